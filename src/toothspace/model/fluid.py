"""From a fluid's name or table to the constants that the right-hand side reads."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, final

import numpy as np

from toothspace.closures.fluid_law import FluidLaw
from toothspace.closures.vapour_pressure import clausius_clapeyron_pressure
from toothspace.closures.viscosity import walther_constants, walther_viscosity
from toothspace.core.errors import CaseError
from toothspace.core.frozen import Columns
from toothspace.core.units import AIR_GAS_CONSTANT, ATMOSPHERIC_PRESSURE, ZERO_CELSIUS
from toothspace.library import load_fluid
from toothspace.model.fluid_table import ROUNDING, LiquidState, fit_table, table_temperatures

__all__ = [
    "FluidLaw",
    "GasModel",
    "LiquidState",
    "fit_table",
    "fluid_law",
    "highest_pressure",
    "library_liquid",
    "liquid_at",
    "mixed_law",
    "temperature_range",
]

EQUILIBRIUM_RATE = 1e5
"""Exchange rate that stands for the equilibrium law. [1/s]"""

NUCLEI_VOLUME_FRACTION = 1e-6
"""Volume of bubble nuclei at one atmosphere over volume of liquid. [-]"""

VAPOUR_SMOOTHING_RATIO = 0.25
"""Width of the transition to the vapour pressure over the vapour pressure. [-]"""


@final
@dataclass(frozen=True)
class GasModel:
    """Air in the fluid."""

    law: str = "dynamic"
    """``dynamic`` (finite rates), ``equilibrium`` (rates of 1e5 1/s) or ``none`` (the free air
    stays as it is, nothing is released).
    """
    free_air_fraction: float = 0.002
    """Volume of free air in the feed at one atmosphere over volume of liquid. [-]"""
    dissolved_air_fraction: float | None = None
    """Volume of dissolved air over volume of liquid; None takes the fluid's default. [-]"""
    saturation_pressure: float = ATMOSPHERIC_PRESSURE
    """Pressure of equilibrium of the dissolved air. [Pa]"""
    release_time: float = 0.02
    absorption_time: float = 1.0
    """Time constants of the dynamic law. [s]"""

    def rates(self) -> tuple[float, float]:
        """Return release and absorption rate. [1/s]."""
        allowed = {
            "dynamic": (1.0 / self.release_time, 1.0 / self.absorption_time),
            "equilibrium": (EQUILIBRIUM_RATE, EQUILIBRIUM_RATE),
            "none": (0.0, 0.0),
        }
        if self.law not in allowed:
            names = ", ".join(allowed)
            raise CaseError("fluid.gas_law", f"{self.law!r}", names)
        return allowed[self.law]


def _viscosity_pair(
    table: Mapping[str, Any], temperature: float, state: Any
) -> tuple[float, float]:
    """Dynamic viscosity at zero pressure and its Barus coefficient."""
    density, a, b = state
    shift = table["walther_shift_cSt"]
    if "points_cSt" in table:
        kelvin = tuple(t + ZERO_CELSIUS for t in table["points_degC"])
        viscosities = tuple(1e-6 * nu for nu in table["points_cSt"])
        constants = walther_constants(kelvin, viscosities, shift)
    else:
        constants = (table["walther_intercept"], table["walther_slope"])
    kinematic = float(walther_viscosity(temperature, *constants, shift))
    # The density's share is the mean over 0 to 200 bar, where pumps work.
    p = 2e7
    alpha = table["kinematic_pressure_coefficient"] + np.log1p(a * p / (1.0 + b * p)) / p
    at_zero = kinematic * density * np.exp(-alpha * table["reference_pressure"])
    return float(at_zero), float(alpha)


def _linear(table: Mapping[str, Any], temperature: float) -> float:
    return float(table["at_20_degC"] + table["per_kelvin"] * (temperature - 20.0 - ZERO_CELSIUS))


def library_liquid(name: str, temperature: float) -> LiquidState:
    """Return the properties of a library fluid at a temperature.

    Parameters
    ----------
    name : str
        Name of the fluid. [-]
    temperature : float
        Absolute temperature. [K]

    Raises
    ------
    CaseError
        If the fluid is unknown or the temperature outside its range.
    """
    table = load_fluid(name)
    low, high = table["temperature_range_degC"]
    celsius = temperature - ZERO_CELSIUS
    if not low - ROUNDING <= celsius <= high + ROUNDING:
        allowed = f"{low:g} to {high:g} degC for {name}"
        raise CaseError("fluid.temperature", f"{celsius:g} degC", allowed)
    density = float(table["density"]["intercept"] + table["density"]["slope"] * temperature)
    modulus = _linear(table["bulk_modulus"], temperature)
    slope = table["bulk_modulus"]["per_pressure"]
    a = 1.0 / modulus
    state = (density, a, 0.5 * a * (slope - 1.0))
    viscosity, barus = _viscosity_pair(table["viscosity"], temperature, state)
    vapour = table["vapour"]
    known = vapour["pressure"], vapour["at_degC"] + ZERO_CELSIUS
    boiling = clausius_clapeyron_pressure(temperature, *known, vapour["evaporation_temperature"])
    return LiquidState(
        density=density,
        bulk_modulus=modulus,
        bulk_modulus_slope=slope,
        dynamic_viscosity=viscosity,
        pressure_viscosity=barus,
        vapour_pressure=float(max(boiling, vapour["floor"])),
        specific_heat_capacity=_linear(table["thermal"], temperature),
        dissolved_air_fraction=float(table["air"]["dissolved_fraction"]),
    )


