"""Full Jacobian of the right-hand side, to hold the matrices of the iteration against."""

from __future__ import annotations

from toothspace.core.compiled import inlined
from toothspace.core.types import Array
from toothspace.model.arrays import (
    CHANNEL_MOTION,
    EXCHANGE_BY_GAS,
    EXCHANGE_RATE,
    FLOW,
    GAS,
    NODE_A,
    PRESENT_B,
    PRESSURE_BY_GAS,
    PRESSURE_BY_MASS,
    PRESSURE_BY_VOLUME,
    SystemArrays,
)
from toothspace.model.jacobian import add_flow_change, fill_rates
from toothspace.model.system import evaluate


@inlined
def jacobian(t: float, state: Array, s: SystemArrays, matrix: Array) -> None:
    """Derivatives of all rates with respect to the core states; energy rows are left out."""
    evaluate(s, state)
    fill_rates(t, state, s, matrix)
    _add_pressure_changes(s, matrix)
    add_composition(s, state, matrix)


@inlined
def _add_pressure_changes(s: SystemArrays, matrix: Array) -> None:
    """Turn derivatives at constant pressure into those at constant mass."""
    node, values, size = s.node, s.chamber_values, s.size
    for i in range(size.nodes):
        d = s.dynamic_index[i]
        if d < 0:
            continue
        by_pressure = matrix[:, size.mass + d] / node[i, PRESSURE_BY_MASS]
        matrix[:, size.gas + d] += by_pressure * node[i, PRESSURE_BY_GAS]
        if i < size.chambers:
            by_volume = by_pressure * node[i, PRESSURE_BY_VOLUME]
            for k in range(size.motions):
                matrix[:, size.position + k] += by_volume * values[i, CHANNEL_MOTION + k]


@inlined
def add_composition(s: SystemArrays, state: Array, matrix: Array) -> None:
    """Derivatives through density and gas content at constant pressure, by mass and gas mass."""
    size = s.size
    for j in range(s.paths.open[-1]):
        flow = s.path[j, FLOW]
        source = s.open_index[j, NODE_A] if flow > 0.0 else s.open_index[j, PRESENT_B]
        d = s.dynamic_index[source]
        if d >= 0 and flow != 0.0:
            carried = flow / state[size.mass + d]
            add_flow_change(s, j, size.mass + d, carried, 0.0, matrix)
            add_flow_change(s, j, size.gas + d, 0.0, carried, matrix)
    for i in range(size.nodes):
        d = s.dynamic_index[i]
        if d >= 0:
            by_mass = s.node[i, EXCHANGE_RATE] - s.node[i, EXCHANGE_BY_GAS] * s.node[i, GAS]
            matrix[size.gas + d, size.mass + d] += by_mass
