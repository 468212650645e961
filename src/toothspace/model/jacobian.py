"""Jacobian of the right-hand side, assembled from the derivatives of each element."""

from __future__ import annotations

from toothspace.core.compiled import kernel
from toothspace.core.types import Array
from toothspace.model.arrays import (
    CHANNEL_MOTION,
    CONTACT_FORCE,
    DENSITY,
    ELEMENT_A,
    ELEMENT_B,
    ELEMENT_BY_A,
    ELEMENT_BY_B,
    ELEMENT_FLOW,
    ELEMENT_KIND,
    EXCHANGE_BY_GAS,
    EXCHANGE_BY_PRESSURE,
    EXCHANGE_RATE,
    FLOW,
    FLOW_BY_HEIGHT,
    FLOW_BY_PRESSURE,
    FORCE_BY_OVERLAP,
    FORCE_BY_RATE,
    FRICTION_BY_FORCE,
    FRICTION_BY_SLIP,
    GAP_BY_MOTION,
    GAS,
    HEIGHT_BY_MOTION,
    MOTION_MASS,
    NODE_A,
    PRESENT_B,
    PRESSURE_BY_GAS,
    PRESSURE_BY_MASS,
    PRESSURE_BY_VOLUME,
    SLOPE,
    VALUE,
    SystemArrays,
)
from toothspace.model.circuit import update_elements
from toothspace.model.drive import add_coupling
from toothspace.model.fluid_column import FLUID_COLUMN, add_column
from toothspace.model.ledger import GAS_MASS, MASS
from toothspace.model.system import evaluate


@kernel
def jacobian(t: float, state: Array, s: SystemArrays, matrix: Array) -> None:
    """Derivatives of all rates with respect to the core states, see :func:`fill_jacobian`."""
    evaluate(s, state)
    fill_jacobian(t, state, s, matrix)


@kernel
def fill_jacobian(t: float, state: Array, s: SystemArrays, matrix: Array) -> None:
    """Derivatives of all rates at the state last evaluated; energy rows are left out.

    The rows of port masses and port gas stand in full, so that mass balances close to round-off.
    Angle and speed of a free shaft are left to the iteration: its inertia makes their feedback
    within a step weak.
    """
    matrix[:, :] = 0.0
    matrix[0, 1] = 1.0
    for entry in range(s.paths.open[-1]):
        j = s.paths.open[entry]
        if s.path[j, FLOW] != 0.0:
            add_path(s, state, j, matrix)
    add_gas_exchange(s, state, matrix)
    add_pressure_forces(s, matrix)
    add_films(s, matrix)
    add_contacts(s, state, matrix)
    add_elements(s, state, t, matrix)
    add_coupling(s, state, matrix)


@kernel
def mass_row(s: SystemArrays, i: int) -> int:
    """Row of the mass balance of a node: a state, or the ledger entry of a fixed port."""
    d = s.dynamic_index[i]
    return s.size.mass + d if d >= 0 else s.size.core + MASS + i - s.size.chambers


@kernel
def gas_row(s: SystemArrays, i: int) -> int:
    """Row of the gas balance of a node."""
    d = s.dynamic_index[i]
    return s.size.gas + d if d >= 0 else s.size.core + GAS_MASS + i - s.size.chambers


@kernel
def add_flow_change(
    s: SystemArrays, j: int, column: int, mass_change: float, gas_change: float, matrix: Array
) -> None:
    """Add the change of one path's flows with one state to the balances of both its nodes."""
    a, b = s.path_index[j, NODE_A], s.path_index[j, PRESENT_B]
    matrix[mass_row(s, a), column] -= mass_change
    matrix[mass_row(s, b), column] += mass_change
    matrix[gas_row(s, a), column] -= gas_change
    matrix[gas_row(s, b), column] += gas_change


@kernel
def add_path(s: SystemArrays, state: Array, j: int, matrix: Array) -> None:
    """Derivatives of one path's flow through pressures, upstream state and gap height."""
    node, size = s.node, s.size
    a, b = s.path_index[j, NODE_A], s.path_index[j, PRESENT_B]
    flow = s.path[j, FLOW]
    source = a if flow > 0.0 else b
    gas = node[source, GAS]
    slope = node[source, DENSITY] * s.path[j, FLOW_BY_PRESSURE]
    for i, sign in ((a, 1.0), (b, -1.0)):
        d = s.dynamic_index[i]
        if d < 0:
            continue
        change = sign * slope * node[i, PRESSURE_BY_MASS]
        add_flow_change(s, j, size.mass + d, change, gas * change, matrix)
        change = sign * slope * node[i, PRESSURE_BY_GAS]
        add_flow_change(s, j, size.gas + d, change, gas * change, matrix)
    d = s.dynamic_index[source]
    if d >= 0:
        carried = flow / state[size.mass + d]
        add_flow_change(s, j, size.mass + d, carried, 0.0, matrix)
        add_flow_change(s, j, size.gas + d, 0.0, carried, matrix)
    add_path_motions(s, j, gas, slope, matrix)


@kernel
def add_path_motions(s: SystemArrays, j: int, gas: float, slope: float, matrix: Array) -> None:
    """Derivatives of one path's flow with respect to the micro-motions."""
    node, values, size = s.node, s.chamber_values, s.size
    a, b = s.path_index[j, NODE_A], s.path_index[j, PRESENT_B]
    source = a if s.path[j, FLOW] > 0.0 else b
    by_height = node[source, DENSITY] * s.path[j, FLOW_BY_HEIGHT]
    for k in range(size.motions):
        change = 0.0
        if by_height != 0.0:
            change += by_height * s.path_values[j, HEIGHT_BY_MOTION + k]
        if a < size.chambers:
            change += slope * node[a, PRESSURE_BY_VOLUME] * values[a, CHANNEL_MOTION + k]
        if b < size.chambers:
            change -= slope * node[b, PRESSURE_BY_VOLUME] * values[b, CHANNEL_MOTION + k]
        if change != 0.0:
            add_flow_change(s, j, size.position + k, change, gas * change, matrix)


