"""Profiles of gerotor sets: trochoidal, cycloidal, or read from files.

Frame at shaft angle zero: the outer rotor turns about the origin, the inner one about
``(0, -eccentricity)``; both turn counter-clockwise. A cavity of the outer rotor and a tooth of
the inner rotor in it lie on the negative y axis, where the pockets are smallest; the largest
pocket is on the positive y axis.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import cached_property
from typing import NoReturn, final

import numpy as np
import shapely

from toothspace.core.errors import CaseError, GeometryError
from toothspace.core.types import Array
from toothspace.core.units import to_si
from toothspace.geometry.contour import Contour, Turning, contour
from toothspace.geometry.curve import counter_clockwise, without_repeats
from toothspace.machines.gerotor.rotor_files import (
    DrawnRotor,
    RotorParameters,
    drawn_eccentricity,
    rotor_pair,
)

_SAMPLES = 2000
_LEAST_LOBE = 1.05
POINTS_PER_TOOTH = 480
_UNITS = ("mm", "m", "um", "in")
_LEAST_EDGE = 1e-9
_FEWEST_EDGES = 16
_POINTS_FOR_PHASE = 2000
_LEAST_OF_RIM = 0.5
"""Of the outside diameter of an outer rotor: the width across its lobes is more. [-]"""


@final
@dataclass(frozen=True)
class Trochoid:
    """Generating data of a trochoidal set."""

    tooth_count: int
    """Teeth of the inner rotor."""
    eccentricity: float
    """Distance of the centres. [m]"""
    generating_radius: float
    """Radius of the lobe centres. [m]"""
    lobe_radius: float
    """Radius of the outer rotor's lobes, without clearance. [m]"""

    @property
    def lobe_count(self) -> int:
        """Lobes of the outer rotor."""
        return self.tooth_count + 1

    @property
    def no_undercut_limit(self) -> float:
        """Largest lobe radius that the inner profile bears without undercut. [m]."""
        curvature = self.path_curvature(np.linspace(0.0, 2.0 * np.pi / self.tooth_count, _SAMPLES))
        return float(1.0 / curvature.max())

    @property
    def closure_limit(self) -> float:
        """Lobe radius at which neighbouring lobes touch. [m]."""
        return float(self.generating_radius * np.sin(np.pi / self.lobe_count))

    @property
    def floor_limit(self) -> float:
        """Lobe radius at which the cavity floor cuts into the part of a lobe that touches. [m]."""
        radius, e = self.generating_radius, self.eccentricity
        slope = np.sqrt(1.0 - (self.lobe_count * e / radius) ** 2)
        return float(2.0 * e * (e + radius) / (radius + 2.0 * e - radius * slope))

    @property
    def cavity_radius(self) -> float:
        """Radius of the outer rotor's cavity floor, which the inner tips touch. [m]."""
        return self.generating_radius - self.lobe_radius + 2.0 * self.eccentricity

    def check(self) -> None:
        """Refuse designs that cannot be built.

        Raises
        ------
        GeometryError
            For a generating radius inside the pitch circle, undercut, lobes that overlap, or lobes
            that end before the floor of the cavities.
        """
        e, pitch = self.eccentricity, self.lobe_count * self.eccentricity
        if self.generating_radius <= pitch:
            raise _found("generating_radius", self.generating_radius, "above", pitch)
        limit = min(self.no_undercut_limit, self.closure_limit, self.floor_limit)
        if self.lobe_radius >= limit:
            raise _found("lobe_radius", self.lobe_radius, "below", limit)
        # a smaller lobe does not reach the cavity floor, which the inner tips need
        if self.lobe_radius <= _LEAST_LOBE * e:
            raise _found("lobe_radius", self.lobe_radius, "above", _LEAST_LOBE * e)

    def center_path(self, sigma: Array) -> tuple[Array, Array, Array]:
        """Lobe centre in the inner rotor's frame and two derivatives, complex. [m]."""
        count, lobes = self.tooth_count, self.lobe_count
        start = -0.5 * np.pi + np.pi / lobes
        # at sigma zero the lobe stands half a pitch from the cavity on the negative y axis
        first = self.generating_radius * np.exp(1j * (start - sigma))
        second = 1j * self.eccentricity * np.exp(-1j * (count + 1) * sigma)
        return (first + second, -1j * first - 1j * lobes * second, -first - lobes**2 * second)

    def path_curvature(self, sigma: Array) -> Array:
        """Curvature of the trochoid, positive where convex. [1/m]."""
        _, rate, bend = self.center_path(sigma)
        return np.asarray(-np.imag(np.conj(rate) * bend) / np.abs(rate) ** 3, dtype=float)


