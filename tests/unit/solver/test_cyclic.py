"""What two revolutions are compared by, and which chamber stands where another stood."""

from __future__ import annotations

import numpy as np
import pytest

from tests.toy_machine import COUNT, TURN, toy_machine
from toothspace import api
from toothspace.model import arrays as col
from toothspace.model.assembly import System, assemble
from toothspace.solver.cyclic import _change, _difference, _Seen, _turned, successors
from toothspace.solver.initial import start_state


@pytest.fixture(scope="module")
def pump() -> System:
    run = api.prepare(api.load_case("egm12_pump"))
    return assemble(run.machine, run.fluid, run.condition)


def test_after_a_pitch_every_chamber_stands_where_the_next_one_stood() -> None:
    machine, own = toy_machine(), np.arange(COUNT)
    np.testing.assert_array_equal(successors(machine, TURN / COUNT), np.roll(own, -1))
    np.testing.assert_array_equal(successors(machine, -TURN / COUNT), np.roll(own, 1))
    np.testing.assert_array_equal(successors(machine, TURN), own)
    np.testing.assert_array_equal(successors(machine, 0.3 * TURN / COUNT), own)


def test_states_that_are_turned_keep_masses_with_their_places(pump: System) -> None:
    size, state = pump.arrays.size, start_state(pump)
    family = pump.description.families[0]
    turned = _turned(pump, state[None], TURN / family.count)[0]
    assert turned[0] == pytest.approx(state[0] + TURN / family.count)
    masses = []
    for one in (state, turned):
        place = np.mod(family.phases + family.angle_ratio * one[0] + 1e-9, TURN)
        masses.append(one[size.mass : size.mass + family.count][np.argsort(place)])
    np.testing.assert_array_equal(*masses)
    np.testing.assert_array_equal(turned[size.position :], state[size.position :])


def test_changes_count_two_tenthousandths_of_the_pressure_and_two_thousandths_of_a_clearance(
    pump: System,
) -> None:
    arrays = pump.arrays
    highest = max(pump.condition.inlet_pressure, pump.condition.outlet_pressure)
    clearance = arrays.motion[:, col.CLEARANCE]
    pressure = np.linspace(1e5, 9e6, 3 * arrays.size.nodes).reshape(3, -1)
    place = np.zeros((3, clearance.size))
    before = _Seen(pressure, place)
    moved = place.copy()
    moved[1, 2] = -2e-3 * clearance[2]
    after = _Seen(pressure + 2e-4 * highest, moved)
    assert _difference(pump, before, after, TURN) == pytest.approx((1.0, 1.0))
    # root mean square: one node of all
    one = pressure.copy()
    one[0, 0] += 1e5
    expected = 1e5 / np.sqrt(pressure.size) / (2e-4 * highest)
    assert _difference(pump, before, _Seen(one, place), TURN) == pytest.approx((expected, 0.0))
    state = start_state(pump)[None]
    assert _change(pump, state, _turned(pump, state, TURN)) == pytest.approx((0.0, 0.0), abs=1e-6)
