"""Numbers of a run over time and of a start, from rows whose numbers are known by hand."""

from __future__ import annotations

import math

import numpy as np
import pytest
import xarray as xr

from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.results.ledger import Ledger
from toothspace.results.performance import collapse_power, transient_numbers
from toothspace.results.solution import Solution, moving_mean, standing, startup_numbers

BREAKAWAY, SLOWER = 2.0, 8.0
PITCH = 2.0 * math.pi / 12.0


def over(time: Array, **variables: Array | float) -> xr.Dataset:
    rows = {name: ("time", np.broadcast_to(value, time.shape)) for name, value in variables.items()}
    return xr.Dataset(rows, {"time": time, "chamber": [f"gear_{k}" for k in range(12)]})


def start() -> xr.Dataset:
    """100 bar break a shaft away, 60 bar and 1 bar/s more run it; peaks where none counts."""
    time = np.linspace(0.0, 10.0, 1001)
    pressure = np.where(time <= BREAKAWAY, 50.0 * time, 60.0 + (time - BREAKAWAY))
    pressure[(time > 2.3) & (time < 2.7)] = 90.0  # still settling
    pressure[time > SLOWER] = 120.0
    return over(
        time,
        shaft_angle=4.0 * np.maximum(time - BREAKAWAY, 0.0),
        pressure_difference=1e5 * pressure,
        pressure_difference_highest=1e5 * (pressure + 2.0),
        supply_speed=np.where(time <= SLOWER, 100.0, 50.0),
    )


def test_a_mean_over_a_window_of_the_shaft_lags_by_half_of_it() -> None:
    time = np.linspace(0.0, 1.0, 101)
    ends, mean = moving_mean(time, 10.0 * time, 3.0 + 2.0 * time, 2.0)
    assert ends[0] == pytest.approx(0.2)
    assert mean == pytest.approx(3.0 + 2.0 * (ends - 0.1), rel=1e-9)


def test_numbers_of_a_start() -> None:
    numbers = startup_numbers(start(), BREAKAWAY)
    window = PITCH / 4.0
    assert numbers["startup_pressure_bar"] == pytest.approx(102.0)
    assert numbers["breakaway_time_s"] == BREAKAWAY
    assert numbers["breakaway_pressure_bar"] == pytest.approx(100.0)
    running = 60.0 + (SLOWER - BREAKAWAY) - 0.5 * window
    assert numbers["max_running_pressure_bar"] == pytest.approx(running, rel=1e-4)
    assert numbers["startup_pressure_ratio"] == pytest.approx(102.0 / running, rel=1e-4)
    settled = 60.0 + 0.9 * (SLOWER - BREAKAWAY) - 0.5 * window  # middle of the last fifth
    assert numbers["settled_pressure_bar"] == pytest.approx(settled, rel=1e-4)
    assert numbers["startup_to_settled_ratio"] == pytest.approx(102.0 / settled, rel=1e-4)


def test_a_shaft_that_never_starts_has_no_numbers_of_a_start() -> None:
    numbers = startup_numbers(start(), math.nan)
    assert math.isnan(numbers["startup_pressure_bar"])
    assert math.isnan(numbers["max_running_pressure_bar"])


@pytest.mark.parametrize(
    ("speed", "supply", "text"),
    [
        ([0.0, 0.0, 0.0, 0.0], 10.0, "never turns: friction and load hold it against 50 bar"),
        ([0.0, 5.0, 2.0, 0.0], 10.0, "stands still since 2 s although the supply runs"),
        ([0.0, 5.0, 2.0, 0.0], 0.0, ""),
        ([0.0, 5.0, 2.0, 1.0], 10.0, ""),
    ],
)
def test_a_shaft_that_stands_is_told(speed: list[float], supply: float, text: str) -> None:
    pressure = np.array([10e5, -50e5, 30e5, 20e5])
    data = over(
        np.arange(4.0),
        shaft_speed=np.array(speed),
        pressure_difference=pressure,
        supply_speed=supply,
    )
    told = [finding.text for finding in standing(data)]
    assert len(told) == bool(text)
    assert all(text in one for one in told)
    assert all(("20 bar" in one) == ("since" in text) for one in told)


