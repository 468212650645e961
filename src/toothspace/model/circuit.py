r"""Hydraulic elements round the machine: supply pump, valves; their flows and losses.

Each element joins two nodes; its volume flow counts from a to b and depends on the pressures
at both ends and on time. Volumes (hoses, lines) are dynamic nodes of the network, tanks are
nodes of constant pressure, orifices are ordinary flow paths, lines with waves are chains of
nodes and fluid columns.
"""

from __future__ import annotations

from toothspace.closures.hydraulic_resistance import resistance_flow, throttle_flow, valve_flow
from toothspace.core.compiled import kernel
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.arrays import SystemArrays
from toothspace.model.drive import scheduled
from toothspace.model.fluid_column import FLUID_COLUMN, column_flow, column_power
from toothspace.model.ledger import CIRCUIT, SUPPLY

SUPPLY_PUMP, PRESSURE_VALVE, PROPORTIONAL_VALVE, RESISTANCE = range(4)


@kernel
def update_elements(s: SystemArrays, state: Array, time: float) -> None:
    """Flow of every element and its derivatives; add them to the balances of the nodes."""
    elements, node = s.elements, s.node
    for j in range(elements.shape[0]):
        element = elements[j]
        a, b = int(element[col.ELEMENT_A]), int(element[col.ELEMENT_B])
        if element[col.ELEMENT_KIND] == FLUID_COLUMN:
            flow, by_drop = column_flow(s, element, state), 0.0
        else:
            drop = node[a, col.PRESSURE] - node[b, col.PRESSURE]
            flow, by_drop = element_flow(s, element, drop, time)
        density = node[a, col.DENSITY] if flow >= 0.0 else node[b, col.DENSITY]
        gas = node[a, col.GAS] if flow >= 0.0 else node[b, col.GAS]
        element[col.ELEMENT_FLOW] = density * flow
        element[col.ELEMENT_BY_A] = density * by_drop
        element[col.ELEMENT_BY_B] = -density * by_drop
        node[a, col.MASS_RATE] -= density * flow
        node[b, col.MASS_RATE] += density * flow
        node[a, col.GAS_RATE] -= gas * density * flow
        node[b, col.GAS_RATE] += gas * density * flow


@kernel
def element_flow(s: SystemArrays, element: Array, drop: float, time: float) -> tuple[float, float]:
    """Volume flow of an element and its derivative with respect to the pressure drop."""
    kind = element[col.ELEMENT_KIND]
    if kind == PRESSURE_VALVE:
        opening, gradient = element[col.PARAMETER_1], element[col.PARAMETER_2]
        return valve_flow(drop, opening, gradient, element[col.PARAMETER_3])
    if kind == RESISTANCE:
        return resistance_flow(drop, element[col.PARAMETER_1], element[col.PARAMETER_2])
    value = scheduled(s.schedule, int(element[col.FIRST_KNOT]), int(element[col.KNOTS]), time)
    if kind == SUPPLY_PUMP:
        return supply_flow(s, element, drop, value)
    density = s.node[int(element[col.ELEMENT_A if drop >= 0.0 else col.ELEMENT_B]), col.DENSITY]
    return throttle_flow(drop, element[col.PARAMETER_1] * value, density)


@kernel
def supply_flow(s: SystemArrays, element: Array, drop: float, speed: float) -> tuple[float, float]:
    """Flow of a supply pump and its derivative with respect to the drop. [m3/s], [m3/(s Pa)].

    Parameters are displacement per radian, volumetric efficiency at zero pressure difference,
    its change per pressure rise (or the first row of an efficiency map, as minus one minus
    the row) and the leakage per pressure rise.
    """
    ideal = element[col.PARAMETER_1] * speed
    slip = element[col.PARAMETER_4]
    if element[col.PARAMETER_2] < 0.0:
        first = int(-element[col.PARAMETER_2]) - 1
        efficiency, slope = map_efficiency(s.schedule, first, speed, -drop)
    else:
        slope = element[col.PARAMETER_3]
        efficiency = element[col.PARAMETER_2] - slope * drop
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


@kernel
def book_circuit(s: SystemArrays, state: Array, ledger: Array) -> None:
    """Work of supply pumps on the fluid, and losses in valves and lines."""
    node = s.node
    for j in range(s.elements.shape[0]):
        element = s.elements[j]
        flow = element[col.ELEMENT_FLOW]
        a, b = int(element[col.ELEMENT_A]), int(element[col.ELEMENT_B])
        gas = node[a, col.GAS] if flow > 0.0 else node[b, col.GAS]
        rise = (1.0 - gas) * (node[b, col.LIQUID_ENTHALPY] - node[a, col.LIQUID_ENTHALPY])
        rise += gas * (node[b, col.GAS_ENTHALPY] - node[a, col.GAS_ENTHALPY])
        if element[col.ELEMENT_KIND] == SUPPLY_PUMP:
            ledger[SUPPLY] += flow * rise
            continue
        ledger[CIRCUIT] -= flow * rise
        if element[col.ELEMENT_KIND] == FLUID_COLUMN:
            ledger[CIRCUIT] -= column_power(s, element, state)
