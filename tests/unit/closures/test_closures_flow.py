"""Flow laws against their limits, quadrature and published laws."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from tests.reference_formulas.flow import (
    borutzky_flow_rate,
    root_flow_rate,
    tanh_flow_rate,
)
from toothspace.closures.accumulator import gas_charge_energy, gas_charge_volume
from toothspace.closures.gap_flow import (
    curved_gap_conductance,
    equal_leakage_height,
    fitted_gap_conductance,
    land_shear_torque,
    parallel_gap_conductance,
    ring_sector_gap,
    tilted_gap_height,
    wall_drag_flow_rate,
)
from toothspace.closures.hydraulic_resistance import resistance_flow, throttle_flow, valve_flow
from toothspace.closures.orifice import (
    inertial_laminar_drop,
    inertial_laminar_flow,
    orifice_conductance,
)
from toothspace.core.compiled import njit

AREA, DIAMETER, DENSITY, VISCOSITY = 4e-6, 2e-3, 842.0, 0.026


def orifice_flow(drop: np.ndarray, viscosity: float = VISCOSITY, **options: float) -> np.ndarray:
    """An orifice as the network runs it: its conductance and its kinetic loss in series."""
    conductance = orifice_conductance(AREA, DIAMETER, viscosity, **options)
    return inertial_laminar_flow(drop, conductance, 0.7 * AREA, DENSITY)[0]


def test_orifice_is_the_law_of_borutzky() -> None:
    drop = np.array([1.0, 1e3, 1e5, 1e7])
    expected = borutzky_flow_rate(drop, AREA, DIAMETER, DENSITY, VISCOSITY)
    # the printed form cancels at small drops
    assert orifice_flow(drop) == pytest.approx(expected, rel=1e-6, abs=0.0)


def test_orifice_is_turbulent_at_the_end_and_laminar_at_the_start() -> None:
    flow = orifice_flow(1e9, viscosity=1e-6)
    assert flow == pytest.approx(0.7 * AREA * np.sqrt(2e9 / DENSITY), rel=1e-4)
    slow = orifice_flow(1e-3)
    assert slow == pytest.approx(
        1e-3 * orifice_conductance(AREA, DIAMETER, VISCOSITY), rel=1e-4, abs=0.0
    )


def test_orifice_laws_agree_in_turbulent_flow() -> None:
    """With the laminar start of a sharp opening, as the other laws have it."""
    flow = orifice_flow(50e5, transition_reynolds_number=35.0)
    other = root_flow_rate(50e5, AREA, DIAMETER, DENSITY, VISCOSITY)
    assert other == pytest.approx(flow, rel=0.02)
    assert tanh_flow_rate(50e5, AREA, DIAMETER, DENSITY, VISCOSITY) == pytest.approx(
        other, rel=0.02
    )
    assert throttle_flow(50e5, 0.7 * AREA, DENSITY)[0] == pytest.approx(other, rel=1e-4)


@pytest.mark.parametrize("drop", [-3e5, 200.0, 4e3, 2e7])
@pytest.mark.parametrize(
    ("law", "constants"),
    [
        (throttle_flow, (3e-6, DENSITY)),
        (resistance_flow, (2e9, 3e13)),
        (valve_flow, (3e3, 1e9, 5e3)),
    ],
)
def test_resistances_give_their_derivative(law, constants, drop: float) -> None:
    step = 1e-5 * abs(drop)
    rise = law(drop + step, *constants)[0] - law(drop - step, *constants)[0]
    assert rise / (2.0 * step) == pytest.approx(law(drop, *constants)[1], rel=1e-6, abs=1e-20)


def test_resistance_solves_its_equation() -> None:
    flow, _ = resistance_flow(7e5, 2e9, 3e13)
    assert 2e9 * flow + 3e13 * flow**2 == pytest.approx(7e5)


def test_valve_is_shut_below_its_pressure_and_straight_above() -> None:
    assert valve_flow(99e5, 100e5, 1e10, 1e5) == (0.0, 0.0)
    assert valve_flow(110e5, 100e5, 1e10, 1e5)[0] == pytest.approx((10e5 - 0.5e5) / 1e10)


def test_gas_charge_keeps_the_work_done_on_it() -> None:
    """Quadrature of p dV from the precharge on, and the adiabatic law by hand."""
    volume, slope = gas_charge_volume(90e5, 1e-3, 40e5, 1.3)
    assert volume == pytest.approx(1e-3 * (1.0 - (40.0 / 90.0) ** (1.0 / 1.3)))
    step = gas_charge_volume(90e5 + 1.0, 1e-3, 40e5, 1.3)[0] - volume
    assert step == pytest.approx(slope, rel=1e-6, abs=0.0)
    work = quad(lambda p: p * gas_charge_volume(p, 1e-3, 40e5, 1.3)[1], 40e5, 90e5)[0]
    assert gas_charge_energy(90e5, 1e-3, 40e5, 1.3) == pytest.approx(work, rel=1e-9)


def test_path_law_solves_its_equation_and_gives_its_derivatives() -> None:
    drop, conductance, area = 30e5, 2e-11, 3e-6
    flow, by_pressure, by_conductance = inertial_laminar_flow(drop, conductance, area, DENSITY)
    assert flow / conductance + DENSITY / (2 * area**2) * flow**2 == pytest.approx(drop)
    step = inertial_laminar_flow(drop + 1.0, conductance, area, DENSITY)[0]
    assert step - flow == pytest.approx(by_pressure, rel=1e-5, abs=0.0)
    step = inertial_laminar_flow(drop, conductance * (1 + 1e-6), area, DENSITY)[0]
    assert (step - flow) / (1e-6 * conductance) == pytest.approx(by_conductance, rel=1e-4)


def test_closed_path_has_no_flow_and_finite_derivatives() -> None:
    flow, by_pressure, by_conductance = inertial_laminar_flow(100e5, 0.0, 0.0, DENSITY)
    assert flow == 0.0
    assert by_pressure == 0.0
    assert np.isfinite(by_conductance)


def test_curved_gap_is_the_lubrication_integral() -> None:
    """Quadrature of 12 mu dx / h^3 through h0 + x^2/2R."""
    height, radius = 20e-6, 3e-3
    length = np.sqrt(2 * radius * height)
    integral = 2 * quad(lambda t: length / (height * (1 + t * t)) ** 3, 0, 200)[0]
    conductance = curved_gap_conductance(height, 1.0, radius, VISCOSITY)
    assert 1 / (12 * VISCOSITY * integral) == pytest.approx(conductance, rel=1e-6, abs=0.0)
    constant = conductance * VISCOSITY * np.sqrt(radius) / height**2.5
    assert constant == pytest.approx(0.050018, abs=1e-6)


def test_tanh_law_has_the_laminar_slope_of_the_default() -> None:
    slow = tanh_flow_rate(1e-4, AREA, DIAMETER, DENSITY, VISCOSITY)
    assert orifice_flow(1e-4) == pytest.approx(slow, rel=1e-3, abs=0.0)


@pytest.mark.parametrize("ratio", [3e-4, 1e-3, 1e-2, 1e-1])
def test_published_fit_of_the_curved_gap_is_within_its_accuracy(ratio: float) -> None:
    fit = fitted_gap_conductance(ratio, 1.0, 1.0, 1.0)
    assert curved_gap_conductance(ratio, 1.0, 1.0, 1.0) == pytest.approx(fit, rel=0.057)


def test_ring_sector_leaks_as_its_quadrature() -> None:
    """Resistances of thin rings in series, 12 mu dr / (phi r h^3)."""
    width, length = ring_sector_gap(0.009, 0.020, 0.5)
    ours = parallel_gap_conductance(10e-6, width, length, VISCOSITY)
    rings = quad(lambda r: 12.0 * VISCOSITY / (0.5 * r * 10e-6**3), 0.009, 0.020)[0]
    assert ours == pytest.approx(1.0 / rings, rel=1e-9, abs=0.0)


def test_tilted_gap_leaks_as_the_mean_of_the_cubes() -> None:
    angle = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    mean = np.mean((10e-6 * (1 + 0.48 * np.cos(angle))) ** 3)
    assert tilted_gap_height(10e-6, 0.48) ** 3 == pytest.approx(mean, rel=1e-9, abs=0.0)


def test_two_equal_gaps_leak_as_two_different_ones() -> None:
    assert 2.0 * equal_leakage_height(10e-6, 25e-6) ** 3 == pytest.approx(
        10e-6**3 + 25e-6**3, rel=1e-9, abs=0.0
    )
    assert equal_leakage_height(15e-6, 15e-6) == pytest.approx(15e-6)


def test_smooth_disc_pumps_half_of_its_gap_forward() -> None:
    """Off centre too: what the displacement opened moves with the disc, half of it is missing."""
    speed, height, width = 5.0, 20e-6, 10e-3
    drag = wall_drag_flow_rate(height, width, 0.5 * speed, 0.0, speed)
    assert drag == pytest.approx(0.5 * width * speed * height)
    opened = wall_drag_flow_rate(height + 4e-6, width, 0.5 * speed, 4e-6, speed)
    assert opened == pytest.approx(0.5 * width * speed * (height - 4e-6))


def test_shear_of_a_land() -> None:
    """By hand: mu u/h = 1300 Pa on 1.5e-7 m3 of area times lever."""
    torque = land_shear_torque(50.0, 0.020, 20e-6, 7.5e-3, 1e-3, 0.026)
    assert torque == pytest.approx(1300.0 * 7.5e-3 * 1e-3 * 0.020)


@njit
def _compiled(drop: float) -> tuple[float, float, float]:
    conductance = orifice_conductance(AREA, DIAMETER, VISCOSITY)
    conductance += curved_gap_conductance(1e-5, 1e-2, 1e-3, VISCOSITY)
    return inertial_laminar_flow(drop, conductance, 0.7 * AREA, DENSITY)


def test_compiled_flow_equals_python() -> None:
    assert _compiled(-2e5) == pytest.approx(_compiled.py_func(-2e5), rel=1e-14, abs=0.0)


@pytest.mark.parametrize("flow", [-3e-4, -1e-9, 0.0, 2e-7, 5e-5])
def test_drop_of_a_flow_is_the_inverse_of_the_flow_of_a_drop(flow):
    path = (2e-9, 3e-6, 850.0)
    drop, by_flow = inertial_laminar_drop(flow, *path)
    back, by_drop, _ = inertial_laminar_flow(drop, *path)
    assert back == pytest.approx(flow, rel=1e-12, abs=1e-20)
    assert by_flow * by_drop == pytest.approx(1.0, rel=1e-12)


def test_drop_is_laminar_at_small_and_kinetic_at_large_flow():
    conductance, area, density = 2e-9, 3e-6, 850.0
    slow, _ = inertial_laminar_drop(1e-12, conductance, area, density)
    fast, _ = inertial_laminar_drop(1.0, conductance, area, density)
    assert slow == pytest.approx(1e-12 / conductance, rel=1e-6)
    assert fast == pytest.approx(0.5 * density / area**2, rel=1e-3)


def test_a_throttle_is_linear_far_below_one_kilopascal() -> None:
    """A_d sqrt(2/rho) dp/sqrt(1000 Pa), and the root of the drop far above."""
    scale = 3e-6 * np.sqrt(2.0 / DENSITY)
    slow, slope = throttle_flow(0.1, 3e-6, DENSITY)
    assert slow == pytest.approx(scale * 0.1 / np.sqrt(1e3), rel=1e-6, abs=0.0)
    assert slope == pytest.approx(scale / np.sqrt(1e3), rel=1e-6)
    assert throttle_flow(1e3, 3e-6, DENSITY)[0] == pytest.approx(
        scale * np.sqrt(1e3) / 2.0**0.25, rel=1e-9
    )


def test_a_valve_opens_with_a_parabola_of_its_rounding() -> None:
    """x^2/(2 w k) at half the rounding: 1/8 of w/k; at its end the line goes on."""
    half, slope = valve_flow(100.5e5, 100e5, 1e10, 1e5)
    assert half == pytest.approx(0.125 * 1e5 / 1e10)
    assert slope == pytest.approx(0.5 / 1e10, rel=1e-9, abs=0.0)
    assert valve_flow(101e5, 100e5, 1e10, 1e5)[0] == pytest.approx(0.5 * 1e5 / 1e10)


def test_walls_are_parabolas_up_to_a_tenth_of_their_radius() -> None:
    """Conductance as h^2.5 below, as h^2 above; the published fit as h^2.4836."""
    for law, power in ((curved_gap_conductance, 2.5), (fitted_gap_conductance, 2.4836)):
        narrow = law(0.05e-3, 1.0, 1e-3, VISCOSITY) / law(0.025e-3, 1.0, 1e-3, VISCOSITY)
        assert narrow == pytest.approx(2.0**power, rel=1e-9)
        wide = law(0.4e-3, 1.0, 1e-3, VISCOSITY) / law(0.1e-3, 1.0, 1e-3, VISCOSITY)
        assert wide == pytest.approx(16.0, rel=1e-9)
    by_hand = 0.0456 * 0.01**2.4836 * 1e-6 * 3.0 / VISCOSITY  # h/R = 0.01, R = 1 mm, b = 3 m
    assert fitted_gap_conductance(1e-5, 3.0, 1e-3, VISCOSITY) == pytest.approx(
        by_hand, rel=1e-9, abs=0.0
    )
