"""Bulk heat balance of journals, pads and rings; closed forms of the adiabatic rise."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from toothspace.core.errors import CaseError
from toothspace.films import (
    FilmFluid,
    Groove,
    HeatBalance,
    JournalBearing,
    JournalBearingSolution,
    LateralFilm,
    LateralSolution,
    Pad,
    PadSolution,
    solve_heated,
)

BEARING = JournalBearing(
    diameter=0.1, length=0.08, radial_clearance=1e-4, dynamic_viscosity=0.03, grid=(48, 9)
)
OIL = HeatBalance(supply_temperature=313.0, density=870.0, heat_capacity=1900.0)


def _film(viscosity: float) -> JournalBearingSolution:
    bearing = replace(BEARING, dynamic_viscosity=viscosity)
    return bearing.solve(eccentricity=(0.6, 0.0), shaft_speed=150.0)


def _thinning(temperature: float) -> float:
    return float(0.03 * np.exp(-0.035 * (temperature - 313.0)))


def test_oil_carries_the_friction_power_away() -> None:
    heated = solve_heated(_film, _thinning, OIL)
    rise = heated.outlet_temperature - OIL.supply_temperature
    carried = OIL.density * OIL.heat_capacity * heated.film.side_flow * rise
    assert carried == pytest.approx(heated.film.power_loss, rel=1e-9)
    mean = OIL.supply_temperature + 0.5 * rise
    assert heated.mean_temperature == pytest.approx(mean, abs=1e-4)
    assert heated.film.bearing.dynamic_viscosity == pytest.approx(_thinning(mean), rel=1e-6)


def test_constant_viscosity_gives_the_rise_at_once() -> None:
    film = _film(0.03)
    heated = solve_heated(_film, lambda temperature: 0.03, OIL)
    rise = film.power_loss / (OIL.density * OIL.heat_capacity * film.side_flow)
    assert heated.outlet_temperature == pytest.approx(313.0 + rise, rel=1e-9)


def test_isothermal_film_stays_at_supply_temperature() -> None:
    heated = solve_heated(_film, _thinning, replace(OIL, oil_share=0.0))
    assert heated.mean_temperature == 313.0
    assert heated.film.bearing.dynamic_viscosity == 0.03


def test_walls_instead_of_side_flow_are_refused() -> None:
    closed = replace(BEARING, end_condition="no_flow")
    with pytest.raises(CaseError, match="side flow of a bearing"):
        solve_heated(
            lambda mu: closed.solve(eccentricity=(0.6, 0.0), shaft_speed=150.0), _thinning, OIL
        )


CAPACITY = OIL.density * OIL.heat_capacity


def _pad(viscosity: float) -> PadSolution:
    pad = Pad(
        length=0.02,
        width=0.01,
        inlet_height=20e-6,
        outlet_height=10e-6,
        fluid=FilmFluid(viscosity),
        grid=(256, 4),
        side_condition="no_flow",
    )
    return pad.solve(speed=2.0)


def test_adiabatic_rise_of_an_endless_incline() -> None:
    """Friction mu U L / h0 [4 ln K / (K - 1) - 6 / (K + 1)], flow U h0 K / (K + 1), K = 2."""
    friction = 0.03 * 2.0 * 0.02 / 10e-6 * (4.0 * np.log(2.0) - 2.0)
    rise = friction * 2.0 / (CAPACITY * 2.0 * 10e-6 * 2.0 / 3.0)
    heated = solve_heated(_pad, lambda temperature: 0.03, OIL)
    assert heated.outlet_temperature - 313.0 == pytest.approx(rise, rel=1e-4)
    assert heated.mean_temperature - 313.0 == pytest.approx(0.5 * rise, rel=1e-4)


def test_incline_finds_its_own_viscosity() -> None:
    """The rise is proportional to the viscosity: T = T0 + k mu(T) / 2 by Lambert's function."""
    from scipy.special import lambertw

    slope = solve_heated(_pad, lambda temperature: 0.03, OIL).mean_temperature - 313.0
    rise = float(lambertw(0.035 * slope).real) / 0.035
    heated = solve_heated(_pad, _thinning, OIL)
    assert heated.mean_temperature - 313.0 == pytest.approx(rise, rel=1e-6)
    assert heated.dynamic_viscosity == pytest.approx(_thinning(313.0 + rise), rel=1e-6)
    half = solve_heated(_pad, _thinning, replace(OIL, oil_share=0.5))
    assert half.mean_temperature - 313.0 == pytest.approx(
        float(lambertw(0.035 * 0.5 * slope).real) / 0.035, rel=1e-6
    )


