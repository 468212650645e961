"""Polynomial through backward differences: values between steps, change of step, roots."""

from __future__ import annotations

from toothspace.core.compiled import njit
from toothspace.core.types import Array

_kernel = njit(error_model="numpy", _nrt=False)


@_kernel
def copy(source: Array, target: Array) -> None:
    """Copy a vector; slices that might overlap would be copied twice."""
    for i in range(target.size):
        target[i] = source[i]


@_kernel
def interpolate(differences: Array, order: int, position: float, y: Array) -> None:
    r"""Evaluate the interpolating polynomial of the last step.

    Parameters
    ----------
    differences : ndarray, shape (>= order + 1, n)
        Backward differences at the end of the step.
    order : int
        Degree of the polynomial.
    position : float
        Time from the end of the step over the step, -1 to 0 inside the step. [-]
    y : ndarray, shape (n,)
        Receives the state.

    Notes
    -----
    .. math:: y(s) = \sum_{j=0}^{k} \nabla^j y \prod_{m=0}^{j-1} \frac{s + m}{m + 1}
    """
    n = y.size
    for i in range(n):
        y[i] = differences[0, i]
    factor = 1.0
    for j in range(1, order + 1):
        factor *= (position + (j - 1)) / j
        for i in range(n):
            y[i] += factor * differences[j, i]


@_kernel
def change_step(differences: Array, order: int, ratio: float, scratch: Array) -> None:
    """Turn backward differences into those of another step, exactly for the polynomial.

    Parameters
    ----------
    differences : ndarray, shape (>= order + 1, n)
        Backward differences, changed in place.
    order : int
        Degree of the polynomial.
    ratio : float
        New step over old step. [-]
    scratch : ndarray, shape (>= 2 * order + 2, >= order + 1)
        Work space.

    Notes
    -----
    Matrices R and U of Shampine and Reichelt (1997), section 2.2. Their product is
    triangular: a polynomial of degree m has no differences beyond the m-th.
    """
    new, old = scratch[: order + 1], scratch[order + 1 : 2 * order + 2]
    for j in range(order + 1):
        new[0, j] = old[0, j] = 1.0
        for i in range(1, order + 1):
            new[i, j] = new[i - 1, j] * (i - 1 - ratio * j) / i
            old[i, j] = old[i - 1, j] * (i - 1 - j) / i
    n = differences.shape[1]
    for j in range(1, order + 1):
        for m in range(j, order + 1):
            weight = 0.0
            for p in range(1, order + 1):
                weight += new[m, p] * old[p, j]
            if m == j:
                for i in range(n):
                    differences[j, i] *= weight
            else:
                for i in range(n):
                    differences[j, i] += weight * differences[m, i]


@_kernel
def false_position(low: float, g_low: float, high: float, g_high: float) -> float:
    """Return the next trial point of a bracketed root, kept off the ends of the bracket."""
    share = g_low / (g_low - g_high)
    share = min(max(share, 0.02), 0.98)
    return low + share * (high - low)
