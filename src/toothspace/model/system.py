"""The right-hand side of a whole machine, with the friction of mesh, films, tips and seal."""

from __future__ import annotations

import math

import numpy as np

from toothspace.closures.traction import mesh_friction
from toothspace.core.compiled import kernel, merged
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.arrays import SystemArrays
from toothspace.model.bodies import (
    book_journal_friction,
    curve_torques,
    face_sense,
    journal_place,
    update_film_forces,
    update_pressure_forces,
)
from toothspace.model.carried_flows import carries, carry_volumes, set_quasi_steady_pressures
from toothspace.model.chambers import (
    exchange_gas,
    gas_relaxation,
    update_enthalpies,
    update_pressures,
    update_volumes,
)
from toothspace.model.circuit import (
    book_circuit,
    fill_element_rates,
    fill_element_weights,
    update_elements,
)
from toothspace.model.contacts import (
    book_contacts,
    contact_gap,
    motion_force,
    note_approach,
    outer_force,
    update_contacts,
)
from toothspace.model.drive import (
    fill_load_rates,
    fill_load_weights,
    load_power,
    prescribed_acceleration,
    running_torque,
    startup_torque,
    taken_torque,
    update_fade,
    update_load,
)
from toothspace.model.lateral_lookup import fill_film_rates, fill_film_weights, update_lateral_films
from toothspace.model.lateral_table import ASPERITY_STRESS, DRAG_STRESS, REST_STRESS, SHEAR_RATIO
from toothspace.model.ledger import (
    COUPLING,
    FRICTION,
    GAS_RELAXATION,
    JOURNAL_ASPERITY,
    LATERAL_ASPERITY,
    LATERAL_VISCOUS,
    MESH_FRICTION,
    RADIAL_LOAD,
    SHAFT,
    SHAFT_LOAD,
    SHAFT_SEAL,
    STARTUP,
    TIP_SHEAR,
)
from toothspace.model.network import (
    book_throttling,
    gather_open,
    shift_flows,
    update_network,
    update_partners,
)
from toothspace.model.packed_tables import fill_slopes, fill_values, find_intervals

NO_SHARE = 1e-9
_RESISTING = (LATERAL_VISCOUS, LATERAL_ASPERITY, TIP_SHEAR, SHAFT_SEAL, STARTUP)
"""Friction of faces, tips, seal and start."""
_BOOKED = (MESH_FRICTION, *_RESISTING)


@kernel
def mesh_force(s: SystemArrays) -> float:
    """Contact force of the rigid mesh that balances all torques on the driven body. [N].

    Besides the pressures these are inertia and the friction of its bearings and faces.
    """
    node, values = s.node, s.chamber_values
    torque = s.drive[col.DRIVEN_FRICTION]
    for i in range(s.size.chambers):
        torque += node[i, col.PRESSURE] * values[i, col.CHANNEL_MESH]
    return -torque / s.surface.lever


@kernel
def mesh_torque(s: SystemArrays, speed: float) -> float:
    """Friction torque at the shaft of all contacts of a rigid mesh. [N m]."""
    values, surface, fluid = s.contact_values[col.VALUE], s.surface, s.fluid
    if s.size.compliant > 0:
        return 0.0
    total = mesh_force(s)
    speed = max(speed, 0.0)
    torque = 0.0
    for j in range(s.size.contacts):
        share = values[j, col.LOAD_SHARE]
        s.contact[j, col.CONTACT_FORCE] = total * max(share, 0.0)
        if share <= NO_SHARE:
            continue
        force = abs(total) * share
        sliding = abs(values[j, col.SLIDING])
        radius_a, radius_b = values[j, col.RADIUS_A], values[j, col.RADIUS_B]
        friction, _, _ = mesh_friction(
            force / surface.width,
            radius_a * radius_b / (radius_a + radius_b),
            sliding * speed,
            values[j, col.ROLLING] * speed,
            fluid,
            surface,
        )
        torque += friction * force * sliding
    return torque


