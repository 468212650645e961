"""Drag through the tip gaps: a smooth disc in a bore, centred and off centre."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np

import toothspace as ts
from tests.iteration_matrices import jacobian_of, slope_of_rates
from toothspace.api import fluid_of
from toothspace.model.arrays import DRAG, HEIGHT, PRESENT_B
from toothspace.model.assembly import System, assemble
from toothspace.run.condition import condition_of
from toothspace.solver.compiled_model import evaluate_state
from toothspace.solver.cyclic import RunPlan, march_revolutions
from toothspace.solver.initial import start_state

PUMP = Path(__file__).resolve().parents[2] / "cases" / "egm12_pump.toml"


@cache
def pump() -> System:
    """The 12-tooth pump without running-in and with the same pressure at both ports."""
    point = (
        'operating_point.outlet_pressure="1 bar"',
        "operating_point.outlet_load=fixed_pressure",
        'machine.casing.outlet_angle="55 deg"',  # tips seal over most of the turn
    )
    case = ts.load_case(PUMP, point)
    description = ts.describe(case)
    return assemble(description, fluid_of(case), condition_of(case, description))


def tip_flows(system: System, shift: float) -> tuple[np.ndarray, np.ndarray]:
    """Drag flows towards the space ahead and heights of the drive gear's tip gaps.

    The gear is shifted along y. [m3/s], [m]
    """
    arrays = system.arrays
    state = start_state(system)
    motion = [system.description.motions[k] for k in system.free_motions]
    column = next(
        k
        for k, m in enumerate(motion)
        if (m.body, m.axis) == (system.description.bodies[0].name, "y")
    )
    state[arrays.size.position : arrays.size.velocity] = 0.0
    state[arrays.size.position + column] = shift
    evaluate_state(arrays, state)
    chambers = system.description.families[0].count
    index = arrays.path_index
    tips = [
        j for j in range(arrays.size.paths) if is_tip(system, j) and index[j, PRESENT_B] < chambers
    ]
    rows = np.flatnonzero(np.isin(arrays.paths.open[: arrays.paths.open[-1]], tips))
    heights = arrays.path[rows, HEIGHT]
    sealing = arrays.path_values[rows, 1] > 0.0
    drag = arrays.path[rows, DRAG] * system.condition.shaft_speed
    return drag[sealing], heights[sealing]


def is_tip(system: System, row: int) -> bool:
    rows = np.concatenate(
        [np.full(p.count, p.category.name == "tooth_tip") for p in system.description.paths]
    )
    return bool(rows[row])


def test_smooth_disc_carries_half_the_wall_speed_forward() -> None:
    """Chambers end at the tip circle: b u h / 2 in the sense of rotation."""
    system = pump()
    flows, heights = tip_flows(system, 0.0)
    speed = system.condition.shaft_speed * 0.5 * 40.372e-3
    assert np.allclose(flows, 7.5e-3 * 0.5 * speed * heights, rtol=2e-3)


def test_off_centre_disc_makes_one_reynolds_wedge() -> None:
    """The part of the gap that motion opens moves with the tooth: b u (h0 - dh) / 2."""
    flows, heights = tip_flows(pump(), 5e-6)
    speed = pump().condition.shaft_speed * 0.5 * 40.372e-3
    nominal, centred = tip_flows(pump(), 0.0)
    opened = heights - centred
    assert np.ptp(opened) > 5e-6
    assert np.allclose(flows, nominal - 7.5e-3 * 0.5 * speed * opened, rtol=5e-3)


def test_jacobian_of_a_gear_machine_is_the_derivative_of_its_rates() -> None:
    system = pump()
    size = system.arrays.size
    state = march_revolutions(system, RunPlan(revolutions=1, samples_per_revolution=36)).states[17]
    matrix = jacobian_of(system, state)
    mass = state[size.mass]
    steps = np.repeat(
        (1e-7 * mass, 1e-11 * mass, 1e-12, 1e-9),
        (size.gas - size.mass, size.gas - size.mass, size.motions, size.motions),
    )
    for column, step in zip(range(size.mass, size.core), steps, strict=True):
        expected = slope_of_rates(system, state, column, step)
        scale = np.abs(expected).max() + 1e-6
        assert np.abs(matrix[: size.core, column] - expected).max() < 2e-3 * scale
