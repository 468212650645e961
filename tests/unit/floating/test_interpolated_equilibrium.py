"""Bearing between chambers that a wider gap drains: rest at pressures between two runs."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.lateral_stack import AREA, HIGH, loads, pressures, ring_stack
from toothspace.floating.coupling import (
    InterpolatedEquilibrium,
    SettledBearing,
    Trial,
)
from toothspace.floating.equilibrium import snapshots_over_pitch
from toothspace.floating.motion import Balance, balance_force
from toothspace.floating.problem import LateralProblem, LateralSettings, numbers_of
from toothspace.floating.stack import HoldingSpring, leaning, stop_forces

PUSHED, PRESSED = 60e5, 38e5
"""Pressures round the ring that lift the bearing off and press it on, before high pressure behind
less than half of its back. [Pa]"""
LEAKAGE = (2e-6, 2e-5)
"""Leakage of the paths at these pressures. [m3/s]"""


def _problem(rim: float, arrangement: str, coulomb: float = 0.0) -> LateralProblem:
    stack = ring_stack(
        high_share=0.45, approach=5e-13, cells=(12, 6), arrangement=arrangement, speed=100.0
    )
    snapshots = snapshots_over_pitch(stack, lambda _: pressures(rim), 1)
    return LateralProblem(
        stack, snapshots, loads(HIGH, coulomb), lambda _: pressures(rim), LateralSettings(angles=1)
    )


def _settle(problem: LateralProblem, begun: Balance, warm: np.ndarray | None) -> SettledBearing:
    found = problem.settle(begun)
    numbers = numbers_of(problem, found.balance)
    return SettledBearing(problem=problem, equilibrium=found, numbers=numbers)


def _trials(arrangement: str, coulomb: float = 0.0) -> list[Trial]:
    found = []
    for k, rim in enumerate((PUSHED, PRESSED)):
        problem = _problem(rim, arrangement, coulomb)
        start = problem.stack.start(5e-6)
        log_leakage_factor = float(np.log(LEAKAGE[k] / LEAKAGE[0]))
        found.append(Trial(log_leakage_factor, LEAKAGE[k], problem, start, 1.0 - 2.0 * k, 1))
    return found


@pytest.mark.slow
def test_films_push_off_at_one_run_and_close_at_the_other() -> None:
    pushed, pressed = _trials("asymmetric")
    away = pushed.problem.settle(pushed.problem.started(5e-6)).balance
    near = pressed.problem.settle(pressed.problem.started(5e-6)).balance
    assert leaning(pushed.problem.stack, away.position)
    assert numbers_of(pressed.problem, near).leakage < 0.1 * LEAKAGE[1]


@pytest.mark.parametrize("arrangement", ["asymmetric", "symmetric"])
def test_interpolated_equilibrium_leaks_as_the_paths_and_leaves_no_force(arrangement: str) -> None:
    low, high = _trials(arrangement)
    share, held = InterpolatedEquilibrium(low, high, _settle).equilibrium(high.position)
    assert 0.0 < share < 1.0
    assert held.equilibrium.settled
    wanted = LEAKAGE[0] * (LEAKAGE[1] / LEAKAGE[0]) ** share
    assert held.numbers.leakage == pytest.approx(wanted, rel=5e-3)
    state, stack = held.balance.states[0], held.problem.stack
    found = state.film_force() + state.back_force(held.problem.loads.back)
    answer = stop_forces(stack, held.balance.position)[0]
    scale = balance_force(stack, held.problem.loads.back)
    assert abs(stack.opening @ (found + answer)) < 5e-6 * scale
    assert abs(stack.opening @ answer) < 2e-4 * scale
    assert held.balance.residual < 5e-6
    # chambers that a wider gap drains hold the bearing like a spring
    assert stack.holding_spring is not None
    opening = float(stack.opening @ held.balance.position)
    assert stack.holding_spring.opening == pytest.approx(opening, rel=1e-3)
    fall = 0.645 * (PUSHED - PRESSED) * AREA / np.log(10.0)
    bearings, gaps = len(stack.moving_bearings), held.numbers.gaps
    # one bearing opens both films, two bearings open one film each
    assert stack.holding_spring.stiffness == pytest.approx(
        3.0 * fall * bearings**2 / gaps.sum(), rel=0.02
    )


def test_bearing_that_rose_stays_where_friction_of_the_housing_holds_it() -> None:
    low, high = _trials("asymmetric", coulomb=40.0)
    _, held = InterpolatedEquilibrium(low, high, _settle).equilibrium(high.position)
    assert held.balance.friction == pytest.approx([-40.0])
    state = held.balance.states[0]
    left = state.film_force() + state.back_force(held.problem.loads.back)
    assert left[0] == pytest.approx(40.0, abs=1.0)


def test_ends_on_the_same_side_are_no_equilibrium() -> None:
    low, high = _trials("asymmetric")
    _, held = InterpolatedEquilibrium(
        low, replace(low, leakage=2.0 * low.leakage), _settle
    ).equilibrium(high.position)
    assert not held.equilibrium.settled
    assert "films and chambers leave" in held.equilibrium.reason


def test_guide_holds_the_mean_opening_of_both_bearings() -> None:
    problem = _problem(PUSHED, "symmetric")
    stack = replace(problem.stack, holding_spring=HoldingSpring(12e-6, 1e11))
    guided = replace(problem, stack=stack)
    found = guided.settle(guided.started(11e-6))
    assert found.settled
    assert float(stack.opening @ found.balance.position) == pytest.approx(12e-6, rel=1e-2)
    q = found.balance.position
    assert stack.positions(q) - q[stack.first_body] == pytest.approx([12e-6, -12e-6], rel=2e-2)
