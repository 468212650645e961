"""Checks of the Jacobian and of the matrices that the iteration of the integrator is given."""

import numpy as np

from tests.reference_formulas.full_jacobian import iteration_matrices
from toothspace.core.types import Array
from toothspace.model.assembly import System
from toothspace.model.system import right_hand_side


def slope_of_rates(system: System, state: Array, column: int, step: float) -> Array:
    """Central difference of all rates by one state."""
    rates = np.zeros((2, system.arrays.size.total))
    for rate, sign in zip(rates, (1.0, -1.0), strict=True):
        moved = state.copy()
        moved[column] += sign * step
        right_hand_side(0.0, moved, system.arrays, rate)
    return np.asarray((rates[0] - rates[1]) / (2.0 * step))


def assert_within_patterns(system: System, state: Array) -> None:
    """Derivatives by the unknowns and their basis are nought where elimination expects it."""
    matrix, basis = iteration_matrices(0.0, state, system.arrays)
    assert not np.any(matrix[~system.pattern])
    assert not np.any(basis[~system.basis])
