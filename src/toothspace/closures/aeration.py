"""Free, dissolved and evaporated parts of the fluid."""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.closures.density import (
    free_gas_fraction,
    liquid_specific_volume,
    mixture_specific_volume,
)
from toothspace.closures.fluid_law import FluidLaw
from toothspace.closures.smooth import positive_part, positive_part_slope
from toothspace.core.compiled import inlined

_ROUNDING = 1e-3
"""Width of the rounded corners over the total gas fraction: regularisation, not physics."""


@inlined
def equilibrium_gas_fraction(pressure: Any, law: FluidLaw) -> tuple[Any, Any]:
    r"""Mass fraction of free gas in equilibrium with the dissolved gas (Henry's law).

    Parameters
    ----------
    pressure : float or ndarray
        Absolute pressure. [Pa]
    law : FluidLaw
        Constants of the fluid. [SI]

    Returns
    -------
    fraction : float or ndarray
        Mass of free gas per mass of mixture, positive. [-]
    by_pressure : float or ndarray
        Its derivative. [1/Pa]

    Notes
    -----
    .. math:: f_{eq} = \max\left(0,\; f_{total} - f_{dissolved}\, p / p_{sat}\right)

    with a rounded corner. At the saturation pressure the free gas is that of the feed; a
    little above it all gas is dissolved in equilibrium. Validity: a gas that dissolves in
    proportion to its pressure, as air in oil up to some tens of megapascal.

    References
    ----------
    .. [1] P. Atkins, J. de Paula, *Atkins' Physical Chemistry*, Oxford University Press,
       chapter on simple mixtures (textbook law: Henry's law).
    """
    total = law.total_gas_mass_fraction
    width = _ROUNDING * total + law.nuclei_mass_fraction
    henry = law.dissolved_mass_fraction / law.saturation_pressure
    undersaturation = total - henry * pressure
    slope = -henry * positive_part_slope(undersaturation, width)
    return positive_part(undersaturation, width), slope


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

    with the equilibrium of :func:`equilibrium_gas_fraction`, the release rate where gas is
    missing and the (slower) absorption rate where there is too much, blended smoothly about
    equilibrium. Validity: one time constant each for all sizes of bubbles.

    References
    ----------
    .. [1] J. Zhou, A. Vacca, B. Manhartsgruber, "A novel approach for the prediction of dynamic
       features of air release and absorption in hydraulic oils", J. Fluids Eng. 135, 2013,
       091305 (the idea; here with constant rates).
    """
    width = _ROUNDING * law.total_gas_mass_fraction + law.nuclei_mass_fraction
    equilibrium, missing_by_pressure = equilibrium_gas_fraction(pressure, law)
    missing = equilibrium - gas_fraction
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

    Notes
    -----
    .. math:: \alpha = f R T / (p\, v)

    with the mixture's :func:`~toothspace.closures.density.mixture_specific_volume` v. Validity:
    ideal gas, isothermal, well above the vapour pressure.

    References
    ----------
    .. [1] G. B. Wallis, *One-dimensional Two-phase Flow*, McGraw-Hill, 1969 (textbook law:
       homogeneous mixture).
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
    .. math:: \alpha_v = \max\left(0,\; 1 - \frac{(1-f)\, v_l(p) + f R T / p}{v}\right)

    The volume that liquid and free gas do not fill at the actual pressure. It is given the
    volume because near the vapour pressure the pressure alone no longer determines it.
    Validity: vapour of no mass.

    References
    ----------
    .. [1] G. B. Wallis, *One-dimensional Two-phase Flow*, McGraw-Hill, 1969 (textbook law:
       homogeneous mixture).
    """
    f = free_gas_fraction(gas_fraction, law)
    liquid = liquid_specific_volume(pressure, law)
    filled = (1.0 - f) * liquid + f * law.gas_specific_energy / pressure
    return np.maximum(1.0 - filled / specific_volume, 0.0)
