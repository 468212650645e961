"""Closed outline of a rotor as a smooth curve over its arc length."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np
import scipy

from toothspace.core.types import Array, BoolArray

_SAMPLES = 12_000
_NEWTON_STEPS = 5
_CURVATURE_REACH = 60e-6


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

    def within(self, points: Array, reach: float) -> BoolArray:
        """Which points lie within a distance of the outline."""
        distance, _ = self.tree.query(points, distance_upper_bound=reach)
        return np.asarray(np.isfinite(distance))

    def nearest(self, points: Array) -> Array:
        """Arc lengths of the nearest points of the outline. [m]."""
        _, index = self.tree.query(points)
        step = self.length / _SAMPLES
        start = index * step
        place = start
        for _ in range(_NEWTON_STEPS):
            wrapped = np.mod(place, self.length)
            offset = self.spline(wrapped) - points
            first, second = self.spline(wrapped, 1), self.spline(wrapped, 2)
            slope = np.sum(first * first + offset * second, axis=-1)
            slope = np.where(slope > 0.1, slope, 1.0)
            place = place - np.sum(offset * first, axis=-1) / slope
            place = np.clip(place, start - 2.0 * step, start + 2.0 * step)
        return np.asarray(place, dtype=float)


def contour(points: Array) -> Contour:
    """Curve through the points of a closed outline.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        Points in counter-clockwise order; the last one may repeat the first. [m]
    """
    closed = np.vstack([points, points[:1]])
    steps = np.hypot(*np.diff(closed, axis=0).T)
    closed = np.vstack([points[:1], closed[1:][steps > 1e-9]])
    closed[-1] = closed[0]
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
    spline = scipy.interpolate.CubicSpline(along, closed, bc_type="periodic")
    length = float(along[-1])
    places = np.arange(_SAMPLES) * (length / _SAMPLES)
    return Contour(length, spline, scipy.spatial.cKDTree(spline(places)))
