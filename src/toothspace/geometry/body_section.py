"""Solid bodies as closed triangle meshes, their axes, and sections across the teeth."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field, replace
from itertools import pairwise, product
from typing import NamedTuple, final

import numpy as np
import scipy
import shapely
from numpy.typing import NDArray

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array
from toothspace.geometry.curve import chord_heights, signed_area, without_repeats
from toothspace.geometry.involute_gear import MIN_TOOTH_COUNT
from toothspace.geometry.tooth_count import repeating_teeth

_Faces = NDArray[np.int64]

_ONE_POINT = 1e-9
"""Distance up to which points of a section are one. [m]"""
_UPRIGHT = 0.3
"""Largest slope of a facet along the axis on a meshed cylinder surface. [-]"""
_CHAIN_DISTANCE = 3.0
"""Of the chord height: lower and upper corners this close lie on one cylinder surface. [-]"""
_SNAP = np.deg2rad(0.2)
_FLAT = 1e-7
"""Of 1: how far the cosine between a flat face's normal and the axis may be off. [-]"""
_LEVEL = 1e-6
"""Flat faces this close along the axis are one. [m]"""
_LEAST_FACE = 1e-4
"""Of the surface of the body: smaller flat faces do not count. [-]"""


@final
@dataclass(frozen=True)
class SurfaceMesh:
    """Triangles of one body."""

    vertices: Array
    """Corners, each once. Shape (n, 3). [m]"""
    faces: _Faces
    """Corners of the triangles, counter-clockwise seen from outside. Shape (m, 3)."""

    @property
    def volume(self) -> float:
        """Volume inside the triangles [m3]."""
        a, b, c = (self.vertices[self.faces[:, k]] for k in range(3))
        return abs(float(np.sum(a * np.cross(b, c)))) / 6.0

    @property
    def is_closed(self) -> bool:
        """Whether every edge joins two triangles, or four where the surface touches itself."""
        pairs = np.sort(self.faces[:, [0, 1, 1, 2, 2, 0]].reshape(-1, 2), axis=1)
        _, counts = np.unique(
            pairs[:, 0] * np.int64(len(self.vertices)) + pairs[:, 1], return_counts=True
        )
        return bool(np.all(counts % 2 == 0))

    def extent(self, axis: Array) -> tuple[float, float]:
        """Range of the body along a unit vector [m]."""
        along = self.vertices @ axis
        return float(along.min()), float(along.max())


def merged(triangles: Array, tolerance: float) -> SurfaceMesh:
    """Surface mesh of loose triangles, corners within a tolerance being one.

    Parameters
    ----------
    triangles : ndarray, shape (m, 3, 3)
        Corners. [m]
    tolerance : float
        Distance up to which corners are one, 0 for equal corners only. [m]
    """
    corners = np.ascontiguousarray(triangles.reshape(-1, 3)) + 0.0
    rows = corners.view([("", float)] * 3).ravel()
    _, first, number = np.unique(rows, return_index=True, return_inverse=True)
    vertices = corners[first]
    if tolerance > 0.0:
        # the first point of every cluster, and the cluster of every point
        pairs = scipy.spatial.cKDTree(vertices).query_pairs(tolerance, output_type="ndarray")
        size = len(vertices)
        graph = scipy.sparse.coo_array(
            (np.ones(len(pairs), dtype=bool), pairs.T), shape=(size, size)
        )
        count, label = scipy.sparse.csgraph.connected_components(graph, directed=False)
        representative = np.full(count, size)
        np.minimum.at(representative, label, np.arange(size))
        vertices, joined = vertices[representative], label.astype(np.int64)
        number = joined[number]
    faces = number.reshape(-1, 3)
    distinct = (
        (faces[:, 0] != faces[:, 1]) & (faces[:, 1] != faces[:, 2]) & (faces[:, 2] != faces[:, 0])
    )
    return SurfaceMesh(vertices, faces[distinct])


