"""Tooth flanks as cubic splines: points, derivatives and swept areas for compiled code."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple

import numpy as np

from toothspace.core.compiled import inlined
from toothspace.core.recall import recalled
from toothspace.core.types import Array
from toothspace.geometry.gear_profile import GearProfile


def spline_coefficients(knots: Array, values: Array) -> Array:
    """Cubic spline with two continuous derivatives, its third also at the second knots.

    Coefficients of the powers 0 to 3 of the distance to the left knot of each interval, shape (n -
    1, channels, 4).

    Parameters
    ----------
    knots : ndarray, shape (n,)
        Increasing, n >= 2; three give a parabola, two a line. [unit of the abscissa]
    values : ndarray, shape (n, channels)
        Values at the knots.

    Notes
    -----
    Equation: continuity of the second derivative gives a tridiagonal system for the slopes; the
    rows of both ends ask for one polynomial on the first two intervals and on the last two.

    References
    ----------
    de Boor, A Practical Guide to Splines, Springer, New York 1978, chapter 4.
    """
    step = np.diff(knots)
    rise = np.diff(values, axis=0) / step[:, None]
    slope = _slopes(step, rise)
    bend = (3.0 * rise - 2.0 * slope[:-1] - slope[1:]) / step[:, None]
    twist = (slope[:-1] + slope[1:] - 2.0 * rise) / step[:, None] ** 2
    return np.stack([values[:-1], slope[:-1], bend, twist], axis=-1)


def _slopes(step: Array, rise: Array) -> Array:
    if len(step) == 1:
        return rise[[0, 0]]
    both = (step[:-1] + step[1:])[:, None]
    middle = (step[1:, None] * rise[:-1] + step[:-1, None] * rise[1:]) / both
    if len(step) == 2:
        return np.vstack([2.0 * rise[:1] - middle, middle, 2.0 * rise[1:] - middle])
    nodes = len(step) + 1
    matrix, right = np.zeros((nodes, nodes)), np.empty((nodes, rise.shape[1]))
    inner = np.arange(1, nodes - 1)
    matrix[inner, inner - 1], matrix[inner, inner + 1] = step[1:], step[:-1]
    matrix[inner, inner] = 2.0 * both[:, 0]
    right[1:-1] = 3.0 * both * middle
    for end, second, near, far in ((0, 1, 0, 1), (-1, -2, -1, -2)):
        a, b = step[near], step[far]
        matrix[end, [end, second]] = b, a + b
        right[end] = ((3.0 * a + 2.0 * b) * b * rise[near] + a**2 * rise[far]) / (a + b)
    return np.asarray(np.linalg.solve(matrix, right))


LEFT = 1.0
"""Counter-clockwise side of a tooth that points outwards."""
RIGHT = -1.0
"""Clockwise side of a tooth that points outwards."""

_TANGENT_JUMP = 0.02


class Flank(NamedTuple):
    """One flank from the root middle to the tip corner, tooth on the +x axis."""

    knots: Array
    """Curve parameter (chord length) at the spline knots, from 0 at the root middle. Shape (n,).
    [m]
    """
    coefficients: Array
    """Cubic polynomials of x, then of y, in ascending powers. Shape (n - 1, 8). [m]"""
    area: Array
    """Area swept by the radius from the root middle to each knot, right-handed. Shape (n,). [m2]"""
    side: float
    """``LEFT`` or ``RIGHT``."""
    corner_angle: float
    """Polar angle of the tip corner. [rad]"""
    tip_radius: float
    """Tip circle, negative where the tooth points to its centre. [m]"""


class Tooth(NamedTuple):
    """Both flanks of a gear's tooth and the numbers that go with them."""

    left: Flank
    right: Flank
    """Flanks."""
    tooth_count: int
    """Number of teeth, negative of a ring gear."""
    tip_radius: float
    """Tip circle, negative of a ring gear. [m]"""

    @property
    def pitch_angle(self) -> float:
        """Angle between neighbouring teeth. [rad]."""
        return 2.0 * np.pi / self.tooth_count

    @property
    def land_angle(self) -> float:
        """Angle covered by the tip land. [rad]."""
        return self.left.corner_angle - self.right.corner_angle


def tooth_curves(profile: GearProfile) -> Tooth:
    """Splines through both flanks of a profile.

    Flanks from root middle to tip corner.

    Parameters
    ----------
    profile : GearProfile
        One tooth pitch.
    """
    radius = profile.tip_radius
    breaks = np.asarray(profile.breaks, dtype=int)
    right = flank_spline(profile.right_flank, breaks, RIGHT, radius)
    last = len(profile.points) - 1
    left = flank_spline(profile.left_flank[::-1], last - breaks, LEFT, radius)
    return Tooth(left, right, profile.tooth_count, radius)


