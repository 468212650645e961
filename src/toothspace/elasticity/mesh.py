"""Meshes of hexahedra or ten-node tetrahedra, and bodies swept along z."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
import shapely

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.elasticity.triangulation import Triangulation, triangulate

_LEVEL_STEP = 1e-9
"""Levels nearer to each other are one. [m]"""


@final
@dataclass(frozen=True)
class SolidMesh:
    """Solid mesh with its outer surface.

    ``elements`` has 8 columns (bottom then top corners, counter-clockwise seen from above) or
    10 (corners, then the middles of edges 01, 12, 02, 03, 13, 23). ``faces`` are the outer faces
    with nodes counter-clockwise seen from outside: 4 columns or 6 (corners, then middles).
    """

    nodes: Array
    elements: IntArray
    faces: IntArray

    @property
    def unknowns(self) -> int:
        """Number of displacement components. [-]."""
        return 3 * len(self.nodes)

    def face_frames(self) -> tuple[Array, Array]:
        """Centres [m] and outward normals times the area [m2] of the faces."""
        corners = 4 if self.faces.shape[1] == 4 else 3
        p = self.nodes[self.faces[:, :corners]]
        if corners == 4:
            normal = 0.5 * np.cross(p[:, 2] - p[:, 0], p[:, 3] - p[:, 1])
        else:
            normal = 0.5 * np.cross(p[:, 1] - p[:, 0], p[:, 2] - p[:, 0])
        return p.mean(axis=1), normal


@final
@dataclass(frozen=True)
class Prism:
    """Part of a body: a plane section between two levels."""

    section: shapely.Polygon
    """Outline with holes in the x y plane. [m]"""
    bottom: float
    top: float
    """Levels along z. [m]"""


def disc(radius: float, center: tuple[float, float] = (0.0, 0.0)) -> shapely.Polygon:
    """Circle as a polygon of the same area, fine enough for any mesh. [m]."""
    angle = np.linspace(0.0, 2.0 * np.pi, 1440, endpoint=False)
    step = angle[1]
    equal = radius * np.sqrt(step / np.sin(step))
    ring = np.column_stack([np.cos(angle), np.sin(angle)]) * equal + np.asarray(center)
    return shapely.Polygon(ring)


def annulus(
    inner_radius: float, outer_radius: float, center: tuple[float, float] = (0.0, 0.0)
) -> shapely.Polygon:
    """Ring between two radii. [m]."""
    return disc(outer_radius, center).difference(disc(inner_radius, center))


def sweep(parts: tuple[Prism, ...], edge_length: float, layer_height: float) -> SolidMesh:
    """Hexahedra of a body made of prisms.

    Parameters
    ----------
    parts : tuple of Prism
        Parts of the body; where they touch they are one.
    edge_length : float
        Edge of the plane triangles; each is cut into three quadrilaterals. [m]
    layer_height : float
        Largest height of a layer. [m]

    Returns
    -------
    Mesh
        Hexahedra; all section boundaries are met.

    Raises
    ------
    GeometryError
        If there are no parts or the sections are empty.
    """
    if not parts:
        raise GeometryError("elastic body", "no parts", "are one or more prisms")
    plane = triangulate([part.section for part in parts], edge_length)
    points, quads = _quadrilaterals(plane)
    # layers between the ends of the parts, no higher than asked for
    given = np.unique(np.round([v for p in parts for v in (p.bottom, p.top)], 9))
    kept = given[np.concatenate([[True], np.diff(given) > _LEVEL_STEP])]
    counts = [max(1, int(np.ceil(step / layer_height - 1e-9))) for step in np.diff(kept)]
    pieces = [
        np.linspace(low, high, count + 1)[:-1]
        for low, high, count in zip(kept[:-1], kept[1:], counts, strict=True)
    ]
    levels = np.concatenate([*pieces, kept[-1:]])
    active = _active(parts, points[quads].mean(axis=1), 0.5 * (levels[1:] + levels[:-1]))
    count = len(points)
    layer, cell = np.nonzero(active)
    low = quads[cell] + layer[:, None] * count
    elements = np.hstack([low, low + count])
    nodes = np.column_stack([np.tile(points, (len(levels), 1)), np.repeat(levels, count)])
    used, index = np.unique(elements, return_inverse=True)
    elements = index.reshape(-1, 8).astype(np.int64)
    return SolidMesh(nodes[used], elements, outer_faces(elements, _HEX_FACES))


def _quadrilaterals(plane: Triangulation) -> tuple[Array, IntArray]:
    """Cut every triangle at its centre and the middles of its edges."""
    points, triangles = plane
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, index = np.unique(sides, axis=0, return_inverse=True)
    middle = len(points) + index.reshape(-1, 3)
    centre = len(points) + len(edges) + np.arange(len(triangles))
    nodes = np.vstack([points, points[edges].mean(axis=1), points[triangles].mean(axis=1)])
    quads = [
        np.column_stack([triangles[:, k], middle[:, k], centre, middle[:, k - 1]]) for k in range(3)
    ]
    return nodes, np.vstack(quads).astype(np.int64)


def _active(parts: tuple[Prism, ...], centres: Array, heights: Array) -> BoolArray:
    """Cells (layer, quadrilateral) that are solid."""
    active = np.zeros((len(heights), len(centres)), dtype=bool)
    for part in parts:
        inside = shapely.contains_xy(part.section, centres[:, 0], centres[:, 1])
        between = (heights > part.bottom) & (heights < part.top)
        active |= between[:, None] & inside[None, :]
    return active


_HEX_FACES = ((0, 3, 2, 1), (4, 5, 6, 7), (0, 1, 5, 4), (1, 2, 6, 5), (2, 3, 7, 6), (3, 0, 4, 7))
_TET_FACES = ((0, 2, 1, 6, 5, 4), (0, 1, 3, 4, 8, 7), (1, 2, 3, 5, 9, 8), (0, 3, 2, 7, 9, 6))


def outer_faces(elements: IntArray, local: tuple[tuple[int, ...], ...]) -> IntArray:
    """Faces that belong to one element only."""
    faces = np.vstack([elements[:, list(face)] for face in local])
    corners = 4 if faces.shape[1] == 4 else 3
    key = np.sort(faces[:, :corners], axis=1)
    _, first, counts = np.unique(key, axis=0, return_index=True, return_counts=True)
    return np.asarray(faces[np.sort(first[counts == 1])], dtype=np.int64)


def tetrahedral_mesh(nodes: Array, elements: IntArray) -> SolidMesh:
    """Mesh of ten-node tetrahedra, as read from a file; corners right-handed."""
    return SolidMesh(nodes, elements, outer_faces(elements, _TET_FACES))
