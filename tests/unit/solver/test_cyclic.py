"""What two revolutions are compared by, and which chamber stands where another stood."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest

from tests.toy_machine import COUNT, TURN, toy_machine, toy_system
from toothspace import api
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.assembly import System, assemble
from toothspace.solver import cyclic
from toothspace.solver.compiled_model import observe
from toothspace.solver.cyclic import (
    DENSE,
    DenseStates,
    History,
    RunPlan,
    _change,
    _difference,
    _PeriodicSearch,
    _Seen,
    _turned,
    first_turn_state,
    march_near,
    march_revolutions,
    march_several,
    successors,
)
from toothspace.solver.initial import start_state
from toothspace.solver.integrator import Piece


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


@pytest.fixture(scope="module")
def cylinders() -> System:
    return toy_system()


@pytest.mark.parametrize("samples", [36, 35])
@pytest.mark.parametrize("by_pitch", [True, False])
def test_a_pitch_of_six_equal_cylinders_makes_the_revolution(
    cylinders: System, samples: int, by_pitch: bool
) -> None:
    """Every chamber where another stood, all sums six times those of a pitch, without a seam."""
    whole = march_revolutions(cylinders, RunPlan(samples_per_revolution=samples))
    plan = RunPlan(samples_per_revolution=samples, by_pitch=by_pitch)
    march = march_revolutions if by_pitch else march_near
    told: list[str] = []
    found = march(cylinders, plan, lambda _, text: told.append(text))
    assert found is not None
    assert found.alike == (COUNT if by_pitch else 1)
    turn = TURN / 150.0
    assert found.times == pytest.approx(turn * np.arange(samples + 1) / samples)
    assert found.states[:, 0] == pytest.approx(150.0 * found.times, abs=1e-9)
    seen, expected = (observe(cylinders.arrays, one.states) for one in (found, whole))
    apart = np.abs(seen.pressure - expected.pressure).max(axis=1)
    assert np.median(apart) < 1e-3 * 50e5
    sums = slice(cylinders.arrays.size.core, None)
    booked, known = (one.states[-1, sums] - one.states[0, sums] for one in (found, whole))
    large = np.abs(known) > 1e-3 * np.abs(known).max()
    assert booked[large] == pytest.approx(known[large], rel=5e-3)
    # masses of the last state are those of the first, turned by a whole revolution
    rest = slice(cylinders.arrays.size.mass, cylinders.arrays.size.core)
    assert found.states[-1, rest] == pytest.approx(found.states[0, rest], rel=1e-9)
    assert found.dense is not None
    assert found.dense.times[-1] == pytest.approx(turn / COUNT if by_pitch else turn)
    assert len(found.dense.times) > DENSE // COUNT
    assert np.all(np.diff(found.dense.times) > 0.0)
    # pitches are counted as parts of revolutions
    assert told == [f"pitch {k}" for k in range(1, len(told) + 1)]
    assert found.statistics["revolutions"] == pytest.approx(len(told) / COUNT)


def test_a_march_tells_how_far_it_is(cylinders: System) -> None:
    told: list[tuple[float, str]] = []
    plan = RunPlan(revolutions=3, samples_per_revolution=36)
    found = march_revolutions(cylinders, plan, lambda share, text: told.append((share, text)))
    assert (found.revolutions, found.statistics["revolutions"]) == (3, 3.0)
    shares, words = zip(*told, strict=True)
    pieces = len(told) // 3
    assert shares == pytest.approx(np.arange(1, 3 * pieces + 1) / (3 * pieces))
    assert [*dict.fromkeys(words)] == ["revolution 1", "revolution 2", "revolution 3"]
    assert words.count("revolution 2") == pieces
    assert found.times[0] == pytest.approx(2.0 * TURN / 150.0)
    assert found.times[-1] == pytest.approx(3.0 * TURN / 150.0)


@pytest.mark.parametrize(("change", "status"), [(0.97, Status.DONE), (1.03, Status.NOT_CYCLIC)])
def test_revolutions_agree_up_to_what_counts_as_no_change(
    change: float, status: Status, cylinders: System, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setattr(cyclic, "_change", lambda *_: (change, 0.0))
    plan = RunPlan(max_revolutions=4, samples_per_revolution=36)
    found = march_revolutions(cylinders.at(relative_tolerance=1e-4), plan)
    assert found.status is status
    assert found.revolutions == (2 if status is Status.DONE else 4)


@pytest.mark.parametrize(("apart", "spanned"), [(0.97, 3), (1.03, 4)])
def test_a_period_is_found_between_revolutions_so_far_apart(
    apart: float, spanned: int, cylinders: System, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Each is compared with those before it, at the turns that lie between."""
    numbers = iter(range(100))
    monkeypatch.setattr(cyclic, "_seen", lambda *_: next(numbers))

    def difference(_: System, before: int, after: int, turn: float) -> tuple[float, float]:
        assert turn == pytest.approx((after - before) * TURN)
        return (apart if after - before == 3 else 0.5 if after - before == 4 else 9.0), 0.0

    monkeypatch.setattr(cyclic, "_difference", difference)
    plan = RunPlan(revolutions=1, samples_per_revolution=36, averaged_revolutions=8)
    quick = cylinders.at(relative_tolerance=1e-4)
    found = march_several(march_revolutions(quick, plan), plan, lambda _: (1.0, 1.0))
    assert (found.status, found.spanned) == (Status.DONE, spanned)


