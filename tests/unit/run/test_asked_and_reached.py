"""What was asked against what was reached: a miss is a status with advice that works."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import xarray as xr

from tests.fake_solution import fake_solution
from toothspace import api
from toothspace.case import Case, load_case
from toothspace.core.status import Status
from toothspace.floating import coupling
from toothspace.floating.coupling import PointRequest
from toothspace.model.description import MachineDescription
from toothspace.results.solution import Solution
from toothspace.run import heating, running_in
from toothspace.run import run as runs
from toothspace.run.running_in import Tracks
from toothspace.studies.points import evaluate_points, point
from toothspace.studies.startup import started
from toothspace.studies.study import StudyContext

CASES = Path(__file__).resolve().parents[3] / "cases"
PUMP = CASES / "egm12_pump.toml"
QUICK = {"run__samples_per_revolution": 180, "run__relative_tolerance": 1e-4}


def serious(solution: Solution) -> list[str]:
    return [x.sentence for x in solution.warnings if x.severity == "serious"]


def test_a_miss_is_no_done_run_and_a_failure_stays_one() -> None:
    done = replace(fake_solution(), status=Status.DONE)
    assert done.short_of("").status is Status.DONE
    missed = done.short_of("It turns at half the speed. Lower the load.")
    assert missed.status is Status.NOT_REACHED
    assert serious(missed)[-1].startswith("It turns at half the speed.")
    cut = replace(done, status=Status.MAX_STEPS).short_of("It turns at half the speed.")
    assert cut.status is Status.MAX_STEPS


@pytest.mark.slow
def test_warm_films_beyond_the_fluid_are_not_reached_and_flushing_helps() -> None:
    hot = {
        "machine__journal_bearings__radial_clearance": "1 um",
        "operating_point__shaft_speed": "8000 rpm",
        "heat__model": "coupled",
        **QUICK,
    }
    found = api.simulate(PUMP, **hot)
    assert found.status is Status.NOT_REACHED
    assert "heat.bearing_flushing" in serious(found)[0]
    assert api.simulate(PUMP, heat__bearing_flushing="20 L/min", **hot).status is Status.DONE


@pytest.mark.slow
def test_temperatures_that_do_not_settle_are_not_reached(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(heating, "_ROUNDS", 1)
    monkeypatch.setattr(heating, "_AGREED", 1e-9)
    found = api.simulate(PUMP, heat__model="coupled", **QUICK)
    assert found.status is Status.NOT_REACHED
    assert "Temperatures still change" in serious(found)[0]
    assert api.simulate(PUMP, heat__model="network", **QUICK).status is Status.DONE


def test_a_track_that_still_changes_is_not_reached(monkeypatch: pytest.MonkeyPatch) -> None:
    depths = iter([1e-6, 4e-6])
    real = running_in.march_revolutions

    def restless(*given: Any) -> Any:
        return replace(real(*given), status=Status.NOT_CYCLIC)

    monkeypatch.setattr(running_in, "march_revolutions", restless)
    monkeypatch.setattr(running_in, "running_in_depths", lambda _: {"a": np.full(3, next(depths))})
    monkeypatch.setattr(running_in, "keep_arrays", lambda *_: None)
    monkeypatch.setattr(running_in, "load_arrays", lambda _: None)
    case = load_case(PUMP)
    tracks = running_in.run_in(case, api.describe(case))
    assert tracks.change == pytest.approx(3e-6)
    found = tracks.marked(replace(fake_solution(), status=Status.DONE))
    assert found.status is Status.NOT_REACHED
    assert "still changes by 3 µm, of 1 µm" in serious(found)[-1]


def test_a_track_within_two_percent_is_run_in() -> None:
    done = replace(fake_solution(), status=Status.DONE)
    settled = Tracks({"a": np.full(3, 10e-6)}, change=0.1e-6)
    assert settled.marked(done).status is Status.DONE
    cut = Tracks({"a": np.full(3, 10e-6)}, Status.STEP_TOO_SMALL)
    assert cut.marked(done).status is Status.STEP_TOO_SMALL


def test_seats_that_do_not_agree_are_not_reached(monkeypatch: pytest.MonkeyPatch) -> None:
    table = SimpleNamespace(seat_factor=1.0)
    monkeypatch.setattr(runs, "replace", lambda thing, **changes: thing)
    search = runs.SeatSearch(cast(MachineDescription, SimpleNamespace(lateral_table=table)))
    data = xr.Dataset(
        {
            "lateral_leakage_factor": ("s", [2.0]),
            "lateral_load_beyond": ("s", [0.0]),
            "shaft_speed": ("s", [1.0]),
        }
    )
    found = replace(fake_solution(), status=Status.DONE, data=data)
    while not search.agree_with(found):
        pass
    noted = search.noted(found)
    assert noted.status is Status.NOT_REACHED
    assert "Seats and gaps of the bearings do not agree" in serious(noted)[-1]


def test_an_elastic_run_keeps_what_its_temperatures_miss(monkeypatch: pytest.MonkeyPatch) -> None:
    """Films of the point that the solution belongs to, with the status of the solution."""
    first = replace(fake_solution(), status=Status.DONE)
    points = [
        SimpleNamespace(
            solution=replace(first, ledger=replace(first.ledger)),
            status=Status.DONE,
            equilibrium=SimpleNamespace(balance=SimpleNamespace(position=0.0)),
            log_leakage_factor=0.0,
        )
        for _ in range(2)
    ]
    made = iter(points)
    taken: list[Any] = []

    def films(chosen: Any, solution: Solution, *_: Any) -> Solution:
        taken.append(chosen)
        return solution

    def heated(machine: Any, march: Any) -> Solution:
        cold = march(machine)
        march(machine)
        missed: Solution = cold.short_of("Films would be too warm.")
        return missed

    monkeypatch.setattr(coupling, "couple_point", lambda *_: next(made))
    monkeypatch.setattr(coupling, "_with_films", films)
    request = PointRequest(settings=cast(Any, None), start=1e-6)
    anything = cast(Any, None)
    found = coupling.coupled_solution(anything, anything, anything, request, 1, heated=heated)
    assert found.status is Status.NOT_REACHED
    assert taken == [points[0]]


@pytest.fixture(scope="module")
def blocked() -> Case:
    return load_case(CASES / "startup_blocked.toml", ["circuit.duration=0.3 s"])


@pytest.mark.slow
def test_a_shaft_that_never_turns_is_told_and_no_start(blocked: Case) -> None:
    found = api.simulate(blocked)
    assert any(x.text.startswith("The shaft never turns") for x in found.warnings)
    assert found.status is Status.DONE
    assert started(blocked)["status"] == "not_reached"


def test_a_study_tells_what_a_point_did_not_reach(blocked: Case) -> None:
    [record] = evaluate_points([point(blocked, {})], StudyContext(), started)
    assert record.status == "not_reached"
    assert record.message.startswith("The shaft never turns")
