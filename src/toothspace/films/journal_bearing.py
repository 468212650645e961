"""Journal bearing with mass-conserving cavitation: forces, flows, friction, equilibrium."""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property, lru_cache
from typing import final

import numpy as np

from toothspace.core.constants import ATMOSPHERIC_PRESSURE
from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.films.journal_film import (
    EndConditions,
    Groove,
    JournalMesh,
    MotionState,
    journal_gap,
    journal_grid,
    journal_load,
    journal_mesh,
    journal_shear,
)
from toothspace.films.reynolds import (
    FilmGrid,
    FluidField,
    GapField,
    balance_derivative,
    balance_variation,
    film_balance,
)
from toothspace.films.rough_surfaces import SMOOTH, FlowLaw, RoughSurfaces, contact_field
from toothspace.numerics.complementarity import (
    PRESCRIBED,
    SATURATED,
    ComplementaritySolution,
    Constraint,
    face_flows,
    residual,
    solve_complementarity,
)
from toothspace.numerics.structured_grid import CellBalance

CAVITATION = {
    "guembel": Constraint.NONE,
    "reynolds": Constraint.OBSTACLE,
    "jfo": Constraint.CONSERVING,
}
"""Cavitation models by name."""

Pair = tuple[float, float]


@final
@dataclass(frozen=True, kw_only=True)
class JournalBearing:
    r"""Film between a rigid shaft and a rigid cylindrical bush.

    Parameters
    ----------
    diameter : float
        Bore of the bush. [m]
    length : float
        Axial length of the film. [m]
    radial_clearance : float
        Radius of the bush minus radius of the shaft. [m]
    dynamic_viscosity : float
        Dynamic viscosity. [Pa s]
    grid : tuple of int
        Cells round the circumference and along the axis. [-]
    cavitation : {"jfo", "reynolds", "guembel"}
        Mass-conserving film fraction, pressure obstacle, or clipped pressure.
    grooves : tuple of Groove
        Grooves of given pressure in the bush.
    end_pressure : float
        Absolute pressure beyond both ends. [Pa]
    cavitation_pressure : float
        Absolute pressure in the cavity. [Pa]
    end_condition : {"pressure", "no_flow"}
        Whether the ends are open or walls.
    surfaces : RoughSurfaces, optional
        Roughness and contact; the shaft is the moving wall. Smooth walls if not given.
    supply : {"auto", "none", "widest_gap"}
        Ideal axial supply line at end pressure on the widest gap. ``auto`` adds it where oil
        could not enter otherwise: no grooves, and ends not above the cavitation pressure.

    Notes
    -----
    Angles run from x towards y, the direction of positive ``shaft_speed``. Forces act on
    the shaft by the film. With a film fraction :math:`s` the flow is

    .. math::

        \nabla\cdot\left(-\frac{h^3}{12\mu}\nabla p + s h \frac{\omega R}{2}\mathbf e
        \right) + s\,\frac{\partial h}{\partial t} = 0, \quad
        p \ge p_c,\ s \le 1,\ (p - p_c)(1 - s) = 0 .

    Validity: laminar, isoviscous, incompressible, no inertia, :math:`c \ll R`; the film
    fraction follows the motion of the shaft without delay.

    References
    ----------
    .. [1] H. G. Elrod, A cavitation algorithm, J. Lubr. Technol. 103 (1981) 350-354.

    Examples
    --------
    >>> from math import pi
    >>> bearing = JournalBearing(
    ...     diameter=0.1, length=0.08, radial_clearance=150e-6, dynamic_viscosity=0.01
    ... )
    >>> film = bearing.solve(eccentricity=(0.6, 0.0), shaft_speed=100.0 * pi)
    >>> round(film.attitude_angle * 180.0 / pi)
    50
    """

    diameter: float
    length: float
    radial_clearance: float
    dynamic_viscosity: float
    grid: tuple[int, int] = (200, 53)
    cavitation: str = "jfo"
    grooves: tuple[Groove, ...] = ()
    end_pressure: float = ATMOSPHERIC_PRESSURE
    cavitation_pressure: float = ATMOSPHERIC_PRESSURE
    end_condition: str = "pressure"
    surfaces: RoughSurfaces | None = None
    supply: str = "auto"

    def __post_init__(self) -> None:
        for key in ("diameter", "length", "radial_clearance", "dynamic_viscosity"):
            value = getattr(self, key)
            if not value > 0.0:
                raise CaseError(f"bearing.{key}: found {value!r}, allowed are positive numbers")
        for key, allowed in _CHOICES.items():
            value = getattr(self, key)
            if value not in allowed:
                raise CaseError(f"bearing.{key}: found {value!r}, allowed are {sorted(allowed)}")
        if min(self.grid) < 4:
            raise CaseError(f"bearing.grid: found {self.grid!r}, allowed are 4 cells or more")
        object.__setattr__(self, "grooves", tuple(self.grooves))

    def solve(
        self,
        *,
        eccentricity: Pair = (0.0, 0.0),
        shaft_speed: float,
        velocity: Pair = (0.0, 0.0),
        tilt: Pair = (0.0, 0.0),
        tilt_rate: Pair = (0.0, 0.0),
        bush_speed: float = 0.0,
    ) -> JournalBearingSolution:
        """Film for a given position and motion of the shaft.

        Parameters
        ----------
        eccentricity : tuple of float
            Displacement x, y of the shaft over the radial clearance. [-]
        shaft_speed : float
            Rotation of the shaft, positive from x towards y. [rad/s]
        velocity : tuple of float
            Velocity x, y of the shaft axis. [m/s]
        tilt : tuple of float
            Rotation of the shaft about the x and y axis, right-handed. [rad]
        tilt_rate : tuple of float
            Time derivative of the tilt. [rad/s]
        bush_speed : float
            Rotation of the bush; grooves stay where they are. [rad/s]

        Returns
        -------
        JournalBearingSolution
            Pressure, film fraction and everything derived from them.

        Raises
        ------
        CaseError
            If shaft and bush touch.
        """
        place = np.array([*(self.radial_clearance * np.asarray(eccentricity, float)), *tilt])
        motion = MotionState(place, np.array([*velocity, *tilt_rate], dtype=float))
        return solve_motion(self, motion, SurfaceSpeed(shaft_speed, bush_speed))

    def equilibrium(
        self,
        *,
        load: Pair,
        shaft_speed: float,
        start: Pair | None = None,
        bush_speed: float = 0.0,
    ) -> JournalBearingSolution:
        """Steady position of the shaft under a load.

        Parameters
        ----------
        load : tuple of float
            External force x, y on the shaft. [N]
        shaft_speed : float
            Rotation of the shaft, positive from x towards y. [rad/s]
        start : tuple of float, optional
            Eccentricity to begin with. [-]
        bush_speed : float
            Rotation of the bush. [rad/s]

        Returns
        -------
        JournalBearingSolution
            Film in equilibrium; ``status`` tells whether it was found.
        """
        from toothspace.films.equilibrium import find_equilibrium

        speed = SurfaceSpeed(shaft_speed, bush_speed)
        return find_equilibrium(self, np.asarray(load, dtype=float), speed, start)


