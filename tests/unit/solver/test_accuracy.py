"""Runs that tighten their tolerance until revolutions agree and energies balance."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from tests.toy_machine import toy_system
from toothspace.core.status import Status
from toothspace.model.assembly import System
from toothspace.solver import accuracy, cyclic
from toothspace.solver.accuracy import march_to_balance
from toothspace.solver.cyclic import History, RunPlan

Answers = dict[float, tuple[Status, float]]
"""Status and energy error, by tolerance."""


@pytest.fixture
def machine() -> System:
    return toy_system()


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
    assert "run.averaged_revolutions" in history.status.value
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
    monkeypatch.setattr(accuracy, "march_several", lambda history, *_: history)
    history = march_to_balance(machine, RunPlan(max_revolutions=60))
    assert history.status is Status.NOT_REPEATING
    assert len(asked) == marches


def one_revolution(machine: System) -> History:
    plan = RunPlan(revolutions=1, samples_per_revolution=36)
    return cyclic.march_revolutions(machine.at(relative_tolerance=1e-4), plan)


def test_a_machine_that_repeats_itself_every_third_revolution_is_told_by_three(
    machine: System, monkeypatch: pytest.MonkeyPatch
) -> None:
    """A change that counts as none is seen between revolutions three apart alone."""
    monkeypatch.setattr(
        cyclic,
        "_difference",
        lambda _, __, ___, turn: (abs(turn / (2.0 * np.pi) - 3.0) + 0.5, 0.0),
    )
    plan = RunPlan(samples_per_revolution=36)
    first = one_revolution(machine)
    found = cyclic.march_several(first, plan, accuracy.mean_errors)
    assert found.status is Status.DONE
    assert (found.spanned, found.revolutions, found.mean_errors) == (3, 4, None)
    assert found.states[-1, 0] - found.states[0, 0] == pytest.approx(6.0 * np.pi, rel=1e-9)
    assert len(found.times) == 3 * 36 + 1
    assert np.all(np.diff(found.times) > 0.0)
    # this machine repeats itself in truth: three revolutions deliver three times one
    one, three = (accuracy.window_ledger(history) for history in (first, found))
    assert three.shaft_energy == pytest.approx(3.0 * one.shaft_energy, rel=2e-2)


@pytest.mark.parametrize(
    ("errors", "most", "status", "marched"),
    [
        ((0.004, 0.001), 64, Status.DONE, 8),
        ((0.03, 0.001), 32, Status.NOT_REPEATING, 32),
        ((0.001, 0.03), 10, Status.NOT_REPEATING, 10),
    ],
)
def test_a_machine_that_never_repeats_itself_is_told_by_means(
    errors: tuple[float, float],
    most: int,
    status: Status,
    marched: int,
    machine: System,
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """As many revolutions as leave half a percent of them open; many keep fewer samples of each."""
    monkeypatch.setattr(cyclic, "_difference", lambda *_: (5.0, 0.0))
    asked = []

    def errors_of(revolutions: Sequence[History]) -> tuple[float, float]:
        asked.append(len(revolutions))
        return errors

    plan = RunPlan(samples_per_revolution=36, averaged_revolutions=most)
    found = cyclic.march_several(one_revolution(machine), plan, errors_of)
    assert (found.status, found.spanned, found.revolutions) == (status, marched, marched)
    assert asked == [n for n in (8, 10, 16, 32) if n <= marched and (n != 10 or most == 10)]
    assert found.mean_errors == errors
    assert found.states[-1, 0] - found.states[0, 0] == pytest.approx(2.0 * np.pi * marched)
    assert len(found.times) <= 16 * 36 + 1


def test_errors_of_means_are_those_of_scatter_or_of_drift(
    machine: System, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Flows 1, 3, 1, 3: standard deviation over root of four. Torques 1, 1, 3, 3: half apart."""
    condition, displacement = machine.condition, machine.description.displacement
    ideal = displacement * (condition.outlet_pressure - condition.inlet_pressure)
    one = accuracy.window_ledger(one_revolution(machine))
    density = 870.0
    monkeypatch.setattr(accuracy, "mixture_density", lambda *_: density)
    ledgers = iter(
        replace(
            one,
            mass={**one.mass, "outlet": 0.01 * flow * density * displacement * one.shaft_angle},
            energy={"shaft": 0.01 * torque * ideal * one.shaft_angle},
        )
        for flow, torque in zip((1, 3, 1, 3), (1, 1, 3, 3), strict=True)
    )
    monkeypatch.setattr(accuracy, "window_ledger", lambda _: next(ledgers))
    found = accuracy.mean_errors([one_revolution(machine)] * 4)
    assert found == pytest.approx((0.01 * np.sqrt(4.0 / 3.0) / 2.0, 0.01))


@pytest.mark.parametrize(("again", "kept"), [(Status.DONE, 1e-7), (Status.NOT_REPEATING, 1e-6)])
def test_means_whose_energies_do_not_balance_are_marched_tighter_and_kept_where_that_fails(
    again: Status, kept: float, machine: System, monkeypatch: pytest.MonkeyPatch
) -> None:
    marched: list[float] = []

    def several(history: History, *_: Any) -> History:
        marched.append(history.system.condition.relative_tolerance)
        status = Status.DONE if len(marched) == 1 else again
        return replace(history, status=status, statistics={"revolutions": 8.0})

    def ledger(_: History) -> SimpleNamespace:
        return SimpleNamespace(energy_balance_error=5e-5 if len(marched) == 1 else 1e-6)

    monkeypatch.setattr(accuracy, "march_several", several)
    monkeypatch.setattr(accuracy, "window_ledger", ledger)
    nothing = np.zeros((1, 1))
    history = History(
        Status.NOT_REPEATING, machine, nothing, nothing, (), 10, {"revolutions": 10.0}
    )
    found = accuracy.balanced(history, RunPlan(max_revolutions=10))
    assert marched == pytest.approx([1e-6, 1e-7])
    assert found.status is Status.DONE
    assert found.statistics["relative_tolerance"] == pytest.approx(kept)
