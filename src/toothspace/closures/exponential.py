"""Exponential function of small arguments, which compilers turn into vector instructions."""

from __future__ import annotations

from typing import Any

from toothspace.core.compiled import inlined


@inlined
def exponential_rise(exponent: Any) -> Any:
    r"""Exponential function less one, without a call into a library.

    Parameters
    ----------
    exponent : float or ndarray
        Argument x. [-]

    Returns
    -------
    float or ndarray
        Exponential less one. [-]

    Notes
    -----
    Taylor's series of a sixteenth of the argument, doubled four times:

    .. math:: e^{2y} - 1 = (e^y - 1)\,[2 + (e^y - 1)]

    Validity: to 2e-14 of :math:`e^x` for :math:`|x| \le 4`, 3e-10 for 10.

    References
    ----------
    .. [1] M. Abramowitz, I. A. Stegun, *Handbook of Mathematical Functions*, 1964, equation 4.2.1
       (textbook: series of the exponential function).
    """
    y = 0.0625 * exponent
    rest = y * (1.0 / 39916800.0) + 1.0 / 3628800.0
    rest = rest * y + 1.0 / 362880.0
    rest = rest * y + 1.0 / 40320.0
    rest = rest * y + 1.0 / 5040.0
    rest = rest * y + 1.0 / 720.0
    rest = rest * y + 1.0 / 120.0
    rest = rest * y + 1.0 / 24.0
    rest = rest * y + 1.0 / 6.0
    rest = rest * y + 0.5
    rise = y + y * y * rest
    rise = rise * (2.0 + rise)
    rise = rise * (2.0 + rise)
    rise = rise * (2.0 + rise)
    return rise * (2.0 + rise)
