"""From a data sheet, density and two viscosities or one and the index, to all of a fluid.

A sheet is a TOML file: ``title``, ``density`` at 15 degC, ``viscosity_40`` at 40 degC, and
``viscosity_100`` at 100 degC or ``viscosity_index``. What it leaves unsaid is typical of its
``family``.
"""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, final

import numpy as np

from toothspace.closures.data_sheet import pressure_viscosity, viscosity_at_100
from toothspace.core.errors import CaseError
from toothspace.core.keys import KeyTable, Source, Table, choice, number, quantity, text
from toothspace.core.units import ZERO_CELSIUS


class Family(NamedTuple):
    """Typical properties of a kind of fluid; SI units, at 20 degC and atmospheric pressure."""

    bulk_modulus: float
    """Within some 10 %. [Pa]"""
    bulk_modulus_slope: float
    """Rise with the pressure. [-]"""
    expansion: float
    """Density that a kelvin takes. [kg/(m3 K)]"""
    heat_capacity: float
    heat_capacity_rise: float
    """Specific heat capacity [J/(kg K)] and its rise with the temperature. [J/(kg K2)]"""
    vapour_pressure: float
    evaporation_temperature: float
    """Vapour pressure at 50 degC [Pa]; it follows ``exp(-x/T)`` with this x. [K]"""
    air: float
    """Volume of dissolved air at one atmosphere over volume of liquid. [-]"""
    pressure_viscosity: float | None
    """Barus coefficient; None by the viscosity, as of mineral oils. [1/Pa]"""


FAMILIES = {
    "mineral_oil": Family(1.667e9, 4.9, 0.63, 1870.0, 4.0, 100.0, 0.0, 0.08, None),
    "ester": Family(1.85e9, 5.0, 0.70, 1950.0, 3.0, 10.0, 0.0, 0.08, None),
    "water_glycol": Family(3.3e9, 5.0, 0.70, 3200.0, 3.0, 9000.0, 5200.0, 0.02, 3.5e-9),
    "fuel": Family(1.40e9, 9.5, 0.70, 1950.0, 4.4, 1000.0, 5140.0, 0.12, 1.0e-8),
}
"""Kinds of fluids. Lubricating oils lose 0.63 kg/m3 a kelvin by ASTM D1250 (K1 = 0.6278)."""

_SHIFT = 0.7
_MEAN_PRESSURE = 2e7
"""Pressure up to which pumps work, over which the share of the density is averaged. [Pa]"""


def share_of_density(bulk_modulus: float, slope: float) -> float:
    """Coefficient of the dynamic viscosity less that of the kinematic one. [1/Pa].

    Parameters
    ----------
    bulk_modulus, slope : float
        Bulk modulus at zero pressure [Pa], and its rise per pressure [-].
    """
    a, p = 1.0 / bulk_modulus, _MEAN_PRESSURE
    b = 0.5 * a * (slope - 1.0)
    return float(np.log1p(a * p / (1.0 + b * p)) / p)


@final
@dataclass(frozen=True, kw_only=True)
class DataSheet(KeyTable):
    """What a data sheet of a fluid gives."""

    title: str = text("Name of the fluid.")
    family: str = choice("Kind of fluid.", *FAMILIES, default="mineral_oil")
    density: float = quantity("kg/m^3", "At 15 degC.", low=500, high=2000)
    viscosity_40: float = quantity("mm^2/s", "Kinematic, at 40 degC.", low=1, high=5000)
    viscosity_100: float | None = quantity(
        "mm^2/s", "Kinematic, at 100 degC.", low=0.3, high=500, default=None
    )
    viscosity_index: float | None = number(
        "In place of the viscosity at 100 degC.", low=-50, high=400, default=None
    )
    lowest_temperature: float = quantity("degC", "As the pour point.", low=-60, high=40)
    highest_temperature: float = quantity("degC", "In use.", low=20, high=250)
    bulk_modulus: float | None = quantity(
        "GPa", "At 20 degC; default that of the family.", low=0.5, high=10, default=None
    )
    source: str = text("Where the figures come from.", default="")

    def __post_init__(self) -> None:
        if (self.viscosity_100 is None) == (self.viscosity_index is None):
            found = "neither" if self.viscosity_index is None else "both"
            allowed = "one of viscosity_100 and viscosity_index"
            raise CaseError("viscosity_100", found, allowed)
        if not self.hot_viscosity < self.viscosity_40:
            found = f"{self.viscosity_index:g}" if self.viscosity_index is not None else "more"
            allowed = "what gives 2 to 70 mm2/s at 100 degC, less than at 40 degC"
            raise CaseError("viscosity_index", found, allowed)
        if self.highest_temperature <= self.lowest_temperature:
            raise CaseError("highest_temperature", "too low", "above lowest_temperature")

    @property
    def hot_viscosity(self) -> float:
        """Kinematic viscosity at 100 degC. [m2/s]."""
        if self.viscosity_100 is not None:
            return self.viscosity_100
        assert self.viscosity_index is not None
        return viscosity_at_100(self.viscosity_40, self.viscosity_index)

    def properties(self) -> dict[str, Any]:
        """All constants, as entries of the library hold them."""
        family = FAMILIES[self.family]
        modulus = self.bulk_modulus or family.bulk_modulus
        cold = self.density + family.expansion * (15.0 + ZERO_CELSIUS)
        barus = family.pressure_viscosity
        if barus is None:
            warm = cold - family.expansion * (40.0 + ZERO_CELSIUS)
            barus = pressure_viscosity(self.viscosity_40 * warm)
        of_density = share_of_density(modulus, family.bulk_modulus_slope)
        ends = self.lowest_temperature, self.highest_temperature
        return {
            "title": self.title,
            "source": self.source,
            "temperature_range_degC": [end - ZERO_CELSIUS for end in ends],
            "pressure_range_Pa": [0.0, 1e8],
            "density": {"intercept": cold, "slope": -family.expansion},
            "bulk_modulus": {
                "at_20_degC": modulus,
                "per_kelvin": 0.0,
                "per_pressure": family.bulk_modulus_slope,
            },
            "viscosity": {
                "points_degC": [40.0, 100.0],
                "points_cSt": [1e6 * self.viscosity_40, 1e6 * self.hot_viscosity],
                "walther_shift_cSt": _SHIFT,
                "kinematic_pressure_coefficient": barus - of_density,
                "reference_pressure": 0.0,
            },
            "vapour": {
                "pressure": family.vapour_pressure,
                "at_degC": 50.0,
                "evaporation_temperature": family.evaporation_temperature,
                "floor": 1000.0,
            },
            "thermal": {
                "at_20_degC": family.heat_capacity,
                "per_kelvin": family.heat_capacity_rise,
            },
            "air": {"dissolved_fraction": family.air},
        }


def read_data_sheet(path: Path) -> DataSheet:
    """Data sheet of a TOML file.

    Raises CaseError for a file that cannot be read or a key that is missing or refused.
    """
    try:
        found = tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, UnicodeDecodeError, tomllib.TOMLDecodeError) as error:
        allowed = "a data sheet in TOML"
        raise CaseError("fluid.data_sheet", f"{path} unreadable ({error})", allowed) from error
    return data_sheet(found, path.name)


def data_sheet(keys: Mapping[str, Any], name: str) -> DataSheet:
    """Data sheet of its keys, quantities with their units; ``name`` is for messages."""
    try:
        sheet: DataSheet = Table(doc="", spec=DataSheet).read(keys, Source())
    except CaseError as error:
        raise error.under("fluid.data_sheet").in_file(name) from error
    return sheet
