"""Compliant contacts in the whole model: balances, exact Jacobian, events, walls at the ends."""

from __future__ import annotations

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from tests.contact_machine import RATIO, contact_machine
from tests.iteration_matrices import jacobian_of, slope_of_rates
from toothspace.closures.bearing_map import build_journal_map, journal_force
from toothspace.closures.journal_friction import PUBLISHED
from toothspace.model.arrays import (
    CHANNEL_MOTION,
    FILM_FORCE,
    LEAST_VOLUME,
    PRESSURE,
    PRESSURE_FORCE,
    VOLUME,
)
from toothspace.model.assembly import System, assemble
from toothspace.model.bodies import CREEP_SPEED, journal_torques
from toothspace.model.fluid import GasModel, fluid_law
from toothspace.model.operating_point import OperatingCondition
from toothspace.solver.compiled_model import evaluate_state, observe
from toothspace.solver.cyclic import History, RunPlan, march_revolutions
from toothspace.solver.initial import start_state
from toothspace.solver.outcome import window_ledger

PLAN = RunPlan(revolutions=3, samples_per_revolution=360)
STEPS = {"x": 1e-10, "y": 1e-10, "rotation": 1e-8}


def ring_system(**pair: Any) -> System:
    fluid = fluid_law("iso_vg_46", 323.15, GasModel(dissolved_air_fraction=0.08))
    condition = OperatingCondition(
        shaft_speed=157.0,
        inlet_pressure=1e5,
        outlet_pressure=150e5,
        relative_tolerance=1e-6,
    )
    return assemble(contact_machine(**pair), fluid, condition)


@pytest.fixture(scope="module")
def history() -> History:
    return march_revolutions(ring_system(), PLAN)


def test_mass_closes_to_round_off_and_energy_to_tolerance(history: History) -> None:
    """With elastic energy stored, damping and friction lost, and curvature that varies."""
    ledger = window_ledger(history)
    assert ledger.mass_balance_error < 1e-10
    assert ledger.energy_balance_error < 1e-5
    assert ledger.energy["contact_friction"] > 100.0 * ledger.energy_balance_error
    assert ledger.energy["contact_damping"] > 0.0


@pytest.mark.parametrize("law", ["johnson", "pereira", "linear"])
def test_energy_closes_with_every_law(law: str) -> None:
    system = ring_system(law=law, structure_stiffness=2e8 if law == "linear" else np.inf)
    assert window_ledger(march_revolutions(system, PLAN)).energy_balance_error < 1e-5


def test_contacts_hand_the_load_over(history: History) -> None:
    """Each lobe carries once a turn, one or two at a time; no hand-over without events."""
    force = observe(history.system.arrays, history.states).contact_force
    assert np.all(force.max(axis=1) > 0.0)
    assert np.all(np.count_nonzero(force > 0.0, axis=1) <= 2)
    assert np.all(force.max(axis=0) > 0.0)
    assert {event.kind for event in history.events} == {"contact_made", "contact_lost"}
    made = {event.label for event in history.events if event.kind == "contact_made"}
    assert len(made) >= 2


def test_events_are_told_where_contacts_begin_and_cease_to_carry(history: History) -> None:
    """The force of the contact that is named vanishes before or after, within a sample."""
    force = observe(history.system.arrays, history.states).contact_force
    speed, labels = history.system.condition.shaft_speed, list(history.system.contact_labels)
    told = [event for event in history.events if event.time > history.times[1]]
    assert len(told) >= 2
    for event in told:
        assert event.shaft_angle == pytest.approx(speed * event.time, rel=1e-12)
        after = int(np.searchsorted(history.times, event.time))
        change = force[[after - 1, min(after, len(force) - 1)], labels.index(event.label)]
        without, loaded = change if event.kind == "contact_made" else change[::-1]
        assert without == 0.0 < loaded, event


def test_jacobian_is_the_derivative_of_the_rates(history: History) -> None:
    """Central differences by every position and velocity, at the sample of largest force."""
    system = history.system
    force = observe(system.arrays, history.states).contact_force
    state = history.states[int(np.argmax(force.max(axis=1)))]
    assert_derivatives(system, state)


def assert_derivatives(system: System, state: Any) -> None:
    size = system.arrays.size
    matrix = jacobian_of(system, state)
    for k, motion in enumerate(system.free_motions):
        axis = system.description.motions[motion].axis
        for column, step in ((size.position + k, STEPS[axis]), (size.velocity + k, 1e-7)):
            slope = slope_of_rates(system, state, column, step)
            expected = slope[size.velocity : size.core]
            found = matrix[size.velocity : size.core, column]
            assert found == pytest.approx(expected, abs=2e-3 * np.abs(expected).max())


def closing_ring(share: float) -> tuple[System, Any]:
    """The ring system with volumes of a share of twice the least one."""
    system = ring_system()
    state = start_state(system)
    evaluate_state(system.arrays, state)
    node = system.arrays.node[: system.arrays.size.chambers]
    node[:, LEAST_VOLUME] = 0.5 * node[:, VOLUME] / share
    return system, state


