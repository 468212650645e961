"""Rectangular bearing pads: inclined, stepped, with a pocket, or of any given shape."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from functools import cached_property
from typing import final

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.types import Array
from toothspace.core.units import ATMOSPHERIC_PRESSURE
from toothspace.films.definitions import RoughSurfaces
from toothspace.films.plane.film import (
    FaceSolution,
    PlaneFilm,
    PlaneSolution,
    cartesian_points,
    solve_plane,
)
from toothspace.films.reynolds.equation import FilmGrid, GapField
from toothspace.films.reynolds.fluid import CAVITATION, FilmFluid
from toothspace.films.reynolds.rough_surfaces import SMOOTH, flow_law, wall_stress
from toothspace.films.reynolds.state import FilmHistory
from toothspace.numerics.banded import check_grid

GapFunction = Callable[[Array, Array], Array]


@final
@dataclass(frozen=True)
class Pocket:
    """Rectangular recess of a pad, centred across the motion; edges of the pad cut it off.

    Parameters
    ----------
    depth : float
        Depth below the pad surface. [m]
    start : float
        Distance of its first edge from the inlet edge. [m]
    length : float
        Extent along the motion. [m]
    width : float
        Extent across the motion. [m]
    """

    depth: float
    start: float
    length: float
    width: float


@final
@dataclass(frozen=True, kw_only=True)
class Pad:
    r"""Film between a fixed rectangular pad and a plane wall that slides along x.

    Parameters
    ----------
    length : float
        Extent along the motion; the inlet edge is at x = 0. [m]
    width : float
        Extent across the motion. [m]
    inlet_height, outlet_height : float
        Gap heights at the two edges, linear in between. [m]
    fluid : FilmFluid
        Liquid.
    pocket : Pocket, optional
        Recess.
    shape : callable, optional
        Gap height over x and y (y from the middle) instead of the linear one. [m]
    grid : tuple of int
        Cells along and across the motion. [-]
    cavitation : {"jfo", "reynolds", "guembel"}
        As for :class:`~toothspace.films.journal.bearing.JournalBearing`.
    ambient_pressure : float
        Absolute pressure at all open edges. [Pa]
    cavitation_pressure : float
        Absolute pressure in the cavity. [Pa]
    side_condition : {"pressure", "no_flow"}
        Whether the edges along the motion are open or walls (endless pad).
    surfaces : RoughSurfaces, optional
        Roughness and contact; the sliding wall is the moving one.

    Notes
    -----
    Validity: laminar, no inertia, gap small against its extents; a pocket so deep that
    inertia counts is outside.
    """

    length: float
    width: float
    inlet_height: float
    outlet_height: float
    fluid: FilmFluid
    pocket: Pocket | None = None
    shape: GapFunction | None = None
    grid: tuple[int, int] = (256, 128)
    cavitation: str = "jfo"
    ambient_pressure: float = ATMOSPHERIC_PRESSURE
    cavitation_pressure: float = 0.0
    side_condition: str = "pressure"
    surfaces: RoughSurfaces | None = None

    def __post_init__(self) -> None:
        if self.cavitation not in CAVITATION:
            raise CaseError("film.cavitation", f"{self.cavitation!r}", f"are {sorted(CAVITATION)}")
        check_grid("film.grid", self.grid)
        if self.pocket is not None and self.pocket.start >= self.length:
            raise CaseError(
                "film.pocket.x",
                f"{1000.0 * self.pocket.start:g} mm",
                f"are pockets that begin on the pad, below {1000.0 * self.length:g} mm",
            )
        if self.ambient_pressure < self.cavitation_pressure:
            raise CaseError(
                "film.ambient_pressure",
                f"{self.ambient_pressure!r} Pa",
                f"are values from the cavitation pressure {self.cavitation_pressure!r} Pa",
            )

    def solve(
        self, *, speed: float, squeeze_velocity: float = 0.0, history: FilmHistory | None = None
    ) -> PadSolution:
        """Film at a speed of the wall.

        Parameters
        ----------
        speed : float
            Velocity of the wall along x. [m/s]
        squeeze_velocity : float
            Velocity of the pad away from the wall. [m/s]
        history : FilmHistory, optional
            ``solution.history(time_step)`` of the film one time step ago: the liquid is then
            transported in time; the change of the gaps counts instead of their velocities.
        """
        film = self._film(speed, squeeze_velocity)
        return PadSolution(self, speed, squeeze_velocity, solve_plane(film, history))

    def _film(self, speed: float, squeeze_velocity: float) -> PlaneFilm:
        half = self.shape is None
        x, x_face, y, y_face = self._lines(half)
        dx, dy = np.diff(x_face), np.diff(y_face)
        along = np.concatenate([[x[0]], np.diff(x), [self.length - x[-1]]])
        across = np.concatenate([[y[0] - y_face[0]], np.diff(y), [y_face[-1] - y[-1]]])
        wall = np.zeros(y_face.size, dtype=bool)
        wall[[0, -1]] = self.side_condition == "no_flow"
        wall[0] |= half
        inverse = np.where(wall, 0.0, 1.0 / np.where(wall, 1.0, across))
        rows, lanes = x.size, y.size
        ambient = self.ambient_pressure
        grid = FilmGrid(
            dy[None, :] / along[:, None],
            dx[:, None] * inverse[None, :],
            np.tile(0.5 * speed * dy, (rows + 1, 1)),
            np.zeros((rows, lanes + 1)),
            dx[:, None] * dy[None, :],
            np.zeros((rows, lanes), dtype=np.int64),
            np.zeros((rows, lanes)),
            np.full(lanes, ambient),
            np.full(lanes, ambient),
            np.full(rows, ambient),
            np.full(rows, ambient),
            False,
        )
        base = self._gap(x, y)
        # the film is deeper over the pocket
        step = np.zeros((x.size, y.size))
        if self.pocket is not None:
            p = self.pocket
            along = (x > p.start) & (x < p.start + p.length)
            step[np.ix_(along, np.abs(y) < 0.5 * p.width)] = p.depth
        gap = GapField(
            base,
            self._gap(x_face, y),
            self._gap(x, y_face),
            np.full_like(base, squeeze_velocity),
            step,
        )
        points = cartesian_points(x, x_face, y, y_face)
        weight = 2.0 if half else 1.0
        constraint = CAVITATION[self.cavitation]
        law = SMOOTH if self.surfaces is None else flow_law(self.surfaces, 1.0)
        problem = grid, gap, self.fluid, self.cavitation_pressure, constraint, law
        return PlaneFilm(*problem, points=points, weight=weight)

    def _lines(self, half: bool) -> tuple[Array, Array, Array, Array]:
        """Centres and faces along x and y; an odd middle lane is cut in half."""
        rows, lanes = self.grid
        x_face = np.linspace(0.0, self.length, rows + 1)
        y_face = np.linspace(-0.5 * self.width, 0.5 * self.width, lanes + 1)
        x, y = 0.5 * (x_face[1:] + x_face[:-1]), 0.5 * (y_face[1:] + y_face[:-1])
        if half:
            y, y_face = y[lanes // 2 :].copy(), y_face[lanes // 2 :].copy()
            y_face[0] = 0.0
            if lanes % 2:
                y[0] = 0.0
        return x, x_face, y, y_face

    def _gap(self, x: Array, y: Array) -> Array:
        xs, ys = np.meshgrid(x, y, indexing="ij")
        if self.shape is not None:
            return np.array(np.broadcast_to(self.shape(xs, ys), xs.shape), dtype=float, order="C")
        slope = (self.outlet_height - self.inlet_height) / self.length
        return np.asarray(self.inlet_height + slope * xs)


@final
@dataclass(frozen=True)
class PadSolution(FaceSolution):
    """Film under a pad."""

    pad: Pad
    """What was solved."""
    speed: float
    """Velocity of the wall. [m/s]"""
    squeeze_velocity: float
    """Velocity of the pad away from the wall. [m/s]"""
    plane: PlaneSolution
    """Fields on the solved part of the pad."""

    @property
    def surfaces(self) -> RoughSurfaces | None:
        """Roughness and contact of the walls."""
        return self.pad.surfaces

    @property
    def x(self) -> Array:
        """Centres of the cells along the motion. [m]."""
        return self.plane.film.points.x[:, 0]

    @property
    def y(self) -> Array:
        """Centres of the cells across the motion, whole pad. [m]."""
        lanes, width = self.pad.grid[1], self.pad.width
        return (np.arange(lanes) + 0.5) * width / lanes - 0.5 * width

    @property
    def load(self) -> float:
        """Force of film pressure above ambient and of asperities on the pad. [N]."""
        return float(self.plane.load(self._carried())[0])

    @property
    def center_of_pressure(self) -> float:
        """Distance of the resultant from the inlet edge. [m]."""
        load = self.plane.load(self._carried())
        return float(-load[2] / load[0]) if load[0] != 0.0 else float("nan")

    def _carried(self) -> Array:
        return self.plane.pressure - self.pad.ambient_pressure + self._contact()[0]

    @property
    def friction(self) -> float:
        """Drag on the sliding wall, against its motion if positive at positive speed. [N].

        Shear in a cavity counts with the film fraction.
        """
        sliding, pattern, pressure = self._drag
        return sliding - pattern + pressure + self.contact_friction

    @property
    def resting_friction(self) -> float:
        """Drag on the pad along the motion, positive at positive speed. [N]."""
        sliding, pattern, pressure = self._drag
        return sliding + pattern - pressure + self.contact_friction

    @property
    def contact_friction(self) -> float:
        """Part of both drags that touching asperities cause. [N]."""
        if self.pad.surfaces is None:
            return 0.0
        return float(np.sign(self.speed)) * self.pad.surfaces.boundary_friction * self.contact_load

    @property
    def power_loss(self) -> float:
        """Power that friction takes from the sliding wall. [W]."""
        return self.friction * self.speed

    @cached_property
    def _drag(self) -> tuple[float, float, float]:
        """Drag by sliding, its difference by the patterns, and by the pressure gradient. [N]."""
        film, gap = self.plane.film, self.plane.film.gap
        mean, difference, half = wall_stress(gap.centre + gap.step, film.law)
        viscous = self.plane.fields.saturation * self.speed / self.plane.fluid.fluidity
        area = film.weight * film.grid.area
        sliding, pattern = (float((viscous * part * area).sum()) for part in (mean, difference))
        # integral of the pressure part of the stress, in halves of the cells. [N]
        p = self.plane.pressure
        ambient = np.full((1, p.shape[1]), self.pad.ambient_pressure)
        rise = np.diff(np.concatenate([ambient, p, ambient]), axis=0)
        bordered = np.concatenate([half[:1], half, half[-1:]])
        mean = 0.5 * (bordered[1:] + bordered[:-1])
        faces = self.pad._lines(self.plane.film.weight > 1.0)[3]
        return sliding, pattern, film.weight * float((mean * rise).sum(axis=0) @ np.diff(faces))

    @property
    def inlet_flow(self) -> float:
        """Flow in through the inlet edge, at the density of the cavitation pressure. [m3/s]."""
        return self.plane.film.weight * float(self.plane.flows[0][0].sum())

    @property
    def outlet_flow(self) -> float:
        """Flow out through the outlet edge. [m3/s]."""
        return self.plane.film.weight * float(self.plane.flows[0][-1].sum())

    @property
    def side_flow(self) -> float:
        """Flow out through both edges along the motion. [m3/s]."""
        flow_y = self.plane.flows[1]
        if self.plane.film.weight > 1.0:
            return 2.0 * float(flow_y[:, -1].sum())
        return float(flow_y[:, -1].sum() - flow_y[:, 0].sum())

    @property
    def dissipated_power(self) -> float:
        """Power that becomes heat: of the sliding wall and of the approaching pad. [W]."""
        film = self.plane.load(self.plane.pressure - self.pad.ambient_pressure)
        return self.friction * self.speed - float(film[0]) * self.squeeze_velocity

    @property
    def pressure_centerline(self) -> Array:
        """Absolute pressure along the middle of the pad. [Pa]."""
        whole = self.pressure
        lanes = whole.shape[1]
        return np.asarray(0.5 * (whole[:, (lanes - 1) // 2] + whole[:, lanes // 2]))

    def _whole(self, values: Array) -> Array:
        if self.plane.film.weight == 1.0:
            return values.copy()
        mirrored = values[:, ::-1][:, : self.pad.grid[1] // 2]
        return np.concatenate([mirrored, values], axis=1)
