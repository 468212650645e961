"""One study of the path of a floating bearing, and its other names."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path
from types import SimpleNamespace
from typing import Any, cast

import pytest

from toothspace.case import Case, load_case
from toothspace.core.errors import CaseError
from toothspace.core.registry import STUDY_KEYS, study
from toothspace.studies import bearing_path, bearing_points
from toothspace.studies.bearing_path import BearingPathStudy, HysteresisStudy, asked_path
from toothspace.studies.bearing_points import LateralPoints

CASES = Path(__file__).parents[3] / "cases"
LOOP = {"outlet_pressures": (20e5, 40e5, 20e5), "friction_coefficient": (0.01,)}


def _case(name: str) -> Case:
    return load_case(CASES / f"{name}.toml")


@pytest.mark.parametrize("name", ["hysteresis", "nose_pressure", "bearing_map"])
def test_former_kinds_are_names_of_the_path(name: str) -> None:
    assert study(name).run is study("bearing_path").run
    assert study(name).figures is study("bearing_path").figures
    assert STUDY_KEYS.name_of(STUDY_KEYS[name]) == name


def test_loop_goes_on_where_the_point_before_ended() -> None:
    case = _case("hysteresis_055")
    points = asked_path(case).points(case)
    assert isinstance(case.study, HysteresisStudy)
    assert [one.outlet_pressure for one in points] == list(case.study.outlet_pressures)
    assert not any(one.anew for one in points)
    assert points[0].label == f"1: {case.study.outlet_pressures[0] * 1e-5:.4g} bar"


def test_nose_pressures_rise_within_each_condition_and_begin_anew() -> None:
    case = _case("nose_pressure")
    points = asked_path(case).points(case)
    first, last = points[0], points[-1]
    assert all(one.anew for one in points)
    assert first.nose_pressure == first.inlet_pressure  # a fraction of zero
    fraction = case.study.nose_pressure_fractions[-1]  # type: ignore[union-attr]
    assert last.nose_pressure == pytest.approx(fraction * last.outlet_pressure)
    assert last.label.endswith(f", {fraction:.4g}")


def test_path_over_the_nose_continues_within_a_pressure() -> None:
    case = _case("hysteresis_055")
    path = BearingPathStudy(**LOOP, nose_pressure_fractions=(0.0, 0.2))  # type: ignore[arg-type]
    assert [one.anew for one in path.points(case)] == [True, False] * 3


@pytest.mark.parametrize(
    ("keys", "key"),
    [
        ({"friction_coefficient": (0.01,)}, "outlet_pressures"),
        ({**LOOP, "friction_coefficient": (0.01, 0.02)}, "friction_coefficient"),
        ({**LOOP, "sensor_deflection": 1e-12}, "sensor_deflection"),
        ({**LOOP, "reference_area": 1e-4}, "reference_area"),
        ({**LOOP, "shaft_speed": (100.0,), "balance_ratio": (1.0,)}, "balance_ratio"),
        ({**LOOP, "balance_ratio": (1.0,), "nose_pressure_fractions": (0.1,)}, "nose_pressure"),
        ({"outlet_pressures": (20e5,), "balance_ratio": (1.0,)}, "friction_coefficient"),
    ],
)
def test_keys_that_exclude_each_other_are_refused(keys: dict[str, Any], key: str) -> None:
    with pytest.raises(CaseError, match=f"^{key}"):
        BearingPathStudy(**keys)


def test_one_kind_asks_all_four_questions(monkeypatch: pytest.MonkeyPatch) -> None:
    """Each leads to the solution that its own name leads to."""
    case, asked = _case("hysteresis_055"), []
    monkeypatch.setattr(bearing_path, "solve_path", lambda case, _: asked.append("path"))
    monkeypatch.setattr(bearing_path, "_map", lambda *_: asked.append("map"))
    monkeypatch.setattr(bearing_path.balance_sweep, "solve", lambda *_: asked.append("areas"))
    for keys in ({"shaft_speed": (100.0,)}, {"balance_ratio": (1.0, 1.1)}):
        own = BearingPathStudy(**LOOP, **keys)  # type: ignore[arg-type]
        bearing_path.run(replace(case, study=own), None)  # type: ignore[arg-type]
    assert asked == ["map", "areas"]


def test_another_study_is_no_path() -> None:
    with pytest.raises(CaseError, match="allowed a path of a floating bearing"):
        asked_path(_case("efficiency_map_egm12"))


def test_nose_pressures_share_the_chambers_of_their_condition(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    case, made = _case("nose_pressure"), []
    points = LateralPoints(case, cast(Any, SimpleNamespace(machine=None, fluid=None)), cast(Any, 0))
    monkeypatch.setattr(LateralPoints, "lumped", lambda *_: lambda machine: made.append(machine))
    monkeypatch.setattr(bearing_points, "couple_point", lambda machine, _, run, asked: run(machine))
    for one in asked_path(case).points(case):
        points.solve(one, 2e-6)
    assert len(made) == len(case.study.conditions)  # type: ignore[union-attr]
    points = replace(points, rounds=2, known={})
    points.solve(one, 2e-6)
    points.solve(one, 2e-6)
    assert len(made) == len(case.study.conditions) + 2  # type: ignore[union-attr]
