"""Involute gear teeth cut by a rack with a rounded tip: flank, trochoidal root, tip rounding."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np
from scipy.optimize import brentq

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array, FloatOrArray
from toothspace.geometry.curve import CurveSegment, sample_segments
from toothspace.geometry.gear_profile import GearProfile

MIN_TOOTH_COUNT = 5
MAX_TOOTH_COUNT = 400
DEFAULT_TOOL_TIP_RADIUS = 0.38


def involute_function(pressure_angle: FloatOrArray) -> FloatOrArray:
    """Involute function, tan(a) - a, of a pressure angle in [rad]."""
    return np.tan(pressure_angle) - pressure_angle


@final
@dataclass(frozen=True)
class InvoluteGear:
    """Parameters of a spur gear that a straight-sided rack with rounded tip would cut.

    Parameters
    ----------
    tooth_count : int
        Number of teeth, 5 to 400.
    module : float
        Reference diameter over tooth count. [m]
    pressure_angle : float
        Flank angle of the rack. [rad]
    profile_shift : float
        Distance of the rack from its standard place, positive away from the centre. [module]
    tip_diameter : float or None
        Outside diameter; None for ``module (tooth_count + 2 + 2 profile_shift)``. [m]
    dedendum : float
        Depth of the root below the rack's reference line. [module]
    tool_tip_radius : float or None
        Radius of the rack's tip corners; None for 0.38, or for the fully rounded tip where 0.38
        does not fit. [module]
    tip_rounding : float
        Radius of the arc that joins flank and tip circle tangentially, 0 for a sharp corner. [m]

    Raises
    ------
    GeometryError
        If a value is outside its range; the tooth form is checked by ``tooth_form``.
    """

    tooth_count: int
    module: float
    pressure_angle: float = np.deg2rad(20.0)
    profile_shift: float = 0.0
    tip_diameter: float | None = None
    dedendum: float = 1.25
    tool_tip_radius: float | None = None
    tip_rounding: float = 0.0

    def __post_init__(self) -> None:
        count = self.tooth_count
        if not (MIN_TOOTH_COUNT <= count <= MAX_TOOTH_COUNT and int(count) == count):
            raise GeometryError(
                f"tooth_count: found {count}, allowed an integer {MIN_TOOTH_COUNT} to "
                f"{MAX_TOOTH_COUNT}"
            )
        _check("module", self.module * 1e3, 1e-2, 1e3, "mm")
        _check("pressure_angle", np.rad2deg(self.pressure_angle), 10.0, 35.0, "deg")
        _check("profile_shift", self.profile_shift, -1.5, 2.5, "modules")
        _check("dedendum", self.dedendum, 0.5, 2.0, "modules")
        _check("tip_rounding", self.tip_rounding * 1e3, 0.0, 0.5 * self.module * 1e3, "mm")
        if self.tip_diameter is not None:
            upper = self.module * (self.tooth_count + 8.0)
            _check("tip_diameter", self.tip_diameter * 1e3, 0.0, upper * 1e3, "mm", open_low=True)
        self._check_tool()

    def _check_tool(self) -> None:
        if self._largest_tool_tip_radius < 0.0:
            raise GeometryError(
                f"dedendum: found {self.dedendum:g} modules, allowed up to "
                f"{0.25 * np.pi / np.tan(self.pressure_angle):.4g} (the rack tooth is pointed)"
            )
        if self.tool_tip_radius is not None:
            _check("tool_tip_radius", self.tool_tip_radius, 0.0, self._largest_tool_tip_radius,
                   "modules")  # fmt: skip

    @property
    def _largest_tool_tip_radius(self) -> float:
        alpha = self.pressure_angle
        tip_half_width = 0.25 * np.pi - self.dedendum * np.tan(alpha)
        return float(tip_half_width * np.cos(alpha) / (1.0 - np.sin(alpha)))

    @property
    def rack_tip_radius(self) -> float:
        """Radius of the rack's tip corners [m]."""
        radius = self.tool_tip_radius
        if radius is None:
            radius = min(DEFAULT_TOOL_TIP_RADIUS, self._largest_tool_tip_radius)
        return self.module * radius

    @property
    def reference_radius(self) -> float:
        """Radius at which the rack rolls [m]."""
        return 0.5 * self.module * self.tooth_count

    @property
    def base_radius(self) -> float:
        """Radius of the circle that the involute unwinds from [m]."""
        return float(self.reference_radius * np.cos(self.pressure_angle))

    @property
    def base_pitch(self) -> float:
        """Distance of neighbouring flanks along their common normal [m]."""
        return float(np.pi * self.module * np.cos(self.pressure_angle))

    @property
    def root_radius(self) -> float:
        """Radius of the root circle [m]."""
        return self.reference_radius - (self.dedendum - self.profile_shift) * self.module

    @property
    def tip_radius(self) -> float:
        """Radius of the tip circle [m]."""
        if self.tip_diameter is not None:
            return 0.5 * self.tip_diameter
        return self.reference_radius + (1.0 + self.profile_shift) * self.module

    @property
    def base_half_angle(self) -> float:
        """Half of the tooth's angular thickness on the base circle [rad]."""
        half = 0.25 * np.pi + self.profile_shift * np.tan(self.pressure_angle)
        return float(2.0 * half / self.tooth_count + involute_function(self.pressure_angle))

    def half_angle(self, radius: FloatOrArray) -> FloatOrArray:
        """Half of the angular thickness of the unlimited involute tooth.

        Parameters
        ----------
        radius : float or ndarray
            Distance from the centre, at least the base radius. [m]

        Returns
        -------
        float or ndarray
            Half angle; negative above the point where the flanks cross. [rad]
        """
        angle = np.arccos(np.minimum(self.base_radius / np.asarray(radius), 1.0))
        return self.base_half_angle - involute_function(angle)

    def tooth_thickness(self, radius: FloatOrArray) -> FloatOrArray:
        """Arc thickness of the involute tooth at a radius of at least the base radius [m]."""
        return 2.0 * np.asarray(radius) * self.half_angle(radius)

    @property
    def smallest_shift_without_undercut(self) -> float:
        """Profile shift below which the rack's tip corner cuts into the involute [module]."""
        alpha = self.pressure_angle
        corner = self.rack_tip_radius / self.module * (1.0 - np.sin(alpha))
        return float(self.dedendum - corner - 0.5 * self.tooth_count * np.sin(alpha) ** 2)


