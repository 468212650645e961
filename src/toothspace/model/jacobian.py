"""Jacobian of the right-hand side, assembled from the derivatives of each element."""

from __future__ import annotations

from toothspace.core.compiled import njit
from toothspace.core.types import Array
from toothspace.model.arrays import SystemArrays
from toothspace.model.chambers import CHANNEL_MOTION, exchange_gas
from toothspace.model.ledger import MASS
from toothspace.model.network import HEIGHT_BY_MOTION
from toothspace.model.system import evaluate


@njit(cache=True)
def jacobian(t: float, state: Array, s: SystemArrays, matrix: Array) -> None:
    """Derivatives of all rates with respect to the core states; energy rows are left out.

    The rows of port masses stand in full, so that mass balances close to round-off.
    """
    evaluate(s, state)
    exchange_gas(s, state)
    matrix[:, :] = 0.0
    matrix[0, 1] = 1.0
    for j in range(s.paths.table.size):
        if s.work.path_flow[j] != 0.0:
            add_path(s, state, j, matrix)
    for node in range(s.size.nodes):
        if s.condition.dynamic_index[node] >= 0:
            add_gas_exchange(s, state, node, matrix)
            add_pressure_force(s, node, matrix)
    add_motions(s, matrix)


@njit(cache=True)
def mass_row(s: SystemArrays, node: int) -> int:
    """Row of the mass balance of a node: a state, or the ledger entry of a fixed port."""
    d = s.condition.dynamic_index[node]
    return s.size.mass + d if d >= 0 else s.size.core + MASS + node - s.size.chambers


@njit(cache=True)
def add_flow_derivative(
    s: SystemArrays, j: int, column: int, mass_change: float, gas_change: float, matrix: Array
) -> None:
    """Add the change of one path's flows with one state to the balances of both its nodes."""
    a, b = s.paths.node_a[j], s.work.path_b[j]
    matrix[mass_row(s, a), column] -= mass_change
    matrix[mass_row(s, b), column] += mass_change
    da, db = s.condition.dynamic_index[a], s.condition.dynamic_index[b]
    if da >= 0:
        matrix[s.size.gas + da, column] -= gas_change
    if db >= 0:
        matrix[s.size.gas + db, column] += gas_change


@njit(cache=True)
def add_path(s: SystemArrays, state: Array, j: int, matrix: Array) -> None:
    """Derivatives of one path's flow through pressures, upstream state and gap height."""
    w = s.work
    a, b = s.paths.node_a[j], w.path_b[j]
    source = a if w.path_volume_flow[j] > 0.0 else b
    gas = w.gas[source]
    slope = w.density[source] * w.path_by_pressure[j]
    for node, sign in ((a, 1.0), (b, -1.0)):
        d = s.condition.dynamic_index[node]
        if d < 0:
            continue
        change = sign * slope * w.pressure_by_mass[node]
        add_flow_derivative(s, j, s.size.mass + d, change, gas * change, matrix)
        change = sign * slope * w.pressure_by_gas[node]
        add_flow_derivative(s, j, s.size.gas + d, change, gas * change, matrix)
    d = s.condition.dynamic_index[source]
    if d >= 0:
        mass = state[s.size.mass + d]
        flow = w.path_flow[j]
        add_flow_derivative(s, j, s.size.mass + d, flow / mass, 0.0, matrix)
        add_flow_derivative(s, j, s.size.gas + d, 0.0, flow / mass, matrix)
    add_path_motions(s, j, gas, slope, matrix)


@njit(cache=True)
def add_path_motions(s: SystemArrays, j: int, gas: float, slope: float, matrix: Array) -> None:
    """Derivatives of one path's flow with respect to the micro-motions."""
    w = s.work
    a, b = s.paths.node_a[j], w.path_b[j]
    source = a if w.path_volume_flow[j] > 0.0 else b
    for k in range(s.size.motions):
        change = 0.0
        if w.path_by_height[j] != 0.0:
            change = w.density[source] * w.path_by_height[j]
            change *= w.path_values[j, HEIGHT_BY_MOTION + k]
        if a < s.size.chambers:
            change += slope * w.pressure_by_volume[a] * w.chamber_values[a, CHANNEL_MOTION + k]
        if b < s.size.chambers:
            change -= slope * w.pressure_by_volume[b] * w.chamber_values[b, CHANNEL_MOTION + k]
        if change != 0.0:
            add_flow_derivative(s, j, s.size.position + k, change, gas * change, matrix)


@njit(cache=True)
def add_gas_exchange(s: SystemArrays, state: Array, node: int, matrix: Array) -> None:
    """Derivatives of gas release and absorption in one node."""
    w = s.work
    d = s.condition.dynamic_index[node]
    row, mass = s.size.gas + d, state[s.size.mass + d]
    rate, by_pressure, by_gas = (
        w.gas_exchange[node, 0],
        w.gas_exchange[node, 1],
        w.gas_exchange[node, 2],
    )
    by_mass = rate - by_gas * w.gas[node] + mass * by_pressure * w.pressure_by_mass[node]
    matrix[row, s.size.mass + d] += by_mass
    matrix[row, s.size.gas + d] += by_gas + mass * by_pressure * w.pressure_by_gas[node]
    if node < s.size.chambers:
        for k in range(s.size.motions):
            by_motion = w.pressure_by_volume[node] * w.chamber_values[node, CHANNEL_MOTION + k]
            matrix[row, s.size.position + k] += mass * by_pressure * by_motion


@njit(cache=True)
def add_pressure_force(s: SystemArrays, node: int, matrix: Array) -> None:
    """Derivatives of the pressure forces on the motions with respect to one chamber's state."""
    if node >= s.size.chambers:
        return
    w = s.work
    d = s.condition.dynamic_index[node]
    for k in range(s.size.motions):
        row = s.size.velocity + k
        area = w.chamber_values[node, CHANNEL_MOTION + k] / s.motions.mass[k]
        matrix[row, s.size.mass + d] += area * w.pressure_by_mass[node]
        matrix[row, s.size.gas + d] += area * w.pressure_by_gas[node]
        for m in range(s.size.motions):
            other = w.chamber_values[node, CHANNEL_MOTION + m]
            matrix[row, s.size.position + m] += area * other * w.pressure_by_volume[node]


@njit(cache=True)
def add_motions(s: SystemArrays, matrix: Array) -> None:
    """Derivatives of the film forces on the motions."""
    for k in range(s.size.motions):
        matrix[s.size.position + k, s.size.velocity + k] = 1.0
        row = s.size.velocity + k
        for m in range(s.size.motions):
            by_position = s.work.film_by_position[k, m] / s.motions.mass[k]
            matrix[row, s.size.position + m] += by_position
            matrix[row, s.size.velocity + m] += s.work.film_by_velocity[k, m] / s.motions.mass[k]
