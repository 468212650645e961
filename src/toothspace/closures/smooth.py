"""Smooth replacements of kinks, for formulas that a time integrator differentiates."""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.core.compiled import inlined  # sets the cache folder before numba loads

# isort: split
from numba import types
from numba.extending import overload


def select(condition: Any, if_true: Any, if_false: Any) -> Any:
    """Choose by a condition, for scalars in compiled code and for arrays in Python.

    Parameters
    ----------
    condition : bool or ndarray of bool
        What is asked. [-]
    if_true, if_false : float or ndarray
        Values to choose from, of one unit. [-]

    Returns
    -------
    float or ndarray
        ``if_true`` where the condition holds, else ``if_false``. [-]

    Notes
    -----
    ``numpy.where`` of scalars makes an array in compiled code; this one does not.
    """
    return np.where(condition, if_true, if_false)[()]


@overload(select, strict=False)
def _select_compiled(condition: Any, if_true: Any, if_false: Any) -> Any:
    if isinstance(condition, types.Array):
        return lambda condition, if_true, if_false: np.where(condition, if_true, if_false)
    return lambda condition, if_true, if_false: if_true if condition else if_false


@inlined
def positive_part(value: Any, width: Any) -> Any:
    r"""Smooth maximum of a value and zero, always positive, without cancellation.

    Parameters
    ----------
    value : float or ndarray
        Argument x. [-]
    width : float or ndarray
        Value at x = 0, same unit as x. [-]

    Returns
    -------
    float or ndarray
        Smooth maximum, same unit as x. [-]

    Notes
    -----
    .. math:: s = \tfrac12 \left(x + \sqrt{x^2 + 4 w^2}\right), \qquad x = s - w^2 / s .

    Derivative ``s / sqrt(x**2 + 4 w**2)``. A regularisation, not physics.
    """
    root = np.sqrt(value * value + 4.0 * width * width)
    return select(value > 0.0, 0.5 * (value + root), 2.0 * width * width / (root - value))


@inlined
def positive_part_slope(value: Any, width: Any) -> Any:
    """Differentiate :func:`positive_part` with respect to its value.

    Parameters
    ----------
    value : float or ndarray
        Argument x. [-]
    width : float or ndarray
        Width of the rounding, same unit as x. [-]

    Returns
    -------
    float or ndarray
        Derivative, between 0 and 1. [-]
    """
    root = np.sqrt(value * value + 4.0 * width * width)
    return positive_part(value, width) / root


@inlined
def smooth_step(value: Any) -> Any:
    r"""Rise from 0 to 1 over the unit interval with level ends.

    Parameters
    ----------
    value : float or ndarray
        Argument, 0 at the start and 1 at the end of the rise. [-]

    Returns
    -------
    float or ndarray
        :math:`3 x^2 - 2 x^3`, limited to 0..1. [-]
    """
    x = np.minimum(np.maximum(value, 0.0), 1.0)
    return x * x * (3.0 - 2.0 * x)
