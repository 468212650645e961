r"""Mass flows along all flow paths.

Every path obeys one law, laminar at small and inertial at large flow, plus wall drag:

.. math::

    \Delta p = \frac{Q_p}{G} + \frac{\rho}{2 (C A)^2} Q_p |Q_p|, \qquad
    \dot m = \rho_{up} (Q_p + w h\, u\, \omega) .

Chamber volumes end at the tip circle of bodies at rest but follow their micro-motion up to
the casing, so at a tooth tip the part of the gap that motion opens moves with the tooth: the
drag there is :math:`w (u h - U \delta h)\, \omega` with the tooth speed U = 2 u. A smooth
disc then pumps half its surface speed times the gap, eccentric or not.

The discharge coefficient C is 0.7 at sharp edges (ports, grooves, tip lands) and 1 in the
smooth throat between two flanks, where one dynamic head is lost behind the throat.

The fluid carries the density and gas content of the node that it leaves. The power lost in
a path is the drop of enthalpy flow plus the work of the dragging walls against pressure.
"""

from __future__ import annotations

import math

from toothspace.closures.gap_flow import curved_gap_conductance, parallel_gap_conductance
from toothspace.closures.orifice import inertial_laminar_flow, orifice_conductance
from toothspace.closures.viscosity import dynamic_viscosity, throttling_viscosity
from toothspace.core.compiled import kernel, merged
from toothspace.core.types import Array
from toothspace.model.arrays import (
    CARRIED_SHARE,
    CATEGORY,
    DENSITY,
    DRAG,
    DRAG_SPEED,
    DROP,
    FAMILY_COUNT,
    FAMILY_FIRST,
    FLOW,
    FLOW_BY_HEIGHT,
    FLOW_BY_PRESSURE,
    GAS,
    GAS_ENTHALPY,
    GAS_RATE,
    GEOMETRY,
    HEIGHT,
    HEIGHT_BY_MOTION,
    KIND,
    LIQUID_ENTHALPY,
    LOSS,
    MASS_RATE,
    MINIMUM_HEIGHT,
    MULTIPLICITY,
    NODE_A,
    NODE_B,
    PARTNER_SHIFT,
    PRESENT_B,
    PRESSURE,
    ROOT_VISCOSITY,
    SHEAR,
    SHEAR_SPEED,
    THROAT_SPEED,
    VOLUME_FLOW,
    SystemArrays,
)
from toothspace.model.ledger import THROTTLING
from toothspace.model.tables import CLOSED

ORIFICE, PARALLEL_GAP, CURVED_GAP = 0, 1, 2
SHARP_EDGE = 0.7
SMOOTH_THROAT = 1.0
HEIGHT_SMOOTHING = 1e-7
CLOSED_ORIFICE = 1e-12
CLOSED_GAP = 1e-7


@kernel
def update_partners(s: SystemArrays) -> None:
    """Set the present partner of every path: tooth pairing moves on with unequal counts."""
    index, turns = s.path_index, s.paths.turns
    for j in range(s.size.paths):
        partner = index[j, NODE_B]
        if index[j, PARTNER_SHIFT] != 0:
            first, count = index[j, FAMILY_FIRST], index[j, FAMILY_COUNT]
            partner = first + (partner - first + turns[j] * index[j, PARTNER_SHIFT]) % count
        index[j, PRESENT_B] = partner


@kernel
def close_paths(s: SystemArrays) -> None:
    """Let nothing flow through the paths that are closed at the present angle."""
    path = s.path
    for j in range(s.size.paths):
        if s.paths.closed[j] == CLOSED:
            for column in range(path.shape[1]):
                path[j, column] = 0.0


@kernel
def running_height(nominal: float, residual: float) -> tuple[float, float]:
    """Gap height and its slope; it keeps its residual where bodies would touch. [m], [-]."""
    excess = nominal - residual
    root = math.sqrt(excess * excess + 4.0 * HEIGHT_SMOOTHING * HEIGHT_SMOOTHING)
    return residual + 0.5 * (excess + root), 0.5 * (1.0 + excess / root)


@kernel
def gap_conductance(
    kind: int, height: float, width: float, extent: float, viscosity: float
) -> tuple[float, float]:
    """Laminar conductance of a gap and its derivative with respect to the height."""
    if kind == PARALLEL_GAP:
        conductance = parallel_gap_conductance(height, width, extent, viscosity)
        return conductance, 3.0 * conductance / height
    conductance = curved_gap_conductance(height, width, extent, viscosity)
    return conductance, 2.5 * conductance / height


@kernel
def update_gap_heights(s: SystemArrays, state: Array) -> None:
    """Nominal heights of all gaps with the present positions of the bodies."""
    values, path, index, size, free = s.path_values, s.path, s.path_index, s.size, s.paths.open
    for entry in range(free[-1]):
        j = free[entry]
        if index[j, KIND] == ORIFICE or values[j, 1] <= CLOSED_GAP:
            continue
        height = values[j, GEOMETRY]
        for k in range(size.motions):
            height += values[j, HEIGHT_BY_MOTION + k] * state[size.position + k]
        path[j, HEIGHT] = height


@kernel
def update_viscosities(s: SystemArrays) -> None:
    """Square root of the viscosity at every node: a path sees the geometric mean of its ends."""
    node, fluid = s.node, s.fluid
    for i in range(s.size.nodes):
        node[i, ROOT_VISCOSITY] = math.sqrt(dynamic_viscosity(node[i, PRESSURE], fluid))


