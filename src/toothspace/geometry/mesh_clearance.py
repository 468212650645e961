"""Play between two gear profiles that roll on each other, for profiles of any origin."""

from __future__ import annotations

import numpy as np

from toothspace.geometry.gear_profile import GearProfile


def flank_clearance(
    drive: GearProfile, driven: GearProfile, center_distance: float, phases: int = 161
) -> float:
    """Smallest circumferential play between two profiles that roll with centred backlash.

    Parameters
    ----------
    drive, driven : GearProfile
        Profiles of any origin whose radius rises from root to tip.
    center_distance : float
        Distance of the gear centres. [m]
    phases : int
        Number of positions over the passage of a tooth.

    Returns
    -------
    float
        Arc length between a tooth and the flanks of the mating space, about half the
        circumferential backlash; negative where the gears overlap. [m]
    """
    return min(
        _clearance_in_space(drive, driven, center_distance, phases),
        _clearance_in_space(driven, drive, center_distance, phases),
    )


def _clearance_in_space(
    space: GearProfile, tooth: GearProfile, center_distance: float, phases: int
) -> float:
    reach = 2.5 * max(space.pitch_angle, tooth.pitch_angle * tooth.tooth_count / space.tooth_count)
    turn = np.linspace(-reach, reach, phases)[:, None]
    # the mating tooth points from its centre (0, a) towards the space on the y axis
    local = (tooth.points @ np.array([1.0, 1j]))[None, :]
    mating = local * np.exp(-1j * turn * space.tooth_count / tooth.tooth_count)
    placed = (center_distance - mating) * np.exp(-1j * turn)
    radius, angle = np.abs(placed), np.abs(np.angle(placed))
    flank = space.left_flank[::-1]
    flank_radius = np.maximum.accumulate(np.hypot(flank[:, 0], flank[:, 1]))
    half_space = 0.5 * space.pitch_angle - np.arctan2(flank[:, 1], flank[:, 0])
    limit = np.interp(radius, flank_radius, half_space)
    inside = radius < space.tip_radius
    play = np.where(inside, radius * (limit - angle), np.inf)
    return float(np.min(np.where(angle < 1.5 * space.pitch_angle, play, np.inf)))