_CHOICES = {
    "cavitation": set(CAVITATION),
    "end_condition": {"pressure", "no_flow"},
    "supply": {"auto", "none", "widest_gap"},
}


@final
@dataclass(frozen=True)
class SurfaceSpeed:
    """Rotation of shaft and bush. [rad/s]."""

    shaft: float
    bush: float = 0.0


@final
@dataclass(frozen=True)
class _Contact:
    """Asperity pressure of the cells and its derivative with the gap."""

    pressure: Array
    slope: Array


@final
@dataclass(frozen=True)
class _Film:
    """Discrete film and its solution, kept for variations."""

    mesh: JournalMesh
    grid: FilmGrid
    gap: GapField
    fluid: FluidField
    balance: CellBalance
    fields: ComplementaritySolution
    law: FlowLaw
    contact: _Contact | None

    @cached_property
    def gauge(self) -> Array:
        """Pressure above the cavitation pressure; Guembel's model clips it here. [Pa]."""
        return np.maximum(self.fields.potential, 0.0)


@final
@dataclass(frozen=True)
class JournalBearingSolution:
    """Film of a journal bearing; forces and moments act on the shaft by the film."""

    bearing: JournalBearing
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
    film: _Film = field(repr=False)

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
    def sommerfeld_number(self) -> float:
        r"""Load parameter :math:`S = (\eta N / P) (R / c)^2`, N in 1/s. [-]."""
        return 1.0 / (2.0 * np.pi * self.sommerfeld_number_din) if self.load > 0.0 else np.inf

    @property
    def sommerfeld_number_din(self) -> float:
        r"""Load parameter :math:`So = P \psi^2 / (\eta \omega)`. [-]."""
        b = self.bearing
        ratio = 2.0 * b.radial_clearance / b.diameter
        speed = abs(self.speed.shaft + self.speed.bush)
        if speed == 0.0:
            return np.inf
        return self.load / (b.diameter * b.length) * ratio**2 / (b.dynamic_viscosity * speed)

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
    def max_pressure(self) -> float:
        """Highest absolute pressure. [Pa]."""
        return float(self.film.gauge.max()) + self.bearing.cavitation_pressure

    @property
    def min_gap_height(self) -> float:
        """Smallest gap height. [m]."""
        return float(min(self.film.gap.centre.min(), self.film.gap.face_y.min()))

    @property
    def cavitated_fraction(self) -> float:
        """Part of the film area at cavitation pressure with a film fraction below one. [-]."""
        film = self.film
        empty = np.where(_cavitated(film.fields, film.balance), film.grid.area, 0.0)
        return float(empty.sum() / film.grid.area.sum())

    @property
    def pressure(self) -> Array:
        """Absolute pressure over angle and axis, whole film. [Pa]."""
        return self._whole(self.film.gauge) + self.bearing.cavitation_pressure

    @property
    def film_fraction(self) -> Array:
        """Film fraction over angle and axis, whole film. [-]."""
        return self._whole(self.film.fields.saturation)

    @property
    def gap_height(self) -> Array:
        """Gap height over angle and axis, whole film. [m]."""
        return self._whole(self.film.gap.centre)

    @property
    def angle(self) -> Array:
        """Angles of the cell centres. [rad]."""
        return self.film.mesh.angle

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
        return load_derivatives(self.film, self.bearing.radial_clearance, (0, 1))

    def coefficients(self) -> tuple[Array, Array]:
        """Stiffness and damping 4x4 for x, y and rotations about x and y.

        Units follow force [N] and moment [N m] over displacement [m] and rotation [rad].
        """
        whole = self
        if self.film.mesh.weight > 1.0:
            whole = solve_motion(self.bearing, self.motion, self.speed, half=False)
        derivatives = load_derivatives(whole.film, self.bearing.radial_clearance, (0, 1, 2, 3))
        return -derivatives[:, :4], -derivatives[:, 4:]

    def _whole(self, values: Array) -> Array:
        if self.film.mesh.weight == 1.0:
            return values.copy()
        mirrored = values[:, ::-1]
        if self.bearing.grid[1] % 2:
            mirrored = mirrored[:, :-1]
        return np.concatenate([mirrored, values], axis=1)


