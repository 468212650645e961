"""Smooth maximum, its slope and the smooth step: identities, limits and hand values."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.closures.smooth import positive_part, positive_part_slope, select, smooth_step

VALUES = np.array([-1e6, -30.0, -2.0, -1e-3, 0.0, 1e-3, 0.7, 5.0, 1e6])


@pytest.mark.parametrize("width", [0.3, 2.0])
def test_smooth_maximum_is_the_root_of_its_equation(width: float) -> None:
    """s (s - x) = w^2: w at zero, w^2/|x| far below, above x and zero by at most w."""
    found = positive_part(VALUES, width)
    assert found * (found - VALUES) == pytest.approx(width**2, rel=1e-9, abs=1e-3 * width**2)
    assert found[4] == width
    assert found[0] == pytest.approx(width**2 / 1e6, rel=1e-9)
    assert np.all(found > np.maximum(VALUES, 0.0))
    assert np.all(found <= np.maximum(VALUES, 0.0) + width)
    assert float(positive_part(3.0, width)) == pytest.approx(positive_part(-3.0, width) + 3.0)


@pytest.mark.parametrize("width", [0.3, 2.0])
def test_slope_of_the_smooth_maximum(width: float) -> None:
    step = 1e-5
    inner = VALUES[1:-1]
    ends = positive_part(inner + step, width) - positive_part(inner - step, width)
    assert positive_part_slope(inner, width) == pytest.approx(ends / (2.0 * step), rel=1e-6)
    assert positive_part_slope(0.0, width) == 0.5


def test_smooth_step_by_hand() -> None:
    assert smooth_step(np.array([-3.0, 0.0, 0.25, 0.5, 0.75, 1.0, 4.0])) == pytest.approx(
        [0.0, 0.0, 0.15625, 0.5, 0.84375, 1.0, 1.0]
    )


def test_select_takes_scalars_and_arrays() -> None:
    assert select(True, 1.0, 2.0) == 1.0
    assert select(np.array([True, False]), 1.0, np.array([3.0, 4.0])).tolist() == [1.0, 4.0]