@kernel
def boundary_torque(s: SystemArrays) -> float:
    """Torque at the shaft of all interfaces at their boundary level under the present loads. [N m].

    Journals at the level of their curve at rest, or of their boundary friction; teeth likewise;
    faces as at the lowest speed of their table, none without a table; the seal at its own ratio.
    """
    journal, surface = s.journal, s.surface
    total = s.drive[col.RUNNING_FRICTION] * s.drive[col.SEAL_RATIO]
    total += s.constant.lateral_torque * s.lateral.now[REST_STRESS]
    for j in range(s.size.journals):
        force = math.sqrt(journal[j, col.FILM_X] ** 2 + journal[j, col.FILM_Y] ** 2)
        torque = journal[j, col.BOUNDARY_FRICTION] * force * journal[j, col.RADIUS]
        if journal[j, col.CURVES] > 0:
            film, asperities = curve_torques(s, j, 0.0, force)
            torque = film + asperities
        total += abs(journal[j, col.SPEED_RATIO]) * torque
    values, contact = s.contact_values[col.VALUE], s.contact
    if s.size.compliant > 0:
        for j in range(s.size.compliant):
            force = contact[j, col.CONTACT_FORCE] * abs(values[j, col.SLIDING])
            total += contact[j, col.PAIR_BOUNDARY] * force
        return total
    # the teeth of a shaft at rest carry the pressures on the driven body
    force = 0.0
    for i in range(s.size.chambers):
        force += s.node[i, col.PRESSURE] * s.chamber_values[i, col.CHANNEL_MESH]
    force = abs(force / surface.lever)
    for j in range(s.size.contacts):
        arm = max(values[j, col.LOAD_SHARE], 0.0) * abs(values[j, col.SLIDING])
        total += surface.boundary_friction * force * arm
    return total


@kernel
def tip_torque(s: SystemArrays) -> float:
    """Torque of viscous shear in all gaps with sliding walls. [N m]."""
    total = 0.0
    for j in range(s.paths.open[-1]):
        total += s.path[j, col.SHEAR]
    return total


@kernel
def load_mesh(s: SystemArrays, state: Array, torque: float) -> None:
    """Add friction of the faces and inertia to what the mesh carries of the driven bodies.

    ``torque`` is that at the shaft without mesh friction, too small to matter here. [N m]
    """
    drive, now = s.drive, s.lateral.now
    lateral = drive[col.DRIVEN_LATERAL] * s.fluid.dynamic_viscosity * now[SHEAR_RATIO]
    drive[col.DRIVEN_FRICTION] += drive[col.FADE] * lateral * state[1]
    held = drive[col.DIRECTION] * (now[DRAG_STRESS] + now[ASPERITY_STRESS])
    drive[col.DRIVEN_FRICTION] += drive[col.FADE] * drive[col.DRIVEN_LATERAL] * held
    if drive[col.FREE] > 0.0 and drive[col.DIRECTION] != 0.0:
        acceleration = -(torque + taken_torque(s, state)) / drive[col.INERTIA]
        drive[col.DRIVEN_FRICTION] += drive[col.DRIVEN_INERTIA] * acceleration


