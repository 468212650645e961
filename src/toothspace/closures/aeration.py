"""Free, dissolved and evaporated parts of the fluid."""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.closures.density import free_gas_fraction, mixture_specific_volume
from toothspace.closures.fluid_law import FluidLaw
from toothspace.closures.smooth import positive_part, positive_part_slope
from toothspace.core.compiled import inlined

_ROUNDING = 1e-3
"""Width of the rounded corners over the total gas fraction: regularisation, not physics."""


@inlined
def equilibrium_gas_fraction(pressure: Any, law: FluidLaw) -> Any:
    r"""Mass fraction of free gas in equilibrium with the dissolved gas (Henry's law).

    Parameters
    ----------
    pressure : float or ndarray
        Absolute pressure. [Pa]
    law : FluidLaw
        Constants of the fluid. [SI]

    Returns
    -------
    float or ndarray
        Mass of free gas per mass of mixture, positive. [-]

    Notes
    -----
    .. math:: f_{eq} = \max\left(0,\; f_{total} - f_{dissolved}\, p / p_{sat}\right)

    with a rounded corner. At the saturation pressure the free gas is that of the feed; a
    little above it all gas is dissolved in equilibrium.
    """
    capacity = law.dissolved_mass_fraction * pressure / law.saturation_pressure
    width = _ROUNDING * law.total_gas_mass_fraction + law.nuclei_mass_fraction
    return positive_part(law.total_gas_mass_fraction - capacity, width)


@inlined
def gas_exchange_rate(pressure: Any, gas_fraction: Any, law: FluidLaw) -> Any:
    r"""Rate at which gas is released from, or absorbed by, the liquid.

    Parameters
    ----------
    pressure : float or ndarray
        Absolute pressure. [Pa]
    gas_fraction : float or ndarray
        Mass of free gas per mass of mixture. [-]
    law : FluidLaw
        Constants of the fluid. [SI]

    Returns
    -------
    rate : float or ndarray
        Growth of the gas fraction, positive in release. [1/s]
    rate_by_pressure : float or ndarray
        Derivative with respect to pressure. [1/(s Pa)]
    rate_by_gas : float or ndarray
        Derivative with respect to the gas fraction. [1/s]

    Notes
    -----
    .. math:: \dot f = k (f_{eq}(p) - f)

    with the release rate where gas is missing and the (slower) absorption rate where there
    is too much, blended smoothly about equilibrium.
    """
    total = law.total_gas_mass_fraction
    width = _ROUNDING * total + law.nuclei_mass_fraction
    henry = law.dissolved_mass_fraction / law.saturation_pressure
    undersaturation = total - henry * pressure
    missing = positive_part(undersaturation, width) - gas_fraction
    missing_by_pressure = -henry * positive_part_slope(undersaturation, width)
    step = np.minimum(np.maximum(missing / width, 0.0), 1.0)
    released = missing * step * step * (3.0 - 2.0 * step)
    released_slope = step * step * (9.0 - 8.0 * step)
    extra = law.release_rate - law.absorption_rate
    rate = law.absorption_rate * missing + extra * released
    slope = law.absorption_rate + extra * released_slope
    return rate, slope * missing_by_pressure, -slope


@inlined
def gas_volume_fraction(pressure: Any, gas_fraction: Any, law: FluidLaw) -> Any:
    r"""Part of the mixture's volume that is free gas.

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
        Volume fraction between 0 and 1. [-]
    """
    gas = free_gas_fraction(gas_fraction, law) * law.gas_specific_energy / pressure
    return gas / mixture_specific_volume(pressure, gas_fraction, law)


@inlined
def vapour_fraction(specific_volume: Any, pressure: Any, gas_fraction: Any, law: FluidLaw) -> Any:
    r"""Part of the mixture's volume that is vapour.

    Parameters
    ----------
    specific_volume : float or ndarray
        Volume per mass of mixture. [m3/kg]
    pressure : float or ndarray
        Absolute pressure of the mixture at that volume. [Pa]
    gas_fraction : float or ndarray
        Mass of free gas per mass of mixture. [-]
    law : FluidLaw
        Constants of the fluid. [SI]

    Returns
    -------
    float or ndarray
        Volume fraction between 0 and 1. [-]

    Notes
    -----
    The volume that liquid and free gas do not fill at the actual pressure. It is given the
    volume because near the vapour pressure the pressure alone no longer tells it.
    """
    f = free_gas_fraction(gas_fraction, law)
    b = law.stiffening
    liquid = (1.0 + b * pressure) / (1.0 + (law.compliance + b) * pressure)
    filled = (1.0 - f) * liquid / law.reference_density + f * law.gas_specific_energy / pressure
    return np.maximum(1.0 - filled / specific_volume, 0.0)


@inlined
def undissolved_share(pressure: Any, full_release_pressure: Any, saturation_pressure: Any) -> Any:
    r"""Undissolved share of the gas in a steady, barotropic mixture (smooth Henry law).

    Parameters
    ----------
    pressure : float or ndarray
        Absolute pressure. [Pa]
    full_release_pressure : float or ndarray
        Pressure at and below which all gas is free. [Pa]
    saturation_pressure : float or ndarray
        Pressure at and above which all gas is dissolved. [Pa]

    Returns
    -------
    float or ndarray
        Share between 0 (all dissolved) and 1 (all free). [-]

    Notes
    -----
    .. math:: \theta = (1 - x)^5 (1 + 5x + 15x^2 + 35x^3 + 70x^4), \quad
        x = (p - p_H) / (p_{sat} - p_H)

    Four times differentiable at both ends.
    """
    x = (pressure - full_release_pressure) / (saturation_pressure - full_release_pressure)
    x = np.minimum(np.maximum(x, 0.0), 1.0)
    series = 1.0 + x * (5.0 + x * (15.0 + x * (35.0 + x * 70.0)))
    return (1.0 - x) ** 5 * series
