"""Supply pumps: a speed over time and an efficiency from a line, a rated point or a map."""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import NamedTuple, final

import numpy as np

from toothspace.circuit.history import (
    NO_HISTORY,
    SpeedHistory,
    check_history,
    history,
    over_time,
    scheduled,
)
from toothspace.circuit.network import (
    FIRST_KNOT,
    FIRST_ROW,
    KNOTS,
    CircuitElement,
    CircuitNetwork,
    FluidPart,
    law_columns,
)
from toothspace.closures.fluid_law import FluidLaw
from toothspace.closures.viscosity import dynamic_viscosity
from toothspace.core.compiled import kernel
from toothspace.core.errors import CaseError
from toothspace.core.keys import (
    KeyTable,
    QuantityKey,
    file_path,
    forbid,
    number,
    quantity,
    table,
)
from toothspace.core.signals import read_grid
from toothspace.core.types import Array
from toothspace.core.units import ATMOSPHERIC_PRESSURE


class SupplyPump(NamedTuple):
    """Pump whose efficiency falls linearly with the pressure rise; its speed is the history."""

    displacement: float
    """Displacement. [m3/rad]"""
    slip: float
    """Leakage per pressure rise. [m3/(s Pa)]"""
    offset: float
    """Volumetric efficiency at zero pressure rise. [-]"""
    slope: float
    """Its change per pressure rise. [1/Pa]"""


class MappedPump(NamedTuple):
    """Pump with a map of its efficiency in its table; its speed is the history."""

    displacement: float
    """Displacement. [m3/rad]"""
    slip: float
    """Leakage per pressure rise. [m3/(s Pa)]"""


_DISPLACEMENT, _SLIP, _OFFSET, _SLOPE = law_columns(SupplyPump)


@kernel
def pump_flow(element: Array, tables: Array, drop: float, time: float) -> tuple[float, float]:
    """Flow of a pump with an efficiency line and its slope over the drop. [m3/s], [m3/(s Pa)]."""
    speed = scheduled(tables, int(element[FIRST_KNOT]), int(element[KNOTS]), time)
    slope = element[_SLOPE]
    efficiency = element[_OFFSET] - slope * drop
    return delivered(element, speed, drop, efficiency, slope)


@kernel
def mapped_flow(element: Array, tables: Array, drop: float, time: float) -> tuple[float, float]:
    """Flow of a pump with an efficiency map and its slope over the drop. [m3/s], [m3/(s Pa)]."""
    speed = scheduled(tables, int(element[FIRST_KNOT]), int(element[KNOTS]), time)
    efficiency, slope = map_efficiency(tables, int(element[FIRST_ROW]), speed, -drop)
    return delivered(element, speed, drop, efficiency, slope)


@kernel
def delivered(
    element: Array, speed: float, drop: float, efficiency: float, slope: float
) -> tuple[float, float]:
    """Flow at an efficiency that changes by a slope per pressure rise; never backwards."""
    ideal = element[_DISPLACEMENT] * speed
    slip = element[_SLIP]
    flow = ideal * efficiency + slip * drop
    if flow * ideal <= 0.0:
        return 0.0, 0.0
    return flow, slip - ideal * slope


@kernel
def map_efficiency(rows: Array, first: int, speed: float, rise: float) -> tuple[float, float]:
    """Bilinear map at a speed and a pressure rise, and its slope over the rise; flat outside.

    The first row counts speeds and rises; speeds, rises and values follow, rises fastest.
    """
    speeds, rises = int(rows[first, 0]), int(rows[first, 1])
    axis = first + 1
    i, x = place(rows, axis, speeds, abs(speed))
    axis += speeds
    j, y = place(rows, axis, rises, rise)
    width = rows[axis + j + 1, 0] - rows[axis + j, 0]
    corner = axis + rises + i * rises + j
    low = rows[corner, 0] + x * (rows[corner + rises, 0] - rows[corner, 0])
    high = rows[corner + 1, 0] + x * (rows[corner + rises + 1, 0] - rows[corner + 1, 0])
    inside = 1.0 if 0.0 < y < 1.0 else 0.0
    return low + y * (high - low), inside * (high - low) / width


@kernel
def place(rows: Array, first: int, count: int, value: float) -> tuple[int, float]:
    """Cell of an increasing axis that holds a value, and the share of the cell before it."""
    k = 0
    while k < count - 2 and rows[first + k + 1, 0] <= value:
        k += 1
    low, high = rows[first + k, 0], rows[first + k + 1, 0]
    return k, min(max((value - low) / (high - low), 0.0), 1.0)


@final
@dataclass(frozen=True, kw_only=True)
class EfficiencyLine(KeyTable):
    """Volumetric efficiency that falls linearly with the pressure difference."""

    offset: float = number("Value at zero pressure difference.", above=0, high=1)
    per_100_bar: float = number("Change per 100 bar.", low=-1, high=1, default=0.0)


