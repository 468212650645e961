"""Films between nearly parallel faces: solution on a given grid, loads and rigid motions."""

from __future__ import annotations

from dataclasses import dataclass
from typing import NamedTuple, final

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.films.definitions import RoughSurfaces
from toothspace.films.reynolds.equation import FilmGrid, GapField, ring_grid
from toothspace.films.reynolds.rough_surfaces import contact_field, contact_table
from toothspace.films.reynolds.state import FilmHistory, FilmProblem, FilmState, solve_state
from toothspace.numerics.linear_system import PRESCRIBED


class PlanePoints(NamedTuple):
    """Coordinates x and y of cell centres and faces. [m]."""

    x: Array  # (rows, lanes)
    y: Array
    face_x: tuple[Array, Array]  # x and y on the faces of the first index
    face_y: tuple[Array, Array]  # x and y on the faces of the second index


def cartesian_points(x: Array, x_face: Array, y: Array, y_face: Array) -> PlanePoints:
    """Coordinates of a rectangular grid from its lines."""
    centre = np.meshgrid(x, y, indexing="ij")
    first = np.meshgrid(x_face, y, indexing="ij")
    second = np.meshgrid(x, y_face, indexing="ij")
    return PlanePoints(centre[0], centre[1], (first[0], first[1]), (second[0], second[1]))


def polar_points(angle: Array, angle_face: Array, radius: Array, rim: Array) -> PlanePoints:
    """Coordinates of a polar grid from its lines; the first index is the angle."""

    def at(angles: Array, radii: Array) -> tuple[Array, Array]:
        return np.outer(np.cos(angles), radii), np.outer(np.sin(angles), radii)

    x, y = at(angle, radius)
    return PlanePoints(x, y, at(angle_face, radius), at(angle, rim))


def polar_grid(rows: int, rim: Array) -> FilmGrid:
    """Grid whose ring of cells turns at one radian per second, from the radii between its lanes.

    Radial conductances are exact for a gap that does not change along the radius; nothing flows
    through a rim of no radius.
    """
    step, width, radius = 2.0 * np.pi / rows, np.diff(rim), 0.5 * (rim[1:] + rim[:-1])
    with np.errstate(divide="ignore"):
        inner = np.log(radius[0] / rim[0])
    between = np.array([inner, *np.log(radius[1:] / radius[:-1]), np.log(rim[-1] / radius[-1])])
    area = 0.5 * step * (rim[1:] ** 2 - rim[:-1] ** 2)
    return ring_grid(rows, width / (radius * step), step / between, 0.5 * radius * width, area)


@final
@dataclass(frozen=True, kw_only=True)
class PlaneFilm(FilmProblem):
    """Discrete film between two faces; force axis z, mirror plane y = 0."""

    points: PlanePoints


@final
@dataclass(frozen=True)
class PlaneSolution(FilmState):
    """Fields of a plane film and the state that they were found with."""

    film: PlaneFilm

    def load(self, pressure: Array) -> Array:
        """Force along z and moments about x and y of a pressure on the upper face.

        [N, N m, N m]
        """
        film = self.film
        push = pressure * film.grid.area * film.weight
        moment_x = 0.0 if film.weight > 1.0 else float((push * film.points.y).sum())
        return np.array([float(push.sum()), moment_x, -float((push * film.points.x).sum())])

    def mass_balance_error(self) -> float:
        """Sum of the residuals of free cells over the through-flow. [-]."""
        b, net = self.balance, self.residuals
        free = b.mark != PRESCRIBED
        u = self.fields.potential
        through_edges = float(np.abs(b.conductance_y[:, -1] * (u[:, -1] - b.north)).sum())
        if not b.ring:
            through_edges += float(np.abs(b.conductance_x[0] * (u[0] - b.west)).sum())
        through = max(
            float(np.abs(net[~free]).sum()),
            float(np.abs(b.storage).sum()),
            float(np.abs(b.advection_x).sum(axis=1).max()),
            float(np.abs(b.advection_y).sum(axis=0).max()),
            through_edges,
        )
        return self.relative_error(float(net[free].sum()), through)

    def cavitated_fraction(self) -> float:
        """Part of the free area that is at cavitation pressure. [-]."""
        free = self.balance.mark != PRESCRIBED
        empty = free & (self.fields.potential <= 0.0)
        area = self.film.grid.area
        return float(area[empty].sum() / area[free].sum())

    def rigid_coefficients(self) -> tuple[Array, Array]:
        """Stiffness and damping 3x3 for lift of the upper face and its rotations about x and y.

        Minus the derivatives of force and moments; the density is held.
        [N/m, N m/rad and mixed; the same times s]
        """
        film = self.film
        places = film.points
        changes = [rigid_change(places, k, rate) for rate in (False, True) for k in range(3)]
        responses = self.responses(changes)
        table = -np.array([self.load(response) for response in responses]).T
        return table[:, :3], table[:, 3:]


