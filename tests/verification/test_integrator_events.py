import numpy as np
import pytest

from tests.stiff_problems import BLOW_UP, CELLS, NETWORK, NOT_A_NUMBER, OSCILLATOR, RELAY, Run
from toothspace.numerics.ndf_types import (
    DONE,
    LOG_EVENT,
    MAX_STEPS,
    NOT_FINITE,
    RESTART_AT_EVENT,
    STEP_TOO_SMALL,
    STOP_AT_EVENT,
    TERMINAL_EVENT,
)

pytestmark = pytest.mark.slow  # every right-hand side is compiled


def _oscillator(tolerance=1e-9, actions=(LOG_EVENT, LOG_EVENT), **choices):
    return Run(
        OSCILLATOR, [1.0, 0.0], tolerance, tolerance, event_actions=np.array(actions), **choices
    )


def _network(tolerance):
    return Run(NETWORK, np.r_[np.linspace(1, 3, CELLS), 0.0, 0.0], tolerance, tolerance, 2)


def test_samples_between_steps_are_as_accurate_as_the_steps():
    run = _oscillator(1e-8)
    times = np.linspace(0.0, 10.0, 400)
    run.sample(times)
    assert run.to(10.0) == DONE
    error = np.abs(run.record.samples[:, 0] - np.cos(times)).max()
    end_error = abs(run.y[0] - np.cos(10.0))
    assert run.record.counts[0] == times.size
    assert run.count("steps") < times.size
    assert error < 4.0 * max(end_error, 1e-7)


def test_first_and_last_sample_are_the_start_and_the_end():
    run = _oscillator()
    run.sample(np.array([0.0, 2.0]))
    run.to(2.0)
    np.testing.assert_array_equal(run.record.samples[0], [1.0, 0.0])
    np.testing.assert_array_equal(run.record.samples[1], run.y)


def test_events_are_found_to_1e_10_with_direction_and_order():
    run = _oscillator(1e-13)
    run.to(6.0)
    # cos t = 0 falling at pi/2, rising at 3 pi/2; -sin t + 1/2 falling at pi/6, rising at 5 pi/6
    expected = np.array([1 / 6, 1 / 2, 5 / 6, 3 / 2]) * np.pi
    assert run.record.counts[1] == 4
    np.testing.assert_allclose(run.record.event_times[:4], expected, atol=1e-10)
    assert run.record.event_index[:4].tolist() == [1, 0, 1, 0]
    assert run.record.event_direction[:4].tolist() == [-1, -1, 1, 1]


def test_terminal_event_stops_exactly_and_can_be_passed():
    run = _oscillator(1e-12, actions=(STOP_AT_EVENT, LOG_EVENT))
    run.sample(np.linspace(0.0, 3.0, 31))
    assert run.to(3.0) == TERMINAL_EVENT
    np.testing.assert_allclose(run.y, [0.0, -1.0], atol=1e-10)
    assert run.record.counts.tolist() == [16, 2]
    assert run.to(3.0) == DONE
    np.testing.assert_allclose(run.y[0], np.cos(3.0), atol=1e-9)
    assert run.record.counts.tolist() == [31, 3]


def test_terminal_event_beyond_the_end_waits_for_the_next_call():
    run = _oscillator(1e-6, actions=(STOP_AT_EVENT, LOG_EVENT))
    assert run.to(np.pi / 2 - 1e-3) == DONE
    assert run.to(3.0) == TERMINAL_EVENT
    np.testing.assert_allclose(run.y[0], 0.0, atol=1e-9)


def test_events_beyond_the_capacity_are_counted():
    run = _oscillator(1e-6)
    run.record = run.record._replace(event_times=np.zeros(2))
    run.to(6.0)
    assert run.record.counts[1] == 4


def test_restart_passes_a_jump_of_the_right_hand_side():
    actions = np.array([RESTART_AT_EVENT])
    run = Run(RELAY, [1.0], 1e-8, 1e-8, event_actions=actions, max_step=0.3)
    assert run.to(2.0) == DONE
    np.testing.assert_allclose(run.record.event_times[0], 1.0, atol=1e-14)
    np.testing.assert_allclose(run.y[0], 2.0, atol=1e-13)
    assert run.count("steps") < 64  # without the restart 67


def test_pieces_give_the_bits_of_one_run():
    times = np.linspace(0.0, 20.0, 137)
    whole, pieces = _oscillator(1e-6), _oscillator(1e-6)
    whole.sample(times)
    pieces.sample(times)
    whole.to(20.0)
    for end in (0.01, 0.02, 3.0, 3.1, 7.77, 7.77, 20.0):
        pieces.to(end)
    np.testing.assert_array_equal(whole.y, pieces.y)
    for a, b in zip(whole.state, pieces.state, strict=True):
        np.testing.assert_array_equal(a, b)
    for a, b in zip(whole.record, pieces.record, strict=True):
        np.testing.assert_array_equal(a, b)


@pytest.mark.parametrize("tolerance", [1e-3, 1e-6])
def test_masses_and_their_ledger_sum_to_round_off(tolerance):
    run = _network(tolerance)
    start = np.linspace(1, 3, CELLS).sum()
    for end in np.linspace(1.0, 20.0, 20):
        assert run.to(end) == DONE
        assert abs(run.y.sum() - start) < 1e-13 * (start + abs(run.y).max())


def test_ledger_is_excluded_from_error_control():
    # The outflow integral reaches 16 times the masses, yet leaves the number of steps alone.
    long, short = _network(1e-6), _network(1e-6)
    short.state.differences[0, CELLS:] = 1e9
    long.to(5.0)
    short.to(5.0)
    assert long.count("steps") == short.count("steps")
    np.testing.assert_array_equal(long.y[:CELLS], short.y[:CELLS])


def test_ledger_agrees_with_a_core_state_of_the_same_equation():
    as_ledger = _network(1e-8)
    y0 = np.r_[np.linspace(1, 3, CELLS), 0.0, 0.0]
    as_core = Run(NETWORK, y0, 1e-8, 1e-8)
    as_ledger.to(5.0)
    as_core.to(5.0)
    np.testing.assert_allclose(as_ledger.y, as_core.y, rtol=1e-6)


def test_a_pole_ends_with_step_too_small_near_the_pole():
    run = Run(BLOW_UP, [1.0], 1e-6, 1e-6, min_step=1e-9)
    assert run.to(2.0) in (STEP_TOO_SMALL, NOT_FINITE)
    assert run.count("time") <= 1


def test_undefined_right_hand_side_is_told_apart():
    run = Run(NOT_A_NUMBER, [1.0], 1e-6, 1e-6)
    assert run.to(2.0) == NOT_FINITE
    assert abs(float(run.state.control["time"][0]) - 1.0) < 1e-6
    np.testing.assert_allclose(run.y[0], 0.0, atol=1e-6)


def test_step_count_is_limited():
    run = _oscillator(1e-10, max_steps=20)
    assert run.to(100.0) == MAX_STEPS
    assert run.count("steps") + run.count("rejected") == 20


def test_steps_respect_their_limit():
    run = _oscillator(1e-4, max_step=0.01)
    run.to(1.0)
    assert run.count("steps") >= 100
