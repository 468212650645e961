"""Checks of the Jacobian and of the matrices that the iteration of the integrator is given."""

import numpy as np

from tests.reference_formulas.full_jacobian import add_composition, jacobian
from toothspace.core.types import Array
from toothspace.model.assembly import System
from toothspace.model.jacobian import fill_jacobian
from toothspace.model.system import right_hand_side


def slope_of_rates(system: System, state: Array, column: int, step: float) -> Array:
    """Central difference of all rates by one state."""
    rates = np.zeros((2, system.arrays.size.total))
    for rate, sign in zip(rates, (1.0, -1.0), strict=True):
        moved = state.copy()
        moved[column] += sign * step
        right_hand_side(0.0, moved, system.arrays, rate)
    return np.asarray((rates[0] - rates[1]) / (2.0 * step))


def assert_iteration_agrees(system: System, state: Array) -> None:
    """Derivatives by the unknowns and their basis make up the Jacobian, within their patterns."""
    size = system.arrays.size
    matrix, full = np.zeros((size.total, size.core)), np.zeros((size.total, size.core))
    basis = np.eye(size.core)
    jacobian(0.0, state, system.arrays, full)
    fill_jacobian(0.0, state, system.arrays, matrix, basis)
    assert not np.any(matrix[~system.pattern])
    assert not np.any(basis[~system.basis])
    expected = matrix @ np.linalg.inv(basis)
    add_composition(system.arrays, state, expected)
    np.testing.assert_allclose(expected, full, rtol=1e-9, atol=1e-12 * np.abs(full).max())
