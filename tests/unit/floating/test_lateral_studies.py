"""Studies of a floating bearing: numbers, figures and page from points of a plain ring."""

from __future__ import annotations

import json
from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest
import xarray as xr

from tests.lateral_stack import conditions, loads, pressures, ring_stack
from toothspace.case import Case, load_case
from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.floating.coupling import CoupledPoint
from toothspace.floating.problem import LateralProblem, LateralSettings, numbers_of
from toothspace.report.study import study_report_html
from toothspace.run.run import Run
from toothspace.studies import bearing_path, bearing_points, run_study, study_figures
from toothspace.studies.balance_sweep import BalanceSweepStudy
from toothspace.studies.bearing_path import BearingMapStudy, HysteresisStudy, NosePressureStudy
from toothspace.studies.bearing_points import (
    LateralStudy,
    PointCondition,
    StoredPoint,
    record_of,
    recorded_point,
    stored_point,
)
from toothspace.studies.study import Record, Records, StudyContext

CASES = Path(__file__).parents[3] / "cases"
UP_AND_DOWN = (20e5, 40e5, 60e5, 40e5, 20e5)


def _points(pressure: tuple[float, ...], coulomb: float) -> tuple[StoredPoint, ...]:
    stack = ring_stack(approach=3e-13, high_share=0.68, preload=400.0, cells=(12, 8))
    now, found = None, []
    for high in pressure:
        problem = LateralProblem(
            stack,
            (stack.snapshot(0.0, pressures(high)),),
            loads(high, coulomb * high / 60e5),
            lambda _, high=high: pressures(high),
            LateralSettings(),
        )
        start = problem.started(0.8e-6) if now is None else problem.continued(now.position)
        settled = problem.settle(start)
        now = settled.balance
        numbers = numbers_of(problem, now)
        solution = cast(Any, SimpleNamespace(status=Status.DONE))
        one = CoupledPoint(
            problem=problem,
            equilibrium=settled,
            numbers=numbers,
            solution=solution,
            description=cast(Any, None),
            leakage_mismatch=0.0,
        )
        found.append(stored_point(one))
    return tuple(found)


def _study(pressure: tuple[float, ...], coulomb: float = 60.0) -> LateralStudy:
    return LateralStudy(conditions(*pressure), _points(pressure, coulomb))


@pytest.fixture(scope="module")
def study() -> LateralStudy:
    return _study(UP_AND_DOWN)


@pytest.fixture(scope="module")
def case() -> Case:
    return load_case(CASES / "hysteresis_055.toml")


def test_loop_area_is_positive_where_the_bearing_stays_away(study: LateralStudy) -> None:
    """Trapezoids by hand, and nothing left without friction."""
    x = [p.numbers.position for p in study.points]
    p = np.array(UP_AND_DOWN)
    by_hand = np.trapezoid(x[2:][::-1], p[2:][::-1]) - np.trapezoid(x[:3], p[:3])
    assert bearing_path.loop_area(study) == pytest.approx(by_hand, rel=1e-12)
    assert by_hand > 0.0
    free = bearing_path.loop_area(_study(UP_AND_DOWN, 0.0))
    assert abs(free) < 0.02 * by_hand


def test_points_that_friction_holds_are_marked() -> None:
    """They end where they start: at the point before, or at the gap given to all."""
    held, moved = _study(UP_AND_DOWN, 1e6), _study(UP_AND_DOWN, 1e-3)
    assert held.held_by_friction[1:] == (True,) * 4
    assert held.summary()["held_by_friction"][1:] == [True] * 4
    assert not any(moved.held_by_friction)
    gap = 0.5 * held.points[0].numbers.position
    anew = tuple(replace(condition, anew=True) for condition in held.conditions)
    assert all(replace(held, start_gap=gap, conditions=anew).held_by_friction)


def test_result_lists_every_point_with_units(study: LateralStudy) -> None:
    result = study.result({"loop_area_um_bar": 1.0})
    assert result.status is Status.DONE
    assert result.data["bearing_position_um"].attrs["units"] == "um"
    assert result.data["film_height"].dims == ("point", "film", "film_row", "film_column")
    assert result.data["outlet_pressure_bar"].values == pytest.approx([20, 40, 60, 40, 20])
    assert len(result.tables[0].rows) == 5
    assert result.summary()["loop_area_um_bar"] == 1.0


@pytest.mark.slow
@pytest.mark.parametrize("kind", ["hysteresis", "nose_pressure"])
def test_figures_and_page(kind: str, study: LateralStudy, tmp_path: Path) -> None:
    result = replace(study.result({}), kind=kind)
    figures = study_figures(kind, result.data)
    assert figures
    page = study_report_html(result)
    assert page.count("<svg") >= len(figures)
    assert {path.name for path in result.save(tmp_path)} >= {"study.nc", "points.csv"}


