"""Distance of the flanks of a profile from the involute of a gear."""

from __future__ import annotations

import numpy as np

from toothspace.core.types import Array
from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.involute import InvoluteGear, tooth_form


def deviations(profile: GearProfile, gear: InvoluteGear) -> Array:
    """Along the normal, both flanks between the ends of the involute, positive for excess. [m]."""
    form, found = tooth_form(gear), []
    for flank in (profile.right_flank * (1.0, -1.0), profile.left_flank):
        radius, angle = np.hypot(*flank.T), np.arctan2(flank[:, 1], flank[:, 0])
        inside = (radius >= form.form_radius) & (radius <= form.tip_form_radius)
        distance = gear.base_radius * (angle - gear.half_angle(radius))
        found.append(distance[inside])
    return np.concatenate(found)