@final
@dataclass(frozen=True)
class ToothForm:
    """Where the parts of a generated tooth meet.

    Parameters
    ----------
    form_radius : float
        Start of the involute above the root fillet. [m]
    tip_form_radius : float
        End of the involute below tip circle or tip rounding. [m]
    tip_half_angle : float
        Half of the angle that the tip land covers. [rad]
    undercut : bool
        True where the root fillet cuts the involute instead of joining it tangentially.
    undercut_depth : float
        Height of the involute that the fillet removes above the base circle. [m]
    fillet_end : float
        Rack corner angle at which fillet and involute meet. [rad]
    """

    form_radius: float
    tip_form_radius: float
    tip_half_angle: float
    undercut: bool
    undercut_depth: float
    fillet_end: float

    @property
    def tip_land_angle(self) -> float:
        """Angle covered by the tip land [rad]."""
        return 2.0 * self.tip_half_angle


def tooth_form(gear: InvoluteGear) -> ToothForm:
    """Junctions of root fillet, involute, tip rounding and tip land.

    Parameters
    ----------
    gear : InvoluteGear
        Gear parameters.

    Returns
    -------
    ToothForm
        Radii and angles of the junctions.

    Raises
    ------
    GeometryError
        If the root circle vanishes, the tooth is pointed below its tip circle, the tip rounding
        does not fit, or undercut leaves no involute.
    """
    if gear.root_radius <= 0.05 * gear.module:
        raise GeometryError(
            f"dedendum: found a root radius of {gear.root_radius * 1e3:.4g} mm, allowed above "
            f"{0.05 * gear.module * 1e3:.4g} mm"
        )
    fillet_end, form_radius, undercut = _fillet_junction(gear)
    _check_neck(gear, fillet_end)
    tip_form_radius, tip_half_angle = _tip_junction(gear)
    if form_radius >= tip_form_radius:
        key = "profile_shift" if undercut else "tip_diameter"
        value = f"{gear.profile_shift:g}" if undercut else f"{gear.tip_radius * 2e3:.5g} mm"
        raise GeometryError(
            f"{key}: found {value}: the root fillet ends at radius {form_radius * 1e3:.4f} mm and "
            f"the flank at {tip_form_radius * 1e3:.4f} mm, allowed a fillet end below the flank "
            f"end (no involute is left)"
        )
    depth = max(form_radius - gear.base_radius, 0.0) if undercut else 0.0
    return ToothForm(form_radius, tip_form_radius, tip_half_angle, undercut, depth, fillet_end)