@pytest.mark.parametrize(
    ("name", "kind"),
    [
        ("hysteresis_055", HysteresisStudy),
        ("hysteresis_078", HysteresisStudy),
        ("hysteresis_overlay", HysteresisStudy),
        ("nose_pressure", NosePressureStudy),
        ("balance_sweep", BalanceSweepStudy),
        ("bearing_map", BearingMapStudy),
    ],
)
def test_shipped_cases_study_one_pump(name: str, kind: type) -> None:
    own, pump = load_case(CASES / f"{name}.toml"), load_case(CASES / "fuel14_pump.toml")
    assert isinstance(own.study, kind)
    assert own.machine == pump.machine
    assert own.run.deformation == pump.run.deformation


def test_study_needs_an_operating_point(case: Case) -> None:
    with pytest.raises(CaseError, match="operating_point: found none"):
        run_study(replace(case, operating_point=None))


def test_record_of_a_point_gives_the_same_point(study: LateralStudy) -> None:
    """Through the text of the record, as a study that goes on reads it."""
    kept = json.loads(json.dumps(asdict(record_of("key", study.points[2]))))
    back = recorded_point(Record(**kept))
    again = replace(study, points=(*study.points[:2], back, *study.points[3:]))
    xr.testing.assert_identical(again.dataset(), study.dataset())
    np.testing.assert_array_equal(back.coordinates, study.points[2].coordinates)


class _Chain:
    """Points whose gap grows by one micrometre each, interrupted before one of them."""

    def __init__(self, points: tuple[StoredPoint, ...], last: int) -> None:
        self.points, self.last, self.asked = points, last, []

    def solve(self, condition: PointCondition, start: Any, _progress: object) -> StoredPoint:
        if len(self.asked) == self.last:
            raise KeyboardInterrupt
        self.asked.append((condition.label, start))
        return self.points[int(condition.label[-1])]


@pytest.fixture
def loop(study: LateralStudy, monkeypatch: pytest.MonkeyPatch) -> Callable[..., Any]:
    def run(records: Records, last: int = 99) -> tuple[_Chain, tuple[StoredPoint, ...]]:
        chain = _Chain(study.points, last)
        monkeypatch.setattr(bearing_points, "stored_point", lambda point: point)
        asked = conditions(*UP_AND_DOWN)
        keys = [f"key {k}" for k in range(len(asked))]
        context = StudyContext(records=records)
        return chain, bearing_points.follow(cast(Any, chain), asked, 1e-6, context, keys)

    return run


def test_interrupted_loop_goes_on_from_its_last_point(
    loop: Callable[..., Any], study: LateralStudy, tmp_path: Path
) -> None:
    path = tmp_path / "out" / "points.jsonl"
    _, found = loop(Records(path), last=2)
    assert len(found) == 2
    part = replace(study, points=found)
    assert part.status is Status.INTERRUPTED
    chain, found = loop(Records(path, resume=True))
    assert [label for label, _ in chain.asked] == ["A, 2", "A, 3", "A, 4"]
    np.testing.assert_array_equal(chain.asked[0][1], study.points[1].coordinates)
    whole = replace(study, points=found)
    xr.testing.assert_identical(whole.dataset(), study.dataset())


def test_interrupt_before_the_first_point_keeps_nothing(
    loop: Callable[..., Any], tmp_path: Path
) -> None:
    with pytest.raises(KeyboardInterrupt):
        loop(Records(tmp_path / "points.jsonl"), last=0)
    assert not list(tmp_path.iterdir())


def test_loop_asks_for_as_many_rounds_as_its_case(
    case: Case, study: LateralStudy, monkeypatch: pytest.MonkeyPatch
) -> None:
    asked: list[tuple[int, str]] = []

    def follow(points: Any, *rest: Any) -> tuple[StoredPoint, ...]:
        asked.append((points.rounds, rest[-1][0]))
        return study.points[:1]

    monkeypatch.setattr(bearing_path, "follow", follow)
    monkeypatch.setattr(Run, "worn", lambda run: run)
    for rounds in (1, 6):
        own = replace(case.study, coupling_rounds=rounds)  # type: ignore[type-var]
        found = bearing_path.solve_path(replace(case, study=own))
        assert found.status is Status.INTERRUPTED
    assert [one for one, _ in asked] == [1, 6]
    # points of one number of rounds are none of another
    assert asked[0][1] != asked[1][1]
