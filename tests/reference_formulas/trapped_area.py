"""Area that two tooth contacts of a pump enclose between the gears."""

from __future__ import annotations

import numpy as np

from tests.reference_formulas.involute_contact import contact_points
from toothspace.core.types import Array
from toothspace.geometry.curve import signed_area
from toothspace.geometry.gear_pair import GearPair
from toothspace.geometry.gear_profile import GearProfile


def trapped_outline(
    pair: GearPair, drive: GearProfile, driven: GearProfile, midpoint: float = 0.0
) -> Array:
    """Outline of the chamber between two contacts one base pitch apart, backlash open.

    Parameters
    ----------
    pair : GearPair
        Gears in mesh, driven by the drive gear's leading flank.
    drive, driven : GearProfile
        Profiles of the two gears.
    midpoint : float
        Distance of the midpoint of both contacts from the pitch point along the motion of the
        contacts; 0 gives the smallest chamber. [m]

    Returns
    -------
    ndarray
        Closed polygon, frame of ``gear_pair``. [m]

    Notes
    -----
    Validity: both contacts on the involute. A contact that does not exist in reality (contact
    ratio below 1) leaves a gap that the polygon closes by its end points.
    """
    half = 0.5 * pair.base_pitch
    rear, front = contact_points(pair, np.array([midpoint - half, midpoint + half]))
    first = _along_drive(pair, drive, rear, front)
    second = _along_driven(pair, driven, rear, front)
    return np.vstack([rear, first, front, second[::-1]])


def trapped_area(
    pair: GearPair, drive: GearProfile, driven: GearProfile, midpoint: float = 0.0
) -> float:
    """Area of ``trapped_outline``, smallest for ``midpoint`` 0 [m2]."""
    return abs(signed_area(trapped_outline(pair, drive, driven, midpoint)))


def _along_drive(pair: GearPair, profile: GearProfile, rear: Array, front: Array) -> Array:
    # counter-clockwise: down the leading flank of one tooth, over the next to its leading flank
    radius = float(np.hypot(*rear))
    axis = np.arctan2(rear[1], rear[0]) - float(pair.drive.half_angle(radius))
    descending = _below(profile.left_flank, radius)
    following = _upto(profile, float(np.hypot(*front)))
    return np.vstack([_turned(descending, axis), _turned(following, axis + profile.pitch_angle)])


def _along_driven(pair: GearPair, profile: GearProfile, rear: Array, front: Array) -> Array:
    # clockwise: over the tip of one tooth to its other side, root, flank of the next tooth
    center = np.array([0.0, pair.center_distance])
    arm = rear - center
    radius = float(np.hypot(*arm))
    axis = np.arctan2(arm[1], arm[0]) - float(pair.driven.half_angle(radius))
    over_tip = _upto(profile, radius)[::-1]
    descending = _below(profile.left_flank, float(np.hypot(*(front - center))))[::-1]
    turned = [_turned(over_tip, axis), _turned(descending, axis - profile.pitch_angle)]
    return np.vstack(turned) + center


def _below(flank: Array, radius: float) -> Array:
    return flank[np.hypot(flank[:, 0], flank[:, 1]) < radius]


def _upto(profile: GearProfile, radius: float) -> Array:
    flank = profile.left_flank
    above = flank[np.hypot(flank[:, 0], flank[:, 1]) > radius]
    return np.vstack([profile.points[: profile.tip_end], above])


def _turned(points: Array, angle: float) -> Array:
    cosine, sine = np.cos(angle), np.sin(angle)
    return points @ np.array([[cosine, sine], [-sine, cosine]])
