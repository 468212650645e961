"""Motions that bodies and bearing blocks are free to make, as arrays."""

from __future__ import annotations

import numpy as np

from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.contact_data import held_by_contacts, rigid_mesh
from toothspace.model.description import FreeBlocks, MachineDescription
from toothspace.model.lumped_films import lateral_drag
from toothspace.model.operating_point import OperatingCondition

_CLEARANCE = 1e-3
"""Scale of motions without a bearing, over the cube root of the displacement. [-]"""


def free_motions(description: MachineDescription, condition: OperatingCondition) -> list[int]:
    """Positions of the free motions of bodies among those of the description."""
    carried = {journal.body for journal in description.journals}
    held = held_by_contacts(description, condition)
    mesh = rigid_mesh(description, condition)
    tied = mesh.motion if mesh else -1
    free = []
    for k, motion in enumerate(description.motions):
        held_radially = motion.axis in ("x", "y") and (motion.body in carried or held[k])
        turning = motion.axis == "rotation" and held[k]
        if k != tied and (turning or (held_radially and condition.radial_motion)):
            free.append(k)
    return free


def free_blocks(
    description: MachineDescription, condition: OperatingCondition
) -> FreeBlocks | None:
    """Bearing blocks that move in x and y, the last two free motions; None if they rest."""
    return description.free_blocks if condition.radial_motion else None


def map_of_motions(
    description: MachineDescription, condition: OperatingCondition, free: list[int]
) -> Array:
    """All motions of the description from the free ones, with a column for each of these."""
    blocks = 2 if free_blocks(description, condition) else 0
    found = np.zeros((len(description.motions), len(free) + blocks))
    found[free, np.arange(len(free))] = 1.0
    mesh = rigid_mesh(description, condition)
    if mesh:
        found[mesh.motion, : len(free)] = np.asarray(mesh.coefficients)[free]
    return found


def motion_rows(
    description: MachineDescription, condition: OperatingCondition, free: list[int]
) -> Array:
    """Mass, load and scale of every free motion."""
    bodies = {body.name: body for body in description.bodies}
    clearance = {journal.body: journal.radial_clearance for journal in description.journals}
    drag = lateral_drag(description)
    blocks = free_blocks(description, condition)
    rows = np.zeros((len(free) + (2 if blocks else 0), col.MOTION_COLUMNS))
    without_bearing = _CLEARANCE * float(np.cbrt(description.displacement))
    for row, k in zip(rows, free, strict=False):
        motion = description.motions[k]
        body = bodies[motion.body]
        row[col.CLEARANCE] = clearance.get(motion.body, without_bearing)
        row[col.MOTION_MASS] = body.mass
        if motion.axis == "rotation":
            row[col.MOTION_MASS], row[col.MOTION_RATIO] = body.inertia, body.speed_ratio
            row[col.LATERAL_DRAG] = drag[motion.body]
            levers = [np.abs(c.gap_by_motion.values[:, k]).max() for c in description.contacts]
            row[col.CLEARANCE] /= float(max(levers))
        elif body.role == "shaft" and motion.axis in ("x", "y"):
            row[col.EXTERNAL_FORCE] = condition.radial_load["xy".index(motion.axis)]
    if blocks:
        rows[-2:, col.MOTION_MASS] = blocks.mass
        rows[-2:, col.CLEARANCE] = blocks.film.radial_clearance
        rows[-2, col.PORT_AREA] = blocks.port_area
    return rows
