r"""Friction of flow in a round line that changes with time.

.. math::

    \frac{\Delta p}{L} = \frac{8\nu}{r^2}\,\phi\,q
        + \frac{4\nu}{r^2}\int_0^t W\!\left(\frac{\nu (t-\tau)}{r^2}\right)\dot q\, d\tau,
    \qquad W(\hat t) = \sum_{i=1}^\infty e^{-\alpha_i^2 \hat t}

with the zeros :math:`\alpha_i` of the Bessel function J2 (Zielke, 1968). A few exponentials with
positive weights stand for the sum, so that the friction of the column never gives energy.
Laminar memory is kept in turbulent flow, where it is the upper limit.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from toothspace.core.compiled import inlined
from toothspace.core.types import Array, ComplexArray

CRITICAL_REYNOLDS = 2300.0
_LAMINAR_END = 2000.0 / CRITICAL_REYNOLDS
_TURBULENT_BEGIN = 4000.0 / CRITICAL_REYNOLDS
_BLASIUS = 0.3164 / 64.0 * CRITICAL_REYNOLDS**0.75
_FIRST_RATE = 26.374616427163393
_SPACING = 6.0
_POINTS = 200


@inlined
def turbulent_growth(ratio: float) -> tuple[float, float]:
    r"""Friction over that of laminar flow, and its slope over the ratio of flows.

    Parameters
    ----------
    ratio : float
        Flow over that at a Reynolds number of 2300, not negative. [-]

    Returns
    -------
    tuple of float
        Growth of the friction and its slope. [-]

    Notes
    -----
    .. math:: \phi = 1 \ (Re < 2000), \qquad
        \phi = \frac{0.3164\, Re^{3/4}}{64} \ (Re > 4000)

    laminar flow and the law of Blasius, blended between. Validity: smooth round lines up to a
    Reynolds number of 1e5.

    References
    ----------
    .. [1] F. M. White, *Fluid Mechanics*, McGraw-Hill, chapter 6 (textbook law: Blasius, 1913).
    """
    if ratio <= _LAMINAR_END:
        return 1.0, 0.0
    turbulent = _BLASIUS * ratio**0.75
    slope = 0.75 * turbulent / ratio
    if ratio >= _TURBULENT_BEGIN:
        return turbulent, slope
    width = _TURBULENT_BEGIN - _LAMINAR_END
    x = (ratio - _LAMINAR_END) / width
    share = x * x * (3.0 - 2.0 * x)
    by_ratio = 6.0 * x * (1.0 - x) / width
    return 1.0 + share * (turbulent - 1.0), share * slope + by_ratio * (turbulent - 1.0)


def memory_transform(rate: npt.ArrayLike) -> ComplexArray:
    r"""Laplace transform of the weighting function W of unsteady laminar friction.

    Parameters
    ----------
    rate : array_like of complex
        Laplace variable s r^2/nu, its real part not negative. [-]

    Returns
    -------
    ndarray of complex
        Transform of W over nu t/r^2. [-]

    Notes
    -----
    .. math:: \hat W = \tfrac14 \left[\frac{I_0(z)}{I_2(z)} - 1 - \frac{8}{z^2}\right], \qquad
        z^2 = s r^2/\nu

    with modified Bessel functions, from the series impedance :math:`s I_0/I_2` of the line.
    Validity: laminar flow, radius small against the wave length.

    References
    ----------
    .. [1] W. Zielke, "Frequency-dependent friction in transient pipe flow", J. Basic Eng. 90,
       1968, 109-115.
    """
    from scipy.special import ive

    square = np.asarray(rate, dtype=complex)
    root = np.sqrt(square)
    exact: ComplexArray = 0.25 * (ive(0, root) / ive(2, root) - 1.0 - 8.0 / square)
    return exact


def memory_branches(highest_rate: float) -> Array:
    r"""Decay rates and weights of few exponentials for W up to an angular frequency.

    Parameters
    ----------
    highest_rate : float
        Highest angular frequency w r^2/nu that the line resolves. [-]

    Returns
    -------
    branches : ndarray
        Rates n and weights m, not negative, one row each. [-]

    Notes
    -----
    .. math:: W(\hat t) \approx \sum_i m_i e^{-n_i \hat t}

    Rates grow by a factor from the first zero of J2; the weights are a nonnegative least
    squares fit of the transform, relative to the impedance of the line, over the
    frequencies up to the highest one. The series impedance is then within 0.6 %. Validity:
    angular frequencies up to the highest one.

    References
    ----------
    .. [1] W. Zielke, "Frequency-dependent friction in transient pipe flow", J. Basic Eng. 90,
       1968, 109-115.
    .. [2] A. K. Trikha, "An efficient method for simulating frequency-dependent friction in
       transient liquid flow", J. Fluids Eng. 97, 1975, 97-105 (sum of few exponentials).
    """
    from scipy.optimize import nnls

    last = max(highest_rate, 4.0 * _FIRST_RATE)
    count = 2 + int(np.ceil(np.log(last / _FIRST_RATE) / np.log(_SPACING)))
    rates = _FIRST_RATE * _SPACING ** np.arange(count)
    frequency = 1j * np.geomspace(0.1, last, _POINTS)
    exact = memory_transform(frequency)
    scale = np.abs(frequency) / np.abs(frequency + 8.0 + 4.0 * frequency * exact)
    basis = scale[:, None] / (frequency[:, None] + rates)
    weights, _ = nnls(
        np.vstack([basis.real, basis.imag]),
        np.concatenate([(scale * exact).real, (scale * exact).imag]),
    )
    kept = weights > 0.0
    return np.column_stack([rates[kept], weights[kept]])
