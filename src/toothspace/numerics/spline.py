"""Cubic spline through points of an open curve."""

from __future__ import annotations

import numpy as np

from toothspace.core.types import Array


def spline_coefficients(knots: Array, values: Array) -> Array:
    """Cubic spline with two continuous derivatives, its third also at the second knots.

    Parameters
    ----------
    knots : ndarray, shape (n,)
        Increasing, n >= 2; three give a parabola, two a line. [unit of the abscissa]
    values : ndarray, shape (n, channels)
        Values at the knots.

    Returns
    -------
    ndarray, shape (n - 1, channels, 4)
        Coefficients of the powers 0 to 3 of the distance to the left knot of each interval.

    Notes
    -----
    Equation: continuity of the second derivative gives a tridiagonal system for the slopes; the
    rows of both ends ask for one polynomial on the first two intervals and on the last two.

    References
    ----------
    de Boor, A Practical Guide to Splines, Springer, New York 1978, chapter 4.
    """
    step = np.diff(knots)
    rise = np.diff(values, axis=0) / step[:, None]
    slope = _slopes(step, rise)
    bend = (3.0 * rise - 2.0 * slope[:-1] - slope[1:]) / step[:, None]
    twist = (slope[:-1] + slope[1:] - 2.0 * rise) / step[:, None] ** 2
    return np.stack([values[:-1], slope[:-1], bend, twist], axis=-1)


def _slopes(step: Array, rise: Array) -> Array:
    if len(step) == 1:
        return rise[[0, 0]]
    both = (step[:-1] + step[1:])[:, None]
    middle = (step[1:, None] * rise[:-1] + step[:-1, None] * rise[1:]) / both
    if len(step) == 2:
        return np.vstack([2.0 * rise[:1] - middle, middle, 2.0 * rise[1:] - middle])
    nodes = len(step) + 1
    matrix, right = np.zeros((nodes, nodes)), np.empty((nodes, rise.shape[1]))
    inner = np.arange(1, nodes - 1)
    matrix[inner, inner - 1], matrix[inner, inner + 1] = step[1:], step[:-1]
    matrix[inner, inner] = 2.0 * both[:, 0]
    right[1:-1] = 3.0 * both * middle
    for end, second, near, far in ((0, 1, 0, 1), (-1, -2, -1, -2)):
        a, b = step[near], step[far]
        matrix[end, [end, second]] = b, a + b
        right[end] = ((3.0 * a + 2.0 * b) * b * rise[near] + a**2 * rise[far]) / (a + b)
    return np.asarray(np.linalg.solve(matrix, right))
