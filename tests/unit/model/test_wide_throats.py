"""Throats between flanks that open wide: conductance of an opening, and no steps lost to it."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np
import pytest

from benchmarks.random_designs import first_case
from toothspace import api
from toothspace.case import Case
from toothspace.closures.gap_flow import (
    NARROW,
    curved_gap_conductance,
    fitted_gap_conductance,
)
from toothspace.model.assembly import System, assemble
from toothspace.solver.initial import start_state
from toothspace.solver.integrator import start_march

CASES = Path(__file__).resolve().parents[3] / "cases"
SLOW = ["operating_point.shaft_speed=12.3 rpm", "operating_point.outlet_pressure=149 bar"]


def system_of(case: Case) -> System:
    run = api.prepare(case)
    return assemble(run.machine, run.fluid, run.condition)


def counts_in_a_ninth_of_a_turn(case: Case) -> dict[str, float]:
    system = system_of(case)
    march = start_march(system, start_state(system))
    turn = 2.0 * np.pi / system.condition.shaft_speed
    march.advance(np.array([turn / 9.0]))
    return march.statistics


@pytest.mark.parametrize("law", [curved_gap_conductance, fitted_gap_conductance])
def test_a_wide_throat_conducts_like_an_opening(law: Any) -> None:
    """Narrow as the closed form says, then in proportion to the area times the height."""
    height, radius = np.array([0.5, 1.0, 2.0, 4.0]) * NARROW * 5e-3, 5e-3
    found = law(height, 20e-3, radius, 0.03)
    assert np.log2(found[1] / found[0]) == pytest.approx(2.5, abs=0.02)
    np.testing.assert_allclose(found[2:] / found[1], [4.0, 16.0])


def test_throats_between_hyperbolas_are_near_creeping_flow() -> None:
    """Stokes flow has a closed form there; its limits are the narrow gap and the thin screen.

    Stream function a eta + b sin 2 eta of elliptic coordinates, walls at the angle phi.
    """
    openness = np.logspace(-4.0, 6.0, 41)
    phi = np.arctan(0.5 * np.sqrt(openness))
    exact = (np.sin(2.0 * phi) - 2.0 * phi * np.cos(2.0 * phi)) / (32.0 * np.sin(phi) ** 2)
    assert exact[-1] == pytest.approx(np.pi / 32.0, rel=1e-4)
    ratio = curved_gap_conductance(openness, 1.0, 1.0, 1.0) / openness**2 / exact
    assert ratio.max() < 1.22
    assert ratio.min() > 0.16


def test_wide_throats_do_not_bound_the_steps_of_a_slow_machine() -> None:
    """Drops of some pascals, far below the tolerance, once cost a step per microsecond."""
    pump = api.load_case(CASES / "egm12_pump.toml", SLOW)
    assert counts_in_a_ninth_of_a_turn(pump)["steps"] < 3000


@pytest.mark.parametrize("seed", [104, 239])
def test_steps_at_one_revolution_a_minute_are_solved_for_flows(seed: int) -> None:
    """A gear and a crescent motor, hot oil; solved for pressures alone the first took 31 826.

    It takes 2 400 to 3 900 by processor: rounding chooses among steps that fail.
    """
    assert counts_in_a_ninth_of_a_turn(first_case(seed)[1])["steps"] < 8000


def test_steps_that_will_fail_are_cut_at_their_first_evaluation() -> None:
    """With every iteration finished, this motor takes 2.5 evaluations a step."""
    counts = counts_in_a_ninth_of_a_turn(api.load_case(CASES / "egm12_motor.toml"))
    assert counts["rhs"] < 2.4 * counts["steps"]
