"""Polar grids on the faces, masked at every shaft angle, and smooth functions of the gap there."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import final

import numpy as np
import scipy.sparse as sp
from scipy.linalg import cho_factor, cho_solve

from toothspace.core.compiled import njit
from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.films.plane.film import PlanePoints, polar_grid, polar_points
from toothspace.films.reynolds.equation import FilmGrid, GapField
from toothspace.model.film_faces import FILM
from toothspace.model.floating_bearing import FilmInterface
from toothspace.numerics.structured_grid import FREE, PRESCRIBED

_BEYOND = 1e-6
"""Distance from both rims, over their radius, at which the nodes beyond are looked up. [-]"""


@final
@dataclass(frozen=True)
class Mask:
    """What stands against one bearing face at a shaft angle."""

    node: IntArray
    """Node whose pressure acts in a cell, FILM where there is a film."""
    covered: BoolArray
    """Cells before which the own body stands."""
    open_face: BoolArray
    """Cells where a chamber meets the bearing and no other body does."""
    rim: IntArray
    """Nodes beyond the outer rim, one per angle."""
    bore: IntArray
    """Nodes within the inner rim, one per angle."""

    @property
    def film(self) -> BoolArray:
        """Cells that a film covers."""
        return np.asarray(self.node == FILM)

    @property
    def owned(self) -> BoolArray:
        """Cells whose part of the bearing counts with the own body and not with a neighbour."""
        return np.asarray(self.covered | self.open_face)


@final
@dataclass(frozen=True, eq=False)
class FaceGrid:
    """Polar grid about the axis of one body, fixed to the bearing."""

    interface: FilmInterface
    """Film that it is for."""
    rows: int
    lanes: int
    """Cells round the circumference and along the radius. [-]"""
    points: PlanePoints = field(init=False, repr=False)
    area: Array = field(init=False, repr=False)
    _metric: FilmGrid = field(init=False, repr=False)

    def __post_init__(self) -> None:
        step, rim = 2.0 * np.pi / self.rows, self.rims
        face = np.asarray(np.arange(self.rows + 1) * step)
        object.__setattr__(self, "points", polar_points(self.angle, face, self.radius, rim))
        metric = polar_grid(self.rows, rim)
        object.__setattr__(self, "_metric", metric)
        object.__setattr__(self, "area", self._metric.area)

    @property
    def rims(self) -> Array:
        """Radii between the lanes, one of them where tooth spaces begin. [m]."""
        own, root_radius = self.interface.face, self.interface.root_radius
        within = root_radius - own.inner_radius
        if not 0.0 < within < own.outer_radius - own.inner_radius:
            return np.linspace(own.inner_radius, own.outer_radius, self.lanes + 1)
        share = within / (own.outer_radius - own.inner_radius)
        inside = min(max(round(self.lanes * share), 1), self.lanes - 1)
        land = np.linspace(own.inner_radius, root_radius, inside + 1)
        teeth = np.linspace(root_radius, own.outer_radius, self.lanes - inside + 1)
        return np.concatenate([land, teeth[1:]])

    @property
    def radius(self) -> Array:
        """Radii of the cell centres. [m]."""
        rim = self.rims
        return np.asarray(0.5 * (rim[1:] + rim[:-1]))

    @property
    def angle(self) -> Array:
        """Angles of the cell centres. [rad]."""
        return np.asarray((np.arange(self.rows) + 0.5) * 2.0 * np.pi / self.rows)

    def mask(self, shaft_angle: float) -> Mask:
        """Film, chambers and grooves at a shaft angle. [rad]."""
        face = self.interface.face
        body, (x0, y0) = face.body_number(self.interface.body), face.center
        x, y = self.points.x + x0, self.points.y + y0
        shaft_angle += self.interface.lead
        cells = face.face_map(shaft_angle, x, y)
        edges = np.array([(1 - _BEYOND) * face.inner_radius, (1 + _BEYOND) * face.outer_radius])
        beyond = face.face_map(shaft_angle, *face.places(self.angle, edges)).node
        bore = np.where(beyond[:, 0] == FILM, face.inner_node, beyond[:, 0])
        open_face = face.open_wall(body, cells, x, y)
        first = self.interface.first_node
        node = np.where(cells.node == FILM, FILM, cells.node + first)
        covered = np.asarray(cells.body == body)
        return Mask(node, covered, open_face, beyond[:, 1] + first, bore + first)

    def film_grid(self, mask: Mask, node_pressure: Array, shaft_speed: float) -> FilmGrid:
        """Metric, pressures of chambers, grooves, bore and rim [Pa], and sweep of the body."""
        known = ~mask.film
        speed = self.interface.speed_ratio * shaft_speed
        ring = np.vstack([mask.film[-1:], mask.film, mask.film[:1]])
        across = np.zeros((mask.film.shape[0], mask.film.shape[1] + 1), dtype=bool)
        across[:, 1:-1] = mask.film[:, 1:] != mask.film[:, :-1]
        along = np.asarray(ring[1:] != ring[:-1])
        return self._metric._replace(
            shape_x=np.where(along, 2.0, 1.0) * self._metric.shape_x,
            shape_y=np.where(across, 2.0, 1.0) * self._metric.shape_y,
            sweep_x=self._metric.sweep_x * speed,
            mark=np.where(known, PRESCRIBED, FREE),
            prescribed=np.where(known, node_pressure[mask.node], 0.0),
            south=node_pressure[mask.bore],
            north=node_pressure[mask.rim],
        )

    def face_moments(self, cells: BoolArray) -> Array:
        """Area of cells [m2] and its first moments in the machine frame [m3]."""
        x0, y0 = self.interface.face.center
        area = np.where(cells, self.area, 0.0)
        x, y = self.points.x + x0, self.points.y + y0
        return np.array([area.sum(), (area * y).sum(), -(area * x).sum()])

    def moments(self, pressure: Array, cells: BoolArray) -> Array:
        """Force and moments of a pressure on cells about the own axis: lift and rotations.

        [N, N m, N m]
        """
        return np.array(_moments(pressure, cells, self.points.x, self.points.y, self.area))


@njit(nogil=True)
def _moments(
    pressure: Array, cells: BoolArray, x: Array, y: Array, area: Array
) -> tuple[float, float, float]:
    lift, about_x, about_y = 0.0, 0.0, 0.0
    for i in range(pressure.shape[0]):
        for j in range(pressure.shape[1]):
            if cells[i, j]:
                push = pressure[i, j] * area[i, j]
                lift += push
                about_x += push * y[i, j]
                about_y -= push * x[i, j]
    return lift, about_x, about_y


_ASIDE = 0.01
"""Weight of cells beside the film, which determine waves shorter than a tooth space. [-]"""


@final
@dataclass(frozen=True, eq=False)
class BasisFunctions:
    """Basis functions of one face."""

    grid: FaceGrid
    """Face."""
    waves: int
    """Most waves round the circumference, at least one. [-]"""
    degree: int
    """Largest degree of the polynomials, at least one: then planes are among them. [-]"""
    film: BoolArray | None = None
    """Cells that fields are fitted on, in place of all. What such a fit leaves has no mean there,
    so that it hardly squeezes the film.
    """
    _round: Array = field(init=False, repr=False)
    _along: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_round", self._turns(self.grid.angle))
        object.__setattr__(self, "_along", self._powers(self.grid.radius))

    @property
    def count(self) -> int:
        """Number of basis functions. [-]."""
        return self._round.shape[1] * self._along.shape[1]

    def fit(self, values: Array) -> Array:
        """Coefficients of the least-squares fit of a field. [as the field]."""
        moments = self._round.T @ ((self._weight * values) @ self._along)
        # fields of films that are lost have no numbers; the step that they lead to tells it
        return np.asarray(cho_solve(self._gram, moments.ravel(), check_finite=False))

    def combine(self, coefficients: Array) -> Array:
        """Field with given coefficients. [as the coefficients]."""
        table = coefficients.reshape(self._round.shape[1], self._along.shape[1])
        return np.asarray(self._round @ table @ self._along.T)

    def fit_rows(self, fields: sp.spmatrix) -> Array:
        """Coefficients of many fields, which are the rows of a sparse matrix, row by row."""
        turns, powers = self._round, self._along
        cells, count = fields.tocoo(), fields.shape[0]
        row, lane = np.divmod(cells.col, self.grid.lanes)
        data = cells.data * self._weight[row, lane]
        found = np.empty((count, turns.shape[1], powers.shape[1]))
        for k, power in enumerate(powers.T):
            values = (data * power[lane], (cells.row, row))
            found[:, :, k] = sp.csr_matrix(values, shape=(count, self.grid.rows)) @ turns
        return np.asarray(cho_solve(self._gram, found.reshape(count, self.count).T).T)

    @cached_property
    def _weight(self) -> Array:
        if self.film is None:
            return np.ones(self.grid.area.shape)
        return np.where(self.film, 1.0, _ASIDE)

    @cached_property
    def _gram(self) -> tuple[Array, bool]:
        """Factors of the sums of products of all basis functions."""
        turns, powers, size = self._round, self._along, self._along.shape[1]
        found = np.empty((turns.shape[1], size, turns.shape[1], size))
        for k in range(size):
            for m in range(k + 1):
                weight = self._weight @ (powers[:, k] * powers[:, m])
                found[:, k, :, m] = found[:, m, :, k] = turns.T @ (weight[:, None] * turns)
        return cho_factor(found.reshape(self.count, self.count))

    def planes(self) -> Array:
        """Coefficients of unit lift and rotations about x and y, shape (count, 3). [-, m]."""
        middle, half = self._radii()
        found = np.zeros((self._round.shape[1], self._along.shape[1], 3))
        found[0, 0, 0] = 1.0
        found[2, :2, 1] = middle, half
        found[1, :2, 2] = -middle, -half
        return found.reshape(self.count, 3)

    def gap_changes(self, frequency: float) -> Iterator[GapField]:
        """Change of the gap by every basis function that grows at a given frequency. [1/s]."""
        rows = self.grid.rows
        edges = self._turns(np.arange(rows + 1) * 2.0 * np.pi / rows)
        rims = self._powers(self.grid.rims)
        still = np.zeros((rows, self.grid.lanes))
        for turn, edge in zip(self._round.T, edges.T, strict=True):
            for power, rim in zip(self._along.T, rims.T, strict=True):
                centre = np.outer(turn, power)
                sides = np.outer(edge, power), np.outer(turn, rim)
                yield GapField(centre, *sides, frequency * centre, still)

    def _radii(self) -> tuple[float, float]:
        own = self.grid.interface.face
        return 0.5 * (own.outer_radius + own.inner_radius), 0.5 * (
            own.outer_radius - own.inner_radius
        )

    def _turns(self, angle: Array) -> Array:
        waves = np.arange(1, self.waves + 1) * angle[:, None]
        pairs = np.stack([np.cos(waves), np.sin(waves)], axis=2).reshape(angle.size, -1)
        return np.hstack([np.ones((angle.size, 1)), pairs])

    def _powers(self, radius: Array) -> Array:
        middle, half = self._radii()
        return np.asarray(np.polynomial.legendre.legvander((radius - middle) / half, self.degree))
