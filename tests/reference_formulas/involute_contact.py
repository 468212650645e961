"""Contact of two external involute gears on the line of action."""

from __future__ import annotations

import numpy as np

from toothspace.core.types import Array, FloatOrArray
from toothspace.geometry.gear_pair import GearPair


def contact_points(pair: GearPair, position: FloatOrArray, mode: str = "pump") -> Array:
    """Points at distances from the pitch point along the motion of the contact. [m]."""
    along = np.atleast_1d(np.asarray(position, dtype=float))
    sine = np.sin(pair.operating_pressure_angle) * (1.0 if mode == "pump" else -1.0)
    cosine = np.cos(pair.operating_pressure_angle)
    return np.column_stack([-cosine * along, pair.pitch_radii[0] + sine * along])


def curvature_radii(
    pair: GearPair, position: FloatOrArray, mode: str = "pump"
) -> tuple[FloatOrArray, FloatOrArray]:
    """Radii of curvature of the drive and the driven flank in contact, both convex. [m]."""
    roll_1, roll_2 = pair.pitch_roll_lengths
    outward = np.asarray(position) if mode == "pump" else -np.asarray(position)
    return roll_1 + outward, roll_2 - outward
