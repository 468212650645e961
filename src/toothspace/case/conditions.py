"""Fluid, operating point and numerical settings."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import final

from toothspace.case.presets import (
    LUMPED,
    PRESETS,
    ElasticKeys,
    IdealKeys,
    LumpedKeys,
    Preset,
)
from toothspace.circuit.lines import PortLine
from toothspace.core.errors import CaseError
from toothspace.core.frozen import Columns
from toothspace.core.keys import (
    Choice,
    KeyTable,
    QuantityKey,
    choice,
    file_path,
    forbid,
    integer,
    items,
    number,
    pair,
    quantity,
    require,
    table,
    text,
)
from toothspace.core.units import ATMOSPHERIC_PRESSURE
from toothspace.library import library_names
from toothspace.results.variables import CHANNELS

_FORCE = QuantityKey(unit="N", low=-1e6, high=1e6)


@final
@dataclass(frozen=True, kw_only=True)
class FluidChoice(KeyTable):
    """``[fluid]``: a fluid of the library or a user table, and its state."""

    name: str | None = text("Fluid from the library.", default=None)
    table: Path | Columns | None = file_path(
        "Table of properties over temperature and pressure.", ".csv", columns=True
    )
    data_sheet: Path | None = file_path(
        "Data sheet: density, and viscosities at 40 and 100 degC or the viscosity index.", ".toml"
    )
    temperature: float = quantity("degC", "Temperature of the fluid.", low=-60, high=250)
    free_air_fraction: float = number(
        "Free air over liquid volume at one atmosphere.", low=0, high=0.2, default=0.002
    )
    dissolved_air_fraction: float | None = number(
        "Dissolved air over liquid volume at one atmosphere; default that of the fluid.",
        low=0,
        high=0.5,
        default=None,
    )
    saturation_pressure: float = quantity(
        "bar",
        "Absolute pressure at which the dissolved air is in equilibrium.",
        above=0,
        high=1000,
        default=ATMOSPHERIC_PRESSURE,
    )
    gas_law: str = choice(
        "Release and absorption of air.", "dynamic", "equilibrium", "none", default="dynamic"
    )
    release_time: float = quantity(
        "s", "Time constant of air release.", above=0, high=100, default=0.02
    )
    absorption_time: float = quantity(
        "s", "Time constant of air absorption.", above=0, high=1000, default=1.0
    )

    def __post_init__(self) -> None:
        if self.data_sheet is not None:
            forbid(self, "because a data sheet is given", "name", "table")
        elif self.table is None:
            require(self, "unless a table or a data sheet is given", "name")
            names = library_names("fluids")
            if self.name not in names:
                raise CaseError("name", repr(self.name), ", ".join(names))
        else:
            forbid(self, "because a table is given", "name")

    @property
    def source(self) -> str | Path | Columns:
        """The table, the data sheet, or else the name in the library."""
        return self.table or self.data_sheet or self.name or ""


@final
@dataclass(frozen=True, kw_only=True)
class OperatingPoint(KeyTable):
    """``[operating_point]``: steady condition; pressures are absolute."""

    shaft_speed: float = quantity("rpm", "Speed of the drive shaft.", above=0, high=50000)
    inlet_pressure: float = quantity("bar", "Absolute pressure.", above=0, high=1000)
    outlet_pressure: float = quantity("bar", "Absolute pressure.", above=0, high=1000)
    outlet_load: str = choice(
        "Fixed pressure, or an orifice sized for the mean so that ripple is free; with a line, "
        "at its far end.",
        "fixed_pressure",
        "orifice",
        default="fixed_pressure",
    )
    line: PortLine | None = table(
        PortLine,
        "Line with waves at the working port: from the outlet of a pump to its load, from a "
        "source of constant pressure to the inlet of a motor.",
        default=None,
    )
    shaft_radial_load: tuple[float, float] = pair(
        _FORCE, "External force on the shaft (x, y).", default=(0.0, 0.0)
    )


@final
@dataclass(frozen=True, kw_only=True)
class HeatSettings(KeyTable):
    """``[heat]``: temperatures of oil, bodies and films at an operating point."""

    model: str = choice(
        "``network``: heat flows between oil, bodies, films and casing give the temperatures; "
        "``coupled``: these also thin the oil in lateral and journal films; ``adiabatic``: all "
        "heat of the bearings stays in the drain.",
        "network",
        "coupled",
        "adiabatic",
        default="network",
    )
    running_time: float | None = quantity(
        "s",
        "Time after a start at the temperature of the fluid; steady if not given.",
        above=0,
        high=1e6,
        default=None,
    )
    oil_conductivity: float = quantity(
        "W/(m K)", "Thermal conductivity of the oil.", above=0, high=10, default=0.13
    )
    ambient_temperature: float = quantity(
        "degC", "Temperature of the surroundings.", low=-60, high=150, default=293.15
    )
    housing_conductance: float = quantity(
        "W/K",
        "Heat flow from the casing to the surroundings per temperature difference.",
        low=0,
        high=1e4,
        default=0.0,
    )
    bearing_flushing: float = quantity(
        "L/min",
        "Oil of the supply that flows through all bearings besides the leakage.",
        low=0,
        high=1000,
        default=0.0,
    )
    casing_heat_capacity: float = quantity(
        "J/K", "Heat capacity of casing and bearing blocks.", above=0, high=1e6, default=1000.0
    )


@final
@dataclass(frozen=True, kw_only=True)
class InterfaceChoice(KeyTable):
    """``[run.interfaces]``: models of single interfaces in place of those of the preset."""

    journal: str | None = choice("Journal bearings.", "closed_form", "reynolds", default=None)
    lateral: str | None = choice(
        "Faces of gears and rotors, and the film round an outer rotor.",
        "closed_form",
        "reynolds",
        "elastic",
        default=None,
    )

    @property
    def given(self) -> dict[str, str]:
        """Interfaces for which a model is chosen."""
        return {name: model for name, model in vars(self).items() if model is not None}


@final
@dataclass(frozen=True, kw_only=True)
class RunSettings(IdealKeys, LumpedKeys, ElasticKeys):
    """``[run]``: fidelity and numerical settings."""

    fidelity: str = choice("Named set of models.", *PRESETS, default=LUMPED.name)
    interfaces: InterfaceChoice | None = table(
        InterfaceChoice,
        "Models of single interfaces; those of the preset where none is chosen.",
        default=None,
    )
    until: str | None = choice(
        "Stop when two successive revolutions agree.", "cyclic", default=None
    )
    revolutions: int | None = integer(
        "Number of shaft revolutions to run.", low=1, high=100000, default=None
    )
    max_revolutions: int = integer(
        "Most revolutions to look for the cyclic state.", low=2, high=100000, default=120
    )
    averaged_revolutions: int = integer(
        "Most revolutions that tell the means of a machine which never repeats itself.",
        low=4,
        high=1000,
        default=64,
    )
    samples_per_revolution: int = integer(
        "Samples that are kept of each revolution.", low=36, high=20000, default=720
    )
    time_samples: int = integer(
        "Rows that are kept of a run over time; each holds mean, lowest and highest value.",
        low=10,
        high=10**6,
        default=4000,
    )
    channels: tuple[str, ...] | None = items(
        Choice(options=CHANNELS),
        "What a run over time keeps of the values with one column per tooth space, body, "
        "contact, mechanism or node; all if not given.",
        low=0,
        default=None,
    )
    relative_tolerance: float = number(
        "Local error of the time integration.", low=1e-12, high=1e-4, default=1e-6
    )
    max_steps: int | None = integer(
        "Most time steps of a march; if not given, 4 million to a cyclic state and 20 million over "
        "time.",
        low=100,
        high=10**9,
        default=None,
    )
    mesh: str = choice("Stiffness of the mesh.", "rigid", "elastic", default="rigid")

    def step_limit(self, *, over_time: bool) -> int:
        """Most time steps of a march."""
        return self.max_steps or (20_000_000 if over_time else 4_000_000)

    @property
    def preset(self) -> Preset:
        """The set of models."""
        return PRESETS[self.fidelity]

    def __post_init__(self) -> None:
        if self.until is not None:
            forbid(self, 'because until = "cyclic" is given', "revolutions")
