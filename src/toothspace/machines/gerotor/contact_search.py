"""Where the lobes of two rotors come closest, followed over the angle.

The rotors look the same after the outer one has turned by one pitch, each place on it being
one tooth farther back. So one pitch is searched; a closest place that leaves it re-enters at
its start, one tooth farther back on both outlines.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.geometry.curve import turned
from toothspace.machines.gerotor.profiles import Rotors

_OUTER_SAMPLES = 260
_BISECTIONS = 26
_LOST_NODES = 3
_FARTHEST, _SEARCHED = 0.24, 0.32
"""Step of a closest place, and gap that is looked at, over the eccentricity. [-]"""


@final
@dataclass(frozen=True)
class ClosestPoints:
    """Places where the outlines come closest, one row each."""

    node: IntArray
    """Number of the angle."""
    outer: Array
    inner: Array
    """Arc lengths on the outlines. [m]"""
    gap: Array
    """Distance, negative where they overlap. [m]"""


@final
@dataclass(frozen=True)
class Branch:
    """One closest place over the nodes at which it exists."""

    first: int
    """Node at which it begins, counted from the start of a pitch."""
    rows: IntArray
    """Row of :class:`ClosestPoints` at each following node; -1 where it is lost for a moment."""
    closed: bool
    """It never ends; the last node leads to the first."""


def distance_to_inner(rotors: Rotors, angle: Array, place: Array) -> tuple[Array, Array]:
    """Nearest place on the inner rotor for places on the outer one.

    Parameters
    ----------
    angle : ndarray
        Angles of the outer rotor. [rad]
    place : ndarray
        Arc lengths on the outer outline. [m]

    Returns
    -------
    inner : ndarray
        Arc lengths on the inner outline. [m]
    gap : ndarray
        Distance, negative within the inner rotor. [m]
    """
    seen = seen_from_inner(rotors, angle, place)
    inner = rotors.inner_curve.nearest(seen)
    tangent = rotors.inner_curve.tangent(inner)
    offset = seen - rotors.inner_curve.point(inner)
    outside = offset[..., 0] * tangent[..., 1] - offset[..., 1] * tangent[..., 0]
    return inner, np.copysign(np.hypot(offset[..., 0], offset[..., 1]), outside)


def seen_from_inner(rotors: Rotors, angle: Array, place: Array) -> Array:
    """Places on the outer outline as points in the turning frame of the inner rotor. [m]."""
    seen = turned(rotors.outer_curve.point(place), angle) - rotors.inner_center
    return turned(seen, -rotors.turns * angle)


def closest_places(rotors: Rotors, nodes: int, reach: float) -> ClosestPoints:
    """All local minima of the distance below ``reach`` at angles of one pitch."""
    count = _OUTER_SAMPLES * rotors.outer_tooth_count
    step = rotors.outer_curve.length / count
    angle = np.asarray(np.arange(nodes) * (rotors.pitch / nodes), dtype=float)
    grid_angle, place = np.broadcast_arrays(angle[:, None], step * np.arange(count))
    gap = np.full(place.shape, np.inf)
    searched = _SEARCHED * rotors.eccentricity
    near = rotors.inner_curve.within(seen_from_inner(rotors, grid_angle, place), searched)
    _, gap[near] = distance_to_inner(rotors, grid_angle[near], place[near])
    least = (gap <= np.roll(gap, 1, axis=1)) & (gap < np.roll(gap, -1, axis=1)) & (gap < reach)
    node, column = np.nonzero(least)
    outer = nearest_place(rotors, angle[node], np.asarray(column * step), step)
    inner, gap = distance_to_inner(rotors, angle[node], outer)
    return ClosestPoints(node.astype(np.int64), outer, inner, gap)


def nearest_place(rotors: Rotors, angle: Array, place: Array, step: float) -> Array:
    """Place on the outer outline where the distance is least.

    Parameters
    ----------
    angle, place : ndarray
        Angles of the outer rotor [rad] and arc lengths on its outline to begin with. [m]
    step : float
        The least distance is looked for within one step on either side. [m]

    Returns
    -------
    ndarray
        Arc lengths on the outer outline, found by halving on the sign of the slope. [m]
    """
    low, high = place - step, place + step
    for _ in range(_BISECTIONS):
        middle = 0.5 * (low + high)
        inner, _ = distance_to_inner(rotors, angle, middle)
        tangent = turned(rotors.inner_curve.tangent(inner), (rotors.turns - 1.0) * angle)
        along = rotors.outer_curve.tangent(middle)
        rising = along[..., 0] * tangent[..., 1] - along[..., 1] * tangent[..., 0] > 0.0
        high = np.where(rising, middle, high)
        low = np.where(rising, low, middle)
    return np.asarray(0.5 * (low + high), dtype=float)


def linked(rotors: Rotors, closest: ClosestPoints, nodes: int) -> IntArray:
    """Row that continues every row at the next node (or up to three later); -1: none."""
    successor = np.full(closest.node.size, -1, dtype=np.int64)
    tracks: dict[int, _Track] = {}
    # the first round gives the second one its speeds at the start
    for step in range(2 * nodes + _LOST_NODES):
        node = step % nodes
        rows = np.flatnonzero(closest.node == node)
        if node == 0 and step > 0:
            for track in tracks.values():
                track.back_one_tooth(rotors)
        tracks = _advance(rotors, closest, rows, tracks, successor)
    return successor


class _Track:
    """A closest place on its way, with its speed per node. [m]."""

    def __init__(self, row: int, place: Array) -> None:
        self.row, self.place, self.speed, self.lost = row, place, np.zeros(2), 0

    def ahead(self) -> Array:
        """Where it should be at this node."""
        return np.asarray(self.place + self.speed * (1 + self.lost))

    def back_one_tooth(self, rotors: Rotors) -> None:
        """Count from the following tooth on both outlines."""
        inner = rotors.inner_curve.length / rotors.inner_tooth_count
        outer = rotors.outer_curve.length / rotors.outer_tooth_count
        self.place = self.place + np.array([outer, inner])


def _advance(
    rotors: Rotors,
    closest: ClosestPoints,
    rows: IntArray,
    tracks: dict[int, _Track],
    successor: IntArray,
) -> dict[int, _Track]:
    """Match the tracks with the rows of a node; begin new ones, drop lost ones."""
    lengths = np.array([rotors.outer_curve.length, rotors.inner_curve.length])
    places = np.column_stack([closest.outer[rows], closest.inner[rows]])
    old = list(tracks.values())
    following: dict[int, _Track] = {}
    reach = _FARTHEST * rotors.eccentricity
    pairs = _nearest_pairs([track.ahead() for track in old], places, lengths, reach)
    for k, track in enumerate(old):
        if k in pairs:
            j = pairs[k]
            step = places[j] - track.place
            step -= lengths * np.round(step / lengths)
            track.speed, track.place = step / (1 + track.lost), places[j]
            successor[track.row] = rows[j]
            track.row, track.lost = int(rows[j]), 0
        else:
            track.lost += 1
        if track.lost < _LOST_NODES:
            following[track.row] = track
    for j in set(range(rows.size)) - set(pairs.values()):
        following[int(rows[j])] = _Track(int(rows[j]), places[j])
    return following


def _nearest_pairs(
    expected: list[Array], places: Array, lengths: Array, reach: float
) -> dict[int, int]:
    """Pairs in the order of their distance, each side used once, none beyond ``reach``."""
    if not expected or not places.size:
        return {}
    difference = np.array(expected)[:, None, :] - places[None, :, :]
    difference -= lengths * np.round(difference / lengths)
    far = np.hypot(difference[..., 0], difference[..., 1])
    pairs: dict[int, int] = {}
    for flat in np.argsort(far, axis=None):
        k, j = divmod(int(flat), places.shape[0])
        if far[k, j] > reach:
            break
        if k not in pairs and j not in pairs.values():
            pairs[k] = j
    return pairs


def branches(closest: ClosestPoints, successor: IntArray, nodes: int) -> list[Branch]:
    """Chains of the links: those that begin and end, then those that close on themselves."""
    free = np.ones(closest.node.size, dtype=bool)
    starts = np.setdiff1d(np.arange(closest.node.size), successor)
    found = [_chain(closest, successor, int(row), nodes, free) for row in starts]
    for row in np.flatnonzero(closest.node == 0):
        if free[row]:
            found.append(_chain(closest, successor, int(row), nodes, free))
    return found


def _chain(
    closest: ClosestPoints, successor: IntArray, start: int, nodes: int, free: BoolArray
) -> Branch:
    rows, row, first = [], start, int(closest.node[start])
    while row >= 0 and free[row]:
        free[row] = False
        rows.append(row)
        following = int(successor[row])
        if following >= 0:
            skipped = (closest.node[following] - closest.node[row]) % nodes - 1
            rows.extend([-1] * int(skipped))
        row = following
    return Branch(first, np.array(rows), closed=row == start)
