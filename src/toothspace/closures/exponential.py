"""Exponential and logarithm without calls, which compilers turn into vector instructions."""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.core.compiled import inlined

_MANTISSA = 52
"""Bits of the mantissa."""
_ROOT_OF_HALF = 0x3FE6A09E667F3BCD
"""Bits of the root of 1/2."""
_LOGARITHM_OF_TWO = 0.6931471805599453


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


@inlined
def logarithm(value: Any) -> Any:
    r"""Natural logarithm, without a call into a library.

    Parameters
    ----------
    value : float or ndarray
        Argument x, positive. [-]

    Returns
    -------
    float or ndarray
        Logarithm. [-]

    Notes
    -----
    With :math:`x = 2^k m` and m between the roots of 1/2 and 2, from the bits of x,

    .. math:: \ln x = k \ln 2 + 2 \operatorname{artanh} f, \qquad f = \frac{m - 1}{m + 1}

    by the series of the inverse hyperbolic tangent. Validity: normal positive numbers, to 5e-16 of
    the larger of 1 and the logarithm.

    References
    ----------
    .. [1] M. Abramowitz, I. A. Stegun, *Handbook of Mathematical Functions*, 1964, equation 4.1.27
       (textbook: series of the logarithm).
    """
    bits = np.float64(value).view(np.int64)
    power = (bits - _ROOT_OF_HALF) >> _MANTISSA
    m = np.int64(bits - (power << _MANTISSA)).view(np.float64)
    f = (m - 1.0) / (m + 1.0)
    square = f * f
    rest = square * (1.0 / 19.0) + 1.0 / 17.0
    rest = rest * square + 1.0 / 15.0
    rest = rest * square + 1.0 / 13.0
    rest = rest * square + 1.0 / 11.0
    rest = rest * square + 1.0 / 9.0
    rest = rest * square + 1.0 / 7.0
    rest = rest * square + 1.0 / 5.0
    rest = rest * square + 1.0 / 3.0
    return power * _LOGARITHM_OF_TWO + 2.0 * (f + f * square * rest)
