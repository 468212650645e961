"""Friction of the mesh, the lateral films, the tips and the seal, as torque at the shaft."""

from __future__ import annotations

import math

import numpy as np

from toothspace.closures.traction import mesh_friction
from toothspace.core.compiled import kernel
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.arrays import SystemArrays
from toothspace.model.bodies import curve_torques, face_sense
from toothspace.model.drive import running_torque, startup_torque, taken_torque
from toothspace.model.lateral_table import ASPERITY_STRESS, DRAG_STRESS, REST_STRESS, SHEAR_RATIO
from toothspace.model.ledger import (
    FRICTION,
    LATERAL_ASPERITY,
    LATERAL_VISCOUS,
    MESH_FRICTION,
    SHAFT_SEAL,
    STARTUP,
    TIP_SHEAR,
)

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
