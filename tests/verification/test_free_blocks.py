"""Bearing blocks that follow their load: reaction, balance, place, and what presses them."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest

import toothspace as ts
from tests.iteration_matrices import jacobian_of, slope_of_rates
from toothspace.api import fluid_of
from toothspace.core.errors import CaseError
from toothspace.model.assembly import System, assemble
from toothspace.results.solution import Solution
from toothspace.run.condition import condition_of
from toothspace.solver.cyclic import RunPlan, march_revolutions

CASES = Path(__file__).resolve().parents[2] / "cases"
FREE = "machine.bearing_blocks.motion=free"
CLEARANCE = 25e-6


@cache
def steady(*overrides: str) -> Solution:
    return ts.simulate(ts.load_case(CASES / "egm12_motor.toml", overrides))


@cache
def pump() -> System:
    """Blocks pressed by the ports of a pump that works against an orifice."""
    case = ts.load_case(
        CASES / "egm12_pump.toml", (FREE, "machine.bearing_blocks.port_area=5 mm^2")
    )
    description = ts.describe(case)
    return assemble(description, fluid_of(case), condition_of(case, description))


def test_jacobian_is_the_derivative_of_the_rates() -> None:
    system = pump()
    size = system.arrays.size
    state = march_revolutions(system, RunPlan(revolutions=1, samples_per_revolution=36)).states[17]
    matrix = jacobian_of(system, state)
    for column in range(size.position, size.column):
        step = 1e-12 if column < size.velocity else 1e-9
        expected = slope_of_rates(system, state, column, step)
        assert np.abs(matrix[: size.core, column] - expected).max() < 2e-3 * np.abs(expected).max()


@pytest.mark.slow
def test_film_of_the_blocks_carries_what_both_gears_press() -> None:
    """Without inertia the forces on blocks and gears cancel, as those of both bearings do."""
    data = steady(FREE).data
    load = -data["journal_force"].mean("shaft_angle").sum("body").values[:2]
    place = data["block_position"].mean("shaft_angle").values[:2]
    assert load[0] > 4000.0
    assert place / np.hypot(*place) == pytest.approx(load / np.hypot(*load), abs=0.01)
    assert 0.85 * CLEARANCE < np.hypot(*place) < CLEARANCE


@pytest.mark.slow
def test_mass_and_energy_close() -> None:
    numbers = steady(FREE).summary()
    assert numbers["mass_balance_error"] < 1e-8
    assert numbers["energy_balance_error"] < 1e-5


def test_bores_of_one_block_move_together() -> None:
    """On a seat as free; seats by the load of each gear would lie 12 um apart along y."""
    seat = steady().data["seat_position"].values
    np.testing.assert_array_equal(seat[0], seat[1])
    assert np.hypot(*seat[0, :2]) == pytest.approx(CLEARANCE)
    gaps = [
        float(steady(*more).data["body_position"].mean("shaft_angle").diff("body").sel(axis="y")[0])
        for more in ((), (FREE,))
    ]
    assert gaps[0] == pytest.approx(gaps[1], abs=0.2e-6)


@pytest.mark.slow
def test_ports_press_the_blocks_to_the_low_pressure_side() -> None:
    """Thick oil at the tips lifts them off; 1000 mm2 at 24 bar, 2.4 kN, hold them down."""
    narrow = "machine.casing.radial_clearance=20 um"
    no_groove = 'machine.casing.inlet_angle="55 deg"'
    short = 'circuit.duration="4 s"', no_groove, narrow
    runs = [
        ts.simulate(ts.load_case(CASES / "startup_cold.toml", (*short, *more)))
        for more in ((), ("machine.bearing_blocks.port_area=1000 mm^2",))
    ]
    lifted, held = (float(run.data["block_position"].sel(axis="x")[-1]) for run in runs)
    assert 0.3 * CLEARANCE < lifted < 0.5 * CLEARANCE
    assert held > 0.85 * CLEARANCE
    assert not any("lean" in told.sentence for run in runs for told in run.warnings)


def test_keys_of_free_blocks_are_refused_on_a_seat() -> None:
    with pytest.raises(CaseError, match="port_area"):
        ts.load_case(CASES / "egm12_motor.toml", ("machine.bearing_blocks.port_area=5 mm^2",))
    with pytest.raises(CaseError, match="radial_clearance"):
        ts.load_case(
            CASES / "egm12_motor.toml", (FREE, "machine.bearing_blocks.radial_clearance=0 um")
        )
