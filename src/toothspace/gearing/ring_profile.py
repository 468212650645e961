"""Ring gear from a closed curve of its teeth: the spaces are seen as teeth of an external gear."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.types import Array
from toothspace.gearing.tooth import LEFT, RIGHT, Tooth, flank_spline
from toothspace.geometry.curve import turned
from toothspace.geometry.gear_profile import GearProfile

_LAND = 2e-4
"""Height above the tip circle, over its radius, up to which points count to the tip land. [-]"""


@final
@dataclass(frozen=True)
class RingProfile:
    """Teeth of a ring gear from a curve."""

    spaces: GearProfile
    """The curve as a gear whose teeth are the ring's spaces."""

    @property
    def tip_radius(self) -> float:
        """Circle inside the teeth. [m]."""
        return self.spaces.root_radius

    @property
    def root_radius(self) -> float:
        """Circle at the bottom of the spaces. [m]."""
        return self.spaces.tip_radius

    @property
    def flank(self) -> Array:
        """Counter-clockwise flank of a tooth on the +x axis, from root middle to tip corner. [m].

        The curve is that of the clockwise half of the space ahead.
        """
        middle = (self.spaces.tip_start + self.spaces.tip_end) // 2
        half = self.spaces.points[: middle + 1][::-1]
        radius = np.hypot(*half.T)
        last = int(np.argmax(radius < self.tip_radius * (1.0 + _LAND)))
        turn = np.pi / self.spaces.tooth_count - np.arctan2(half[0, 1], half[0, 0])
        corner = turned(half[: last + 1], turn)
        corner[-1] *= self.tip_radius / np.hypot(*corner[-1])
        return np.asarray(corner, dtype=float)


def profile_tooth(ring: RingProfile) -> Tooth:
    """Splines through both flanks of a ring gear, whose count and radii are negative."""
    breaks = np.zeros(0, dtype=int)
    left = flank_spline(ring.flank * (-1.0, 1.0), breaks, LEFT, -ring.tip_radius)
    right = flank_spline(ring.flank * (-1.0, -1.0), breaks, RIGHT, -ring.tip_radius)
    return Tooth(left, right, -ring.spaces.tooth_count, -ring.tip_radius)


def profile_outline(ring: RingProfile, rotation: float) -> Array:
    """Teeth as one closed curve about the ring's centre, a tooth at an angle from x [rad]. [m]."""
    return ring.spaces.closed_polygon(rotation + np.pi / ring.spaces.tooth_count)
