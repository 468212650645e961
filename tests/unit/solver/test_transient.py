"""Marches over time: samples, whole cells, kinks of a speed, loads on a shaft."""

from __future__ import annotations

from dataclasses import replace
from types import SimpleNamespace
from typing import Any, cast

import numpy as np
import pytest

from tests.toy_machine import toy_machine, toy_system
from toothspace.circuit.shaft_loads import FreeShaft
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.assembly import System
from toothspace.numerics.ndf_types import STEP_TOO_SMALL
from toothspace.solver import integrator, transient
from toothspace.solver.initial import start_state
from toothspace.solver.integrator import March, start_march
from toothspace.solver.transient import (
    STUCK,
    TimePlan,
    TransientMarch,
    settle,
)

SLOW = {"shaft_speed": 100.0, "relative_tolerance": 1e-4}


def cylinders(*knots: tuple[float, float], **changes: Any) -> System:
    """Six cylinders whose shaft follows a speed: time and speed of its knots."""
    if knots:
        changes |= {"speed_schedule": np.array(knots), "shaft_speed": knots[0][1]}
    return toy_system(**(SLOW | changes))


def angle_at(knots: tuple[tuple[float, float], ...], times: Array) -> Array:
    """Integral of a speed that goes along straight lines. [rad]."""
    fine = np.unique(np.concatenate([np.linspace(0.0, float(times[-1]), 20001), times]))
    speed = np.interp(fine, *np.array(knots).T)
    whole = np.concatenate([[0.0], np.cumsum(0.5 * (speed[1:] + speed[:-1]) * np.diff(fine))])
    return np.interp(times, fine, whole)


def test_samples_fill_all_cells_piece_by_piece(monkeypatch: pytest.MonkeyPatch) -> None:
    """Seven cells of three samples in 21 ms, two cells at a time."""
    monkeypatch.setattr(transient, "_CELLS_PER_CHUNK", 2)
    march = TransientMarch(
        cylinders((0.0, 100.0), (1.0, 100.0)), TimePlan(21e-3, cells=7, samples_per_cell=3)
    )
    told: list[tuple[float, str]] = []
    asked: list[int] = []
    advance = TransientMarch._advance

    def noted(own: TransientMarch, by: March, times: Array) -> Array:
        asked.append(times.size)
        return advance(own, by, times)

    monkeypatch.setattr(TransientMarch, "_advance", noted)
    pieces = list(march.chunks(lambda share, text: told.append((share, text))))
    assert asked == [times.size for times, _ in pieces] == [6, 6, 6, 3]
    times = np.concatenate([times for times, _ in pieces])
    states = np.vstack([states for _, states in pieces])
    assert times == pytest.approx(1e-3 * np.arange(1, 22))
    assert states[:, 0] == pytest.approx(100.0 * times)
    assert [share for share, _ in told] == pytest.approx([6 / 21, 12 / 21, 18 / 21, 1.0])
    assert told[-1][1] == "0.02 s"
    assert march.time == pytest.approx(21e-3)
    assert march.last == pytest.approx(states[-1])


def test_cells_that_are_not_whole_are_left_out(monkeypatch: pytest.MonkeyPatch) -> None:
    """A march that fails after seven of twelve samples has two cells of three."""
    plan = TimePlan(12e-3, cells=4, samples_per_cell=3)
    march = TransientMarch(cylinders((0.0, 100.0), (1.0, 100.0)), plan)

    def fails(own: TransientMarch, _: Any, times: Array) -> Array:
        own.status = Status.STEP_TOO_SMALL
        return np.arange(7.0)[:, None] * np.ones((7, own.system.arrays.size.total))

    monkeypatch.setattr(TransientMarch, "_advance", fails)
    ((times, states),) = march.chunks()
    assert times == pytest.approx(1e-3 * np.arange(1, 7))
    assert states[:, 0].tolist() == [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]
    assert march.last[0] == 5.0
    assert march.time == pytest.approx(6e-3)


@pytest.mark.parametrize(
    "kinks", [(0.4e-3,), (5e-3,), (6.0e-3,), (11.3e-3,), (8.3e-3, 9.6e-3, 11e-3)]
)
def test_a_march_begins_anew_at_every_kink_of_the_speed(
    kinks: tuple[float, ...], monkeypatch: pytest.MonkeyPatch
) -> None:
    """Before the first sample, at one, at the end of a piece, between; turned as the lines say."""
    monkeypatch.setattr(transient, "_CELLS_PER_CHUNK", 2)
    between = [(kink, 60.0 + 50.0 * (k % 2)) for k, kink in enumerate(kinks)]
    knots = ((0.0, 100.0), *between, (20e-3, 200.0))
    restarts: list[float] = []
    begin_anew = March.restart

    def noted(own: March, time: float, state: Array) -> None:
        restarts.append(time)
        begin_anew(own, time, state)

    monkeypatch.setattr(March, "restart", noted)
    march = TransientMarch(cylinders(*knots), TimePlan(18e-3, cells=6, samples_per_cell=3))
    pieces = list(march.chunks())
    times = np.concatenate([times for times, _ in pieces])
    states = np.vstack([states for _, states in pieces])
    assert restarts == pytest.approx(kinks)
    assert times == pytest.approx(1e-3 * np.arange(1, 19))
    assert states[:, 0] == pytest.approx(angle_at(knots, times), rel=1e-3)
    assert states[:, 1] == pytest.approx(np.interp(times, *np.array(knots).T), rel=1e-3)