def separated(mesh: SurfaceMesh) -> list[SurfaceMesh]:
    """Bodies of a mesh that do not touch one another, largest volume first."""
    a, b = mesh.faces[:, [0, 1]].T, mesh.faces[:, [1, 2]].T
    rows, columns = np.concatenate([a[0], b[0]]), np.concatenate([a[1], b[1]])
    size = len(mesh.vertices)
    graph = scipy.sparse.coo_array(
        (np.ones(len(rows), dtype=bool), (rows, columns)), shape=(size, size)
    )
    count, label = scipy.sparse.csgraph.connected_components(graph, directed=False)
    if count == 1:
        return [mesh]
    owner = label[mesh.faces[:, 0]]
    bodies = []
    for number in range(count):
        faces = mesh.faces[owner == number]
        if len(faces) == 0:
            continue
        used, packed = np.unique(faces, return_inverse=True)
        bodies.append(SurfaceMesh(mesh.vertices[used], packed.reshape(-1, 3)))
    return sorted(bodies, key=lambda body: -body.volume)


def section(mesh: SurfaceMesh, frame: Array, height: float) -> list[Array]:
    """Cut a closed mesh with a plane.

    Closed curves, shape (n, 2). Where the surface runs parallel to the normal, the points are
    corners of the mesh, which lie on the surface that was meshed, instead of places inside its
    facets. [m]

    Parameters
    ----------
    mesh : SurfaceMesh
        Closed body.
    frame : ndarray, shape (3, 3)
        Rows: x and y direction of the section and its normal.
    height : float
        Distance of the plane from the origin along the normal. [m]
    """
    local = mesh.vertices @ frame.T
    above = local[:, 2] > height
    side = above[mesh.faces]
    crossing = np.flatnonzero(side.any(axis=1) & ~side.all(axis=1))
    if len(crossing) == 0:
        return []
    faces, side = mesh.faces[crossing], side[crossing]
    # two edges of every crossing face are cut: those at the corner that lies alone
    alone = np.where(side.sum(axis=1) == 1, side.argmax(axis=1), (~side).argmax(axis=1))
    rows = np.arange(len(faces))
    tip = faces[rows, alone]
    ends = np.column_stack([faces[rows, (alone + 1) % 3], faces[rows, (alone + 2) % 3]])
    pairs = np.sort(np.stack([np.column_stack([tip, ends[:, k]]) for k in (0, 1)], axis=1), axis=2)
    edges, number = np.unique(pairs.reshape(-1, 2), axis=0, return_inverse=True)
    a, b, c = (local[faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    upright = np.abs(normal[:, 2]) <= _UPRIGHT * np.linalg.norm(normal, axis=1)
    curves = []
    for loop, along in _loops(number.reshape(-1, 2)):
        curve = _corner_chain(local, edges[loop], above) if upright[along].all() else None
        if curve is None:
            first, second = (local[edges[loop, k]] for k in (0, 1))
            share = (height - first[:, 2]) / (second[:, 2] - first[:, 2])
            cut = (first + share[:, None] * (second - first))[:, :2]
            curve = without_repeats(cut, _ONE_POINT)
        curves.append(curve)
    return [curve for curve in curves if len(curve) >= 3]


def axis_frame(axis: Array) -> Array:
    """Right-handed frame whose third row is the unit vector along an axis.

    Rows x, y, normal; the frame of the file for the z axis, y and z for the x axis, z and x for the
    y axis, shape (3, 3).

    Parameters
    ----------
    axis : ndarray, shape (3,)
        Direction, any length. [-]
    """
    normal = np.asarray(axis, dtype=float) / np.linalg.norm(axis)
    main = int(np.argmax(np.abs(normal)))
    first = np.eye(3)[(main + 1) % 3]
    first -= normal * (first @ normal)
    first /= np.linalg.norm(first)
    return np.vstack([first, np.cross(normal, first), normal])


def flat_levels(mesh: SurfaceMesh, axis: Array) -> list[float]:
    """Heights of the ends of a body and of its flat faces across an axis, ascending. [m]."""
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    doubled = np.cross(b - a, c - a)
    area = np.linalg.norm(doubled, axis=1)
    flat = np.abs(doubled @ axis) > (1.0 - _FLAT) * area
    cells = np.round((a @ axis)[flat] / _LEVEL).astype(np.int64)
    levels, number = np.unique(cells, return_inverse=True)
    large = np.bincount(number, area[flat], len(levels)) > _LEAST_FACE * area.sum()
    ends = np.round(np.array(mesh.extent(axis)) / _LEVEL).astype(np.int64)
    return [float(level) * _LEVEL for level in np.union1d(levels[large], ends)]


def likely_axes(mesh: SurfaceMesh) -> list[Array]:
    r"""Directions that may be the axis of a body with teeth, best first.

    Unit vectors [-]: the direction that differs from the two others in the area of the surface
    facing it, which repeated teeth make equal; then z, x and y.

    Parameters
    ----------
    mesh : SurfaceMesh
        One body.

    Notes
    -----
    The tensor :math:`\sum A\, n n^T` of a surface with an axis of threefold or higher symmetry
    has two equal eigenvalues; the eigenvector of the third is the axis.
    """
    a, b, c = (mesh.vertices[mesh.faces[:, k]] for k in range(3))
    normal = np.cross(b - a, c - a)
    area = np.maximum(np.linalg.norm(normal, axis=1), 1e-300)
    values, vectors = np.linalg.eigh((normal / area[:, None]).T @ normal)
    unique = 0 if values[1] - values[0] > values[2] - values[1] else 2
    found = vectors[:, unique]
    found = found * np.sign(found[np.argmax(np.abs(found))])
    main = np.eye(3)[np.argmax(np.abs(found))]
    if np.linalg.norm(np.cross(found, main)) < _SNAP:
        found = main
    others = [axis for axis in np.eye(3)[[2, 0, 1]] if abs(axis @ found) < 1.0 - 1e-12]
    return [found, *others]


def _loops(faces: NDArray[np.int64]) -> list[tuple[list[int], list[int]]]:
    # closed chains of cut edges, each face joining two of them; edges and faces along each
    neighbours: dict[int, list[tuple[int, int]]] = {}
    for face, (first, second) in enumerate(faces.tolist()):
        neighbours.setdefault(first, []).append((face, second))
        neighbours.setdefault(second, []).append((face, first))
    used: set[int] = set()
    loops = []
    for start in neighbours:
        edges, along, at = [start], [], start
        while True:
            ahead = next((step for step in neighbours[at] if step[0] not in used), None)
            if ahead is None:
                break
            used.add(ahead[0])
            along.append(ahead[0])
            at = ahead[1]
            edges.append(at)
        if along:
            loops.append((edges[:-1], along))
    return loops


def _corner_chain(local: Array, edges: NDArray[np.int64], above: NDArray[np.bool_]) -> Array | None:
    # lower or upper ends of the cut edges, whichever are more, if both lie on one curve
    upper = above[edges[:, 0]]
    chains = [np.where(upper, edges[:, k], edges[:, 1 - k]) for k in (0, 1)]
    fewer, more = sorted(
        (without_repeats(local[chain, :2], _ONE_POINT) for chain in chains), key=len
    )
    if len(fewer) < 3:
        return None
    if not shapely.LinearRing(more).is_simple:
        fewer, more = more, fewer
    if not shapely.LinearRing(more).is_simple:
        return None
    reach = _CHAIN_DISTANCE * chord_heights(more).max(initial=0.0) + 1e-9
    ring = shapely.LinearRing(more)
    # prepared, it looks for near edges in a tree, not at all of them
    shapely.prepare(ring)
    return more if shapely.dwithin(ring, shapely.points(fewer), reach).all() else None


FEWEST_LOBES = 3
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
_MOST_LAYERS = 24
_THINNEST = 4e-6
"""Thinner layers are edges, not parts of a body. [m]"""
_QUICK_LOOK = (0.02, 0.5, 0.98)
_SECOND = 0.2
"""Of the toothed length, from its begin: place of the second section. [-]"""


class _Look(NamedTuple):
    fewest: int
    """Teeth."""
    bores: bool
    """Whether a hole with teeth counts where the outline has none."""


_LOOKS_FOR_TEETH = _Look(MIN_TOOTH_COUNT, bores=False), _Look(MIN_TOOTH_COUNT, bores=True)
_LOOKS_FOR_LOBES = (_Look(FEWEST_LOBES, bores=True),)


@final
@dataclass(frozen=True)
class SectionRequest:
    """What to cut out of a solid file."""

    axis: str | tuple[float, float, float] | None = None
    """``x``, ``y``, ``z`` or a unit vector; None: the axis of symmetry where teeth are wanted, else
    z.
    """
    plane: float | None = None
    """Height of the section along the axis; None: middle of the teeth or of the body. [m]"""
    body: int | None = None
    """Number of one body, the largest is 0; None for all."""
    part: str | None = None
    """Name of one body; None for all."""
    teeth: bool = False
    """Whether to look for teeth, on bores only of bodies that have none outside."""
    lobes: bool = False
    """Whether to look for three and more teeth, also on holes, as of gerotor rotors."""
    layer: str | None = None
    """Layer of a DXF file; None for all."""
    face_towards: float | None = None
    """Height towards which a body turns its face: in place of one section, one through the layer
    behind that face and one through the layer that follows, between flat faces across the axis. [m]
    """
    left_out: tuple[tuple[str, int], ...] = ()
    """Names of files and numbers of bodies in them that do not belong to the machine."""
    missed: bool = False
    """Whether bodies that the plane does not meet are cut at their middle."""


@final
@dataclass(frozen=True)
class SolidBody:
    """One body of a file."""

    name: str
    """Name in the file, empty without."""
    mesh: SurfaceMesh
    """Its surface, for a STEP body a coarse one."""
    cut: Callable[[Array, float], list[Array]]
    """Section curves for a frame and a height, as in ``mesh_section.section``."""


@final
@dataclass(frozen=True)
class BodySection:
    """Section of one body."""

    body: int
    """Number of the body, the largest is 0."""
    name: str
    """Its name in the file, empty without."""
    axis: Array
    """Unit vector normal to the section. Shape (3,)."""
    height: float
    """Distance of the plane from the origin along the axis. [m]"""
    extent: tuple[float, float]
    """Range of the body along the axis. [m]"""
    teeth_extent: tuple[float, float] | None
    """Range along the axis in which the section has teeth; None if it was not looked for or none
    was found. [m]
    """
    curves: list[Array]
    """Closed curves, shape (n, 2), in the frame of ``axis_frame``, largest first. [m]"""
    second_height: float = 0.0
    """Height of a second section through the teeth. [m]"""
    second: list[Array] = field(default_factory=list)
    """Its curves, on the mesh of the body, largest first. [m]"""
    layer: tuple[float, float] | None = None
    """Flat faces between which the section was cut. [m]"""


def cut_bodies(file: str, bodies: list[SolidBody], request: SectionRequest) -> list[BodySection]:
    """Cut the bodies of a file.

    One for each body that the plane meets, largest volume first.

    Raises GeometryError for an unknown body or part, or a plane outside all bodies.

    Parameters
    ----------
    file : str
        Name of the file for error messages.
    bodies : list of SolidBody
        Bodies in any order.
    """
    ordered = sorted(bodies, key=lambda body: -body.mesh.volume)
    if not ordered:
        raise GeometryError(file, "no body", "at least one closed body")
    if request.part is not None:
        names = [body.name for body in ordered]
        if request.part not in names:
            known = ", ".join(repr(name) for name in dict.fromkeys(names) if name) or "no names"
            raise GeometryError(file, f"no body named {request.part!r}", known)
        numbers = [k for k, name in enumerate(names) if name == request.part]
    elif request.body is None:
        numbers = list(range(len(ordered)))
    else:
        if not 0 <= request.body < len(ordered):
            raise GeometryError(file, f"body = {request.body}", f"0 to {len(ordered) - 1}")
        numbers = [request.body]
    found = [cut for number in numbers for cut in _cuts(number, ordered[number], request)]
    sections = [cut for cut in found if cut.curves]
    if not sections:
        low = min(cut.extent[0] for cut in found) * 1e3
        high = max(cut.extent[1] for cut in found) * 1e3
        plane = "" if request.plane is None else f" = {request.plane * 1e3:.5g} mm"
        raise GeometryError(file, f"plane_z{plane}", f"{low:.5g} to {high:.5g} mm")
    return sections


def _cuts(number: int, body: SolidBody, request: SectionRequest) -> list[BodySection]:
    given = request.axis
    # a body without teeth is cut across z unless told otherwise
    axis = np.array(AXES[given] if isinstance(given, str) else given or AXES["z"])
    if request.teeth or request.lobes:
        axes = likely_axes(body.mesh) if given is None else [axis]
        looks = _LOOKS_FOR_LOBES if request.lobes else _LOOKS_FOR_TEETH
        for look, likely in product(looks, axes):
            teeth = _toothed_extent(body.mesh, axis_frame(likely), look)
            if teeth is not None:
                return [_section(number, body, likely, teeth, request.plane)]
    if request.face_towards is None:
        low, high = body.mesh.extent(axis)
        meets = request.plane is not None and low < request.plane < high
        plane = request.plane if meets or not request.missed else None
        return [_section(number, body, axis, None, plane)]
    # from the end nearest to the height
    layers, towards = _layers(body.mesh, axis), request.face_towards
    if abs(layers[0][0] - towards) >= abs(layers[-1][1] - towards):
        layers = layers[::-1]
    return [
        replace(_section(number, body, axis, None, 0.5 * sum(layer)), layer=layer)
        for layer in layers[:2]
    ]


def _section(
    number: int,
    body: SolidBody,
    axis: Array,
    teeth: tuple[float, float] | None,
    plane: float | None,
) -> BodySection:
    extent = body.mesh.extent(axis)
    low, high = extent if teeth is None else teeth
    height = 0.5 * (low + high) if plane is None else plane
    frame = axis_frame(axis)
    curves = _sorted(body.cut(frame, height)) if extent[0] < height < extent[1] else []
    second_height, second = 0.0, list[Array]()
    if teeth is not None:
        second_height = low + _SECOND * (high - low)
        second = _sorted(section(body.mesh, frame, second_height))
    return BodySection(
        number, body.name, axis, height, extent, teeth, curves, second_height, second
    )


def _sorted(curves: list[Array]) -> list[Array]:
    return sorted(curves, key=lambda curve: -abs(signed_area(curve)))


def _toothed_extent(mesh: SurfaceMesh, frame: Array, look: _Look) -> tuple[float, float] | None:
    low, high = mesh.extent(frame[2])
    looks = [_teeth_at(mesh, frame, low + k * (high - low), look) for k in _QUICK_LOOK]
    if looks[0][0] is not None and len({count for count, _ in looks}) == 1:
        return low, high
    # neighbouring layers with one tooth count; the widest such gear is meant, not a spline or nut
    runs: list[tuple[float, float, float, int]] = []
    for start, end in _layers(mesh, frame[2]):
        count, width = _teeth_at(mesh, frame, 0.5 * (start + end), look)
        if count is None:
            continue
        if runs and runs[-1][1] == start and runs[-1][3] == count:
            runs[-1] = (runs[-1][0], end, max(runs[-1][2], width), count)
        else:
            runs.append((start, end, width, count))
    if not runs:
        return None
    widest = max(run[2] for run in runs)
    near = [run for run in runs if run[2] > 0.98 * widest]
    low, high, _, _ = max(near, key=lambda run: run[1] - run[0])
    return low, high


def _teeth_at(
    mesh: SurfaceMesh, frame: Array, height: float, look: _Look
) -> tuple[int | None, float]:
    # tooth count and width of the outermost curve, or of the outermost toothed one
    for curve in _sorted(section(mesh, frame, height)):
        count = repeating_teeth(curve, look.fewest)
        if count is not None or not look.bores:
            return count, float(np.ptp(curve[:, 0]))
    return None, 0.0


def _layers(mesh: SurfaceMesh, axis: Array) -> list[tuple[float, float]]:
    # between flat faces across the axis: end faces, shoulders, bottoms of recesses
    levels = flat_levels(mesh, axis)
    if len(levels) > _MOST_LAYERS:
        levels = [float(level) for level in np.linspace(levels[0], levels[-1], _MOST_LAYERS + 1)]
    return [(low, high) for low, high in pairwise(levels) if high - low > _THINNEST]