@lru_cache(maxsize=32)
def _metric(
    bearing: JournalBearing, grooves: tuple[Groove, ...], first_angle: float, half: bool
) -> tuple[JournalMesh, FilmGrid]:
    mesh = journal_mesh(bearing.length, bearing.grid, first_angle, half=half)
    wall = bearing.end_condition == "no_flow"
    ends = EndConditions(bearing.end_pressure, bearing.end_pressure, wall)
    return mesh, journal_grid(mesh, 0.5 * bearing.diameter, grooves, ends)


def _needs_supply(bearing: JournalBearing, surface_speed: float) -> bool:
    if bearing.supply != "auto":
        return bearing.supply == "widest_gap"
    dry_ends = (
        bearing.end_condition == "no_flow" or bearing.end_pressure <= bearing.cavitation_pressure
    )
    return dry_ends and not bearing.grooves and surface_speed != 0.0


def _supplied(
    bearing: JournalBearing, place: Array, surface_speed: float
) -> tuple[tuple[Groove, ...], float]:
    """Grooves with the supply line, and the angle at which the grid begins."""
    if not _needs_supply(bearing, surface_speed):
        return bearing.grooves, 0.0
    widest = float(np.arctan2(-place[1], -place[0])) if np.any(place[:2]) else np.pi
    line = Groove(widest, 0.0, bearing.length, bearing.end_pressure)
    return (*bearing.grooves, line), widest


