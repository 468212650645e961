"""Loss models: a map made of known coefficients gives them back."""

from __future__ import annotations

import numpy as np
import pytest
import xarray as xr

from toothspace.studies.loss_models import fit_losses, loss_data, loss_numbers, loss_table

VOLUME = 5e-6 / (2.0 * np.pi)
VISCOSITY, DENSITY = 0.03, 860.0
SLIP, TURBULENT, VISCOUS, FRICTION, INERTIA, CONSTANT = 2e-9, 1e-5, 4e4, 0.03, 15.0, 0.2


def made_map(*, motor: bool, turbulent: float = 0.0, inertia: float = 0.0) -> xr.Dataset:
    """Flow and torque with losses by the formulas."""
    speed = np.array([50.0, 100.0, 200.0, 300.0])
    pressure = np.array([20e5, 80e5, 150e5, 250e5])
    w, p = np.meshgrid(speed, pressure, indexing="ij")
    lost_flow = SLIP * VOLUME * p / VISCOSITY
    lost_flow += turbulent * VOLUME ** (2 / 3) * np.sqrt(2.0 * p / DENSITY)
    lost_torque = VISCOUS * VOLUME * VISCOSITY * w + FRICTION * VOLUME * p + CONSTANT
    lost_torque += inertia * DENSITY * VOLUME ** (5 / 3) * w**2
    sign = -1.0 if motor else 1.0
    axes = ("shaft_speed", "pressure_difference")
    return xr.Dataset(
        {
            "displacement_cm3_per_rev": (axes, np.full(w.shape, 5.0)),
            "mean_flow_L_per_min": (axes, 6e4 * (VOLUME * w - sign * lost_flow)),
            "mean_torque_N_m": (axes, VOLUME * p + sign * lost_torque),
        },
        coords={axes[0]: speed, axes[1]: pressure},
    )


def fitted(data: xr.Dataset, *, motor: bool = False) -> dict[str, dict[str, float]]:
    fits = fit_losses(data, motor=motor, dynamic_viscosity=VISCOSITY, density=DENSITY)
    return {
        f"{fit.model} {fit.loss}": dict(zip(fit.names, fit.values, strict=True)) for fit in fits
    }


@pytest.mark.parametrize("motor", [False, True])
def test_coefficients_come_back(motor: bool) -> None:
    found = fitted(made_map(motor=motor), motor=motor)
    assert found["wilson flow"]["slip"] == pytest.approx(SLIP)
    torque = {
        "viscous_friction": VISCOUS,
        "pressure_friction": FRICTION,
        "constant_torque": CONSTANT,
    }
    assert found["wilson torque"] == pytest.approx(torque)
    found = fitted(made_map(motor=motor, turbulent=TURBULENT, inertia=INERTIA), motor=motor)
    assert found["schloesser flow"] == pytest.approx({"slip": SLIP, "turbulent_slip": TURBULENT})
    assert found["schloesser torque"] == pytest.approx({**torque, "inertia": INERTIA})


def test_the_polynomial_is_exact_for_losses_of_its_powers() -> None:
    """Losses of Wilson lie in its span: k01 is the slip at full pressure, all others are zero."""
    found = fitted(made_map(motor=False))
    expected = dict.fromkeys(found["polynomial flow"], 0.0)
    expected["k01"] = 6e4 * SLIP * VOLUME * 250e5 / VISCOSITY
    assert found["polynomial flow"] == pytest.approx(expected, abs=1e-9)
    torque = found["polynomial torque"]
    assert torque["k10"] == pytest.approx(VISCOUS * VOLUME * VISCOSITY * 300.0)
    assert torque["k00"] == pytest.approx(CONSTANT)


def test_errors_are_those_of_the_residuals() -> None:
    """Noise of known size: its deviation is the error, 95 % of intervals hold the true value."""
    random, held, runs = np.random.default_rng(1), 0, 200
    clean = made_map(motor=False)
    for _ in range(runs):
        data = clean.copy()
        data["mean_flow_L_per_min"] = clean["mean_flow_L_per_min"] + random.normal(0, 0.05, (4, 4))
        fit = fit_losses(data, motor=False, dynamic_viscosity=VISCOSITY, density=DENSITY)[0]
        held += abs(fit.values[0] - SLIP) < fit.half_widths[0]
    assert held / runs == pytest.approx(0.95, abs=0.04)
    assert 6e4 * fit.error == pytest.approx(0.05, rel=0.5)


def test_failed_points_are_left_out_and_few_points_fit_no_polynomial() -> None:
    data = made_map(motor=False)
    data["mean_flow_L_per_min"][0, 0] = np.nan
    assert fitted(data)["wilson flow"]["slip"] == pytest.approx(SLIP)
    assert set(fitted(data.isel(shaft_speed=slice(2), pressure_difference=slice(2)))) == {
        "wilson flow",
        "wilson torque",
        "schloesser flow",
    }
    assert fitted(data.drop_vars("mean_torque_N_m")) == {}


def test_numbers_table_and_data_say_the_same() -> None:
    fits = fit_losses(
        made_map(motor=False), motor=False, dynamic_viscosity=VISCOSITY, density=DENSITY
    )
    numbers, table = loss_numbers(fits), loss_table(fits)
    assert numbers["wilson_slip"] == pytest.approx(SLIP)
    assert numbers["wilson_constant_torque_N_m"] == pytest.approx(CONSTANT)
    assert numbers["wilson_flow_error_L_per_min"] == pytest.approx(0.0, abs=1e-9)
    row = next(row for row in table.rows if row[:3] == ("wilson", "flow", "slip"))
    assert row[3] == numbers["wilson_slip"]
    data = xr.Dataset(loss_data(fits))
    assert float(data["loss_coefficient_value"].sel(loss_coefficient="wilson flow slip")) == row[3]
    assert data.sizes["loss_coefficient"] == len(table.rows)