def test_a_shaft_at_rest_turns_the_way_of_its_next_speed() -> None:
    system = cylinders((0.0, 0.0), (1.0, 0.0), (2.0, -50.0), (3.0, 50.0))
    state, drive = start_state(system), system.arrays.drive
    for speed, time, direction in ((0.0, 1.5, -1.0), (0.0, 2.5, 1.0), (-7.0, 2.5, -1.0)):
        state[1] = speed
        settle(system, state, time)
        assert drive[col.DIRECTION] == direction
    state[1] = 0.0
    settle(system, state, 4.0)
    assert drive[col.DIRECTION] == 0.0


def test_friction_holds_a_shaft_at_rest_where_it_has_a_breakaway_torque(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """3 N m drive it, 5 N m hold it: without a breakaway torque nothing does."""
    system = cylinders(shaft_speed=0.0, free_shaft=FreeShaft(inertia=1e-3))
    drive, state = system.arrays.drive, start_state(system)
    monkeypatch.setattr(transient, "hold_shaft", lambda *_: None)
    drive[col.DRIVING_TORQUE], drive[col.HOLDING_TORQUE] = 3.0, 5.0
    for breakaway, direction in ((1.0, STUCK), (0.0, 1.0)):
        drive[col.BREAKAWAY] = breakaway
        settle(system, state, 0.0)
        assert drive[col.DIRECTION] == direction


@pytest.mark.parametrize("mode", ["pump", "motor"])
def test_the_pressure_difference_is_that_which_a_machine_works_with(mode: str) -> None:
    ports = {"inlet_pressure": 1e5, "outlet_pressure": 50e5}
    if mode == "motor":
        ports = {"inlet_pressure": 50e5, "outlet_pressure": 1e5}
    knots = np.array([[0.0, 100.0], [1.0, 100.0]])
    machine = replace(toy_machine(), mode=mode)
    system = toy_system(machine, **SLOW, speed_schedule=knots, **ports)
    march = TransientMarch(system, TimePlan(1.0))
    states = np.tile(start_state(system), (3, 1))
    found = transient._values(march, 1e-3 * np.arange(3.0), states)
    assert found["pressure_difference"] == pytest.approx(np.full(3, 49e5))


def test_a_load_is_the_sum_of_its_parts() -> None:
    """1 + 0.2 w + 0.03 w |w| + 0.004 w^3 at 10 and -10 rad/s, one at 0.25 s growing to two."""
    shaft = FreeShaft(inertia=1e-3, linear=0.2, square=0.03, cubic=0.004)
    system = SimpleNamespace(condition=SimpleNamespace(free_shaft=shaft))
    history = np.array([[0.0, 0.5], [0.5, 1.5]])
    found = transient._load(
        cast(System, system), np.array([0.25, 0.25]), np.array([10.0, -10.0]), history
    )
    assert found == pytest.approx([1.0 + 2.0 + 3.0 + 4.0, 1.0 - 2.0 - 3.0 - 4.0])
    still = SimpleNamespace(condition=SimpleNamespace(free_shaft=None))
    assert transient._load(cast(System, still), np.zeros(2), np.ones(2), history).tolist() == [0, 0]


def test_a_cell_at_the_start_is_next_to_no_time() -> None:
    march = TransientMarch(cylinders((0.0, 100.0), (1.0, 100.0)), TimePlan(1.0, samples_per_cell=5))
    march.first = start_state(march.system)
    times, states = transient._start(march)
    assert times.size == len(states) == 5
    assert times[0] == 0.0
    assert np.all(np.diff(times) > 0.0)
    assert times[-1] < 1e-9
    assert np.all(states == march.first)


def test_events_have_the_time_and_the_angle_at_which_they_were(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """The chamber and the direction that the compiled march has noted."""

    def noted(_: Any, integration: Any, end: float) -> int:
        record = integration.record
        record.counts[:2] = 1
        record.event_times[0], record.event_index[0], record.event_direction[0] = 0.02, 4, -1
        return integrator.DONE

    system = cylinders()
    march = start_march(system, start_state(system))
    monkeypatch.setattr(integrator, "advance", noted)
    (event,) = march.advance(np.array([0.03])).events
    assert (event.time, event.shaft_angle) == pytest.approx((0.02, 2.0))
    assert (event.kind, event.label) == ("cavitation_onset", "cylinder_4")


@pytest.mark.parametrize(
    ("pressure", "status"),
    [(0.9e9, Status.STEP_TOO_SMALL), (1.1e9, Status.FLUID_ENCLOSED)],
)
def test_a_march_that_ends_beyond_all_liquids_enclosed_its_fluid(
    pressure: float, status: Status, monkeypatch: pytest.MonkeyPatch
) -> None:
    system = cylinders()
    march = start_march(system, start_state(system))
    monkeypatch.setattr(integrator, "advance", lambda *_: STEP_TOO_SMALL)
    monkeypatch.setattr(March, "_highest_pressure", lambda _: pressure)
    assert march.advance(np.array([0.03])).status is status
