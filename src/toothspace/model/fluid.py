"""From a fluid's name or table to the constants that the right-hand side reads.

A user's table is a CSV file, separated by commas or semicolons, with a header such as
``temperature [degC],pressure [bar],density [kg/m3],dynamic_viscosity [mPa s]`` and, if known,
``vapour_pressure [Pa]`` and ``specific_heat_capacity [J/(kg K)]``. Rows of one temperature
form an isotherm of at least three pressures.
"""

from __future__ import annotations

import csv
import re
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any, NoReturn, final

import numpy as np

from toothspace.closures.density import clausius_clapeyron_pressure
from toothspace.closures.fluid_law import FluidLaw
from toothspace.closures.viscosity import walther_constants, walther_viscosity
from toothspace.core.errors import CaseError
from toothspace.core.frozen import Columns
from toothspace.core.types import Array
from toothspace.core.units import (
    AIR_GAS_CONSTANT,
    ATMOSPHERIC_PRESSURE,
    ZERO_CELSIUS,
    compatible,
    to_si,
)
from toothspace.library import load_fluid
from toothspace.model.data_sheet import data_sheet, read_data_sheet, share_of_density

REQUIRED = {"temperature": "K", "pressure": "Pa", "density": "kg/m^3", "dynamic_viscosity": "Pa s"}
"""Columns that a table must have, and the unit they are read in."""

OPTIONAL = {"vapour_pressure": "Pa", "specific_heat_capacity": "J/(kg K)"}
"""Columns that a table may have."""

DEFAULT_HEAT_CAPACITY = 2000.0
"""Specific heat capacity of a table without that column. [J/(kg K)]"""

VAPOUR_FLOOR = 1000.0
"""Lowest vapour pressure that the equation of state is given: numerical floor. [Pa]"""

SHEET = ".toml"
"""Ending of data sheets."""

ROUNDING = 1e-6
"""Temperature by which a fluid is known beyond its range, as left by a change of units. [K]"""

_HEADER = re.compile(r"\s*(\w+)\s*\[(.+)\]\s*")
_POWER = re.compile(r"(?<=[A-Za-z])(\d)")
_POSITIVE = ("temperature", "density", "dynamic_viscosity", "specific_heat_capacity")


TABLE_AIR_FRACTION = 0.08
"""Dissolved air at one atmosphere over volume of liquid, of a table. [-]"""


@dataclass(frozen=True)
class LiquidState:
    """Properties of a liquid at one temperature, without gas."""

    density: float
    """At zero pressure. [kg/m3]"""
    bulk_modulus: float
    """At zero pressure. [Pa]"""
    bulk_modulus_slope: float
    """Rise of the bulk modulus per pressure. [-]"""
    dynamic_viscosity: float
    """At zero pressure. [Pa s]"""
    pressure_viscosity: float
    """Barus coefficient of the dynamic viscosity. [1/Pa]"""
    vapour_pressure: float
    """Lowest pressure, numerical floor included. [Pa]"""
    specific_heat_capacity: float
    """Specific heat capacity. [J/(kg K)]"""
    dissolved_air_fraction: float
    """Default volume of dissolved air at one atmosphere over volume of liquid. [-]"""

    @property
    def compliance(self) -> float:
        """Compressibility a at zero pressure. [1/Pa]."""
        return 1.0 / self.bulk_modulus

    @property
    def stiffening(self) -> float:
        """Stiffening b of the density law. [1/Pa]."""
        return 0.5 * self.compliance * (self.bulk_modulus_slope - 1.0)


@final
@dataclass(frozen=True)
class TableFit(LiquidState):
    """Properties of a liquid fitted to a table at one temperature."""

    density_error: float
    viscosity_error: float
    """Largest relative error of the fit at the points of the isotherms used. [-]"""
    highest_pressure: float
    """Pressure up to which these isotherms reach. [Pa]"""


def _fail(path: Path | Columns, place: str, found: object, allowed: str) -> NoReturn:
    raise CaseError(f"fluid.table: {path.name}, {place}", found, allowed)


