"""Solved film of a journal bearing and everything derived from it."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import final

import numpy as np

from toothspace.closures.journal_friction import sommerfeld_number
from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.core.types import Array, IntArray
from toothspace.films.definitions import Groove
from toothspace.films.journal.geometry import (
    EndConditions,
    JournalDefinition,
    JournalMesh,
    MotionState,
    SurfaceSpeed,
    journal_gap,
    journal_grid,
    journal_load,
    journal_mesh,
    journal_shear,
    lobed,
)
from toothspace.films.reynolds.equation import FilmGrid
from toothspace.films.reynolds.fluid import CAVITATION
from toothspace.films.reynolds.rough_surfaces import (
    SMOOTH,
    FlowLaw,
    contact_field,
    contact_table,
    flow_law,
)
from toothspace.films.reynolds.state import FilmHistory, FilmProblem, FilmState, solve_state
from toothspace.numerics.linear_system import PRESCRIBED, TIGHT


@final
@dataclass(frozen=True)
class JournalContact:
    """Asperity pressure of the cells and its derivative with the gap."""

    pressure: Array
    slope: Array


@final
@dataclass(frozen=True)
class JournalField(FilmState):
    """Discrete film and its solution, kept for variations."""

    mesh: JournalMesh
    contact: JournalContact | None


@lru_cache(maxsize=32)
def _metric(
    bearing: JournalDefinition, grooves: tuple[Groove, ...], first_angle: float, half: bool
) -> tuple[JournalMesh, FilmGrid]:
    mesh = journal_mesh(bearing.length, bearing.grid, first_angle, half=half)
    wall = bearing.end_condition == "no_flow"
    ends = EndConditions(bearing.end_pressure, bearing.end_pressure, wall)
    return mesh, journal_grid(mesh, 0.5 * bearing.diameter, grooves, ends)


def _supplied(
    bearing: JournalDefinition, motion: MotionState, surface_speed: float, *, remembered: bool
) -> tuple[tuple[Groove, ...], float]:
    """Grooves with the supply line, and the angle at which the grid begins."""
    if bearing.supply != "auto":
        needed = bearing.supply == "widest_gap"
    elif bearing.grooves:
        needed = False
    elif bearing.end_condition == "no_flow":
        needed = surface_speed != 0.0 or bool(np.any(motion.speed))
    else:
        needed = surface_speed != 0.0 and bearing.end_pressure <= bearing.cavitation_pressure
    if not needed:
        moves = surface_speed != 0.0 or bool(np.any(motion.speed))
        closed = bearing.end_condition == "no_flow" and not bearing.grooves
        if moves and closed and not remembered:
            raise CaseError(
                "bearing.supply",
                "'none' between walls and without grooves",
                "is a supply line, a groove or open ends: the liquid in a closed film is not "
                "determined",
            )
        return bearing.grooves, 0.0
    place = motion.place
    widest = float(np.arctan2(-place[1], -place[0])) if np.any(place[:2]) else np.pi
    line = Groove(widest, 0.0, bearing.length, bearing.end_pressure)
    return (*bearing.grooves, line), widest


def solve_field(
    bearing: JournalDefinition,
    motion: MotionState,
    speed: SurfaceSpeed,
    *,
    half: bool | None = None,
    start: IntArray | None = None,
    history: FilmHistory | None = None,
) -> JournalField:
    """Film of a bearing for a rigid motion of its shaft.

    ``start`` holds the kinds of the cells to begin with. With a history the film fraction is
    transported in time, else it follows the motion without delay.
    """
    radius = 0.5 * bearing.diameter
    surface_speed = 0.5 * (speed.shaft + speed.bush) * radius
    grooves, first_angle = _supplied(bearing, motion, surface_speed, remembered=history is not None)
    if half is None:
        tilted = np.any(motion.place[2:]) or np.any(motion.speed[2:])
        half = not tilted and all(g.position == 0.0 for g in grooves)
    mesh, unit_grid = _metric(bearing, grooves, first_angle, half)
    grid = unit_grid._replace(sweep_x=unit_grid.sweep_x * surface_speed)
    gap = journal_gap(mesh, bearing.radial_clearance, motion)
    if bearing.lobes is not None:
        gap = lobed(gap, mesh, bearing.lobes, bearing.radial_clearance)
    surfaces = bearing.surfaces
    law: FlowLaw = SMOOTH
    contact: JournalContact | None = None
    if surfaces is not None:
        total = speed.shaft + speed.bush
        law = flow_law(surfaces, (speed.shaft - speed.bush) / total if total != 0.0 else 0.0)
        pressure, slope = contact_field(gap.centre, surfaces.roughness, contact_table(surfaces))
        contact = JournalContact(pressure, slope)
    if contact is None:
        lowest = min(float(gap.centre.min()), float(gap.face_x.min()), float(gap.face_y.min()))
        if lowest <= 0.0:
            ratio = float(np.hypot(*motion.place[:2])) / bearing.radial_clearance
            raise CaseError(
                "bearing.eccentricity",
                f"a smallest gap of {lowest:.3g} m at an eccentricity ratio of {ratio:.4g}",
                "are positions without contact",
            )
    film = FilmProblem(
        grid,
        gap,
        bearing.fluid,
        bearing.cavitation_pressure,
        CAVITATION[bearing.cavitation],
        law,
        mesh.weight,
    )
    return JournalField(**vars(solve_state(film, start, history)), mesh=mesh, contact=contact)


def contact_load(
    bearing: JournalDefinition, speed: SurfaceSpeed, field: JournalField
) -> tuple[Array, float]:
    """Force on the shaft by asperities [N], and the torque by which they brake it [N m]."""
    if field.contact is None or bearing.surfaces is None:
        return np.zeros(2), 0.0
    load = journal_load(field.mesh, field.contact.pressure, field.film.grid.area)
    force = np.array(load[:2])
    normal = field.mesh.weight * float((field.contact.pressure * field.film.grid.area).sum())
    sense = float(np.sign(speed.shaft - speed.bush))
    return force, sense * bearing.surfaces.boundary_friction * normal * 0.5 * bearing.diameter


def friction_torques(
    bearing: JournalDefinition, speed: SurfaceSpeed, field: JournalField
) -> tuple[float, float]:
    """Torques on shaft and bush [N m]; a cavity shears in proportion to its film fraction."""
    radius = 0.5 * bearing.diameter
    thickness = 1.0 / (bearing.dynamic_viscosity * field.fluid.fluidity)
    sheared = field.fields.saturation * thickness
    couette, pattern, pressure = (
        field.mesh.weight * part
        for part in journal_shear(field.film.gap, field.gauge, sheared, field.mesh, field.film.law)
    )
    scale = bearing.dynamic_viscosity * (speed.shaft - speed.bush) * radius**3
    shaft = -scale * (couette - pattern) - radius * pressure
    return shaft, scale * (couette + pattern) - radius * pressure


def boundary_flows(field: JournalField) -> tuple[float, Array, float]:
    """Supply by prescribed cells, flow out of the two ends [m3/s], error of the balance [-]."""
    weight, b = field.mesh.weight, field.balance
    net, (_, flow_y) = field.residuals, field.flows
    prescribed = b.mark == PRESCRIBED
    supply = weight * float(net[prescribed].sum())
    north = float(flow_y[:, -1].sum())
    south = north if weight > 1.0 else -float(flow_y[:, 0].sum())
    through = max(
        abs(supply), abs(north), abs(south), float(np.abs(b.advection_x).sum(axis=1).max())
    )
    through = max(through, float(np.abs(b.storage - b.source).sum()))
    error = field.relative_error(weight * float(net[~prescribed].sum()), through)
    return supply, np.array([south, north]), error


@final
@dataclass(frozen=True)
class JournalBearingSolution:
    """Film of a journal bearing; forces and moments act on the shaft by the film."""

    bearing: JournalDefinition
    """What was solved."""
    motion: MotionState
    """Position and motion of the shaft."""
    speed: SurfaceSpeed
    """Rotation of shaft and bush."""
    force: Array
    """Force x, y on the shaft. [N]"""
    moment: Array
    """Moment about the x and y axis through the middle of the bush, on the shaft. [N m]"""
    friction_torque: float
    """Torque of the film on the shaft, positive along positive rotation. [N m]"""
    bush_friction_torque: float
    """Torque of the film on the bush. [N m]"""
    contact_force: Array
    """Part of the force that touching asperities carry. [N]"""
    contact_torque: float
    """Torque by which touching asperities brake the shaft; part of the friction torques. [N m]"""
    end_flow: Array
    """Flow out through the ends at z = -length/2 and +length/2. [m3/s]"""
    supply_flow: float
    """Flow in through grooves and supply line. [m3/s]"""
    mass_balance_error: float
    """Sum of the absolute cell residuals over the through-flow. [-]"""
    status: Status
    """Whether the cavity boundary settled."""
    solved: JournalField = field(repr=False)

    @property
    def eccentricity(self) -> Array:
        """Displacement over clearance. [-]."""
        return self.motion.place[:2] / self.bearing.radial_clearance

    @property
    def eccentricity_ratio(self) -> float:
        """Length of the eccentricity. [-]."""
        return float(np.hypot(*self.eccentricity))

    @property
    def attitude_angle(self) -> float:
        """Angle from the load on the shaft to the eccentricity, along the rotation. [rad]."""
        load, place = -self.force, self.motion.place
        turn = np.arctan2(place[1], place[0]) - np.arctan2(load[1], load[0])
        sense = -1.0 if self.speed.shaft < 0.0 else 1.0
        return float(sense * np.angle(np.exp(1j * turn)))

    @property
    def load(self) -> float:
        """Size of the force. [N]."""
        return float(np.hypot(*self.force))

    @property
    def load_vector(self) -> Array:
        """Force and moment on the shaft. [N, N m]."""
        return np.concatenate([self.force, self.moment])

    @property
    def sommerfeld_number(self) -> float:
        r"""Load parameter :math:`S = (\eta N / P) (R / c)^2`, N in 1/s. [-]."""
        if self.load == 0.0:
            return np.inf
        b = self.bearing
        speed = abs(self.speed.shaft + self.speed.bush)
        number = sommerfeld_number(
            speed, self.load, b.dynamic_viscosity, 0.5 * b.diameter, b.length, b.radial_clearance
        )
        return float(number)

    @property
    def sommerfeld_number_din(self) -> float:
        r"""Load parameter :math:`So = P \psi^2 / (\eta \omega)`. [-]."""
        number = self.sommerfeld_number
        return 1.0 / (2.0 * np.pi * number) if number > 0.0 else np.inf

    @property
    def side_flow(self) -> float:
        """Flow out through both ends. [m3/s]."""
        return float(self.end_flow.sum())

    @property
    def power_loss(self) -> float:
        """Power that friction takes from shaft and bush. [W]."""
        return (
            -self.friction_torque * self.speed.shaft - self.bush_friction_torque * self.speed.bush
        )

    @property
    def outflow(self) -> float:
        """Flow that carries heat away: out through both ends. [m3/s]."""
        return self.side_flow

    @property
    def dissipated_power(self) -> float:
        """Power that becomes heat: of friction, approach, and supply pressure. [W]."""
        approach = self.force @ self.motion.speed[:2] + self.moment @ self.motion.speed[2:]
        return self.power_loss + self.solved.exchange.power - float(approach)

    @property
    def max_pressure(self) -> float:
        """Highest absolute pressure. [Pa]."""
        return float(self.solved.pressure.max())

    @property
    def min_gap_height(self) -> float:
        """Smallest gap height. [m]."""
        gap = self.solved.film.gap
        return float(min(gap.centre.min(), gap.face_y.min()))

    @property
    def cavitated_fraction(self) -> float:
        """Part of the film area at cavitation pressure with a film fraction below one. [-]."""
        found, area = self.solved, self.solved.film.grid.area
        empty = (found.balance.mark != PRESCRIBED) & (found.fields.potential <= 0.0)
        return float(np.where(empty, area, 0.0).sum() / area.sum())

    @property
    def pressure(self) -> Array:
        """Absolute pressure over angle and axis, whole film. [Pa]."""
        return self._whole(self.solved.pressure)

    @property
    def film_fraction(self) -> Array:
        """Film fraction over angle and axis, whole film. [-]."""
        return self._whole(self.solved.fields.saturation)

    @property
    def gap_height(self) -> Array:
        """Gap height over angle and axis, whole film. [m]."""
        return self._whole(self.solved.film.gap.centre)

    @property
    def contact_pressure(self) -> Array:
        """Asperity pressure over angle and axis, whole film. [Pa]."""
        contact = self.solved.contact
        none = np.zeros_like(self.solved.gauge)
        return self._whole(none if contact is None else contact.pressure)

    @property
    def angle(self) -> Array:
        """Angles of the cell centres. [rad]."""
        return self.solved.mesh.angle

    @property
    def axial_position(self) -> Array:
        """Axial positions of the cell centres, whole film. [m]."""
        length, lanes = self.bearing.length, self.bearing.grid[1]
        return (np.arange(lanes) + 0.5) * length / lanes - 0.5 * length

    @cached_property
    def stiffness(self) -> Array:
        """Minus the derivative of the force with the displacement, 2x2. [N/m]."""
        return -self._derivatives[:2, :2]

    @cached_property
    def damping(self) -> Array:
        """Minus the derivative of the force with the velocity, 2x2. [N s/m]."""
        return -self._derivatives[:2, 2:]

    @cached_property
    def _derivatives(self) -> Array:
        return load_derivatives(self.solved, (0, 1))

    def history(self, time_step: float) -> FilmHistory:
        """What the film holds, as the past of a film one time step later. [s]."""
        return self.solved.history(time_step)

    def coefficients(self) -> tuple[Array, Array]:
        """Stiffness and damping 4x4 for x, y and rotations about x and y.

        Units follow force [N] and moment [N m] over displacement [m] and rotation [rad].
        """
        whole = self
        if self.solved.mesh.weight > 1.0:
            whole = solve_motion(self.bearing, self.motion, self.speed, half=False)
        derivatives = load_derivatives(whole.solved, (0, 1, 2, 3))
        return -derivatives[:, :4], -derivatives[:, 4:]

    def _whole(self, values: Array) -> Array:
        if self.solved.mesh.weight == 1.0:
            return values.copy()
        mirrored = values[:, ::-1]
        if self.bearing.grid[1] % 2:
            mirrored = mirrored[:, :-1]
        return np.concatenate([mirrored, values], axis=1)


def load_derivatives(
    field: JournalField,
    directions: tuple[int, ...],
    *,
    speeds: tuple[bool, ...] = (False, True),
    relative_tolerance: float = TIGHT,
) -> Array:
    """Derivatives of force and moment with position and speed of the shaft, cavity boundary exact.

    Returns an array of 4 rows (force x, y, moment x, y) and, for every direction, one column
    per position and then one per speed. [N or N m over m, rad, m/s, rad/s]
    """
    still, units = np.zeros(4), np.eye(4)[list(directions)]
    motions = [
        MotionState(still, unit) if of_speed else MotionState(unit, still)
        for of_speed in speeds
        for unit in units
    ]
    changes = [journal_gap(field.mesh, 0.0, motion) for motion in motions]
    responses = field.responses(changes, relative_tolerance)
    columns = []
    for response, change in zip(responses, changes, strict=True):
        touch = 0.0 if field.contact is None else field.contact.slope * change.centre
        columns.append(journal_load(field.mesh, response + touch, field.film.grid.area))
    return np.array(columns).T


def solve_motion(
    bearing: JournalDefinition,
    motion: MotionState,
    speed: SurfaceSpeed,
    *,
    half: bool | None = None,
    former: JournalBearingSolution | None = None,
    history: FilmHistory | None = None,
) -> JournalBearingSolution:
    """Film of a bearing for a rigid motion of its shaft; see :meth:`JournalBearing.solve`.

    A former solution nearby gives the cavity to begin with. With a history the film fraction is
    transported in time, else it follows the motion without delay.
    """
    start = None if former is None else former.solved.fields.kind
    field = solve_field(bearing, motion, speed, half=half, start=start, history=history)
    carried = field.gauge if field.contact is None else field.gauge + field.contact.pressure
    load = np.array(journal_load(field.mesh, carried, field.film.grid.area))
    shaft, bush = friction_torques(bearing, speed, field)
    contact_force, contact_torque = contact_load(bearing, speed, field)
    shaft, bush = shaft - contact_torque, bush + contact_torque
    supply, ends, error = boundary_flows(field)
    return JournalBearingSolution(
        bearing=bearing,
        motion=motion,
        speed=speed,
        force=load[:2],
        moment=load[2:],
        friction_torque=shaft,
        bush_friction_torque=bush,
        contact_force=contact_force,
        contact_torque=contact_torque,
        end_flow=ends,
        supply_flow=supply,
        mass_balance_error=error,
        status=field.status,
        solved=field,
    )
