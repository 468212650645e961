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
from toothspace.geometry.curve import counter_clockwise, without_repeats
from toothspace.machines.gerotor.contour import Contour, contour
from toothspace.machines.gerotor.cycloid import cycloid
from toothspace.machines.gerotor.rotor_files import DrawnRotor, drawn_eccentricity, rotor_pair
from toothspace.machines.gerotor.rotor_parameters import RotorParameters
from toothspace.machines.gerotor.trochoid import Trochoid, inner_outline, outer_outline

POINTS_PER_TOOTH = 480

_UNITS = ("mm", "m", "um", "in")
_LEAST_EDGE = 1e-9
_FEWEST_EDGES = 16
_POINTS_FOR_PHASE = 2000
_LEAST_OF_RIM = 0.5
"""Of the outside diameter of an outer rotor: the width across its lobes is more. [-]"""


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
    def inner_center(self) -> Array:
        """Centre of the inner rotor. [m]."""
        return np.array([0.0, -self.eccentricity])

    @property
    def pitch_point(self) -> Array:
        """Point where both rotors have one velocity; all contact normals meet there. [m]."""
        return np.array([0.0, -self.outer_tooth_count * self.eccentricity])


def rotors_from(parameters: RotorParameters, points_per_tooth: int = POINTS_PER_TOOTH) -> Rotors:
    """Build both rotors of a case.

    Parameters
    ----------
    parameters : RotorParameters
        Keys ``[machine.rotors]``.
    points_per_tooth : int
        Points on one tooth of a generated outline.

    Returns
    -------
    Rotors
        Outlines with half of the tip clearance taken off each rotor by normal offset, so that
        the curve in the middle of the gaps is the exact conjugate pair. Profiles from files
        are taken as drawn, less half of ``tip_clearance`` each.

    Raises
    ------
    GeometryError
        If the design undercuts or does not close, or a file holds no rotor.
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

    Parameters
    ----------
    outline : ndarray, shape (n, 2)
        Closed counter-clockwise curve. [m]
    distance : float
        Offset, positive outwards; loops that it would cut off are removed. [m]

    Returns
    -------
    ndarray
        Closed counter-clockwise curve. [m]

    Raises
    ------
    GeometryError
        If the offset does not leave one outline.
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

    Parameters
    ----------
    parameters : RotorParameters
        Keys ``[machine.rotors]`` with profiles.
    outer_diameter : float
        Outside diameter of the outer rotor, to check the unit of the files. [m]

    Returns
    -------
    RotorParameters
        Keys without defaults that stand for the files.

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
    _check_unit(parameters.profile_unit, outer, outer_diameter)
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


def _check_unit(unit: str, outer: DrawnRotor, diameter: float) -> None:
    size = float(np.ptp(outer.curve, axis=0).max())
    if _LEAST_OF_RIM * diameter < size < diameter:
        return
    scales = {name: to_si(1.0, name) / to_si(1.0, unit) for name in _UNITS}
    fits = [n for n, s in scales.items() if _LEAST_OF_RIM * diameter < size * s < diameter]
    if len(fits) == 1:
        raise CaseError(
            "rotors.profile_unit",
            f"{unit!r}, with which the outer rotor's lobes span {1e3 * size:.5g} mm",
            f"{fits[0]!r}, with which it is {1e3 * size * scales[fits[0]]:.5g} mm and fits the rim",
        )


def turned_to_axis(curve: Array, tooth_count: int, name: str) -> Array:
    """Move a rotor outline to its centre and turn its farthest points to the negative y axis. [m].

    Parameters
    ----------
    curve : ndarray, shape (n, 2)
        Closed counter-clockwise outline anywhere in its plane. [m]
    tooth_count : int
        Teeth or lobes that the outline must have.
    name : str
        File name for error messages.

    Raises
    ------
    GeometryError
        If the outline has another number of teeth.
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
