from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import xarray as xr

from tests.fake_solution import (
    DENSITY_HIGH,
    DISPLACEMENT,
    HIGH,
    LOW,
    MECHANISMS,
    PATHS,
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
    # without its parts what is lost and does not leak is exchanged
    leakage = sum(summary[f"leakage_{path}_L_per_min"] for path in PATHS)
    exchanged = summary["lost_flow_L_per_min"] - leakage
    assert summary["mesh_exchange_flow_L_per_min"] == pytest.approx(exchanged)


def test_drain_of_the_fake_motor_is_warmed_by_its_own_losses() -> None:
    summary = fake_solution().summary()
    heat = 22.0 + SPEED * (0.35 + 0.15)
    rise = heat / (1.1e-6 * DENSITY_HIGH * 1960.0)
    assert summary["drain_temperature_degC"] == pytest.approx(50.0 + rise)


def test_zero_window_gives_no_number_instead_of_an_error() -> None:
    ledger = Ledger(0.0, 0.0, {}, {})
    assert np.isnan(performance.overall_efficiency(pump_data(), ledger))


def test_pressures_of_the_summary_are_extremes_in_bar() -> None:
    solution = fake_solution()
    summary, pressure = solution.summary(), np.asarray(solution.data["chamber_pressure"])
    assert summary["max_chamber_pressure_bar"] == pytest.approx(1e-5 * pressure.max())
    assert summary["min_chamber_pressure_bar"] == pytest.approx(1e-5 * pressure.min())
    assert summary["inlet_pressure_bar"] == pytest.approx(200.0, rel=1e-3)
    assert summary["outlet_pressure_bar"] == pytest.approx(1.0)
    # a wave of two thousandths of 200 bar, of a rectified sine
    assert summary["pressure_ripple_bar"] == pytest.approx(0.4, rel=0.01)
    flow = np.asarray(solution.data["inlet_flow_rate"])
    ripple = 100.0 * (flow.max() - flow.min()) / flow.mean()
    assert summary["flow_ripple_percent"] == pytest.approx(ripple, rel=1e-3)


def test_contacts_that_carry_are_counted_by_their_forces() -> None:
    force = [[10.0, 0.0], [10.0, 5.0], [0.0, 0.0], [3.0, -2.0]]
    data = xr.Dataset({"contact_force": (("shaft_angle", "contact"), force)})
    assert performance.mean_loaded_contacts(data) == 1.0
    known = data.assign(contact_loaded_share=("contact", [0.75, 0.5]))
    assert performance.mean_loaded_contacts(known) == 1.25


def test_numbers_of_lateral_films_are_in_engineering_units() -> None:
    """Micrometres, litres per minute, square millimetres; the load is that of the samples."""
    data = xr.Dataset(
        {
            "bearing_position": ("shaft_angle", [4e-6, 6e-6]),
            "axial_load": ("shaft_angle", [900.0, 1100.0]),
        }
    )
    statistics = {
        "lateral_leakage": 2e-5,
        "lateral_smallest_gap": 3e-6,
        "lateral_real_contact_area": 4e-6,
        "solid_bearing_seat_margin": 2e-3,
        "lateral_wear_power": 5e6,
        "lateral_torque": 0.7,
    }
    assert performance.lateral_numbers(data, statistics) == pytest.approx(
        {
            "bearing_position_um": 5.0,
            "axial_load_N": 1000.0,
            "lateral_leakage_L_per_min": 1.2,
            "smallest_film_um": 3.0,
            "real_contact_area_mm2": 4.0,
            "tipping_margin_mm": 2.0,
            "seat_margin_mm": 2.0,
            "wear_power_W_per_mm2": 5.0,
            "lateral_torque_N_m": 0.7,
        }
    )
    assert performance.lateral_numbers(xr.Dataset(), {}) == {}


def test_the_hottest_film_is_one_of_the_films() -> None:
    nodes = {"outlet": 330.0, "drain": 345.0, "drive_gear_film.1": 350.0, "lateral_film.2": 340.0}
    network = xr.Dataset(
        {"temperature": ("heat_node", list(nodes.values()))}, {"heat_node": [*nodes]}
    )
    solution = fake_solution()
    summary = replace(solution, data=solution.data.merge(network)).summary()
    assert summary["highest_film_temperature_degC"] == pytest.approx(350.0 - 273.15)
    assert summary["outlet_temperature_degC"] == pytest.approx(330.0 - 273.15)
    assert summary["drain_temperature_degC"] == pytest.approx(345.0 - 273.15)
    assert summary["inlet_temperature_degC"] == pytest.approx(50.0)


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
    assert performance.lost_flow_rate(data.assign_attrs(mode="motor"), ledger) == pytest.approx(
        -lost
    )
