"""Contacts of both flanks: shares of a rigid mesh, or compliant teeth with backlash."""

from __future__ import annotations

import numpy as np

from toothspace.closures.contact_law import hertz_scale, logarithmic_law
from toothspace.core.types import Array
from toothspace.gearing.materials import reduced_modulus, solid
from toothspace.gearing.mesh_split import Throats
from toothspace.gearing.meshing import (
    FULL_TURN,
    flank_geometry,
    flow_over_pitch,
    gap_by_motion,
    load_share,
    loaded_throats,
    rigid_contact,
    slip_by_motion,
)
from toothspace.gearing.numbering import Numbering
from toothspace.gearing.spaces import Spaces
from toothspace.machines.crescent.assembly import CrescentAssembly
from toothspace.machines.crescent.loads import BODIES, MOTIONS
from toothspace.model.description import ContactPair, RigidMesh
from toothspace.numerics.periodic_table import monotone_table

_STEEL_MODULUS = 206e9
_MEASURED_OVER_THEORY = 0.8
_HERTZ_SHARE_DEPTH = 5e-6
_RADIUS_OVER_PITCH = 0.34


def flank_contacts(
    assembly: CrescentAssembly, numbering: Numbering, spaces: Spaces
) -> tuple[ContactPair, ContactPair]:
    """Contacts of the loaded and of the unloaded flanks over the angle of the pinion's spaces."""
    loaded = loaded_throats(assembly, spaces)
    other = spaces.right if loaded is spaces.left else spaces.left
    return (
        _pair("drive_flank", assembly, numbering, loaded, load_share(assembly, spaces.angles)),
        _pair("coast_flank", assembly, numbering, other, np.zeros(spaces.angles.size)),
    )


def _pair(
    name: str, assembly: CrescentAssembly, numbering: Numbering, side: Throats, share: Array
) -> ContactPair:
    spec = assembly.spec
    first = solid(spec.pinion.material, "machine.pinion.material")
    second = solid(spec.ring.material, "machine.ring.material")
    return ContactPair(
        name=name,
        body_a=BODIES[0],
        body_b=BODIES[1],
        angle_ratio=1.0,
        phases=numbering.space_phases[0],
        geometry=flank_geometry(assembly, side, share),
        gap_by_motion=monotone_table(FULL_TURN, gap_by_motion(assembly, side)),
        slip_by_motion=monotone_table(FULL_TURN, slip_by_motion(assembly, side)),
        width=assembly.face_width,
        effective_modulus=reduced_modulus(first, second),
        roughness=float(np.hypot(spec.pinion.roughness, spec.ring.roughness)),
        law="hertz_line",
        structure_stiffness=tooth_stiffness(assembly) * assembly.face_width,
        depth=half_tooth(assembly),
        friction_account="mesh_friction",
    )


def half_tooth(assembly: CrescentAssembly) -> float:
    """Half thickness of a tooth on the pitch circle: how deep contact deformation counts. [m]."""
    return 0.5 * assembly.mesh.half_pitch * assembly.mesh.pitch_radii[0]


def tooth_stiffness(assembly: CrescentAssembly) -> float:
    r"""Stiffness of a tooth pair in bending, shear and at the root, per face width.

    Parameters
    ----------
    assembly : CrescentAssembly
        Gears in mesh.

    Returns
    -------
    float
        Stiffness without the contact's own flattening. [N/m2]

    Notes
    -----
    ISO 6336-1 gives the largest stiffness of one pair, flattening included, as
    :math:`c' = 0.8 E / (E_{steel}\, q')`; a ring gear counts with an infinite tooth number. The
    flattening of the law of the contact, :math:`1/k_H` as its secant at 5 um, is taken off.

    References
    ----------
    .. [1] ISO 6336-1:2006, section 9.3, method B.
    """
    spec = assembly.spec
    first = solid(spec.pinion.material, "machine.pinion.material")
    second = solid(spec.ring.material, "machine.ring.material")
    moduli = first.elastic_modulus, second.elastic_modulus
    shift, count = spec.pinion.profile_shift, assembly.counts[0]
    flexibility = 0.04723 + 0.15551 / count - 0.00635 * shift - 0.11654 * shift / count
    flexibility += 0.00529 * shift**2
    total = _MEASURED_OVER_THEORY / (1e-9 * flexibility)
    total *= 2.0 * moduli[0] * moduli[1] / (moduli[0] + moduli[1]) / _STEEL_MODULUS
    radius = _RADIUS_OVER_PITCH * assembly.mesh.pitch_radii[0]
    level = float(np.log(hertz_scale(radius, -radius / assembly.ratio, half_tooth(assembly))))
    contact_modulus = 0.5 * reduced_modulus(first, second)
    load, _, _, _ = logarithmic_law(_HERTZ_SHARE_DEPTH, level, contact_modulus)
    return float(1.0 / (1.0 / total - _HERTZ_SHARE_DEPTH / load))


def rigid_mesh(assembly: CrescentAssembly) -> RigidMesh:
    """Rotation of the ring that keeps the loaded flanks touching."""
    normal, lever = rigid_contact(assembly)
    coefficients = np.zeros(len(MOTIONS))
    coefficients[:4] = np.concatenate([normal, -normal]) / lever
    return RigidMesh("drive_flank", len(MOTIONS) - 1, coefficients, lever)


def displacement(assembly: CrescentAssembly) -> float:
    """Geometric displacement per radian, single flank: closed form for involutes. [m3/rad]."""
    if assembly.pair is not None:
        return assembly.pair.displacement_per_radian(assembly.face_width)
    return float(np.mean(flow_over_pitch(assembly)))