def _columns(path: Path | Columns, header: list[str]) -> dict[str, tuple[int, str]]:
    """Position and unit of every known column."""
    known, found = {**REQUIRED, **OPTIONAL}, {}
    for position, text in enumerate(header):
        match = _HEADER.fullmatch(text)
        if match is None:
            _fail(path, f"column {position + 1}, row 1", repr(text), "a name with its [unit]")
        name, unit = match[1], _POWER.sub(r"^\1", match[2])
        if name not in known or name in found:
            _fail(path, f"column {name}, row 1", repr(name), "each once: " + ", ".join(known))
        try:
            fits = compatible(unit, known[name])
        except CaseError:
            fits = False
        if not fits:
            _fail(path, f"column {name}, row 1", repr(unit), f"a unit such as {known[name]}")
        found[name] = (position, unit)
    for name in REQUIRED:
        if name not in found:
            _fail(path, f"column {name}, row 1", "none", "a column " + name)
    return found


def _read(path: Path | Columns) -> tuple[dict[str, Array], list[int]]:
    """Columns of a table in SI units, and the row number of every entry."""
    try:
        if isinstance(path, Columns):
            lines = list(enumerate(path.lines(), start=1))
        else:
            text = path.read_text(encoding="utf-8-sig")
            separator = ";" if ";" in text.partition("\n")[0] else ","
            cells = csv.reader(text.splitlines(), delimiter=separator)
            lines = [(k, line) for k, line in enumerate(cells, start=1) if any(line)]
    except (OSError, UnicodeDecodeError, csv.Error) as error:
        raise CaseError("fluid.table", f"{path} unreadable ({error})", "a CSV file") from error
    if len(lines) < 2:
        _fail(path, "row 1", f"{len(lines)} rows", "a header and rows of numbers")
    columns = _columns(path, lines[0][1])
    data: dict[str, list[float]] = {name: [] for name in columns}
    for row, line in lines[1:]:
        if len(line) != len(lines[0][1]):
            _fail(path, f"row {row}", f"{len(line)} entries", f"{len(lines[0][1])} entries")
        for name, (position, unit) in columns.items():
            cell = line[position]
            place = f"column {name}, row {row}"
            try:
                value = to_si(float(cell), unit)
            except ValueError:
                _fail(path, place, repr(cell.strip()), "a number with a decimal point")
            if not np.isfinite(value):
                _fail(path, place, cell.strip(), "a finite number")
            if value < 0.0 or (value == 0.0 and name in _POSITIVE):
                _fail(path, place, cell.strip(), "a positive number")
            data[name].append(value)
    return {name: np.array(values) for name, values in data.items()}, [k for k, _ in lines[1:]]


def _isotherm(
    data: dict[str, Array], rows: list[int], level: float, path: Path | Columns
) -> dict[str, Array]:
    """Rows of one temperature in the order of pressure, checked."""
    chosen = np.flatnonzero(np.abs(data["temperature"] - level) < 1e-6)
    chosen = chosen[np.argsort(data["pressure"][chosen], kind="stable")]
    line = {name: values[chosen] for name, values in data.items()}
    kelvin = f"{level - ZERO_CELSIUS:g} degC"
    if chosen.size < 3:
        place = f"column pressure, row {rows[chosen[0]]}"
        _fail(path, place, f"{chosen.size} pressures at {kelvin}", "three or more")
    for k, (lower, upper) in enumerate(pairwise(line["pressure"])):
        if upper <= lower:
            place = f"column pressure, row {rows[chosen[k + 1]]}"
            _fail(path, place, f"{upper:g} Pa twice at {kelvin}", "each pressure once")
    for k, (lower, upper) in enumerate(pairwise(line["density"])):
        if upper <= lower:
            place = f"column density, row {rows[chosen[k + 1]]}"
            _fail(path, place, f"{upper:g} kg/m3 after {lower:g}", "density rising with pressure")
    return line


