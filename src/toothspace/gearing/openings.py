"""Tooth spaces as polygons, and their openings to ports along the bore and to relief grooves."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, final

import numpy as np
import shapely

from toothspace.core.recall import recalled
from toothspace.core.types import Array, IntArray
from toothspace.gearing.mesh_split import Throats
from toothspace.gearing.meshing import MeshedGears
from toothspace.gearing.numbering import FULL_TURN, Numbering
from toothspace.gearing.spaces import Spaces, other_end, own_end
from toothspace.gearing.tooth import Tooth
from toothspace.geometry.curve import enclosed, turned

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

    Outlines, counter-clockwise, machine frame, shape (points, 2). [m]

    Parameters
    ----------
    indices : ndarray of int or None
        Numbers of the angles; None for all.
    """
    at = np.arange(spaces.angles.size) if indices is None else indices
    right, left = (_side(spaces, side, at, own=True) for side in (spaces.right, spaces.left))
    mate_right, mate_left = (
        _side(spaces, side, at, own=False) for side in (spaces.right, spaces.left)
    )
    in_mesh = np.maximum(spaces.left.weight, spaces.right.weight)[at] > 0.0
    outlines = []
    for k, meshed in enumerate(in_mesh):
        # both from the middle of the root to the throat's end, or to the corner before it
        flanks = [right.flank[k, : right.count[k]][::-1], left.flank[k, 1 : left.count[k]]]
        if not meshed:
            outlines.append(np.concatenate([*flanks, left.arc(left.corner[k], right.corner[k])]))
            continue
        entry = [right.end[k, None], right.arc(right.along[k], right.corner[k])]
        opening = [left.arc(left.corner[k], left.along[k]), left.end[k, None]]
        tip = mate_left.arc(mate_left.along[k], mate_right.along[k])
        # of the mate, from the throat's end to the corner
        intruder = [mate_left.end[k, None], mate_left.flank[k, mate_left.count[k] :]]
        back = [mate_right.flank[k, mate_right.count[k] :][::-1], mate_right.end[k, None]]
        outlines.append(np.concatenate([*entry, *flanks, *opening, *intruder, tip, *back]))
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


_LEAST_AREA = 1e-12


def port_lengths(spaces: Spaces, edges: tuple[float, float]) -> tuple[Array, Array]:
    """Length of the port opening of a tooth space at inlet and outlet.

    Arc length on the tip circles between lens and port edge, to inlet and outlet. [m]

    Parameters
    ----------
    edges : tuple of float
        Angle from the mesh side of the centre line to the edges of inlet and outlet port. [rad]
    """
    (inlet_edge, outlet_edge), tip = edges, abs(spaces.own.tip_radius)
    mesh = spaces.mesh
    both = abs(mesh.lens_drive), abs(mesh.lens_driven)
    lens, other_lens = both if spaces.is_drive else both[::-1]
    # in the sense of rotation: on a ring gear places of the mesh count against it
    sense, other_sense = np.sign(spaces.own.tip_radius), np.sign(spaces.other.tip_radius)
    # the left flank of a drive space is on the tooth behind, that of a driven space ahead
    sides = (spaces.left, spaces.right) if spaces.is_drive else (spaces.right, spaces.left)
    near, far = (own_end(spaces, side) for side in sides)
    behind, ahead, last, first = (
        sense * place for place in (near.corner, far.corner, near.along, far.along)
    )
    turn = 2.0 * np.pi
    inlet = _overlap(np.maximum(first, behind), ahead, lens, inlet_edge)
    inlet += _overlap(behind + turn, ahead + turn, lens, inlet_edge)
    outlet = _overlap(behind, np.minimum(last, ahead), -outlet_edge, -lens)
    outlet += _overlap(behind - turn, ahead - turn, -outlet_edge, -lens)
    # a throat that ends on the other gear's tip circle leaves its arc up to the lens to this space
    radius = abs(spaces.other.tip_radius)
    beyond_in, beyond_out = np.zeros(spaces.angles.size), np.zeros(spaces.angles.size)
    for side in (spaces.left, spaces.right):
        along = other_sense * other_end(spaces, side).along
        there = side.weight > 0.0
        beyond_in += np.where(there, np.maximum(along - other_lens, 0.0), 0.0)
        beyond_out += np.where(there, np.maximum(-other_lens - along, 0.0), 0.0)
    return tip * inlet + radius * beyond_in, tip * outlet + radius * beyond_out


def _overlap(start: Array, end: Array, low: float, high: float) -> Array:
    return np.maximum(np.minimum(end, high) - np.maximum(start, low), 0.0)


_REACH_STEP = 0.5
_KEPT, _KEPT_RECESSES = 6, 24


@recalled(_KEPT)
def _enclosed_spaces(spaces: Spaces, indices: IntArray) -> Any:
    """Tooth spaces at some of their angles, as polygons. [m]."""
    return enclosed(space_outlines(spaces, indices))


@recalled(_KEPT_RECESSES)
def _overlaps_with(groove: Array, spaces: Spaces, indices: IntArray) -> tuple[Array, Array, Array]:
    """Area [m2], perimeter and extent along y [m] of what spaces share with a recess."""
    shared = shapely.intersection(_enclosed_spaces(spaces, indices), shapely.Polygon(groove))
    bounds = np.nan_to_num(shapely.bounds(shared))
    return shapely.area(shared), shapely.length(shared), bounds[:, 3] - bounds[:, 1]


def groove_openings(
    spaces: Spaces, polygons: Mapping[str, Array], depth: float
) -> dict[str, Array]:
    r"""Openings of the tooth spaces into the recesses of one face.

    For each recess an array of shape (nodes, 2): area [m2] and hydraulic diameter [m].

    Parameters
    ----------
    polygons : mapping of name to ndarray, shape (n, 2)
        Outlines of the recesses. [m]
    depth : float
        Their depth. [m]

    Notes
    -----
    Fluid passes the overlap of tooth space and groove along the axis, then the groove's own
    depth sideways; both areas act in series,

    .. math:: A^{-2} = A_o^{-2} + (t\,w)^{-2},

    with the overlap :math:`A_o`, its extent :math:`w` along y and the groove depth :math:`t`.
    The hydraulic diameter is that of the overlap, four times its area over its perimeter.
    """
    if not polygons:
        return {}
    reaches = []
    for groove in polygons.values():
        if shapely.Polygon(groove).buffer(1e-6).contains(shapely.Point(*spaces.center)):
            place = float(np.pi)
        else:
            x, y = (groove - spaces.center).T
            rise = y if spaces.is_drive or spaces.own.tip_radius < 0.0 else -y
            place = float(np.max(np.abs(np.arctan2(x, rise))) + abs(spaces.own.pitch_angle))
        reaches.append(place)
    # in whole steps, so that outlines are known where a recess is moved
    step = _REACH_STEP * abs(spaces.own.pitch_angle)
    near = np.flatnonzero(np.abs(spaces.angles) < step * np.ceil(max(reaches) / step))
    found = {}
    for name, groove in polygons.items():
        table = np.zeros((spaces.angles.size, 2))
        overlaps = _overlaps_with(groove, spaces, near)
        there = overlaps[0] > _LEAST_AREA
        area, perimeter, extent = (part[there] for part in overlaps)
        passage = depth * extent
        series = area * passage / np.hypot(area, passage)
        table[near[there]] = np.column_stack([series, 4.0 * area / perimeter])
        found[name] = table
    return found