@kernel
def book_friction(s: SystemArrays, state: Array, ledger: Array, driving: float) -> float:
    """Add mesh, lateral, tip and seal friction to the ledger; return their torque. [N m].

    ``driving`` is the torque at the shaft of all that acts on it besides. [N m]
    """
    torque, motion, speed, now = s.torque, s.motion, state[1], s.lateral.now
    way, fade = s.drive[col.DIRECTION], s.drive[col.FADE]
    viscosity = s.fluid.dynamic_viscosity * now[SHEAR_RATIO]
    lateral = s.constant.lateral_torque * viscosity
    torque[LATERAL_ASPERITY] = fade * lateral * s.constant.asperity_share * speed
    torque[LATERAL_VISCOUS] = fade * lateral * speed - torque[LATERAL_ASPERITY]
    held = fade * s.constant.lateral_torque * way
    torque[LATERAL_VISCOUS] += held * now[DRAG_STRESS]
    torque[LATERAL_ASPERITY] += held * now[ASPERITY_STRESS]
    torque[TIP_SHEAR] = fade * tip_torque(s)
    torque[SHAFT_SEAL] = running_torque(s)
    torque[STARTUP] = startup_torque(s, speed)
    total = 0.0
    for mechanism in _RESISTING:
        total += torque[mechanism]
    for k in range(s.size.motions):
        drag = motion[k, col.LATERAL_DRAG] * viscosity
        turning, ahead = motion[k, col.MOTION_RATIO] * speed, state[s.size.velocity + k]
        ledger[FRICTION + LATERAL_VISCOUS] += drag * (2.0 * turning + ahead) * ahead
        share, ratio = motion[k, col.LATERAL_DRAG], motion[k, col.MOTION_RATIO]
        ledger[FRICTION + LATERAL_VISCOUS] += way * share * ratio * ahead * now[DRAG_STRESS]
        sense, _ = face_sense(s, state, k)
        rubbing = share * abs(ratio) * now[ASPERITY_STRESS]
        ledger[FRICTION + LATERAL_ASPERITY] += rubbing * sense * ahead
        other = fade * ratio * rubbing * (sense - np.sign(ratio) * way)
        torque[LATERAL_ASPERITY] += other
        total += ratio * drag * ahead + other
    load_mesh(s, state, driving + total)
    torque[MESH_FRICTION] = way * fade * mesh_torque(s, way * speed)
    for mechanism in _BOOKED:
        ledger[FRICTION + mechanism] += torque[mechanism] * speed
    return total + torque[MESH_FRICTION]


SAME_ANGLE = 1e-13
SMALLEST_TORQUE = 1e-9
REVERSED = 1e-4


@kernel
def update_tables(s: SystemArrays, shaft_angle: float) -> bool:
    """Evaluate all tables at an angle; True if the open paths are others than before."""
    s.table_angle[0] = shaft_angle
    find_intervals(s.bank, s.chambers, shaft_angle)
    fill_values(s.chambers, s.chamber_values)
    fill_slopes(s.chambers, s.chamber_slopes)
    find_intervals(s.bank, s.contacts, shaft_angle)
    fill_values(s.contacts, s.contact_values[col.VALUE])
    if s.size.compliant > 0:
        fill_slopes(s.contacts, s.contact_values[col.SLOPE])
    changed = find_intervals(s.bank, s.paths, shaft_angle)
    if changed:
        update_partners(s)
        gather_open(s)
    fill_values(s.paths, s.path_values)
    return changed


@merged
def evaluate_pressures(s: SystemArrays, state: Array) -> bool:
    """Compute the pressures of a state into the work arrays; tables only at a new angle.

    True if the open paths are others than before.
    """
    changed = False
    if not abs(state[0] - s.table_angle[0]) <= SAME_ANGLE * max(1.0, abs(state[0])):
        changed = update_tables(s, state[0])
    if carries(s):
        set_quasi_steady_pressures(s, state)
        update_volumes(s, state)
        carry_volumes(s)
    else:
        update_volumes(s, state)
    update_pressures(s, state)
    return changed


@merged
def evaluate(s: SystemArrays, state: Array) -> None:
    """Compute pressures, flows and forces of a state into the work arrays."""
    evaluate_pressures(s, state)
    update_lateral_films(s, state)
    update_network(s, state)
    exchange_gas(s, state)
    update_pressure_forces(s)
    update_film_forces(s, state)
    update_contacts(s, state)


@kernel
def right_hand_side(t: float, state: Array, s: SystemArrays, rate: Array) -> None:
    """Time derivative of the core states and of the masses of held nodes."""
    evaluate(s, state)
    node, motion, balance, size = s.node, s.motion, s.balance, s.size
    update_elements(s, state, t)
    update_load(s, t)
    rate[0] = state[1]
    rate[1] = shaft_acceleration(t, state, s)
    for i in range(size.core, size.total):
        rate[i] = 0.0
    for i in range(size.nodes):
        rate[balance[i, 0]] = node[i, col.MASS_RATE]
        rate[balance[i, 1]] = node[i, col.GAS_RATE]
    for k in range(size.motions):
        rate[size.position + k] = state[size.velocity + k]
        carried = motion[k, col.MOTION_RATIO] * rate[1]
        rate[size.velocity + k] = motion_force(s, k) / motion[k, col.MOTION_MASS] - carried
    if size.core > size.column:
        fill_element_rates(s, state, rate)
        fill_film_rates(s, state, rate)
        fill_load_rates(s, state, rate)


