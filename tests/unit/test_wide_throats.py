"""Throats between flanks that open wide: conductance of an opening, and no steps lost to it."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

from toothspace import api
from toothspace.closures.gap_flow import curved_gap_conductance
from toothspace.closures.orifice import orifice_conductance
from toothspace.model.arrays import (
    CONDUCTANCE,
    CURVED_GAP,
    FITTED_GAP,
    MEAN_VISCOSITY,
    RUNNING_HEIGHT,
)
from toothspace.model.assembly import System
from toothspace.solver.accuracy import Assembled
from toothspace.solver.compiled_model import evaluate_state
from toothspace.solver.initial import start_state
from toothspace.solver.integrator import start_march

CASES = Path(__file__).resolve().parents[2] / "cases"
SLOW = [
    "machine.journal_bearings.radial_clearance=42 um",
    "operating_point.shaft_speed=22.8 rpm",
    "operating_point.outlet_pressure=23.7 bar",
    "fluid.temperature=74.5 degC",
]


@cache
def slow_pump() -> System:
    setup = api.set_up(api.load_case(CASES / "crescent_pump.toml", SLOW))
    assembled = Assembled(setup.description, setup.fluid, setup.condition)
    return assembled.at(setup.condition.relative_tolerance)


def test_a_throat_conducts_like_a_narrow_gap_or_an_opening_whichever_is_less() -> None:
    system = slow_pump()
    arrays = system.arrays
    evaluate_state(arrays, start_state(system))
    rows = slice(arrays.open_kinds[CURVED_GAP], arrays.open_kinds[FITTED_GAP])
    path = arrays.path[rows]
    width, radius = arrays.path_values[rows, 1], arrays.path_values[rows, 2]
    open_ = width > 1e-6
    height, viscosity = path[open_, RUNNING_HEIGHT], path[open_, MEAN_VISCOSITY]
    narrow = curved_gap_conductance(height, width[open_], radius[open_], viscosity)
    wide = orifice_conductance(width[open_] * height, 2.0 * height, viscosity, 1.0)
    assert np.any(narrow < wide)
    assert np.any(narrow > 3.0 * wide)
    np.testing.assert_allclose(path[open_, CONDUCTANCE], np.minimum(narrow, wide), rtol=1e-12)


def test_wide_throats_do_not_bound_the_steps_of_a_slow_machine() -> None:
    """Drops of some pascals, far below the tolerance, once cost a step per microsecond."""
    system = slow_pump()
    march = start_march(system, start_state(system))
    turn = 2.0 * np.pi / system.condition.shaft_speed
    march.advance(np.array([turn / 36.0]))
    assert march.statistics["steps"] < 3000