@kernel
def update_flows(s: SystemArrays, speed: float) -> None:
    """Flow of every path from the pressures at its ends and its gap, with derivatives."""
    node, path, values, index = s.node, s.path, s.path_values, s.path_index
    data, fluid, free = s.path_data, s.fluid, s.paths.open
    for entry in range(free[-1]):
        j = free[entry]
        kind = index[j, KIND]
        first, second, third = values[j, 0], values[j, 1], values[j, 2]
        if (kind == ORIFICE and first <= CLOSED_ORIFICE) or (
            kind != ORIFICE and second <= CLOSED_GAP
        ):
            path[j, :] = 0.0
            continue
        a, b = index[j, NODE_A], index[j, PRESENT_B]
        drop = node[a, PRESSURE] - node[b, PRESSURE]
        density = node[a, DENSITY] if drop >= 0.0 else node[b, DENSITY]
        viscosity = node[a, ROOT_VISCOSITY] * node[b, ROOT_VISCOSITY]
        if kind == CURVED_GAP:
            upstream = max(node[a, PRESSURE], node[b, PRESSURE])
            viscosity = throttling_viscosity(upstream, abs(drop), fluid)
        many = data[j, MULTIPLICITY]
        drag, by_height, drag_by_height = 0.0, 0.0, 0.0
        if kind == ORIFICE:
            conductance = orifice_conductance(first, second, viscosity)
            area = first
            discharge = SHARP_EDGE
        else:
            height, factor = running_height(path[j, HEIGHT], data[j, MINIMUM_HEIGHT])
            conductance, by_height = gap_conductance(kind, height, second, third, viscosity)
            area = second * height
            discharge = SMOOTH_THROAT if kind == CURVED_GAP else SHARP_EDGE
            by_height *= factor
            carried = second * data[j, THROAT_SPEED]
            dragged = area - second * data[j, CARRIED_SHARE] * first
            drag = dragged * values[j, DRAG_SPEED] - carried * (path[j, HEIGHT] - first)
            drag_by_height = (second * values[j, DRAG_SPEED] * factor - carried) * speed
            shear = values[j, SHEAR_SPEED] ** 2 * second * third / height
            path[j, SHEAR] = many * viscosity * speed * shear
        flow, by_pressure, by_conductance = inertial_laminar_flow(
            drop, conductance, discharge * area, density
        )
        path[j, VOLUME_FLOW] = many * (flow + drag * speed)
        path[j, FLOW_BY_PRESSURE] = many * by_pressure
        path[j, FLOW_BY_HEIGHT] = many * (by_conductance * by_height + drag_by_height)
        path[j, DRAG] = many * drag
        path[j, DROP] = drop


@kernel
def sum_flows(s: SystemArrays) -> None:
    """Mass and gas flows of all paths, summed into the nodes."""
    node, path, index, free = s.node, s.path, s.path_index, s.paths.open
    for i in range(s.size.nodes):
        node[i, MASS_RATE] = 0.0
        node[i, GAS_RATE] = 0.0
    for entry in range(free[-1]):
        j = free[entry]
        flow = path[j, VOLUME_FLOW]
        if flow == 0.0:
            path[j, FLOW] = 0.0
            continue
        a, b = index[j, NODE_A], index[j, PRESENT_B]
        source = a if flow > 0.0 else b
        mass_flow = node[source, DENSITY] * flow
        gas_flow = mass_flow * node[source, GAS]
        path[j, FLOW] = mass_flow
        node[a, MASS_RATE] -= mass_flow
        node[b, MASS_RATE] += mass_flow
        node[a, GAS_RATE] -= gas_flow
        node[b, GAS_RATE] += gas_flow


@kernel
def shift_flows(s: SystemArrays) -> None:
    """Move the flows of all paths linearly to the present pressures."""
    node, path, index, free = s.node, s.path, s.path_index, s.paths.open
    for entry in range(free[-1]):
        j = free[entry]
        if path[j, FLOW] == 0.0:
            continue
        a, b = index[j, NODE_A], index[j, PRESENT_B]
        change = node[a, PRESSURE] - node[b, PRESSURE] - path[j, DROP]
        path[j, DROP] += change
        path[j, VOLUME_FLOW] += path[j, FLOW_BY_PRESSURE] * change
        source = a if path[j, VOLUME_FLOW] > 0.0 else b
        path[j, FLOW] = node[source, DENSITY] * path[j, VOLUME_FLOW]


@merged
def update_network(s: SystemArrays, state: Array) -> None:
    """Flows of all paths and their sums in the nodes."""
    update_viscosities(s)
    update_gap_heights(s, state)
    update_flows(s, state[1])
    sum_flows(s)


@kernel
def book_throttling(s: SystemArrays, speed: float, ledger: Array) -> float:
    """Add the power lost in every path to its category; return the torque of wall drag. [N m]."""
    node, path, index, free = s.node, s.path, s.path_index, s.paths.open
    torque = 0.0
    for entry in range(free[-1]):
        j = free[entry]
        flow = path[j, FLOW]
        if flow == 0.0:
            continue
        a, b = index[j, NODE_A], index[j, PRESENT_B]
        gas = node[a, GAS] if flow > 0.0 else node[b, GAS]
        drop = (1.0 - gas) * (node[a, LIQUID_ENTHALPY] - node[b, LIQUID_ENTHALPY])
        drop += gas * (node[a, GAS_ENTHALPY] - node[b, GAS_ENTHALPY])
        wall = path[j, DRAG] * (node[b, PRESSURE] - node[a, PRESSURE])
        path[j, LOSS] = flow * drop + wall * speed
        ledger[THROTTLING + index[j, CATEGORY]] += path[j, LOSS]
        torque += wall
    return torque