def solve_motion(
    bearing: JournalBearing,
    motion: MotionState,
    speed: SurfaceSpeed,
    *,
    half: bool | None = None,
    former: JournalBearingSolution | None = None,
) -> JournalBearingSolution:
    """Film of a bearing for a rigid motion of its shaft; see :meth:`JournalBearing.solve`.

    A former solution nearby gives the cavity to begin with.
    """
    radius = 0.5 * bearing.diameter
    surface_speed = 0.5 * (speed.shaft + speed.bush) * radius
    grooves, first_angle = _supplied(bearing, motion.place, surface_speed)
    if half is None:
        tilted = np.any(motion.place[2:]) or np.any(motion.speed[2:])
        half = not tilted and all(g.position == 0.0 for g in grooves)
    mesh, unit_grid = _metric(bearing, grooves, first_angle, half)
    grid = unit_grid._replace(sweep_x=unit_grid.sweep_x * surface_speed)
    gap = journal_gap(mesh, bearing.radial_clearance, motion)
    law, contact = _walls(bearing, speed, gap)
    if contact is None:
        _refuse_contact(gap, motion, bearing)
    fluid = FluidField(
        np.full(gap.centre.shape, 1.0 / bearing.dynamic_viscosity), np.ones(gap.centre.shape)
    )
    balance = film_balance(grid, gap, fluid, bearing.cavitation_pressure, law)
    fields = _solve_fields(balance, CAVITATION[bearing.cavitation], former)
    film = _Film(mesh, grid, gap, fluid, balance, fields, law, contact)
    return _evaluate(bearing, motion, speed, film)


def _walls(
    bearing: JournalBearing, speed: SurfaceSpeed, gap: GapField
) -> tuple[FlowLaw, _Contact | None]:
    """Average flow law and asperity pressure; smooth walls have none."""
    surfaces = bearing.surfaces
    if surfaces is None:
        return SMOOTH, None
    total = speed.shaft + speed.bush
    law = surfaces.flow_law((speed.shaft - speed.bush) / total if total != 0.0 else 0.0)
    pressure, slope = contact_field(gap.centre, surfaces.roughness, surfaces.contact_table())
    return law, _Contact(pressure, slope)


def _solve_fields(
    balance: CellBalance, constraint: Constraint, former: JournalBearingSolution | None
) -> ComplementaritySolution:
    if former is not None and former.film.fields.kind.shape == balance.storage.shape:
        start = former.film.fields.kind
        fields = solve_complementarity(balance, constraint, start, max_passes=15)
        if fields.converged:
            return fields
    return solve_complementarity(balance, constraint)


def _refuse_contact(gap: GapField, motion: MotionState, bearing: JournalBearing) -> None:
    lowest = min(float(gap.centre.min()), float(gap.face_x.min()), float(gap.face_y.min()))
    if lowest <= 0.0:
        ratio = float(np.hypot(*motion.place[:2])) / bearing.radial_clearance
        raise CaseError(
            f"bearing.eccentricity: found a smallest gap of {lowest:.3g} m at an eccentricity "
            f"ratio of {ratio:.4g}, allowed are positions without contact"
        )


def _evaluate(
    bearing: JournalBearing, motion: MotionState, speed: SurfaceSpeed, film: _Film
) -> JournalBearingSolution:
    fields = film.fields
    carried = film.gauge if film.contact is None else film.gauge + film.contact.pressure
    load = journal_load(film.mesh, carried, film.grid.area)
    shaft, bush = _friction(bearing, speed, film)
    contact_force, contact_torque = _contact_load(bearing, speed, film)
    shaft, bush = shaft - contact_torque, bush + contact_torque
    supply, ends, error = _flows(film)
    status = Status.DONE if fields.converged else Status.NOT_CONVERGED
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
        status=status,
        film=film,
    )


