"""Meshes of hexahedra or ten-node tetrahedra: triangulated sections swept along z, STEP files."""

from __future__ import annotations

import hashlib
import subprocess
import sys
import tempfile
from collections.abc import Sequence
from dataclasses import dataclass
from importlib.util import find_spec
from itertools import pairwise
from pathlib import Path
from typing import NamedTuple, final

import numpy as np
import scipy
import shapely

from toothspace.core.errors import GeometryError
from toothspace.core.processes import program_named
from toothspace.core.types import Array, IntArray

_SNAP = 1e-6
"""Distance over the edge length at which boundaries are taken as one. [-]"""

_BORDER = 0.62
"""Smallest distance of inner points from the boundary over the edge length. [-]"""

_SMOOTHING = 6
_MAX_SPLITS = 40


@final
class Triangulation(NamedTuple):
    """Triangles of a plane region."""

    points: Array  # (points, 2) [m]
    triangles: IntArray  # (triangles, 3) counter-clockwise


def triangulate(
    regions: list[shapely.Polygon], edge_length: float, chord: float = 0.02
) -> Triangulation:
    """Triangulate the union of regions; the boundary of each region becomes edges.

    Points and counter-clockwise triangles.

    Raises GeometryError if the regions are empty or the edges are too long for them.

    Parameters
    ----------
    regions : list of Polygon
        Plane regions; they may overlap or lie inside one another. [m]
    edge_length : float
        Target length of the edges. [m]
    chord : float
        Largest distance of the boundary from its chords over the edge length. [-]

    Notes
    -----
    Boundary edges are split until the circle over each of them is empty, so that they are edges
    of the Delaunay triangulation; inner points start on a triangular lattice and are smoothed.
    """
    whole = shapely.union_all(regions)
    if whole.is_empty or not edge_length > 0.0:
        raise GeometryError("elastic body", "an empty section", "are closed outlines")
    boundary, edges = _boundary_points(regions, edge_length, chord)
    border = shapely.linestrings(boundary[edges])
    left, low, right, high = whole.bounds
    rise = edge_length * np.sqrt(0.75)
    rows = np.arange(low + 0.37 * rise, high, rise)
    x = np.arange(left - edge_length, right + edge_length, edge_length)
    grid = np.array([(u + 0.5 * edge_length * (k % 2), v) for k, v in enumerate(rows) for u in x])
    if grid.size == 0:
        inner = np.empty((0, 2))
    else:
        grid = grid[shapely.contains_xy(whole, grid[:, 0], grid[:, 1])]
        far = (
            shapely.distance(shapely.points(grid), shapely.union_all(border))
            > _BORDER * edge_length
        )
        inner = np.asarray(grid[far], dtype=float)
    boundary, edges, inner = _clear_edges(boundary, edges, inner)
    for _ in range(_SMOOTHING if len(inner) else 0):
        # move inner points to the mean of their neighbours
        points = np.vstack([boundary, inner])
        start, neighbours = scipy.spatial.Delaunay(points).vertex_neighbor_vertices
        sums = np.add.reduceat(points[neighbours], start[:-1], axis=0)
        mean = sums / np.diff(start)[:, None]
        inner = np.asarray(mean[len(boundary) :], dtype=float)
        _, _, inner = _clear_edges(boundary, edges, inner, split=False)
    points = np.vstack([boundary, inner])
    # triangles whose centre is in the region, counter-clockwise, without slivers
    simplices = scipy.spatial.Delaunay(points).simplices
    centre = points[simplices].mean(axis=1)
    kept = simplices[shapely.contains_xy(whole, centre[:, 0], centre[:, 1])]
    a, b, c = (points[kept[:, k]] for k in range(3))
    double = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    kept = np.where(double[:, None] > 0.0, kept, kept[:, [0, 2, 1]])
    longest = np.maximum(np.hypot(*(b - a).T), np.hypot(*(c - a).T))
    triangles = np.asarray(kept[np.abs(double) > 1e-6 * longest**2], dtype=np.int64)
    used, index = np.unique(triangles, return_inverse=True)
    if used.size < 3:
        raise GeometryError(
            "elastic body",
            f"an element size of {edge_length:.3g} m",
            "are sizes that resolve the section",
        )
    return Triangulation(points[used], index.reshape(-1, 3).astype(np.int64))


