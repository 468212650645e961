"""Runs whose energies balance, at the tolerance that this takes: cyclic ones, and over time."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace

import numpy as np

from toothspace.closures.density import mixture_density
from toothspace.core.progress import Progress
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.model.assembly import System
from toothspace.results.solution import Solution
from toothspace.solver.cyclic import (
    History,
    RunPlan,
    first_turn_state,
    march_revolutions,
    march_several,
)
from toothspace.solver.outcome import window_ledger

ENERGY_BALANCE = 1e-5
"""Largest energy error of a cyclic revolution, or of a run over time. [-]"""

_TIGHTER = 0.1
_TIGHTEST = 1e-9
_NEARER = 0.5
"""Change between revolutions over that at ten times the tolerance that errors would leave. [-]"""


def march_to_balance(
    system: System, plan: RunPlan, progress: Progress | None = None, state: Array | None = None
) -> History:
    """March until cyclic with energies that balance, tightening the tolerance for it.

    A tolerance at which the errors of the integration keep two revolutions apart, or leave more
    than 1e-5 of the energy unexplained, is lowered by a factor of ten from the state reached.

    The last revolution; its statistics count all steps and hold ``relative_tolerance``.

    Parameters
    ----------
    system : System
        Machine at its operating point, with the tolerance to begin with.
    plan : RunPlan
        Most revolutions in all; a fixed number of them is marched at the tolerance given.
    progress : callable, optional
        Called with the finished share and a short text.
    state : ndarray, optional
        State to begin with.
    """
    return balanced(march_revolutions(system, plan, progress, state), plan, progress)


def balanced(history: History, plan: RunPlan, progress: Progress | None = None) -> History:
    """Go on from a march at lower tolerances until it repeats and its energies balance.

    Parameters
    ----------
    history : History
        March with the tolerance to begin with.
    plan, progress
        As for :func:`march_to_balance`; the revolutions of the march count.
    """
    system = history.system
    tolerance = system.condition.relative_tolerance
    history = _counted(history, tolerance)
    while plan.revolutions is None and not plan.by_pitch:
        if history.status not in (Status.DONE, Status.NOT_REPEATING):
            break
        repeats = history.status is Status.DONE
        if repeats and window_ledger(history).energy_balance_error <= ENERGY_BALANCE:
            break
        tolerance *= _TIGHTER
        left = plan.max_revolutions - int(history.statistics["revolutions"])
        if tolerance < _TIGHTEST or left < 2:
            break
        rest = replace(plan, max_revolutions=left)
        tighter = system.at(relative_tolerance=tolerance)
        again = march_revolutions(tighter, rest, progress, first_turn_state(history))
        if repeats and again.status is not Status.DONE:
            break
        as_far_apart = again.apart > _NEARER * history.apart
        history = _counted(again, tolerance, history.statistics)
        # what smaller errors do not bring closer is the machine's own
        if history.status is Status.NOT_REPEATING and as_far_apart:
            break
    repeats = history.status is not Status.NOT_REPEATING
    return history if repeats else _over_several(history, plan, progress)


def _over_several(history: History, plan: RunPlan, progress: Progress | None) -> History:
    """Several revolutions whose energies balance, from a march whose revolutions differ."""
    tolerance = history.statistics["relative_tolerance"]
    found = march_several(history, plan, mean_errors, progress)
    found = _counted(found, tolerance, history.statistics)
    while found.status is Status.DONE:
        tolerance *= _TIGHTER
        balances = window_ledger(found).energy_balance_error <= ENERGY_BALANCE
        if balances or tolerance < _TIGHTEST:
            break
        tighter = replace(found, system=found.system.at(relative_tolerance=tolerance))
        again = march_several(tighter, plan, mean_errors, progress)
        if again.status is not Status.DONE:
            break
        found = _counted(again, tolerance, found.statistics)
    return found


def mean_errors(revolutions: Sequence[History]) -> tuple[float, float]:
    """Standard errors of mean flow and mean torque over revolutions that follow each other. [-].

    Of the flow over that of the displacement, of the torque over the larger of its mean and that of
    an ideal machine. Half the difference of the two halves of the revolutions where that is larger,
    as of means that drift.
    """
    system, condition = revolutions[0].system, revolutions[0].system.condition
    displacement = system.description.displacement
    flows, torques = [], []
    for one in revolutions:
        ledger = window_ledger(one)
        flows.append(ledger.mass["outlet"] / ledger.shaft_angle)
        torques.append(ledger.shaft_energy / ledger.shaft_angle)
    fluid = system.arrays.fluid
    density = mixture_density(condition.inlet_pressure, fluid.feed_gas_mass_fraction, fluid)
    ideal = displacement * abs(condition.outlet_pressure - condition.inlet_pressure)
    torque = max(ideal, abs(float(np.mean(torques))))
    return _error_of_mean(flows) / (float(density) * displacement), _error_of_mean(torques) / torque


def _error_of_mean(given: Sequence[float]) -> float:
    """How far the mean of values of successive revolutions may be from that of very many."""
    values = np.array(given)
    first, second = np.array_split(values, 2)
    scatter = float(values.std(ddof=1)) / np.sqrt(values.size)
    return max(scatter, 0.5 * abs(float(first.mean() - second.mean())))


def solve_to_balance(system: System, solve: Callable[[System], Solution]) -> Solution:
    """Solution over time whose energies balance, solved again at a tighter tolerance for it.

    The last that was done; its statistics hold ``relative_tolerance``.

    Parameters
    ----------
    system : System
        Machine in its circuit, with the tolerance to begin with.
    solve : callable
        Runs a system from its start.
    """
    tolerance = system.condition.relative_tolerance
    found = solve(system).with_note(relative_tolerance=tolerance)
    while found.status is Status.DONE and found.ledger.energy_balance_error > ENERGY_BALANCE:
        tolerance *= _TIGHTER
        if tolerance < _TIGHTEST:
            break
        again = solve(system.at(relative_tolerance=tolerance))
        if again.status is not Status.DONE:
            break
        found = again.with_note(relative_tolerance=tolerance)
    return found


def _counted(
    history: History, tolerance: float, before: Mapping[str, float] | None = None
) -> History:
    """History whose statistics hold its tolerance and count the steps before it too."""
    earlier = before or {}
    counts = {name: value + earlier.get(name, 0.0) for name, value in history.statistics.items()}
    return replace(history, statistics={**counts, "relative_tolerance": tolerance})
