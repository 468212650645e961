"""Contacts of both flanks of a pair: shares of a rigid mesh, or compliant teeth with backlash."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.closures.contact_law import hertz_scale, logarithmic_law
from toothspace.core.types import Array
from toothspace.gearing import meshing
from toothspace.gearing.materials import Material, reduced_modulus
from toothspace.gearing.mesh_split import Throats
from toothspace.gearing.numbering import FULL_TURN, Numbering
from toothspace.gearing.spaces import Spaces
from toothspace.model.description import ContactPair, Motion, RigidMesh
from toothspace.numerics.periodic_table import monotone_table

_STEEL_MODULUS = 206e9
_MEASURED_OVER_THEORY = 0.8
_HERTZ_SHARE_DEPTH = 2.21e-3
"""Depth whose flattening ISO 6336 counts to a pair, over half a tooth: 5 um at module 2.75. [-]"""

_RADIUS_OVER_PITCH = 0.34


@final
@dataclass(frozen=True)
class FlankPair:
    """What touches at the flanks: drive and driven body, each with its surface."""

    bodies: tuple[str, str]
    """Names."""
    materials: tuple[Material, Material]
    """Materials."""
    roughness: tuple[float, float]
    """Root mean square roughness. [m]"""
    profile_shifts: tuple[float, float]
    """Profile shifts in modules; 0 for profiles from file and for a ring gear. [-]"""


def mesh_motions(bodies: tuple[str, str]) -> tuple[Motion, ...]:
    """Micro-motions of two gears; the drive gear's rotation is the shaft angle."""
    drive, driven = bodies
    planar = tuple(Motion(body, axis) for body in (drive, driven) for axis in ("x", "y"))
    return (*planar, Motion(driven, "rotation"))


def flank_contacts(
    gears: meshing.MeshedGears, flanks: FlankPair, numbering: Numbering, spaces: Spaces
) -> tuple[ContactPair, ContactPair]:
    """Contacts of the loaded and of the unloaded flanks over the angle of the drive spaces."""
    loaded = meshing.loaded_throats(gears, spaces)
    other = spaces.right if loaded is spaces.left else spaces.left
    stiffness = tooth_stiffness(gears, flanks) * gears.face_width

    def contact(name: str, side: Throats, share: Array) -> ContactPair:
        geometry = meshing.flank_geometry(gears, side, share)
        return ContactPair(
            name=name,
            body_a=flanks.bodies[0],
            body_b=flanks.bodies[1],
            angle_ratio=1.0,
            phases=numbering.space_phases[0],
            geometry=geometry,
            gap_by_motion=monotone_table(FULL_TURN, meshing.gap_by_motion(gears, side)),
            slip_by_motion=monotone_table(FULL_TURN, meshing.slip_by_motion(gears, side)),
            width=gears.face_width,
            effective_modulus=reduced_modulus(*flanks.materials),
            roughness=float(np.hypot(*flanks.roughness)),
            law="hertz_line",
            structure_stiffness=stiffness,
            depth=_half_tooth(gears),
            friction_account="mesh_friction",
            facing_gap=float(geometry.values[:, 0].max()),
        )

    return (
        contact("drive_flank", loaded, meshing.load_share(gears, spaces.angles)),
        contact("coast_flank", other, np.zeros(spaces.angles.size)),
    )


def _half_tooth(gears: meshing.MeshedGears) -> float:
    """Half thickness of a tooth on the pitch circle: how deep contact deformation counts. [m]."""
    return 0.5 * gears.mesh.half_pitch * gears.mesh.pitch_radii[0]


def tooth_stiffness(gears: meshing.MeshedGears, flanks: FlankPair) -> float:
    r"""Stiffness of a tooth pair in bending, shear and at the root, per face width.

    Stiffness without the contact's own flattening. [N/m2]

    Notes
    -----
    ISO 6336-1 gives the largest stiffness of one pair, flattening included, as
    :math:`c' = 0.8 E / (E_{steel}\, q')` with the minimum flexibility q' of a polynomial in
    reciprocal tooth counts and profile shifts; a ring gear counts with an infinite tooth number.
    The flattening of the law of the contact, :math:`1/k_H` as its secant at 5 um of a module
    of 2.75 mm and in proportion, is taken off:
    :math:`1/\kappa = 1/c' - 1/k_H`.

    References
    ----------
    .. [1] ISO 6336-1:2006, section 9.3, method B.
    """
    counts = gears.teeth[0].tooth_count, gears.teeth[1].tooth_count
    # flexibility q' of one tooth pair of spur gears by ISO 6336-1. [mm um/N]
    teeth = [
        (1.0 / z if z > 0 else 0.0, x) for z, x in zip(counts, flanks.profile_shifts, strict=True)
    ]
    if counts[1] > 0:
        # the polynomial holds for the gear with the larger shift first
        teeth.sort(key=lambda tooth: -tooth[1])
    (first, x1), (second, x2) = teeth
    constant = 0.04723 + 0.15551 * first + 0.25791 * second
    linear = -0.00635 * x1 - 0.11654 * x1 * first - 0.00193 * x2 - 0.24188 * x2 * second
    total = _MEASURED_OVER_THEORY / (1e-9 * (constant + linear + 0.00529 * x1**2 + 0.00182 * x2**2))
    moduli = [material.elastic_modulus for material in flanks.materials]
    total *= 2.0 * moduli[0] * moduli[1] / (moduli[0] + moduli[1]) / _STEEL_MODULUS
    radius = _RADIUS_OVER_PITCH * gears.mesh.pitch_radii[0]
    half = _half_tooth(gears)
    depth, scale = _HERTZ_SHARE_DEPTH * half, hertz_scale(radius, radius / gears.mesh.ratio, half)
    contact_modulus = 0.5 * reduced_modulus(*flanks.materials)
    load, _, _, _ = logarithmic_law(depth, float(np.log(scale)), contact_modulus)
    return float(1.0 / (1.0 / total - depth / load))


def rigid_mesh(gears: meshing.MeshedGears) -> RigidMesh:
    """Rotation of the driven gear that keeps the loaded flanks touching.

    At the middle of the path of contact the gap changes by ``-n . q_drive + n . q_driven + lever
    q_rotation`` with the normal n; the lever is signed, and the contact force is the pressure
    torque on the driven gear over minus the lever.
    """
    middle = np.array([0.5 * sum(meshing.contact_range(gears))])
    side = meshing.facing_throats(gears.teeth, gears.mesh, gears.loaded_is_left, middle)
    normal, lever = side.normal[0], float(meshing.driven_lever(side, gears.mesh)[0])
    coefficients = np.append(np.concatenate([normal, -normal]) / lever, 0.0)
    return RigidMesh("drive_flank", coefficients.size - 1, coefficients, lever)
