"""Tooth spaces as polygons, up to the throats of the mesh."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.types import Array
from toothspace.gearing.mesh_split import Throats
from toothspace.gearing.meshing import MeshedGears
from toothspace.gearing.numbering import FULL_TURN, Numbering
from toothspace.gearing.spaces import Spaces
from toothspace.gearing.tooth import Flank, Tooth
from toothspace.geometry.curve import turned

_ARC_STEP = np.deg2rad(1.0)


@final
@dataclass(frozen=True)
class _Side:
    # one end of a throat on one gear at one angle
    flank: Flank
    turn: float
    center: Array
    is_drive: bool
    inward: float
    along: float
    corner: float
    point: Array


@final
@dataclass(frozen=True)
class SpaceOutlines:
    """Outlines of all tooth spaces of a gear pair over the shaft angle.

    Parameters
    ----------
    gears : MeshedGears
        Gears in mesh.
    numbering : Numbering
        Phases of the spaces.
    """

    gears: MeshedGears
    numbering: Numbering

    def __call__(self, shaft_angle: float) -> list[Array]:
        """Outlines at a shaft angle [rad], in the order of the chambers. [m]."""
        first, second = (
            np.mod(phases + ratio * shaft_angle, FULL_TURN) - np.pi
            for phases, ratio in zip(
                self.numbering.space_phases, self.numbering.ratios, strict=True
            )
        )
        both = self.gears.spaces_at(first, second)
        return [space_outline(own, k) for own in both for k in range(own.angles.size)]


def space_outline(spaces: Spaces, index: int) -> Array:
    """Polygon of a tooth space at one of its angles.

    Returns
    -------
    ndarray, shape (points, 2)
        Outline, counter-clockwise, machine frame. [m]
    """
    right = _side(spaces, spaces.right, index, own=True)
    left = _side(spaces, spaces.left, index, own=True)
    own = [_flank_points(right)[::-1], _flank_points(left)]
    if max(spaces.left.weight[index], spaces.right.weight[index]) <= 0.0:
        return np.vstack([*own, _arc(left, left.corner, right.corner)])
    mouth = [_arc(left, left.corner, left.along), left.point[None, :]]
    entry = [right.point[None, :], _arc(right, right.along, right.corner)]
    return np.vstack([*entry, *own, *mouth, *_intruder(spaces, index)])


def _intruder(spaces: Spaces, index: int) -> list[Array]:
    right = _side(spaces, spaces.right, index, own=False)
    left = _side(spaces, spaces.left, index, own=False)
    return [
        left.point[None, :],
        _above(left),
        _arc(left, left.along, right.along),
        _above(right)[::-1],
        right.point[None, :],
    ]


def _side(spaces: Spaces, throat: Throats, index: int, *, own: bool) -> _Side:
    is_drive = spaces.is_drive == own
    tooth: Tooth = spaces.own if own else spaces.other
    flank = tooth.left if throat is spaces.left else tooth.right
    end = throat.drive if is_drive else throat.driven
    corner = float(end.corner[index])
    polar = 0.5 * np.pi + corner if is_drive else -0.5 * np.pi - corner
    return _Side(
        flank=flank,
        turn=polar - flank.corner_angle,
        center=spaces.center if own else spaces.other_center,
        is_drive=is_drive,
        inward=float(end.inward[index]),
        along=float(end.along[index]),
        corner=corner,
        point=end.point[index],
    )


def _placed(side: _Side, keep: Array) -> Array:
    starts = side.flank.coefficients[:, [0, 4]]
    radius, angle = side.flank.tip_radius, side.flank.corner_angle
    tip = radius * np.array([[np.cos(angle), np.sin(angle)]])
    # points between an arc and its chord would cross the chord
    inside = np.hypot(*starts.T) < radius * np.cos(0.5 * _ARC_STEP)
    clear = inside if radius > 0.0 else np.hypot(*starts.T) > -radius / np.cos(0.5 * _ARC_STEP)
    points = np.vstack([starts, tip])[keep & np.append(clear, True)]
    return turned(points, side.turn) + side.center


def _flank_points(side: _Side) -> Array:
    # from the root middle to the throat's end, or to the corner where it is beyond
    knots = side.flank.knots
    return _placed(side, knots <= knots[-1] - max(side.inward, 0.0))


def _above(side: _Side) -> Array:
    # from the throat's end to the corner
    knots = side.flank.knots
    if side.inward < 0.0:
        return np.empty((0, 2))
    return _placed(side, knots > knots[-1] - side.inward)


def _arc(side: _Side, start: float, end: float) -> Array:
    # without its ends, which are corners or throat ends
    count = 2 + int(abs(end - start) / _ARC_STEP)
    places = np.linspace(start, end, count)[1:-1]
    rise = np.cos(places) if side.is_drive else -np.cos(places)
    circle = np.column_stack([-np.sin(places), rise])
    return np.asarray(side.flank.tip_radius * circle + side.center, dtype=float)