def generate_profile(gear: InvoluteGear, points_per_tooth: int = 200) -> GearProfile:
    r"""Tooth profile that a rounded rack cuts, with every point on the exact curve.

    Parameters
    ----------
    gear : InvoluteGear
        Gear parameters.
    points_per_tooth : int
        Number of intervals on one pitch, even, at least 40.

    Returns
    -------
    GearProfile
        One pitch with ``points_per_tooth + 1`` points, closer together at the junctions of tip,
        flank, fillet and root so that a cubic spline through a flank stays exact.

    Raises
    ------
    GeometryError
        As ``tooth_form``, and for a number of points outside 40 to 20000 or odd.

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
        raise GeometryError(
            f"points_per_tooth: found {points_per_tooth}, allowed an even number 40 to 20000"
        )
    form = tooth_form(gear)
    half, breaks = sample_segments(_half_tooth(gear, form), points_per_tooth // 2)
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
        base_radius=gear.base_radius,
        breaks=mirrored + tuple(middle + index for index in breaks),
    )


def involute_point(gear: InvoluteGear, radius: FloatOrArray) -> Array:
    """Points of the counter-clockwise flank's unlimited involute.

    Parameters
    ----------
    gear : InvoluteGear
        Gear parameters.
    radius : float or ndarray
        Distances from the centre, at least the base radius. [m]

    Returns
    -------
    ndarray
        Points, shape (n, 2), tooth centred on the x axis. [m]
    """
    radii = np.atleast_1d(np.asarray(radius, dtype=float))
    return _polar(radii, np.asarray(gear.half_angle(radii)))


def fillet_point(gear: InvoluteGear, corner_angle: FloatOrArray) -> Array:
    """Points of the root fillet on the counter-clockwise side of the tooth.

    Parameters
    ----------
    gear : InvoluteGear
        Gear parameters.
    corner_angle : float or ndarray
        Angle on the rack's tip corner, 0 at the rack tip, pi/2 - pressure_angle at the rack
        flank. [rad]

    Returns
    -------
    ndarray
        Points, shape (n, 2), tooth centred on the x axis. [m]
    """
    radii, space_angles = _fillet_polar(gear, np.atleast_1d(np.asarray(corner_angle, dtype=float)))
    return _polar(radii, np.pi / gear.tooth_count - space_angles)


def _corner_center(gear: InvoluteGear) -> tuple[float, float]:
    # depth below the rolling line and distance from the rack tooth's axis
    m, rho, alpha = gear.module, gear.rack_tip_radius, gear.pressure_angle
    depth = (gear.dedendum - gear.profile_shift) * m - rho
    tip_half_width = m * (0.25 * np.pi - gear.dedendum * np.tan(alpha))
    return depth, max(tip_half_width - rho * (1.0 - np.sin(alpha)) / np.cos(alpha), 0.0)


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
    angle = _undercut_corner(gear, last)
    return angle, float(_fillet_polar(gear, np.array([angle]))[0][0]), True


def _undercut_corner(gear: InvoluteGear, last: float) -> float:
    def gap(corner_angle: float) -> float:
        radius, space = _fillet_polar(gear, np.array([corner_angle]))
        flank = np.pi / gear.tooth_count - gear.half_angle(np.maximum(radius, gear.base_radius))
        return float((space - flank)[0])

    def height(corner_angle: float) -> float:
        return float(_fillet_polar(gear, np.array([corner_angle]))[0][0]) - gear.base_radius

    start = float(brentq(height, 0.0, last)) if height(0.0) < 0.0 < height(last) else 0.0
    if gap(start) <= 0.0 or gap(last) >= 0.0:
        return float(start)
    return float(brentq(gap, start, last, xtol=1e-15, rtol=1e-14))


def _check_neck(gear: InvoluteGear, fillet_end: float) -> None:
    radii, spaces = _fillet_polar(gear, np.linspace(0.0, fillet_end, 200))
    if np.min(np.diff(radii)) < -1e-12 * gear.module:
        raise GeometryError(
            f"profile_shift: found {gear.profile_shift:g}, allowed below dedendum minus "
            f"tool_tip_radius (the root fillet folds back)"
        )
    neck = float(np.min((np.pi / gear.tooth_count - spaces) * radii)) * 2.0
    if neck < 0.1 * gear.module:
        raise GeometryError(
            f"profile_shift: found {gear.profile_shift:g}: undercut leaves a tooth neck of "
            f"{neck * 1e3:.4g} mm, allowed at least {0.1 * gear.module * 1e3:.4g} mm"
        )


def _tip_junction(gear: InvoluteGear) -> tuple[float, float]:
    base, rounding = gear.base_radius, gear.tip_rounding
    if gear.tip_radius <= base:
        raise GeometryError(
            f"tip_diameter: found {gear.tip_radius * 2e3:.5g} mm, allowed above the base diameter "
            f"of {base * 2e3:.5g} mm"
        )
    if float(gear.half_angle(gear.tip_radius)) <= 0.0:
        raise GeometryError(
            f"tip_diameter: found {gear.tip_radius * 2e3:.5g} mm, allowed below "
            f"{_pointed_radius(gear) * 2e3:.5g} mm where the tooth is pointed"
        )
    center_radius = gear.tip_radius - rounding
    if center_radius <= base:
        raise GeometryError(_rounding_message(gear))
    tip_half_angle = float(gear.half_angle(center_radius)) - rounding / base
    if tip_half_angle <= 0.0:
        raise GeometryError(_rounding_message(gear))
    roll_length = np.sqrt(center_radius**2 - base**2) + rounding
    return float(np.hypot(base, roll_length)), tip_half_angle


def _rounding_message(gear: InvoluteGear) -> str:
    return (
        f"tip_rounding: found {gear.tip_rounding * 1e3:.4g} mm, allowed smaller: no tip land is "
        f"left of {gear.tip_radius * 2e3 * float(gear.half_angle(gear.tip_radius)):.4g} mm"
    )


def _pointed_radius(gear: InvoluteGear) -> float:
    def excess(angle: float) -> float:
        return float(involute_function(angle)) - gear.base_half_angle

    return float(gear.base_radius / np.cos(brentq(excess, 1e-6, 1.5)))


def _half_tooth(gear: InvoluteGear, form: ToothForm) -> list[CurveSegment]:
    # from the tooth axis outwards: land, rounding, involute, fillet, root
    segments = [_arc_segment(gear.tip_radius, 0.0, form.tip_half_angle, 0.0)]
    if gear.tip_rounding > 0.0:
        segments.append(CurveSegment(_rounding_arc(gear, form), (0.0, 1.0)))
    segments.append(CurveSegment(_flank_curve(gear, form), (float(gear.tip_rounding > 0.0), 1.0)))
    corner = 1.0 if _corner_center(gear)[1] > 0.0 else 0.0
    end = form.fillet_end
    segments.append(CurveSegment(lambda u: fillet_point(gear, end * (1.0 - u)), (1.0, corner)))
    root_angle = float(_fillet_polar(gear, np.zeros(1))[1][0])
    if corner > 0.0:
        pitch = np.pi / gear.tooth_count
        segments.append(_arc_segment(gear.root_radius, pitch - root_angle, pitch, 1.0))
    if form.undercut:
        _sharpen(segments, -2 if corner == 0.0 else -3)
    return segments


def _sharpen(segments: list[CurveSegment], index: int) -> None:
    flank, fillet = segments[index], segments[index + 1]
    segments[index] = CurveSegment(flank.curve, (flank.crowding[0], 2.0))
    segments[index + 1] = CurveSegment(fillet.curve, (2.0, fillet.crowding[1]))


def _arc_segment(radius: float, start: float, end: float, crowding: float) -> CurveSegment:
    def curve(u: Array) -> Array:
        return _polar(np.full(len(u), radius), start + (end - start) * u)

    return CurveSegment(curve, (crowding, 0.0))


def _flank_curve(gear: InvoluteGear, form: ToothForm) -> Callable[[Array], Array]:
    base = gear.base_radius
    upper = np.sqrt(form.tip_form_radius**2 - base**2)
    lower = np.sqrt(max(form.form_radius**2 - base**2, 0.0))

    def curve(u: Array) -> Array:
        roll = upper + (lower - upper) * u
        angle = gear.base_half_angle - (roll / base - np.arctan(roll / base))
        return _polar(np.hypot(base, roll), angle)

    return curve


def _rounding_arc(gear: InvoluteGear, form: ToothForm) -> Callable[[Array], Array]:
    radius = gear.tip_rounding
    center = _polar(np.array([gear.tip_radius - radius]), np.array([form.tip_half_angle]))[0]
    contact = involute_point(gear, form.tip_form_radius)[0] - center
    start, end = form.tip_half_angle, float(np.arctan2(contact[1], contact[0]))

    def curve(u: Array) -> Array:
        return center + _polar(np.full(len(u), radius), start + (end - start) * u)

    return curve


def _polar(radius: Array, angle: Array) -> Array:
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def _check(
    key: str, value: float, low: float, high: float, unit: str, *, open_low: bool = False
) -> None:
    # comparisons are false for NaN
    if not (low < value <= high if open_low else low <= value <= high):
        bound = "above" if open_low else "from"
        raise GeometryError(f"{key}: found {value:g} {unit}, allowed {bound} {low:g} to {high:.4g}")
