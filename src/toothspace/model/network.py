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
smooth throat between two flanks, where one dynamic head is lost behind the throat. A throat
that is wide against the radius of its walls is an opening.

The fluid carries the density and gas content of the node that it leaves. The power lost in
a path is the drop of enthalpy flow plus the work of the dragging walls against pressure.
"""

from __future__ import annotations

import math

from toothspace.closures.gap_flow import (
    FITTED_POWER,
    NARROW,
    curved_gap_conductance,
    fitted_gap_conductance,
    land_shear_torque,
    parallel_gap_conductance,
    wall_drag_flow_rate,
)
from toothspace.closures.orifice import (
    DISCHARGE_COEFFICIENT,
    inertial_laminar_flow,
    orifice_conductance,
)
from toothspace.closures.viscosity import dynamic_viscosity, throttling_viscosity
from toothspace.core.compiled import kernel, merged
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.arrays import SystemArrays
from toothspace.model.carried_flows import carried_flow, carries, line_of_flow
from toothspace.model.lateral_table import HEIGHT_RATIO
from toothspace.model.ledger import THROTTLING

SMOOTH_THROAT = 1.0
HEIGHT_SMOOTHING = 0.1
LEAST_ROUNDING = 1e-9
CLOSED_ORIFICE = 1e-12
CLOSED_GAP = 1e-7


@kernel
def update_partners(s: SystemArrays) -> None:
    """Set the present partner of every path: tooth pairing moves on with unequal counts."""
    index, turns = s.path_index, s.paths.turns
    for j in range(s.size.paths):
        partner = index[j, col.NODE_B]
        if index[j, col.PARTNER_SHIFT] != 0:
            first, count = index[j, col.FAMILY_FIRST], index[j, col.FAMILY_COUNT]
            partner = first + (partner - first + turns[j] * index[j, col.PARTNER_SHIFT]) % count
        index[j, col.PRESENT_B] = partner


@kernel
def gather_open(s: SystemArrays) -> None:
    """Set out the paths that are open at the present angle, with nothing known of them yet."""
    free = s.paths.open
    for column in range(s.path.shape[1]):
        for j in range(free[-1]):
            s.path[j, column] = 0.0
    for column in range(s.path_values.shape[1]):
        for j in range(free[-1]):
            s.path_values[j, column] = 0.0
    for column in (col.CATEGORY, col.NODE_A, col.PRESENT_B):
        for j in range(free[-1]):
            s.open_index[j, column] = s.path_index[free[j], column]
    for column in range(s.path_data.shape[1]):
        for j in range(free[-1]):
            s.open_data[j, column] = s.path_data[free[j], column]
    for kind in range(s.kinds.size):
        first = s.kinds[kind]
        s.open_kinds[kind] = s.paths.seat[first] if first < s.size.paths else free[-1]


@kernel
def running_height(nominal: float, residual: float) -> tuple[float, float]:
    """Gap height and its slope; it keeps its residual where bodies would touch. [m], [-]."""
    excess, rounding = nominal - residual, max(HEIGHT_SMOOTHING * residual, LEAST_ROUNDING)
    root = math.sqrt(excess * excess + 4.0 * rounding * rounding)
    return residual + 0.5 * (excess + root), 0.5 * (1.0 + excess / root)


@kernel
def update_viscosities(s: SystemArrays) -> None:
    """Square root of the viscosity at every node: a path sees the geometric mean of its ends."""
    node, fluid = s.node, s.fluid
    for i in range(s.size.nodes):
        node[i, col.ROOT_VISCOSITY] = math.sqrt(dynamic_viscosity(node[i, col.PRESSURE], fluid))


@kernel
def update_ends(s: SystemArrays) -> None:
    """Pressure drop along every open path, and density and viscosity of what flows in it."""
    node, path, index = s.node, s.path, s.open_index
    for j in range(s.paths.open[-1]):
        a, b = index[j, col.NODE_A], index[j, col.PRESENT_B]
        drop = node[a, col.PRESSURE] - node[b, col.PRESSURE]
        path[j, col.DROP] = drop
        path[j, col.INFLOW_DENSITY] = node[a, col.DENSITY] if drop >= 0.0 else node[b, col.DENSITY]
        mean = node[a, col.ROOT_VISCOSITY] * node[b, col.ROOT_VISCOSITY]
        path[j, col.MEAN_VISCOSITY] = s.open_data[j, col.GAP_VISCOSITY] * mean


@kernel
def update_throat_viscosity(s: SystemArrays) -> None:
    """Viscosity in the throats between flanks, lowered by the friction heat of their flow."""
    node, path, index, fluid = s.node, s.path, s.open_index, s.fluid
    for j in range(s.open_kinds[col.PARALLEL_GAP]):
        a, b = index[j, col.NODE_A], index[j, col.PRESENT_B]
        # viscosity grows with pressure: the larger one is that upstream
        root = max(node[a, col.ROOT_VISCOSITY], node[b, col.ROOT_VISCOSITY])
        drop = abs(path[j, col.DROP])
        path[j, col.MEAN_VISCOSITY] = throttling_viscosity(root * root, drop, fluid)


@kernel
def update_heights(s: SystemArrays, state: Array) -> None:
    """Heights of all gaps with the present positions of the bodies, nominal and running."""
    values, path, residual = s.path_values, s.path, s.open_data[:, col.MINIMUM_HEIGHT]
    gaps = s.open_kinds[col.ORIFICE]
    widened = s.lateral.now[HEIGHT_RATIO] - 1.0
    for j in range(gaps):
        nominal = values[j, col.GEOMETRY] * (1.0 + s.open_data[j, col.LATERAL_SHARE] * widened)
        path[j, col.HEIGHT] = path[j, col.NOMINAL_HEIGHT] = nominal
    for k in range(s.size.motions):
        q = state[s.size.position + k]
        for j in range(gaps):
            path[j, col.HEIGHT] += values[j, col.HEIGHT_BY_MOTION + k] * q
    for j in range(gaps):
        height, factor = running_height(path[j, col.HEIGHT], residual[j])
        path[j, col.RUNNING_HEIGHT], path[j, col.HEIGHT_FACTOR] = height, factor


@merged
def note_curved_gap(path: Array, j: int, width: float, found: float, power: float) -> None:
    """Keep the conductance of a gap between curved walls, zero where it is closed."""
    height, conductance = path[j, col.RUNNING_HEIGHT], found if width > CLOSED_GAP else 0.0
    path[j, col.CONDUCTANCE] = conductance
    path[j, col.OPENING] = SMOOTH_THROAT * width * height
    path[j, col.BY_HEIGHT] = power * conductance / height * path[j, col.HEIGHT_FACTOR]


@kernel
def update_gap_conductances(s: SystemArrays) -> None:
    """Laminar conductance of all gaps and its derivative with respect to the height."""
    path, values, kinds = s.path, s.path_values, s.open_kinds
    fitted, parallel, gaps = kinds[col.FITTED_GAP], kinds[col.PARALLEL_GAP], kinds[col.ORIFICE]
    for j in range(fitted):
        width, height = values[j, 1], path[j, col.RUNNING_HEIGHT]
        radius = values[j, 2] if width > CLOSED_GAP else 1.0
        found = curved_gap_conductance(height, width, radius, path[j, col.MEAN_VISCOSITY])
        power = 2.5 if height < NARROW * radius else 2.0
        note_curved_gap(path, j, width, found, power)
    for j in range(fitted, parallel):
        width, height = values[j, 1], path[j, col.RUNNING_HEIGHT]
        radius = values[j, 2] if width > CLOSED_GAP else 1.0
        found = fitted_gap_conductance(height, width, radius, path[j, col.MEAN_VISCOSITY])
        power = FITTED_POWER if height < NARROW * radius else 2.0
        note_curved_gap(path, j, width, found, power)
    for j in range(parallel, gaps):
        width, height = values[j, 1], path[j, col.RUNNING_HEIGHT]
        length = values[j, 2] if width > CLOSED_GAP else 1.0
        found = parallel_gap_conductance(height, width, length, path[j, col.MEAN_VISCOSITY])
        conductance = found if width > CLOSED_GAP else 0.0
        path[j, col.CONDUCTANCE] = conductance
        path[j, col.OPENING] = DISCHARGE_COEFFICIENT * width * height
        path[j, col.BY_HEIGHT] = 3.0 * conductance / height * path[j, col.HEIGHT_FACTOR]


@kernel
def update_orifice_conductances(s: SystemArrays) -> None:
    """Laminar conductance of all orifices."""
    path, values = s.path, s.path_values
    for j in range(s.open_kinds[col.ORIFICE], s.paths.open[-1]):
        area = values[j, 0]
        found = orifice_conductance(area, values[j, 1], path[j, col.MEAN_VISCOSITY])
        path[j, col.CONDUCTANCE] = found if area > CLOSED_ORIFICE else 0.0
        path[j, col.OPENING] = DISCHARGE_COEFFICIENT * area


@kernel
def drag_walls(s: SystemArrays, speed: float) -> None:
    """Flow dragged by the walls of all gaps, and the torque of their shear."""
    path, values, data = s.path, s.path_values, s.open_data
    for j in range(s.open_kinds[col.ORIFICE]):
        many, wall = data[j, col.MULTIPLICITY], values[j, col.DRAG_SPEED]
        width = values[j, 1] if values[j, 1] > CLOSED_GAP else 0.0
        nominal, height = path[j, col.NOMINAL_HEIGHT], path[j, col.RUNNING_HEIGHT]
        dragged, throat = height - data[j, col.CARRIED_SHARE] * nominal, data[j, col.THROAT_SPEED]
        opened = path[j, col.HEIGHT] - nominal
        path[j, col.DRAG] = many * wall_drag_flow_rate(dragged, width, wall, opened, throat)
        by_height = width * wall * path[j, col.HEIGHT_FACTOR] - width * throat
        path[j, col.DRAG_BY_HEIGHT] = by_height * speed
        wall, viscosity = values[j, col.SHEAR_SPEED], path[j, col.MEAN_VISCOSITY]
        torque = land_shear_torque(speed, wall, height, width, values[j, 2], viscosity)
        path[j, col.SHEAR] = many * torque


@kernel
def update_flows(s: SystemArrays, speed: float) -> None:
    """Flow of every path from the pressures at its ends and its gap, with derivatives."""
    path, data = s.path, s.open_data
    for j in range(s.paths.open[-1]):
        many = data[j, col.MULTIPLICITY]
        flow, by_pressure, by_conductance = inertial_laminar_flow(
            path[j, col.DROP],
            path[j, col.CONDUCTANCE],
            path[j, col.OPENING],
            path[j, col.INFLOW_DENSITY],
        )
        path[j, col.VOLUME_FLOW] = many * flow + path[j, col.DRAG] * speed
        path[j, col.SENSE] = path[j, col.VOLUME_FLOW]
        path[j, col.FLOW_BY_PRESSURE] = many * by_pressure
        by_height = by_conductance * path[j, col.BY_HEIGHT] + path[j, col.DRAG_BY_HEIGHT]
        path[j, col.FLOW_BY_HEIGHT] = many * by_height
    if carries(s):
        update_carried_flows(s, speed)


@kernel
def update_carried_flows(s: SystemArrays, speed: float) -> None:
    """Flow of every path on the tangent at the flow of the linear equations."""
    path, data = s.path, s.open_data
    for j in range(s.paths.open[-1]):
        if path[j, col.CONDUCTANCE] > 0.0:
            many, drag = data[j, col.MULTIPLICITY], path[j, col.DRAG] * speed
            linear = carried_flow(s, j, many, drag)
            flow, by_pressure = line_of_flow(s, j, linear)
            path[j, col.LINE_FLOW], path[j, col.LINE_SLOPE] = flow, by_pressure
            path[j, col.LINE_DROP] = path[j, col.DROP]
            path[j, col.SENSE] = many * linear + drag
            path[j, col.VOLUME_FLOW] = many * flow + drag
            path[j, col.FLOW_BY_PRESSURE] = many * by_pressure


@kernel
def sum_flows(s: SystemArrays) -> None:
    """Mass and gas flows of all paths, summed into the nodes."""
    node, path, index = s.node, s.path, s.open_index
    for i in range(s.size.nodes):
        node[i, col.MASS_RATE] = 0.0
        node[i, col.GAS_RATE] = 0.0
    for j in range(s.paths.open[-1]):
        flow = path[j, col.VOLUME_FLOW]
        if flow == 0.0:
            path[j, col.FLOW] = 0.0
            continue
        a, b = index[j, col.NODE_A], index[j, col.PRESENT_B]
        source = a if path[j, col.SENSE] > 0.0 else b
        mass_flow = node[source, col.DENSITY] * flow
        gas_flow = mass_flow * node[source, col.GAS]
        path[j, col.FLOW] = mass_flow
        node[a, col.MASS_RATE] -= mass_flow
        node[b, col.MASS_RATE] += mass_flow
        node[a, col.GAS_RATE] -= gas_flow
        node[b, col.GAS_RATE] += gas_flow


@kernel
def shift_flows(s: SystemArrays) -> None:
    """Move the flows of all paths linearly to the present pressures, and keep them."""
    node, path, index = s.node, s.path, s.open_index
    for j in range(s.paths.open[-1]):
        if path[j, col.FLOW] == 0.0:
            continue
        a, b = index[j, col.NODE_A], index[j, col.PRESENT_B]
        change = node[a, col.PRESSURE] - node[b, col.PRESSURE] - path[j, col.DROP]
        path[j, col.DROP] += change
        path[j, col.VOLUME_FLOW] += path[j, col.FLOW_BY_PRESSURE] * change
        path[j, col.LAST_FLOW] = path[j, col.VOLUME_FLOW]
        source = a if path[j, col.VOLUME_FLOW] > 0.0 else b
        path[j, col.FLOW] = node[source, col.DENSITY] * path[j, col.VOLUME_FLOW]


@merged
def update_network(s: SystemArrays, state: Array) -> None:
    """Flows of all paths and their sums in the nodes."""
    update_viscosities(s)
    update_ends(s)
    update_throat_viscosity(s)
    update_heights(s, state)
    update_gap_conductances(s)
    update_orifice_conductances(s)
    drag_walls(s, state[1])
    update_flows(s, state[1])
    sum_flows(s)


@kernel
def book_throttling(s: SystemArrays, speed: float, ledger: Array) -> float:
    """Add the power lost in every path to its category; return the torque of wall drag. [N m]."""
    node, path, index = s.node, s.path, s.open_index
    torque = 0.0
    for j in range(s.paths.open[-1]):
        flow = path[j, col.FLOW]
        if flow == 0.0:
            path[j, col.LOSS] = 0.0
            continue
        a, b = index[j, col.NODE_A], index[j, col.PRESENT_B]
        gas = node[a, col.GAS] if flow > 0.0 else node[b, col.GAS]
        drop = (1.0 - gas) * (node[a, col.LIQUID_ENTHALPY] - node[b, col.LIQUID_ENTHALPY])
        drop += gas * (node[a, col.GAS_ENTHALPY] - node[b, col.GAS_ENTHALPY])
        wall = path[j, col.DRAG] * (node[b, col.PRESSURE] - node[a, col.PRESSURE])
        path[j, col.LOSS] = flow * drop + wall * speed
        ledger[THROTTLING + index[j, col.CATEGORY]] += path[j, col.LOSS]
        torque += wall
    return torque
