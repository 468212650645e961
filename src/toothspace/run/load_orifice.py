"""A load orifice sized so that the mean outlet pressure is the one asked for."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from toothspace.closures.orifice import DISCHARGE_COEFFICIENT
from toothspace.core.progress import UNKNOWN, Progress, tell
from toothspace.run.running_in import CUT_SHORT
from toothspace.solver.accuracy import Assembled, march_to_balance
from toothspace.solver.compiled_model import observe
from toothspace.solver.cyclic import History, RunPlan, first_turn_state, march_revolutions

_LOAD_ROUNDS = 4
_LOAD_SETTLED = 1e-2
_EVERY = 32
"""Every so many of the dense states count to the mean pressure."""
_LOAD_MATCH = 2e-3
_WITHOUT_LEAKAGE = 0.5
_MOST_LEAKAGE = 1.5
"""Powers of the pressure that the area of the load orifice grows with. [-]"""


def march_against_orifice(
    machine: Assembled, plan: RunPlan, last: History | None, progress: Progress | None
) -> tuple[History, str]:
    """Size the load orifice until the mean outlet pressure is the one asked for.

    Returns
    -------
    history : History
        The last revolution.
    told : str
        What was not reached, empty if nothing.
    """
    condition = machine.condition
    wanted = condition.outlet_pressure - condition.load_pressure

    def loaded(area: float) -> Assembled:
        return replace(machine, condition=replace(condition, load_area=area))

    history = last or _roughly_sized(machine, loaded, wanted, plan, progress)
    area, found = history.system.condition.load_area, _gauge_pressure(history)
    exponent = _WITHOUT_LEAKAGE
    for _ in range(_LOAD_ROUNDS):
        if history.status in CUT_SHORT:
            break
        wider, before = (found / wanted) ** exponent, found
        area *= wider
        history = march_to_balance(loaded(area), plan, progress, first_turn_state(history))
        found = _gauge_pressure(history)
        if abs(found / wanted - 1.0) < _LOAD_MATCH:
            break
        if abs(wider - 1.0) > _LOAD_MATCH:
            slope = np.log(wider) / np.log(before / found)
            exponent = float(np.clip(slope, _WITHOUT_LEAKAGE, _MOST_LEAKAGE))
    return history, ""


def _roughly_sized(
    machine: Assembled,
    loaded: Callable[[float], Assembled],
    wanted: float,
    plan: RunPlan,
    progress: Progress | None,
) -> History:
    """March against the orifice of a machine that does not leak until its pressure settles."""

    def sizing(_: float, text: str) -> None:
        tell(progress, UNKNOWN, f"load orifice, {text}")

    condition, density = machine.condition, machine.fluid.reference_density
    flow = machine.description.displacement * condition.shaft_speed
    area = flow / (DISCHARGE_COEFFICIENT * np.sqrt(2.0 * wanted / density))
    system, once = loaded(area).at(condition.relative_tolerance), replace(plan, revolutions=1)
    history = march_revolutions(system, once, sizing)
    found, settled = _gauge_pressure(history), False
    while history.status not in CUT_SHORT and not settled:
        history = march_revolutions(system, once, sizing, first_turn_state(history))
        before, found = found, _gauge_pressure(history)
        settled = abs(found / before - 1.0) < _LOAD_SETTLED
    return history


def _gauge_pressure(history: History) -> float:
    """Mean pressure of the outlet volume over the last revolution, above that of the load. [Pa]."""
    dense = history.dense
    # dense states, so that the orifice does not hang on the samples
    states = history.states if dense is None else dense.states[::_EVERY]
    seen = observe(history.system.arrays, states[: max(len(states) - 1, 1)])
    mean = float(seen.pressure[:, history.system.description.outlet_node].mean())
    return mean - history.system.condition.load_pressure
