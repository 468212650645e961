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


def test_pressures_temperatures_and_lost_flow_of_a_summary_by_hand() -> None:
    """The inlet swings by 0.2 % of 200 bar; of the 4 % that is lost gaps leak a part."""
    solution = fake_solution()
    summary = solution.summary()
    chambers = solution.data["chamber_pressure"].values
    assert summary["inlet_pressure_bar"] == pytest.approx(200.0, rel=1e-4)
    assert summary["outlet_pressure_bar"] == pytest.approx(1.0)
    assert summary["pressure_ripple_bar"] == pytest.approx(0.4, rel=1e-6)
    assert summary["max_chamber_pressure_bar"] == pytest.approx(1e-5 * chambers.max())
    assert summary["min_chamber_pressure_bar"] == pytest.approx(1e-5 * chambers.min())
    assert summary["inlet_temperature_degC"] == pytest.approx(50.0)
    heat = sum(v for k, v in summary.items() if k.startswith("power_loss_") and k != "power_loss_W")
    assert heat == pytest.approx(summary["power_loss_W"])
    warmed = heat / (summary["mean_flow_L_per_min"] / 6e4 * DENSITY_HIGH * 1960.0)
    assert summary["outlet_temperature_degC"] == pytest.approx(50.0 + warmed)
    lost = 4.949e-3 * 1500.0 * (1.0 / 0.96 - 1.0)
    assert summary["lost_flow_L_per_min"] == pytest.approx(lost)
    leaking = 6e4 * (0.9e-6 + 0.15e-6 + 0.8e-6 + 1.1e-6)
    assert summary["mesh_exchange_flow_L_per_min"] == pytest.approx(lost - leaking)


def test_films_of_a_heat_network_have_their_hottest_place() -> None:
    nodes = ["outlet", "drain", "journal_film_drive", "lateral_film_left"]
    solution = fake_solution()
    data = solution.data.assign(
        temperature=xr.DataArray([330.0, 340.0, 373.15, 350.0], {"heat_node": nodes})
    )
    summary = performance.summary_numbers(data, solution.ledger)
    assert summary["highest_film_temperature_degC"] == pytest.approx(100.0)
    assert summary["outlet_temperature_degC"] == pytest.approx(330.0 - 273.15)
    assert summary["drain_temperature_degC"] == pytest.approx(340.0 - 273.15)


def test_contacts_that_push_are_loaded() -> None:
    force = [[0.0, 5.0, 0.0], [2.0, 5.0, 0.0]]
    data = xr.Dataset({"contact_force": (("shaft_angle", "contact"), force)})
    assert performance.mean_loaded_contacts(data) == pytest.approx(1.5)


def test_vapour_collapses_under_the_higher_port_during_the_samples() -> None:
    """0.2 cubic centimetres under 20 bar from 5 to 5.004 s."""
    data = xr.Dataset(
        {
            "inlet_pressure": ("shaft_angle", [1e5, 1e5]),
            "outlet_pressure": ("shaft_angle", [19e5, 21e5]),
            "chamber_vapour_fraction": (("shaft_angle", "chamber"), [[0.4], [0.2]]),
            "chamber_volume": (("shaft_angle", "chamber"), [[1e-6], [1e-6]]),
            "time": ("shaft_angle", [5.0, 5.004]),
        }
    )
    assert performance.vapour_collapse_power(data) == pytest.approx(20e5 * 0.2e-6 / 4e-3)


def test_numbers_of_lateral_films_are_in_the_unit_of_their_name() -> None:
    data = xr.Dataset({"bearing_position": ("shaft_angle", [4e-6, 8e-6])})
    statistics = {
        "lateral_leakage": 2e-5,
        "lateral_smallest_gap": 3e-6,
        "lateral_real_contact_area": 5e-6,
        "lateral_wear_power": 7e6,
        "solid_bearing_seat_margin": 2e-3,
        "lateral_torque": 0.4,
    }
    found = performance.lateral_numbers(data, statistics)
    assert found == pytest.approx(
        {
            "bearing_position_um": 6.0,
            "lateral_leakage_L_per_min": 1.2,
            "smallest_film_um": 3.0,
            "real_contact_area_mm2": 5.0,
            "wear_power_W_per_mm2": 7.0,
            "tipping_margin_mm": 2.0,
            "seat_margin_mm": 2.0,
            "lateral_torque_N_m": 0.4,
        }
    )
    assert performance.lateral_numbers(data, {}) == {}


def test_leakages_are_by_pressure_and_drag_together() -> None:
    parts = {
        "pressure_leakage_tooth_tip": 5e-6,
        "drag_leakage_tooth_tip": -2e-6,
        "pressure_leakage_flank": 1e-6,
        "compression_flow": 7e-6,
    }
    found = performance.leakages_of(parts)
    assert found == pytest.approx({"tooth_tip": 3e-6, "flank": 1e-6})
    data = xr.Dataset({"lost_flow": ("flow_part", [*parts.values()])}, {"flow_part": [*parts]})
    assert performance.parts_of(data) == parts


def test_a_machine_lacks_what_it_displaces_and_does_not_deliver() -> None:
    data, ledger = pump_data(), pump_ledger()
    lost = 1e-6 * 10.0 / 0.1 - 8.0e-3 / 850.0 / 0.1
    assert performance.lost_flow_rate(data, ledger) == pytest.approx(lost)
    motor = data.assign_attrs(mode="motor")
    assert performance.lost_flow_rate(motor, ledger) == pytest.approx(-lost)