def test_many_revolutions_keep_their_ends_and_fewer_states(cylinders: System) -> None:
    """Thirty-three of two intervals each: every third state, with the last."""
    states = np.zeros((3, 1))
    parts = []
    for k in range(33):
        times = k + np.array([0.0, 0.5, 1.0])
        dense = DenseStates(times, states)
        parts.append(History(Status.DONE, cylinders, times, states, (), 1, {}, dense))
    found = cyclic._joined(parts)
    assert found.times == pytest.approx(1.5 * np.arange(23))
    assert found.spanned == 33


def test_chambers_that_turn_more_slowly_change_places_later() -> None:
    machine = toy_machine()
    (family,) = machine.families
    slow = replace(machine, families=(replace(family, angle_ratio=0.5),))
    own = np.arange(COUNT)
    np.testing.assert_array_equal(successors(slow, 2.0 * TURN / COUNT), np.roll(own, -1))
    np.testing.assert_array_equal(successors(slow, TURN / COUNT), own)


@pytest.mark.parametrize(("turns", "left"), [(3.1, 0.1), (2.47, 0.47), (2.53, -0.47)])
def test_a_state_is_put_back_by_whole_turns(turns: float, left: float, cylinders: System) -> None:
    history = march_revolutions(cylinders, RunPlan(revolutions=1, samples_per_revolution=36))
    states = history.states.copy()
    states[-1, 0] = turns * TURN
    found = first_turn_state(replace(history, states=states))
    assert found[0] == pytest.approx(left * TURN)
    np.testing.assert_array_equal(found[1:], states[-1, 1:])


def revolutions_towards(cylinders: System, start: float) -> tuple[_PeriodicSearch, Piece, Array]:
    """A search that has seen a mass come nearer by a tenth in each of two revolutions.

    Returns the search, the last revolution, and the masses that all leads to.
    """
    size, settled = cylinders.arrays.size, start_state(cylinders)
    states = np.tile(settled, (3, 1))
    states[:, 0] = 0.2 + TURN * np.arange(3.0)
    states[:, size.mass] *= 1.0 + start * 0.9 ** np.arange(3.0)
    pieces = [Piece(Status.DONE, np.arange(2.0), states[k : k + 2], ()) for k in range(2)]
    search = _PeriodicSearch(cylinders, pieces[0])
    for piece in pieces:
        search.learn(piece)
    return search, pieces[-1], settled[size.mass : size.gas]


def test_a_search_goes_where_two_revolutions_lead(cylinders: System) -> None:
    """All the way where it is near, and by half of a mass where it is far."""
    masses = slice(cylinders.arrays.size.mass, cylinders.arrays.size.gas)
    search, last, settled = revolutions_towards(cylinders, 1e-4)
    found = search.start(last)
    assert found[0] == last.states[-1, 0]
    assert found[masses] == pytest.approx(settled, rel=1e-6)
    search, last, settled = revolutions_towards(cylinders, 3.0)
    moved = search.start(last)[masses] / last.states[-1, masses] - 1.0
    assert moved[0] == pytest.approx(-0.5)
    assert moved[1:] == pytest.approx(np.zeros(COUNT - 1), abs=1e-6)