def _found(key: str, value: float, relation: str, bound: float) -> GeometryError:
    return GeometryError(
        f"machine.rotors.{key}", f"{value * 1e3:.5g} mm", f"{relation} {bound * 1e3:.5g} mm"
    )


def inner_outline(design: Trochoid, points_per_tooth: int, offset: float) -> Array:
    """Outline of the inner rotor.

    Closed counter-clockwise curve about the inner rotor's centre, shape (n, 2). [m]

    Parameters
    ----------
    points_per_tooth : int
        Points on one tooth.
    offset : float
        What the profile is set back along its normal. [m]
    """
    # chords of one sagitta: steps with the inverse square root of the curvature
    pitch = 2.0 * np.pi / design.tooth_count
    fine = pitch * np.arange(_SAMPLES + 1) / _SAMPLES
    _, rate, _ = design.center_path(-fine)
    path = design.path_curvature(-fine)
    moved = 1.0 - (design.lobe_radius + offset) * path
    length = np.abs(rate) * np.abs(moved)
    bend = np.sqrt(length * np.abs(path * rate)) + 0.2 * length / design.lobe_radius
    summed = np.concatenate([[0.0], np.cumsum(0.5 * (bend[1:] + bend[:-1]))])
    levels = summed[-1] * np.arange(points_per_tooth) / points_per_tooth
    one = np.interp(levels, summed, fine)
    sigma = -(one[None, :] + pitch * np.arange(design.tooth_count)[:, None]).ravel()
    center, rate, _ = design.center_path(sigma)
    # the path runs clockwise over sigma: its inward normal is on the right of the rate
    inward = -1j * rate / np.abs(rate)
    point = center + (design.lobe_radius + offset) * inward
    return np.column_stack([point.real, point.imag])


