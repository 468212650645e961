"""Least squares over points of a study: residuals in batches, bounds, covariance."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.types import Array

Residuals = Callable[[Array], Array]
"""Residuals (points, rows) at points of the unit cube (points, keys); NaN where one failed."""

DIFFERENCE_STEP = 5e-3
"""Step of difference quotients over the range of a key: above the noise of a cyclic state."""

_TOLERANCE = 1e-3
_FAR = 1e3


@final
@dataclass(frozen=True)
class Fit:
    """Result of a fit."""

    shares: Array
    """Best point in the unit cube. Shape (keys,). [-]"""
    residuals: Array
    """Residuals there. Shape (rows,). [-]"""
    slopes: Array
    """Their slopes there. Shape (rows, keys). [-]"""
    evaluations: int
    """Points that were asked for."""
    converged: bool
    """Whether the last step was small, rather than the budget used up."""

    @property
    def covariance(self) -> Array:
        r"""Covariance of the shares: :math:`s^2 (J^T J)^{-1}`, infinite if not determined. [-]."""
        rows, keys = self.slopes.shape
        if rows <= keys or np.linalg.matrix_rank(self.slopes) < keys:
            return np.diag(np.full(keys, np.inf))
        variance = float(self.residuals @ self.residuals) / (rows - keys)
        return np.asarray(variance * np.linalg.inv(self.slopes.T @ self.slopes))

    def half_widths(self, confidence: float = 0.95) -> Array:
        """Return half the width of the confidence interval of every share. [-]."""
        from scipy.stats import t

        rows, keys = self.slopes.shape
        if rows <= keys:
            return np.full(keys, np.inf)
        factor = float(t.ppf(0.5 + 0.5 * confidence, rows - keys))
        return np.asarray(factor * np.sqrt(np.diag(self.covariance)))


class BudgetUsedUpError(Exception):
    """The largest number of evaluations was reached."""


def fit(residuals: Residuals, start: Array, budget: int) -> Fit:
    """Minimise the sum of squares within the unit cube.

    Best point found, with the slopes for its covariance.

    Parameters
    ----------
    start : ndarray, shape (keys,)
        Where the search starts. [-]
    budget : int
        Most points to evaluate. [-]
    """
    from scipy.optimize import least_squares

    search = _Evaluations(residuals, budget)
    inside = np.clip(start, 1e-3, 1.0 - 1e-3)
    converged = True
    if np.all(search.at(inside) == _FAR):
        rows = search.known(inside)
        return Fit(inside, rows, np.zeros((rows.size, inside.size)), search.used, False)
    try:
        found = least_squares(
            search.at, inside, jac=search.slopes, bounds=(0.0, 1.0), xtol=_TOLERANCE,
            ftol=_TOLERANCE, gtol=1e-10, x_scale=1.0,
        )  # fmt: skip
        converged = found.status > 0
    except BudgetUsedUpError:
        converged = False
    best = search.best
    return Fit(best, search.known(best), search.slopes_known(best), search.used, converged)


class _Evaluations:
    """Evaluates points in batches, counts them and remembers the best."""

    def __init__(self, residuals: Residuals, budget: int) -> None:
        self._residuals, self._budget = residuals, budget
        self._seen: dict[bytes, Array] = {}
        self._slopes: dict[bytes, Array] = {}
        self.used = 0
        self.best: Array = np.zeros(0)
        self._smallest = np.inf

    def at(self, point: Array) -> Array:
        key = point.tobytes()
        if key not in self._seen:
            self._seen[key] = self._batch(point[None])[0]
        found = self._seen[key]
        cost = float(found @ found)
        if self.best.size == 0 or cost < self._smallest:
            self._smallest, self.best = cost, point.copy()
        return found

    def slopes(self, point: Array) -> Array:
        key = point.tobytes()
        if key not in self._slopes:
            here = self.at(point)
            # towards the inside of the cube
            steps = np.where(point + DIFFERENCE_STEP > 1.0, -DIFFERENCE_STEP, DIFFERENCE_STEP)
            beside = self._batch(point[None] + np.diag(steps))
            self._slopes[key] = ((beside - here) / steps[:, None]).T
        return self._slopes[key]

    def known(self, point: Array) -> Array:
        return self._seen[point.tobytes()]

    def slopes_known(self, point: Array) -> Array:
        """Slopes at a point; those of the last point if the budget does not allow its own."""
        try:
            return self.slopes(point)
        except BudgetUsedUpError:
            rows = self.known(point).size
            return next(reversed(self._slopes.values()), np.zeros((rows, point.size)))

    def _batch(self, points: Array) -> Array:
        if self.used and self.used + len(points) > self._budget:
            raise BudgetUsedUpError
        self.used += len(points)
        found = self._residuals(points)
        # a point that failed is far away, so that the search turns back
        return np.where(np.isfinite(found), found, _FAR)
