"""Specific enthalpy of liquid and gas at fixed composition, exact for the density law."""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.closures.density import free_gas_fraction
from toothspace.closures.fluid_law import FluidLaw
from toothspace.closures.smooth import positive_part_slope
from toothspace.core.compiled import inlined


@inlined
def _reciprocal_integral(excess: Any, reference: Any, offset: Any, width: Any) -> Any:
    """Integrate 1 / (p0 + offset - p_v) over the pressure, in terms of s = p - p_v.

    With p0 = p_v + s - width^2 / s the integrand is a rational function of s whose
    denominator has one small positive and one negative root.
    """
    root = np.sqrt(offset * offset + 4.0 * width * width)
    negative = 0.5 * (offset + root)
    positive = width * width / negative
    near = np.maximum(excess - positive, 1e-9 * width) / (reference - positive)
    far = np.log1p((excess - reference) / (reference + negative))
    return (positive * np.log(near) + negative * far) / root


@inlined
def liquid_enthalpy(pressure: Any, law: FluidLaw) -> Any:
    r"""Specific enthalpy of the liquid, zero at the saturation pressure.

    Parameters
    ----------
    pressure : float or ndarray
        Absolute pressure, above the vapour pressure. [Pa]
    law : FluidLaw
        Constants of the fluid. [SI]

    Returns
    -------
    float or ndarray
        Specific enthalpy of the mechanical energy ledger. [J/kg]

    Notes
    -----
    .. math:: h = \int_{p_{ref}}^{p} v_l(p_0(p')) \, \mathrm{d}p'

    in closed form with :math:`v_l = v_0 [b + a / (1 + (a+b) p_0)] / (a+b)`, the smooth
    transition to the vapour pressure included. Validity: mechanical part of the enthalpy, at
    one temperature.

    References
    ----------
    .. [1] M. J. Moran, H. N. Shapiro, *Fundamentals of Engineering Thermodynamics*, Wiley,
       chapter 11 (textbook law: dh = v dp at constant entropy).
    """
    a, g = law.compliance, law.compliance + law.stiffening
    excess = pressure - law.vapour_pressure
    reference = law.saturation_pressure - law.vapour_pressure
    offset = law.vapour_pressure + 1.0 / g
    integral = _reciprocal_integral(excess, reference, offset, law.vapour_smoothing)
    mean = law.stiffening * (excess - reference) + a / g * integral
    return mean / (g * law.reference_density)


@inlined
def gas_enthalpy(pressure: Any, law: FluidLaw) -> Any:
    r"""Specific enthalpy of the free gas, zero at the saturation pressure.

    Parameters
    ----------
    pressure : float or ndarray
        Absolute pressure, above the vapour pressure. [Pa]
    law : FluidLaw
        Constants of the fluid. [SI]

    Returns
    -------
    float or ndarray
        Specific enthalpy (isothermal compression work) of the ledger. [J/kg]

    Notes
    -----
    .. math:: h = R T \int_{p_{ref}}^{p} \mathrm{d}p' / p_0(p')

    which is :math:`R T \ln (p / p_{ref})` far above the vapour pressure. Validity: ideal gas,
    isothermal.

    References
    ----------
    .. [1] M. J. Moran, H. N. Shapiro, *Fundamentals of Engineering Thermodynamics*, Wiley,
       chapter 11 (textbook law: work of isothermal compression).
    """
    excess = pressure - law.vapour_pressure
    reference = law.saturation_pressure - law.vapour_pressure
    integral = _reciprocal_integral(excess, reference, law.vapour_pressure, law.vapour_smoothing)
    return law.gas_specific_energy * integral


@inlined
def partial_enthalpies(pressure: Any, gas_fraction: Any, law: FluidLaw) -> tuple[Any, Any]:
    r"""Enthalpy that a mixture gains for each mass of liquid, and of free gas, that joins it.

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
    liquid, gas : float or ndarray
        Partial specific enthalpies of the ledger. [J/kg]

    Notes
    -----
    With the fraction :math:`\phi(f)` of gas and nuclei of the density law

    .. math:: h_1 = h_l + (\phi - f \phi') (h_g - h_l), \qquad h_2 = h_1 + \phi' (h_g - h_l)

    so that :math:`(1-f) h_1 + f h_2 = (1-\phi) h_l + \phi h_g`: the ledger closes with the
    volume of the nuclei too, which counts where little energy flows at low pressure. Validity:
    ideal mixture, fixed composition.

    References
    ----------
    .. [1] M. J. Moran, H. N. Shapiro, *Fundamentals of Engineering Thermodynamics*, Wiley,
       chapter 11 (textbook law: partial properties of a mixture).
    """
    liquid, gas = liquid_enthalpy(pressure, law), gas_enthalpy(pressure, law)
    slope = positive_part_slope(gas_fraction, law.nuclei_mass_fraction)
    nuclei = free_gas_fraction(gas_fraction, law) - gas_fraction * slope
    first = liquid + nuclei * (gas - liquid)
    return first, first + slope * (gas - liquid)
