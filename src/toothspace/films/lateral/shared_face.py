r"""Films between bodies and the covers that they share, as conductances and supporting areas.

Rigid parallel faces: the Reynolds equation is linear in the pressures round the film and its
shape does not depend on the gap, so unit pressures at the edges give

.. math:: Q_i = \frac{h^3}{12\mu} \sum_j G_{ij}\, p_j, \qquad F_b = \sum_j A_{bj}\, p_j,

the flows into the film and the force on the face of every body.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.model.film_shapes import Cover, SharedFaceMap, SharedFaces

ROWS_PER_PITCH = 48
LANES = 56
ANGLES_PER_PITCH = 8

_FULL_TURN = 2.0 * np.pi


@final
@dataclass(frozen=True)
class SharedFilm:
    """Films before one cover over one pitch of the chambers.

    Parameters
    ----------
    matrix : ndarray, shape (angles, k, k)
        Flow into the film per pressure, over h^3/(12 mu) of the cover's gap; edges are the
        chambers, the recesses, the inner rim, the sectors of the outer rim. Rows sum to 0. [-]
    area : ndarray, shape (angles, bodies, k)
        Force on the face of a body per pressure at an edge. [m2]
    drag : ndarray, shape (bodies,)
        Torque on the face of a body per viscosity and speed, times the gap height. [m4]
    turn : ndarray, shape (angles,)
        Growth of the table angles since shaft angle zero. [rad]
    gap : ndarray, shape (bodies,)
        Height of the film of every body. [m]
    """

    matrix: Array
    area: Array
    drag: Array
    turn: Array
    gap: Array


@final
@dataclass(frozen=True)
class _Grid:
    """Polar grid about the origin: angles and radii of its cells."""

    rows: int
    rims: Array

    @property
    def step(self) -> float:
        return _FULL_TURN / self.rows

    @property
    def radius(self) -> Array:
        return np.asarray(0.5 * (self.rims[1:] + self.rims[:-1]))

    @property
    def angle(self) -> Array:
        return np.asarray((np.arange(self.rows) + 0.5) * self.step)

    @property
    def points(self) -> tuple[Array, Array]:
        rays = np.cos(self.angle), np.sin(self.angle)
        return np.outer(rays[0], self.radius), np.outer(rays[1], self.radius)

    @property
    def area(self) -> Array:
        ring = 0.5 * np.diff(self.rims**2) * self.step
        return np.tile(ring, (self.rows, 1))


def shared_film(
    faces: SharedFaces,
    cover: Cover,
    centers: Array,
    gap: Array | None = None,
    rows_per_pitch: int = ROWS_PER_PITCH,
    lanes: int = LANES,
    angles: int = ANGLES_PER_PITCH,
) -> SharedFilm:
    """Solve the films before one cover for a unit pressure at each of their edges.

    Parameters
    ----------
    faces : SharedFaces
        What the covers share.
    cover : Cover
        The cover.
    centers : ndarray, shape (bodies, 2)
        Axes of the bodies. [m]
    gap : ndarray, shape (bodies,), optional
        Height of the film of every body; that of the cover if not given. [m]
    rows_per_pitch, lanes : int
        Cells on one pitch of the chambers, and along the radius. [-]
    angles : int
        Angles on one pitch. [-]

    Returns
    -------
    SharedFilm
        Conductances, supporting areas and drag.

    Notes
    -----
    Polar grid about the origin of the machine with edges on cell boundaries. A recess counts as
    deep: no resistance, no shear. Where two edges meet without film between them, the gap or
    opening between is a path of its own.
    """
    count = faces.chambers.size
    grid = _Grid(
        rows_per_pitch * count, np.linspace(faces.inner_radius, faces.rim.radius, lanes + 1)
    )
    turn = _FULL_TURN / count * np.arange(angles) / angles
    own = np.full(len(centers), cover.gap) if gap is None else gap
    view = _View(faces, cover.face_map, centers, (own / cover.gap) ** 3)
    found = [_at_angle(view, grid, t / faces.angle_ratio) for t in turn]
    matrix, area, drag = (np.array(parts) for parts in zip(*found, strict=True))
    return SharedFilm(matrix, area, drag.mean(axis=0), turn, own)


@final
@dataclass(frozen=True)
class _View:
    """One cover as its films see it: map, axes of the bodies, cubes of their gaps."""

    faces: SharedFaces
    face_map: SharedFaceMap
    centers: Array
    cubes: Array


def _at_angle(view: _View, grid: _Grid, shaft_angle: float) -> tuple[Array, Array, Array]:
    faces, centers = view.faces, view.centers
    x, y = grid.points
    node, body = view.face_map(shaft_angle, x, y)
    free = node < 0
    sector = sectors_at(faces, grid.angle, faces.angle_ratio * shaft_angle)
    cube = np.where(body >= 0, view.cubes[np.maximum(body, 0)], 1.0)
    matrix, pressure = _solve((_edge_numbers(faces, node), sector), free, grid, cube)
    weight = [np.where(body == k, grid.area, 0.0) for k in range(len(centers))]
    area = [w.ravel() @ pressure for w in weight]
    drag = [
        float(np.sum(w[free] * ((x - cx) ** 2 + (y - cy) ** 2)[free]))
        for w, (cx, cy) in zip(weight, centers, strict=True)
    ]
    return matrix, np.array(area), np.array(drag)


def sector_phases(faces: SharedFaces) -> Array:
    """Table angles of the middles of the rim's sectors at shaft angle zero. [rad]."""
    per_pitch = faces.rim.sectors
    width = _FULL_TURN / (faces.chambers.size * per_pitch)
    own = (np.arange(per_pitch) - 0.5 * (per_pitch - 1)) * width
    return np.asarray((faces.phases[:, None] + own).ravel())


