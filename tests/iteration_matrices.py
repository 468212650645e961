"""The matrices that the iteration of the integrator is given, and the Jacobian that they make."""

import numpy as np

from tests.reference_formulas.full_jacobian import add_composition
from toothspace.core.types import Array
from toothspace.model.assembly import System
from toothspace.model.jacobian import fill_jacobian
from toothspace.solver import compiled_model
from toothspace.solver.compiled_model import evaluate_state


def all_rates_of(system: System, state: Array) -> Array:
    """Rates of all states, by the entry that runs use: the model is not compiled again."""
    arrays, rate = system.arrays, np.zeros(system.arrays.size.total)
    out, nothing = compiled_model.empty_observation(arrays, 1), compiled_model._NO_INTEGRATION
    at, states = np.zeros(1), state[None]
    compiled_model._run(compiled_model._OBSERVE, arrays, nothing, out, 0.0, rate, at, states)
    return rate


def rates_of(system: System, state: Array) -> Array:
    """Rates of the core states."""
    return all_rates_of(system, state)[: system.arrays.size.core]


def slope_of_rates(system: System, state: Array, column: int, step: float) -> Array:
    """Central difference of the rates of the core states by one state."""
    moved = np.stack([state, state])
    moved[:, column] += step, -step
    rates = [rates_of(system, each) for each in moved]
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