@kernel
def add_gas_exchange(s: SystemArrays, state: Array, matrix: Array) -> None:
    """Derivatives of gas release and absorption in all dynamic nodes."""
    node, values, size = s.node, s.chamber_values, s.size
    for i in range(size.nodes):
        d = s.dynamic_index[i]
        if d < 0:
            continue
        row, mass = size.gas + d, state[size.mass + d]
        by_pressure = mass * node[i, EXCHANGE_BY_PRESSURE]
        by_gas = node[i, EXCHANGE_BY_GAS]
        matrix[row, size.mass + d] += node[i, EXCHANGE_RATE] - by_gas * node[i, GAS]
        matrix[row, size.mass + d] += by_pressure * node[i, PRESSURE_BY_MASS]
        matrix[row, size.gas + d] += by_gas + by_pressure * node[i, PRESSURE_BY_GAS]
        if i < size.chambers:
            by_volume = by_pressure * node[i, PRESSURE_BY_VOLUME]
            for k in range(size.motions):
                matrix[row, size.position + k] += by_volume * values[i, CHANNEL_MOTION + k]


@kernel
def add_pressure_forces(s: SystemArrays, matrix: Array) -> None:
    """Derivatives of the pressure forces on the motions with respect to all chambers' states."""
    node, values, size = s.node, s.chamber_values, s.size
    for i in range(size.chambers):
        d = s.dynamic_index[i]
        for k in range(size.motions):
            row = size.velocity + k
            area = values[i, CHANNEL_MOTION + k] / s.motion[k, MOTION_MASS]
            matrix[row, size.mass + d] += area * node[i, PRESSURE_BY_MASS]
            matrix[row, size.gas + d] += area * node[i, PRESSURE_BY_GAS]
            for m in range(size.motions):
                by_motion = node[i, PRESSURE_BY_VOLUME] * values[i, CHANNEL_MOTION + m]
                matrix[row, size.position + m] += area * by_motion


@kernel
def add_films(s: SystemArrays, matrix: Array) -> None:
    """Derivatives of the film forces on the motions."""
    size, slopes = s.size, s.film_slopes
    for k in range(size.motions):
        matrix[size.position + k, size.velocity + k] = 1.0
        mass = s.motion[k, MOTION_MASS]
        for m in range(size.motions):
            matrix[size.velocity + k, size.position + m] += slopes[0, k, m] / mass
            matrix[size.velocity + k, size.velocity + m] += slopes[1, k, m] / mass


@kernel
def add_contacts(s: SystemArrays, state: Array, matrix: Array) -> None:
    """Derivatives of normal and friction forces of the compliant contacts on the motions."""
    size, values, slopes = s.size, s.contact_values[VALUE], s.contact_values[SLOPE]
    for j in range(size.compliant):
        contact = s.contact[j]
        if contact[CONTACT_FORCE] == 0.0:
            continue
        friction_slope = contact[FRICTION_BY_FORCE]
        for m in range(size.motions):
            gap, slip = values[j, GAP_BY_MOTION + m], values[j, GAP_BY_MOTION + size.motions + m]
            turned = slopes[j, GAP_BY_MOTION + m] * state[1]
            by_place = -contact[FORCE_BY_OVERLAP] * gap - contact[FORCE_BY_RATE] * turned
            by_speed = -contact[FORCE_BY_RATE] * gap
            dragged = friction_slope * by_speed + contact[FRICTION_BY_SLIP] * slip
            for k in range(size.motions):
                normal = values[j, GAP_BY_MOTION + k] / s.motion[k, MOTION_MASS]
                along = values[j, GAP_BY_MOTION + size.motions + k] / s.motion[k, MOTION_MASS]
                row = size.velocity + k
                place, speed = size.position + m, size.velocity + m
                matrix[row, place] += (normal + along * friction_slope) * by_place
                matrix[row, speed] += normal * by_speed + along * dragged


@kernel
def add_elements(s: SystemArrays, state: Array, t: float, matrix: Array) -> None:
    """Derivatives of the flows of circuit elements with respect to the pressures at their ends."""
    node, size = s.node, s.size
    update_elements(s, state, t)
    for j in range(s.elements.shape[0]):
        element = s.elements[j]
        if element[ELEMENT_KIND] == FLUID_COLUMN:
            add_column(s, state, j, matrix)
            continue
        a, b = int(element[ELEMENT_A]), int(element[ELEMENT_B])
        gas = node[a, GAS] if element[ELEMENT_FLOW] >= 0.0 else node[b, GAS]
        for i, slope in ((a, element[ELEMENT_BY_A]), (b, element[ELEMENT_BY_B])):
            d = s.dynamic_index[i]
            if d < 0:
                continue
            for column, by_state in (
                (size.mass + d, node[i, PRESSURE_BY_MASS]),
                (size.gas + d, node[i, PRESSURE_BY_GAS]),
            ):
                change = slope * by_state
                matrix[mass_row(s, a), column] -= change
                matrix[mass_row(s, b), column] += change
                matrix[gas_row(s, a), column] -= gas * change
                matrix[gas_row(s, b), column] += gas * change