def _boundary_points(
    regions: list[shapely.Polygon], edge: float, chord: float
) -> tuple[Array, IntArray]:
    """Points on all boundaries and the edges between them."""
    lines = shapely.union_all([r.boundary for r in regions], grid_size=_SNAP * edge)
    pieces = shapely.get_parts(shapely.line_merge(lines))
    pieces = shapely.simplify(pieces, chord * edge, preserve_topology=True)
    points: list[Array] = []
    edges: list[IntArray] = []
    start = 0
    for piece in pieces:
        line = np.asarray(piece.coords)[:, :2]
        out = [line[:1]]
        for begin, last in pairwise(line):
            parts_of = max(1, int(np.ceil(np.hypot(*(last - begin)) / edge - 1e-9)))
            parts = np.linspace(0.0, 1.0, parts_of + 1)[1:, None]
            out.append(begin + parts * (last - begin))
        chain = np.vstack(out)
        count = len(chain)
        points.append(chain)
        first = np.arange(start, start + count - 1)
        edges.append(np.column_stack([first, first + 1]))
        start += count
    stacked = np.vstack(points)
    _, kept, index = np.unique(
        np.round(stacked / (1e-6 * edge)).astype(np.int64),
        axis=0,
        return_index=True,
        return_inverse=True,
    )
    joined = np.sort(index.ravel()[np.vstack(edges).astype(np.int64)], axis=1)
    joined = np.unique(joined[joined[:, 0] != joined[:, 1]], axis=0)
    return stacked[kept], joined.astype(np.int64)


def _clear_edges(
    boundary: Array, edges: IntArray, inner: Array, *, split: bool = True
) -> tuple[Array, IntArray, Array]:
    """Drop inner points from the circles over the edges; split edges near other boundaries."""
    for _ in range(_MAX_SPLITS):
        middle = boundary[edges].mean(axis=1)
        radius = 0.5 * np.hypot(*(boundary[edges[:, 0]] - boundary[edges[:, 1]]).T)
        if len(inner):
            hits = scipy.spatial.cKDTree(inner).query_ball_point(middle, 1.001 * radius)
            dropped = np.unique(np.concatenate([np.asarray(h, dtype=int) for h in hits]))
            inner = np.delete(inner, dropped, axis=0)
        if not split:
            break
        counts = scipy.spatial.cKDTree(boundary).query_ball_point(middle, (1.0 - 1e-9) * radius)
        crowded = np.array(
            [bool(set(near) - set(edge)) for near, edge in zip(counts, edges.tolist(), strict=True)]
        )
        if not crowded.any():
            break
        added = boundary[edges[crowded]].mean(axis=1)
        index = len(boundary) + np.arange(len(added))
        first = np.column_stack([edges[crowded, 0], index])
        second = np.column_stack([index, edges[crowded, 1]])
        boundary, edges = np.vstack([boundary, added]), np.vstack([edges[~crowded], first, second])
    return boundary, edges, inner


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
    corners, triangles = plane
    sides = np.sort(triangles[:, [[0, 1], [1, 2], [2, 0]]].reshape(-1, 2), axis=1)
    edges, index = np.unique(sides, axis=0, return_inverse=True)
    middle = len(corners) + index.reshape(-1, 3)
    centre = len(corners) + len(edges) + np.arange(len(triangles))
    nodes = np.vstack([corners, corners[edges].mean(axis=1), corners[triangles].mean(axis=1)])
    cut = [
        np.column_stack([triangles[:, k], middle[:, k], centre, middle[:, k - 1]]) for k in range(3)
    ]
    points, quads = nodes, np.vstack(cut).astype(np.int64)
    # layers between the ends of the parts, no higher than asked for
    given = np.unique(np.round([v for p in parts for v in (p.bottom, p.top)], 9))
    kept = given[np.concatenate([[True], np.diff(given) > _LEVEL_STEP])]
    counts = [max(1, int(np.ceil(step / layer_height - 1e-9))) for step in np.diff(kept)]
    pieces = [
        np.linspace(low, high, count + 1)[:-1]
        for low, high, count in zip(kept[:-1], kept[1:], counts, strict=True)
    ]
    levels = np.concatenate([*pieces, kept[-1:]])
    # cells (layer, quadrilateral) that are solid
    centres = points[quads].mean(axis=1)
    heights = 0.5 * (levels[1:] + levels[:-1])
    active = np.zeros((len(heights), len(centres)), dtype=bool)
    for part in parts:
        inside = shapely.contains_xy(part.section, centres[:, 0], centres[:, 1])
        between = (heights > part.bottom) & (heights < part.top)
        active |= between[:, None] & inside[None, :]
    count = len(points)
    layer, cell = np.nonzero(active)
    low = quads[cell] + layer[:, None] * count
    elements = np.hstack([low, low + count])
    nodes = np.column_stack([np.tile(points, (len(levels), 1)), np.repeat(levels, count)])
    used, index = np.unique(elements, return_inverse=True)
    elements = index.reshape(-1, 8).astype(np.int64)
    return SolidMesh(nodes[used], elements, outer_faces(elements, _HEX_FACES))


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


