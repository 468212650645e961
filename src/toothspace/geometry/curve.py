"""Planar curves: sampling of smooth pieces, orientation, self-crossing, deviation."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.types import Array

_FINE = 801


@final
@dataclass(frozen=True)
class CurveSegment:
    """A smooth piece of curve.

    Parameters
    ----------
    curve : callable
        Points, shape (n, 2), for parameters in 0 to 1. [m]
    crowding : tuple of float
        How closely points gather at the start and at the end: 0 not at all, 1 for a jump of
        curvature, 2 for a corner.
    """

    curve: Callable[[Array], Array]
    crowding: tuple[float, float]


def sample_segments(segments: list[CurveSegment], count: int) -> tuple[Array, tuple[int, ...]]:
    """Points on a chain of smooth pieces, dense where curvature is high and at the junctions.

    Parameters
    ----------
    segments : list of CurveSegment
        Pieces, each starting where the previous one ends.
    count : int
        Number of intervals on the whole chain.

    Returns
    -------
    points : ndarray
        Points on the exact curves, shape (count + 1, 2). [m]
    breaks : tuple of int
        Index of the last point of every piece but the last.
    """
    scale = sum(_length(segment) for segment in segments)
    densities = [_density(segment, scale) for segment in segments]
    totals = np.array([cumulative[-1] for _, cumulative in densities])
    counts = _shares(totals, count)
    points, breaks = [segments[0].curve(np.zeros(1))], [0]
    for segment, (parameter, cumulative), pieces in zip(segments, densities, counts, strict=True):
        levels = cumulative[-1] * np.arange(1, pieces + 1) / pieces
        chosen = np.interp(levels, cumulative, parameter)
        chosen[-1] = 1.0
        points.append(segment.curve(chosen))
        breaks.append(breaks[-1] + pieces)
    return np.vstack(points), tuple(breaks[1:-1])


def _fine_parameters() -> Array:
    near = np.geomspace(1e-8, 0.1, _FINE // 3)
    return np.concatenate([[0.0], near, np.linspace(0.1, 0.9, _FINE // 3)[1:-1], 1.0 - near[::-1],
                           [1.0]])  # fmt: skip


def _length(segment: CurveSegment) -> float:
    step = np.diff(segment.curve(_fine_parameters()), axis=0)
    return float(np.sum(np.hypot(step[:, 0], step[:, 1])))


def _density(segment: CurveSegment, scale: float) -> tuple[Array, Array]:
    # cumulative number of wanted points over the parameter, up to a common factor
    parameter = _fine_parameters()
    step = np.diff(segment.curve(parameter), axis=0)
    length = np.hypot(step[:, 0], step[:, 1])
    along = np.concatenate([[0.0], np.cumsum(length)])
    middle, total = 0.5 * (along[1:] + along[:-1]), along[-1]
    heading = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
    turning = np.abs(np.gradient(heading)) / 0.2
    even = length * (20.0 / scale + 3.0 / total)
    weight = even + turning + length * _crowding(middle, total, scale, segment.crowding)
    return parameter, np.concatenate([[0.0], np.cumsum(weight)])


def _crowding(along: Array, total: float, scale: float, crowding: tuple[float, float]) -> Array:
    density = np.zeros_like(along)
    for level, distance in zip(crowding, (along, total - along), strict=True):
        if level > 0.0:
            density += 1.0 / (distance + scale * 10.0 ** (-3.0 - 1.5 * level))
    return density


def _shares(totals: Array, count: int) -> list[int]:
    wanted = totals / totals.sum() * count
    shares = np.maximum(np.floor(wanted).astype(int), 2)
    while shares.sum() > count:
        shares[int(np.argmax(shares))] -= 1
    order = np.argsort(shares - wanted)
    for index in order[: count - int(shares.sum())]:
        shares[index] += 1
    shares[int(np.argmax(shares))] += count - int(shares.sum())
    return [int(value) for value in shares]