class FaceSolution:
    """What solved films between two faces have in common."""

    plane: PlaneSolution

    @property
    def surfaces(self) -> RoughSurfaces | None:
        """Roughness and contact of the walls; None if they are smooth."""
        raise NotImplementedError

    def _whole(self, values: Array) -> Array:
        """Values of all cells from those of the solved part."""
        return values

    def history(self, time_step: float) -> FilmHistory:
        """What the film holds, as the past of a film one time step later. [s]."""
        return self.plane.history(time_step)

    @property
    def status(self) -> Status:
        """Whether there is a solution and cavity boundary and fluid state settled."""
        return self.plane.status

    @property
    def pressure(self) -> Array:
        """Absolute pressure of the cells. [Pa]."""
        return self._whole(self.plane.pressure)

    @property
    def film_fraction(self) -> Array:
        """Film fraction of the cells. [-]."""
        return self._whole(self.plane.fields.saturation)

    @property
    def gap_height(self) -> Array:
        """Gap height of the cells, recesses included. [m]."""
        gap = self.plane.film.gap
        return self._whole(gap.centre + gap.step)

    @property
    def contact_pressure(self) -> Array:
        """Asperity pressure of the cells, zero in recesses of given pressure. [Pa]."""
        return self._whole(self._contact()[0])

    def _contact(self) -> tuple[Array, Array]:
        """Asperity pressure of the solved cells and its derivative with the gap. [Pa, Pa/m]."""
        film, surfaces = self.plane.film, self.surfaces
        if surfaces is None:
            return np.zeros_like(film.gap.centre), np.zeros_like(film.gap.centre)
        height = film.gap.centre + film.gap.step
        values = contact_field(height, surfaces.roughness, contact_table(surfaces))
        given = film.grid.mark == PRESCRIBED
        return np.where(given, 0.0, values[0]), np.where(given, 0.0, values[1])

    @property
    def contact_load(self) -> float:
        """Part of the force along z that touching asperities carry. [N]."""
        film = self.plane.film
        return film.weight * float((self._contact()[0] * film.grid.area).sum())

    @property
    def outflow(self) -> float:
        """Flow out over all edges and those of given cells, where it leaves. [m3/s]."""
        return self.plane.exchange.outflow

    @property
    def max_pressure(self) -> float:
        """Highest absolute pressure. [Pa]."""
        return float(self.plane.pressure.max())

    @property
    def cavitated_fraction(self) -> float:
        """Part of the area at cavitation pressure. [-]."""
        return self.plane.cavitated_fraction()

    @property
    def mass_balance_error(self) -> float:
        """Sum of the cell residuals over the through-flow. [-]."""
        return self.plane.mass_balance_error()


def solve_plane(film: PlaneFilm, history: FilmHistory | None = None) -> PlaneSolution:
    """Pressure and film fraction; viscosity and density are iterated with the pressure.

    With a history the liquid is transported in time, else it follows the motion without delay.
    """
    lowest = float(min(film.gap.centre.min(), film.gap.face_x.min(), film.gap.face_y.min()))
    if lowest <= 0.0 and film.law.roughness == 0.0:
        raise CaseError("film", f"a smallest gap of {lowest:.3g} m", "are open gaps")
    return PlaneSolution(**vars(solve_state(film, history=history)))


def rigid_change(points: PlanePoints, motion: int, rate: bool) -> GapField:
    """Change of the gap by a unit lift or rotation of the upper face about x or y, or its rate."""

    def shape(x: Array, y: Array) -> Array:
        return np.ascontiguousarray((np.ones_like(x), y, -x)[motion])

    centre = shape(points.x, points.y)
    faces = shape(*points.face_x), shape(*points.face_y)
    zero = np.zeros_like(centre)
    if rate:
        return GapField(zero, np.zeros_like(faces[0]), np.zeros_like(faces[1]), centre, zero)
    return GapField(centre, faces[0], faces[1], zero, zero)