def _contact_load(bearing: JournalBearing, speed: SurfaceSpeed, film: _Film) -> tuple[Array, float]:
    """Force on the shaft by asperities, and the torque by which they brake it."""
    if film.contact is None or bearing.surfaces is None:
        return np.zeros(2), 0.0
    force = journal_load(film.mesh, film.contact.pressure, film.grid.area)[:2]
    normal = film.mesh.weight * float((film.contact.pressure * film.grid.area).sum())
    sense = float(np.sign(speed.shaft - speed.bush))
    return force, sense * bearing.surfaces.boundary_friction * normal * 0.5 * bearing.diameter


def _friction(bearing: JournalBearing, speed: SurfaceSpeed, film: _Film) -> tuple[float, float]:
    """Torques on shaft and bush; a cavity carries shear in proportion to its film fraction."""
    radius = 0.5 * bearing.diameter
    couette, pattern, pressure = film.mesh.weight * journal_shear(
        film.gap, film.gauge, film.fields.saturation, film.mesh, film.law
    )
    scale = bearing.dynamic_viscosity * (speed.shaft - speed.bush) * radius**3
    shaft = -scale * (couette - pattern) - radius * pressure
    return shaft, scale * (couette + pattern) - radius * pressure


def _flows(film: _Film) -> tuple[float, Array, float]:
    """Supply by prescribed cells, flow out of the two ends, relative error of the balance."""
    weight, b = film.mesh.weight, film.balance
    potential, saturation = film.gauge, film.fields.saturation
    _, flow_y = face_flows(b, b, potential, saturation)
    net = residual(b, b, potential, saturation)
    prescribed = b.mark == PRESCRIBED
    supply = weight * float(net[prescribed].sum())
    north = float(flow_y[:, -1].sum())
    south = north if weight > 1.0 else -float(flow_y[:, 0].sum())
    through = max(
        abs(supply), abs(north), abs(south), float(np.abs(b.advection_x).sum(axis=1).max())
    )
    through = max(through, float(np.abs(b.storage).sum()))
    error = weight * abs(float(net[~prescribed].sum()))
    return supply, np.array([south, north]), error / through if through > 0.0 else 0.0


def _cavitated(fields: ComplementaritySolution, balance: CellBalance) -> Array:
    """Cells at cavitation pressure that are not prescribed."""
    return (balance.mark != PRESCRIBED) & (fields.potential <= 0.0)


def load_derivatives(film: _Film, clearance: float, directions: tuple[int, ...]) -> Array:
    """Derivatives of force and moment with position and speed of the shaft, cavity boundary exact.

    Returns an array of 4 rows (force x, y, moment x, y) and, for every direction, one column
    per position and then one per speed. [N or N m over m, rad, m/s, rad/s]
    """
    slope = balance_derivative(film.grid, film.gap, film.fluid, film.balance, film.law)
    columns = [
        _load_variation(film, _unit_motion(k, speeds), slope)
        for speeds in (False, True)
        for k in directions
    ]
    return np.array(columns).T


def _unit_motion(direction: int, speeds: bool) -> MotionState:
    unit = np.zeros(4)
    unit[direction] = 1.0
    return MotionState(np.zeros(4), unit) if speeds else MotionState(unit, np.zeros(4))


def _load_variation(film: _Film, motion: MotionState, slope: CellBalance) -> Array:
    """Change of force and moment per unit of one position or speed."""
    change = journal_gap(film.mesh, 0.0, motion)
    varied = balance_variation((film.grid, film.gap, film.fluid), change, slope, film.law)
    fields = film.fields
    disturbance = residual(film.balance, varied, fields.potential, fields.saturation)
    disturbance[fields.kind == PRESCRIBED] = 0.0
    response = fields.system.solve(-disturbance.ravel()).reshape(disturbance.shape)
    response[(fields.kind != SATURATED) | (fields.potential <= 0.0)] = 0.0
    if film.contact is not None:
        response += film.contact.slope * change.centre
    return np.asarray(journal_load(film.mesh, response, film.grid.area))
