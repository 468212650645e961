"""Volumes of the tooth spaces, their exact derivatives and their shapes."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.types import Array
from toothspace.gearing.mesh_split import Mesh, ThroatEnd, Throats, throats
from toothspace.gearing.tooth import Tooth


@final
@dataclass(frozen=True)
class Spaces:
    """Tooth spaces of one gear over their own angle, between their two throats."""

    own: Tooth
    other: Tooth
    """The gear of the spaces, and the gear whose tooth enters them."""
    mesh: Mesh
    """Gears in mesh."""
    is_drive: bool
    """Whether the spaces belong to the drive gear."""
    angles: Array
    """Place of the middle of the space, from the centre line in the sense of rotation. [rad]"""
    left: Throats
    right: Throats
    """Throats between left flanks and between right flanks. The left one is at the tooth behind a
    drive space and at the tooth ahead of a driven space.
    """

    @property
    def center(self) -> Array:
        """Centre of the gear. [m]."""
        return np.array([0.0, 0.0 if self.is_drive else self.mesh.center_distance])

    @property
    def other_center(self) -> Array:
        """Centre of the other gear. [m]."""
        return np.array([0.0, self.mesh.center_distance if self.is_drive else 0.0])

    @property
    def angle_ratio(self) -> float:
        """Growth of the angle per shaft angle. [-]."""
        return 1.0 if self.is_drive else self.mesh.ratio


def drive_spaces(drive: Tooth, driven: Tooth, mesh: Mesh, angles: Array) -> Spaces:
    """Tooth spaces of the drive gear at angles [rad]."""
    left = throats(drive.left, driven.left, mesh, angles)
    right = throats(drive.right, driven.right, mesh, angles)
    return Spaces(drive, driven, mesh, True, angles, left, right)


def driven_spaces(drive: Tooth, driven: Tooth, mesh: Mesh, angles: Array) -> Spaces:
    """Tooth spaces of the driven gear at angles [rad]."""
    ahead = (angles + mesh.turn + 0.5 * driven.pitch_angle) / mesh.ratio
    left = throats(drive.left, driven.left, mesh, ahead)
    right = throats(drive.right, driven.right, mesh, ahead - 2.0 * mesh.half_pitch)
    return Spaces(driven, drive, mesh, False, angles, left, right)


def own_end(spaces: Spaces, side: Throats) -> ThroatEnd:
    """End of a throat on the gear of the spaces."""
    return side.drive if spaces.is_drive else side.driven


def other_end(spaces: Spaces, side: Throats) -> ThroatEnd:
    """End of a throat on the other gear."""
    return side.driven if spaces.is_drive else side.drive


def section_areas(spaces: Spaces) -> Array:
    r"""Section area of the tooth spaces.

    Area inside the tip circles, up to the throats. [m2]

    Notes
    -----
    Green's theorem :math:`A = \frac12 \oint (x\,dy - y\,dx)` along own flanks, throats, the
    other gear's tooth and the tip circles; the flank parts are integrals of the splines.
    """
    right, left = (own_end(spaces, side) for side in (spaces.right, spaces.left))
    far_right, far_left = (other_end(spaces, side) for side in (spaces.right, spaces.left))
    own = left.swept - right.swept
    tooth = spaces.other
    tip = 0.5 * tooth.tip_radius**2 * (tooth.right.corner_angle - tooth.left.corner_angle)
    beyond = (far_right.swept - tooth.right.area[-1]) - (far_left.swept - tooth.left.area[-1])
    offset = spaces.other_center - spaces.center
    shift = 0.5 * _cross(offset[None, :], far_right.point - far_left.point)
    segments = 0.5 * (
        _cross(left.point - spaces.center, far_left.point - spaces.center)
        + _cross(far_right.point - spaces.center, right.point - spaces.center)
    )
    return own + tip + beyond + shift + segments


def wall_ends(spaces: Spaces, side: Throats, of_own: bool) -> Array:
    """Where pressure on a gear's wall changes from one chamber to the next.

    Middle of the throat, middle of the tip land where there is no throat, shape (angles, 2). [m]

    Parameters
    ----------
    side : Throats
        Their left or right throats.
    of_own : bool
        Whether the wall belongs to the gear of the spaces or to the other gear.
    """
    drive_wall = of_own == spaces.is_drive
    tooth = spaces.own if of_own else spaces.other
    corner = (side.drive if drive_wall else side.driven).corner
    flank = tooth.left if side is spaces.left else tooth.right
    # places grow with the rotation: with the polar angle on the drive gear, against it on the other
    along = corner - flank.corner_angle if drive_wall else corner + flank.corner_angle
    rise = np.cos(along) if drive_wall else -np.cos(along)
    height = 0.0 if drive_wall else spaces.mesh.center_distance
    tip = np.column_stack([-np.sin(along), rise]) * tooth.tip_radius + np.array([0.0, height])
    weight = side.weight[:, None]
    return (1.0 - weight) * tip + weight * side.middle


def area_by_motion(spaces: Spaces) -> Array:
    r"""Derivative of the section areas with respect to the micro-motions of both gears.

    Drive x, drive y, driven x, driven y [m2/m], driven rotation [m2/rad], shape (angles, 5).

    Notes
    -----
    A wall from :math:`a` to :math:`b`, fluid on its left, sweeps :math:`e_x (y_b - y_a) -
    e_y (x_b - x_a)` when shifted by :math:`e`. Throats are cut in half between the gears, so the
    shear force in the throat is contained.
    """
    own = wall_ends(spaces, spaces.right, True), wall_ends(spaces, spaces.left, True)
    other = wall_ends(spaces, spaces.left, False), wall_ends(spaces, spaces.right, False)
    drive, driven = (own, other) if spaces.is_drive else (other, own)
    center = np.array([0.0, spaces.mesh.center_distance])
    near, far = (np.sum((end - center) ** 2, axis=1) for end in driven)
    (drive_x, drive_y), (driven_x, driven_y) = ((end - start).T for start, end in (drive, driven))
    return np.column_stack([drive_y, -drive_x, driven_y, -driven_x, -0.5 * (far - near)])


def _cross(a: Array, b: Array) -> Array:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
