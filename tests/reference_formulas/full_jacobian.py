"""Full Jacobian of the right-hand side from the matrices of the iteration."""

from __future__ import annotations

import numpy as np

from toothspace.core.types import Array
from toothspace.model.arrays import (
    EXCHANGE_BY_GAS,
    EXCHANGE_RATE,
    FLOW,
    GAS,
    NODE_A,
    PRESENT_B,
    SystemArrays,
)
from toothspace.model.jacobian import add_flow_change, fill_jacobian
from toothspace.solver.compiled_model import evaluate_state


def jacobian(t: float, state: Array, s: SystemArrays) -> Array:
    """Derivatives of all rates with respect to the core states; energy rows are left out."""
    matrix, basis = iteration_matrices(t, state, s)
    full = np.asarray(matrix @ np.linalg.inv(basis))
    add_composition(s, state, full)
    return full


def iteration_matrices(t: float, state: Array, s: SystemArrays) -> tuple[Array, Array]:
    """Derivatives by the unknowns of the iteration, and the basis of these."""
    matrix, basis = np.zeros((s.size.total, s.size.core)), np.eye(s.size.core)
    evaluate_state(s, state)
    fill_jacobian(t, state, s, matrix, basis)
    return matrix, basis


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
