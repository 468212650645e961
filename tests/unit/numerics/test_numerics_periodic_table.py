"""Tables over an angle: order, smoothness and what they keep of their data."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.numerics.periodic_table import smooth_table

PERIOD = 3.0


def _wave(angle: np.ndarray) -> np.ndarray:
    return np.asarray(np.sin(2.0 * np.pi * angle / PERIOD))


def _angles(count: int) -> np.ndarray:
    return PERIOD * np.arange(count) / count


def test_smooth_table_is_of_fourth_order() -> None:
    fine = _angles(5000)
    errors = [
        np.abs(smooth_table(PERIOD, _wave(_angles(n)))(fine)[:, 0] - _wave(fine)).max()
        for n in (40, 80)
    ]
    # leading term of the error: twice the distance, sixteen times the error
    assert errors[0] / errors[1] == pytest.approx(16.0, rel=0.03)


def test_smooth_table_has_a_continuous_second_derivative() -> None:
    # jumps of third differences show a jump of the second derivative, even beside a kink
    table = smooth_table(PERIOD, np.abs(_wave(_angles(30))))
    step = 1e-4
    before, behind = (
        (table.derivative(_angles(30) + at) - table.derivative(_angles(30) + at - step)) / step
        for at in (0.0, step)
    )
    assert np.abs(behind - before).max() < 1e-2 * np.abs(behind).max()


def test_smooth_table_keeps_sums_and_means() -> None:
    kinked = np.abs(_wave(_angles(30)))
    whole = smooth_table(PERIOD, np.ones(30) - kinked).values + smooth_table(PERIOD, kinked).values
    assert np.abs(whole - 1.0).max() < 1e-14
    assert smooth_table(PERIOD, kinked).values.mean() == pytest.approx(kinked.mean(), rel=1e-14)