def _fit_isotherm(line: dict[str, Array]) -> tuple[Array, float, float]:
    """Density (rho0, 1/a, b), viscosity (ln mu0, alpha) and their largest relative errors."""
    p, rho = line["pressure"], line["density"]
    scale = p.max()
    x = p / scale
    # rho (1 + b p) = rho0 + rho0 (a + b) p is linear in its constants.
    solution = np.linalg.lstsq(np.stack([np.ones_like(x), x, -rho * x], axis=1), rho, rcond=None)[0]
    if solution[2] < 0.0 or solution[1] <= solution[0] * solution[2]:
        line_fit = np.linalg.lstsq(np.stack([np.ones_like(x), x], axis=1), rho, rcond=None)[0]
        solution = np.array([line_fit[0], line_fit[1], 0.0])
    rho0, b = solution[0], solution[2] / scale
    a = solution[1] / (solution[0] * scale) - b
    density_error = float(np.abs(rho0 * (1.0 + a * p / (1.0 + b * p)) / rho - 1.0).max())
    logarithm = np.log(line["dynamic_viscosity"])
    slope, level = np.polyfit(x, logarithm, 1)
    viscosity_error = float(np.abs(np.exp(level + slope * x - logarithm) - 1.0).max())
    return np.array([rho0, 1.0 / a, b, level, slope / scale]), density_error, viscosity_error


def fit_table(path: Path | Columns, temperature: float) -> TableFit:
    """Read a fluid table and fit the liquid's constants at a temperature.

    Constants with the largest error of the fit. [SI]

    Raises CaseError if the file cannot be read, a column, unit or number is bad, the density does
    not rise with pressure or the temperature is outside the table; names column and row.

    Parameters
    ----------
    path : Path or Columns
        CSV file, see the module, or its columns. [-]
    temperature : float
        Absolute temperature inside the range of the table. [K]

    Notes
    -----
    Least squares on the isotherms below and above; their constants (of the viscosity the
    logarithm) are interpolated linearly over the temperature.
    """
    data, rows = _read(path)
    levels = np.unique(np.round(data["temperature"], 9))
    if not levels[0] - ROUNDING <= temperature <= levels[-1] + ROUNDING:
        low, high = levels[0] - ZERO_CELSIUS, levels[-1] - ZERO_CELSIUS
        found = f"{temperature - ZERO_CELSIUS:g} degC"
        allowed = f"{low:g} to {high:g} degC, column temperature of {path.name}"
        raise CaseError("fluid.temperature", found, allowed)
    lines = {float(level): _isotherm(data, rows, float(level), path) for level in levels}
    upper = int(np.clip(np.searchsorted(levels, temperature), 1, max(levels.size - 1, 1)))
    pair = [float(levels[upper - 1]), float(levels[min(upper, levels.size - 1)])]
    share = (temperature - pair[0]) / (pair[1] - pair[0]) if pair[1] > pair[0] else 0.0
    return _between([lines[level] for level in pair], min(max(share, 0.0), 1.0))


def _between(lines: list[dict[str, Array]], share: float) -> TableFit:
    """Interpolate the constants of two isotherms."""
    fits = [_fit_isotherm(line) for line in lines]
    constants = (1.0 - share) * fits[0][0] + share * fits[1][0]

    def level(name: str, default: float) -> float:
        if name not in lines[0]:
            return default
        return float((1.0 - share) * lines[0][name][0] + share * lines[1][name][0])

    compliance = float(1.0 / constants[1])
    return TableFit(
        density=float(constants[0]),
        bulk_modulus=1.0 / compliance,
        bulk_modulus_slope=1.0 + 2.0 * float(constants[2]) / compliance,
        dynamic_viscosity=float(np.exp(constants[3])),
        pressure_viscosity=float(constants[4]),
        vapour_pressure=max(level("vapour_pressure", VAPOUR_FLOOR), VAPOUR_FLOOR),
        specific_heat_capacity=level("specific_heat_capacity", DEFAULT_HEAT_CAPACITY),
        dissolved_air_fraction=TABLE_AIR_FRACTION,
        density_error=max(fits[0][1], fits[1][1]),
        viscosity_error=max(fits[0][2], fits[1][2]),
        highest_pressure=min(float(line["pressure"].max()) for line in lines),
    )