@kernel
def full_rates(t: float, state: Array, s: SystemArrays, rate: Array) -> None:
    """Time derivative of the state with the whole ledger."""
    right_hand_side(t, state, s, rate)
    book_rates(s, state, rate)


@kernel
def book_rates(s: SystemArrays, state: Array, rate: Array) -> None:
    """Add the rates of the ledger to those of the masses of held nodes."""
    update_enthalpies(s)
    ledger = rate[s.size.core :]
    ledger[GAS_RELAXATION] = gas_relaxation(s, state)
    book_circuit(s, state, ledger)
    for k in range(s.size.motions):
        ledger[RADIAL_LOAD] += outer_force(s, k) * state[s.size.velocity + k]
    book_shaft(s, state, ledger)


@kernel
def book_shaft(s: SystemArrays, state: Array, ledger: Array) -> None:
    """Work of the shaft on the machine: against pressure, wall drag, friction and contacts.

    A body that turns on its own takes its share of the shaft's torque through its inertia.
    """
    s.torque[:] = 0.0
    node, drive, speed = s.node, s.drive, state[1]
    torque = 0.0
    for i in range(s.size.chambers):
        torque -= node[i, col.PRESSURE] * node[i, col.VOLUME_RATE]
    torque += book_throttling(s, speed, ledger)
    torque += book_contacts(s, state, ledger)
    for k in range(s.size.motions):
        torque += s.motion[k, col.MOTION_RATIO] * motion_force(s, k)
    drive[col.DRIVING_TORQUE] = -torque - taken_torque(s, state)
    if drive[col.FROM_INTERFACES] > 0.0:
        drive[col.BREAKAWAY] = boundary_torque(s)
    update_fade(s, speed)
    torque += book_journal_friction(s, state, ledger)
    torque += book_friction(s, state, ledger, torque)
    if drive[col.FREE] > 0.0 and drive[col.DIRECTION] == 0.0:
        s.torque[STARTUP] = drive[col.DRIVING_TORQUE]
        torque += drive[col.DRIVING_TORQUE]
    s.torque[-1] = torque
    ledger[SHAFT] = torque * speed
    ledger[SHAFT_LOAD], ledger[COUPLING] = load_power(s, state)


@kernel
def shaft_acceleration(t: float, state: Array, s: SystemArrays) -> float:
    """Angular acceleration of the shaft: prescribed, zero while it sticks, or free. [rad/s2]."""
    drive = s.drive
    if drive[col.FREE] == 0.0:
        return prescribed_acceleration(s, t)
    s.scratch[:] = 0.0
    book_shaft(s, state, s.scratch)
    if drive[col.DIRECTION] == 0.0:
        return 0.0
    return -(s.torque[-1] + taken_torque(s, state)) / drive[col.INERTIA]


@kernel
def held_torque(s: SystemArrays, state: Array) -> None:
    """Torque that friction must hold at rest, and the largest that it can hold."""
    drive = s.drive
    drive[col.DIRECTION] = 1.0
    s.scratch[:] = 0.0
    book_shaft(s, state, s.scratch)
    drive[col.HOLDING_TORQUE] = drive[col.BREAKAWAY]
    if drive[col.ADDED_FRICTION] > 0.0:
        for mechanism in (JOURNAL_ASPERITY, MESH_FRICTION):
            drive[col.HOLDING_TORQUE] += s.torque[mechanism]
    drive[col.DIRECTION] = 0.0


@kernel
def finish_step(
    t: float, state: Array, s: SystemArrays, rate: Array, weight: Array, values: Array
) -> None:
    """Ledger rates, error weights and event values of an accepted state.

    The flows are moved on linearly from the last state of the iteration, which was within the
    tolerance of the accepted one; all else is evaluated, and flows too where paths opened or
    closed in between. Masses of held nodes are left out.
    """
    changed = evaluate_pressures(s, state)
    update_lateral_films(s, state)
    if changed:
        update_network(s, state)
    shift_flows(s)
    update_pressure_forces(s)
    update_film_forces(s, state)
    update_contacts(s, state)
    note_approach(s, state)
    update_elements(s, state, t)
    for i in range(s.size.core, s.size.total):
        rate[i] = 0.0
    book_rates(s, state, rate)
    fill_weights(s, state, weight)
    fill_event_values(s, t, state, values)


