from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from tests.fake_solution import (
    DENSITY_HIGH,
    DISPLACEMENT,
    HIGH,
    LOW,
    MECHANISMS,
    SPEED,
    TORQUE_LOSSES,
    fake_solution,
)
from toothspace.results import performance
from toothspace.results.ledger import Ledger

CONTRACT = [
    "displacement_cm3_per_rev",
    "mean_flow_L_per_min",
    "mean_torque_N_m",
    "volumetric_efficiency",
    "hydromechanical_efficiency",
    "overall_efficiency",
    "flow_ripple_percent",
    "pressure_ripple_bar",
    "torque_ripple_percent",
    "max_chamber_pressure_bar",
    "min_chamber_pressure_bar",
    "mass_balance_error",
    "energy_balance_error",
    "status",
    "wall_time_s",
]


def pump_data(**changes: float) -> xr.Dataset:
    scalars = {
        "displacement": 1e-6,
        "inlet_density": 850.0,
        "outlet_density": 860.0,
        "specific_heat_capacity": 2000.0,
        "fluid_temperature": 320.0,
        **changes,
    }
    return xr.Dataset(scalars, attrs={"mode": "pump"})


def pump_ledger() -> Ledger:
    energy = {"shaft": 100.0, "port_outlet": 80.0, "tooth_tip": 12.0, "journal_viscous": 8.0}
    mass = {"inlet": 8.0e-3, "outlet": 8.0e-3}
    return Ledger(0.1, 10.0, mass, energy, {"tooth_tip": "Leakage over tooth tips"})


def test_pump_efficiencies_by_hand() -> None:
    data, ledger = pump_data(), pump_ledger()
    assert performance.volumetric_efficiency(data, ledger) == pytest.approx(8.0e-3 / 8.5e-3)
    assert performance.overall_efficiency(data, ledger) == pytest.approx(0.8)
    assert performance.hydromechanical_efficiency(data, ledger) == pytest.approx(0.85)
    assert performance.mean_flow_rate(data, ledger) == pytest.approx(8.0e-3 / 0.1 / 860.0)
    assert performance.mean_torque(data, ledger) == pytest.approx(10.0)


def test_motor_efficiencies_are_the_inverse() -> None:
    solution = fake_solution()
    assert performance.volumetric_efficiency(solution.data, solution.ledger) == pytest.approx(0.96)
    supplied = DISPLACEMENT * SPEED / 0.96 * (HIGH - LOW)
    friction = SPEED * sum(TORQUE_LOSSES)
    throttling_and_leakage = 18.0 + 16.0 + 3.0 + 22.0 + 2.0 + 1.5 + 1.0
    delivered = supplied - friction - throttling_and_leakage
    overall = performance.overall_efficiency(solution.data, solution.ledger)
    assert overall == pytest.approx(delivered / supplied)
    assert performance.mean_torque(solution.data, solution.ledger) == pytest.approx(
        delivered / SPEED
    )


def test_all_losses_warm_the_outlet_when_the_drain_is_internal() -> None:
    rise = performance.outlet_temperature(pump_data(), pump_ledger()) - 320.0
    assert rise == pytest.approx(20.0 / (8.0e-3 * 2000.0))


def test_an_external_drain_takes_its_heat_away() -> None:
    base = pump_ledger()
    mass = {"inlet": 8.0e-3, "outlet": 7.0e-3, "drain": 1.0e-3}
    ledger = Ledger(base.duration, base.shaft_angle, mass, base.energy, base.path_losses)
    rise = performance.outlet_temperature(pump_data(), ledger) - 320.0
    assert rise == pytest.approx(12.0 / (7.0e-3 * 2000.0))
    drain = performance.drain_temperature(pump_data(), ledger) - 320.0
    assert drain == pytest.approx(8.0 / (1.0e-3 * 2000.0))


def test_summary_has_every_contract_name() -> None:
    summary = fake_solution().summary()
    assert set(CONTRACT) <= set(summary)
    assert summary["status"] == "done"
    numbers = [v for k, v in summary.items() if k != "status"]
    assert np.all(np.isfinite(numbers))


def test_summary_numbers_in_engineering_units() -> None:
    summary = fake_solution().summary()
    assert summary["displacement_cm3_per_rev"] == pytest.approx(4.949)
    assert summary["mean_flow_L_per_min"] == pytest.approx(4.949e-3 * 1500.0 / 0.96)
    assert summary["shaft_speed_rpm"] == pytest.approx(1500.0)
    assert summary["leakage_drain_L_per_min"] == pytest.approx(0.066)
    index = MECHANISMS.index("mesh_friction")
    expected = TORQUE_LOSSES[index]  # its ripple has zero mean up to the sampling
    assert summary["torque_loss_mesh_friction_N_m"] == pytest.approx(expected, rel=1e-3)
    assert summary["energy_balance_error"] < 1e-12


def test_drain_of_the_fake_motor_is_warmed_by_its_own_losses() -> None:
    summary = fake_solution().summary()
    heat = 22.0 + SPEED * (0.35 + 0.15)
    rise = heat / (1.1e-6 * DENSITY_HIGH * 1960.0)
    assert summary["drain_temperature_degC"] == pytest.approx(50.0 + rise)


def test_zero_window_gives_no_number_instead_of_an_error() -> None:
    ledger = Ledger(0.0, 0.0, {}, {})
    assert np.isnan(performance.overall_efficiency(pump_data(), ledger))
