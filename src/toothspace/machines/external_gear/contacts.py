"""Contact of the loaded flanks and what follows from it: displacement and ideal flow."""

from __future__ import annotations

import numpy as np

from toothspace.core.types import Array
from toothspace.gearing.mesh_split import Throats
from toothspace.gearing.spaces import Spaces
from toothspace.geometry.gear_pair import displacement_per_radian
from toothspace.machines.external_gear.assembly import (
    Assembly,
    driven_lever,
    facing_throats,
)
from toothspace.machines.external_gear.loads import MOTIONS
from toothspace.model.description import RigidMesh

CONTACT_TOLERANCE = 1e-6
"""Gap above that of the touching pair up to which a second flank pair counts as touching. [m]"""

_LEAST_RATIO = 1.02
_SAMPLES = 1441
_NO_THROAT = 1.0


def loaded_throats(assembly: Assembly, spaces: Spaces) -> Throats:
    """Throats of the drive spaces at the flanks that carry the load."""
    return spaces.left if assembly.loaded_is_left else spaces.right


def contact_range(assembly: Assembly) -> tuple[float, float]:
    """Throat angles at which the loaded flank pair begins and ends to touch.

    Parameters
    ----------
    assembly : Assembly
        Gears in mesh.

    Returns
    -------
    tuple of float
        Range, at least 1.02 pitches long. [rad]
    """
    mesh = assembly.mesh
    pitch = 2.0 * mesh.half_pitch
    reach = mesh.lens_drive + 2.0 * pitch
    angles = np.linspace(-reach, reach, _SAMPLES)
    gap = _complete_gap(facing_throats(assembly.teeth, mesh, assembly.loaded_is_left, angles))
    neighbours = [
        _complete_gap(facing_throats(assembly.teeth, mesh, assembly.loaded_is_left, angles + shift))
        for shift in (-pitch, pitch)
    ]
    least = np.minimum(gap, np.minimum(*neighbours))
    touching = angles[(gap < _NO_THROAT) & (gap <= least + CONTACT_TOLERANCE)]
    start, end = float(touching[0]), float(touching[-1])
    missing = max(_LEAST_RATIO * pitch - (end - start), 0.0)
    return start - 0.5 * missing, end + 0.5 * missing


def _complete_gap(side: Throats) -> Array:
    return np.where(side.weight >= 1.0, side.gap, _NO_THROAT)


def load_share(assembly: Assembly, angles: Array) -> Array:
    """Share of the contact force that a flank pair carries.

    Parameters
    ----------
    assembly : Assembly
        Gears in mesh.
    angles : ndarray
        Throat angles. [rad]

    Returns
    -------
    ndarray
        Share, 0 out of contact and smooth in between; the shares of pairs one pitch apart
        sum to 1 at every angle. [-]
    """
    start, end = contact_range(assembly)
    pitch = 2.0 * assembly.mesh.half_pitch
    ramp = min(end - start - pitch, 0.5 * (end - start))
    total = np.zeros_like(angles)
    for shift in range(-3, 4):
        total += _bump(angles + shift * pitch, start, end, ramp)
    own = _bump(angles, start, end, ramp)
    return np.asarray(own / np.where(own > 0.0, total, 1.0), dtype=float)


def _bump(angles: Array, start: float, end: float, ramp: float) -> Array:
    t = np.clip(np.minimum(angles - start, end - angles) / ramp, 0.0, 1.0)
    return np.asarray(t * t * (3.0 - 2.0 * t), dtype=float)


def rigid_mesh(assembly: Assembly) -> RigidMesh:
    """Rotation of the driven gear that keeps the loaded flanks touching.

    The gap changes by ``-n . q_drive + n . q_driven + lever q_rotation`` with the normal n at
    the middle of the path of contact; the lever is signed, and the contact force is the pressure
    torque on the driven gear over minus the lever.
    """
    middle = np.array([0.5 * sum(contact_range(assembly))])
    side = facing_throats(assembly.teeth, assembly.mesh, assembly.loaded_is_left, middle)
    lever = float(driven_lever(side, assembly.mesh)[0])
    normal = side.normal[0]
    coefficients = np.zeros(len(MOTIONS))
    coefficients[:4] = np.concatenate([normal, -normal]) / lever
    return RigidMesh("drive_flank", len(MOTIONS) - 1, coefficients, lever)


def ideal_flow(assembly: Assembly, angles: Array) -> Array:
    r"""Volume delivered per radian while a throat at given angles seals inlet from outlet.

    Parameters
    ----------
    assembly : Assembly
        Gears in mesh.
    angles : ndarray
        Throat angles of the loaded flanks. [rad]

    Returns
    -------
    ndarray
        Flow rate over shaft speed. [m3/rad]

    Notes
    -----
    .. math:: \frac{Q}{\omega} = \frac{b}{2}\left[r_{a1}^2 - r_1^2
              + \frac{z_1}{z_2} (r_{a2}^2 - r_2^2)\right]

    with the distances :math:`r_1, r_2` of the throat's middle from the centres.
    """
    side = facing_throats(assembly.teeth, assembly.mesh, assembly.loaded_is_left, angles)
    drive, driven = assembly.teeth
    center = np.array([0.0, assembly.mesh.center_distance])
    near = drive.tip_radius**2 - np.sum(side.middle**2, axis=1)
    far = driven.tip_radius**2 - np.sum((side.middle - center) ** 2, axis=1)
    return np.asarray(0.5 * assembly.face_width * (near + assembly.mesh.ratio * far), dtype=float)


def flow_over_pitch(assembly: Assembly, samples: int = 1200) -> Array:
    """Ideal single-flank flow over one pitch: the contact nearest to the pitch point seals."""
    pitch = 2.0 * assembly.mesh.half_pitch
    steps = pitch * np.arange(samples) / samples
    start, end = contact_range(assembly)
    angles = 0.5 * (start + end) + steps[:, None] + pitch * np.arange(-2, 2)[None, :]
    flow = ideal_flow(assembly, angles.ravel()).reshape(angles.shape)
    inside = (angles >= start) & (angles <= end)
    return np.asarray(np.max(np.where(inside, flow, 0.0), axis=1), dtype=float)


def displacement(assembly: Assembly) -> float:
    """Geometric displacement per radian, single flank: closed form for involutes. [m3/rad]."""
    if assembly.pair is not None:
        return displacement_per_radian(assembly.pair, assembly.face_width)
    return float(np.mean(flow_over_pitch(assembly)))
