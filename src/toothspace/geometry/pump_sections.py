"""Casing and bearing faces of a pump in a solid file: cavity round the gears, recesses, frame."""

from __future__ import annotations

from collections.abc import Iterable, Sequence
from dataclasses import dataclass
from functools import reduce
from typing import Any, final

import numpy as np
import shapely

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array
from toothspace.geometry.body_section import BodySection, axis_frame
from toothspace.geometry.curve import checked_polygon
from toothspace.geometry.gear_finder import FoundGear

_LEAST_TOWARDS = 0.5
_LEVEL = 1e-6
_LEAST_AREA = 1e-8
"""Smaller recesses are marks of the section, not grooves. [m2]"""


@final
@dataclass(frozen=True)
class MachineFrame:
    """Frame of an external gear machine within a file."""

    origin: Array
    """Centre of the drive gear in the middle of its teeth. Shape (3,). [m]"""
    rows: Array
    """x towards the outlet, y towards the driven gear, z along the axis. Shape (3, 3)."""

    @property
    def height(self) -> float:
        """Height of the middle of the teeth in the file along z. [m]."""
        return float(self.rows[2] @ self.origin)

    def curves(self, cut: BodySection) -> list[Array]:
        """Curves of a section across the axis, in this frame. [m]."""
        frame = axis_frame(cut.axis)
        placed = [np.column_stack([c, np.full(len(c), cut.height)]) @ frame for c in cut.curves]
        return [(points - self.origin) @ self.rows[:2].T for points in placed]


OWN_FRAME = MachineFrame(np.zeros(3), np.eye(3))
"""Frame of a file that is drawn in the frame of the machine, faces at z = 0."""


def machine_frame(drive: FoundGear, driven: FoundGear, outlet: Array) -> MachineFrame:
    """Frame of two gears in one file.

    Raises GeometryError if the direction does not lead across the centre line.

    Parameters
    ----------
    drive, driven : FoundGear
        Gears on parallel axes.
    outlet : ndarray, shape (3,)
        Unit vector in the file from the centre line towards the outlet. [-]
    """
    between = driven.center - drive.center
    up = between - drive.axis * (between @ drive.axis)
    up /= np.linalg.norm(up)
    across = np.cross(up, drive.axis)
    along = float(across @ outlet)
    if abs(along) < _LEAST_TOWARDS:
        named = ", ".join(f"{value:.3g}" for value in across)
        raise GeometryError(
            "outlet_toward",
            "a direction along the centre line or the axis",
            f"one across both, near ({named}) or its opposite",
        )
    across *= np.sign(along)
    return MachineFrame(drive.center, np.vstack([across, up, np.cross(across, up)]))


def casing_cavity(curves: Sequence[Array], key: str) -> Array:
    """Outline of the space round the gears in a section of the casing.

    Bores and what opens to them; passages to the outside end on the convex hull, shape (n, 2). [m]

    Raises GeometryError if the casing does not surround the drive gear.

    Parameters
    ----------
    curves : sequence of ndarray
        Curves of the section, drive gear at the origin. [m]
    key : str
        Name for error messages.
    """
    material = _material(curves)
    # a hull that touches the outer walls would leave slivers along them
    void = shapely.convex_hull(material).buffer(-_LEVEL, join_style="mitre").difference(material)
    around = [part for part in _polygons(void) if part.contains(shapely.Point(0.0, 0.0))]
    if not around:
        raise GeometryError(
            key,
            "a section that does not surround the drive gear",
            "a body with the bores of the gears",
        )
    return checked_polygon(shapely.get_coordinates(around[0].exterior)[:-1], key)


def face_recesses(
    face: Sequence[Array], behind: Sequence[Array], gears: Iterable[tuple[Array, float, float]]
) -> list[Array]:
    """Outlines of the recesses in a face beside the gears.

    Recesses that reach the teeth: material behind the face that it lacks, and passages through both
    layers but the bores of the shafts. [m]

    Parameters
    ----------
    face, behind : sequence of ndarray
        Curves of sections through the layer at the face and through the one that follows, which
        may be empty. [m]
    gears : iterable of tuple
        Centre, shaft radius and tip radius of each gear. [m]
    """
    lacking = _material(face)
    deeper = _material(behind)
    gears = list(gears)
    holes = [
        hole
        for part in _polygons(lacking)
        for hole in (shapely.Polygon(ring) for ring in part.interiors)
        if not any(hole.contains(shapely.Point(*center)) for center, _, _ in gears)
    ]
    recesses = shapely.union_all([deeper.difference(lacking), *holes])
    teeth = shapely.union_all(
        [
            shapely.Point(*center).buffer(tip).difference(shapely.Point(*center).buffer(shaft))
            for center, shaft, tip in gears
        ]
    )
    found = [part for part in _polygons(recesses) if part.intersection(teeth).area > _LEAST_AREA]
    return [checked_polygon(shapely.get_coordinates(p.exterior)[:-1], "recess") for p in found]


def _material(curves: Sequence[Array]) -> Any:
    # inside an odd number of curves
    areas = [shapely.make_valid(shapely.Polygon(curve)) for curve in curves]
    return reduce(shapely.symmetric_difference, areas, shapely.Polygon())


def _polygons(shape: Any) -> list[Any]:
    parts = shapely.get_parts(shape)
    return [part for part in parts if part.geom_type == "Polygon" and part.area > _LEAST_AREA]
