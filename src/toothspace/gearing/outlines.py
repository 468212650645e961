"""Tooth spaces as polygons, up to the throats of the mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.types import Array, IntArray
from toothspace.gearing.mesh_split import Throats
from toothspace.gearing.meshing import MeshedGears
from toothspace.gearing.numbering import FULL_TURN, Numbering
from toothspace.gearing.spaces import Spaces
from toothspace.gearing.tooth import Tooth
from toothspace.geometry.curve import turned

_ARC_STEP = np.deg2rad(1.0)


@final
@dataclass(frozen=True)
class _Side:
    # ends of a throat on one gear at several angles: the flank's points, those short of the end
    flank: Array
    count: IntArray
    center: Array
    tip_radius: float
    rise: float
    along: Array
    corner: Array
    end: Array

    def short_of_end(self, index: int) -> Array:
        # from the root middle to the throat's end, or to the corner where it is beyond
        return self.flank[index, : self.count[index]]

    def above(self, index: int) -> Array:
        # from the throat's end to the corner
        return self.flank[index, self.count[index] :]

    def point(self, index: int) -> Array:
        return self.end[index, None, :]

    def arc(self, start: float, end: float) -> Array:
        # without its ends, which are corners or throat ends
        steps = 1 + int(abs(end - start) / _ARC_STEP)
        places = np.arange(1, steps) * ((end - start) / steps) + start
        circle = np.array([-np.sin(places), self.rise * np.cos(places)]).T
        return np.asarray(self.tip_radius * circle + self.center, dtype=float)


@final
@dataclass(frozen=True)
class SpaceOutlines:
    """Outlines of all tooth spaces of a gear pair over the shaft angle."""

    gears: MeshedGears
    """Gears in mesh."""
    numbering: Numbering
    """Phases of the spaces."""

    def __call__(self, shaft_angle: float) -> list[Array]:
        """Outlines at a shaft angle [rad], in the order of the chambers. [m]."""
        first, second = (
            np.mod(phases + ratio * shaft_angle, FULL_TURN) - np.pi
            for phases, ratio in zip(
                self.numbering.space_phases, self.numbering.ratios, strict=True
            )
        )
        both = self.gears.spaces_at(first, second)
        return [outline for own in both for outline in space_outlines(own)]


def space_outlines(spaces: Spaces, indices: IntArray | None = None) -> list[Array]:
    """Polygons of a tooth space at its angles.

    Parameters
    ----------
    indices : ndarray of int or None
        Numbers of the angles; None for all.

    Returns
    -------
    list of ndarray, shape (points, 2)
        Outlines, counter-clockwise, machine frame. [m]
    """
    at = np.arange(spaces.angles.size) if indices is None else indices
    right, left = (_side(spaces, side, at, own=True) for side in (spaces.right, spaces.left))
    mate_right, mate_left = (
        _side(spaces, side, at, own=False) for side in (spaces.right, spaces.left)
    )
    in_mesh = np.maximum(spaces.left.weight, spaces.right.weight)[at] > 0.0
    outlines = []
    for k, meshed in enumerate(in_mesh):
        # both begin in the middle of the root
        flanks = [right.short_of_end(k)[::-1], left.short_of_end(k)[1:]]
        if not meshed:
            outlines.append(np.concatenate([*flanks, left.arc(left.corner[k], right.corner[k])]))
            continue
        entry = [right.point(k), right.arc(right.along[k], right.corner[k])]
        mouth = [left.arc(left.corner[k], left.along[k]), left.point(k)]
        tip = mate_left.arc(mate_left.along[k], mate_right.along[k])
        intruder = [mate_left.point(k), mate_left.above(k)]
        back = [mate_right.above(k)[::-1], mate_right.point(k)]
        outlines.append(np.concatenate([*entry, *flanks, *mouth, *intruder, tip, *back]))
    return outlines


def _side(spaces: Spaces, throat: Throats, at: IntArray, *, own: bool) -> _Side:
    is_drive = spaces.is_drive == own
    tooth: Tooth = spaces.own if own else spaces.other
    flank = tooth.left if throat is spaces.left else tooth.right
    end = throat.drive if is_drive else throat.driven
    center, corner = spaces.center if own else spaces.other_center, end.corner[at]
    polar = 0.5 * np.pi + corner if is_drive else -0.5 * np.pi - corner
    # knots with the tip corner, without those between an arc and its chord: they would cross it
    starts, radius = flank.coefficients[:, [0, 4]], flank.tip_radius
    inside = np.hypot(*starts.T) < radius * np.cos(0.5 * _ARC_STEP)
    clear = inside if radius > 0.0 else np.hypot(*starts.T) > -radius / np.cos(0.5 * _ARC_STEP)
    tip = radius * np.array([[np.cos(flank.corner_angle), np.sin(flank.corner_angle)]])
    keep = np.append(clear, True)
    points, knots = np.vstack([starts, tip])[keep], flank.knots[keep]
    beyond = np.searchsorted(knots, flank.knots[-1] - np.maximum(end.inward[at], 0.0), "right")
    return _Side(
        flank=turned(points, (polar - flank.corner_angle)[:, None]) + center,
        count=beyond,
        center=center,
        tip_radius=flank.tip_radius,
        rise=1.0 if is_drive else -1.0,
        along=end.along[at],
        corner=corner,
        end=end.point[at],
    )
