"""The matrices that the iteration of the integrator is given, and the Jacobian that they make."""

import numpy as np

from tests.reference_formulas.full_jacobian import add_composition
from toothspace.core.types import Array
from toothspace.model.assembly import System
from toothspace.model.jacobian import fill_jacobian
from toothspace.model.system import right_hand_side
from toothspace.solver.compiled_model import evaluate_state


def slope_of_rates(system: System, state: Array, column: int, step: float) -> Array:
    """Central difference of all rates by one state."""
    rates = np.zeros((2, system.arrays.size.total))
    for rate, sign in zip(rates, (1.0, -1.0), strict=True):
        moved = state.copy()
        moved[column] += sign * step
        right_hand_side(0.0, moved, system.arrays, rate)
    return np.asarray((rates[0] - rates[1]) / (2.0 * step))


def jacobian_of(system: System, state: Array) -> Array:
    """Derivatives of all rates by the core states, from those by the unknowns and their basis.

    Both are nought where the elimination expects it.
    """
    arrays, size = system.arrays, system.arrays.size
    matrix, basis = np.zeros((size.total, size.core)), np.eye(size.core)
    evaluate_state(arrays, state)
    fill_jacobian(0.0, state, arrays, matrix, basis)
    assert not np.any(matrix[~system.pattern])
    assert not np.any(basis[~system.basis])
    full = np.asarray(matrix @ np.linalg.inv(basis))
    add_composition(arrays, state, full)
    return full