def test_numbers_over_time() -> None:
    """Rows are means of ten samples at ends of steps; powers that grow evenly sum exactly."""
    step, samples = 1e-3, 10
    middle = step * (samples * np.arange(20) + 0.5 * (samples + 1))
    whole = step * samples * 20
    rates = {"electric_power": (500.0, 2000.0), "drive_motor_loss": (40.0, 300.0)}
    data = over(
        middle,
        shaft_speed_highest=np.linspace(0.0, 50.0 * math.pi, 20),
        outlet_flow_rate=2e-4,
        shaft_torque=30.0,
        pressure_difference_highest=np.linspace(1e5, 150e5, 20),
        chamber_pressure=1e5,
        chamber_pressure_highest=np.linspace(1e5, 200e5, 20),
        chamber_pressure_lowest=np.linspace(0.5e5, 200e5, 20),
        drive_inverter_loss=10.0,
        **{name: a + b * middle for name, (a, b) in rates.items()},
    ).assign(displacement=3e-6 / (2.0 * math.pi))
    data.attrs["mode"] = "pump"
    ledger = Ledger(whole, 7.0 * math.pi, {}, {"supply": 3.0, "shaft": -20.0, "tip_shear": 4.0})
    numbers = transient_numbers(data, ledger)
    electric, motor = (a * whole + 0.5 * b * whole**2 for a, b in rates.values())
    expected = {
        "displacement_cm3_per_rev": 3.0,
        "duration_s": whole,
        "revolutions": 3.5,
        "max_shaft_speed_rpm": 1500.0,
        "mean_flow_L_per_min": 12.0,
        "mean_torque_N_m": 30.0,
        "max_pressure_difference_bar": 150.0,
        "max_chamber_pressure_bar": 200.0,
        "min_chamber_pressure_bar": 0.5,
        "supply_energy_J": 3.0,
        "shaft_energy_J": 20.0,
        "loss_energy_J": 4.0,
        "electric_energy_J": electric,
        "drive_loss_energy_J": motor + 10.0 * whole,
    }
    assert {name: numbers[name] for name in expected} == pytest.approx(expected)


def test_vapour_that_collapses_sets_free_what_the_high_pressure_does_on_it() -> None:
    """0.25 and 0.3 of a cubic centimetre vanish within 3 ms; traces do not count."""
    fraction = np.array([[0.5, 9e-5], [0.25, 0.0], [0.3, 9e-5], [0.0, 0.0]])
    power = collapse_power(fraction, np.full((4, 2), 1e-6), np.arange(4.0) * 1e-3, 1e7)
    assert power == pytest.approx(1e7 * 0.55e-6 / 3e-3)


def test_time_of_a_run_over_time_of_computing_is_its_real_time_factor() -> None:
    data = start().assign(
        displacement=1e-6,
        shaft_speed_highest=("time", np.ones(1001)),
        outlet_flow_rate=("time", np.ones(1001)),
        shaft_torque=("time", np.ones(1001)),
    )
    ledger = Ledger(10.0, 7.0, {}, {})
    found = Solution(Status.DONE, data, ledger, statistics={"wall_time": 4.0}).summary()
    assert found["real_time_factor"] == pytest.approx(2.5)
    assert found["wall_time_s"] == 4.0


def test_a_shaft_that_never_turned_is_told_with_the_largest_pressure() -> None:
    pressure = np.array([10e5, -50e5, 30e5])
    data = over(np.arange(3.0), shaft_speed=0.0, pressure_difference=pressure, supply_speed=10.0)
    (told,) = standing(data)
    assert told.text.endswith("friction and load hold it against 50 bar.")


def test_numbers_of_a_start_do_not_hang_on_where_the_shaft_stood() -> None:
    turned = start()
    turned["shaft_angle"] = turned["shaft_angle"] + 5.0
    numbers = startup_numbers(turned, BREAKAWAY)
    assert numbers == pytest.approx(startup_numbers(start(), BREAKAWAY))


def test_a_start_without_supply_runs_to_the_end() -> None:
    coasting = start()
    coasting["supply_speed"] = 0.0 * coasting["supply_speed"]
    numbers = startup_numbers(coasting, BREAKAWAY)
    assert numbers["max_running_pressure_bar"] == pytest.approx(120.0)
