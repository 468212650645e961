"""March of the lateral films: progress, and what an interrupt by the user keeps."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import pytest

from tests.fake_solution import fake_solution
from tests.lateral_stack import HIGH, loads, pressures, ring_stack
from tests.toy_machine import toy_machine
from toothspace.core.status import Status
from toothspace.floating.coupling import PointRequest, couple_point, coupled_solution
from toothspace.floating.equilibrium import snapshots_over_pitch
from toothspace.floating.problem import LateralProblem, LateralSettings
from toothspace.results.solution import Solution


@pytest.fixture(scope="module")
def problem() -> LateralProblem:
    stack = ring_stack(high_share=0.7)
    snapshots = snapshots_over_pitch(stack, lambda _: pressures(HIGH), 1)
    return LateralProblem(
        stack, snapshots, loads(HIGH), lambda _: pressures(HIGH), LateralSettings(angles=1)
    )


def test_march_reports_its_progress(problem: LateralProblem) -> None:
    reported: list[tuple[float, str]] = []
    track = problem.march(
        problem.started(3e-6), 4, progress=lambda share, text: reported.append((share, text))
    )
    assert [share for share, _ in reported] == [0.25, 0.5, 0.75, 1.0]
    assert reported[0][1] == "film step 1 of 4"
    assert len(track.shaft_angle) == 4
    assert not track.interrupted


def test_interrupted_march_keeps_its_steps(problem: LateralProblem) -> None:
    def stop(share: float, text: str) -> None:
        if share > 0.4:
            raise KeyboardInterrupt

    whole = problem.march(problem.started(3e-6), 4)
    track = problem.march(problem.started(3e-6), 4, progress=stop)
    assert track.interrupted
    assert track.positions == whole.positions[:2]
    assert track.shaft_angle.tolist() == whole.shaft_angle[:2].tolist()
    assert track.last.position == pytest.approx(track.last.states[0].position)


def test_march_interrupted_at_once_keeps_nothing(
    problem: LateralProblem, monkeypatch: pytest.MonkeyPatch
) -> None:
    def stop(*args: Any, **rest: Any) -> None:
        raise KeyboardInterrupt

    monkeypatch.setattr("toothspace.floating.problem.march_angles", stop)
    with pytest.raises(KeyboardInterrupt):
        problem.march(problem.started(3e-6), 4)


NOTHING: Any = None
"""Machine, fluid and settings that a replaced function does not look at."""


def test_interrupt_beside_the_films_keeps_the_lumped_solution(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    reported: list[str] = []

    def couple(description: Any, fluid: Any, run: Any, request: Any) -> Any:
        run(description)
        raise KeyboardInterrupt

    monkeypatch.setattr("toothspace.floating.coupling.couple_point", couple)
    lumped = fake_solution()
    found = coupled_solution(
        NOTHING, NOTHING, lambda _: lumped, NOTHING, 12, lambda _, text: reported.append(text)
    )
    assert found.status is Status.INTERRUPTED
    assert found.data is lumped.data
    assert reported == ["lateral films settle, round 1"]


def test_interrupted_lumped_run_ends_the_point(monkeypatch: pytest.MonkeyPatch) -> None:
    def went_on(*_: Any) -> Any:
        raise AssertionError("went on")

    coupling = "toothspace.floating.coupling"
    monkeypatch.setattr(f"{coupling}.lateral_problem", went_on)
    monkeypatch.setattr(f"{coupling}.with_lateral_leakage", lambda machine, _: machine)
    cut = replace(fake_solution(), status=Status.INTERRUPTED)
    request = PointRequest(settings=NOTHING, start=1e-6)
    machine = toy_machine()
    with pytest.raises(KeyboardInterrupt):
        couple_point(machine, NOTHING, lambda _: cut, request)
    assert (
        coupled_solution(machine, NOTHING, lambda _: cut, request, 12).status is Status.INTERRUPTED
    )


def test_interrupt_before_any_result_is_passed_on(monkeypatch: pytest.MonkeyPatch) -> None:
    def run(_: Any) -> Solution:
        raise KeyboardInterrupt

    def couple(description: Any, fluid: Any, run: Any, request: Any) -> Any:
        return run(description)

    monkeypatch.setattr("toothspace.floating.coupling.couple_point", couple)
    with pytest.raises(KeyboardInterrupt):
        coupled_solution(NOTHING, NOTHING, run, NOTHING, 12)
