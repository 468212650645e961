"""Stiffness of a liquid with free gas."""

from __future__ import annotations

from typing import Any

from toothspace.closures.density import mixture_pressure, mixture_specific_volume
from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.compiled import inlined


@inlined
def effective_bulk_modulus(pressure: Any, gas_fraction: Any, law: FluidLaw) -> Any:
    r"""Bulk modulus of the mixture at frozen composition.

    Parameters
    ----------
    pressure : float or ndarray
        Absolute pressure, above the vapour pressure. [Pa]
    gas_fraction : float or ndarray
        Mass of free gas per mass of mixture. [-]
    law : FluidLaw
        Constants of the fluid. [SI]

    Returns
    -------
    float or ndarray
        Bulk modulus, positive. [Pa]

    Notes
    -----
    .. math:: K = \rho \, \mathrm{d}p / \mathrm{d}\rho = -v \, \mathrm{d}p / \mathrm{d}v ,

    the exact derivative of :func:`toothspace.closures.density.mixture_pressure`.
    """
    volume = mixture_specific_volume(pressure, gas_fraction, law)
    return -volume * mixture_pressure(volume, gas_fraction, law)[1]


@inlined
def liquid_bulk_modulus(pressure: Any, law: FluidLaw) -> Any:
    r"""Bulk modulus of the liquid without gas.

    Parameters
    ----------
    pressure : float or ndarray
        Absolute pressure. [Pa]
    law : FluidLaw
        Constants of the fluid. [SI]

    Returns
    -------
    float or ndarray
        Bulk modulus. [Pa]

    Notes
    -----
    .. math:: K = (1 + b p) [1 + (a + b) p] / a
    """
    a, b, p = law.compliance, law.stiffening, pressure
    return (1.0 + b * p) * (1.0 + (a + b) * p) / a


@inlined
def entrained_gas_bulk_modulus(
    gauge_pressure: Any,
    liquid_modulus: Any,
    gas_volume_ratio: Any,
    polytropic_exponent: Any,
    atmospheric_pressure: Any,
) -> Any:
    r"""Bulk modulus of a liquid with free gas that does not dissolve.

    Parameters
    ----------
    gauge_pressure : float or ndarray
        Pressure above the atmosphere. [Pa]
    liquid_modulus : float or ndarray
        Bulk modulus of the liquid. [Pa]
    gas_volume_ratio : float or ndarray
        Volume of gas over volume of liquid at atmospheric pressure. [-]
    polytropic_exponent : float or ndarray
        1 isothermal, 1.4 adiabatic. [-]
    atmospheric_pressure : float or ndarray
        Absolute pressure of the atmosphere. [Pa]

    Returns
    -------
    float or ndarray
        Bulk modulus of the mixture. [Pa]

    Notes
    -----
    .. math:: E = E_l \frac{1 + \alpha (p_a / (p_a + p))^{1/n}}
        {1 + \alpha p_a^{1/n} E_l / [n (p_a + p)^{(n+1)/n}]}

    Validity: no dissolution, no vapour, constant modulus of the liquid. Kept to compare
    with other programs; the package itself uses :func:`effective_bulk_modulus`.

    References
    ----------
    .. [1] MathWorks, Simscape Fluids reference, *Hydraulic Fluid*.

    Examples
    --------
    >>> modulus = entrained_gas_bulk_modulus(10e5, 1.7e9, 0.005, 1.4, 101325.0)
    >>> round(float(modulus) / 1e9, 2)
    0.85
    """
    n = polytropic_exponent
    absolute = atmospheric_pressure + gauge_pressure
    ratio = (atmospheric_pressure / absolute) ** (1.0 / n)
    gas = gas_volume_ratio * ratio * liquid_modulus / (n * absolute)
    return liquid_modulus * (1.0 + gas_volume_ratio * ratio) / (1.0 + gas)
