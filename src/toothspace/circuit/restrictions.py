"""Restrictions: orifices, valves and coolers; their keys, laws and flows."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any, NamedTuple, final

import numpy as np

from toothspace.circuit.history import NO_HISTORY, check_history, history, over_time, scheduled
from toothspace.circuit.network import (
    FIRST_KNOT,
    KNOTS,
    CircuitElement,
    CircuitNetwork,
    CircuitOrifice,
    FluidPart,
    law_columns,
)
from toothspace.closures.fluid_law import FluidLaw
from toothspace.closures.hydraulic_resistance import resistance_flow, throttle_flow, valve_flow
from toothspace.closures.orifice import DISCHARGE_COEFFICIENT
from toothspace.core.compiled import kernel
from toothspace.core.keys import Number, file_path, instead_of, number, quantity
from toothspace.core.types import Array

_ROUNDING = 5e3


class PressureValve(NamedTuple):
    """Valve that opens above a pressure difference: relief or check."""

    opening: float
    """Pressure difference at which it opens. [Pa]"""
    gradient: float
    """Pressure rise per flow once open. [Pa s/m3]"""
    rounding: float
    """Rounding of the opening point. [Pa]"""


class ProportionalOpening(NamedTuple):
    """Sharp edge whose opening from 0 to 1 is the history."""

    area: float
    """Effective area when fully open. [m2]"""


class Resistance(NamedTuple):
    """Pressure drop with a laminar and a turbulent part."""

    linear: float
    """Drop per flow. [Pa s/m3]"""
    square: float
    """Drop per flow squared. [Pa s2/m6]"""


_OPENING, _GRADIENT, _ROUNDED = law_columns(PressureValve)
(_AREA,) = law_columns(ProportionalOpening)
_LINEAR, _SQUARE = law_columns(Resistance)


@kernel
def pressure_valve_flow(element: Array, drop: float) -> tuple[float, float]:
    """Flow of a relief or check valve and its slope over the drop. [m3/s], [m3/(s Pa)]."""
    return valve_flow(drop, element[_OPENING], element[_GRADIENT], element[_ROUNDED])


@kernel
def proportional_flow(
    element: Array, tables: Array, drop: float, density: float, time: float
) -> tuple[float, float]:
    """Flow of a proportional valve at its present opening, and its slope over the drop."""
    opening = scheduled(tables, int(element[FIRST_KNOT]), int(element[KNOTS]), time)
    return throttle_flow(drop, element[_AREA] * opening, density)


@kernel
def resistance_of(element: Array, drop: float) -> tuple[float, float]:
    """Flow through a resistance and its slope over the drop. [m3/s], [m3/(s Pa)]."""
    return resistance_flow(drop, element[_LINEAR], element[_SQUARE])


@dataclass(frozen=True, kw_only=True)
class Restriction(FluidPart):
    """Keys of an element whose flow follows from one law."""

    @property
    def law(self) -> Any:
        """Named fields of its law. [SI]."""
        raise NotImplementedError

    @property
    def over_time(self) -> Array:
        """What changes over time."""
        return NO_HISTORY

    def build(
        self, name: str, ends: tuple[str, str], start: float, fluid: FluidLaw
    ) -> CircuitNetwork:
        """One element."""
        element = CircuitElement(self.law, *ends, self.over_time)
        return CircuitNetwork(elements=(element,))


@final
@dataclass(frozen=True, kw_only=True)
class Orifice(FluidPart):
    """``kind = "orifice"``: sharp-edged restriction."""

    diameter: float | None = quantity("mm", "Diameter.", above=0, high=200, default=None)
    area: float | None = quantity("mm^2", "Area.", above=0, high=1e5, default=None)
    discharge_coefficient: float = number("Discharge coefficient.", above=0, high=1, default=0.7)

    def __post_init__(self) -> None:
        instead_of(self, "diameter", "area")

    def build(
        self, name: str, ends: tuple[str, str], start: float, fluid: FluidLaw
    ) -> CircuitNetwork:
        """A flow path with the area that passes as much at the coefficient of all paths."""
        area = self.area or 0.25 * np.pi * (self.diameter or 0.0) ** 2
        passing = area * self.discharge_coefficient / DISCHARGE_COEFFICIENT
        return CircuitNetwork(orifices=(CircuitOrifice(*ends, passing),))


@final
@dataclass(frozen=True, kw_only=True)
class ReliefValve(Restriction):
    """``kind = "relief_valve"``: opens above a pressure difference."""

    opening_pressure: float = quantity("bar", "Pressure difference.", above=0, high=1000)
    gradient: float = quantity(
        "bar s/L", "Pressure rise per flow once open.", above=0, high=1e4, default=1.2e9
    )

    @property
    def law(self) -> PressureValve:
        """Opening, gradient and rounding."""
        return PressureValve(self.opening_pressure, self.gradient, _ROUNDING)


@final
@dataclass(frozen=True, kw_only=True)
class CheckValve(Restriction):
    """``kind = "check_valve"``: lets fluid pass in the order of its connections."""

    opening_pressure: float = quantity("bar", "Pressure difference.", low=0, high=1000, default=0.0)
    gradient: float = quantity(
        "bar s/L", "Pressure rise per flow once open.", above=0, high=1e4, default=1e8
    )

    @property
    def law(self) -> PressureValve:
        """Opening, gradient and rounding."""
        return PressureValve(self.opening_pressure, self.gradient, _ROUNDING)


@final
@dataclass(frozen=True, kw_only=True)
class ProportionalValve(Restriction):
    """``kind = "proportional_valve"``: orifice whose opening changes over time."""

    area: float = quantity("mm^2", "Area when fully open.", above=0, high=1e5)
    discharge_coefficient: float = number("Discharge coefficient.", above=0, high=1, default=0.7)
    opening: tuple[tuple[float, float], ...] | None = over_time(
        Number(low=0, high=1), "opening from 0 to 1"
    )
    opening_file: Path | None = file_path("Columns time [s] and opening [1].", ".csv", ".txt")

    def __post_init__(self) -> None:
        check_history(self, "opening")

    @property
    def law(self) -> ProportionalOpening:
        """Effective area."""
        return ProportionalOpening(self.discharge_coefficient * self.area)

    @property
    def over_time(self) -> Array:
        """Opening over time."""
        return history(self, "opening", "1")


@final
@dataclass(frozen=True, kw_only=True)
class Cooler(Restriction):
    """``kind = "cooler"``: pressure drop with a laminar and a turbulent part."""

    pressure_drop: float = quantity("bar", "Drop at the rated flow.", above=0, high=100)
    flow_rate: float = quantity("L/min", "Rated flow.", above=0, high=10000)
    laminar_share: float = number("Laminar part of that drop.", above=0, high=1, default=0.5)

    @property
    def law(self) -> Resistance:
        """Both parts of the drop."""
        return Resistance(
            self.laminar_share * self.pressure_drop / self.flow_rate,
            (1.0 - self.laminar_share) * self.pressure_drop / self.flow_rate**2,
        )
