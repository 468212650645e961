"""Mean pressure of touching asperities over the gap between rough surfaces, and their real area."""

from __future__ import annotations

import math

import numpy as np
import scipy

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


_SUMMIT_LEVELS = np.polynomial.legendre.leggauss(200)


def exceedance_moment(order: float, gap_ratio: float) -> float:
    r"""Moment of Gaussian heights above a level.

    Parameters
    ----------
    order : float
        Order n of the moment. [-]
    gap_ratio : float
        Level x over the standard deviation. [-]

    Returns
    -------
    float
        Moment. [-]

    Notes
    -----
    .. math:: F_n(x) = \frac{1}{\sqrt{2\pi}} \int_x^\infty (s - x)^n e^{-s^2/2}\, ds
        = \frac{\Gamma(n+1)}{\sqrt{2\pi}}\, e^{-x^2/4} D_{-n-1}(x)

    with the parabolic cylinder function D. Validity: exact for orders above -1.

    References
    ----------
    .. [1] J. A. Greenwood, J. H. Tripp, The contact of two nominally flat rough surfaces, Proc.
       Inst. Mech. Eng. 185 (1970) 625-633.

    Examples
    --------
    >>> round(exceedance_moment(2.5, 1.0), 5)
    0.08056
    """
    x = gap_ratio
    factor = math.gamma(order + 1.0) / math.sqrt(2.0 * math.pi)
    return float(factor * math.exp(-0.25 * x * x) * scipy.special.pbdv(-order - 1.0, x)[0])


def greenwood_tripp_pressure(
    gap_ratio: float,
    asperity_product: float,
    roughness_over_radius: float,
    effective_modulus: float,
) -> float:
    r"""Mean pressure of elastic contact between two rough surfaces.

    Parameters
    ----------
    gap_ratio : float
        Nominal gap over combined roughness. [-]
    asperity_product : float
        Asperity density times tip radius times combined roughness, about 0.03 to 0.05. [-]
    roughness_over_radius : float
        Combined roughness over tip radius, about 1e-4 to 1e-2. [-]
    effective_modulus : float
        E' = 2 / [(1 - nu1^2)/E1 + (1 - nu2^2)/E2]. [Pa]

    Returns
    -------
    float
        Pressure over the nominal area. [Pa]

    Notes
    -----
    .. math::

        p = \frac{16\sqrt2\,\pi}{15} (\eta\beta\sigma)^2 E^* \sqrt{\sigma/\beta}\,F_{5/2}(H)

    with :math:`E^* = E'/2`. Validity: elastic, Gaussian, isotropic.

    References
    ----------
    .. [1] J. A. Greenwood, J. H. Tripp, Proc. Inst. Mech. Eng. 185 (1970) 625-633.
    """
    factor = 16.0 * math.sqrt(2.0) * math.pi / 15.0 * asperity_product**2
    modulus = 0.5 * effective_modulus * math.sqrt(roughness_over_radius)
    return factor * modulus * exceedance_moment(2.5, gap_ratio)


def asperity_force(
    interference: Array, radius: float, effective_modulus: float, hardness: float, poisson: float
) -> Array:
    r"""Force on one spherical asperity, elastic to fully plastic.

    Parameters
    ----------
    interference : ndarray
        Depth by which the asperity is pressed in, not negative. [m]
    radius : float
        Tip radius. [m]
    effective_modulus : float
        E' = 2 / [(1 - nu1^2)/E1 + (1 - nu2^2)/E2]. [Pa]
    hardness : float
        Hardness of the softer body. [Pa]
    poisson : float
        Poisson's ratio of the softer body. [-]

    Returns
    -------
    ndarray
        Normal force. [N]

    Notes
    -----
    With the critical interference :math:`w_c`, the critical force
    :math:`F_c = \tfrac43 E^* R^{1/2} w_c^{3/2}` and :math:`r = w/w_c`,

    .. math:: w_c = \left(\frac{\pi K H}{2 E^*}\right)^2 R, \quad K = 0.454 + 0.41 \nu, \qquad
        \frac{F}{F_c} = r^{1.5} \ (r < 1),\; 1.03\, r^{1.425} \ (r < 6),\;
        1.40\, r^{1.263} \ (r \le 110)

    and full plasticity :math:`F = 2 \pi R w H` above. Validity: one asperity against a flat,
    elastic and perfectly plastic, without friction.

    References
    ----------
    .. [1] L. Kogut, I. Etsion, Elastic-plastic contact analysis of a sphere and a rigid flat,
       J. Appl. Mech. 69 (2002) 657-662.
    """
    modulus = 0.5 * effective_modulus
    critical = (math.pi * (0.454 + 0.41 * poisson) * hardness / (2.0 * modulus)) ** 2 * radius
    unit = 4.0 / 3.0 * modulus * math.sqrt(radius) * critical**1.5
    w = np.maximum(interference, 0.0) / critical
    force = np.where(w < 6.0, 1.03 * w**1.425, 1.40 * w**1.263)
    force = np.where(w < 1.0, w**1.5, force) * unit
    plastic = 2.0 * math.pi * radius * critical * w * hardness
    return np.asarray(np.where(w > 110.0, plastic, force))


def kogut_etsion_pressure(
    gap_ratio: float,
    roughness: float,
    correlation_length: float,
    effective_modulus: float,
    hardness: float,
    poisson: float = 0.3,
) -> float:
    r"""Mean pressure of a Gaussian surface as a sum over elastic-plastic summits.

    Parameters
    ----------
    gap_ratio : float
        Distance of the mean planes over the combined roughness. [-]
    roughness : float
        Combined root mean square roughness. [m]
    correlation_length : float
        Half-height correlation length. [m]
    effective_modulus : float
        E' = 2 / [(1 - nu1^2)/E1 + (1 - nu2^2)/E2]. [Pa]
    hardness : float
        Hardness of the softer body. [Pa]
    poisson : float
        Poisson's ratio of the softer body. [-]

    Returns
    -------
    float
        Pressure over the nominal area. [Pa]

    Notes
    -----
    .. math:: p = \eta \int_H^\infty F\big((z - H)\,\sigma\big)\, \phi(z)\, dz

    with :func:`asperity_force` F and summits of a surface with Gaussian autocorrelation
    (Nayak's parameter 3): density eta of 0.1274 / l^2, radius 0.2768 l^2 / sigma, normal
    distribution phi with standard deviation 0.8373 sigma about a level 1.303 sigma above the
    mean plane. Validity: separate summits, gap ratio above about 1.3.

    References
    ----------
    .. [1] L. Kogut, I. Etsion, J. Appl. Mech. 69 (2002) 657-662.
    .. [2] P. R. Nayak, Random process model of rough surfaces, J. Lubr. Technol. 93 (1971)
       398-407.
    """
    density = 0.1274 / correlation_length**2
    radius = 0.2768 * correlation_length**2 / roughness
    nodes, weights = _SUMMIT_LEVELS
    highest = 1.303 + 6.0 * 0.8373
    half = 0.5 * max(highest - gap_ratio, 0.0)
    height = gap_ratio + half * (1.0 + nodes)
    share = np.exp(-0.5 * ((height - 1.303) / 0.8373) ** 2) / (0.8373 * math.sqrt(2.0 * math.pi))
    depth = (height - gap_ratio) * roughness
    force = asperity_force(depth, radius, effective_modulus, hardness, poisson)
    return float(density * half * np.sum(weights * share * force))