def test_film_hotter_than_the_fluid_is_known() -> None:
    """Found if the viscosity is known a little beyond the answer, refused if it is not."""
    mean = solve_heated(_pad, _thinning, OIL).mean_temperature

    def known(limit: float) -> HeatBalance:
        return replace(OIL, highest_temperature=limit)

    found = solve_heated(_pad, _thinning, known(mean + 0.1))
    assert found.mean_temperature == pytest.approx(mean, abs=1e-5)
    said = f"heat: found a mean temperature beyond {mean - 0.1 - 273.15:.0f} degC"
    with pytest.raises(CaseError, match=said):
        solve_heated(_pad, _thinning, known(mean - 0.1))


def _ring(viscosity: float, **motion: float) -> LateralSolution:
    ring = LateralFilm(
        inner_radius=0.01,
        outer_radius=0.03,
        side_gap=10e-6,
        fluid=FilmFluid(viscosity),
        grid=(32, 64),
        inner_pressure=1e5,
        outer_pressure=101e5,
    )
    return ring.solve(**motion)


def test_throttled_oil_warms_by_its_pressure() -> None:
    """Delta p / (rho c), whatever the viscosity: 6.05 K per 100 bar of this oil."""
    heated = solve_heated(_ring, _thinning, OIL)
    assert heated.outlet_temperature - 313.0 == pytest.approx(100e5 / CAPACITY, rel=1e-9)


def test_rotation_adds_its_torque() -> None:
    """Torque pi mu omega (R^4 - r^4) / (2 h), flow pi h^3 dp / (6 mu ln(R / r))."""
    torque = np.pi * 0.03 * 200.0 * (0.03**4 - 0.01**4) / (2.0 * 10e-6)
    flow = np.pi * 1e-15 * 100e5 / (6.0 * 0.03 * np.log(3.0))
    film = _ring(0.03, shaft_speed=200.0)
    assert film.dissipated_power == pytest.approx(torque * 200.0 + flow * 100e5, rel=1e-3)
    heated = solve_heated(lambda mu: _ring(mu, shaft_speed=200.0), lambda temperature: 0.03, OIL)
    rise = torque * 200.0 / (CAPACITY * flow) + 100e5 / CAPACITY
    assert heated.outlet_temperature - 313.0 == pytest.approx(rise, rel=1e-3)


def test_squeezed_disc_warms_by_the_work_of_its_load() -> None:
    """Load 3 pi mu R^4 V / (2 h^3), flow pi R^2 V (Stefan 1874)."""
    disc = LateralFilm(
        inner_radius=0.0,
        outer_radius=0.02,
        side_gap=20e-6,
        fluid=FilmFluid(0.03),
        grid=(16, 128),
        outer_pressure=1e5,
    )
    film = disc.solve(squeeze_velocity=-0.01)
    load = 1.5 * np.pi * 0.03 * 0.02**4 * 0.01 / 20e-6**3
    assert film.outflow == pytest.approx(np.pi * 0.02**2 * 0.01, rel=1e-9)
    assert film.dissipated_power == pytest.approx(load * 0.01, rel=1e-3)


def test_supply_pressure_heats_a_bearing() -> None:
    """Oil that a groove feeds at 50 bar is throttled on its way to the ends."""
    groove = Groove(angle=0.0, width=0.3, length=0.04, pressure=50e5)
    film = replace(BEARING, grooves=(groove,), end_pressure=1e5, cavitation_pressure=0.0).solve(
        shaft_speed=0.0
    )
    assert film.power_loss == 0.0
    assert film.dissipated_power == pytest.approx(49e5 * film.side_flow, rel=1e-9)
