"""Runs that tighten their tolerance until revolutions agree and energies balance."""

from __future__ import annotations

from collections.abc import Callable
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.toy_machine import toy_machine
from toothspace.core.status import Status
from toothspace.model.assembly import System, assemble
from toothspace.model.fluid import GasModel, fluid_law
from toothspace.model.operating_point import OperatingCondition
from toothspace.solver import accuracy, cyclic
from toothspace.solver.accuracy import march_to_balance
from toothspace.solver.cyclic import History, RunPlan

Answers = dict[float, tuple[Status, float]]
"""Status and energy error, by tolerance."""


@pytest.fixture
def machine() -> System:
    condition = OperatingCondition(
        shaft_speed=150.0, inlet_pressure=1e5, outlet_pressure=50e5, drain_pressure=1e5
    )
    law = fluid_law("iso_vg_46", 323.15, GasModel(law="none", dissolved_air_fraction=0.08))
    return assemble(toy_machine(), law, condition)


@pytest.fixture
def answered(monkeypatch: pytest.MonkeyPatch) -> Callable[[Answers], list[tuple[float, int]]]:
    """Replace marches by answers; return the tolerances and revolutions that are asked for."""

    def answer(answers: Answers) -> list[tuple[float, int]]:
        asked: list[tuple[float, int]] = []

        def answer_at(system: Any) -> tuple[Status, float]:
            return answers[round(np.log10(system.condition.relative_tolerance))]

        def march(system: Any, plan: RunPlan, _progress: Any, _state: Any) -> History:
            asked.append((system.condition.relative_tolerance, plan.max_revolutions))
            status, _ = answer_at(system)
            statistics = {"revolutions": 10.0, "steps": 100.0}
            nothing = np.zeros((1, 1))
            return History(status, system, nothing, nothing, (), 10, statistics)

        def ledger(history: History) -> Any:
            return SimpleNamespace(energy_balance_error=answer_at(history.system)[1])

        monkeypatch.setattr(accuracy, "march_revolutions", march)
        monkeypatch.setattr(accuracy, "first_turn_state", lambda _: None)
        monkeypatch.setattr(accuracy, "window_ledger", ledger)
        return asked

    return answer


def test_a_run_that_balances_is_marched_once(
    machine: System, answered: Callable[[Answers], list[tuple[float, int]]]
) -> None:
    asked = answered({-6: (Status.DONE, 1e-6)})
    history = march_to_balance(machine, RunPlan(max_revolutions=40))
    assert asked == [(1e-6, 40)]
    assert history.statistics["relative_tolerance"] == 1e-6


@pytest.mark.parametrize("first", [(Status.DONE, 5e-5), (Status.NOT_REPEATING, 1.0)])
def test_the_tolerance_follows_energies_and_stalled_revolutions(
    first: tuple[Status, float],
    machine: System,
    answered: Callable[[Answers], list[tuple[float, int]]],
) -> None:
    asked = answered({-6: first, -7: (Status.DONE, 1e-6)})
    history = march_to_balance(machine, RunPlan(max_revolutions=40))
    assert [plan for _, plan in asked] == [40, 30]
    assert history.status is Status.DONE
    assert history.statistics["relative_tolerance"] == pytest.approx(1e-7)
    assert history.statistics["steps"] == 200.0
    assert history.statistics["revolutions"] == 20.0


def test_revolutions_that_still_come_closer_keep_the_tolerance(
    machine: System, answered: Callable[[Answers], list[tuple[float, int]]]
) -> None:
    asked = answered({-6: (Status.NOT_CYCLIC, 1.0)})
    assert march_to_balance(machine, RunPlan(max_revolutions=40)).status is Status.NOT_CYCLIC
    assert len(asked) == 1


def test_a_fixed_number_of_revolutions_is_marched_as_asked(
    machine: System, answered: Callable[[Answers], list[tuple[float, int]]]
) -> None:
    asked = answered({-6: (Status.DONE, 1e-3)})
    march_to_balance(machine, RunPlan(revolutions=3))
    assert len(asked) == 1


def test_a_cyclic_result_is_kept_where_the_tighter_march_fails(
    machine: System, answered: Callable[[Answers], list[tuple[float, int]]]
) -> None:
    answered({-6: (Status.DONE, 5e-5), -7: (Status.STEP_TOO_SMALL, 1.0)})
    history = march_to_balance(machine, RunPlan(max_revolutions=40))
    assert history.status is Status.DONE
    assert history.statistics["relative_tolerance"] == 1e-6


def test_revolutions_that_never_agree_end_before_the_last_with_their_own_advice(
    machine: System, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cyclic, "_change", lambda *_: (5.0, 0.0))
    plan = RunPlan(max_revolutions=40, samples_per_revolution=36)
    history = cyclic.march_revolutions(machine.at(relative_tolerance=1e-4), plan)
    assert history.status is Status.NOT_REPEATING
    assert history.revolutions < 40
    assert "run.revolutions" in history.status.value
    assert "max_revolutions" not in history.status.value


@pytest.mark.parametrize(
    ("changes", "status"),
    [
        ([1e3, 1e2, *([3.0, 5.0, 4.0, 3.5, 6.0, 3.0, 4.0, 5.0] * 2)], Status.NOT_REPEATING),
        ([1e3 * 0.95**k for k in range(40)], Status.NOT_CYCLIC),
    ],
)
def test_stalled_changes_are_told_from_slow_ones(
    changes: list[float], status: Status, machine: System, monkeypatch: pytest.MonkeyPatch
) -> None:
    given = iter(changes)
    # whether one revolution closes is asked with a single state
    monkeypatch.setattr(
        cyclic, "_change", lambda _, before, __: (next(given) if len(before) > 1 else 2.0, 0.0)
    )
    plan = RunPlan(max_revolutions=24, samples_per_revolution=36)
    history = cyclic.march_revolutions(machine.at(relative_tolerance=1e-4), plan)
    assert history.status is status


@pytest.mark.parametrize(("second", "marches"), [(9.0, 2), (1.0, 4)])
def test_what_smaller_errors_do_not_bring_closer_is_left(
    second: float, marches: int, machine: System, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Revolutions 10 limits apart: 9 at a tenth of the tolerance is no error of integration."""
    apart = iter([10.0, second, 0.1, 0.01])
    asked = []

    def march(system: Any, *_: Any) -> History:
        asked.append(system.condition.relative_tolerance)
        nothing, statistics = np.zeros((1, 1)), {"revolutions": 10.0}
        status = Status.NOT_REPEATING
        return History(status, system, nothing, nothing, (), 10, statistics, None, next(apart))

    monkeypatch.setattr(accuracy, "march_revolutions", march)
    monkeypatch.setattr(accuracy, "first_turn_state", lambda _: None)
    history = march_to_balance(machine, RunPlan(max_revolutions=60))
    assert history.status is Status.NOT_REPEATING
    assert len(asked) == marches
