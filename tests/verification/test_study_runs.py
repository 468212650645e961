"""Studies of the motor itself: points are plain runs, processes change nothing, trends hold."""

from __future__ import annotations

import dataclasses
from pathlib import Path

import numpy as np
import pytest

from toothspace import api
from toothspace.core.status import Status
from toothspace.studies import run_study

REPOSITORY = Path(__file__).resolve().parents[2]
CALIBRATE = REPOSITORY / "cases" / "calibrate_gaps.toml"
MOTOR = REPOSITORY / "cases" / "efficiency_map_egm12.toml"
COARSE = ("run.samples_per_revolution=180", "run.relative_tolerance=1e-5")
SMALL = (
    'study.shaft_speed=["1000 rpm", "2000 rpm"]',
    'study.pressure_difference=["100 bar", "200 bar"]',
)


@pytest.mark.slow
def test_a_map_is_made_of_plain_runs_in_any_number_of_processes(tmp_path: Path) -> None:
    case = api.load_case(MOTOR, (*COARSE, *SMALL))
    alone = run_study(case)
    shared = run_study(case, tmp_path, workers=2)
    assert alone.status is shared.status is Status.DONE
    for name in ("volumetric_efficiency", "mean_torque_N_m", "max_chamber_pressure_bar"):
        np.testing.assert_array_equal(alone.data[name], shared.data[name])
    plain = ("operating_point.shaft_speed=2000 rpm", "operating_point.inlet_pressure=101 bar")
    point = dataclasses.replace(api.load_case(MOTOR, (*COARSE, *plain)), study=None)
    one = api.simulate(point).summary()
    torque = alone.data["mean_torque_N_m"].values[1, 0]
    assert torque == pytest.approx(one["mean_torque_N_m"], rel=1e-12)

    slip = 1.0 - alone.data["volumetric_efficiency"].values
    assert (np.diff(slip, axis=0) < 0.0).all(), "slip shrinks as the speed grows"
    assert (np.diff(slip, axis=1) > 0.0).all(), "slip grows with the pressure"
    overall = alone.data["overall_efficiency"].values
    assert ((overall > 0.0) & (overall < 1.0)).all()


def bench_table(path: Path) -> None:
    """Write the bench of ``calibrate_gaps`` anew: 9.2 um, 0.21 N m, 0.2 percent of random noise."""
    true = "machine.lateral.side_gap=9.2 um", "machine.seals.shaft_seal_torque=0.21 N m"
    case = dataclasses.replace(api.load_case(CALIBRATE, true), study=None)
    noise = np.random.default_rng(7)
    lines = [
        "operating_point.shaft_speed [rpm], operating_point.inlet_pressure [bar], "
        "mean_flow_L_per_min [L/min], mean_torque_N_m [N m]"
    ]
    for speed in (500, 1000, 1500, 2500):
        for pressure in (80, 160, 240):
            at = {
                "operating_point.shaft_speed": f"{speed} rpm",
                "operating_point.inlet_pressure": f"{pressure} bar",
            }
            numbers = api.simulate(case.replace(at)).summary()
            flow, torque = (
                numbers[name] * (1.0 + 0.002 * noise.standard_normal())
                for name in ("mean_flow_L_per_min", "mean_torque_N_m")
            )
            lines.append(f"{speed}, {pressure}, {flow:.4f}, {torque:.4f}")
    path.write_text("\n".join(lines) + "\n", encoding="utf-8")


@pytest.mark.slow
def test_calibration_finds_the_values_that_made_the_measurement(tmp_path: Path) -> None:
    bench_table(tmp_path / "bench.csv")
    data = f'study.data="{tmp_path / "bench.csv"}"'
    result = run_study(api.load_case(CALIBRATE, (*COARSE, data)))
    assert result.status is Status.DONE
    for key, true in (
        ("machine.lateral.side_gap", 9.2),
        ("machine.seals.shaft_seal_torque", 0.21),
    ):
        found = float(result.numbers["fitted"][key].split()[0])
        # one interval in twenty misses the true value: twice its width is certain enough
        assert abs(found - true) < 2.0 * result.numbers["half_width_95"][key]
    assert result.numbers["hold_out_error_percent"]["mean_torque_N_m"] < 0.5
