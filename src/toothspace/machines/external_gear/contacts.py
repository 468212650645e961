"""Contact of the loaded flanks as a rigid mesh, and displacement."""

from __future__ import annotations

import numpy as np

from toothspace.gearing.meshing import flow_over_pitch, path_of_contact, rigid_contact
from toothspace.geometry.gear_pair import displacement_per_radian
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.loads import MOTIONS
from toothspace.model.description import RigidMesh


def rigid_mesh(assembly: Assembly) -> RigidMesh:
    """Rotation of the driven gear that keeps the loaded flanks touching."""
    normal, lever = rigid_contact(assembly)
    coefficients = np.zeros(len(MOTIONS))
    coefficients[:4] = np.concatenate([normal, -normal]) / lever
    return RigidMesh("drive_flank", len(MOTIONS) - 1, coefficients, lever)


def displacement(assembly: Assembly) -> float:
    """Geometric displacement per radian, single flank: closed form for involutes. [m3/rad]."""
    if assembly.pair is not None:
        return displacement_per_radian(assembly.pair, assembly.face_width)
    return float(np.mean(flow_over_pitch(assembly)))


def contact_ratio(assembly: Assembly) -> float:
    """Mean number of tooth pairs in contact."""
    if assembly.pair is not None:
        return assembly.pair.contact_ratio
    start, end = path_of_contact(assembly)
    return (end - start) / (2.0 * assembly.mesh.half_pitch)
