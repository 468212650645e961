"""Flow laws against their limits, quadrature and the numbers of PHYSICS 6."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from toothspace.closures.gap_flow import (
    annular_land_conductance,
    couette_flow_rate,
    curved_gap_conductance,
    curved_gap_conductance_fitted,
    gap_flow_rate_couette_poiseuille,
    parallel_gap_conductance,
    throat_drag_flow_rate,
    tilted_gap_factor,
)
from toothspace.closures.orifice import (
    inertial_laminar_flow,
    orifice_conductance,
    orifice_flow_rate,
    orifice_flow_rate_root,
    orifice_flow_rate_tanh,
)
from toothspace.core.compiled import njit

AREA, DIAMETER, DENSITY, VISCOSITY = 4e-6, 2e-3, 842.0, 0.026


def test_orifice_is_the_law_of_borutzky() -> None:
    """Q = A v_t/2 (sqrt(1 + 8 C^2 dp/(rho v_t^2)) - 1), PHYSICS 6.1."""
    drop = np.array([1.0, 1e3, 1e5, 1e7])
    speed = 350.0 * VISCOSITY / DENSITY / DIAMETER
    expected = 0.5 * AREA * speed * (np.sqrt(1 + 8 * 0.49 * drop / (DENSITY * speed**2)) - 1)
    flow = orifice_flow_rate(drop, AREA, DIAMETER, DENSITY, VISCOSITY)
    # the printed form cancels at small drops
    assert flow == pytest.approx(expected, rel=1e-6)


def test_orifice_is_turbulent_at_the_end_and_laminar_at_the_start() -> None:
    flow = orifice_flow_rate(1e9, AREA, DIAMETER, DENSITY, 1e-6)
    assert flow == pytest.approx(0.7 * AREA * np.sqrt(2e9 / DENSITY), rel=1e-4)
    slow = orifice_flow_rate(1e-3, AREA, DIAMETER, DENSITY, VISCOSITY)
    assert slow == pytest.approx(1e-3 * orifice_conductance(AREA, DIAMETER, VISCOSITY), rel=1e-4)


def test_all_orifice_laws_agree_in_turbulent_flow() -> None:
    """With the laminar start of a sharp opening, as the other laws have it."""
    arguments = (50e5, AREA, DIAMETER, DENSITY, VISCOSITY)
    flow = orifice_flow_rate(*arguments, transition_reynolds_number=35.0)
    assert orifice_flow_rate_tanh(*arguments) == pytest.approx(flow, rel=0.02)
    assert orifice_flow_rate_root(*arguments) == pytest.approx(flow, rel=0.02)


def test_tanh_law_has_its_laminar_slope() -> None:
    """Q = (4 C/lambda_crit) A Dh dp/(rho nu), PHYSICS 6.1."""
    drop = 1e-4
    flow = orifice_flow_rate_tanh(drop, AREA, DIAMETER, DENSITY, VISCOSITY)
    assert flow == pytest.approx(4 * 0.7 / 1000 * AREA * DIAMETER * drop / VISCOSITY, rel=1e-4)


def test_root_law_at_its_critical_pressure() -> None:
    """At p_cr the law is 2^(-1/4) of the turbulent one, by its formula."""
    critical = 0.5 * DENSITY * (12 * VISCOSITY / DENSITY / (0.7 * DIAMETER)) ** 2
    turbulent = 0.7 * AREA * np.sqrt(2 * critical / DENSITY)
    flow = orifice_flow_rate_root(critical, AREA, DIAMETER, DENSITY, VISCOSITY)
    assert flow == pytest.approx(turbulent * 2**-0.25)


def test_path_law_solves_its_equation_and_gives_its_derivatives() -> None:
    drop, conductance, area = 30e5, 2e-11, 3e-6
    flow, by_pressure, by_conductance = inertial_laminar_flow(drop, conductance, area, DENSITY)
    assert flow / conductance + DENSITY / (2 * area**2) * flow**2 == pytest.approx(drop)
    step = inertial_laminar_flow(drop + 1.0, conductance, area, DENSITY)[0]
    assert step - flow == pytest.approx(by_pressure, rel=1e-5)
    step = inertial_laminar_flow(drop, conductance * (1 + 1e-6), area, DENSITY)[0]
    assert (step - flow) / (1e-6 * conductance) == pytest.approx(by_conductance, rel=1e-4)


def test_closed_path_has_no_flow_and_finite_derivatives() -> None:
    flow, by_pressure, by_conductance = inertial_laminar_flow(100e5, 0.0, 0.0, DENSITY)
    assert flow == 0.0
    assert by_pressure == 0.0
    assert np.isfinite(by_conductance)


def test_curved_gap_is_the_lubrication_integral() -> None:
    """Quadrature of 12 mu dx / h^3 through h0 + x^2/2R (PHYSICS 6.3)."""
    height, radius = 20e-6, 3e-3
    length = np.sqrt(2 * radius * height)
    integral = 2 * quad(lambda t: length / (height * (1 + t * t)) ** 3, 0, 200)[0]
    conductance = curved_gap_conductance(height, 1.0, radius, VISCOSITY)
    assert 1 / (12 * VISCOSITY * integral) == pytest.approx(conductance, rel=1e-6)
    constant = conductance * VISCOSITY * np.sqrt(radius) / height**2.5
    assert constant == pytest.approx(0.050018, abs=1e-6)


@pytest.mark.parametrize(
    ("ratio", "expected"),
    [  # table of PHYSICS 6.3
        (1e-5, 1.10),
        (1e-4, 1.06),
        (1e-3, 1.02),
        (3e-3, 1.003),
        (1e-2, 0.983),
        (1e-1, 0.947),
    ],
)
def test_fitted_curved_gap(ratio: float, expected: float) -> None:
    arguments = (ratio, 1.0, 1.0, 1.0)
    quotient = curved_gap_conductance_fitted(*arguments) / curved_gap_conductance(*arguments)
    assert quotient == pytest.approx(expected, abs=0.006)


def test_narrow_ring_is_a_parallel_gap() -> None:
    ring = annular_land_conductance(10e-6, 0.020, 0.0201, 0.5, VISCOSITY)
    strip = parallel_gap_conductance(10e-6, 0.5 * 0.02005, 0.1e-3, VISCOSITY)
    assert ring == pytest.approx(strip, rel=1e-5)


def test_tilt_factor_is_the_mean_of_the_cubes() -> None:
    angle = np.linspace(0, 2 * np.pi, 400, endpoint=False)
    mean = np.mean((1 + 0.6 * 0.8 * np.cos(angle)) ** 3)
    assert tilted_gap_factor(0.6, 0.8) == pytest.approx(mean)


def test_smooth_disc_pumps_half_of_its_gap_forward() -> None:
    """PHYSICS 6.2: the limiting case of the tip gap in the frame of the housing."""
    speed, height, width = 5.0, 20e-6, 10e-3
    drag = couette_flow_rate(0.5 * speed, height, width)
    assert drag == pytest.approx(0.5 * width * speed * height)
    flow = gap_flow_rate_couette_poiseuille(0.0, speed, height, width, 1e-3, VISCOSITY)
    assert flow == pytest.approx(drag)


def test_no_drag_through_a_throat_that_moves_with_both_walls() -> None:
    assert throat_drag_flow_rate(3.0, 3.0, 3.0, 20e-6, 10e-3) == 0.0
    expected = 20e-6 * 10e-3 * ((1.0 + 4.0) / 2 - 1.0)
    assert throat_drag_flow_rate(1.0, 4.0, 1.0, 20e-6, 10e-3) == pytest.approx(expected)


@njit
def _compiled(drop: float) -> tuple[float, float, float]:
    conductance = orifice_conductance(AREA, DIAMETER, VISCOSITY)
    conductance += curved_gap_conductance(1e-5, 1e-2, 1e-3, VISCOSITY)
    return inertial_laminar_flow(drop, conductance, 0.7 * AREA, DENSITY)


def test_compiled_flow_equals_python() -> None:
    assert _compiled(-2e5) == pytest.approx(_compiled.py_func(-2e5), rel=1e-14)