__all__ = [
    "FluidLaw",
    "GasModel",
    "LiquidState",
    "TableFit",
    "fit_table",
    "fluid_law",
    "highest_pressure",
    "known_range",
    "library_liquid",
    "liquid_at",
    "mixed_law",
    "properties_table",
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


def _linear(table: Mapping[str, Any], temperature: float) -> float:
    return float(table["at_20_degC"] + table["per_kelvin"] * (temperature - 20.0 - ZERO_CELSIUS))


def library_liquid(source: str | Path, temperature: float) -> LiquidState:
    """Return the properties of a fluid of the library or a data sheet at a temperature.

    Raises CaseError if the fluid is unknown or the temperature outside its range.

    Parameters
    ----------
    source : str or Path
        Name of the fluid, or file of its data sheet. [-]
    temperature : float
        Absolute temperature. [K]
    """
    table, name = _constants(source), source if isinstance(source, str) else source.name
    low, high = table["temperature_range_degC"]
    celsius = temperature - ZERO_CELSIUS
    if not low - ROUNDING <= celsius <= high + ROUNDING:
        allowed = f"{low:g} to {high:g} degC for {name}"
        raise CaseError("fluid.temperature", f"{celsius:g} degC", allowed)
    density = float(table["density"]["intercept"] + table["density"]["slope"] * temperature)
    modulus = _linear(table["bulk_modulus"], temperature)
    slope = table["bulk_modulus"]["per_pressure"]
    curve = table["viscosity"]
    shift = curve["walther_shift_cSt"]
    if "points_cSt" in curve:
        # through the two points next to the temperature
        points = np.asarray(curve["points_degC"]) + ZERO_CELSIUS
        upper = int(np.clip(np.searchsorted(points, temperature), 1, points.size - 1))
        kelvin = float(points[upper - 1]), float(points[upper])
        thick, thin = (1e-6 * nu for nu in curve["points_cSt"][upper - 1 : upper + 1])
        constants = walther_constants(kelvin, (thick, thin), shift)
    else:
        constants = (curve["walther_intercept"], curve["walther_slope"])
    kinematic = float(walther_viscosity(temperature, *constants, shift))
    # viscosity at zero pressure and its Barus coefficient
    alpha = curve["kinematic_pressure_coefficient"] + share_of_density(modulus, slope)
    at_zero = kinematic * density * np.exp(-alpha * curve["reference_pressure"])
    viscosity, barus = float(at_zero), float(alpha)
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
    return float(_constants(source)["pressure_range_Pa"][1])


def temperature_range(source: str | Path | Columns) -> tuple[float, float]:
    """Return the absolute temperatures between which the properties of a fluid are known. [K].

    Parameters
    ----------
    source : str, Path or Columns
        Name of a library fluid, or path or columns of a table (CSV). [-]
    """
    table = _table(source)
    if table is not None:
        temperatures = _read(table)[0]["temperature"]
        return float(temperatures.min()), float(temperatures.max())
    low, high = _constants(source)["temperature_range_degC"]
    return low + ZERO_CELSIUS, high + ZERO_CELSIUS


def known_range(source: str | Path) -> dict[str, str]:
    """Say what a fluid is known from, between which limits, and what is extrapolated.

    Raises CaseError if the fluid is unknown, or its file refused.

    Parameters
    ----------
    source : str or Path
        Name of a library fluid, a data sheet (TOML) or a table (CSV). [-]
    """
    table = _table(source)
    low, high = temperature_range(source)
    bar = f"{1e-5 * highest_pressure(source, 0.5 * (low + high)):g} bar"
    told = {
        "pressure": f"to {bar}; extrapolated beyond, as in contacts at 4 kbar: density by its law, "
        "viscosity held from 1000 bar"
    }
    if table is not None:
        return {"viscosity": "of the table, logarithm linear between its temperatures", **told}
    entry = _constants(source)
    points = entry["viscosity"].get("points_degC")
    law = "by constants of ASTM D341"
    if points is not None:
        law = f"known from {points[0]:g} to {points[-1]:g} degC, extrapolated by ASTM D341 outside"
    sources = {
        f"source_{key}": value["source"]
        for key, value in entry.items()
        if isinstance(value, dict) and "source" in value
    }
    whole = {"source": entry["source"]} if entry.get("source") else {}
    return {"viscosity": law, **told, **whole, **sources}


_STEP = 20.0
"""Between the temperatures of a table of properties. [K]"""


def properties_table(source: str | Path) -> list[dict[str, float]]:
    """Properties of a liquid over its temperatures, at zero pressure; names carry their units.

    Raises CaseError if the fluid is unknown, or its file refused.

    Parameters
    ----------
    source : str or Path
        Name of a library fluid, a data sheet (TOML) or a table (CSV). [-]
    """
    low, high = (end - ZERO_CELSIUS for end in temperature_range(source))
    inner = np.arange(np.ceil(low / _STEP) * _STEP, high + 1e-9, _STEP)
    rows = []
    for celsius in np.unique(np.round([low, *inner, high], 6)):
        liquid = liquid_at(source, float(celsius) + ZERO_CELSIUS)
        rows.append(
            {
                "temperature_degC": float(celsius),
                "density_kg_per_m3": liquid.density,
                "kinematic_viscosity_mm2_per_s": 1e6 * liquid.dynamic_viscosity / liquid.density,
                "dynamic_viscosity_mPa_s": 1e3 * liquid.dynamic_viscosity,
                "pressure_viscosity_1_per_GPa": 1e9 * liquid.pressure_viscosity,
                "bulk_modulus_GPa": 1e-9 * liquid.bulk_modulus,
                "specific_heat_capacity_J_per_kg_K": liquid.specific_heat_capacity,
                "vapour_pressure_bar": 1e-5 * liquid.vapour_pressure,
            }
        )
    return rows


def fluid_law(
    source: str | Path | Columns, temperature: float, gas: GasModel | None = None
) -> FluidLaw:
    """Return the constants of a fluid at a temperature.

    Raises CaseError if the fluid is unknown, the table is bad or a value is out of range.

    Parameters
    ----------
    source : str, Path or Columns
        Name of a library fluid, or path or columns of a table (CSV). [-]
    temperature : float
        Absolute temperature. [K]
    gas : GasModel, optional
        Air in it.
    """
    liquid = liquid_at(source, temperature)
    # one-sided at the end of the fluid's range
    low, high = temperature_range(source)
    step = 1.0 if temperature + 1.0 <= high else -1.0
    fall = (
        0.0
        if temperature + step < low
        else float(
            np.log(
                liquid.dynamic_viscosity / liquid_at(source, temperature + step).dynamic_viscosity
            )
            / step
        )
    )
    law = mixed_law(liquid, temperature, gas or GasModel())
    return law._replace(viscosity_temperature=fall)


def liquid_at(source: str | Path | Columns, temperature: float) -> LiquidState:
    """Return the properties of a liquid, from the library or a table, at a temperature [K]."""
    table = _table(source)
    if table is not None:
        return fit_table(table, temperature)
    return library_liquid(source if isinstance(source, Path) else str(source), temperature)


def _table(source: str | Path | Columns) -> Path | Columns | None:
    """Table that a source stands for; None for a library fluid or a data sheet."""
    if isinstance(source, str):
        return Path(source) if source.endswith(".csv") else None
    return None if isinstance(source, Path) and source.suffix == SHEET else source


def _constants(source: str | Path | Columns) -> Mapping[str, Any]:
    """Constants of a library fluid or a data sheet."""
    if isinstance(source, Path):
        return _of_sheet(source, source.stat().st_mtime_ns if source.is_file() else 0)
    return _of_library(str(source))


@cache
def _of_sheet(path: Path, _modified: int) -> Mapping[str, Any]:
    return read_data_sheet(path).properties()


@cache
def _of_library(name: str) -> Mapping[str, Any]:
    found = load_fluid(name)
    return (
        found
        if "density" in found and isinstance(found["density"], Mapping)
        else (data_sheet(found, name).properties())
    )


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
