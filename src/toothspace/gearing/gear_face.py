"""Face of a toothed body against a wall: its section, tooth spaces and recesses opposite."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import final

import numpy as np
import shapely

from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.geometry.curve import polar_moment
from toothspace.geometry.gear_profile import GearProfile
from toothspace.model.film_faces import FILM, NO_BODY, ChamberRing, FaceCells

_FLANK_POINTS = 400


@final
@dataclass(frozen=True, eq=False)
class GearSection:
    """Section of an external gear in the machine frame over the shaft angle."""

    profile: GearProfile
    """One tooth."""
    center: tuple[float, float]
    """Axis. [m]"""
    first_tooth: float
    """Polar angle of the middle of a tooth at shaft angle zero. [rad]"""
    speed_ratio: float
    """Angular speed over shaft speed. [-]"""
    _flanks: tuple[Array, Array, Array] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        radii = np.linspace(self.profile.root_radius, self.profile.tip_radius, _FLANK_POINTS)
        sides = []
        for flank in (self.profile.right_flank, self.profile.left_flank[::-1]):
            radius, angle = np.hypot(*flank.T), np.arctan2(flank[:, 1], flank[:, 0])
            rising = np.maximum.accumulate(radius) == radius
            sides.append(np.interp(radii, radius[rising], angle[rising]))
        object.__setattr__(self, "_flanks", (radii, *sides))

    def tooth_angle(self, shaft_angle: float) -> float:
        """Angle of the middle of a tooth at a shaft angle. [rad]."""
        return self.first_tooth + self.speed_ratio * shaft_angle

    def polar(self, x: Array, y: Array) -> tuple[Array, Array]:
        """Radii [m] and angles [rad] of points about the axis."""
        along, rise = x - self.center[0], y - self.center[1]
        return np.hypot(along, rise), np.arctan2(rise, along)

    def flank(self, side: int) -> tuple[Array, Array]:
        """Radii [m] and angles [rad] of a flank from its tooth's middle, side 0 left, 1 right."""
        radii, right, left = self._flanks
        return radii, (left, right)[side]

    def contains(self, shaft_angle: float, x: Array, y: Array) -> BoolArray:
        """Whether points [m] lie in the section at a shaft angle [rad]."""
        (radius, polar), pitch = self.polar(x, y), self.profile.pitch_angle
        place = np.mod(polar - self.tooth_angle(shaft_angle) + 0.5 * pitch, pitch) - 0.5 * pitch
        radii, right, left = self._flanks
        low, high = np.interp(radius, radii, right), np.interp(radius, radii, left)
        on_tooth = (place >= low) & (place <= high) & (radius <= self.profile.tip_radius)
        return np.asarray((radius <= self.profile.root_radius) | on_tooth)


@final
@dataclass(frozen=True, eq=False)
class GearFace:
    """Face map of one gear with its tooth spaces."""

    section: GearSection
    """The gear."""
    spaces: ChamberRing
    """Its tooth spaces."""
    recesses: Sequence[tuple[int, Array]] = ()
    """Recesses of the wall: node that feeds them, and outline. [m]"""

    def __call__(self, shaft_angle: float, x: Array, y: Array) -> FaceCells:
        """Nodes and the gear at points; angles in [rad], places in [m]."""
        own = self.section.contains(shaft_angle, x, y)
        node = np.where(own, FILM, self.spaces.nodes[self.spaces.nearest(shaft_angle, x, y)])
        return FaceCells(under_recesses(node, own, self.recesses, x, y), np.where(own, 0, NO_BODY))


def tooth_fraction(profile: GearProfile) -> float:
    """Part of the ring between root and tip that is tooth, weighted with r^2. [-]."""
    tip, root = profile.tip_radius, profile.root_radius
    teeth = polar_moment(profile.closed_polygon()) - 0.5 * np.pi * root**4
    return float(teeth / (0.5 * np.pi * (tip**4 - root**4)))


def under_recesses(
    node: IntArray, covered: BoolArray, recesses: Sequence[tuple[int, Array]], x: Array, y: Array
) -> IntArray:
    """Nodes of points, those of recesses where a body covers them.

    Parameters
    ----------
    node : ndarray of int
        Nodes without recesses.
    covered : ndarray of bool
        Where a body stands.
    recesses : sequence of (int, ndarray)
        Node and outline of every recess. [m]
    x, y : ndarray
        Points. [m]
    """
    found = node.copy()
    for fed_by, outline in recesses:
        shape = shapely.Polygon(outline)
        shapely.prepare(shape)
        found[covered & shapely.contains_xy(shape, x, y)] = fed_by
    return found