def outer_outline(design: Trochoid, points_per_lobe: int, offset: float) -> Array:
    """Inside of the outer rotor: lobe arcs joined by the arcs of the cavity floor.

    Closed counter-clockwise curve about the outer rotor's centre, shape (n, 2). [m]

    Parameters
    ----------
    points_per_lobe : int
        Points on one lobe and cavity.
    offset : float
        What the profile is set back along its normal. [m]
    """
    distance, radius = design.generating_radius, design.lobe_radius - offset
    floor, half_pitch = design.cavity_radius + offset, np.pi / design.lobe_count
    # angles of the corner between lobe and floor about the origin and about the lobe centre
    corner = np.arccos((distance**2 + floor**2 - radius**2) / (2.0 * distance * floor))
    swing = np.arccos((distance**2 + radius**2 - floor**2) / (2.0 * distance * radius))
    corner = min(corner, half_pitch)
    on_lobe = 2 * (points_per_lobe // 3) + 1
    turn = np.linspace(-swing, swing, on_lobe)
    lobe = distance - radius * np.exp(-1j * turn)
    rest = np.linspace(corner, 2.0 * half_pitch - corner, points_per_lobe - on_lobe + 2)
    one = np.concatenate([lobe, floor * np.exp(1j * rest[1:-1])])
    places = -0.5 * np.pi + half_pitch * (1.0 + 2.0 * np.arange(design.lobe_count))
    points = (np.exp(1j * places)[:, None] * one[None, :]).ravel()
    return np.column_stack([points.real, points.imag])


def cycloid(tooth_count: int, rolling_radius: float, points_per_tooth: int) -> Array:
    r"""Closed curve of alternating epi- and hypocycloids.

    Closed counter-clockwise curve; the middle of an epicycloid is on the negative y axis, shape (n,
    2). [m]

    Parameters
    ----------
    tooth_count : int
        Teeth (epicycloids) of the curve.
    rolling_radius : float
        Radius of the generating circle, half of the eccentricity. [m]
    points_per_tooth : int
        Points on one epicycloid and one hypocycloid together.

    Notes
    -----
    With the pitch radius :math:`r = 2 z q`:

    .. math::
        p_{epi}(t) = (r+q) e^{it} - q\, e^{i (r+q) t/q}, \qquad
        p_{hypo}(t) = (r-q) e^{it} + q\, e^{-i (r-q) t/q} .
    """
    q, r = rolling_radius, 2.0 * tooth_count * rolling_radius
    half_pitch = np.pi / tooth_count
    count = max(points_per_tooth // 2, 4)
    # points gather at the cusps, where the curvature grows without limit
    share = np.arange(count) / count
    t = half_pitch * (share - np.sin(2.0 * np.pi * share) / (2.0 * np.pi))
    tip = (r + q) * np.exp(1j * t) - q * np.exp(1j * (r + q) * t / q)
    root = (r - q) * np.exp(1j * t) + q * np.exp(-1j * (r - q) * t / q)
    one = np.concatenate([tip, root * np.exp(1j * half_pitch)])
    places = -0.5 * np.pi + half_pitch * (2.0 * np.arange(tooth_count) - 0.5)
    points = (np.exp(1j * places)[:, None] * one[None, :]).ravel()
    return np.column_stack([points.real, points.imag])


@final
@dataclass(frozen=True)
class Rotors:
    """Section of a gerotor set."""

    inner: Array
    outer: Array
    """Closed counter-clockwise outlines, first point not repeated: the inner rotor, and the inside
    of the outer rotor, each about its own centre at shaft angle zero. Shape (n, 2). [m]
    """
    inner_tooth_count: int
    """Teeth of the inner rotor; the outer one has one more."""
    eccentricity: float
    """Distance of the centres. [m]"""
    tip_clearance: float
    """Normal gap of every lobe pair of the centred rotors. [m]"""

    @property
    def outer_tooth_count(self) -> int:
        """Lobes of the outer rotor."""
        return self.inner_tooth_count + 1

    @property
    def speed_ratio(self) -> float:
        """Speed of the outer rotor over that of the inner one. [-]."""
        return self.inner_tooth_count / self.outer_tooth_count

    @property
    def turns(self) -> float:
        """Angle of the inner rotor per angle of the outer one. [-]."""
        return self.outer_tooth_count / self.inner_tooth_count

    @property
    def pitch(self) -> float:
        """Angle of one tooth of the outer rotor. [rad]."""
        return 2.0 * np.pi / self.outer_tooth_count

    @cached_property
    def inner_curve(self) -> Contour:
        """Outline of the inner rotor over its arc length."""
        return contour(self.inner)

    @cached_property
    def outer_curve(self) -> Contour:
        """Outline of the outer rotor over its arc length."""
        return contour(self.outer)

    @property
    def turning(self) -> Turning:
        """How the inner rotor turns about its centre while the outer one turns."""
        x, y = self.inner_center.tolist()
        return Turning(x, y, self.turns)

    @property
    def inner_center(self) -> Array:
        """Centre of the inner rotor. [m]."""
        return np.array([0.0, -self.eccentricity])

    @property
    def pitch_point(self) -> Array:
        """Point where both rotors have one velocity; all contact normals meet there. [m]."""
        return np.array([0.0, -self.outer_tooth_count * self.eccentricity])


def rotors_from(parameters: RotorParameters, points_per_tooth: int = POINTS_PER_TOOTH) -> Rotors:
    """Build both rotors of a case.

    Outlines with half of the tip clearance taken off each rotor by normal offset, so that the curve
    in the middle of the gaps is the exact conjugate pair. Profiles from files are taken as drawn,
    less half of ``tip_clearance`` each.

    Raises GeometryError if the design undercuts or does not close, or a file holds no rotor.

    Parameters
    ----------
    parameters : RotorParameters
        Keys ``[machine.rotors]``.
    points_per_tooth : int
        Points on one tooth of a generated outline.
    """
    count, half = parameters.inner_tooth_count, 0.5 * parameters.tip_clearance
    if parameters.kind == "trochoidal":
        design = trochoid_of(parameters)
        design.check()
        inner = inner_outline(design, points_per_tooth, half)
        outer = outer_outline(design, points_per_tooth, half)
    else:
        if parameters.kind == "cycloidal":
            rolling = 0.5 * parameters.eccentricity
            curves = [cycloid(n, rolling, points_per_tooth) for n in (count, count + 1)]
        else:
            drawn = _drawn(parameters)
            curves = [turned_to_axis(one.curve, one.tooth_count, "rotor") for one in drawn]
        inner, outer = offset_outline(curves[0], -half), offset_outline(curves[1], half)
    return Rotors(inner, outer, count, parameters.eccentricity, parameters.tip_clearance)


def trochoid_of(parameters: RotorParameters) -> Trochoid:
    """Return the generating data of a trochoidal set; see :class:`Trochoid`."""
    return Trochoid(
        tooth_count=parameters.inner_tooth_count,
        eccentricity=parameters.eccentricity,
        generating_radius=parameters.generating_radius or 0.0,
        lobe_radius=parameters.lobe_radius or 0.0,
    )


def offset_outline(outline: Array, distance: float) -> Array:
    """Move a closed outline along its outward normal.

    Closed counter-clockwise curve. [m]

    Raises GeometryError if the offset does not leave one outline.

    Parameters
    ----------
    outline : ndarray, shape (n, 2)
        Closed counter-clockwise curve. [m]
    distance : float
        Offset, positive outwards; loops that it would cut off are removed. [m]
    """
    if distance == 0.0:
        return outline
    moved = shapely.Polygon(outline).buffer(distance, join_style="mitre")
    if not isinstance(moved, shapely.Polygon) or moved.is_empty:
        _refuse_offset(distance, "nothing or several parts")
    points = without_repeats(np.asarray(moved.exterior.coords, dtype=float))
    long_edge = np.hypot(*(np.roll(points, -1, axis=0) - points).T) > _LEAST_EDGE
    if np.count_nonzero(long_edge) < _FEWEST_EDGES:
        _refuse_offset(distance, f"fewer than {_FEWEST_EDGES} edges")
    return counter_clockwise(points[long_edge])


def _refuse_offset(distance: float, left: str) -> NoReturn:
    raise GeometryError(
        "machine.rotors.tip_clearance",
        f"{2000000.0 * abs(distance):.4g} um, of which the half leaves {left} of an outline",
        "less, or larger rotors",
    )


def completed(parameters: RotorParameters, outer_diameter: float) -> RotorParameters:
    """Keys of rotors from files with the tooth count, eccentricity and width found there.

    Keys without defaults that stand for the files.

    Parameters
    ----------
    parameters : RotorParameters
        Keys ``[machine.rotors]`` with profiles.
    outer_diameter : float
        Outside diameter of the outer rotor, to check the unit of the files. [m]

    Raises
    ------
    CaseError
        For another tooth count than given, files without distance or width, or a wrong unit.
    """
    inner, outer = _drawn(parameters)
    given = parameters.inner_tooth_count
    if given not in (0, inner.tooth_count):
        found = f"{given}, but {inner.tooth_count} teeth in the profile"
        raise CaseError("rotors.inner_tooth_count", found, "that of the profile, or none")
    size = float(np.ptp(outer.curve, axis=0).max())
    if not (_LEAST_OF_RIM * outer_diameter < size < outer_diameter):
        scales = {name: to_si(1.0, name) / to_si(1.0, parameters.profile_unit) for name in _UNITS}
        fits = [
            n
            for n, s in scales.items()
            if _LEAST_OF_RIM * outer_diameter < size * s < outer_diameter
        ]
        if len(fits) == 1:
            raise CaseError(
                "rotors.profile_unit",
                f"{parameters.profile_unit!r}, with which the outer rotor's lobes span "
                f"{1e3 * size:.5g} mm",
                f"{fits[0]!r}, with which it is {1e3 * size * scales[fits[0]]:.5g} mm "
                "and fits the rim",
            )
    eccentricity = parameters.eccentricity or drawn_eccentricity(inner, outer)
    if not eccentricity:
        reason = "compulsory unless the rotors are drawn apart on parallel axes"
        raise CaseError("rotors.eccentricity", "nothing", reason)
    width = parameters.face_width or inner.face_width
    if not width:
        reason = "compulsory unless the rotors are solids"
        raise CaseError("rotors.face_width", "nothing", reason)
    return replace(
        parameters, inner_tooth_count=inner.tooth_count, eccentricity=eccentricity, face_width=width
    )


def _drawn(parameters: RotorParameters) -> tuple[DrawnRotor, DrawnRotor]:
    assert parameters.inner_profile is not None
    assert parameters.outer_profile is not None
    unit = to_si(1.0, parameters.profile_unit)
    return rotor_pair(parameters.inner_profile, parameters.outer_profile, unit)


def turned_to_axis(curve: Array, tooth_count: int, name: str) -> Array:
    """Move a rotor outline to its centre and turn its farthest points to the negative y axis. [m].

    Raises GeometryError if the outline has another number of teeth.

    Parameters
    ----------
    curve : ndarray, shape (n, 2)
        Closed counter-clockwise outline anywhere in its plane. [m]
    tooth_count : int
        Teeth or lobes that the outline must have.
    name : str
        File name for error messages.
    """
    outline, count = contour(curve), _POINTS_FOR_PHASE * tooth_count
    even = outline.point(outline.length * np.arange(count) / count)
    middle = shapely.Polygon(even).centroid
    center = np.array([middle.x, middle.y])
    points, even = curve - center, even - center
    radius, angle = np.hypot(*even.T), np.arctan2(even[:, 1], even[:, 0])
    orders = np.arange(2, 2 * tooth_count + 2)
    height = radius - float(np.mean(radius))
    waves = np.array([np.sum(height * np.exp(-1j * k * angle)) for k in orders])
    found = int(orders[np.argmax(np.abs(waves))])
    if found != tooth_count:
        raise GeometryError(name, f"{found} teeth", tooth_count)
    phase = np.angle(waves[tooth_count - 2])
    turn = -0.5 * np.pi + phase / tooth_count
    turned = points @ np.array([[np.cos(turn), np.sin(turn)], [-np.sin(turn), np.cos(turn)]])
    return np.asarray(turned, dtype=float)
