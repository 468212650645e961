"""States that are looked at: each for itself, a free shaft with the sense in which it turns."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from toothspace import api
from toothspace.case import load_case
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.assembly import System, assemble
from toothspace.model.ledger import FRICTION_MECHANISMS
from toothspace.solver.compiled_model import observe
from toothspace.solver.initial import start_state

FAN_DRIVE = Path(__file__).resolve().parents[3] / "cases" / "startup_fan_drive.toml"
SEAL = 0.15
"""Torque of the seal of the case. [N m]"""
SPEEDS = np.array([40.0, -40.0, 0.0])


@pytest.fixture(scope="module")
def turning() -> tuple[System, Array]:
    """A motor with a free shaft, and states of it that turn forwards, backwards and not at all."""
    run = api.prepare(load_case(FAN_DRIVE))
    system = assemble(run.machine, run.fluid, run.condition)
    states = np.repeat(start_state(system)[None], SPEEDS.size, axis=0)
    states[:, 1] = SPEEDS
    return system, states


def test_friction_of_a_free_shaft_is_against_its_motion(turning: tuple[System, Array]) -> None:
    """The seal takes its torque either way, none at rest, and no mechanism drives the shaft."""
    system, states = turning
    before = float(system.arrays.drive[col.DIRECTION])
    torque = observe(system.arrays, states).torque
    seal = torque[:, FRICTION_MECHANISMS.index("shaft_seal")]
    np.testing.assert_allclose(seal, SEAL * np.sign(SPEEDS), rtol=1e-12)
    resisting = torque[:2] * np.sign(SPEEDS[:2, None])
    assert resisting.min() > -1e-6 * resisting.max()
    assert np.count_nonzero(resisting[0] > 0.0) >= 3
    assert system.arrays.drive[col.DIRECTION] == before


def test_states_do_not_feel_those_that_are_looked_at_with_them(
    turning: tuple[System, Array],
) -> None:
    """Alone, or after the others in the other order: the same numbers."""
    system, states = turning
    together, reverse = observe(system.arrays, states), observe(system.arrays, states[::-1])
    for name, values in together._asdict().items():
        np.testing.assert_array_equal(getattr(reverse, name)[::-1], values, err_msg=name)
        for k in range(SPEEDS.size):
            alone = getattr(observe(system.arrays, states[k : k + 1]), name)[0]
            np.testing.assert_array_equal(alone, values[k], err_msg=name)
