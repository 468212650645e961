"""Chamber pressures and lateral films brought to agreement."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.floating.heat import SettledBearing, settle_bearing
from toothspace.floating.interpolation import InterpolatedEquilibrium, Trial
from toothspace.floating.problem import LateralProblem, LateralSettings, lateral_problem
from toothspace.floating.torque import lumped_torque, with_film_torque
from toothspace.model.description import MachineDescription
from toothspace.model.lateral_load import with_lateral_leakage
from toothspace.model.path_category import LATERAL_PATHS
from toothspace.numerics.roots import next_change
from toothspace.results.solution import Solution

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

    Parameters
    ----------
    description : MachineDescription
        The machine after running-in.
    run : callable
        Lumped solution at the operating point, of a changed machine.

    Raises
    ------
    KeyboardInterrupt
        If a lumped run is interrupted.

    Notes
    -----
    Secant method on the logarithm of the factor by which the lumped lateral and drain paths leak
    more. Where equilibria at the pressures of single runs jump from one side to the other, one is
    sought at pressures between two runs, see :class:`~.interpolation.InterpolatedEquilibrium`.
    The faces of
    every run drag like the films of the run before.
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
        found = settle_bearing(problem, begun)
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