def highest_pressure(source: str | Path | Columns, temperature: float) -> float:
    """Return the absolute pressure up to which the properties of a fluid are known. [Pa].

    Parameters
    ----------
    source : str, Path or Columns
        Name of a library fluid, or path or columns of a table (CSV). [-]
    temperature : float
        Absolute temperature. [K]
    """
    table = _table(source)
    if table is not None:
        return fit_table(table, temperature).highest_pressure
    return float(load_fluid(str(source))["pressure_range_Pa"][1])


def temperature_range(source: str | Path | Columns) -> tuple[float, float]:
    """Return the absolute temperatures between which the properties of a fluid are known. [K].

    Parameters
    ----------
    source : str, Path or Columns
        Name of a library fluid, or path or columns of a table (CSV). [-]
    """
    table = _table(source)
    if table is not None:
        return table_temperatures(table)
    low, high = load_fluid(str(source))["temperature_range_degC"]
    return low + ZERO_CELSIUS, high + ZERO_CELSIUS


def fluid_law(
    source: str | Path | Columns, temperature: float, gas: GasModel | None = None
) -> FluidLaw:
    """Return the constants of a fluid at a temperature.

    Parameters
    ----------
    source : str, Path or Columns
        Name of a library fluid, or path or columns of a table (CSV). [-]
    temperature : float
        Absolute temperature. [K]
    gas : GasModel, optional
        Air in it.

    Raises
    ------
    CaseError
        If the fluid is unknown, the table is bad or a value is out of range.
    """
    liquid = liquid_at(source, temperature)
    fall = _viscosity_fall(source, temperature, liquid.dynamic_viscosity)
    law = mixed_law(liquid, temperature, gas or GasModel())
    return law._replace(viscosity_temperature=fall)


def liquid_at(source: str | Path | Columns, temperature: float) -> LiquidState:
    """Return the properties of a liquid, from the library or a table, at a temperature [K]."""
    table = _table(source)
    if table is not None:
        return fit_table(table, temperature)
    return library_liquid(str(source), temperature)


def _table(source: str | Path | Columns) -> Path | Columns | None:
    """Table that a source stands for; None for the name of a library fluid."""
    if isinstance(source, str):
        return Path(source) if source.endswith(".csv") else None
    return source


def _viscosity_fall(source: str | Path | Columns, temperature: float, viscosity: float) -> float:
    """Relative fall of the viscosity per kelvin; one-sided at the end of the fluid's range."""
    low, high = temperature_range(source)
    step = 1.0 if temperature + 1.0 <= high else -1.0
    if temperature + step < low:
        return 0.0
    return float(np.log(viscosity / liquid_at(source, temperature + step).dynamic_viscosity) / step)


def mixed_law(liquid: LiquidState, temperature: float, gas: GasModel) -> FluidLaw:
    """Return the constants of a liquid with air, at a temperature [K], at constant viscosity."""
    if gas.saturation_pressure < 1.2 * liquid.vapour_pressure:
        found = f"{1e-5 * gas.saturation_pressure:g} bar"
        lowest = f"{1.2e-5 * liquid.vapour_pressure:g} bar or more (1.2 times the vapour pressure)"
        raise CaseError("fluid.saturation_pressure", found, lowest)
    air = AIR_GAS_CONSTANT * temperature
    density_ratio = ATMOSPHERIC_PRESSURE / air / liquid.density

    def mass_fraction(volume_ratio: float) -> float:
        mass = volume_ratio * density_ratio
        return mass / (1.0 + mass)

    dissolved = gas.dissolved_air_fraction
    dissolved = mass_fraction(liquid.dissolved_air_fraction if dissolved is None else dissolved)
    feed = mass_fraction(gas.free_air_fraction)
    release, absorption = gas.rates()
    return FluidLaw(
        reference_density=liquid.density,
        compliance=liquid.compliance,
        stiffening=liquid.stiffening,
        vapour_pressure=liquid.vapour_pressure,
        vapour_smoothing=VAPOUR_SMOOTHING_RATIO * liquid.vapour_pressure,
        gas_specific_energy=air,
        saturation_pressure=gas.saturation_pressure,
        dissolved_mass_fraction=dissolved,
        total_gas_mass_fraction=dissolved + feed,
        feed_gas_mass_fraction=feed,
        nuclei_mass_fraction=mass_fraction(NUCLEI_VOLUME_FRACTION),
        release_rate=release,
        absorption_rate=absorption,
        dynamic_viscosity=liquid.dynamic_viscosity,
        pressure_viscosity=liquid.pressure_viscosity,
        viscosity_temperature=0.0,
        specific_heat_capacity=liquid.specific_heat_capacity,
    )
