"""Circuit elements in the right-hand side: what they carry between nodes, lose and store."""

from __future__ import annotations

from toothspace.circuit import network as net
from toothspace.circuit.elements import element_flow
from toothspace.circuit.lines import (
    add_column,
    column_energy,
    column_power,
    column_weight,
    fill_column,
)
from toothspace.core.compiled import kernel
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.arrays import SystemArrays
from toothspace.model.ledger import CIRCUIT, SUPPLY


@kernel
def ends_of(element: Array) -> tuple[int, int]:
    """Nodes at both ends."""
    return int(element[net.END_A]), int(element[net.END_B])


@kernel
def drop_along(s: SystemArrays, element: Array) -> float:
    """Pressure at the first end over that at the second. [Pa]."""
    a, b = ends_of(element)
    return s.node[a, col.PRESSURE] - s.node[b, col.PRESSURE]


@kernel
def own_state(s: SystemArrays, element: Array) -> int:
    """Where the states of an element begin whose flow is one."""
    return s.size.column + int(element[net.FIRST_STATE])


@kernel
def update_elements(s: SystemArrays, state: Array, time: float) -> None:
    """Flow of every element and its derivatives; add them to the balances of the nodes."""
    node = s.node
    for j in range(s.elements.shape[0]):
        element = s.elements[j]
        a, b = ends_of(element)
        if element[net.STATES] > 0.0:
            flow, by_drop = state[own_state(s, element)], 0.0
        else:
            drop = node[a, col.PRESSURE] - node[b, col.PRESSURE]
            upstream = node[a, col.DENSITY] if drop >= 0.0 else node[b, col.DENSITY]
            flow, by_drop = element_flow(element, s.schedule, drop, upstream, time)
        density = node[a, col.DENSITY] if flow >= 0.0 else node[b, col.DENSITY]
        gas = node[a, col.GAS] if flow >= 0.0 else node[b, col.GAS]
        element[net.FLOW] = density * flow
        element[net.FLOW_BY_A] = density * by_drop
        element[net.FLOW_BY_B] = -density * by_drop
        node[a, col.MASS_RATE] -= density * flow
        node[b, col.MASS_RATE] += density * flow
        node[a, col.GAS_RATE] -= gas * density * flow
        node[b, col.GAS_RATE] += gas * density * flow


@kernel
def fill_element_rates(s: SystemArrays, state: Array, rate: Array) -> None:
    """Rates of the states of all elements that have some."""
    for j in range(s.elements.shape[0]):
        element = s.elements[j]
        if element[net.STATES] > 0.0:
            place = own_state(s, element)
            fill_column(element, s.schedule, drop_along(s, element), state, place, rate)


@kernel
def fill_element_weights(s: SystemArrays, state: Array, weight: Array) -> None:
    """Error allowed in the states of all elements."""
    for j in range(s.elements.shape[0]):
        element = s.elements[j]
        place = own_state(s, element)
        for i in range(int(element[net.STATES])):
            allowed = column_weight(element, state[place], s.constant.relative_tolerance)
            weight[place + i] = allowed


@kernel
def stored_in_elements(s: SystemArrays, state: Array) -> float:
    """Kinetic energy of all fluid columns. [J]."""
    energy = 0.0
    for j in range(s.elements.shape[0]):
        element = s.elements[j]
        if element[net.STATES] > 0.0:
            energy += column_energy(element, s.schedule, state, own_state(s, element))
    return energy


@kernel
def book_circuit(s: SystemArrays, state: Array, ledger: Array) -> None:
    """Work of supply pumps on the fluid, and losses in valves and lines."""
    node = s.node
    for j in range(s.elements.shape[0]):
        element = s.elements[j]
        flow = element[net.FLOW]
        a, b = ends_of(element)
        gas = node[a, col.GAS] if flow > 0.0 else node[b, col.GAS]
        rise = (1.0 - gas) * (node[b, col.LIQUID_ENTHALPY] - node[a, col.LIQUID_ENTHALPY])
        rise += gas * (node[b, col.GAS_ENTHALPY] - node[a, col.GAS_ENTHALPY])
        if element[net.SUPPLIES] > 0.0:
            ledger[SUPPLY] += flow * rise
            continue
        ledger[CIRCUIT] -= flow * rise
        if element[net.STATES] > 0.0:
            place, drop = own_state(s, element), drop_along(s, element)
            ledger[CIRCUIT] -= column_power(element, s.schedule, drop, state, place)


@kernel
def add_elements(s: SystemArrays, state: Array, t: float, matrix: Array) -> None:
    """Derivatives of the flows of all elements with respect to the pressures at their ends."""
    node, size = s.node, s.size
    update_elements(s, state, t)
    for j in range(s.elements.shape[0]):
        element = s.elements[j]
        if element[net.STATES] > 0.0:
            add_own_states(s, state, element, matrix)
            continue
        a, b = ends_of(element)
        gas = node[a, col.GAS] if element[net.FLOW] >= 0.0 else node[b, col.GAS]
        for i, slope in ((a, element[net.FLOW_BY_A]), (b, element[net.FLOW_BY_B])):
            d = s.dynamic_index[i]
            if d < 0:
                continue
            change = slope * node[i, col.PRESSURE_BY_MASS]
            matrix[s.balance[a, 0], size.mass + d] -= change
            matrix[s.balance[b, 0], size.mass + d] += change
            matrix[s.balance[a, 1], size.mass + d] -= gas * change
            matrix[s.balance[b, 1], size.mass + d] += gas * change


@kernel
def add_own_states(s: SystemArrays, state: Array, element: Array, matrix: Array) -> None:
    """Derivatives of the states of an element, and of what its flow carries between its nodes."""
    place = own_state(s, element)
    a, b = ends_of(element)
    by_drop = add_column(element, s.schedule, state, place, matrix)
    source = a if element[net.FLOW] >= 0.0 else b
    density, gas = s.node[source, col.DENSITY], s.node[source, col.GAS]
    for i, sign in ((a, 1.0), (b, -1.0)):
        d = s.dynamic_index[i]
        if d >= 0:
            matrix[place, s.size.mass + d] += sign * s.node[i, col.PRESSURE_BY_MASS] * by_drop
        matrix[s.balance[i, 0], place] -= sign * density
        matrix[s.balance[i, 1], place] -= sign * gas * density
