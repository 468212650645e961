"""Keys of ``[machine.rotors]`` of gerotors, and rotors from the files that they name."""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass
from functools import lru_cache
from itertools import product
from pathlib import Path
from typing import final

import numpy as np
import shapely

from toothspace.core.errors import CaseError, GeometryError, Problem
from toothspace.core.frozen import Points
from toothspace.core.keys import (
    KeyTable,
    choice,
    file_path,
    forbid,
    instead_of,
    integer,
    quantity,
    require,
    text,
)
from toothspace.core.types import Array
from toothspace.gearing.gear_tables import PROFILE_SUFFIXES
from toothspace.geometry.body_section import FEWEST_LOBES, SectionRequest
from toothspace.geometry.cad_import import is_solid, load_body_sections, load_closed_curves
from toothspace.geometry.curve import counter_clockwise
from toothspace.geometry.tooth_count import repeating_teeth

_PARALLEL = 1e-6
_LEAST_DISTANCE = 10e-6
"""Rotors drawn about one centre each are closer. [m]"""


@final
@dataclass(frozen=True, kw_only=True)
class RotorParameters(KeyTable):
    """``[machine.rotors]``: a generated pair, or two profiles from files."""

    kind: str | None = choice("Family of the profiles.", "trochoidal", "cycloidal", default=None)
    inner_tooth_count: int = integer(
        "Teeth of the inner rotor; the outer one has one more. Default that of the profiles.",
        low=3,
        high=60,
        default=0,
    )
    eccentricity: float = quantity(
        "mm",
        "Distance of the rotor centres. Default that of the profiles, drawn in one frame.",
        above=0,
        high=50,
        default=0.0,
    )
    generating_radius: float | None = quantity(
        "mm", "Radius of the lobe centres of a trochoidal pair.", above=0, high=500, default=None
    )
    lobe_radius: float | None = quantity(
        "mm", "Radius of the outer rotor's lobes of a trochoidal pair.", above=0, high=200,
        default=None,
    )  # fmt: skip
    inner_profile: Path | Points | None = file_path(
        "Closed profile of the inner rotor.", *PROFILE_SUFFIXES, points=True
    )
    outer_profile: Path | Points | None = file_path(
        "Closed profile of the outer rotor.", *PROFILE_SUFFIXES, points=True
    )
    profile_unit: str = choice("Length unit of the profiles.", "mm", "m", "um", "in", default="mm")
    face_width: float = quantity(
        "mm", "Axial width of the rotors. Default that of solids.", above=0, high=500, default=0.0
    )
    tip_clearance: float = quantity(
        "um", "Normal gap between the centred rotors at a tip pair.", low=0, high=500
    )
    tip_gap_law: str = choice(
        "Flow through the gap at a tip: between parabolic walls, or the published fit.",
        "parabolic",
        "fitted",
        default="parabolic",
    )
    shaft_diameter: float | None = quantity(
        "mm", "Bore of the inner rotor.", above=0, high=500, default=None
    )
    material: str = text("Material from the library.", default="sintered_steel")
    roughness: float = quantity(
        "um", "Root mean square roughness of flanks and faces.", low=0.01, high=10, default=0.6e-6
    )

    def __post_init__(self) -> None:
        instead_of(self, "kind", "inner_profile", "outer_profile")
        if self.kind is not None:
            missing = [n for n in ("inner_tooth_count", "eccentricity", "face_width")
                       if not getattr(self, n)]  # fmt: skip
            if missing:
                raise CaseError.of(
                    Problem(name, "nothing", "compulsory with kind") for name in missing
                )
        if self.kind == "trochoidal":
            require(self, 'with kind = "trochoidal"', "generating_radius", "lobe_radius")
        else:
            forbid(self, 'unless kind = "trochoidal"', "generating_radius", "lobe_radius")


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

    Inner rotor, and outer rotor with one tooth more.

    Raises GeometryError if the files hold no such pair.

    Parameters
    ----------
    inner, outer : Path or Points
        Files or points of the rotors; both may be one assembly.
    unit : float
        Length of one unit of the files; STEP files carry their own. [m]
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
