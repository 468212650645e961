"""Inner and outer rotor in CAD files: axis, lobes, eccentricity, width."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import final

import numpy as np
import shapely

from toothspace.core.errors import GeometryError
from toothspace.core.frozen import Points
from toothspace.core.types import Array
from toothspace.geometry.body_section import FEWEST_LOBES, SectionRequest
from toothspace.geometry.cad_import import is_solid, load_body_sections, load_closed_curves
from toothspace.geometry.curve import counter_clockwise
from toothspace.geometry.tooth_count import repeating_teeth

_PARALLEL = 1e-6
_LEAST_DISTANCE = 10e-6
"""Rotors drawn about one centre each are closer. [m]"""


@final
@dataclass(frozen=True)
class DrawnRotor:
    """Toothed curve of a rotor as it was drawn."""

    file: Path | Points
    """Where it was found."""
    curve: Array
    """Closed counter-clockwise curve in the frame of its section. Shape (n, 2). [m]"""
    tooth_count: int
    """Teeth or lobes."""
    axis: Array
    """Unit vector along the rotor axis. Shape (3,)."""
    face_width: float | None
    """Length of the teeth; None in files of plane curves. [m]"""
    other_curves: tuple[Array, ...]
    """Bore or rim of its body, none in files of plane curves. [m]"""

    @property
    def center(self) -> Array:
        """Centre of area of the curve. [m]."""
        middle = shapely.Polygon(self.curve).centroid
        return np.array([middle.x, middle.y])


def rotor_pair(
    inner: Path | Points, outer: Path | Points, unit: float
) -> tuple[DrawnRotor, DrawnRotor]:
    """Find the rotors of a gerotor set.

    Parameters
    ----------
    inner, outer : Path or Points
        Files or points of the rotors; both may be one assembly.
    unit : float
        Length of one unit of the files; STEP files carry their own. [m]

    Returns
    -------
    tuple of DrawnRotor
        Inner rotor, and outer rotor with one tooth more.

    Raises
    ------
    GeometryError
        If the files hold no such pair.
    """
    both = [
        _rotors(file, file.stat().st_mtime_ns if isinstance(file, Path) else 0, unit)
        for file in (inner, outer)
    ]
    pairs = [
        (first, second)
        for first, second in product(*both)
        if second.tooth_count == first.tooth_count + 1
        and shapely.Polygon(second.curve).area > shapely.Polygon(first.curve).area
    ]
    if not pairs:
        found = [", ".join(str(one.tooth_count) for one in side) or "no" for side in both]
        raise GeometryError(
            "machine.rotors",
            f"curves of {found[0]} teeth in {_named(inner)} and of {found[1]} in {_named(outer)}",
            "an inner rotor and an outer one with one tooth more",
        )
    return pairs[0]


def drawn_eccentricity(inner: DrawnRotor, outer: DrawnRotor) -> float | None:
    """Distance of the rotor axes as drawn, None unless they are parallel and apart. [m]."""
    if abs(inner.axis @ outer.axis) < 1.0 - _PARALLEL:
        return None
    distance = float(np.hypot(*(inner.center - outer.center)))
    return distance if distance > _LEAST_DISTANCE else None


def _named(file: Path | Points) -> str:
    return file.name if isinstance(file, Path) else "the points"


@lru_cache(maxsize=64)
def _rotors(file: Path | Points, _modified: int, unit: float) -> list[DrawnRotor]:
    if not is_solid(file):
        return _toothed(file, load_closed_curves(file, unit), np.array([0.0, 0.0, 1.0]), None)
    found = []
    for cut in load_body_sections(file, unit, SectionRequest(lobes=True)):
        if cut.teeth_extent is not None:
            width = cut.teeth_extent[1] - cut.teeth_extent[0]
            found += _toothed(file, cut.curves, cut.axis, width)[:1]
    return found


def _toothed(
    file: Path | Points, curves: Iterable[Array], axis: Array, width: float | None
) -> list[DrawnRotor]:
    curves = list(curves)
    found = []
    for place, curve in enumerate(curves):
        count = repeating_teeth(curve, FEWEST_LOBES)
        if count is not None:
            others = () if width is None else tuple(curves[:place] + curves[place + 1 :])
            found.append(DrawnRotor(file, counter_clockwise(curve), count, axis, width, others))
    return found


def size_beside(rotor: DrawnRotor, *, outside: bool) -> float | None:
    """Diameter of the rim outside or of the bore inside a rotor of a solid, None without. [m]."""
    area = shapely.Polygon(rotor.curve).area
    others = [
        polygon
        for polygon in map(shapely.Polygon, rotor.other_curves)
        if (polygon.area > area) == outside and polygon.contains(shapely.Point(*rotor.center))
    ]
    if not others:
        return None
    # a keyway or flat leaves most of the circle
    points = shapely.get_coordinates(max(others, key=lambda one: one.area).exterior)
    return 2.0 * float(np.median(np.hypot(*(points - rotor.center).T)))
