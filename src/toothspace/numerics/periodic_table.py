"""Tables over an angle: uniform nodes, several channels, cubic Hermite in between."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.types import Array


@final
@dataclass(frozen=True)
class PeriodicTable:
    """Periodic functions of an angle on uniform nodes, continuous with first derivative.

    Notes
    -----
    Between nodes the table is the cubic Hermite polynomial of values and slopes; with
    exact slopes its error is of fourth order in the node distance.
    """

    period: float
    """Period of the angle. [rad]"""
    values: Array
    """Values at the angles ``period * k / nodes``. Shape (nodes, channels). [unit of each channel]
    """
    slopes: Array
    """Derivatives with respect to the angle at the nodes. Shape (nodes, channels). [unit of each
    channel / rad]
    """

    def __post_init__(self) -> None:
        if self.values.ndim != 2 or self.values.shape != self.slopes.shape:
            raise ValueError("values and slopes need one shape (nodes, channels)")

    def __call__(self, angle: Array | float) -> Array:
        """Return values at angles; shape ``angle.shape + (channels,)``. [unit of each channel]."""
        return self._evaluate(np.asarray(angle, dtype=float), derivative=False)

    def derivative(self, angle: Array | float) -> Array:
        """Return derivatives at angles; shape ``angle.shape + (channels,)``. [unit / rad]."""
        return self._evaluate(np.asarray(angle, dtype=float), derivative=True)

    def moving_mean(self, width: float) -> PeriodicTable:
        r"""Mean over a window of angles about every node, exact for the cubics of the table.

        Parameters
        ----------
        width : float
            Width of the window, not zero; its sign counts for nothing. [rad]

        Notes
        -----
        .. math:: \bar f(\theta) = \frac1w \int_{\theta - w/2}^{\theta + w/2} f\,d\vartheta ,
            \qquad \bar f' = \frac{f(\theta + w/2) - f(\theta - w/2)}{w}
        """
        half = 0.5 * abs(width)
        mirrored = PeriodicTable(self.period, self.values[::-1], -self.slopes[::-1])
        ahead, rise = self._ahead(half)
        behind, fall = (part[::-1] for part in mirrored._ahead(half))
        return PeriodicTable(self.period, (ahead + behind) / abs(width), (rise - fall) / abs(width))

    def _ahead(self, angle: float) -> tuple[Array, Array]:
        """Integral over an angle ahead of every node, and the rise over it.

        From the node on, not from angle zero: narrow windows keep their digits.
        """
        nodes = self.values.shape[0]
        step = self.period / nodes
        v0, v1 = self.values, np.roll(self.values, -1, axis=0)
        s0, s1 = step * self.slopes, step * np.roll(self.slopes, -1, axis=0)
        parts = step * (0.5 * (v0 + v1) + (s0 - s1) / 12.0)
        sums = np.vstack([np.zeros((1, v0.shape[1])), np.cumsum(parts, axis=0)])
        whole = int(angle / step)
        t = angle / step - whole
        turns, index = np.divmod(np.arange(nodes) + whole, nodes)
        c0, c1, c2, c3 = (c[index] for c in cubic_coefficients(v0, v1, s0, s1))
        within = step * t * (c0 + t * (c1 / 2.0 + t * (c2 / 3.0 + t * c3 / 4.0)))
        passed = turns[:, None] * sums[-1] + sums[index] - sums[:-1]
        return passed + within, v0[index] - v0 + t * (c1 + t * (c2 + t * c3))

    def _evaluate(self, angle: Array, *, derivative: bool) -> Array:
        nodes = self.values.shape[0]
        step = self.period / nodes
        position = np.mod(angle, self.period) / step
        index = np.minimum(position.astype(np.int64), nodes - 1)
        t = (position - index)[..., None]
        following = (index + 1) % nodes
        v0, v1 = self.values[index], self.values[following]
        s0, s1 = step * self.slopes[index], step * self.slopes[following]
        _, _, c2, c3 = cubic_coefficients(v0, v1, s0, s1)
        if derivative:
            return (s0 + t * (2.0 * c2 + 3.0 * t * c3)) / step
        return v0 + t * (s0 + t * (c2 + t * c3))


def cubic_coefficients(v0: Array, v1: Array, s0: Array, s1: Array) -> tuple[Array, ...]:
    """Coefficients of the powers 0 to 3 of cubics from values and slopes at 0 and 1."""
    return v0, s0, 3.0 * (v1 - v0) - 2.0 * s0 - s1, s0 + s1 - 2.0 * (v1 - v0)


def table_from_exact_slopes(period: float, values: Array, slopes: Array) -> PeriodicTable:
    """Build a table from values and their exact derivatives (one- or two-dimensional arrays)."""
    return PeriodicTable(period, _columns(values), _columns(slopes))


def monotone_table(period: float, values: Array) -> PeriodicTable:
    """Build a table that never overshoots its data (Fritsch and Carlson's harmonic mean slopes).

    For opening areas: an overshooting spline makes leaks that do not exist.
    """
    v = _columns(values)
    step = period / v.shape[0]
    right = (np.roll(v, -1, axis=0) - v) / step
    left = np.roll(right, 1, axis=0)
    product = left * right
    total = np.where(product > 0.0, left + right, 1.0)
    return PeriodicTable(period, v, np.where(product > 0.0, 2.0 * product / total, 0.0))


def smooth_table(period: float, values: Array) -> PeriodicTable:
    r"""Build a table of smooth data with a continuous second derivative.

    Cubic B-spline with the coefficients :math:`v_i - \delta^2 v_i / 6`.

    Parameters
    ----------
    period : float
        Period of the angle. [rad]
    values : ndarray, shape (nodes,) or (nodes, channels)
        Values at uniform angles, the first at zero. [unit of each channel]

    Notes
    -----
    Cubics are reproduced; elsewhere the error is of fourth order in the node distance. A kink of
    the data is rounded over the intervals beside it. The table is linear in its data: sums and
    integrals of tables are those of the data.

    References
    ----------
    .. [1] C. de Boor, *A Practical Guide to Splines*, Springer, chapter 12 (quasi-interpolants).
    """
    v = _columns(values)
    before, behind = np.roll(v, 1, axis=0), np.roll(v, -1, axis=0)
    c = v - (before - 2.0 * v + behind) / 6.0
    before, behind = np.roll(c, 1, axis=0), np.roll(c, -1, axis=0)
    slopes = (behind - before) * (v.shape[0] / (2.0 * period))
    return PeriodicTable(period, (before + 4.0 * c + behind) / 6.0, slopes)


def sum_of_tables(first: PeriodicTable, second: PeriodicTable) -> PeriodicTable:
    """Add two tables with one period and node count, channel by channel."""
    values, slopes = first.values + second.values, first.slopes + second.slopes
    return PeriodicTable(first.period, values, slopes)


def stack_tables(*tables: PeriodicTable) -> PeriodicTable:
    """Join the channels of tables with one period and node count."""
    first = tables[0]
    for table in tables[1:]:
        if table.period != first.period or table.values.shape[0] != first.values.shape[0]:
            raise ValueError("tables differ in period or node count")
    return PeriodicTable(
        first.period,
        np.hstack([table.values for table in tables]),
        np.hstack([table.slopes for table in tables]),
    )


def _columns(data: Array) -> Array:
    array = np.asarray(data, dtype=float)
    return array[:, None] if array.ndim == 1 else array
