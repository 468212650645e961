r"""Films on the faces of turning bodies, as conductances and supporting areas.

Rigid parallel faces: the Reynolds equation is linear in the pressures round the film,

.. math:: \nabla\cdot\left(\frac{h^3}{12\mu}\nabla p\right) = 0,

and its shape does not depend on the gap, so unit pressures at the edges give

.. math:: Q_i = \frac{h^3}{12\mu} \sum_j G_{ij}\, p_j, \qquad F_b = \sum_j A_{bj}\, p_j,

the flows into the film and the force on the face of every body. One factorisation gives all
columns.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

from toothspace.core.types import Array, IntArray
from toothspace.model.description import FlowPath
from toothspace.model.film_faces import FILM, FilmFace, SharedFaces
from toothspace.model.path_category import DRAIN, LATERAL, RIM, PathCategory
from toothspace.numerics.periodic_table import PeriodicTable, monotone_table

LARGEST = 30.0
"""Largest shape conductance: edges that meet are joined by the opening between anyway. [-]"""
_FULL_TURN = 2.0 * np.pi
_LENGTH = 1e-3
_LEAST = 1e-3
"""Least height of a film between smooth faces, over the gap of the face. [-]"""


@final
@dataclass(frozen=True)
class FaceResolution:
    """Grid on one pitch of the chambers."""

    rows: int
    lanes: int
    """Cells along the circumference of one pitch, and along the radius. [-]"""
    angles: int
    """Angles on one pitch; of ``rows`` a divisor, so that the grid turns with the body. [-]"""


@final
@dataclass(frozen=True)
class FaceConductance:
    """Films of one face over one pitch of the chambers."""

    matrix: Array
    """Flow into the film per pressure, over h^3/(12 mu) of the face's gap; edges are the chambers,
    the recesses, the inner rim, the sectors of the outer rim. Rows sum to 0. Shape (angles, k, k).
    [-]
    """
    area: Array
    """Force on the face of a body per pressure at an edge. Shape (angles, bodies, k). [m2]"""
    drag: Array
    """Torque on the face of a body per viscosity and speed, times the face's gap. Shape (bodies,).
    [m4]
    """
    turn: Array
    """Growth of the table angles since shaft angle zero. Shape (angles,). [rad]"""


def face_conductance(
    face: FilmFace, resolution: FaceResolution, planes: Array | None = None
) -> FaceConductance:
    """Solve the films of one face for a unit pressure at each of their edges.

    Conductances, supporting areas and drag.

    Parameters
    ----------
    planes : ndarray, shape (angles, bodies, 3), optional
        Height of the film of every body at its axis [m], and rotations of that plane about x and
        y [rad]; not given: the gap of the face. Where rough faces touch, heights end at the
        roughness.

    Notes
    -----
    Polar grid with edges on cell boundaries. A recess counts as deep: no resistance, no shear.
    Where two edges meet without film between them, the gap or opening between is a path of its
    own. Chambers of another ring, that of a mating gear, count as the nearest of the own ones.
    """
    rims = np.linspace(face.inner_radius, face.outer_radius, resolution.lanes + 1)
    grid = _Grid(face, resolution.rows * face.chambers.nodes.size, rims)
    turn = face.chambers.pitch * np.arange(resolution.angles) / resolution.angles
    if planes is None:
        planes = np.tile([face.gap, 0.0, 0.0], (turn.size, len(face.bodies), 1))
    found = [_at_turn(grid, t, own) for t, own in zip(turn, planes, strict=True)]
    matrix, area, drag = (np.array(parts) for parts in zip(*found, strict=True))
    return FaceConductance(matrix, area, drag.mean(axis=0), turn)


def over_turn(values: Array, phases: Array, turn: Array) -> Array:
    """Values on uniform nodes of the table angle.

    Parameters
    ----------
    values : ndarray, shape (angles, paths)
        One value for every path at every angle.
    phases : ndarray, shape (paths,)
        Table angles of the paths at shaft angle zero. [rad]
    turn : ndarray, shape (angles,)
        Growth of the table angles. [rad]
    """
    place = np.mod(phases + turn[:, None], _FULL_TURN).ravel()
    order = np.argsort(place)
    nodes = np.arange(place.size) * _FULL_TURN / place.size
    found = np.interp(nodes, place[order], values.ravel()[order], period=_FULL_TURN)
    return np.asarray(found)


def gap_table(height: float, conductance: Array) -> PeriodicTable:
    """Parallel gap of a height [m] with shape conductances over a full turn. [-]."""
    columns = np.tile([height, 0.0, _LENGTH], (conductance.size, 1))
    columns[:, 1] = _LENGTH * np.clip(conductance, 0.0, LARGEST)
    return monotone_table(_FULL_TURN, columns)


@final
@dataclass(frozen=True)
class _Grid:
    """Polar grid on a face; its rows run with the table angle."""

    face: FilmFace
    rows: int
    rims: Array

    @property
    def step(self) -> float:
        return _FULL_TURN / self.rows

    @property
    def radius(self) -> Array:
        return np.asarray(0.5 * (self.rims[1:] + self.rims[:-1]))

    @property
    def table_angle(self) -> Array:
        return np.asarray((np.arange(self.rows) + 0.5) * self.step)

    @property
    def points(self) -> tuple[Array, Array]:
        chambers = self.face.chambers
        polar = chambers.zero_angle + chambers.direction * self.table_angle
        return self.face.places(polar, self.radius)

    @property
    def area(self) -> Array:
        ring = 0.5 * np.diff(self.rims**2) * self.step
        return np.tile(ring, (self.rows, 1))


def _at_turn(grid: _Grid, turn: float, planes: Array) -> tuple[Array, Array, Array]:
    """Conductances, supporting areas and drag at one growth of the table angles."""
    face, (x, y) = grid.face, grid.points
    shaft_angle = turn / face.chambers.angle_ratio
    node, body = face.face_map(shaft_angle, x, y)
    # edge of every cell: chambers, recesses, inner rim; FILM in the film
    edge = np.where(node == FILM, FILM, face.chambers.nearest(shaft_angle, x, y))
    known = [*face.chambers.nodes.tolist(), *face.recesses.tolist(), face.inner_node]
    for number, own in reversed(list(enumerate(known))):
        edge[node == own] = number
    # height of the film before every cell, the gap of the face where no body stands. [m]
    least = face.surfaces.roughness if face.surfaces is not None else 0.0
    height = np.full(x.shape, face.gap)
    for k, ((lift, about_x, about_y), own) in enumerate(zip(planes, face.bodies, strict=True)):
        plane = lift + about_x * (y - own.center[1]) - about_y * (x - own.center[0])
        height = np.where(body == k, np.maximum(plane, max(least, _LEAST * face.gap)), height)
    cube = (height / face.gap) ** 3
    if face.sectors == 0:
        rim = None
    else:
        phases = face.sector_phases
        place = ((grid.table_angle - turn) - phases[0]) * phases.size / _FULL_TURN
        sector = np.mod(np.floor(place + 0.5).astype(np.int64), phases.size)
        rim = np.asarray(face.chambers.nodes.size + face.recesses.size + 1 + sector)
    # conductance matrix of the edges, and pressures of all cells for unit ones at each
    film = edge == FILM
    inside = int(film.sum())
    edges = face.chambers.nodes.size * (1 + face.sectors) + face.recesses.size + 1
    cells = inside + edge
    cells[film] = np.arange(inside)
    a, b, g = _links(grid, cells, inside, rim, cube)
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
    unit = factor.solve(-links.T.toarray())
    found = whole[inside:, inside:].toarray() + links @ unit
    matrix = np.asarray(0.5 * (found + found.T))
    pressure = np.vstack([unit, np.eye(edges)])[cells.ravel()]
    weight = [np.where(body == k, grid.area, 0.0) for k in range(len(face.bodies))]
    area = [w.ravel() @ pressure for w in weight]
    shear = np.where(node == FILM, face.gap / height, 0.0)
    drag = [
        float(np.sum(w * shear * ((x - b.center[0]) ** 2 + (y - b.center[1]) ** 2)))
        for w, b in zip(weight, face.bodies, strict=True)
    ]
    return matrix, np.array(area), np.array(drag)


def _joined(first: Array, second: Array) -> Array:
    """Cube of the gap of two half cells one behind the other, or of the one that holds film."""
    both = 2.0 * first * second / (first + second)
    return np.where(np.isnan(both), np.fmax(first, second), both)


def _links(
    grid: _Grid, number: IntArray, inside: int, rim: IntArray | None, cube: Array
) -> tuple[IntArray, IntArray, Array]:
    """Pairs of cells and edges with what conducts between them; none between two edges."""
    logarithm, centre = np.log(grid.rims), np.log(grid.radius)
    cube = np.where(number < inside, cube, np.nan)
    along = np.tile(np.diff(logarithm) / grid.step, (grid.rows, 1))
    across = np.tile(grid.step / np.diff(centre), (grid.rows, 1))
    before = np.roll(number, 1, axis=0)
    # an edge runs between two cells: on the mean half a cell from the centre in the film
    along = along * np.where((before < inside) == (number < inside), 1.0, 2.0)
    across *= np.where((number[:, 1:] < inside) == (number[:, :-1] < inside), 1.0, 2.0)
    inner_rim = inside + grid.face.chambers.nodes.size + grid.face.recesses.size
    inner = grid.step / (centre[0] - logarithm[0]) * cube[:, 0]
    pairs = [
        (before, number, along * _joined(np.roll(cube, 1, axis=0), cube)),
        (number[:, :-1], number[:, 1:], across * _joined(cube[:, :-1], cube[:, 1:])),
        (np.full(grid.rows, inner_rim), number[:, 0], inner),
    ]
    if rim is not None:
        outer = grid.step / (logarithm[-1] - centre[-1]) * cube[:, -1]
        pairs.append((number[:, -1], inside + rim, outer))
    a, b, g = (np.concatenate([pair[k].ravel() for pair in pairs]) for k in range(3))
    kept = np.minimum(a, b) < inside
    return a[kept], b[kept], g[kept]


_LEAST_FLOW = 0.01
"""Share of the largest conductance below which the films between two edges are left out. [-]"""


@final
@dataclass(frozen=True)
class _Edges:
    """Edges of the films with their nodes, one per chamber."""

    number: IntArray
    node: IntArray


def shared_paths(
    faces: SharedFaces, films: tuple[FaceConductance, ...], height: float
) -> list[FlowPath]:
    """Paths between all edges of the films at shared covers.

    Between neighbouring chambers; from chambers to recesses, to the inner node and to the rim; from
    recesses to each other, to the inner node and to the rim.

    Parameters
    ----------
    faces : SharedFaces
        What the covers share; the chamber of the rim is the first of its sectors.
    films : tuple of FaceConductance
        Films before the covers.
    height : float
        Gap of the paths; unequal gaps of the covers enter with their cubes. [m]
    """
    return _Paths(faces, films, height).all()


class _Paths:
    def __init__(
        self, faces: SharedFaces, films: tuple[FaceConductance, ...], height: float
    ) -> None:
        self.face, self.rim, self.height = faces.face, faces.rim, height
        self.turn = films[0].turn
        weight = [(cover.gap / height) ** 3 for cover in faces.covers]
        parts = [w * film.matrix for w, film in zip(weight, films, strict=True)]
        self.shape = -np.sum(parts, axis=0)
        face, self.count = self.face, self.face.chambers.nodes.size
        self.chambers = _Edges(np.arange(self.count), face.chambers.nodes)
        self.inner = self._same(self.count + face.recesses.size, face.inner_node)
        self.recesses = [
            self._same(self.count + k, node) for k, node in enumerate(face.recesses.tolist())
        ]

    def all(self) -> list[FlowPath]:
        """Every path."""
        chambers, ahead = self.chambers, np.roll(np.arange(self.count), -1)
        next_ones = _Edges(ahead, chambers.node[ahead])
        found = [
            self._turning(("lateral", LATERAL), chambers, next_ones),
            self._turning(("drain", DRAIN), chambers, self.inner),
        ]
        for k, recess in enumerate(self.recesses):
            found.append(self._turning((f"lateral_recess_{k}", LATERAL), chambers, recess))
            found.append(self._resting((f"drain_recess_{k}", DRAIN), recess, self.inner))
            found += [
                self._resting((f"lateral_recesses_{j}_{k}", LATERAL), self.recesses[j], recess)
                for j in range(k)
            ]
        joined = []
        per_pitch, first = self.face.sectors, self.rim.chamber
        edges = self.inner.number[0] + 1
        phases = self.face.sector_phases
        for j in range(-per_pitch, 2 * per_pitch):
            sector = np.mod(np.arange(self.count) * per_pitch + j, phases.size)
            rim = _Edges(edges + sector, self.inner.node if self.rim.open_ends else first + sector)
            joined.append(self._turning((f"rim_{j}", RIM), self.chambers, rim))
            if 0 <= j < per_pitch:
                joined += [
                    self._turning((f"rim_{j}_recess_{k}", RIM), rim, recess, phases[sector])
                    for k, recess in enumerate(self.recesses)
                ]
        largest = max(_shape(path).max() for path in joined)
        return [*found, *[path for path in joined if _shape(path).max() > _LEAST_FLOW * largest]]

    def _same(self, number: int, node: int) -> _Edges:
        return _Edges(np.full(self.count, number), np.full(self.count, node))

    def _turning(
        self, label: tuple[str, PathCategory], a: _Edges, b: _Edges, phases: Array | None = None
    ) -> FlowPath:
        """Path for every chamber, over its table angle."""
        phases = self.face.chambers.phases if phases is None else phases
        shape = over_turn(self.shape[:, a.number, b.number], phases, self.turn)
        return self._path(label, (a.node, b.node), phases, shape)

    def _resting(self, label: tuple[str, PathCategory], a: _Edges, b: _Edges) -> FlowPath:
        """Path between edges that rest: the same after every pitch."""
        shape = np.tile(self.shape[:, a.number[0], b.number[0]], self.count)
        return self._path(label, (a.node[:1], b.node[:1]), np.zeros(1), shape)

    def _path(
        self,
        label: tuple[str, PathCategory],
        nodes: tuple[IntArray, IntArray],
        phases: Array,
        shape: Array,
    ) -> FlowPath:
        return FlowPath(
            name=label[0],
            category=label[1],
            kind="parallel_gap",
            nodes_a=nodes[0],
            nodes_b=nodes[1],
            angle_ratio=self.face.chambers.angle_ratio,
            phases=phases,
            geometry=gap_table(self.height, shape),
        )


def _shape(path: FlowPath) -> Array:
    return np.asarray(path.geometry.values[:, 1] / path.geometry.values[:, 2])
