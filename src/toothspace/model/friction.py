"""Friction of the mesh, the lateral films, the tips and the seal, as torque at the shaft."""

from __future__ import annotations

from toothspace.closures.traction import mesh_friction_coefficient
from toothspace.core.compiled import njit
from toothspace.core.types import Array
from toothspace.model.arrays import SystemArrays
from toothspace.model.chambers import CHANNEL_MESH
from toothspace.model.ledger import (
    FRICTION,
    LATERAL_VISCOUS,
    MESH_FRICTION,
    SHAFT_SEAL,
    TIP_SHEAR,
)
from toothspace.model.tables import table_values

GAP, LOAD_SHARE, RADIUS_A, RADIUS_B, SLIDING, ROLLING = range(6)


@njit(cache=True)
def update_contact_tables(s: SystemArrays, shaft_angle: float) -> None:
    """Evaluate the geometry of all contacts at a shaft angle."""
    for j in range(s.contacts.table.size):
        angle = s.contacts.phase[j] + s.contacts.ratio[j] * shaft_angle
        table_values(s.bank, s.contacts.table[j], angle, s.work.contact_values[j])


@njit(cache=True)
def mesh_force(s: SystemArrays) -> float:
    """Contact force of the rigid mesh that balances the pressure torque of the driven body. [N]."""
    torque = 0.0
    for i in range(s.size.chambers):
        torque += s.work.pressure[i] * s.work.chamber_values[i, CHANNEL_MESH]
    return -torque / s.contacts.lever


@njit(cache=True)
def mesh_torque(s: SystemArrays, speed: float) -> float:
    """Friction torque of all loaded contacts at the shaft. [N m]."""
    total = mesh_force(s)
    torque = 0.0
    for j in range(s.contacts.table.size):
        values = s.work.contact_values[j]
        share = values[LOAD_SHARE]
        s.work.contact_force[j] = total * max(share, 0.0)
        if share <= 1e-9:
            continue
        force = abs(total) * share
        friction = mesh_friction_coefficient(
            force / s.contacts.width,
            values[RADIUS_A],
            values[RADIUS_B],
            abs(values[SLIDING] * speed),
            values[ROLLING] * speed,
            s.fluid,
            s.contacts,
        )
        torque += friction * force * abs(values[SLIDING])
    return torque


@njit(cache=True)
def book_friction(s: SystemArrays, state: Array, ledger: Array) -> float:
    """Add mesh, lateral, tip and seal friction to the ledger; return their torque. [N m]."""
    w, speed = s.work, state[1]
    w.torque[MESH_FRICTION] = 0.0
    if s.contacts.table.size > 0:
        w.torque[MESH_FRICTION] = mesh_torque(s, speed)
    w.torque[LATERAL_VISCOUS] = s.condition.lateral_torque * s.fluid.dynamic_viscosity * speed
    w.torque[TIP_SHEAR] = w.path_shear.sum()
    w.torque[SHAFT_SEAL] = s.condition.seal_torque
    total = 0.0
    for mechanism in (MESH_FRICTION, LATERAL_VISCOUS, TIP_SHEAR, SHAFT_SEAL):
        ledger[FRICTION + mechanism] += w.torque[mechanism] * speed
        total += w.torque[mechanism]
    return total
