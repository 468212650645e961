"""Mean pressure of touching asperities over the gap between rough surfaces, and their real area."""

from __future__ import annotations

import math

import numpy as np

from toothspace.core.compiled import inlined
from toothspace.core.types import Array

_PLASTIC_SHARE = 0.96
"""Mean pressure of plastically deformed spots over the hardness. [-]"""


@inlined
def mean_gap_ratio(nominal_gap_ratio: float) -> float:
    r"""Mean gap of a Gaussian surface over its roughness, from the nominal gap.

    Parameters
    ----------
    nominal_gap_ratio : float
        Distance of the mean planes over the combined roughness, may be negative. [-]

    Returns
    -------
    float
        Mean gap, overlap counted as zero, over the combined roughness. [-]

    Notes
    -----
    .. math:: X = H\,\Phi(H) + \varphi(H)

    with the normal distribution :math:`\Phi` and density :math:`\varphi`. Validity: Gaussian
    heights, asperities cut off where they overlap.

    References
    ----------
    .. [1] C. Wu, L. Zheng, "An average Reynolds equation for partial film lubrication with a
       contact factor", J. Tribol. 111 (1989) 188.
    """
    H = nominal_gap_ratio
    density = math.exp(-0.5 * H * H) / math.sqrt(2.0 * math.pi)
    return H * 0.5 * math.erfc(-H / math.sqrt(2.0)) + density


@inlined
def pressure_unit(roughness: float, correlation_length: float, effective_modulus: float) -> float:
    r"""Pressure over which contact pressure and hardness are dimensionless.

    Parameters
    ----------
    roughness : float
        Root mean square roughness of both surfaces together. [m]
    correlation_length : float
        Half-height correlation length. [m]
    effective_modulus : float
        E' = 2 / [(1 - nu1^2)/E1 + (1 - nu2^2)/E2]. [Pa]

    Returns
    -------
    float
        Pressure. [Pa]

    Notes
    -----
    .. math:: p_u = \frac{\pi E' \sigma}{2\, l_{50}} = \pi E^* \frac{\sigma}{l_{50}}

    the scale of the pressure that flattens a wave of height sigma and length l. Validity:
    elastic half-spaces.

    References
    ----------
    .. [1] K. L. Johnson, *Contact Mechanics*, Cambridge, 1985, section 13.2 (wavy surface).
    """
    return math.pi * effective_modulus * roughness / (2.0 * correlation_length)


@inlined
def asperity_pressure(
    gap_height: float,
    roughness: float,
    correlation_length: float,
    effective_modulus: float,
    hardness: float,
) -> float:
    r"""Pressure of touching asperities, elastic and perfectly plastic, isotropic Gaussian surface.

    Parameters
    ----------
    gap_height : float
        Nominal gap: distance of the undeformed mean planes. [m]
    roughness : float
        Combined root mean square roughness. [m]
    correlation_length : float
        Half-height correlation length of the combined surface. [m]
    effective_modulus : float
        E' = 2 / [(1 - nu1^2)/E1 + (1 - nu2^2)/E2]. [Pa]
    hardness : float
        Hardness of the softer body. [Pa]

    Returns
    -------
    float
        Mean contact pressure over the nominal area. [Pa]

    Notes
    -----
    With :math:`P = 2 l_{50} p / (\pi E' \sigma)`, :math:`H_Y = 2 l_{50} H / (\pi E' \sigma)` and
    the mean gap :math:`X`, fits to a boundary element solution of Gaussian roughness:

    .. math::

        \ln P_{el} &= -1.40292 - 2.40157 X + 0.101663 X^2 - 0.0241509 X^3 \\
        \ln (P_{pl}/H_Y) &= -0.740555 - 0.784921 X - 0.666257 X^2 + 0.0909432 X^3 \\
        P &= P_{el} / (1 + (P_{el}/P_{pl})^3)^{1/3}

    Validity: 0.2 <= X <= 3 with 10 % error for H_Y of 0.1 to 0.5; continued smoothly outside
    and faded out between X = 3 and X = 4.

    References
    ----------
    .. [1] H. M. Stanley, T. Kato, "An FFT-based method for rough surface contact", J. Tribology
       119, 1997, 481-485 (method of the solutions; the fit is this package's own).
    """
    X = min(mean_gap_ratio(gap_height / roughness), 4.0)
    unit = pressure_unit(roughness, correlation_length, effective_modulus)
    elastic = math.exp(-1.40292 + X * (-2.40157 + X * (0.101663 - 0.0241509 * X)))
    plastic = (hardness / unit) * math.exp(
        -0.740555 + X * (-0.784921 + X * (-0.666257 + 0.0909432 * X))
    )
    fade = 1.0 if X < 3.0 else (4.0 - X) ** 2 * (2.0 * X - 5.0)
    return unit * fade * elastic / (1.0 + (elastic / plastic) ** 3) ** (1.0 / 3.0)


def real_contact_share(
    contact_pressure: Array,
    roughness: float,
    correlation_length: float,
    effective_modulus: float,
    hardness: float,
) -> Array:
    r"""Real over nominal area of touching asperities, elastic and perfectly plastic.

    Parameters
    ----------
    contact_pressure : ndarray
        Mean contact pressure over the nominal area, zero or positive. [Pa]
    roughness : float
        Combined root mean square roughness. [m]
    correlation_length : float
        Half-height correlation length of the combined surface. [m]
    effective_modulus : float
        E' = 2 / [(1 - nu1^2)/E1 + (1 - nu2^2)/E2]. [Pa]
    hardness : float
        Hardness of the softer body. [Pa]

    Returns
    -------
    ndarray
        Share of the nominal area, at most one. [-]

    Notes
    -----
    With :math:`P = 2 l_{50} p / (\pi E' \sigma)`, :math:`H_Y = 2 l_{50} H / (\pi E' \sigma)`, a fit
    to the boundary element solutions from which the law of the asperity pressure is:

    .. math:: A_r/A = P / \min(0.2346 - 0.197 \sqrt{P} + 0.895 P,\; 0.96\, H_Y)

    Validity: P up to 0.16.

    References
    ----------
    .. [1] H. M. Stanley, T. Kato, "An FFT-based method for rough surface contact", J. Tribology
       119, 1997, 481-485 (method of the solutions; the fit is this package's own).
    """
    unit = pressure_unit(roughness, correlation_length, effective_modulus)
    load = np.asarray(contact_pressure) / unit
    elastic = 0.2346 - 0.197 * np.sqrt(load) + 0.895 * load
    spots = np.minimum(elastic, _PLASTIC_SHARE * hardness / unit)
    return np.asarray(np.minimum(load / spots, 1.0))