def test_a_closing_chamber_keeps_its_virtual_work() -> None:
    """Force on each motion: sum of p dV/dq of the volumes that the pressures follow from."""
    system, state = closing_ring(0.6)
    arrays, size = system.arrays, system.arrays.size
    evaluate_state(arrays, state)
    force, pressure = (
        arrays.motion[:, PRESSURE_FORCE].copy(),
        arrays.node[: size.chambers, PRESSURE].copy(),
    )
    for k, motion in enumerate(system.free_motions):
        step = 1e3 * STEPS[system.description.motions[motion].axis]
        volumes = []
        for sign in (1.0, -1.0):
            moved = state.copy()
            moved[size.position + k] += sign * step
            evaluate_state(arrays, moved)
            volumes.append(arrays.node[: size.chambers, VOLUME].copy())
        work = pressure @ (volumes[0] - volumes[1]) / (2.0 * step)
        assert force[k] == pytest.approx(work, rel=1e-6, abs=1e-6 * np.abs(force).max())


def test_a_chamber_between_overlapping_contacts_keeps_its_least_volume() -> None:
    """Its pressure hardly acts on the bodies any more."""
    system, state = closing_ring(1e-3)
    arrays, size = system.arrays, system.arrays.size
    evaluate_state(arrays, state)
    node = arrays.node[: size.chambers]
    np.testing.assert_allclose(node[:, VOLUME], node[:, LEAST_VOLUME], rtol=2e-6)
    areas = arrays.chamber_values[:, CHANNEL_MOTION : CHANNEL_MOTION + size.motions]
    np.testing.assert_allclose(
        arrays.motion[:, PRESSURE_FORCE], 1e-3 * node[:, PRESSURE] @ areas, atol=1e-12
    )


def test_jacobian_of_closing_chambers() -> None:
    """The slope of the volume changes with the positions."""
    assert_derivatives(*closing_ring(0.6))


def test_walls_at_the_ends_make_a_long_bearing() -> None:
    """Sommerfeld's pressure with half film, per length: Pinkus and Sternlicht (1961)."""
    ratio = 0.6
    force = journal_force(ratio, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0, build_journal_map(1e4))
    scale = 12.0 / ((2.0 + ratio**2) * (1.0 - ratio**2))
    assert -force[0] == pytest.approx(scale * ratio**2, rel=3e-3)
    assert force[1] == pytest.approx(
        0.5 * np.pi * scale * ratio * np.sqrt(1.0 - ratio**2), rel=3e-3
    )


def test_each_bearing_keeps_its_own_film() -> None:
    """A second, open journal of the same body: its force adds to that of the closed one."""
    closed = ring_system()
    machine = closed.description
    open_ended = replace(machine.journals[0], end_condition="pressure")
    forces = []
    for journals in (machine.journals, (open_ended,), (*machine.journals, open_ended)):
        system = assemble(
            replace(machine, journals=journals), closed.arrays.fluid, closed.condition
        )
        state = start_state(system)
        evaluate_state(system.arrays, state)
        forces.append(system.arrays.motion[:2, FILM_FORCE].copy())
    assert np.hypot(*forces[0]) > 10.0 * np.hypot(*forces[1])
    assert forces[2] == pytest.approx(forces[0] + forces[1], rel=1e-9)


def pressed_ring(own_speed: float) -> tuple[System, Any]:
    """The ring pressed into the asperities of its bearing, turning at a speed [rad/s]."""
    system = ring_system()
    size, state = system.arrays.size, start_state(system)
    state[size.position] = 61e-6
    state[size.velocity + 2] = own_speed - RATIO * state[1]
    return system, state


@pytest.mark.parametrize("share", [-2.0, -0.1, 0.1, 1.0, 3.0])
def test_friction_opposes_the_own_speed_of_a_body(share: float) -> None:
    """Boundary friction is of one size in either sense, shear goes with the speed."""
    mean = RATIO * 157.0
    system, state = pressed_ring(mean)
    evaluate_state(system.arrays, state)
    running = journal_torques(system.arrays, state, 0)[1]
    system, state = pressed_ring(share * mean)
    evaluate_state(system.arrays, state)
    assert running > 0.0
    assert journal_torques(system.arrays, state, 0)[1] == pytest.approx(np.sign(share) * running)


@pytest.mark.parametrize("share", [-0.5, 0.3, 1.0])
def test_jacobian_of_a_friction_curve(share: float) -> None:
    """Torque by the speed of the body, straight and through the force of its film."""
    plain = ring_system()
    machine = plain.description
    journals = tuple(replace(journal, friction=PUBLISHED) for journal in machine.journals)
    system = assemble(replace(machine, journals=journals), plain.arrays.fluid, plain.condition)
    size, state = system.arrays.size, start_state(system)
    state[size.velocity + 2] = (share - 1.0) * RATIO * state[1]
    assert_derivatives(system, state)


def test_a_body_brought_to_rest_creeps() -> None:
    """Friction passes through zero at rest; its slope by speed stands in the Jacobian."""
    torques = []
    for speed in (-1e-4, 0.0, 1e-4):
        system, state = pressed_ring(speed)
        evaluate_state(system.arrays, state)
        torques.append(system.arrays.motion[2, FILM_FORCE])
        if speed == 0.0:
            slope = system.arrays.film_slopes[1, 2, 2]
            assert journal_torques(system.arrays, state, 0)[1] == 0.0
    assert slope == pytest.approx((torques[2] - torques[0]) / 2e-4, rel=1e-4)
    system, state = pressed_ring(RATIO * 157.0)
    evaluate_state(system.arrays, state)
    running = journal_torques(system.arrays, state, 0)[1]
    assert slope == pytest.approx(-running * 30e-3 / CREEP_SPEED, rel=0.02)
