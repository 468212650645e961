"""Every claim about reference machines and the start of the motor fails on a spoiled result."""

from __future__ import annotations

from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
import xarray as xr

from toothspace.core.netcdf import read_dataset
from toothspace.studies import startup
from toothspace.validation import book, motor_startup, reference_machines

CHECKED = {
    claim.key: claim
    for claim in (*reference_machines.CLAIMS, *motor_startup.CLAIMS)
    if claim.measure is not None
}


def verdict(key: str) -> str:
    return book.examine(CHECKED[key], "short").verdict


# reference machines: a summary by hand, good or with one number spoiled

GOOD = {
    "volumetric_efficiency": 0.946,
    "hydromechanical_efficiency": 0.91,
    "overall_efficiency": 0.86,
    "flow_ripple_percent": 15.0,
    "pressure_ripple_bar": 0.0,
    "drain_temperature_degC": 70.0,
    "max_chamber_pressure_bar": 220.0,
    "min_chamber_pressure_bar": 0.5,
    "inlet_pressure_bar": 1.0,
    "outlet_pressure_bar": 200.0,
    "leakage_tooth_tip_L_per_min": 0.1,
    "leakage_lateral_L_per_min": 0.1,
    "leakage_drain_L_per_min": 0.1,
}
SPOILED_MACHINES = {
    "egm12_motor": {"hydromechanical_efficiency": 0.96},
    "egm12_pump": {"volumetric_efficiency": 0.90},
    "egm12_motor_reduced": {"drain_temperature_degC": 95.0},
    "egm12_map": {"overall_efficiency": 0.96},
    "egm12_aims": {"max_chamber_pressure_bar": 320.0},
    "crescent_pump": {"volumetric_efficiency": 0.978},
    "fuel14_pump": {"flow_ripple_percent": 50.0},
    "fuel14_pump_flow": {"volumetric_efficiency": 0.994},
    "fuel14_aims": {"min_chamber_pressure_bar": 0.03},
    "gerotor_aims": {"max_chamber_pressure_bar": 320.0},
    "gerotor_trochoidal": {"volumetric_efficiency": 0.80},
    "gerotor_cycloidal": {"volumetric_efficiency": 0.729},
}
SUITED = {
    "gerotor_cycloidal": {"volumetric_efficiency": 0.90},
}


def machine(numbers: dict[str, float]) -> Any:
    """Runs of one machine whose efficiency is best at 1500 rpm and the highest pressure."""

    def run(case: str, *overrides: str) -> Any:
        text = " ".join(overrides)
        loss = 0.05 * ('"500.0 rpm' in text) + 0.05 * ('"61.0 bar' in text)
        here = numbers | {"overall_efficiency": numbers["overall_efficiency"] - loss}
        return SimpleNamespace(summary=lambda: here)

    return run


@pytest.mark.parametrize("key", SPOILED_MACHINES)
def test_reference_machine(key: str, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(reference_machines, "_over_angle", lambda *_: ())
    good = GOOD | SUITED.get(key, {})
    for numbers, expected in ((good, "pass"), (good | SPOILED_MACHINES[key], "fail")):
        monkeypatch.setattr(reference_machines, "solved", machine(numbers))
        assert verdict(key) == expected


def test_map_whose_best_point_is_at_the_lowest_speed(monkeypatch: pytest.MonkeyPatch) -> None:
    def run(case: str, *overrides: str) -> Any:
        best = any('speed="500.0 rpm' in text for text in overrides)
        return SimpleNamespace(summary=lambda: {"overall_efficiency": 0.9 if best else 0.85})

    monkeypatch.setattr(reference_machines, "solved", run)
    assert verdict("egm12_map") == "fail"


# start of the motor


def start(*, speed: float = 0.0, **numbers: float) -> Any:
    """Runs of a start by hand.

    Parameters
    ----------
    speed : float
        Speed at the end. [rad/s]
    """
    time = np.linspace(0.0, 20.0, 21)
    turning = np.where(time < 15.0, 30.0, speed)
    data = xr.Dataset(
        {
            "shaft_speed": ("time", turning),
            "pressure_difference": ("time", np.full(time.size, 4e5)),
            "lateral_load_beyond": ("time", np.full(time.size, numbers.pop("beyond", 0.0))),
        },
        coords={"time": time},
    )
    events = [SimpleNamespace(kind="shaft_stopped")] * int(numbers.pop("stops", 0))
    found = {"displacement_cm3_per_rev": 4.95, "startup_pressure_ratio": 3.0} | numbers
    return lambda *_: SimpleNamespace(data=data, events=events, summary=lambda: found)


STARTS: dict[str, tuple[dict[str, float], dict[str, float]]] = {
    "startup_ratio": ({"startup_to_settled_ratio": 4.0}, {"startup_to_settled_ratio": 1.3}),
    "startup_ratio_complete": (
        {"startup_to_settled_ratio": 4.0},
        {"startup_to_settled_ratio": 1.3},
    ),
    "startup_breakaway": ({"breakaway_pressure_bar": 12.7}, {"breakaway_pressure_bar": 17.0}),
    "startup_cycle": ({}, {"speed": 3.0}),
    "startup_smooth": ({}, {"stops": 2.0}),
    "startup_against_load": ({"breakaway_pressure_bar": 203.0}, {"breakaway_pressure_bar": 160.0}),
}


@pytest.mark.parametrize("key", STARTS)
def test_start(key: str, monkeypatch: pytest.MonkeyPatch) -> None:
    for numbers, expected in zip(STARTS[key], ("pass", "fail"), strict=True):
        monkeypatch.setattr(motor_startup, "solved", start(**numbers))
        assert verdict(key) == expected


def test_start_outside_its_tables(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(motor_startup, "solved", start(beyond=0.5))
    assert verdict("startup_smooth") == "fail"


def test_ratio_over_speed(monkeypatch: pytest.MonkeyPatch) -> None:
    for size, expected in ((1.0, "pass"), (0.4, "fail")):
        rows = {
            "startup_to_settled_ratio": (("plateau_speed", "angle"), size * np.array([[4.0, 3.9]])),
            "startup_pressure_ratio": (("plateau_speed", "angle"), np.array([[3.0, 3.1]])),
        }
        data = xr.Dataset(rows, coords={"plateau_speed": [40.0]})
        found = SimpleNamespace(data=data)
        monkeypatch.setattr(startup, "run", lambda *_, found=found: found)
        assert verdict("startup_ratio_over_speed") == expected


def test_extra_torque(monkeypatch: pytest.MonkeyPatch) -> None:
    """Tables whose torque is turned round say that films take less than the closed form."""
    assert verdict("lateral_extra_torque") == "pass"

    def spoiled(path: Any) -> xr.Dataset:
        tables = read_dataset(path)
        return tables.assign(lateral_extra_torque=-tables["lateral_extra_torque"])

    monkeypatch.setattr(motor_startup, "read_dataset", spoiled)
    assert verdict("lateral_extra_torque") == "fail"


def test_every_claim_is_tried() -> None:
    others = {"startup_ratio_over_speed", "lateral_extra_torque"}
    assert {*SPOILED_MACHINES, *STARTS, *others} == set(CHECKED)
