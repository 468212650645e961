"""Asperity contact by statistical models: Greenwood and Tripp, Kogut and Etsion.

The default law of the package is in :mod:`toothspace.closures.contact_rough`.
"""

from __future__ import annotations

import math

import numpy as np
from scipy.special import pbdv

from toothspace.core.types import Array

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
    return float(factor * math.exp(-0.25 * x * x) * pbdv(-order - 1.0, x)[0])


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
