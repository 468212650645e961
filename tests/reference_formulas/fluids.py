"""Laws of fluids that the package does not run, to compare its own with."""

from __future__ import annotations

import numpy as np


def entrained_gas_bulk_modulus(
    gauge_pressure: np.ndarray, liquid_modulus: np.ndarray, gas_ratio: float, exponent: float
) -> np.ndarray:
    """Bulk modulus of a liquid with free gas that does not dissolve. [Pa].

    Gas over liquid volume at 101325 Pa; exponent 1 isothermal, 1.4 adiabatic.
    MathWorks, Simscape Fluids reference, Hydraulic Fluid.
    """
    absolute = 101325.0 + gauge_pressure
    ratio = (101325.0 / absolute) ** (1.0 / exponent)
    gas = gas_ratio * ratio * liquid_modulus / (exponent * absolute)
    return liquid_modulus * (1.0 + gas_ratio * ratio) / (1.0 + gas)


def roelands_viscosity(
    pressure: np.ndarray, viscosity: float, pressure_viscosity: float
) -> np.ndarray:
    """Dynamic viscosity with the slope of Barus' law at zero pressure. [Pa s].

    C. J. A. Roelands, Correlational aspects of the viscosity-temperature-pressure relationship
    of lubricating oils, thesis, TU Delft, 1966.
    """
    level = np.log(viscosity) + 9.67
    exponent = pressure_viscosity / (5.1e-9 * level)
    return viscosity * np.exp(level * ((1.0 + 5.1e-9 * pressure) ** exponent - 1.0))
