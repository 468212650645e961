r"""Hydraulic elements round the machine: supply pump, valves; their flows and losses.

Each element joins two nodes; its volume flow counts from a to b and depends on the pressures
at both ends and on time. Volumes (hoses, lines) are dynamic nodes of the network, tanks are
nodes of constant pressure, orifices are ordinary flow paths.
"""

from __future__ import annotations

from toothspace.closures.smooth import positive_part, positive_part_slope
from toothspace.core.compiled import kernel
from toothspace.core.types import Array
from toothspace.model.arrays import (
    DENSITY,
    ELEMENT_A,
    ELEMENT_B,
    ELEMENT_BY_A,
    ELEMENT_BY_B,
    ELEMENT_FLOW,
    ELEMENT_KIND,
    FIRST_KNOT,
    GAS,
    GAS_ENTHALPY,
    GAS_RATE,
    KNOTS,
    LIQUID_ENTHALPY,
    MASS_RATE,
    PARAMETER_1,
    PARAMETER_2,
    PARAMETER_3,
    PRESSURE,
    SystemArrays,
)
from toothspace.model.drive import scheduled
from toothspace.model.ledger import CIRCUIT, SUPPLY

SUPPLY_PUMP, PRESSURE_VALVE = 0, 1


@kernel
def update_elements(s: SystemArrays, time: float) -> None:
    """Flow of every element and its derivatives; add them to the balances of the nodes."""
    elements, node = s.elements, s.node
    for j in range(elements.shape[0]):
        element = elements[j]
        a, b = int(element[ELEMENT_A]), int(element[ELEMENT_B])
        drop = node[a, PRESSURE] - node[b, PRESSURE]
        if element[ELEMENT_KIND] == SUPPLY_PUMP:
            flow, by_drop = supply_flow(s, element, drop, time)
        else:
            flow, by_drop = valve_flow(element, drop)
        density = node[a, DENSITY] if flow >= 0.0 else node[b, DENSITY]
        gas = node[a, GAS] if flow >= 0.0 else node[b, GAS]
        element[ELEMENT_FLOW] = density * flow
        element[ELEMENT_BY_A] = density * by_drop
        element[ELEMENT_BY_B] = -density * by_drop
        node[a, MASS_RATE] -= density * flow
        node[b, MASS_RATE] += density * flow
        node[a, GAS_RATE] -= gas * density * flow
        node[b, GAS_RATE] += gas * density * flow


@kernel
def supply_flow(s: SystemArrays, element: Array, drop: float, time: float) -> tuple[float, float]:
    """Flow of a supply pump and its derivative with respect to the drop. [m3/s], [m3/(s Pa)].

    Parameters are displacement per radian, volumetric efficiency at zero pressure difference
    and its change per pressure rise.
    """
    speed = scheduled(s.schedule, int(element[FIRST_KNOT]), int(element[KNOTS]), time)
    ideal = element[PARAMETER_1] * speed
    efficiency = element[PARAMETER_2] - element[PARAMETER_3] * drop
    if efficiency <= 0.0:
        return 0.0, 0.0
    return ideal * efficiency, -ideal * element[PARAMETER_3]


@kernel
def valve_flow(element: Array, drop: float) -> tuple[float, float]:
    """Flow of a relief or check valve and its derivative. [m3/s], [m3/(s Pa)].

    Parameters are opening pressure difference, pressure rise per flow, and the rounding of
    the opening point.
    """
    excess = drop - element[PARAMETER_1]
    opened = positive_part(excess, element[PARAMETER_3])
    slope = positive_part_slope(excess, element[PARAMETER_3])
    return opened / element[PARAMETER_2], slope / element[PARAMETER_2]


@kernel
def book_circuit(s: SystemArrays, ledger: Array) -> None:
    """Work of supply pumps on the fluid, and losses in valves."""
    node = s.node
    for j in range(s.elements.shape[0]):
        element = s.elements[j]
        flow = element[ELEMENT_FLOW]
        a, b = int(element[ELEMENT_A]), int(element[ELEMENT_B])
        gas = node[a, GAS] if flow > 0.0 else node[b, GAS]
        rise = (1.0 - gas) * (node[b, LIQUID_ENTHALPY] - node[a, LIQUID_ENTHALPY])
        rise += gas * (node[b, GAS_ENTHALPY] - node[a, GAS_ENTHALPY])
        if element[ELEMENT_KIND] == SUPPLY_PUMP:
            ledger[SUPPLY] += flow * rise
        else:
            ledger[CIRCUIT] -= flow * rise
