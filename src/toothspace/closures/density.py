"""Density of a liquid with free gas and vapour: one smooth, explicit equation of state.

The mixture is described by an auxiliary pressure that is not limited by evaporation. The
real pressure follows from it through a smooth maximum with the vapour pressure, so that
pressure over density and density over pressure are both explicit.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.closures.fluid_law import FluidLaw
from toothspace.closures.smooth import positive_part, positive_part_slope, select
from toothspace.core.compiled import inlined


@inlined
def free_gas_fraction(gas_fraction: Any, law: FluidLaw) -> Any:
    r"""Mass fraction of free gas including the nuclei that never dissolve.

    Parameters
    ----------
    gas_fraction : float or ndarray
        Mass of free gas per mass of mixture, may be zero. [-]
    law : FluidLaw
        Constants of the fluid. [SI]

    Returns
    -------
    float or ndarray
        Smooth maximum of the fraction and zero, equal to the nuclei at zero. [-]

    Notes
    -----
    .. math:: \phi = \tfrac12 \left(f + \sqrt{f^2 + 4 f_n^2}\right)

    with the fraction :math:`f_n` of the nuclei. Validity: a regularisation; nuclei far below
    the free gas of the feed.

    References
    ----------
    .. [1] C. Kanzow, "Some noninterior continuation methods for linear complementarity
       problems", SIAM J. Matrix Anal. Appl. 17, 1996, 851-868 (smooth maximum).
    """
    return positive_part(gas_fraction, law.nuclei_mass_fraction)


@inlined
def liquid_specific_volume(pressure: Any, law: FluidLaw) -> Any:
    r"""Volume per mass of the liquid without gas.

    Parameters
    ----------
    pressure : float or ndarray
        Absolute pressure. [Pa]
    law : FluidLaw
        Constants of the fluid. [SI]

    Returns
    -------
    float or ndarray
        Specific volume. [m3/kg]

    Notes
    -----
    .. math:: v_l = \frac{1}{\rho_0}\, \frac{1 + b p}{1 + (a + b) p}, \qquad
        \rho_l = \rho_0 \left(1 + \frac{a p}{1 + b p}\right)

    with compliance a and stiffening b. Validity: 0 to 100 MPa. The bulk modulus is
    1/a at zero pressure and rises by 1 + 2 b/a per pressure.

    References
    ----------
    .. [1] D. Dowson, G. R. Higginson, *Elasto-Hydrodynamic Lubrication*, Pergamon, 1966 (form
       of the law).
    """
    b = law.stiffening
    squeezed = (1.0 + (law.compliance + b) * pressure) * law.reference_density
    return (1.0 + b * pressure) / squeezed


@inlined
def unlimited_pressure(pressure: Any, law: FluidLaw) -> Any:
    r"""Auxiliary pressure that the mixture would have if the liquid could not evaporate.

    Parameters
    ----------
    pressure : float or ndarray
        Absolute pressure, above the vapour pressure. [Pa]
    law : FluidLaw
        Constants of the fluid. [SI]

    Returns
    -------
    float or ndarray
        Auxiliary pressure, positive. [Pa]

    Notes
    -----
    .. math:: p_0 = p - \delta^2 / (p - p_v)

    with the width :math:`\delta` of the transition. Below the lowest pressure that the law
    can reach (1.06 p_v with the default width) it is held at a millionth of p_v. Validity: a
    regularisation; the width far below the pressures of interest.

    References
    ----------
    .. [1] C. Kanzow, "Some noninterior continuation methods for linear complementarity
       problems", SIAM J. Matrix Anal. Appl. 17, 1996, 851-868 (smooth maximum, here inverted).
    """
    excess = np.maximum(pressure - law.vapour_pressure, 1e-3 * law.vapour_smoothing)
    p0 = pressure - law.vapour_smoothing * law.vapour_smoothing / excess
    return np.maximum(p0, 1e-6 * law.vapour_pressure)


@inlined
def mixture_specific_volume(pressure: Any, gas_fraction: Any, law: FluidLaw) -> Any:
    r"""Volume per mass of liquid with free gas and vapour.

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
        Specific volume. [m3/kg]

    Notes
    -----
    .. math:: v = (1-f)\, v_l(p_0) + f \frac{R T}{p_0}

    with :func:`liquid_specific_volume` at the auxiliary pressure of :func:`unlimited_pressure`.
    Validity: isothermal bubbles, one common velocity; inverse of :func:`mixture_pressure`.

    References
    ----------
    .. [1] G. B. Wallis, *One-dimensional Two-phase Flow*, McGraw-Hill, 1969 (textbook law:
       homogeneous mixture).
    """
    f = free_gas_fraction(gas_fraction, law)
    p0 = unlimited_pressure(pressure, law)
    liquid = liquid_specific_volume(p0, law)
    return (1.0 - f) * liquid + f * law.gas_specific_energy / p0


@inlined
def mixture_density(pressure: Any, gas_fraction: Any, law: FluidLaw) -> Any:
    r"""Density of liquid with free gas and vapour.

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
        Density. [kg/m3]

    Notes
    -----
    .. math:: \rho = 1 / v

    with the specific volume v of :func:`mixture_specific_volume`. Validity: as there.

    References
    ----------
    .. [1] G. B. Wallis, *One-dimensional Two-phase Flow*, McGraw-Hill, 1969 (textbook law:
       homogeneous mixture).
    """
    return 1.0 / mixture_specific_volume(pressure, gas_fraction, law)


@inlined
def mixture_pressure(specific_volume: Any, gas_fraction: Any, law: FluidLaw) -> Any:
    r"""Pressure of liquid with free gas and vapour, with its derivatives.

    Parameters
    ----------
    specific_volume : float or ndarray
        Volume per mass of mixture. [m3/kg]
    gas_fraction : float or ndarray
        Mass of free gas per mass of mixture. [-]
    law : FluidLaw
        Constants of the fluid. [SI]

    Returns
    -------
    pressure : float or ndarray
        Absolute pressure, always above the vapour pressure. [Pa]
    pressure_by_volume : float or ndarray
        Derivative with respect to the specific volume, negative. [Pa kg/m3]
    pressure_by_gas : float or ndarray
        Derivative with respect to the gas fraction. [Pa]

    Notes
    -----
    The auxiliary pressure is the positive root of

    .. math:: [(1-f) v_0 b - v (a+b)] p_0^2 + [(1-f) v_0 + f R T (a+b) - v] p_0 + f R T = 0

    and :math:`p = p_v + \tfrac12 (d + \sqrt{d^2 + 4 \delta^2})`, :math:`d = p_0 - p_v`.
    Validity: isothermal bubbles; volumes above b/(a+b) of the liquid at zero pressure.

    References
    ----------
    .. [1] G. B. Wallis, *One-dimensional Two-phase Flow*, McGraw-Hill, 1969 (textbook law:
       homogeneous mixture).
    .. [2] C. Kanzow, "Some noninterior continuation methods for linear complementarity
       problems", SIAM J. Matrix Anal. Appl. 17, 1996, 851-868 (smooth maximum).
    """
    f = free_gas_fraction(gas_fraction, law)
    v, v0, b = specific_volume, 1.0 / law.reference_density, law.stiffening
    g, fC = law.compliance + b, f * law.gas_specific_energy
    # below the smallest volume of the liquid law the root is infinite: keep it finite
    quadratic = np.maximum(v * g - (1.0 - f) * v0 * b, 1e-6 * v0 * g)
    linear = (1.0 - f) * v0 + fC * g - v
    root = np.sqrt(linear * linear + 4.0 * quadratic * fC)
    # the positive root, without cancellation
    above = select(linear > 0.0, linear + root, 2.0 * fC)
    p0 = above / select(linear > 0.0, 2.0 * quadratic, root - linear)
    squeezed = 1.0 / (1.0 + g * p0)
    liquid = v0 * (1.0 + b * p0) * squeezed
    rarefied = 1.0 / p0
    gas = law.gas_specific_energy * rarefied
    volume_slope = (f - 1.0) * v0 * law.compliance * squeezed * squeezed - f * gas * rarefied
    distance = p0 - law.vapour_pressure
    pressure = law.vapour_pressure + positive_part(distance, law.vapour_smoothing)
    by_volume = positive_part_slope(distance, law.vapour_smoothing) / volume_slope
    gas_slope = positive_part_slope(gas_fraction, law.nuclei_mass_fraction)
    return pressure, by_volume, -by_volume * (gas - liquid) * gas_slope


@inlined
def dowson_higginson_density(pressure: Any, reference_density: Any) -> Any:
    r"""Density of a mineral oil at the pressures of rolling contacts.

    Parameters
    ----------
    pressure : float or ndarray
        Pressure above the atmosphere. [Pa]
    reference_density : float or ndarray
        Density at atmospheric pressure. [kg/m3]

    Returns
    -------
    float or ndarray
        Density. [kg/m3]

    Notes
    -----
    .. math:: \rho = \rho_0 \frac{0.59\cdot10^9 + 1.34 p}{0.59\cdot10^9 + p}

    Validity: to several GPa; its bulk modulus at zero pressure is 1.74 GPa.

    References
    ----------
    .. [1] D. Dowson, G. R. Higginson, *Elasto-Hydrodynamic Lubrication*, Pergamon, 1966.
    """
    return reference_density * (0.59e9 + 1.34 * pressure) / (0.59e9 + pressure)


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

    the derivative of :func:`toothspace.closures.density.liquid_specific_volume`. Validity: 0 to
    100 MPa, isothermal.

    References
    ----------
    .. [1] H. E. Merritt, *Hydraulic Control Systems*, Wiley, 1967, chapter 2 (textbook law:
       definition of the bulk modulus).
    """
    a, b, p = law.compliance, law.stiffening, pressure
    return (1.0 + b * p) * (1.0 + (a + b) * p) / a


