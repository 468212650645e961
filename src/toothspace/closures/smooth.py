"""Smooth replacements of kinks, for formulas that a time integrator differentiates."""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.core.compiled import inlined, stand_in


def select(condition: Any, if_true: Any, if_false: Any) -> Any:
    r"""Choose by a condition, for scalars in compiled code and for arrays in Python.

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
    .. math:: y = a \ \text{where the condition holds}, \qquad y = b \ \text{elsewhere}

    ``numpy.where`` of scalars makes an array in compiled code; this one does not. Validity: both
    values are evaluated and must exist on either side.

    References
    ----------
    .. [1] NumPy reference, *numpy.where*.
    """
    return np.where(condition, if_true, if_false)[()]


@stand_in(select)
def _select_compiled(condition: Any, if_true: Any, if_false: Any) -> Any:
    if hasattr(condition, "ndim"):
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

    Validity: a regularisation, not physics; it exceeds the maximum by at most w.

    References
    ----------
    .. [1] C. Kanzow, "Some noninterior continuation methods for linear complementarity
       problems", SIAM J. Matrix Anal. Appl. 17, 1996, 851-868 (smooth maximum).
    """
    root = np.sqrt(value * value + 4.0 * width * width)
    return select(value > 0.0, 0.5 * (value + root), 2.0 * width * width / (root - value))


@inlined
def positive_part_slope(value: Any, width: Any) -> Any:
    r"""Differentiate :func:`positive_part` with respect to its value.

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

    Notes
    -----
    .. math:: \frac{\mathrm ds}{\mathrm dx} = \frac{s}{\sqrt{x^2 + 4 w^2}}

    Validity: as :func:`positive_part`.

    References
    ----------
    .. [1] C. Kanzow, "Some noninterior continuation methods for linear complementarity
       problems", SIAM J. Matrix Anal. Appl. 17, 1996, 851-868 (smooth maximum).
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
        Rise, limited to 0..1. [-]

    Notes
    -----
    .. math:: y = 3 x^2 - 2 x^3

    Validity: a blend, not physics; its slope is continuous.

    References
    ----------
    .. [1] C. de Boor, *A Practical Guide to Splines*, Springer, 1978 (textbook: cubic Hermite
       interpolation).
    """
    x = np.minimum(np.maximum(value, 0.0), 1.0)
    return x * x * (3.0 - 2.0 * x)
