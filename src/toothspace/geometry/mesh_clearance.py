"""Play between two gear profiles that roll on each other, for profiles of any origin."""

from __future__ import annotations

import numpy as np

from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.involute_gear import involute_function


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


def normal_play(profiles: tuple[GearProfile, GearProfile], distance: float) -> float:
    r"""Normal backlash of two profiles, negative where they overlap.

    Parameters
    ----------
    profiles : tuple of GearProfile
        Drive and driven gear.
    distance : float
        Distance of the centres. [m]

    Returns
    -------
    float
        Play along the common normal. [m]

    Notes
    -----
    Of involutes with half angles :math:`\vartheta_b` on the base circles,
    :math:`j_n = 2 (r_{b1} + r_{b2}) (\mathrm{inv}\,\alpha_w - (z_1 \vartheta_{b1} +
    z_2 \vartheta_{b2} - \pi)/(z_1 + z_2))`; below the sum of the base radii and for other flanks
    twice the arc between a tooth and the space around it.
    """
    flanks = [profile.involute for profile in profiles]
    if flanks[0] is None or flanks[1] is None:
        return 2.0 * flank_clearance(*profiles, distance)
    bases = flanks[0].base_radius + flanks[1].base_radius
    if distance <= bases:
        return 2.0 * flank_clearance(*profiles, distance)
    counts = [profile.tooth_count for profile in profiles]
    tight = counts[0] * flanks[0].base_half_angle + counts[1] * flanks[1].base_half_angle - np.pi
    working = involute_function(np.arccos(bases / distance))
    return float(2.0 * bases * (working - tight / sum(counts)))


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
