"""Constants of one fluid at one temperature, as compiled formulas read them."""

from __future__ import annotations

from typing import NamedTuple

from toothspace.core.compiled import passed_by_address


@passed_by_address
class FluidLaw(NamedTuple):
    r"""Constants of one fluid at one temperature.

    Liquid density follows :math:`\rho = \rho_0 [1 + a p / (1 + b p)]`, free gas is ideal
    and isothermal, dissolved gas follows Henry's law, viscosity follows Barus.
    """

    reference_density: float
    """Density of the liquid at zero pressure. [kg/m3]"""
    compliance: float
    """Compressibility a of the liquid at zero pressure, 1 / K0. [1/Pa]"""
    stiffening: float
    """Stiffening b of the liquid; the bulk modulus rises by 1 + 2 b / a per pressure. [1/Pa]"""
    vapour_pressure: float
    """Lowest pressure that the mixture approaches. [Pa]"""
    vapour_smoothing: float
    """Width of the transition to the vapour pressure. [Pa]"""
    gas_specific_energy: float
    """Specific gas constant times temperature. [J/kg]"""
    saturation_pressure: float
    """Pressure at which the dissolved gas is in equilibrium. [Pa]"""
    dissolved_mass_fraction: float
    """Mass of gas dissolved at the saturation pressure, per mass of mixture. [-]"""
    total_gas_mass_fraction: float
    """Mass of all gas, dissolved and free, per mass of mixture. [-]"""
    feed_gas_mass_fraction: float
    """Mass of free gas in a feed at one atmosphere, per mass of mixture. [-]"""
    nuclei_mass_fraction: float
    """Mass of gas that never dissolves (bubble nuclei), per mass of mixture. [-]"""
    release_rate: float
    """Inverse time constant of gas release. [1/s]"""
    absorption_rate: float
    """Inverse time constant of gas absorption. [1/s]"""
    dynamic_viscosity: float
    """Dynamic viscosity at zero pressure. [Pa s]"""
    pressure_viscosity: float
    """Barus coefficient of the dynamic viscosity. [1/Pa]"""
    viscosity_temperature: float
    """Relative fall of the dynamic viscosity per temperature. [1/K]"""
    specific_heat_capacity: float
    """Specific heat capacity of the liquid. [J/(kg K)]"""
