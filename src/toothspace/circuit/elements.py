"""All elements of a circuit by their key ``kind``, and all laws with the flows that they give."""

from __future__ import annotations

from collections.abc import Mapping

from toothspace.circuit.electric_drive import ElectricDrive
from toothspace.circuit.fmu import ForeignUnit
from toothspace.circuit.lines import FluidColumn, Hose
from toothspace.circuit.network import KIND
from toothspace.circuit.pumps import (
    FlowSource,
    MappedPump,
    PumpMap,
    SupplyPump,
    mapped_flow,
    pump_flow,
)
from toothspace.circuit.restrictions import (
    CheckValve,
    Cooler,
    Orifice,
    PressureValve,
    ProportionalOpening,
    ProportionalValve,
    ReliefValve,
    Resistance,
    pressure_valve_flow,
    proportional_flow,
    resistance_of,
)
from toothspace.circuit.shaft_loads import Coupling, Fan, Inertia, SpeedSource, TorqueSource
from toothspace.circuit.stores import Accumulator, Tank, Volume
from toothspace.core.compiled import kernel
from toothspace.core.types import Array

ELEMENTS: Mapping[str, type] = {
    "speed_source": SpeedSource,
    "pump_map": PumpMap,
    "flow_source": FlowSource,
    "hose": Hose,
    "volume": Volume,
    "orifice": Orifice,
    "relief_valve": ReliefValve,
    "check_valve": CheckValve,
    "proportional_valve": ProportionalValve,
    "accumulator": Accumulator,
    "cooler": Cooler,
    "fan": Fan,
    "inertia": Inertia,
    "coupling": Coupling,
    "torque_source": TorqueSource,
    "electric_drive": ElectricDrive,
    "tank": Tank,
    "fmu": ForeignUnit,
}
"""Circuit elements by the value of their key ``kind``."""

LAWS = (PressureValve, ProportionalOpening, Resistance, SupplyPump, MappedPump, FluidColumn)
"""Laws in the order of their kinds; the flow of the last is a state."""
(
    PRESSURE_VALVE, PROPORTIONAL_OPENING, RESISTANCE, SUPPLY_PUMP, MAPPED_PUMP, FLUID_COLUMN,
) = range(len(LAWS))  # fmt: skip


@kernel
def element_flow(
    element: Array, tables: Array, drop: float, density: float, time: float
) -> tuple[float, float]:
    """Volume flow of an element and its slope over the pressure drop. [m3/s], [m3/(s Pa)].

    ``density`` is that of the fluid at the end of higher pressure. [kg/m3]
    """
    kind = element[KIND]
    if kind == PRESSURE_VALVE:
        return pressure_valve_flow(element, drop)
    if kind == RESISTANCE:
        return resistance_of(element, drop)
    if kind == SUPPLY_PUMP:
        return pump_flow(element, tables, drop, time)
    if kind == MAPPED_PUMP:
        return mapped_flow(element, tables, drop, time)
    return proportional_flow(element, tables, drop, density, time)
