"""Bulk heat balance of a journal film."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from toothspace.core.errors import CaseError
from toothspace.films import HeatBalance, JournalBearing, JournalBearingSolution, solve_heated

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
    with pytest.raises(CaseError, match="side flow"):
        solve_heated(
            lambda mu: closed.solve(eccentricity=(0.6, 0.0), shaft_speed=150.0), _thinning, OIL
        )
