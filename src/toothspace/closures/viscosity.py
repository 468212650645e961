"""Viscosity over temperature and pressure."""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.compiled import inlined

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
    return law.dynamic_viscosity * np.exp(law.pressure_viscosity * limited)


@inlined
def throttling_viscosity(upstream_pressure: Any, pressure_drop: Any, law: FluidLaw) -> Any:
    r"""Effective viscosity in a short throat that heats its own flow.

    Parameters
    ----------
    upstream_pressure : float or ndarray
        Absolute pressure before the throat. [Pa]
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
    """
    heating = law.viscosity_temperature / (law.reference_density * law.specific_heat_capacity)
    y = (law.pressure_viscosity + heating) * pressure_drop + 1e-9
    return dynamic_viscosity(upstream_pressure, law) * y / np.expm1(y)


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

    Examples
    --------
    >>> a, b = walther_constants((313.15, 373.15), (46e-6, 6.8e-6))
    >>> round(float(a), 4), round(float(b), 4)
    (9.418, 3.6844)
    """
    ordinates = np.log10(np.log10(np.asarray(viscosities) * 1e6 + shift))
    slope = (ordinates[0] - ordinates[1]) / np.log10(temperatures[1] / temperatures[0])
    return float(ordinates[0] + slope * np.log10(temperatures[0])), float(slope)


@inlined
def roelands_viscosity(pressure: Any, viscosity: Any, exponent: Any) -> Any:
    r"""Dynamic viscosity under high pressure by Roelands.

    Parameters
    ----------
    pressure : float or ndarray
        Pressure above the atmosphere. [Pa]
    viscosity : float or ndarray
        Dynamic viscosity at zero pressure. [Pa s]
    exponent : float or ndarray
        Roelands' exponent Z of :func:`roelands_exponent`. [-]

    Returns
    -------
    float or ndarray
        Dynamic viscosity. [Pa s]

    Notes
    -----
    .. math:: \mu = \mu_0 \exp\{(\ln \mu_0 + 9.67) [(1 + 5.1\cdot10^{-9} p)^Z - 1]\}

    Validity: to about 1 GPa.

    References
    ----------
    .. [1] C. J. A. Roelands, *Correlational aspects of the viscosity-temperature-pressure
       relationship of lubricating oils*, thesis, TU Delft, 1966.
    """
    return viscosity * np.exp(
        (np.log(viscosity) + 9.67) * ((1.0 + 5.1e-9 * pressure) ** exponent - 1.0)
    )


@inlined
def roelands_exponent(viscosity: Any, pressure_viscosity: Any) -> Any:
    r"""Roelands' exponent that has the slope of Barus' law at zero pressure.

    Parameters
    ----------
    viscosity : float or ndarray
        Dynamic viscosity at zero pressure. [Pa s]
    pressure_viscosity : float or ndarray
        Barus coefficient. [1/Pa]

    Returns
    -------
    float or ndarray
        Exponent Z. [-]

    Notes
    -----
    .. math:: Z = \alpha / [5.1\cdot10^{-9} (\ln \mu_0 + 9.67)]

    Examples
    --------
    >>> round(float(roelands_exponent(0.0385, 2e-8)), 2)
    0.61
    """
    return pressure_viscosity / (5.1e-9 * (np.log(viscosity) + 9.67))


@inlined
def hlp_32_viscosity(temperature: Any, pressure: Any) -> Any:
    r"""Dynamic viscosity of a measured hydraulic oil HLP 32.

    Parameters
    ----------
    temperature : float or ndarray
        Absolute temperature, 273 to 373 K. [K]
    pressure : float or ndarray
        Absolute pressure. [Pa]

    Returns
    -------
    float or ndarray
        Dynamic viscosity. [Pa s]

    Notes
    -----
    .. math:: \mu = 0.01702 \exp\left[\frac{5.428 (50 - T)}{94.72 + T} + \alpha p\right]

    with T in degC and :math:`\alpha = 2.278\cdot10^{-8} - 1.477\cdot10^{-10} T
    + 5.127\cdot10^{-13} T^2`.

    References
    ----------
    .. [1] Purdue FSTI/CASPAR, fluid HLP32.
    """
    t = temperature - 273.15
    alpha = 2.278e-8 + t * (-1.477e-10 + 5.127e-13 * t)
    return 1.702e-2 * np.exp(5.428 * (50.0 - t) / (94.72 + t) + alpha * pressure)