def sectors_at(faces: SharedFaces, angle: Array, turn: float) -> IntArray:
    """Edges of the rim's sectors at polar angles, after a growth of the table angles. [rad]."""
    count = faces.chambers.size * faces.rim.sectors
    width = _FULL_TURN / count
    place = angle - faces.zero_angle - turn - sector_phases(faces)[0]
    sector = np.mod(np.floor(place / width + 0.5).astype(np.int64), count)
    return np.asarray(faces.chambers.size + faces.recesses.size + 1 + sector)


def _edge_numbers(faces: SharedFaces, node: IntArray) -> IntArray:
    """Edge of every cell: chambers, recesses, inner rim; BARE in the film."""
    nodes = [*faces.chambers.tolist(), *faces.recesses.tolist(), faces.inner_node]
    number = np.full(node.shape, -1, dtype=np.int64)
    for edge, known in enumerate(nodes):
        number[(node == known) & (number < 0)] = edge
    return number


def _solve(
    edges_at: tuple[IntArray, IntArray], free: BoolArray, grid: _Grid, cube: Array
) -> tuple[Array, Array]:
    """Conductance matrix of the edges, and pressures of all cells for unit ones at each."""
    edge, sector = edges_at
    inside, edges = int(free.sum()), int(sector.max()) + 1
    number = inside + edge
    number[free] = np.arange(inside)
    a, b, g = _links(number, grid, (inside, int(sector.min()) - 1, sector), cube)
    rows, columns = np.concatenate([a, b, a, b]), np.concatenate([a, b, b, a])
    values = np.concatenate([g, g, -g, -g])
    whole = sp.csc_matrix((values, (rows, columns)), shape=(inside + edges, inside + edges))
    links = whole[inside:, :inside]
    factor = splu(
        whole[:inside, :inside],
        permc_spec="MMD_AT_PLUS_A",
        diag_pivot_thresh=0.0,
        options={"SymmetricMode": True},
    )
    film = factor.solve(-links.T.toarray())
    found = whole[inside:, inside:].toarray() + links @ film
    return np.asarray(0.5 * (found + found.T)), np.vstack([film, np.eye(edges)])[number.ravel()]


def _joined(first: Array, second: Array) -> Array:
    """Cube of the gap of two half cells one behind the other."""
    return 2.0 * first * second / (first + second)


def _links(
    number: IntArray, grid: _Grid, edges: tuple[int, int, IntArray], cube: Array
) -> tuple[IntArray, IntArray, Array]:
    """Pairs of cells and edges with what conducts between them; none between two edges."""
    inside, inner_rim, outer_rim = edges
    logarithm = np.log(grid.rims)
    along = np.tile(np.diff(logarithm) / grid.step, (grid.rows, 1))
    centre = np.log(grid.radius)
    across = np.tile(grid.step / np.diff(centre), (grid.rows, 1))
    inner = np.full(grid.rows, grid.step / (centre[0] - logarithm[0]))
    outer = np.full(grid.rows, grid.step / (logarithm[-1] - centre[-1]))
    pairs = [
        (np.roll(number, 1, axis=0), number, along, True),
        (number[:, :-1], number[:, 1:], across, True),
        (np.full(grid.rows, inside + inner_rim), number[:, 0], inner, False),
        (number[:, -1], inside + outer_rim, outer, False),
    ]
    a = np.concatenate([p[0].ravel() for p in pairs])
    b = np.concatenate([p[1].ravel() for p in pairs])
    # an edge runs between two cells: on the mean half a cell from the centre in the film
    halved = np.concatenate([np.full(p[0].size, p[3]) for p in pairs])
    at_edge = (np.minimum(a, b) < inside) & (np.maximum(a, b) >= inside)
    g = np.concatenate([p[2].ravel() for p in pairs]) * np.where(halved & at_edge, 2.0, 1.0)
    joints = [(np.roll(cube, 1, axis=0), cube), (cube[:, :-1], cube[:, 1:])]
    at_rims = [cube[:, 0], cube[:, -1]]
    g *= np.concatenate([*(_joined(*pair).ravel() for pair in joints), *at_rims])
    kept = np.minimum(a, b) < inside
    return a[kept], b[kept], g[kept]
