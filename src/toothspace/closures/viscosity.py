"""Viscosity over temperature and pressure."""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.closures.fluid_law import FluidLaw
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


HIGHEST_PRESSURE = 1e8
"""Pressure beyond which viscosity data end. [Pa]"""


@inlined
def dynamic_viscosity(pressure: Any, law: FluidLaw) -> Any:
    r"""Dynamic viscosity of the liquid under pressure.

    Parameters
    ----------
    pressure : float or ndarray
        Absolute pressure. [Pa]
    law : FluidLaw
        Constants of the fluid. [SI]

    Returns
    -------
    float or ndarray
        Dynamic viscosity. [Pa s]

    Notes
    -----
    .. math:: \mu = \mu_0 e^{\alpha p'}, \qquad p' = \frac{p}{[1 + (p/p_L)^8]^{1/8}},
        \quad p_L = 100\,\mathrm{MPa}

    Validity: up to about 50 MPa, where it agrees with Roelands within 1 %. Beyond the range
    of the data (100 MPa) the growth stops: an exponential without bound would let a squeezed
    space seal itself. Free gas is not counted: gaps are filled with liquid.

    References
    ----------
    .. [1] C. Barus, "Isothermals, isopiestics and isometrics relative to viscosity",
       Am. J. Sci. 45, 1893.
    """
    share = pressure / HIGHEST_PRESSURE
    fourth = share * share * share * share
    limited = pressure / np.sqrt(np.sqrt(np.sqrt(1.0 + fourth * fourth)))
    return law.dynamic_viscosity * (1.0 + exponential_rise(law.pressure_viscosity * limited))


@inlined
def throttling_viscosity(upstream_viscosity: Any, pressure_drop: Any, law: FluidLaw) -> Any:
    r"""Effective viscosity in a short throat that heats its own flow.

    Parameters
    ----------
    upstream_viscosity : float or ndarray
        Dynamic viscosity before the throat. [Pa s]
    pressure_drop : float or ndarray
        Upstream minus downstream pressure, zero or positive. [Pa]
    law : FluidLaw
        Constants of the fluid. [SI]

    Returns
    -------
    float or ndarray
        Viscosity that gives the laminar flow of the throat. [Pa s]

    Notes
    -----
    Without heat to the walls the liquid warms by :math:`(p_1 - p) / (\rho c_p)`. Its
    viscosity falls with pressure and with temperature, and the mean of :math:`1/\mu` is

    .. math:: \mu_e = \mu(p_1) \frac{y}{e^y - 1}, \qquad
        y = \left(\alpha + \frac{\beta}{\rho c_p}\right) \Delta p .

    Validity: passage much shorter than heat conduction across the gap (20 um: 1 ms).

    References
    ----------
    .. [1] R. B. Bird, W. E. Stewart, E. N. Lightfoot, *Transport Phenomena*, Wiley (textbook
       law: energy balance of a throttled liquid; the mean is derived from it).
    .. [2] C. Barus, "Isothermals, isopiestics and isometrics relative to viscosity",
       Am. J. Sci. 45, 1893.
    """
    heating = law.viscosity_temperature / (law.reference_density * law.specific_heat_capacity)
    y = (law.pressure_viscosity + heating) * pressure_drop + 1e-9
    return upstream_viscosity * y / exponential_rise(y)


@inlined
def walther_viscosity(temperature: Any, intercept: Any, slope: Any, shift: Any) -> Any:
    r"""Kinematic viscosity over temperature by Walther's equation (ASTM D341).

    Parameters
    ----------
    temperature : float or ndarray
        Absolute temperature. [K]
    intercept : float or ndarray
        Constant A. [-]
    slope : float or ndarray
        Constant B. [-]
    shift : float or ndarray
        Constant added to the viscosity in cSt, 0.7 in ASTM D341. [cSt]

    Returns
    -------
    float or ndarray
        Kinematic viscosity. [m2/s]

    Notes
    -----
    .. math:: \log_{10} \log_{10} (\nu + c) = A - B \log_{10} T

    with the viscosity in cSt. Validity: petroleum liquids above 2 cSt (with c = 0.7).

    References
    ----------
    .. [1] ASTM D341, *Viscosity-Temperature Equations and Charts for Liquid Petroleum or
       Hydrocarbon Products*.

    Examples
    --------
    >>> round(float(walther_viscosity(323.15, 9.41799, 3.68444, 0.7)) * 1e6, 1)
    30.0
    """
    return 1e-6 * (10.0 ** (10.0 ** (intercept - slope * np.log10(temperature))) - shift)


def walther_constants(
    temperatures: tuple[float, float], viscosities: tuple[float, float], shift: float = 0.7
) -> tuple[float, float]:
    r"""Walther's constants through two measured points.

    Parameters
    ----------
    temperatures : tuple of float
        Absolute temperatures of the points. [K]
    viscosities : tuple of float
        Kinematic viscosities of the points. [m2/s]
    shift : float
        Constant added to the viscosity in cSt. [cSt]

    Returns
    -------
    intercept : float
        Constant A. [-]
    slope : float
        Constant B. [-]

    Notes
    -----
    .. math:: B = \frac{W_1 - W_2}{\log_{10}(T_2/T_1)}, \qquad A = W_1 + B \log_{10} T_1,
        \qquad W = \log_{10} \log_{10} (\nu + c)

    with the viscosity in cSt. Validity: as :func:`walther_viscosity`; the points 40 kelvin apart
    or more.

    References
    ----------
    .. [1] ASTM D341, *Viscosity-Temperature Equations and Charts for Liquid Petroleum or
       Hydrocarbon Products*.

    Examples
    --------
    >>> a, b = walther_constants((313.15, 373.15), (46e-6, 6.8e-6))
    >>> round(float(a), 4), round(float(b), 4)
    (9.418, 3.6844)
    """
    ordinates = np.log10(np.log10(np.asarray(viscosities) * 1e6 + shift))
    slope = (ordinates[0] - ordinates[1]) / np.log10(temperatures[1] / temperatures[0])
    return float(ordinates[0] + slope * np.log10(temperatures[0])), float(slope)


def barus_viscosity(
    pressure: Any, viscosity: Any, pressure_viscosity: Any, highest_exponent: Any
) -> Any:
    r"""Dynamic viscosity of a film by Barus, up to a highest ratio.

    Parameters
    ----------
    pressure : float or ndarray
        Absolute pressure. [Pa]
    viscosity : float or ndarray
        Dynamic viscosity at zero pressure. [Pa s]
    pressure_viscosity : float or ndarray
        Barus coefficient. [1/Pa]
    highest_exponent : float or ndarray
        Logarithm of the ratio beyond which the viscosity grows no further. [-]

    Returns
    -------
    float or ndarray
        Dynamic viscosity. [Pa s]

    Notes
    -----
    .. math:: \mu = \mu_0 \exp[\min(\alpha p,\; E)]

    Validity: up to about 50 MPa, where it agrees with Roelands within 1 %.

    References
    ----------
    .. [1] C. Barus, "Isothermals, isopiestics and isometrics relative to viscosity",
       Am. J. Sci. 45, 1893.
    """
    return viscosity * np.exp(np.minimum(pressure_viscosity * pressure, highest_exponent))
