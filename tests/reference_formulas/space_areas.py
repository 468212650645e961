"""Rate of the section area of a tooth space from the motion of its walls and throats."""

from __future__ import annotations

import numpy as np

from toothspace.core.types import Array
from toothspace.gearing.spaces import Spaces, other_end, own_end


def section_area_rates(spaces: Spaces) -> Array:
    r"""Derivative of the section areas with respect to the shaft angle.

    Parameters
    ----------
    spaces : Spaces
        Tooth spaces over their angle.

    Returns
    -------
    ndarray
        Rate. [m2/rad]

    Notes
    -----
    A wall that turns with speed :math:`\omega` between radii :math:`r_a` and :math:`r_b` sweeps
    :math:`-\frac{\omega}{2}(r_b^2 - r_a^2)`; a throat sweeps its length times the normal
    velocity of its middle.
    """
    sides = (spaces.right, spaces.left)
    near, far = ([end(spaces, side) for side in sides] for end in (own_end, other_end))
    (p_right, u_right), (p_left, u_left) = ((end.point, end.velocity) for end in near)
    (q_right, v_right), (q_left, v_left) = ((end.point, end.velocity) for end in far)
    drive, driven = 1.0, -spaces.mesh.ratio
    own_speed, other_speed = (drive, driven) if spaces.is_drive else (driven, drive)
    own = -0.5 * own_speed * (_square(p_left - spaces.center) - _square(p_right - spaces.center))
    other = (
        -0.5
        * other_speed
        * (_square(q_right - spaces.other_center) - _square(q_left - spaces.other_center))
    )
    left = 0.5 * _cross(u_left + v_left, q_left - p_left)
    right = 0.5 * _cross(u_right + v_right, p_right - q_right)
    return own + other + left + right


def _cross(a: Array, b: Array) -> Array:
    return a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]


def _square(a: Array) -> Array:
    return np.asarray(np.sum(a * a, axis=1))
