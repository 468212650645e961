"""Polar grids on the faces of the gears, masked at every shaft angle."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import final

import numpy as np

from toothspace.core.compiled import njit
from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.films.plane.film import PlanePoints, polar_grid, polar_points
from toothspace.films.reynolds.equation import FilmGrid
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
        cells = face.face_map(shaft_angle, x, y)
        edges = np.array([(1 - _BEYOND) * face.inner_radius, (1 + _BEYOND) * face.outer_radius])
        beyond = face.face_map(shaft_angle, *face.places(self.angle, edges)).node
        bore = np.where(beyond[:, 0] == FILM, face.inner_node, beyond[:, 0])
        open_face = face.open_wall(body, cells, x, y)
        return Mask(cells.node, np.asarray(cells.body == body), open_face, beyond[:, 1], bore)

    def film_grid(self, mask: Mask, node_pressure: Array, shaft_speed: float) -> FilmGrid:
        """Metric, pressures of chambers, grooves, bore and rim [Pa], and sweep of the body."""
        known = ~mask.film
        speed = self.interface.speed_ratio * shaft_speed
        along, across = _edges(mask.film)
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
        return _moments(pressure, cells, self.points.x, self.points.y, self.area)


def _edges(film: BoolArray) -> tuple[BoolArray, BoolArray]:
    """Faces between film and chamber: the edge stands there, half a cell from the film's centre."""
    ring = np.vstack([film[-1:], film, film[:1]])
    across = np.zeros((film.shape[0], film.shape[1] + 1), dtype=bool)
    across[:, 1:-1] = film[:, 1:] != film[:, :-1]
    return np.asarray(ring[1:] != ring[:-1]), across


@njit(nogil=True)
def _moments(pressure: Array, cells: BoolArray, x: Array, y: Array, area: Array) -> Array:
    out = np.zeros(3)
    for i in range(pressure.shape[0]):
        for j in range(pressure.shape[1]):
            if cells[i, j]:
                push = pressure[i, j] * area[i, j]
                out[0] += push
                out[1] += push * y[i, j]
                out[2] -= push * x[i, j]
    return out
