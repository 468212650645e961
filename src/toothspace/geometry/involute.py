"""Involute gear teeth cut by a rack with a rounded tip: flank, trochoidal root, tip rounding."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array, FloatOrArray
from toothspace.geometry.curve import CurveSegment, polar, sample_segments
from toothspace.geometry.gear_profile import GearProfile, InvoluteFlank
from toothspace.geometry.involute_gear import InvoluteGear, involute_function
from toothspace.numerics.roots import root_between

__all__ = [
    "InvoluteGear",
    "ToothForm",
    "fillet_point",
    "generate_profile",
    "involute_function",
    "involute_point",
    "tooth_form",
]


@final
@dataclass(frozen=True)
class ToothForm:
    """Where the parts of a generated tooth meet."""

    form_radius: float
    """Start of the involute above the root fillet. [m]"""
    tip_form_radius: float
    """End of the involute below tip circle or tip rounding. [m]"""
    tip_half_angle: float
    """Half of the angle that the tip land covers. [rad]"""
    undercut: bool
    """True where the root fillet cuts the involute instead of joining it tangentially."""
    undercut_depth: float
    """Height of the involute that the fillet removes above the base circle. [m]"""
    fillet_end: float
    """Rack corner angle at which fillet and involute meet. [rad]"""

    @property
    def tip_land_angle(self) -> float:
        """Angle covered by the tip land [rad]."""
        return 2.0 * self.tip_half_angle


def tooth_form(gear: InvoluteGear) -> ToothForm:
    """Junctions of root fillet, involute, tip rounding and tip land.

    Raises GeometryError if the root circle vanishes, the tooth is pointed below its tip circle, the
    tip rounding does not fit, or undercut leaves no involute.
    """
    if gear.root_radius <= 0.05 * gear.module:
        raise GeometryError(
            "dedendum",
            f"a root radius of {gear.root_radius * 1e3:.4g} mm",
            f"above {0.05 * gear.module * 1e3:.4g} mm",
        )
    fillet_end, form_radius, undercut = _fillet_junction(gear)
    radii, spaces = _fillet_polar(gear, np.linspace(0.0, fillet_end, 200))
    if np.min(np.diff(radii)) < -1e-12 * gear.module:
        raise GeometryError(
            "profile_shift",
            f"{gear.profile_shift:g}",
            "below dedendum minus tool_tip_radius (the root fillet folds back)",
        )
    neck = float(np.min((np.pi / gear.tooth_count - spaces) * radii)) * 2.0
    if neck < 0.1 * gear.module:
        raise GeometryError(
            "profile_shift",
            f"{gear.profile_shift:g}: undercut leaves a tooth neck of {neck * 1e3:.4g} mm",
            f"at least {0.1 * gear.module * 1e3:.4g} mm",
        )
    tip_form_radius, tip_half_angle = _tip_junction(gear)
    if form_radius >= tip_form_radius:
        key = "profile_shift" if undercut else "tip_diameter"
        value = f"{gear.profile_shift:g}" if undercut else f"{gear.tip_radius * 2e3:.5g} mm"
        raise GeometryError(
            key,
            f"{value}: the root fillet ends at radius {form_radius * 1e3:.4f} mm and the flank "
            f"at {tip_form_radius * 1e3:.4f} mm",
            "a fillet end below the flank end (no involute is left)",
        )
    depth = max(form_radius - gear.base_radius, 0.0) if undercut else 0.0
    return ToothForm(form_radius, tip_form_radius, tip_half_angle, undercut, depth, fillet_end)


def generate_profile(gear: InvoluteGear, points_per_tooth: int = 200) -> GearProfile:
    r"""Tooth profile that a rounded rack cuts, with every point on the exact curve.

    One pitch with ``points_per_tooth + 1`` points, closer together at the junctions of tip, flank,
    fillet and root so that a cubic spline through a flank stays exact.

    Raises GeometryError as ``tooth_form``, and for a number of points outside 40 to 20000 or odd.

    Parameters
    ----------
    points_per_tooth : int
        Number of intervals on one pitch, even, at least 40.

    Notes
    -----
    The rack rolls on the reference circle of radius :math:`r`. A corner of radius :math:`\rho`
    with its centre :math:`y_c` below the rolling line and :math:`x_c` beside the rack tooth's axis
    touches the gear at corner angle :math:`\gamma` when the gear has turned by

    .. math:: \varphi = (y_c \tan\gamma - x_c)/r

    because the normal passes through the pitch point; the fillet is then
    :math:`R(-\varphi)(r - d, d \tan\gamma)` with :math:`d = y_c + \rho \cos\gamma`.

    References
    ----------
    .. [1] Litvin, Fuentes, Gear Geometry and Applied Theory, 2nd ed., 2004, chapter 6.
    """
    if points_per_tooth % 2 or not 40 <= points_per_tooth <= 20000:
        raise GeometryError("points_per_tooth", points_per_tooth, "an even number 40 to 20000")
    form = tooth_form(gear)
    flank = InvoluteFlank(
        base_radius=gear.base_radius,
        base_half_angle=gear.base_half_angle,
        form_radius=form.form_radius,
        tip_form_radius=form.tip_form_radius,
        undercut=form.undercut,
    )
    # from the tooth axis outwards: land, rounding, involute, fillet, root
    rounded = float(gear.tip_rounding > 0.0)
    corner = 1.0 if _corner_center(gear)[1] > 0.0 else 0.0
    sharp = 2.0 if form.undercut else 1.0
    land, end, pitch = form.tip_half_angle, form.fillet_end, np.pi / gear.tooth_count
    segments = [CurveSegment(lambda u: polar(gear.tip_radius, land * u), (0.0, 0.7 * rounded))]
    if rounded:
        radius = gear.tip_rounding
        center = polar(np.array([gear.tip_radius - radius]), np.array([form.tip_half_angle]))[0]
        contact = involute_point(gear, form.tip_form_radius)[0] - center
        begin, to = form.tip_half_angle, float(np.arctan2(contact[1], contact[0]))

        def curve(u: Array) -> Array:
            return center + polar(np.full(len(u), radius), begin + (to - begin) * u)

        segments.append(CurveSegment(curve, (0.7, 1.0)))
    segments += [
        CurveSegment(flank.curve(form.tip_form_radius), (rounded, sharp)),
        CurveSegment(lambda u: fillet_point(gear, end * (1.0 - u)), (sharp, corner)),
    ]
    if corner > 0.0:
        root = float(_fillet_polar(gear, np.zeros(1))[1][0])
        start = pitch - root
        segments.append(
            CurveSegment(lambda u: polar(gear.root_radius, start + (pitch - start) * u), (1.0, 0.0))
        )
    half, breaks = sample_segments(segments, points_per_tooth // 2)
    points = np.vstack([half[:0:-1] * (1.0, -1.0), half])
    middle = len(half) - 1
    tip_end = middle + breaks[0]
    mirrored = tuple(middle - index for index in reversed(breaks))
    return GearProfile(
        tooth_count=gear.tooth_count,
        points=points,
        tip_start=middle - breaks[0],
        tip_end=tip_end,
        tip_radius=gear.tip_radius,
        root_radius=gear.root_radius,
        involute=flank,
        breaks=mirrored + tuple(middle + index for index in breaks),
    )


def involute_point(gear: InvoluteGear, radius: FloatOrArray) -> Array:
    """Points of the counter-clockwise flank's unlimited involute.

    Points, shape (n, 2), tooth centred on the x axis. [m]

    Parameters
    ----------
    radius : float or ndarray
        Distances from the centre, at least the base radius. [m]
    """
    radii = np.atleast_1d(np.asarray(radius, dtype=float))
    return polar(radii, np.asarray(gear.half_angle(radii)))


def fillet_point(gear: InvoluteGear, corner_angle: FloatOrArray) -> Array:
    """Points of the root fillet on the counter-clockwise side of the tooth.

    Points, shape (n, 2), tooth centred on the x axis. [m]

    Parameters
    ----------
    corner_angle : float or ndarray
        Angle on the rack's tip corner, 0 at the rack tip, pi/2 - pressure_angle at the rack
        flank. [rad]
    """
    radii, space_angles = _fillet_polar(gear, np.atleast_1d(np.asarray(corner_angle, dtype=float)))
    return polar(radii, np.pi / gear.tooth_count - space_angles)


def _corner_center(gear: InvoluteGear) -> tuple[float, float]:
    # depth below the rolling line and distance from the rack tooth's axis
    m, rho, alpha = gear.module, gear.rack_tip_radius, gear.pressure_angle
    depth = (gear.dedendum - gear.profile_shift) * m - rho
    tip_half_width = m * (0.25 * np.pi - gear.dedendum * np.tan(alpha))
    side = tip_half_width - rho * (1.0 - np.sin(alpha)) / np.cos(alpha)
    return depth, side if side > 1e-6 * m else 0.0


def _fillet_polar(gear: InvoluteGear, corner_angle: Array) -> tuple[Array, Array]:
    center_depth, center_side = _corner_center(gear)
    tangent = np.tan(corner_angle)
    roll = (center_depth * tangent - center_side) / gear.reference_radius
    depth = center_depth + gear.rack_tip_radius * np.cos(corner_angle)
    along = gear.reference_radius - depth
    return np.hypot(along, depth * tangent), np.arctan2(depth * tangent, along) - roll


def _fillet_junction(gear: InvoluteGear) -> tuple[float, float, bool]:
    alpha = gear.pressure_angle
    last = 0.5 * np.pi - alpha
    depth = _corner_center(gear)[0] + gear.rack_tip_radius * np.sin(alpha)
    roll_length = gear.reference_radius * np.sin(alpha) - depth / np.sin(alpha)
    if roll_length >= 0.0:
        return float(last), float(np.hypot(gear.base_radius, roll_length)), False

    def gap(corner_angle: float) -> float:
        radius, space = _fillet_polar(gear, np.array([corner_angle]))
        flank = np.pi / gear.tooth_count - gear.half_angle(np.maximum(radius, gear.base_radius))
        return float((space - flank)[0])

    def height(corner_angle: float) -> float:
        return float(_fillet_polar(gear, np.array([corner_angle]))[0][0]) - gear.base_radius

    start = root_between(height, 0.0, last) if height(0.0) < 0.0 < height(last) else 0.0
    angle = (
        float(start)
        if gap(start) <= 0.0 or gap(last) >= 0.0
        else root_between(gap, start, last, 1e-15)
    )
    return angle, float(_fillet_polar(gear, np.array([angle]))[0][0]), True


def _tip_junction(gear: InvoluteGear) -> tuple[float, float]:
    base, rounding = gear.base_radius, gear.tip_rounding
    if gear.tip_radius <= base:
        raise GeometryError(
            "tip_diameter",
            f"{gear.tip_radius * 2000.0:.5g} mm",
            f"above the base diameter of {base * 2000.0:.5g} mm",
        )
    if float(gear.half_angle(gear.tip_radius)) <= 0.0:
        half = gear.base_half_angle
        pointed = root_between(lambda angle: involute_function(angle) - half, 1e-6, 1.5)
        raise GeometryError(
            "tip_diameter",
            f"{gear.tip_radius * 2000.0:.5g} mm",
            f"below {base / np.cos(pointed) * 2000.0:.5g} mm where the tooth is pointed",
        )
    center_radius = gear.tip_radius - rounding
    tip_half_angle = float(gear.half_angle(center_radius)) - rounding / base
    if center_radius <= base or tip_half_angle <= 0.0:
        land = gear.tip_radius * 2e3 * float(gear.half_angle(gear.tip_radius))
        raise GeometryError(
            "tip_rounding",
            f"{rounding * 1e3:.4g} mm",
            f"smaller: no tip land is left of {land:.4g} mm",
        )
    roll_length = np.sqrt(center_radius**2 - base**2) + rounding
    return float(np.hypot(base, roll_length)), tip_half_angle
