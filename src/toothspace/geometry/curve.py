"""Planar curves: sampling of smooth pieces, orientation, self-crossing, checked polygons."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from typing import Any, final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array, FloatOrArray

_FINE = 801
_LARGEST_BEND = np.deg2rad(45.0)
"""Angle beyond which a corner is one of the curve itself. [rad]"""
_ALIKE, _ARC_TURN, _ARC_PIECES = 0.4, np.deg2rad(20.0), 8
"""Of chords of one circle: least ratio of neighbouring turns, largest turn, pieces of each."""


@final
@dataclass(frozen=True)
class CurveSegment:
    """A smooth piece of curve."""

    curve: Callable[[Array], Array]
    """Points, shape (n, 2), for parameters in 0 to 1. [m]"""
    crowding: tuple[float, float]
    """How closely points gather at the start and at the end: 0 not at all, 1 for a jump of
    curvature, 2 for a corner.
    """


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
    near = np.geomspace(1e-8, 0.1, _FINE // 3)
    inner = np.linspace(0.1, 0.9, _FINE // 3)[1:-1]
    parameter = np.concatenate([[0.0], near, inner, 1.0 - near[::-1], [1.0]])
    steps = [np.diff(segment.curve(parameter), axis=0) for segment in segments]
    lengths = [np.hypot(step[:, 0], step[:, 1]) for step in steps]
    scale = sum(float(np.sum(length)) for length in lengths)
    # cumulative number of wanted points over the parameter, up to a common factor
    wanted_up_to = []
    for segment, step, length in zip(segments, steps, lengths, strict=True):
        along = np.concatenate([[0.0], np.cumsum(length)])
        middle, total = 0.5 * (along[1:] + along[:-1]), along[-1]
        heading = np.unwrap(np.arctan2(step[:, 1], step[:, 0]))
        weight = length * (20.0 / scale + 3.0 / total) + np.abs(np.gradient(heading)) / 0.2
        density = np.zeros_like(middle)
        for level, distance in zip(segment.crowding, (middle, total - middle), strict=True):
            if level > 0.0:
                density += 1.0 / (distance + scale * 10.0 ** (-3.0 - 1.5 * level))
        weight = weight + length * density
        wanted_up_to.append(np.concatenate([[0.0], np.cumsum(weight)]))
    totals = np.array([cumulative[-1] for cumulative in wanted_up_to])
    # whole shares of the points, two or more a segment, that sum to the count
    wanted = totals / totals.sum() * count
    shares = np.maximum(np.floor(wanted).astype(int), 2)
    while shares.sum() > count:
        shares[int(np.argmax(shares))] -= 1
    order = np.argsort(shares - wanted)
    for index in order[: count - int(shares.sum())]:
        shares[index] += 1
    shares[int(np.argmax(shares))] += count - int(shares.sum())
    counts = [int(value) for value in shares]
    points, breaks = [segments[0].curve(np.zeros(1))], [0]
    for segment, cumulative, pieces in zip(segments, wanted_up_to, counts, strict=True):
        levels = cumulative[-1] * np.arange(1, pieces + 1) / pieces
        chosen = np.interp(levels, cumulative, parameter)
        chosen[-1] = 1.0
        points.append(segment.curve(chosen))
        breaks.append(breaks[-1] + pieces)
    return np.vstack(points), tuple(breaks[1:-1])


def without_repeats(points: Array, tolerance: float = 0.0) -> Array:
    """Drop consecutive equal points of a closed curve and its first point at the end. [m].

    Parameters
    ----------
    points : ndarray
        Points, shape (n, 2). [m]
    tolerance : float
        Distance up to which points count as equal. [m]
    """
    step = np.roll(points, -1, axis=0) - points
    return points[np.hypot(step[:, 0], step[:, 1]) > tolerance]


def signed_area(points: Array) -> float:
    """Area inside a closed curve of shape (n, 2), positive if counter-clockwise [m2]."""
    x, y = (points - points.mean(axis=0)).T
    return float(0.5 * np.sum(x * np.roll(y, -1) - np.roll(x, -1) * y))


def polar(radius: FloatOrArray, angle: Array) -> Array:
    """Points at radii [m] and angles [rad], shape (n, 2). [m]."""
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


def turned(points: Array, angle: FloatOrArray) -> Array:
    """Points [m], shape (..., 2), turned counter-clockwise by angles [rad]. [m]."""
    c, s = np.cos(angle), np.sin(angle)
    x, y = points[..., 0], points[..., 1]
    return np.stack([c * x - s * y, s * x + c * y], axis=-1)


def turned_copies(points: Array, angles: Array) -> Array:
    """Points [m] of a piece, repeated one after the other at angles about the origin [rad]. [m]."""
    phasors = np.exp(1j * angles)[:, None] * (points @ np.array([1.0, 1j]))[None, :]
    return np.column_stack([phasors.real.ravel(), phasors.imag.ravel()])


def outline_with_hole(outside: Array, hole: Array) -> Array:
    """One closed outline round a ring, with a cut where both curves are farthest right.

    Parameters
    ----------
    outside, hole : ndarray, shape (n, 2)
        Closed counter-clockwise curves, first point not repeated. [m]
    """
    start, first = (int(np.argmax(curve[:, 0])) for curve in (outside, hole))
    outside, hole = np.roll(outside, -start, axis=0), np.roll(hole, -first, axis=0)
    return np.vstack([outside, outside[:1], hole[:1], hole[::-1]])


def polar_moment(points: Array) -> float:
    """Polar second moment of area of a closed curve about the origin, counter-clockwise. [m4]."""
    p, q = points, np.roll(points, -1, axis=0)
    cross = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    return float(np.sum(cross * np.sum(p * p + p * q + q * q, axis=1)) / 12.0)


def closed_length(points: Array) -> float:
    """Length of a closed polygon. [m]."""
    return float(np.hypot(*(points - np.roll(points, 1, axis=0)).T).sum())


def counter_clockwise(points: Array) -> Array:
    """Run a closed curve counter-clockwise, beginning at the same point [m]."""
    if signed_area(points) >= 0.0:
        return points
    return np.vstack([points[:1], points[:0:-1]])


def first_self_crossing(points: Array) -> tuple[float, float] | None:
    """Place where a closed curve crosses or touches itself.

    One crossing point; None for a simple curve. [m]

    Parameters
    ----------
    points : ndarray
        Points of a closed curve, shape (n, 2). [m]
    """
    import shapely
    from shapely.validation import explain_validity

    polygon = shapely.Polygon(points)
    if polygon.is_valid:
        return None
    text = explain_validity(polygon)
    numbers = text[text.find("[") + 1 : text.find("]")].split()
    return (float(numbers[0]), float(numbers[1])) if len(numbers) >= 2 else tuple(points[0])


def arc_lengths(points: Array) -> Array:
    """Distance along an open polyline from its first point, shape (n,) [m]."""
    step = np.diff(points, axis=0)
    return np.concatenate([[0.0], np.cumsum(np.hypot(step[:, 0], step[:, 1]))])


def even_points(points: Array, count: int) -> Array:
    """Points at so many even places along an open polyline, ends included. [m]."""
    along = arc_lengths(points)
    wanted = np.linspace(0.0, along[-1], count)
    return np.column_stack([np.interp(wanted, along, points[:, axis]) for axis in (0, 1)])


def resample_by_curvature(points: Array, count: int) -> Array:
    """Smooth open curve with points close together where it bends.

    Points, shape (count + 1, 2), on the cubic spline through the given points; half of them spread
    evenly, half by the angle that the curve turns through. [m]

    Parameters
    ----------
    points : ndarray
        Points of a smooth open curve, shape (n, 2), n >= 4. [m]
    count : int
        Number of intervals wanted.
    """
    from scipy.interpolate import CubicSpline

    along = arc_lengths(points)
    spline = CubicSpline(along, points)
    fine = np.interp(np.linspace(0, len(along) - 1, 8 * len(along)), np.arange(len(along)), along)
    slope = spline(fine, 1)
    turning = np.abs(np.diff(np.unwrap(np.arctan2(slope[:, 1], slope[:, 0]))))
    weight = np.diff(fine) / along[-1] + turning / max(float(turning.sum()), 1e-12)
    cumulative = np.concatenate([[0.0], np.cumsum(weight)])
    chosen = np.interp(np.linspace(0.0, cumulative[-1], count + 1), cumulative, fine)
    chosen[-1] = along[-1]
    return np.asarray(spline(chosen))


def chord_heights(points: Array) -> Array:
    r"""Distance of every edge of a closed polygon from the smooth curve through its corners.

    Chord height of the edge that begins at each point, shape (n,). [m]

    Parameters
    ----------
    points : ndarray
        Corners, shape (n, 2). [m]

    Notes
    -----
    A chord of length :math:`l` on an arc between whose neighbouring chords the direction turns by
    :math:`\alpha` has the height :math:`l \alpha / 8`; the smaller turn at its two ends counts.
    """
    step = np.roll(points, -1, axis=0) - points
    length = np.hypot(step[:, 0], step[:, 1])
    heading = np.arctan2(step[:, 1], step[:, 0])
    bend = np.abs((heading - np.roll(heading, 1) + np.pi) % (2.0 * np.pi) - np.pi)
    smaller = np.minimum(bend, np.roll(bend, -1))
    return np.where(smaller < _LARGEST_BEND, 0.125 * length * smaller, 0.0)


def with_arcs(points: Array) -> Array:
    r"""Closed polyline whose chords of circles are replaced by the circles.

    The curve with points between the given ones, shape (m, 2). [m]

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        Closed curve, first point not repeated. [m]

    Notes
    -----
    At the corners of a polygon inscribed in a circle the direction turns by the angle
    :math:`\theta` that each edge spans. An edge whose ends turn to the same side by nearly the
    same angle of at most 20 deg is a chord of that circle, with the height
    :math:`\frac{l}{2} \tan\frac{\theta}{4}`.
    """
    step = np.roll(points, -1, axis=0) - points
    heading = np.arctan2(step[:, 1], step[:, 0])
    turn = (heading - np.roll(heading, 1) + np.pi) % (2.0 * np.pi) - np.pi
    ahead = np.roll(turn, -1)
    small, large = np.sort(np.abs([turn, ahead]), axis=0)
    alike = (turn * ahead > 0.0) & (small > _ALIKE * large) & (large < _ARC_TURN)
    spanned = np.where(alike, 0.5 * (turn + ahead), 0.0)
    place = np.linspace(-1.0, 1.0, _ARC_PIECES + 1)[:-1]
    half = 0.5 * np.hypot(*step.T)
    # a parabola of the height of the circle, which it leaves by less than a hundredth of it
    height = (half * np.tan(0.25 * spanned))[:, None] * (1.0 - place**2)
    outwards = np.column_stack([step[:, 1], -step[:, 0]]) / (2.0 * half)[:, None]
    middle = points + 0.5 * step
    fine = middle[:, None, :] + 0.5 * place[:, None] * step[:, None, :]
    fine = fine + height[..., None] * outwards[:, None, :]
    kept = np.ones(fine.shape[:2], dtype=bool)
    kept[~alike, 1:] = False
    return np.asarray(fine[kept])


_SMALLEST, _LARGEST = 1e-4, 10.0
"""Size of a curve that can belong to a machine. [m]"""


def checked_polygon(points: Array, key: str) -> Array:
    """Check that a closed curve encloses an area without crossing itself.

    Points, counter-clockwise, no point repeated. [m]

    Raises GeometryError for fewer than three points, values that are not finite, a self-crossing or
    no area.

    Parameters
    ----------
    points : ndarray
        Points of the closed curve, shape (n, 2); the first may be repeated at the end. [m]
    key : str
        Name for error messages.
    """
    if points.ndim != 2 or points.shape[1] != 2 or len(points) == 0:
        raise GeometryError(key, "an empty curve", "a closed curve of 3 points")
    if not np.all(np.isfinite(points)):
        raise GeometryError(key, "a coordinate that is not finite", "numbers")
    size = float(np.ptp(points, axis=0).max())
    if not _SMALLEST <= size <= _LARGEST:
        raise GeometryError(
            key,
            f"a curve {size * 1e3:.3g} mm wide",
            f"{_SMALLEST * 1e3:g} to {_LARGEST * 1e3:g} mm (is the unit of the file right?)",
        )
    clean = without_repeats(points)
    if len(clean) < 3:
        raise GeometryError(key, f"{len(clean)} distinct points", "at least 3")
    crossing = first_self_crossing(clean)
    if crossing is not None:
        raise GeometryError(
            key,
            f"a curve that crosses itself at x = {crossing[0] * 1e3:.4g} mm, y = "
            f"{crossing[1] * 1e3:.4g} mm",
            "a simple closed curve",
        )
    return counter_clockwise(clean)


def enclosed(outlines: Sequence[Array]) -> Any:
    """Areas that outlines enclose, also where they touch or cross themselves by rounding.

    Polygons, several for an outline that is pinched, without loops of the other sense.

    Parameters
    ----------
    outlines : sequence of ndarray, shape (n, 2)
        Closed curves. [m]
    """
    import shapely

    owner = np.repeat(np.arange(len(outlines)), [len(outline) for outline in outlines])
    shapes = shapely.polygons(shapely.linearrings(np.concatenate(outlines), indices=owner))
    crossed = np.flatnonzero(~shapely.is_valid(shapes))
    given, shapes[crossed] = shapes[crossed], shapely.buffer(shapes[crossed], 0.0)
    # where points coincide but for rounding, the buffer may leave nothing
    lost = shapely.area(shapes[crossed]) < 0.5 * shapely.area(given)
    shapes[crossed[lost]] = shapely.buffer(shapely.make_valid(given[lost]), 0.0)
    return shapes