@final
@dataclass(frozen=True, kw_only=True)
class RatedPoint(KeyTable):
    """Point of a pump's catalogue, to which its laminar slip is fitted."""

    shaft_speed: float = quantity("rpm", "Shaft speed.", above=0, high=50000)
    pressure_difference: float = quantity("bar", "Pressure rise.", above=0, high=2000)
    volumetric_efficiency: float = number("Volumetric efficiency there.", above=0, high=1)
    dynamic_viscosity: float = quantity(
        "Pa s", "Viscosity of the oil of the catalogue.", above=0, high=10
    )

    def slip_coefficient(self, without_slip: float) -> float:
        """Slip of Wilson, (without_slip - efficiency) viscosity speed / pressure rise. [-]."""
        slip = (
            (without_slip - self.volumetric_efficiency) * self.dynamic_viscosity * self.shaft_speed
        )
        return slip / self.pressure_difference


@final
@dataclass(frozen=True, kw_only=True)
class PumpMap(SpeedHistory, FluidPart):
    """``kind = "pump_map"``: supply pump with a map of volumetric efficiency."""

    displacement: float = quantity("cm^3/rev", "Displacement.", above=0, high=10000)
    volumetric_efficiency: EfficiencyLine = table(
        EfficiencyLine, "Efficiency over pressure.", default=EfficiencyLine(offset=1.0)
    )
    rated_point: RatedPoint | None = table(
        RatedPoint,
        "Point of a catalogue that gives the slip: what the efficiency line leaves of its "
        "losses. Instead of slip_coefficient.",
        default=None,
    )
    table: Path | None = file_path(
        "Map instead of the line: columns speed [rpm], pressure_difference [bar] and "
        "volumetric_efficiency [1] of a full grid.",
        ".csv",
    )
    slip_coefficient: float = number(
        "Laminar slip of Wilson: leakage times viscosity over displacement per radian and "
        "pressure rise.",
        low=0,
        high=1e-3,
        default=0.0,
    )

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.rated_point is None:
            return
        forbid(self, "because rated_point is given", "table")
        if self.slip_coefficient > 0.0:
            allowed = "leave this key out because rated_point is given"
            raise CaseError("slip_coefficient", f"{self.slip_coefficient:g}", allowed)
        if self.slip < 0.0:
            found = f"a volumetric efficiency of {self.rated_point.volumetric_efficiency:g}"
            raise CaseError("rated_point", found, "one that volumetric_efficiency leaves")

    @property
    def slip(self) -> float:
        """Slip of Wilson, given or from the rated point. [-]."""
        rated, line = self.rated_point, self.volumetric_efficiency
        if rated is None:
            return self.slip_coefficient
        return rated.slip_coefficient(
            line.offset + line.per_100_bar * rated.pressure_difference / 1e7
        )

    @property
    def draws_alone(self) -> bool:
        """From the tank of the circuit."""
        return True

    def build(
        self, name: str, ends: tuple[str, str], start: float, fluid: FluidLaw
    ) -> CircuitNetwork:
        """One element whose work comes from outside."""
        slip = self.slip * self.displacement
        slip /= float(dynamic_viscosity(ATMOSPHERIC_PRESSURE, fluid))
        line = self.volumetric_efficiency
        law: SupplyPump | MappedPump = SupplyPump(
            self.displacement, slip, line.offset, line.per_100_bar / 1e7
        )
        rows = NO_HISTORY
        if self.table is not None:
            # as map_efficiency reads it
            units = {"speed": "rpm", "pressure_difference": "bar", "volumetric_efficiency": "1"}
            speeds, rises, efficiency = read_grid(self.table, units)
            column = np.concatenate([speeds, rises, efficiency.ravel()])
            rows = np.column_stack([column, np.zeros_like(column)])
            rows = np.vstack([[speeds.size, rises.size], rows])
            law = MappedPump(self.displacement, slip)
        pump = CircuitElement(law, *ends, self.speed_over_time, rows, supplies=True, turns=True)
        return CircuitNetwork(elements=(pump,))


@final
@dataclass(frozen=True, kw_only=True)
class FlowSource(FluidPart):
    """``kind = "flow_source"``: flow over time, whatever the pressures are."""

    flow: tuple[tuple[float, float], ...] | None = over_time(
        QuantityKey(unit="L/min", low=-1e5, high=1e5), "flow"
    )
    flow_file: Path | None = file_path("Columns time [s] and flow [L/min].", ".csv", ".txt")

    def __post_init__(self) -> None:
        check_history(self, "flow")

    @property
    def draws_alone(self) -> bool:
        """From the tank of the circuit."""
        return True

    def build(
        self, name: str, ends: tuple[str, str], start: float, fluid: FluidLaw
    ) -> CircuitNetwork:
        """An ideal pump whose displacement is one, so that its history is its flow."""
        source = CircuitElement(
            SupplyPump(1.0, 0.0, 1.0, 0.0), *ends, history(self, "flow", "L/min"), supplies=True
        )
        return CircuitNetwork(elements=(source,))