def clausius_clapeyron_pressure(
    temperature: Any,
    reference_pressure: Any,
    reference_temperature: Any,
    evaporation_temperature: Any,
) -> Any:
    r"""Vapour pressure of a liquid with constant heat of evaporation.

    Parameters
    ----------
    temperature : float or ndarray
        Absolute temperature. [K]
    reference_pressure : float or ndarray
        Vapour pressure at the reference temperature. [Pa]
    reference_temperature : float or ndarray
        Absolute temperature at which the vapour pressure is known. [K]
    evaporation_temperature : float or ndarray
        Heat of evaporation over specific gas constant of the vapour. [K]

    Returns
    -------
    float or ndarray
        Absolute vapour pressure. [Pa]

    Notes
    -----
    .. math:: p_v = p_r \exp\left[-T_e \left(\frac{1}{T} - \frac{1}{T_r}\right)\right]

    Validity: far below the critical temperature, some tens of kelvin about the reference.

    References
    ----------
    .. [1] M. J. Moran, H. N. Shapiro, *Fundamentals of Engineering Thermodynamics*, Wiley,
       chapter 11 (textbook law: Clausius and Clapeyron).
    """
    inverse = 1.0 / temperature - 1.0 / reference_temperature
    return reference_pressure * np.exp(-evaporation_temperature * inverse)
