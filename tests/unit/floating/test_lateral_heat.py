"""Lateral films that warm up by what they dissipate."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.lateral_stack import VISCOSITY, loads, pressures, ring_stack
from toothspace.films.thermal import FilmHeating, HeatBalance
from toothspace.floating.heat import SettledBearing, settle_bearing
from toothspace.floating.motion import Balance
from toothspace.floating.problem import LateralProblem, LateralSettings

SUPPLY, THINNING = 330.0, 0.02


def _heating(share: float, **changes: float) -> FilmHeating:
    oil = HeatBalance(
        supply_temperature=SUPPLY, density=800.0, heat_capacity=2000.0, oil_share=share
    )
    return FilmHeating(
        replace(oil, **changes), lambda t: VISCOSITY * float(np.exp(-THINNING * (t - SUPPLY)))
    )


def _settled(problem: LateralProblem, start: Balance, heating: FilmHeating) -> SettledBearing:
    return settle_bearing(replace(problem, settings=LateralSettings(heating=heating)), start)


@pytest.fixture(scope="module")
def problem() -> LateralProblem:
    """Ring between low pressure on one side and high on the other, so that oil flows through."""
    stack = ring_stack(approach=3e-13, high_share=0.4, limit=0.0, preload=400.0, cells=(24, 8))
    snapshots = (stack.snapshot(0.0, pressures(60e5)),)
    return LateralProblem(
        stack, snapshots, loads(60e5), lambda _: pressures(60e5), LateralSettings()
    )


def test_isothermal_films_keep_the_temperature_of_the_supply(problem: LateralProblem) -> None:
    start = problem.started(2e-6)
    found = _settled(problem, start, _heating(0.0))
    assert found.warm
    assert found.temperatures == pytest.approx([SUPPLY, SUPPLY])
    cold = problem.settle(start).balance
    assert found.equilibrium.balance.position == pytest.approx(cold.position, rel=1e-9)


def test_heat_of_the_films_agrees_with_their_viscosity(problem: LateralProblem) -> None:
    """Heat balance by hand: T = T0 + P / (2 rho c Q) with the film's own power and flow."""
    heating = _heating(1.0)
    found = _settled(problem, problem.started(2e-6), heating)
    assert found.warm
    assert found.equilibrium.settled
    for film, law, temperature in zip(
        found.equilibrium.balance.states[0].films,
        found.problem.stack.laws,
        found.temperatures,
        strict=True,
    ):
        lost = film.losses
        rise = 0.5 * (lost.dissipation + lost.asperity) / (1.6e6 * film.plane.exchange.outflow)
        assert rise > 1.0
        assert temperature - SUPPLY == pytest.approx(rise, abs=0.3)
        assert law.fluid.dynamic_viscosity == pytest.approx(heating.viscosity(temperature))
    # thrown-away heat: half of it in the oil warms it less, as much as it thins less
    half = _settled(problem, problem.started(2e-6), _heating(0.5))
    assert SUPPLY < half.temperatures.min() < found.temperatures.min()


def test_film_hotter_than_the_fluid_is_known_for_has_not_agreed(problem: LateralProblem) -> None:
    limit = SUPPLY + 0.5
    found = _settled(problem, problem.started(2e-6), _heating(1.0, highest_temperature=limit))
    assert not found.warm
    assert found.temperatures.max() <= limit
