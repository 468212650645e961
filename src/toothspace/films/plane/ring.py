"""Film between a rotating and a resting face on a polar grid, masked by given pressures."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import final

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.films.definitions import RoughSurfaces
from toothspace.films.plane.film import (
    FaceSolution,
    PlaneFilm,
    PlaneSolution,
    polar_grid,
    polar_points,
    solve_plane,
)
from toothspace.films.reynolds.equation import GapField
from toothspace.films.reynolds.fluid import CAVITATION, FilmFluid
from toothspace.films.reynolds.rough_surfaces import (
    SMOOTH,
    flow_law,
    refuse_deep_contact,
    wall_stress,
)
from toothspace.films.reynolds.state import FilmHistory
from toothspace.model.description import MachineDescription
from toothspace.model.film_faces import FILM, FilmFace
from toothspace.model.lateral_load import chamber_pressures
from toothspace.model.operating_point import OperatingCondition
from toothspace.numerics.banded import check_grid
from toothspace.numerics.linear_system import PRESCRIBED


@final
@dataclass(frozen=True, kw_only=True, eq=False)
class LateralFilm:
    r"""Film on a ring or disc whose one face rotates about the z axis.

    Parameters
    ----------
    inner_radius : float
        Inner radius; zero for a disc. [m]
    outer_radius : float
        Outer radius. [m]
    side_gap : float
        Gap height on the axis. [m]
    fluid : FilmFluid
        Liquid.
    tilt : tuple of float
        Rotation of the upper face about the x and y axis. [rad]
    grid : tuple of int
        Cells round the circumference and along the radius. [-]
    inner_pressure, outer_pressure : float, ndarray or None
        Absolute pressure beyond the rims, one value or one per angle; None for a wall. [Pa]
    given_pressure : ndarray, optional
        Shape of the grid: absolute pressure of cells that belong to a tooth space, groove or
        port, NaN where there is film. [Pa]
    depth : ndarray, optional
        Shape of the grid: recess of the cells below the plane face. [m]
    surfaces : RoughSurfaces, optional
        Roughness and contact; the rotating face is the moving wall.
    cavitation : {"jfo", "reynolds", "guembel"}
        As for :class:`~toothspace.films.journal.bearing.JournalBearing`.
    cavitation_pressure : float
        Absolute pressure in the cavity. [Pa]

    Notes
    -----
    Gap height :math:`h = h_0 + \alpha y - \beta x`. Angles run from x towards y, cell centres
    stand at half steps. Radial conductances are exact for a gap that does not change along the
    radius. Validity: laminar, no inertia (:math:`\rho \omega h^2 / \mu \ll 1`).
    """

    inner_radius: float
    outer_radius: float
    side_gap: float
    fluid: FilmFluid
    tilt: tuple[float, float] = (0.0, 0.0)
    grid: tuple[int, int] = (256, 64)
    inner_pressure: float | Array | None = None
    outer_pressure: float | Array | None = None
    given_pressure: Array | None = field(default=None, repr=False)
    depth: Array | None = field(default=None, repr=False)
    surfaces: RoughSurfaces | None = None
    cavitation: str = "jfo"
    cavitation_pressure: float = 0.0

    def __post_init__(self) -> None:
        if not 0.0 <= self.inner_radius < self.outer_radius:
            raise CaseError(
                "film.inner_radius",
                f"{self.inner_radius!r} m",
                f"are values from 0 to below the outer radius {self.outer_radius!r} m",
            )
        check_grid("film.grid", self.grid)
        for key in ("given_pressure", "depth"):
            values = getattr(self, key)
            if values is not None and values.shape != self.grid:
                raise CaseError(f"film.{key}", f"shape {values.shape}", f"is {self.grid}")

    @property
    def angle(self) -> Array:
        """Angles of the cell centres. [rad]."""
        return np.asarray((np.arange(self.grid[0]) + 0.5) * 2.0 * np.pi / self.grid[0])

    @property
    def radius(self) -> Array:
        """Radii of the cell centres. [m]."""
        rim = self._rims()
        return 0.5 * (rim[1:] + rim[:-1])

    def solve(
        self,
        *,
        shaft_speed: float = 0.0,
        squeeze_velocity: float = 0.0,
        gap_speed: float = 0.0,
        history: FilmHistory | None = None,
    ) -> LateralSolution:
        """Film at a speed of the rotating face.

        Parameters
        ----------
        shaft_speed : float
            Rotation of the lower face, positive from x towards y. [rad/s]
        squeeze_velocity : float
            Velocity of the upper face away from the lower. [m/s]
        gap_speed : float
            Rotation of the gap pattern: zero if it rests with the upper face, the shaft
            speed if it is fixed to the rotating face. [rad/s]
        history : FilmHistory, optional
            ``solution.history(time_step)`` of the film one time step ago: the liquid is then
            transported in time; the change of the gaps counts instead of their velocities.
        """
        film = self.discretise(shaft_speed, squeeze_velocity, gap_speed)
        refuse_deep_contact(film.gap.centre, self.surfaces, "film.side_gap")
        return LateralSolution(self, shaft_speed, squeeze_velocity, solve_plane(film, history))

    def discretise(
        self, shaft_speed: float = 0.0, squeeze_velocity: float = 0.0, gap_speed: float = 0.0
    ) -> PlaneFilm:
        """Film on its grid before it is solved; arguments as for :meth:`solve`."""
        rim, radius, angle = self._rims(), self.radius, self.angle
        step = 2.0 * np.pi / self.grid[0]
        face_angle = np.asarray(np.arange(self.grid[0] + 1) * step, dtype=np.float64)
        centre = self._gap(angle, radius)
        about_x, about_y = self.tilt
        lean = about_x * np.cos(angle) + about_y * np.sin(angle)
        slope = np.asarray(lean[:, None] * radius)
        gap = GapField(
            centre,
            self._gap(face_angle, radius),
            self._gap(angle, rim),
            squeeze_velocity - gap_speed * slope,
            np.zeros_like(centre) if self.depth is None else self.depth,
        )
        grid = polar_grid(self.grid[0], rim)
        if self.inner_pressure is None:
            grid.shape_y[:, 0] = 0.0
        if self.outer_pressure is None:
            grid.shape_y[:, -1] = 0.0
        given = np.full(self.grid, np.nan) if self.given_pressure is None else self.given_pressure
        known = np.isfinite(given)
        return PlaneFilm(
            grid._replace(
                sweep_x=shaft_speed * grid.sweep_x,
                mark=np.where(known, PRESCRIBED, 0),
                prescribed=np.where(known, given, 0.0),
                south=self._rim_pressure(self.inner_pressure),
                north=self._rim_pressure(self.outer_pressure),
            ),
            gap,
            self.fluid,
            self.cavitation_pressure,
            CAVITATION[self.cavitation],
            SMOOTH if self.surfaces is None else flow_law(self.surfaces, 1.0),
            points=polar_points(angle, face_angle, radius, rim),
        )

    def _rims(self) -> Array:
        return np.asarray(np.linspace(self.inner_radius, self.outer_radius, self.grid[1] + 1))

    def _gap(self, angle: Array, radius: Array) -> Array:
        about_x, about_y = self.tilt
        lean = about_x * np.sin(angle) - about_y * np.cos(angle)
        return np.ascontiguousarray(self.side_gap + lean[:, None] * radius)

    def _rim_pressure(self, pressure: float | Array | None) -> Array:
        value = self.cavitation_pressure if pressure is None else pressure
        return np.array(np.broadcast_to(np.asarray(value, dtype=float), (self.grid[0],)))


@final
@dataclass(frozen=True)
class LateralSolution(FaceSolution):
    """Film between two faces, one rotating."""

    lateral: LateralFilm
    """What was solved."""
    shaft_speed: float
    """Rotation of the lower face. [rad/s]"""
    squeeze_velocity: float
    """Velocity of the upper face away from the lower. [m/s]"""
    plane: PlaneSolution
    """Fields, mass balance, stiffness and damping."""

    @property
    def surfaces(self) -> RoughSurfaces | None:
        """Roughness and contact of the walls."""
        return self.lateral.surfaces

    def coefficients(self) -> tuple[Array, Array]:
        """Stiffness [N/m] and damping [N s/m] 3x3 for lift of the upper face and both rotations.

        Of film and touching asperities; units as of
        :meth:`~toothspace.films.plane.film.PlaneSolution.rigid_coefficients`.
        """
        stiffness, damping = self.plane.rigid_coefficients()
        film = self.plane.film
        stiffer = -self._contact()[1] * film.grid.area
        lift = np.stack([np.ones_like(stiffer), film.points.y, -film.points.x])
        return stiffness + np.einsum("ikl,jkl,kl->ij", lift, lift, stiffer), damping

    @property
    def load(self) -> Array:
        """Force along z [N] and moments about x and y [N m] on the upper face.

        Of the absolute pressure, given cells included, and of asperities.
        """
        return self.plane.load(self.plane.pressure + self.contact_pressure)

    @property
    def friction_torque(self) -> float:
        """Torque of film and asperities on the rotating face, positive along z. [N m].

        Shear in a cavity counts with the film fraction; given cells carry none.
        """
        sliding, pattern, pressure = self._drag
        return pattern - sliding - pressure - self.contact_torque

    @property
    def resting_friction_torque(self) -> float:
        """Torque of film and asperities on the resting face, positive along z. [N m]."""
        sliding, pattern, pressure = self._drag
        return sliding + pattern - pressure + self.contact_torque

    @property
    def contact_torque(self) -> float:
        """Torque by which touching asperities drag the resting face along. [N m]."""
        surfaces = self.lateral.surfaces
        if surfaces is None:
            return 0.0
        push = self.contact_pressure * self.plane.film.grid.area * self.lateral.radius
        return float(np.sign(self.shaft_speed) * surfaces.boundary_friction * push.sum())

    @property
    def power_loss(self) -> float:
        """Power that friction takes from the rotating face. [W]."""
        return -self.friction_torque * self.shaft_speed

    @cached_property
    def _drag(self) -> tuple[float, float, float]:
        """Torque by sliding, its difference by the patterns, and by pressure gradients. [N m]."""
        film, gap = self.plane.film, self.plane.film.gap
        radius = self.lateral.radius
        arm = np.where(film.grid.mark != PRESCRIBED, radius * film.grid.area, 0.0)
        mean, difference, half = wall_stress(gap.centre + gap.step, film.law)
        viscous = self.shaft_speed * radius * self.plane.fields.saturation
        viscous = viscous / self.plane.fluid.fluidity * arm
        p = self.plane.pressure
        step = 2.0 * np.pi / self.lateral.grid[0]
        rise = (np.roll(p, -1, axis=0) - np.roll(p, 1, axis=0)) / (2.0 * step * radius)
        return (
            float((viscous * mean).sum()),
            float((viscous * difference).sum()),
            float((half * rise * arm).sum()),
        )

    @property
    def outer_flow(self) -> float:
        """Flow out through the outer rim. [m3/s]."""
        return float(self.plane.flows[1][:, -1].sum())

    @property
    def inner_flow(self) -> float:
        """Flow out through the inner rim. [m3/s]."""
        return -float(self.plane.flows[1][:, 0].sum())

    @property
    def dissipated_power(self) -> float:
        """Power that becomes heat: of rotation, approach, and pressures at the edges. [W]."""
        free = np.where(self.plane.film.grid.mark == PRESCRIBED, 0.0, self.plane.pressure)
        approach = float(self.plane.load(free)[0]) * self.squeeze_velocity
        return self.plane.exchange.power - self.friction_torque * self.shaft_speed - approach


@final
@dataclass(frozen=True, kw_only=True)
class FaceSetting:
    """Where the opposite face stands, and the liquid between."""

    side_gap: float
    """Gap height at the origin of the machine. [m]"""
    fluid: FilmFluid
    """Liquid."""
    tilt: tuple[float, float] = (0.0, 0.0)
    """Rotation of the face about the x and y axis through the origin. [rad]"""
    shaft_angle: float = 0.0
    """Angle of the drive body. [rad]"""
    surfaces: RoughSurfaces | None = None
    """Roughness and contact."""
    cavitation: str = "jfo"
    """Cavitation model."""
    cavitation_pressure: float = 0.0
    """Absolute pressure in the cavity. [Pa]"""
    grid: tuple[int, int] = (256, 64)
    """Cells round each body and along the radius. [-]"""


@final
@dataclass(frozen=True)
class FaceFilms:
    """Solved films, one for each body with an outline."""

    bodies: tuple[str, ...]
    """Names of the bodies."""
    centers: tuple[tuple[float, float], ...]
    """Their axes. [m]"""
    films: tuple[LateralSolution, ...]
    """Films, each about its own axis."""

    @property
    def status(self) -> Status:
        """Of the films; the first that is not done."""
        return min((film.status for film in self.films), key=lambda status: status.succeeded)

    @property
    def outflow(self) -> float:
        """Flow out of all films. [m3/s]."""
        return sum(film.outflow for film in self.films)

    @property
    def dissipated_power(self) -> float:
        """Power that becomes heat in all films. [W]."""
        return sum(film.dissipated_power for film in self.films)

    @property
    def load(self) -> Array:
        """Force along z [N] and moments about x and y through the origin [N m].

        On the face opposite to the bodies, by the absolute pressure on its ring about each body.
        """
        total = np.zeros(3)
        for (x, y), film in zip(self.centers, self.films, strict=True):
            force = film.load
            total += force + force[0] * np.array([0.0, y, -x])
        return total


def solve_faces(
    description: MachineDescription, condition: OperatingCondition, setting: FaceSetting
) -> FaceFilms:
    """Films between the bodies of a machine and one rigid face.

    Raises CaseError if the machine type gives no outlines.

    Parameters
    ----------
    description : MachineDescription
        Machine with outlines of its faces.
    condition : OperatingCondition
        Shaft speed and port pressures; the chambers have the pressures that their paths hold
        at rest.
    """
    known = description.known_faces
    if not known:
        raise CaseError("film.kind", "'lateral'", "is 'pad' for this machine type")
    pressure = chamber_pressures(description, condition)(setting.shaft_angle)
    ratios = {body.name: body.speed_ratio for body in description.bodies}
    # of teeth that wind about their axes, the end that leads its chambers
    lead = 0.0 if description.winding is None else 0.5 * description.winding.twist
    found = [
        _ring(face, pressure, setting, lead).solve(shaft_speed=ratios[body] * condition.shaft_speed)
        for body, face in known.items()
    ]
    centers = tuple(face.center for face in known.values())
    return FaceFilms(tuple(known), centers, tuple(found))


def _ring(face: FilmFace, pressure: Array, setting: FaceSetting, lead: float) -> LateralFilm:
    """Film about one body; the gap is fixed to the opposite face while its edges turn."""
    about_x, about_y = setting.tilt
    x, y = face.center
    polar = (np.arange(setting.grid[0]) + 0.5) * 2.0 * np.pi / setting.grid[0]
    rim = np.linspace(face.inner_radius, face.outer_radius, setting.grid[1] + 1)
    places = face.places(polar, 0.5 * (rim[1:] + rim[:-1]))
    node = face.face_map(setting.shaft_angle + lead, *places).node
    return LateralFilm(
        inner_radius=face.inner_radius,
        outer_radius=face.outer_radius,
        side_gap=setting.side_gap + about_x * y - about_y * x,
        fluid=setting.fluid,
        tilt=setting.tilt,
        grid=setting.grid,
        inner_pressure=float(pressure[face.inner_node]),
        given_pressure=np.where(node == FILM, np.nan, pressure[node]),
        surfaces=setting.surfaces,
        cavitation=setting.cavitation,
        cavitation_pressure=setting.cavitation_pressure,
    )
