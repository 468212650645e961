"""Acceleration of fixed-point iterations."""

from __future__ import annotations

import numpy as np

from toothspace.numerics.acceleration import Mixing


def test_linear_iteration_ends_after_as_many_steps_as_unknowns() -> None:
    """As the method of minimal residuals does (Walker and Ni 2011, theorem 2.2)."""
    rng = np.random.default_rng(1)
    matrix, given = 3.0 * rng.standard_normal((4, 4)), rng.standard_normal(4)
    wanted = np.linalg.solve(np.eye(4) - matrix, given)
    mixing, value = Mixing(8), np.zeros(4)
    for _ in range(6):
        value = mixing.following(value, matrix @ value + given - value)
    np.testing.assert_allclose(value, wanted, rtol=1e-6)


def test_slow_iteration_settles_soon() -> None:
    """Contraction 0.9 leaves a twentieth after 30 plain iterations."""
    shares, given = np.linspace(0.0, 0.9, 50), np.ones(50)
    mixing, value = Mixing(8), np.zeros(50)
    for _ in range(20):
        value = mixing.following(value, shares * value + given - value)
    np.testing.assert_allclose(value, given / (1.0 - shares), rtol=1e-4)
