"""Contacts of both flanks: shares of a rigid mesh, or compliant teeth with backlash."""

from __future__ import annotations

import numpy as np

from toothspace.closures.contact_law import hertz_scale, logarithmic_law
from toothspace.core.types import Array
from toothspace.gearing.mesh_split import Throats
from toothspace.gearing.meshing import (
    flank_geometry,
    gap_by_motion,
    load_share,
    loaded_throats,
    slip_by_motion,
)
from toothspace.gearing.numbering import FULL_TURN, Numbering
from toothspace.gearing.spaces import Spaces
from toothspace.geometry.involute import InvoluteGear
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.loads import BODIES, reduced_modulus
from toothspace.model.description import ContactPair
from toothspace.numerics.periodic_table import monotone_table

_STEEL_MODULUS = 206e9
_MEASURED_OVER_THEORY = 0.8
_HERTZ_SHARE_DEPTH = 5e-6
_RADIUS_OVER_PITCH = 0.34


def flank_contacts(
    assembly: Assembly, numbering: Numbering, spaces: Spaces
) -> tuple[ContactPair, ContactPair]:
    """Contacts of the loaded and of the unloaded flanks over the angle of the drive spaces."""
    loaded = loaded_throats(assembly, spaces)
    other = spaces.right if loaded is spaces.left else spaces.left
    return (
        _pair("drive_flank", assembly, numbering, loaded, load_share(assembly, spaces.angles)),
        _pair("coast_flank", assembly, numbering, other, np.zeros(spaces.angles.size)),
    )


def _pair(
    name: str, assembly: Assembly, numbering: Numbering, side: Throats, share: Array
) -> ContactPair:
    spec = assembly.spec
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
        effective_modulus=reduced_modulus(spec.drive.material, spec.driven.material),
        roughness=float(np.hypot(spec.drive.roughness, spec.driven.roughness)),
        law="hertz_line",
        structure_stiffness=tooth_stiffness(assembly) * assembly.face_width,
        depth=half_tooth(assembly),
        friction_account="mesh_friction",
    )


def half_tooth(assembly: Assembly) -> float:
    """Half thickness of a tooth on the pitch circle: how deep contact deformation counts. [m]."""
    return 0.5 * assembly.mesh.half_pitch * assembly.mesh.pitch_radii[0]


def tooth_stiffness(assembly: Assembly) -> float:
    r"""Stiffness of a tooth pair in bending, shear and at the root, per face width.

    Parameters
    ----------
    assembly : Assembly
        Gears in mesh.

    Returns
    -------
    float
        Stiffness without the contact's own flattening. [N/m2]

    Notes
    -----
    ISO 6336-1 gives the largest stiffness of one pair, flattening included, as
    :math:`c' = 0.8 E / (E_{steel}\, q')` with the minimum flexibility q' of a polynomial in
    reciprocal tooth counts and profile shifts. The flattening of the law of the contact,
    :math:`1/k_H` as its secant at 5 um, is taken off: :math:`1/\kappa = 1/c' - 1/k_H`.
    Profiles from file count with a profile shift of zero.

    References
    ----------
    .. [1] ISO 6336-1:2006, section 9.3, method B.
    """
    total = _MEASURED_OVER_THEORY / (1e-9 * minimum_flexibility(assembly))
    gears = (assembly.spec.drive, assembly.spec.driven)
    moduli = [gear.material.elastic_modulus for gear in gears]
    total *= 2.0 * moduli[0] * moduli[1] / (moduli[0] + moduli[1]) / _STEEL_MODULUS
    contact_modulus = 0.5 * reduced_modulus(gears[0].material, gears[1].material)
    radius = _RADIUS_OVER_PITCH * assembly.mesh.pitch_radii[0]
    other = radius / assembly.mesh.ratio
    level = float(np.log(hertz_scale(radius, other, half_tooth(assembly))))
    load, _, _, _ = logarithmic_law(_HERTZ_SHARE_DEPTH, level, contact_modulus)
    return float(1.0 / (1.0 / total - _HERTZ_SHARE_DEPTH / load))


def minimum_flexibility(assembly: Assembly) -> float:
    """Flexibility q' of one tooth pair of spur gears by ISO 6336-1. [mm um/N]."""
    drive, driven = assembly.counts
    shifts = [
        gear.tooth.profile_shift if isinstance(gear.tooth, InvoluteGear) else 0.0
        for gear in (assembly.spec.drive, assembly.spec.driven)
    ]
    order = (0, 1) if shifts[0] >= shifts[1] else (1, 0)
    z1, z2 = ((drive, driven)[k] for k in order)
    x1, x2 = (shifts[k] for k in order)
    counts = 0.04723 + 0.15551 / z1 + 0.25791 / z2
    linear = -0.00635 * x1 - 0.11654 * x1 / z1 - 0.00193 * x2 - 0.24188 * x2 / z2
    return counts + linear + 0.00529 * x1**2 + 0.00182 * x2**2
