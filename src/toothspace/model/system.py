"""The right-hand side of a whole machine and its Jacobian, compiled."""

from __future__ import annotations

import numpy as np

from toothspace.core.compiled import njit
from toothspace.core.types import Array
from toothspace.model.arrays import SystemArrays
from toothspace.model.bodies import (
    book_journal_friction,
    update_film_forces,
    update_pressure_forces,
)
from toothspace.model.chambers import (
    exchange_gas,
    update_chamber_tables,
    update_enthalpies,
    update_pressures,
    update_volumes,
)
from toothspace.model.friction import book_friction, update_contact_tables
from toothspace.model.ledger import ENERGY, GAS_RELAXATION, MASS, PORT_NODES, RADIAL_LOAD, SHAFT
from toothspace.model.network import book_throttling, update_network, update_path_tables

SAME_ANGLE = 1e-13


@njit(cache=True)
def update_tables(s: SystemArrays, shaft_angle: float) -> None:
    """Evaluate all tables, unless they stand at this angle already."""
    if abs(shaft_angle - s.work.table_angle[0]) <= SAME_ANGLE * max(1.0, abs(shaft_angle)):
        return
    s.work.table_angle[0] = shaft_angle
    update_chamber_tables(s, shaft_angle)
    update_path_tables(s, shaft_angle)
    update_contact_tables(s, shaft_angle)


@njit(cache=True)
def evaluate_pressures(s: SystemArrays, state: Array) -> None:
    """Compute the pressures of a state into the work arrays."""
    update_tables(s, state[0])
    update_volumes(s, state)
    update_pressures(s, state)


@njit(cache=True)
def evaluate(s: SystemArrays, state: Array) -> None:
    """Compute pressures, flows and forces of a state into the work arrays."""
    evaluate_pressures(s, state)
    update_network(s, state)
    update_pressure_forces(s)
    update_film_forces(s, state)


@njit(cache=True)
def right_hand_side(t: float, state: Array, s: SystemArrays, rate: Array) -> None:
    """Time derivative of the state, ledger included."""
    evaluate(s, state)
    w, size = s.work, s.size
    rate[size.core :] = 0.0
    ledger = rate[size.core :]
    update_enthalpies(s)
    ledger[GAS_RELAXATION] = exchange_gas(s, state)
    rate[0] = state[1]
    rate[1] = 0.0
    for node in range(size.nodes):
        d = s.condition.dynamic_index[node]
        if d >= 0:
            rate[size.mass + d] = w.mass_rate[node]
            rate[size.gas + d] = w.gas_rate[node]
    for k in range(size.motions):
        rate[size.position + k] = state[size.velocity + k]
        external = s.motions.external_force[k]
        force = w.pressure_force[k] + w.film_force[k] + external
        rate[size.velocity + k] = force / s.motions.mass[k]
        ledger[RADIAL_LOAD] += external * state[size.velocity + k]
    book_ports(s, ledger)
    book_shaft(s, state, ledger)


@njit(cache=True)
def book_ports(s: SystemArrays, ledger: Array) -> None:
    """Add mass and energy that flow into each fixed port node."""
    w = s.work
    for port in range(len(PORT_NODES)):
        node = s.size.chambers + port
        if s.condition.dynamic_index[node] >= 0:
            continue
        liquid = w.mass_rate[node] - w.gas_rate[node]
        ledger[MASS + port] = w.mass_rate[node]
        ledger[ENERGY + port] = liquid * w.liquid_enthalpy[node]
        ledger[ENERGY + port] += w.gas_rate[node] * w.gas_enthalpy[node]


@njit(cache=True)
def book_shaft(s: SystemArrays, state: Array, ledger: Array) -> None:
    """Work of the shaft on the machine: against pressure, wall drag and friction."""
    w = s.work
    w.torque[:] = 0.0
    torque = 0.0
    for i in range(s.size.chambers):
        torque -= w.pressure[i] * w.volume_rate[i]
    torque += book_throttling(s, state[1], ledger)
    torque += book_journal_friction(s, state, ledger)
    torque += book_friction(s, state, ledger)
    w.torque[-1] = torque
    ledger[SHAFT] = torque * state[1]


@njit(cache=True)
def error_weights(t: float, state: Array, s: SystemArrays, weight: Array) -> None:
    """Error allowed in each core state, from a tolerance on pressures and on positions.

    A pressure error p belongs to a mass error m p / (rho dp/drho); where the bulk modulus
    is low the mass itself is kept to ten times the relative tolerance.
    """
    w, size, tolerance = s.work, s.size, s.condition.relative_tolerance
    evaluate_pressures(s, state)
    weight[0] = tolerance
    weight[1] = tolerance * max(abs(state[1]), 1.0)
    total_gas = max(s.fluid.total_gas_mass_fraction, 1e-8)
    for node in range(size.nodes):
        d = s.condition.dynamic_index[node]
        if d < 0:
            continue
        mass = state[size.mass + d]
        pressure_error = tolerance * (abs(w.pressure[node]) + s.condition.pressure_scale)
        weight[size.mass + d] = min(
            pressure_error / w.pressure_by_mass[node], 10.0 * tolerance * mass
        )
        weight[size.gas + d] = 10.0 * tolerance * total_gas * mass
    for k in range(size.motions):
        clearance = s.motions.clearance[k]
        weight[size.position + k] = 10.0 * tolerance * clearance
        weight[size.velocity + k] = 1000.0 * tolerance * clearance * max(abs(state[1]), 1.0)


@njit(cache=True)
def event_values(t: float, state: Array, s: SystemArrays, values: Array) -> None:
    """Signed distances to events: onset of vapour in each chamber, then each body at its stop."""
    evaluate_pressures(s, state)
    onset = s.fluid.vapour_pressure + 2.0 * s.fluid.vapour_smoothing
    for i in range(s.size.chambers):
        values[i] = (s.work.pressure[i] - onset) / onset
    k = s.size.chambers
    for j in range(s.journals.motion_x.size):
        kx, ky = s.journals.motion_x[j], s.journals.motion_y[j]
        ex = state[s.size.position + kx] - s.journals.bush_x[j]
        ey = state[s.size.position + ky] - s.journals.bush_y[j]
        values[k] = 1.0 - np.sqrt(ex * ex + ey * ey) / s.journals.clearance[j]
        k += 1
