"""Chamber pressures and lateral films brought to agreement, and an equilibrium between two runs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.progress import UNKNOWN, Progress, tell
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.core.units import ZERO_CELSIUS
from toothspace.floating.elastic_faces import face_deflection
from toothspace.floating.heat import SettledBearing, settle_bearing
from toothspace.floating.housing_friction import HousingFriction
from toothspace.floating.motion import Balance, Loads, balance_force
from toothspace.floating.problem import (
    LateralNumbers,
    LateralProblem,
    LateralSettings,
    film_fields,
    film_places,
    lateral_problem,
    numbers_of,
)
from toothspace.floating.stack import HoldingSpring, MovingBearing, Snapshot, leaning
from toothspace.floating.torque import lumped_torque, with_film_torque
from toothspace.model.description import MachineDescription
from toothspace.model.lateral_load import axial_load, with_lateral_leakage
from toothspace.model.path_category import LATERAL_PATHS
from toothspace.numerics.roots import next_change
from toothspace.results.solution import Solution
from toothspace.results.variables import VARIABLES

_LEAKAGE, _MOST_PLACES = 3e-3, 8
"""Difference of the logarithm of two leakages that agree, and most steps to it. [-]"""
_FORCE, _LEFT_FORCE = 1e-6, 1e-4
"""Force left over that behind the bearing: on films alone, and where chambers respond too. [-]"""
_MOST_SHARES = 16
_APART = 3e-3
"""Difference of the logarithm of two leakages that gives a stiffness. [-]"""
_LEFT = "films and chambers leave {:.3g} N on the bearing"
_LEAST_STEP = 0.5
"""Smallest part to which one change of the holding spring may take a gap. [-]"""


@final
@dataclass(frozen=True, eq=False)
class Trial:
    """A lumped run whose lateral paths leak by a factor more."""

    log_leakage_factor: float
    """Logarithm of the factor. [-]"""
    leakage: float
    """Leakage of the lateral paths. [m3/s]"""
    problem: LateralProblem
    """Films at its pressures."""
    position: Array
    """Where bearings and gears were found. [m, rad]"""
    excess: float
    """Positive if the bearing lifts further than the leakage of the paths fits."""
    sense: int
    """Sense in which the bearing has moved: 1 away from the gears."""
    held: SettledBearing | None = None
    """Bearing held at the opening that leaks as the paths do, once it is known."""


Settle = Callable[[LateralProblem, Balance, Array | None], SettledBearing]
"""Equilibrium of a problem from a state and temperatures of its films, if they are known. [K]"""


@final
class InterpolatedEquilibrium:
    """Bearing held at pressures between two trials, linear in the logarithm of their leakage.

    A wider gap drains the chambers that lift the bearing. At given pressures the films have next
    to no stiffness, so a little less leakage sends the bearing to its cover. A spring therefore
    holds it where films and paths leak alike, and the pressures are sought that leave no force
    on it.

    Parameters
    ----------
    low : Trial
        Films push the bearing further than its paths leak.
    high : Trial
        The bearing stays nearer than its paths leak.
    settle : callable
        Equilibrium of a problem from a state.
    stiffness : float
        Response of the chambers to a wider opening that is known from trials further apart. [N/m]
    """

    def __init__(self, low: Trial, high: Trial, settle: Settle, stiffness: float = 0.0) -> None:
        self._ends, self._settle, self._known_stiffness = (low, high), settle, stiffness
        self._temperatures: Array | None = None
        self._scale = balance_force(low.problem.stack, low.problem.loads.back)
        senses = {low.sense, high.sense} - {0}
        self._sense = senses.pop() if len(senses) == 1 else 0

    def at(self, share: float, position: Array) -> SettledBearing:
        """Bearing at the opening that leaks as the paths do, from a position. [m, rad].

        Parameters
        ----------
        share : float
            Part of the way from the first trial to the second. [-]
        position : ndarray
            Where the search starts.
        """
        low, high = self._ends
        wanted = (1.0 - share) * np.log(low.leakage) + share * np.log(high.leakage)
        # films at pressures between the trials
        first, second = (end.problem for end in self._ends)

        def between(a: Array, b: Array) -> Array:
            return np.asarray((1.0 - share) * a + share * b)

        snapshots: tuple[Snapshot, ...] = tuple(
            s._replace(
                node_pressure=between(s.node_pressure, t.node_pressure),
                thrust=between(s.thrust, t.thrust)
                if s.thrust is not None and t.thrust is not None
                else None,
            )
            for s, t in zip(first.snapshots, second.snapshots, strict=True)
        )
        problem = replace(
            (first, second)[round(share)],
            snapshots=snapshots,
            node_pressure=lambda angle: between(
                first.node_pressure(angle), second.node_pressure(angle)
            ),
        )
        place = float(problem.stack.opening @ position)
        known: tuple[float, float] | None = None
        for _ in range(_MOST_PLACES):
            guided = problem.held_at(place)
            spring = guided.stack.holding_spring
            assert spring is not None
            found = self._settle(guided, guided.continued(position), self._temperatures)
            self._temperatures = found.temperatures
            opened = float(guided.stack.opening @ found.balance.position)
            pull = spring.stiffness * (place - opened)
            excess = (-self._sense * self._friction - pull) / self._scale
            held = replace(found, excess=excess)
            error = float(np.log(max(held.numbers.leakage, 1e-30)) - wanted)
            if abs(error) <= _LEAKAGE or not held.equilibrium.settled:
                break
            position = held.balance.position
            room = _room(held)
            # the opening that corrects the leakage, at first by the cube of the gaps
            step = room * float(np.expm1(-error / 3.0))
            if known is not None and known[1] != error:
                secant = -error * (place - known[0]) / (error - known[1])
                step = secant if secant * error < 0.0 else step
            step = float(np.clip(step, -_LEAST_STEP * room, room / _LEAST_STEP))
            known, place = (place, error), place + step
        return held

    def equilibrium(self, position: Array) -> tuple[float, SettledBearing]:
        """Share at which the films leave no force on the holding spring, and the state there.

        Regula falsi, the force of an end that stays halved (Illinois).
        """
        ends = [end.held or self.at(float(k), position) for k, end in enumerate(self._ends)]
        (a, fa), (b, fb) = (0.0, ends[0].excess), (1.0, ends[1].excess)
        share, held = (0.0, ends[0]) if abs(fa) < abs(fb) else (1.0, ends[1])
        stiffness = self._stiffness(*ends)
        # friction, or the chambers that answer to a wider gap, take what is left
        goal = _LEFT_FORCE if self._friction > 0.0 or stiffness > 0.0 else _FORCE
        for _ in range(_MOST_SHARES if fa > 0.0 > fb else 0):
            share = (a * fb - b * fa) / (fb - fa)
            # from the state before, whose films are nearly those of this share
            held = self.at(share, held.balance.position)
            if abs(held.excess) <= goal or not held.equilibrium.settled:
                break
            if held.excess > 0.0:
                a, fa, fb = share, held.excess, 0.5 * fb
            else:
                b, fb, fa = share, held.excess, 0.5 * fa
        return share, self._freed(share, held, stiffness, abs(held.excess) <= goal)

    def _stiffness(self, first: SettledBearing, second: SettledBearing) -> float:
        """Response of the force of chambers and films to a wider opening. [N/m].

        Leakage grows with the cube of the gaps.
        """
        low, high = self._ends
        apart = float(np.log(high.leakage / low.leakage))
        if abs(apart) < _APART:
            return self._known_stiffness
        force = self._scale * (first.excess - second.excess)
        return max(3.0 * force / (apart * _room(second)), 0.0)

    def _freed(
        self, share: float, held: SettledBearing, stiffness: float, balanced: bool
    ) -> SettledBearing:
        """State with friction and the response of the chambers in place of the holding spring.

        There is no equilibrium if a force is left on the holding spring.
        """
        # loads change little between the ends: those of the nearer one
        loads = self._ends[round(share)].problem.loads
        place = float(held.problem.stack.opening @ held.balance.position)
        stack = replace(held.problem.stack, holding_spring=HoldingSpring(place, stiffness))
        problem = replace(held.problem, stack=stack, loads=loads)
        friction = [
            self._sense * part.sign * law.coulomb_force * law.holds
            for part, law in self._laws(loads)
        ]
        states = tuple(replace(s, stack=stack) for s in held.balance.states)
        left = 0.0 if self._friction > 0.0 else abs(held.excess)
        balance = replace(
            held.balance,
            states=states,
            friction=np.array(friction),
            residual=max(held.balance.residual, left),
        )
        if self._friction == 0.0 < stiffness and balanced:
            return self._settle(problem, problem.continued(balance.position), held.temperatures)
        found = replace(held.equilibrium, balance=balance)
        if not balanced and found.settled:
            found = replace(found, settled=False, reason=_LEFT.format(held.excess * self._scale))
        return replace(
            held, problem=problem, equilibrium=found, numbers=numbers_of(problem, balance)
        )

    def _laws(self, loads: Loads) -> list[tuple[MovingBearing, HousingFriction]]:
        moving_bearings = self._ends[0].problem.stack.moving_bearings
        return [(part, loads.law(k)) for k, part in enumerate(moving_bearings)]

    @property
    def _friction(self) -> float:
        """Force with which the housing holds all bearings while they slide. [N]."""
        laws = self._laws(self._ends[1].problem.loads)
        return sum(law.coulomb_force for _, law in laws if law.holds) * abs(self._sense)


def _room(held: SettledBearing) -> float:
    """Opening that closes all gaps. [m]."""
    sides = 1.0 if held.problem.stack.two_floating else 2.0
    return sides * float(held.numbers.gaps.mean())


LumpedRun = Callable[[MachineDescription], Solution]
"""Lumped solution of a machine at the operating point."""

_AGREEMENT = 0.02
"""Difference of leakage or torque at which films and chambers agree. [-]"""
NEGLIGIBLE = 5e-4
"""Difference of leakage over displaced flow at which films and chambers agree. [-]"""
_NEGLIGIBLE_TORQUE = 5e-5
"""Difference of torque over that of the displaced volume at which both agree. [-]"""
_TOLERATED = 20.0
"""Part of a negligible difference above which a point has failed. [-]"""
_LONGEST_CHANGE = 3.0
"""Largest change of the logarithm of the leakage of the paths in one round. [-]"""
_STILL = 1e-10
"""Lift of a bearing that counts as none. [m]"""
_NARROW = 0.1
"""Difference of two runs between which a bearing that friction holds breaks away. [-]"""
_STEEP = 2.0
"""Slope of the logarithm of film over path leakage from which single runs lead nowhere. [-]"""


@final
@dataclass(frozen=True, kw_only=True)
class PointRequest:
    """What is asked of one operating point."""

    settings: LateralSettings
    """Grids and laws of the films."""
    start: Array | float
    """Positions and rotations of all bodies, or a gap everywhere, to begin with. [m, rad]"""
    nose_pressure: float | None = None
    """Absolute pressure on the nose; None: the low pressure. [Pa]"""
    log_leakage_factor: float = 0.0
    """Logarithm of the leakage of the paths over that of the closed form, to begin with. [-]"""
    rounds: int = 12
    """Most lumped runs at this point; one leaves the paths of the network as they are."""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class CoupledPoint(SettledBearing):
    """Bearing in equilibrium between films that agree with the chambers."""

    solution: Solution
    """Last lumped solution."""
    description: MachineDescription
    """The machine with the lateral gaps that were found."""
    log_leakage_factor: float = 0.0
    """Logarithm of the leakage of its paths over that of the closed form. [-]"""
    leakage_mismatch: float
    """Leakage of films less that of the lumped paths, over the displaced flow. [-]"""
    torque_mismatch: float = 0.0
    """Torque of films less that of the lumped faces, over that of the displaced volume. [-]"""
    agreed: bool = True
    """Whether films and paths were brought to agree, or were not meant to be, and temperatures with
    the power dissipated.
    """

    @property
    def temperature_rise(self) -> float | None:
        """Temperature of the hottest film above the fluid; None where none warms up. [K]."""
        heating = self.problem.settings.heating
        if self.temperatures is None or heating is None:
            return None
        return float(self.temperatures.max()) - heating.balance.supply_temperature

    @property
    def status(self) -> Status:
        """Outcome of the lumped run, or failure of the force balance or of the agreement."""
        settled = self.equilibrium.settled and self.agreed
        return self.solution.status if settled else Status.NOT_CONVERGED


def agree(films: float, paths: float, negligible: float) -> bool:
    """Whether leakage or torque of films and of the lumped network agree."""
    return abs(films - paths) <= max(_AGREEMENT * abs(films), negligible)


def path_leakage(solution: Solution) -> float:
    """Leakage beside the gears in a lumped run, mean over its samples. [m3/s]."""
    return float(
        solution.data["equivalent_leakage"]
        .sel(path=[c.name for c in LATERAL_PATHS])
        .sum("path")
        .mean()
    )


def couple_point(
    description: MachineDescription, fluid: FluidLaw, run: LumpedRun, request: PointRequest
) -> CoupledPoint:
    """Find gaps and chamber pressures that agree about lateral leakage and torque.

    Raises KeyboardInterrupt if a lumped run is interrupted.

    Parameters
    ----------
    description : MachineDescription
        The machine after running-in.
    run : callable
        Lumped solution at the operating point, of a changed machine.

    Notes
    -----
    Secant method on the logarithm of the factor by which the lumped lateral and drain paths leak
    more. Where equilibria at the pressures of single runs jump from one side to the other, one is
    sought at pressures between two runs, see :class:`InterpolatedEquilibrium`. The faces of every
    run drag like the films of the run before.
    """
    search = _LeakageSearch(replace(description, lateral_table=None), fluid, run, request)
    point, close = search.advance()
    for _ in range(request.rounds - 1):
        if close:
            break
        point, close = search.advance()
    return point


@final
class _LeakageSearch:
    """Lumped runs and equilibria of the bearing in turn."""

    def __init__(
        self, description: MachineDescription, fluid: FluidLaw, run: LumpedRun, asked: PointRequest
    ) -> None:
        self._dragged, self._fluid, self._run, self._asked = description, fluid, run, asked
        self._log_leakage_factor = asked.log_leakage_factor
        self._known: list[Trial] = []
        self._ends: tuple[Trial, Trial] | None = None
        self._position: Array | None = None
        self._stiffness = 0.0
        self._rest: SettledBearing | None = None

    def advance(self) -> tuple[CoupledPoint, bool]:
        """Make one more lumped run and find the equilibrium; return whether both agree, too."""
        factor = self._log_leakage_factor
        # the network has no films: its paths leak more by a factor until both leak alike
        machine = with_lateral_leakage(self._dragged, float(np.exp(factor)))
        solution = self._run(machine)
        if solution.status is Status.INTERRUPTED:
            raise KeyboardInterrupt  # films of pressures cut short are no point
        settings, nose = self._asked.settings, self._asked.nose_pressure
        problem = lateral_problem(machine, self._fluid, solution.data, settings, nose)
        leakage = path_leakage(solution)
        # where single runs jump from one side to the other the bearing is held in between
        solve = self._free if self._ends is None else self._held
        found = solve(problem, leakage)
        # torque changes the chambers less than leakage does, so it may lag by one run
        viscosity = self._fluid.dynamic_viscosity
        self._dragged = with_film_torque(
            self._dragged, viscosity, solution.data, found.equilibrium.balance
        )
        numbers, back = found.numbers, found.problem.loads.back
        flow = machine.displacement * found.problem.stack.shaft_speed
        ideal = machine.displacement * (back.high - back.low)
        torque = numbers.viscous_torque + numbers.asperity_torque
        dragged = lumped_torque(solution.data)
        pairs = (
            (numbers.leakage, leakage, NEGLIGIBLE * flow),
            (torque, dragged, _NEGLIGIBLE_TORQUE * ideal),
        )
        close = all(agree(a, b, least) for a, b, least in pairs)
        agreed = all(agree(a, b, _TOLERATED * least) for a, b, least in pairs)
        point = CoupledPoint(
            **vars(found),
            solution=solution,
            description=machine,
            log_leakage_factor=factor,
            leakage_mismatch=(numbers.leakage - leakage) / flow,
            torque_mismatch=(torque - dragged) / ideal,
            agreed=found.warm and (agreed or self._asked.rounds == 1),
        )
        return point, close

    def _free(self, problem: LateralProblem, leakage: float) -> SettledBearing:
        """Equilibrium at the pressures of the run; sets how the paths leak in the next one."""
        start = self._asked.start
        begun = problem.started(start) if isinstance(start, float) else problem.continued(start)
        last = self._rest
        known = (None, None) if last is None else (last.temperatures, last.equilibrium)
        found = self._rest = settle_bearing(problem, begun, *known)
        if leakage <= 0.0 or found.numbers.leakage <= 0.0:
            return found
        # friction holds a bearing that did not move: its leakage then says nothing of its balance
        moved = problem.stack.opening @ (found.balance.position - begun.position)
        excess = float(np.log(found.numbers.leakage / leakage))
        sense = int(np.sign(moved)) if abs(moved) > _STILL else 0
        trial = Trial(
            self._log_leakage_factor, leakage, problem, found.balance.position, excess, sense
        )
        self._known.append(trial)
        # leakage spans decades and answers as a power of the gap: steps on its logarithm
        self._ends = _ends(self._known)
        if self._ends is None:
            self._log_leakage_factor += next_change(
                [(t.log_leakage_factor, t.excess) for t in self._known], _LONGEST_CHANGE
            )
        else:
            self._position = self._ends[1].position
            self._interpolated()
        return found

    def _held(self, problem: LateralProblem, leakage: float) -> SettledBearing:
        """Equilibrium at pressures between those of this run and of the other end."""
        assert self._ends is not None
        assert self._position is not None
        low, high = self._ends
        trial = Trial(self._log_leakage_factor, leakage, problem, self._position, 0.0, high.sense)
        held = InterpolatedEquilibrium(trial, trial, settle_bearing).at(0.0, self._position)
        trial = replace(trial, position=held.balance.position, excess=held.excess, held=held)
        self._ends = (trial, high) if held.excess > 0.0 else (low, trial)
        return self._interpolated()

    def _interpolated(self) -> SettledBearing:
        """Equilibrium between the ends; the next run leaks as much."""
        assert self._ends is not None
        assert self._position is not None
        low, high = self._ends
        known = InterpolatedEquilibrium(low, high, settle_bearing, self._stiffness)
        share, found = known.equilibrium(self._position)
        holding_spring = found.problem.stack.holding_spring
        self._stiffness = holding_spring.stiffness if holding_spring else 0.0
        self._position = found.balance.position
        self._log_leakage_factor = (
            1.0 - share
        ) * low.log_leakage_factor + share * high.log_leakage_factor
        return found


def _ends(trials: list[Trial]) -> tuple[Trial, Trial] | None:
    """Nearest trials with opposite errors between which the bearing jumps, None without.

    A bearing that friction holds where it began is followed until it breaks away.
    """
    last = trials[-1]
    opposite = [t for t in trials if t.excess * last.excess < 0.0]
    if not opposite:
        return None
    other = min(opposite, key=lambda t: abs(t.log_leakage_factor - last.log_leakage_factor))
    apart = abs(last.log_leakage_factor - other.log_leakage_factor)
    if last.sense * other.sense == 0 and apart > _NARROW:
        return None
    # a slope that the secant method can follow needs no holding spring
    if abs(last.excess - other.excess) <= _STEEP * apart:
        return None
    return (last, other) if last.excess > 0.0 else (other, last)


_TOO_WARM = (
    "Lateral films find no temperature up to {:.0f} degC, to which the fluid is known, at which "
    "their viscosity agrees with the heat that they dissipate. Lower operating_point.shaft_speed "
    "or the pressure, or set run.film_oil_share = 0 for films at the temperature of the fluid."
)
_DISAGREE = (
    "Lateral films and chambers do not agree: the films leak {:+.2g} % of the displaced flow more "
    "than the chambers lose, and their torque is {:+.2g} % of the ideal torque above that in the "
    "run. Refine run.film_grid, or change the pressure a little."
)

HeatedRun = Callable[[MachineDescription, Callable[[MachineDescription], Solution]], Solution]
"""Solution with temperatures, from a machine and what repeats it with other viscosities."""


def _as_cold(
    description: MachineDescription, run: Callable[[MachineDescription], Solution]
) -> Solution:
    return run(description)


def coupled_solution(
    description: MachineDescription,
    fluid: FluidLaw,
    run: LumpedRun,
    request: PointRequest,
    steps: int,
    progress: Progress | None = None,
    *,
    heated: HeatedRun = _as_cold,
) -> Solution:
    """Operating point with its lateral films over one revolution.

    Raises KeyboardInterrupt if interrupted before there was a lumped solution; a later interrupt
    keeps what is done.

    Parameters
    ----------
    description, fluid, run, request
        Machine, fluid, lumped solution and settings, as for :func:`couple_point`.
    steps : int
        Steps of the march over the revolution. [-]
    progress : callable, optional
        Called with a fraction and a text.
    heated : callable
        Solution of the machine with the temperatures of its films, from one that repeats it with
        other viscosities; without temperatures if not given.
    """
    done: list[Solution] = []
    points: list[CoupledPoint] = []

    def lumped(changed: MachineDescription) -> Solution:
        done.append(run(changed))
        tell(progress, UNKNOWN, f"lateral films settle, round {len(done)}")
        return done[-1]

    def coupled(changed: MachineDescription) -> Solution:
        begun = request
        if points:
            last = points[-1]
            place, factor = last.equilibrium.balance.position, last.log_leakage_factor
            begun = replace(request, start=place, log_leakage_factor=factor)
        points.append(couple_point(changed, fluid, lumped, begun))
        return replace(points[-1].solution, status=points[-1].status)

    try:
        solution = heated(description, coupled)
        # films that would be too warm leave the first point, at the temperature of the fluid
        point = next(p for p in points if p.solution.ledger is solution.ledger)
        return _with_films(point, solution, steps, progress)
    except KeyboardInterrupt:
        if not done:
            raise
        return replace(done[-1], status=Status.INTERRUPTED)


def _with_films(
    point: CoupledPoint, solution: Solution, steps: int, progress: Progress | None
) -> Solution:
    """Lumped solution with film fields at the end of a revolution and the way of the bearing.

    Of an interrupted march as far as it came.
    """
    march = point.problem.march(point.equilibrium.balance, steps, progress=progress)
    stack = point.problem.stack
    data = solution.data
    angle = np.mod(data["shaft_angle"].values, 2.0 * np.pi)
    position = np.interp(angle, march.shaft_angle, march.positions, period=2.0 * np.pi)
    fields = {**film_fields(march.last), **film_places(stack)}
    fields["film_wear_power"] = march.wear
    if point.temperatures is not None:
        fields["film_temperature"] = point.temperatures
    values: dict[str, object] = {}
    for name, field in {**fields, "bearing_position": position}.items():
        entry = VARIABLES[name]
        dimensions = ("shaft_angle",) if field is position else entry.dimensions
        values[name] = dimensions, field, {"long_name": entry.long_name, "units": entry.units}
    data = data.assign(values).assign_coords(
        film=("film", [grid.interface.name for grid in stack.grids])
    )
    data = data.set_coords(list(film_places(stack)))
    status = solution.status if march.converged else Status.NOT_CONVERGED
    status = Status.INTERRUPTED if march.interrupted else status
    force, moment = axial_load(point.problem.stack.balance, point.problem.node_pressure)
    rise, numbers = point.temperature_rise, point.numbers
    sides = np.array([grid.interface.side for grid in stack.grids])
    return replace(solution, status=status, data=data).with_note(
        hold_down_warning(numbers),
        equilibrium_warning(point),
        lateral_leakage=numbers.leakage,
        lateral_leakage_mismatch=point.leakage_mismatch,
        lateral_torque_mismatch=point.torque_mismatch,
        lateral_torque=numbers.viscous_torque + numbers.asperity_torque,
        lateral_smallest_gap=numbers.smallest_gap,
        **{f"{s}_side_gap": float(numbers.gaps[sides == s].mean()) for s in ("floating", "solid")},
        lateral_contact_force=numbers.contact_force,
        lateral_real_contact_area=numbers.real_contact_area,
        lateral_contact_share=numbers.contact_share,
        lateral_wear_power=numbers.wear_power,
        lateral_housing_friction=numbers.friction_force,
        solid_bearing_seat_force=numbers.hold_down_force,
        solid_bearing_seat_margin=numbers.tipping_margin,
        lateral_axial_force=force,
        lateral_axial_moment=moment,
        **({} if rise is None else {"lateral_temperature_rise": rise}),
        floating_bearing_preload=stack.balance.floating.preload.size,
        lateral_iterations=float(sum(march.iterations)),
        lateral_equilibrium_residual=point.equilibrium.balance.residual,
        lateral_residual=float(max(march.residuals)),
        **face_deflection(march.last.states[0]),
    )


def hold_down_warning(numbers: LateralNumbers) -> str:
    """Warning that the solid bearing lifts off its cover or tips, empty if it does not."""
    if numbers.hold_down_force <= 0.0:
        return (
            f"The solid bearing lifts off its cover: {-numbers.hold_down_force:.4g} N are missing "
            "at one shaft angle at least."
        )
    if numbers.tipping_margin < 0.0:
        return (
            "The solid bearing tips on its cover: it is pressed "
            f"{-numbers.tipping_margin * 1e3:.3g} mm beyond its rim at one shaft angle at least."
        )
    return ""


def equilibrium_warning(point: CoupledPoint) -> str:
    """Why there is no equilibrium, or on what bodies lean; empty if films carry all."""
    found, heating = point.equilibrium, point.problem.settings.heating
    if not found.settled:
        return f"Bearing and gears do not reach equilibrium: {found.reason}."
    if not point.warm and heating is not None:
        highest = heating.balance.highest_temperature - ZERO_CELSIUS
        return _TOO_WARM.format(highest)
    if not point.agreed:
        return _DISAGREE.format(100.0 * point.leakage_mismatch, 100.0 * point.torque_mismatch)
    held = leaning(point.problem.stack, found.balance.position)
    return f"In equilibrium {'; '.join(held)}." if held else ""