@recalled(8)
def flank_spline(points: Array, breaks: Array, side: float, tip_radius: float) -> Flank:
    """Spline through the points of a flank.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        From the root middle to the tip corner; the tooth points to +x. [m]
    breaks : ndarray of int
        Where curvature or tangent may jump.
    side : float
        ``LEFT`` or ``RIGHT``.
    tip_radius : float
        Tip circle, negative of a ring gear, whose centre lies ahead of the tooth. [m]
    """
    knots = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(points, axis=0).T))])
    # splines end at corners: breaks where the tangent jumps
    inner = sorted(int(k) for k in breaks if 2 <= k <= len(points) - 3)
    corners = []
    for k in inner:
        before, after = points[k] - points[k - 1], points[k + 1] - points[k]
        turn = before[0] * after[1] - before[1] * after[0]
        if abs(turn) > _TANGENT_JUMP * np.hypot(*before) * np.hypot(*after):
            corners.append(k)
    cuts = [0, *corners, len(points) - 1]
    pieces = [
        spline_coefficients(knots[first : last + 1], points[first : last + 1]).reshape(-1, 8)
        for first, last in pairwise(cuts)
    ]
    coefficients = np.ascontiguousarray(np.vstack(pieces))
    # area that every segment sweeps about the centre: three Gauss points are exact for cubics
    steps = np.diff(knots)
    nodes, weights = np.polynomial.legendre.leggauss(3)
    total = np.zeros_like(steps)
    for node, weight in zip(nodes, weights, strict=True):
        t = 0.5 * steps * (1.0 + node)
        c = coefficients.T
        x = c[0] + t * (c[1] + t * (c[2] + t * c[3]))
        y = c[4] + t * (c[5] + t * (c[6] + t * c[7]))
        dx = c[1] + t * (2.0 * c[2] + 3.0 * t * c[3])
        dy = c[5] + t * (2.0 * c[6] + 3.0 * t * c[7])
        total += 0.25 * steps * weight * (x * dy - y * dx)
    area = np.concatenate([[0.0], np.cumsum(total)])
    x, y = np.sign(tip_radius) * points[-1]
    corner = float(np.arctan2(y, x))
    return Flank(knots, coefficients, area, side, corner, tip_radius)


@inlined
def flank_length(flank: Flank) -> float:
    """Curve parameter of the tip corner. [m]."""
    return flank.knots[-1]


@inlined
def flank_segment(flank: Flank, place: float) -> int:
    """Index of the spline segment of a curve parameter in [m]."""
    index = int(np.searchsorted(flank.knots, place, side="right")) - 1
    return min(max(index, 0), flank.knots.size - 2)


@inlined
def flank_point(flank: Flank, place: float) -> tuple[float, float]:
    """Point at a curve parameter, tooth frame. [m]."""
    k = flank_segment(flank, place)
    t = place - flank.knots[k]
    c = flank.coefficients[k]
    return (
        c[0] + t * (c[1] + t * (c[2] + t * c[3])),
        c[4] + t * (c[5] + t * (c[6] + t * c[7])),
    )


@inlined
def flank_tangent(flank: Flank, place: float) -> tuple[float, float, float, float]:
    """First and second derivative of the curve, tooth frame. [-], [1/m]."""
    k = flank_segment(flank, place)
    t = place - flank.knots[k]
    c = flank.coefficients[k]
    return (
        c[1] + t * (2.0 * c[2] + 3.0 * t * c[3]),
        c[5] + t * (2.0 * c[6] + 3.0 * t * c[7]),
        2.0 * c[2] + 6.0 * t * c[3],
        2.0 * c[6] + 6.0 * t * c[7],
    )


@inlined
def flank_swept_area(flank: Flank, place: float) -> float:
    """Area swept by the radius from the root middle to a curve parameter. [m2]."""
    k = flank_segment(flank, place)
    t = place - flank.knots[k]
    total = flank.area[k]
    for node, weight in (
        (-0.7745966692414834, 0.5555555555555556),
        (0.0, 0.8888888888888888),
        (0.7745966692414834, 0.5555555555555556),
    ):
        at = flank.knots[k] + 0.5 * t * (1.0 + node)
        x, y = flank_point(flank, at)
        dx, dy, _, _ = flank_tangent(flank, at)
        total += 0.25 * t * weight * (x * dy - y * dx)
    return total


@inlined
def flank_curvature(flank: Flank, place: float) -> float:
    """Curvature of the solid, positive where convex. [1/m]."""
    dx, dy, ddx, ddy = flank_tangent(flank, place)
    speed = np.sqrt(dx * dx + dy * dy)
    return flank.side * (dy * ddx - dx * ddy) / speed**3
