"""The spline of tooth flanks and the root finder, against independent implementations."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.interpolate import CubicSpline
from scipy.optimize import brentq

from toothspace.gearing.tooth import spline_coefficients
from toothspace.numerics.roots import root_between


@pytest.mark.parametrize("nodes", [2, 3, 4, 5, 80])
def test_spline_is_that_of_scipy(nodes: int) -> None:
    random = np.random.default_rng(nodes)
    knots = np.cumsum(0.1 + random.random(nodes))
    values = random.standard_normal((nodes, 2))
    expected = CubicSpline(knots, values).c[::-1].transpose(1, 2, 0)
    found = spline_coefficients(knots, values)
    assert found == pytest.approx(expected, rel=1e-9, abs=1e-9)


def test_spline_gives_cubics_back() -> None:
    knots = np.array([0.0, 0.3, 1.0, 1.1, 2.0])
    found = spline_coefficients(knots, (2.0 - knots + 4.0 * knots**3)[:, None])
    assert found[0, 0] == pytest.approx([2.0, -1.0, 0.0, 4.0], abs=1e-12)


@pytest.mark.parametrize(
    ("function", "low", "high"),
    [
        (lambda x: x**3 - 2.0, 0.0, 3.0),
        (lambda x: np.tan(x) - x - 1e-3, 1e-9, 1.4),
        (lambda x: np.exp(x) - 1e-8, -100.0, 50.0),
        (lambda x: 1.0 if x > 0.3 else -1.0, 0.0, 1.0),
        (lambda x: x, 0.0, -1.0),
        (lambda x: x - 1.0, 0.0, 1.0),
    ],
)
def test_roots_are_those_of_scipy(function: object, low: float, high: float) -> None:
    calls: list[float] = []

    def counted(place: float) -> float:
        calls.append(place)
        return float(function(place))  # type: ignore[operator]

    found = root_between(counted, low, high, 1e-14)
    assert len(calls) < 120
    assert found == pytest.approx(brentq(function, low, high, xtol=1e-14), abs=2e-14)


def test_root_needs_a_change_of_sign() -> None:
    with pytest.raises(ValueError, match="one sign"):
        root_between(lambda x: x * x + 1.0, -1.0, 2.0)
