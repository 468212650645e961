"""Closed outline as a periodic spline over its arc length, with its nearest point to others.

The nearest of many even samples is found first, by a search tree or among the samples near a
known one; Newton's method goes on from there in compiled code.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property
from typing import Any, NamedTuple, final

import numpy as np
import scipy

from toothspace.core.compiled import inlined, kernel
from toothspace.core.types import Array, IntArray
from toothspace.geometry.curve import turned

_SAMPLES = 12_000
_NEWTON_STEPS = 5
_SAME_PLACE = 1e-13
"""Step of the search for the nearest point that ends it, over the length of the outline. [-]"""
_STEEP = 0.1
_CURVATURE_REACH = 60e-6
_LEAST_EDGE = 1e-9
_BISECTIONS = 26
_FASTEST = 3.0
"""Way of the nearest place on an outline over the way of the point that it is nearest to. [-]"""
NOWHERE = -1
"""Number in place of that of a sample where no sample is near enough."""


class ContourData(NamedTuple):
    """What compiled code reads of an outline."""

    knots: Array
    """Arc lengths of the knots, the last one the whole length. Shape (n + 1,). [m]"""
    coefficients: Array
    """Of x and y between knots, highest power of the arc length first. Shape (4, n, 2). [m]"""
    samples: Array
    """Points at equal steps of arc length. Shape (samples, 2). [m]"""
    spans: IntArray
    """Knot before every sample. Shape (samples,)."""


@final
@dataclass(frozen=True)
class Contour:
    """Closed outline, counter-clockwise, with the search for its nearest point."""

    length: float
    """Length of the whole outline. [m]"""
    spline: Any
    """Points over the arc length. A ``CubicSpline``. [m]"""
    tree: Any
    """Search tree of points at equal steps of arc length. A ``cKDTree``."""

    @cached_property
    def data(self) -> ContourData:
        """Numbers of the outline for compiled code."""
        samples = np.ascontiguousarray(self.tree.data, dtype=float)
        knots = np.asarray(self.spline.x, dtype=float)
        places = self.step * np.arange(len(samples))
        spans = np.searchsorted(knots, places, "right") - 1
        return ContourData(knots, np.ascontiguousarray(self.spline.c), samples, spans)

    @property
    def step(self) -> float:
        """Arc length between samples. [m]."""
        return self.length / self.tree.n

    def point(self, place: Array) -> Array:
        """Points at arc lengths, shape ``place.shape + (2,)``. [m]."""
        return np.asarray(self.spline(np.mod(place, self.length)), dtype=float)

    def tangent(self, place: Array) -> Array:
        """Unit tangents at arc lengths, counter-clockwise. [-]."""
        slope = np.asarray(self.spline(np.mod(place, self.length), 1), dtype=float)
        return np.asarray(slope / np.hypot(slope[..., 0], slope[..., 1])[..., None], dtype=float)

    def curvature(self, place: Array) -> Array:
        """Curvature of the circle through three points 60 um apart; convex positive. [1/m]."""
        before, at, after = (
            self.point(place + step) for step in (-_CURVATURE_REACH, 0.0, _CURVATURE_REACH)
        )
        a, b, c = at - before, after - at, after - before
        area = a[..., 0] * b[..., 1] - a[..., 1] * b[..., 0]
        size = (np.hypot(v[..., 0], v[..., 1]) for v in (a, b, c))
        return np.asarray(2.0 * area / np.prod(list(size), axis=0), dtype=float)

    def near_samples(self, points: Array, reach: float = np.inf) -> IntArray:
        """Numbers of the nearest samples, :data:`NOWHERE` where none is within a distance.

        Parameters
        ----------
        points : ndarray, shape (..., 2)
            Points. [m]
        reach : float
            Distance beyond which no sample counts. [m]
        """
        _, index = self.tree.query(points, distance_upper_bound=reach)
        return np.where(index < self.tree.n, index, NOWHERE)

    def nearest(self, points: Array) -> tuple[Array, Array]:
        """Arc lengths of the nearest points of the outline, and distances from it, inside negative.

        Both [m].

        Parameters
        ----------
        points : ndarray, shape (..., 2)
            Points. [m]
        """
        return self.nearest_from(points, self.near_samples(points), 0)

    def nearest_from(self, points: Array, samples: IntArray, beside: int) -> tuple[Array, Array]:
        """Nearest points of the outline, as :meth:`nearest`, looked for near known samples.

        Parameters
        ----------
        points : ndarray, shape (..., 2)
            Points. [m]
        samples : ndarray of int, shape (...,)
            Numbers of the samples; the distance of points with :data:`NOWHERE` is infinite.
        beside : int
            Samples on either side of a known one among which the nearest one is.
        """
        flat = np.ascontiguousarray(points, dtype=float).reshape(-1, 2)
        place, gap = np.empty(len(flat)), np.empty(len(flat))
        start = np.ascontiguousarray(samples, dtype=np.int64).ravel()
        _fill_nearest(self.data, flat, start, beside, place, gap)
        return place.reshape(points.shape[:-1]), gap.reshape(points.shape[:-1])


def contour(points: Array) -> Contour:
    """Curve through the points of a closed outline.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        Points in counter-clockwise order; the last one may repeat the first. [m]
    """
    closed = np.vstack([points, points[:1]])
    steps = np.hypot(*np.diff(closed, axis=0).T)
    closed = np.vstack([points[:1], closed[1:][steps > _LEAST_EDGE]])
    closed[-1] = closed[0]
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    spline = scipy.interpolate.CubicSpline(along, closed, bc_type="periodic")
    length = float(along[-1])
    places = np.arange(_SAMPLES) * (length / _SAMPLES)
    return Contour(length, spline, scipy.spatial.cKDTree(spline(places)))


class _Turned(NamedTuple):
    cosine: float
    sine: float
    back_cosine: float
    back_sine: float
    ahead_cosine: float
    ahead_sine: float
    beside: int


class _Place(NamedTuple):
    x: float
    y: float
    dx: float
    dy: float
    ddx: float
    ddy: float


@inlined
def on_contour(data: ContourData, place: float, sample: int) -> _Place:
    """Point of an outline with both derivatives by its arc length. [m], [-], [1/m].

    Parameters
    ----------
    data : ContourData
        The outline.
    place : float
        Arc length, also beyond the whole length. [m]
    sample : int
        Sample from which the knots beside the place are looked for.
    """
    knots, c = data.knots, data.coefficients
    last = knots.size - 1
    place = place % knots[last]
    k = data.spans[sample]
    # the shorter way round
    if place - knots[k] > 0.5 * knots[last]:
        k = last - 1
    elif knots[k] - place > 0.5 * knots[last]:
        k = 0
    while k > 0 and place < knots[k]:
        k -= 1
    while k < last - 1 and place >= knots[k + 1]:
        k += 1
    s = place - knots[k]
    ss = s * s
    sss = ss * s
    return _Place(
        c[3, k, 0] + c[2, k, 0] * s + c[1, k, 0] * ss + c[0, k, 0] * sss,
        c[3, k, 1] + c[2, k, 1] * s + c[1, k, 1] * ss + c[0, k, 1] * sss,
        c[2, k, 0] + c[1, k, 0] * s * 2.0 + c[0, k, 0] * ss * 3.0,
        c[2, k, 1] + c[1, k, 1] * s * 2.0 + c[0, k, 1] * ss * 3.0,
        c[1, k, 0] * 2.0 + c[0, k, 0] * s * 6.0,
        c[1, k, 1] * 2.0 + c[0, k, 1] * s * 6.0,
    )


@inlined
def nearest_sample(data: ContourData, x: float, y: float, sample: int, beside: int) -> int:
    """Sample that is nearest to a point among some on either side of a known one."""
    count = data.samples.shape[0]
    best, least = sample, np.inf
    k = (sample - beside) % count
    for _ in range(2 * beside + 1):
        dx, dy = data.samples[k, 0] - x, data.samples[k, 1] - y
        square = dx * dx + dy * dy
        if square < least:
            best, least = k, square
        k += 1
        if k == count:
            k = 0
    return best


@inlined
def nearest_on(data: ContourData, x: float, y: float, sample: int) -> float:
    """Arc length of the point of an outline that is nearest to another one. [m].

    Parameters
    ----------
    data : ContourData
        The outline.
    x, y : float
        The other point. [m]
    sample : int
        Its nearest sample; the place is within two steps of it.
    """
    length = data.knots[data.knots.size - 1]
    step = length / data.samples.shape[0]
    start = sample * step
    place = start
    for _ in range(_NEWTON_STEPS):
        at = on_contour(data, place, sample)
        off_x, off_y = at.x - x, at.y - y
        slope = (at.dx * at.dx + off_x * at.ddx) + (at.dy * at.dy + off_y * at.ddy)
        if slope <= _STEEP:
            slope = 1.0
        before = place
        place = place - (off_x * at.dx + off_y * at.dy) / slope
        place = min(max(place, start - 2.0 * step), start + 2.0 * step)
        if abs(place - before) < _SAME_PLACE * length:
            break
    return place


@kernel
def _fill_nearest(
    data: ContourData, points: Array, samples: IntArray, beside: int, place: Array, gap: Array
) -> None:
    for k in range(points.shape[0]):
        place[k], gap[k] = 0.0, np.inf
        if samples[k] < 0:
            continue
        x, y = points[k, 0], points[k, 1]
        near = nearest_sample(data, x, y, samples[k], beside)
        place[k] = nearest_on(data, x, y, near)
        at = on_contour(data, place[k], near)
        off_x, off_y = x - at.x, y - at.y
        outside = off_x * at.dy - off_y * at.dx
        gap[k] = np.copysign(np.hypot(off_x, off_y), outside)


class Turning(NamedTuple):
    """How an outline turns about the origin while another one turns about a centre."""

    center_x: float
    center_y: float
    """Centre of the other outline. [m]"""
    turns: float
    """Its angle per angle of the outline about the origin. [-]"""


def nearest_places(
    own: Contour, other: Contour, turning: Turning, angle: Array, place: Array, step: float
) -> Array:
    """Places on an outline where its distance from another one is least. [m].

    Found by halving on the sign of the slope.

    Parameters
    ----------
    own : Contour
        Outline about the origin.
    other : Contour
        Outline about its centre.
    turning : Turning
        How both turn.
    angle : ndarray, shape (n,)
        Angles of the outline about the origin. [rad]
    place : ndarray, shape (n,)
        Arc lengths on it to begin with. [m]
    step : float
        The least distance is looked for within one step on either side. [m]
    """
    seen = seen_from(turning, angle, own.point(place))
    samples = other.near_samples(seen)
    beside = beside_of(other, step)
    found = np.array(place, dtype=float)
    turned_by = np.ascontiguousarray(angle, dtype=float)
    _fill_least(own.data, other.data, turning, turned_by, samples, beside, step, found)
    return found


def seen_from(turning: Turning, angle: Array, points: Array) -> Array:
    """Points of the outline about the origin in the turning frame of the other one. [m].

    Parameters
    ----------
    turning : Turning
        How both turn.
    angle : ndarray
        Angles of the outline about the origin. [rad]
    points : ndarray, shape (..., 2)
        Its points while it has not turned. [m]
    """
    seen = turned(points, angle) - np.array([turning.center_x, turning.center_y])
    return turned(seen, -turning.turns * angle)


def beside_of(other: Contour, way: float) -> int:
    """Samples of an outline among which the nearest one stays while a point moves by a way [m]."""
    return int(np.ceil(_FASTEST * way / other.step)) + 2


@inlined
def _rising(
    own: ContourData, other: ContourData, turning: Turning, at: _Turned, place: float, near: int
) -> bool:
    """Whether the distance from the other outline grows along the own one."""
    own_sample = int(place / own.knots[own.knots.size - 1] * own.samples.shape[0])
    p = on_contour(own, place, own_sample % own.samples.shape[0])
    x = at.cosine * p.x - at.sine * p.y - turning.center_x
    y = at.sine * p.x + at.cosine * p.y - turning.center_y
    x, y = at.back_cosine * x - at.back_sine * y, at.back_sine * x + at.back_cosine * y
    near = nearest_sample(other, x, y, near, at.beside)
    q = on_contour(other, nearest_on(other, x, y, near), near)
    size = np.hypot(q.dx, q.dy)
    tx, ty = q.dx / size, q.dy / size
    tx, ty = at.ahead_cosine * tx - at.ahead_sine * ty, at.ahead_sine * tx + at.ahead_cosine * ty
    size = np.hypot(p.dx, p.dy)
    return bool(p.dx / size * ty - p.dy / size * tx > 0.0)


@kernel
def _fill_least(
    own: ContourData,
    other: ContourData,
    turning: Turning,
    angle: Array,
    samples: IntArray,
    beside: int,
    step: float,
    place: Array,
) -> None:
    for k in range(place.size):
        back, ahead = -turning.turns * angle[k], (turning.turns - 1.0) * angle[k]
        at = _Turned(
            np.cos(angle[k]), np.sin(angle[k]), np.cos(back), np.sin(back),
            np.cos(ahead), np.sin(ahead), beside,
        )  # fmt: skip
        low, high = place[k] - step, place[k] + step
        for _ in range(_BISECTIONS):
            middle = 0.5 * (low + high)
            if _rising(own, other, turning, at, middle, samples[k]):
                high = middle
            else:
                low = middle
        place[k] = 0.5 * (low + high)