_STEP_UNIT = 1e-3
_TETRAHEDRON, _NODES = 11, 10
_LIMIT = 600.0
"""Longest time that the mesher may take. [s]"""

# the last two edges of a tetrahedron stand in the other order in these files
_ORDER = (0, 1, 2, 3, 4, 5, 6, 7, 9, 8)


_GMSH = "import sys, gmsh; gmsh.initialize(sys.argv, run=True); gmsh.finalize()"
"""The program of the extra, whose own script asks for whatever Python comes first on the path."""


def mesher() -> list[str]:
    """Command that starts ``gmsh``: that of the extra, or one on the path; empty without."""
    if find_spec("gmsh") is not None:
        return [sys.executable, "-P", "-c", _GMSH]
    program = program_named("gmsh")
    return [program] if program else []


@final
@dataclass(frozen=True)
class SolidFile:
    """Body of a STEP file, as ten-node tetrahedra.

    The file is in millimetres and in the frame of the body: for a bearing z = 0 on its film face,
    for a gear in the middle of its face width.
    """

    path: Path
    """STEP file with one body."""
    edge_length: float
    """Longest edge of the tetrahedra. [m]"""
    named_by: str = ""
    """Key of the case that names the file, for messages."""

    @property
    def label(self) -> str:
        """What the body is called in messages."""
        return f"{self.named_by}: {self.path.name}" if self.named_by else str(self.path)

    def mesh(self, scale: float = 1.0) -> SolidMesh:
        """Tetrahedra; elements larger by a factor.

        Raises
        ------
        GeometryError
            If the file or the program ``gmsh`` is missing or the body cannot be meshed.
        """
        if not self.path.is_file():
            raise GeometryError(self.label, "no file", "is a STEP file")
        program = mesher()
        if not program:
            raise GeometryError(
                self.label,
                "no program gmsh",
                'with it on the path (pip install "toothspace[bodies]")',
            )
        with tempfile.TemporaryDirectory() as folder:
            text = self._meshed(program, Path(folder), scale * self.edge_length / _STEP_UNIT)
        # nodes and tetrahedra of a mesh file of version 2
        lines = text.splitlines()
        nodes = np.array([line.split() for line in _block(lines, "Nodes")], dtype=float)
        rows = [line.split() for line in _block(lines, "Elements")]
        solid = [row[-_NODES:] for row in rows if int(row[1]) == _TETRAHEDRON]
        if not solid:
            raise GeometryError(self.label, "no body", "is one closed solid")
        number = np.full(int(nodes[:, 0].max()) + 1, -1, dtype=np.int64)
        number[nodes[:, 0].astype(np.int64)] = np.arange(len(nodes))
        elements = number[np.array(solid, dtype=np.int64)][:, _ORDER]
        used, index = np.unique(elements, return_inverse=True)
        return tetrahedral_mesh(
            (_STEP_UNIT * nodes[:, 1:4])[used], index.reshape(elements.shape).astype(np.int64)
        )

    def _meshed(self, program: Sequence[str], folder: Path, size: float) -> str:
        """Mesh file of version 2, as text."""
        target = folder / "body.msh"
        command = [*program, str(self.path.resolve()), "-3", "-order", "2", "-format", "msh22"]
        sizes = ["-clmax", f"{size:.9g}", "-clmin", f"{0.2 * size:.9g}"]
        straight = ["-setnumber", "Mesh.SecondOrderLinear", "1", "-setnumber", "Mesh.Binary", "0"]
        try:
            subprocess.run(
                [*command, *sizes, *straight, "-v", "1", "-o", str(target)],
                check=True,
                capture_output=True,
                timeout=_LIMIT,
                cwd=folder,
            )
        except (subprocess.SubprocessError, OSError) as error:
            raise GeometryError(
                self.label, "a body that gmsh cannot mesh", "are closed solids"
            ) from error
        if not target.is_file():
            raise GeometryError(self.label, "no body", "is one closed solid")
        return target.read_text()

    def key(self) -> tuple[object, ...]:
        """Everything that defines the shape: the content of the file, not its name."""
        content = self.path.read_bytes() if self.path.is_file() else b""
        return ("solid", hashlib.sha256(content).hexdigest(), self.edge_length)


def _block(lines: list[str], name: str) -> list[str]:
    """Lines of a section without its count."""
    start = lines.index(f"${name}") + 2
    return lines[start : lines.index(f"$End{name}")]
