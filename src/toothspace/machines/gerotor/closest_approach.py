"""Throats between rotors without an analytic definition: points of closest approach."""

from __future__ import annotations

import numpy as np
from scipy.interpolate import CubicSpline
from scipy.spatial import KDTree

from toothspace.core.types import Array, IntArray
from toothspace.geometry.curve import arc_lengths
from toothspace.machines.gerotor.profiles import Rotors

_INNER_POINTS_PER_TOOTH = 4000
_LOBE_POINTS = 961
_COARSE = 16
_MISS_WEIGHT = 0.02
_CURVATURE_WINDOW = 0.02


def closest_approach(rotors: Rotors, place: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Find where a lobe comes closest to the inner rotor.

    Parameters
    ----------
    rotors : Rotors
        Both rotors.
    place : ndarray
        Places of the lobe. [rad]

    Returns
    -------
    tuple of ndarray
        Middle of the throat [m], unit normal from inner to outer [-], gap [m], and the
        curvatures of inner and outer wall [1/m], as in
        :class:`~toothspace.machines.gerotor.lobe_path.LobePath`.

    Notes
    -----
    Where several points of a lobe are equally close, the one whose normal passes nearest to the
    pitch point is taken: it is the one that the law of gearing allows to touch.
    """
    inner = _Wall(rotors.inner, _INNER_POINTS_PER_TOOTH * rotors.inner_tooth_count)
    lobe, lobe_curvature = _lobe(rotors)
    every = np.arange(0, _LOBE_POINTS, _COARSE)
    coarse = _Search(inner, rotors, place, np.tile(every, (place.size, 1)), lobe)
    middle = every[coarse.best]
    window = np.clip(middle[:, None] + np.arange(-_COARSE, _COARSE + 1), 0, _LOBE_POINTS - 1)
    fine = _Search(inner, rotors, place, window, lobe)
    gap, point, normal, foot = fine.chosen
    chosen = window[np.arange(place.size), fine.best]
    return (
        point - 0.5 * gap[:, None] * normal,
        normal,
        gap,
        inner.curvatures[foot],
        lobe_curvature[chosen],
    )


class _Search:
    """Distances of some points of the lobe to the inner rotor at every place."""

    def __init__(
        self, inner: _Wall, rotors: Rotors, place: Array, index: IntArray, lobe: Array
    ) -> None:
        turn = (place - np.pi / rotors.outer_tooth_count)[:, None]
        inner_turn = turn * rotors.outer_tooth_count / rotors.inner_tooth_count
        points = _rotated(lobe[index], turn)
        nearest = inner.nearest(_rotated(points - rotors.inner_center, -inner_turn))
        normals = _rotated(inner.normals[nearest], inner_turn)
        feet = _rotated(inner.points[nearest], inner_turn) + rotors.inner_center
        gap = np.sum((points - feet) * normals, axis=-1)
        to_pitch = points - rotors.pitch_point
        miss = normals[..., 0] * to_pitch[..., 1] - normals[..., 1] * to_pitch[..., 0]
        self.best = np.argmin(gap + _MISS_WEIGHT * miss**2 / rotors.eccentricity, axis=1)
        self._all = (gap, points, normals, nearest)

    @property
    def chosen(self) -> tuple[Array, Array, Array, IntArray]:
        """Gap [m], point [m], normal [-] and nearest inner point at the best place of each row."""
        rows = np.arange(self.best.size)
        gap, points, normals, nearest = self._all
        return (
            gap[rows, self.best],
            points[rows, self.best],
            normals[rows, self.best],
            nearest[rows, self.best],
        )


class _Wall:
    """A closed smooth curve as many points with outward normals and curvatures."""

    def __init__(self, outline: Array, count: int) -> None:
        closed = np.vstack([outline, outline[:1]])
        length = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(closed, axis=0).T))])
        spline = CubicSpline(length, closed, bc_type="periodic")
        along = length[-1] * np.arange(count) / count
        self.points = spline(along)
        rate = spline(along, 1)
        self.normals = np.column_stack([rate[:, 1], -rate[:, 0]]) / np.hypot(*rate.T)[:, None]
        self.curvatures = _curvature(self.points, closed=True)
        self._tree = KDTree(self.points)

    def nearest(self, points: Array) -> IntArray:
        """Return the index of the nearest point of the wall."""
        return np.asarray(self._tree.query(points)[1], dtype=np.int64)


def _lobe(rotors: Rotors) -> tuple[Array, Array]:
    """Points of the lobe next to the negative y axis, counter-clockwise, and its curvatures."""
    half_pitch = np.pi / rotors.outer_tooth_count
    start = -0.5 * np.pi
    angle = np.mod(np.arctan2(rotors.outer[:, 1], rotors.outer[:, 0]) - start, 2.0 * np.pi)
    order = np.argsort(angle)
    chosen = order[(angle[order] > 0.0) & (angle[order] < 2.0 * half_pitch)]
    piece = rotors.outer[chosen]
    points = _resampled(piece)
    bend = -_curvature(points, closed=False)
    # the cavity floor beside the lobe is concave: no throat between pockets lies there
    concave = np.flatnonzero(bend <= 0.0)
    middle = _LOBE_POINTS // 2
    first = int(concave[concave < middle].max(initial=-1)) + 1
    last = int(concave[concave > middle].min(initial=_LOBE_POINTS))
    points = _resampled(points[first:last])
    return points, -_curvature(points, closed=False)


def _resampled(piece: Array) -> Array:
    length = arc_lengths(piece)
    along = np.linspace(0.0, length[-1], _LOBE_POINTS)
    return np.column_stack([np.interp(along, length, piece[:, k]) for k in (0, 1)])


def _curvature(points: Array, *, closed: bool) -> Array:
    # three points some way apart, so that facets of a file do not count as corners
    shift = max(int(_CURVATURE_WINDOW * len(points) / (12.0 if closed else 1.0)), 1)
    before, after = np.roll(points, shift, axis=0), np.roll(points, -shift, axis=0)
    if not closed:
        before[:shift], after[-shift:] = points[0], points[-1]
    a, b, c = points - before, after - points, after - before
    cross = a[:, 0] * b[:, 1] - a[:, 1] * b[:, 0]
    product = np.hypot(*a.T) * np.hypot(*b.T) * np.hypot(*c.T)
    return np.asarray(2.0 * cross / np.where(product > 0.0, product, np.inf), dtype=float)


def _rotated(points: Array, angle: Array) -> Array:
    cosine, sine = np.cos(angle), np.sin(angle)
    x, y = points[..., 0], points[..., 1]
    return np.stack([cosine * x - sine * y, sine * x + cosine * y], axis=-1)