@kernel
def error_weights(t: float, state: Array, s: SystemArrays, weight: Array) -> None:
    """Error allowed in each core state, see :func:`fill_weights`."""
    evaluate_pressures(s, state)
    fill_weights(s, state, weight)


@kernel
def fill_weights(s: SystemArrays, state: Array, weight: Array) -> None:
    """Error allowed in each core state, from a tolerance on pressures and on positions.

    A pressure error p belongs to a mass error m p / (rho dp/drho); where the bulk modulus
    is low the mass itself is kept to ten times the relative tolerance.
    """
    node, motion, size, tolerance = s.node, s.motion, s.size, s.constant.relative_tolerance
    weight[0] = tolerance
    weight[1] = tolerance * max(abs(state[1]), 1.0)
    total_gas = max(s.fluid.total_gas_mass_fraction, 1e-8)
    for i in range(size.nodes):
        d = s.dynamic_index[i]
        if d < 0:
            continue
        mass = state[size.mass + d]
        pressure_error = tolerance * (abs(node[i, col.PRESSURE]) + s.constant.pressure_scale)
        by_pressure = pressure_error / node[i, col.PRESSURE_BY_MASS]
        weight[size.mass + d] = min(by_pressure, 10.0 * tolerance * mass)
        weight[size.gas + d] = 10.0 * tolerance * total_gas * mass
    for k in range(size.motions):
        clearance = motion[k, col.CLEARANCE]
        weight[size.position + k] = 10.0 * tolerance * clearance
        weight[size.velocity + k] = 1000.0 * tolerance * clearance * max(abs(state[1]), 1.0)
    if size.core > size.column:
        fill_element_weights(s, state, weight)
        fill_film_weights(s, weight)
        fill_load_weights(s, state, weight)


@kernel
def event_values(t: float, state: Array, s: SystemArrays, values: Array) -> None:
    """Signed distances to events, see :func:`fill_event_values`."""
    evaluate_pressures(s, state)
    fill_event_values(s, t, state, values)


@kernel
def fill_event_values(s: SystemArrays, t: float, state: Array, values: Array) -> None:
    """Signed distances to events: vapour in a chamber, a body at its stop, contact lost."""
    node, journal, size = s.node, s.journal, s.size
    onset = s.fluid.vapour_pressure + 2.0 * s.fluid.vapour_smoothing
    for i in range(size.chambers):
        values[i] = (node[i, col.PRESSURE] - onset) / onset
    for j in range(size.journals):
        ex, ey = journal_place(s, state, j)
        distance = math.sqrt(ex * ex + ey * ey)
        values[size.chambers + j] = 1.0 - distance / journal[j, col.JOURNAL_CLEARANCE]
    first = size.chambers + size.journals
    if size.contacts > size.compliant:
        values[first] = mesh_force(s)
    for j in range(size.compliant):
        onset = s.contact[j, col.PAIR_ONSET]
        values[first + j] = 1.0 - contact_gap(s, state, j) / onset
    if s.drive[col.FREE] > 0.0:
        values[-1] = distance_to_switch(t, state, s)


@kernel
def distance_to_switch(t: float, state: Array, s: SystemArrays) -> float:
    """Positive while the shaft may go on sticking, or sliding in its direction. [-]."""
    drive = s.drive
    if drive[col.DIRECTION] != 0.0:
        return drive[col.DIRECTION] * state[1] / drive[col.BREAKAWAY_SPEED] + REVERSED
    evaluate(s, state)
    update_load(s, t)
    held_torque(s, state)
    return 1.0 - abs(drive[col.DRIVING_TORQUE]) / max(drive[col.HOLDING_TORQUE], SMALLEST_TORQUE)
