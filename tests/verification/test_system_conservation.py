"""Mass and energy close, and the Jacobian is the derivative, on a machine with closed tables."""

from __future__ import annotations

import numpy as np
import pytest

from tests.iteration_matrices import jacobian_of, slope_of_rates
from tests.reference_formulas.full_jacobian import jacobian
from tests.toy_machine import toy_machine
from toothspace.model.assembly import System, assemble
from toothspace.model.fluid import GasModel, fluid_law
from toothspace.model.operating_point import OperatingCondition
from toothspace.solver.cyclic import RunPlan, march_revolutions
from toothspace.solver.initial import start_state
from toothspace.solver.outcome import window_ledger

PLAN = RunPlan(revolutions=3, samples_per_revolution=180)


def toy_system(load_area: float = 0.0, tolerance: float = 1e-6) -> System:
    fluid = fluid_law("iso_vg_46", 323.15, GasModel(dissolved_air_fraction=0.08))
    condition = OperatingCondition(
        shaft_speed=157.0,
        inlet_pressure=1e5,
        outlet_pressure=150e5,
        load_area=load_area,
        relative_tolerance=tolerance,
    )
    return assemble(toy_machine(), fluid, condition)


@pytest.mark.parametrize("load_area", [0.0, 4e-6])
def test_mass_closes_to_round_off_and_energy_to_tolerance(load_area: float) -> None:
    history = march_revolutions(toy_system(load_area), PLAN)
    ledger = window_ledger(history)
    assert ledger.mass_balance_error < 1e-10
    assert ledger.energy_balance_error < 1e-5


def test_jacobian_is_the_derivative_of_the_rates() -> None:
    """Central differences of the core rates, in the error scale of each state."""
    system = toy_system(load_area=4e-6)
    size = system.arrays.size
    state = march_revolutions(system, RunPlan(revolutions=1, samples_per_revolution=36)).states[17]
    matrix = jacobian_of(system, state)
    for column in range(size.mass, size.core):
        step = 1e-7 * (state[size.mass] if column < size.gas else 1e-4 * state[size.mass])
        expected = slope_of_rates(system, state, column, step)
        scale = np.abs(expected).max() + 1e-6
        assert np.abs(matrix[: size.core, column] - expected).max() < 2e-3 * scale


@pytest.mark.slow
def test_jacobian_that_other_integrators_are_given_is_the_same() -> None:
    """The benchmarks hand the compiled derivatives at constant mass to SciPy and SUNDIALS."""
    system = toy_system(load_area=4e-6)
    arrays, size = system.arrays, system.arrays.size
    state = march_revolutions(system, RunPlan(revolutions=1, samples_per_revolution=36)).states[17]
    full = np.zeros((size.total, size.core))
    jacobian(0.0, state, arrays, full)
    near = 1e-12 * np.abs(full).max()
    np.testing.assert_allclose(jacobian_of(system, state), full, rtol=1e-9, atol=near)


def test_start_state_holds_port_pressures() -> None:
    system = toy_system()
    state = start_state(system)
    assert np.all(state[system.arrays.size.mass : system.arrays.size.gas] > 0.0)
