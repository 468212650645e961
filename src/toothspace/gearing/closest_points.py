"""Closest points of two facing flanks, compiled.

A place on a flank is its spline parameter, from 0 in the root middle to the tip corner.
Every flank stands in the machine frame: turned by an angle, then shifted by its centre.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from toothspace.core.compiled import inlined
from toothspace.gearing.tooth import Flank, flank_length, flank_point, flank_tangent

FREE, FIRST_AT_CORNER, SECOND_AT_CORNER = 0, 1, 2
"""How the closest points lie: common normal, or one of them at its flank's tip corner."""

_ITERATIONS = 30
_TOLERANCE = 1e-13
_OVERLAP = 2e-5
"""Largest overlap of flanks, which have a common normal longer than the way to a crossing. [m]"""
_ROUNDING = 1.0 + 1e-9


class Placement(NamedTuple):
    """Where a gear's tooth stands: polar angle of the tooth [rad] and height of the centre [m]."""

    angle: float
    center: float


class Closest(NamedTuple):
    """Closest points: their places on the flanks [m] and how they lie."""

    first: float
    second: float
    mode: int


@inlined
def placed_point(flank: Flank, at: Placement, place: float) -> tuple[float, float]:
    """Point of a flank in the machine frame. [m]."""
    x, y = flank_point(flank, place)
    c, s = np.cos(at.angle), np.sin(at.angle)
    return c * x - s * y, s * x + c * y + at.center


@inlined
def placed_tangent(flank: Flank, at: Placement, place: float) -> tuple[float, float, float, float]:
    """First and second derivative of a flank in the machine frame. [-], [1/m]."""
    dx, dy, ddx, ddy = flank_tangent(flank, place)
    c, s = np.cos(at.angle), np.sin(at.angle)
    return c * dx - s * dy, s * dx + c * dy, c * ddx - s * ddy, s * ddx + c * ddy


@inlined
def nearest_knots(
    first: Flank, at_first: Placement, second: Flank, at_second: Placement
) -> tuple[float, float]:
    """Places of the closest pair of spline knots. [m]."""
    n, m = first.knots.size, second.knots.size
    # the second flank is seen from the first flank's tooth frame
    turn = at_second.angle - at_first.angle
    c, s = np.cos(turn), np.sin(turn)
    rise = at_second.center - at_first.center
    shift_x, shift_y = np.sin(at_first.angle) * rise, np.cos(at_first.angle) * rise
    best, best_i, best_j = 1e300, 0, 0
    xs, ys = np.empty(n), np.empty(n)
    for i in range(n):
        xs[i], ys[i] = flank_point(first, first.knots[i])
    for j in range(m):
        u, v = flank_point(second, second.knots[j])
        x, y = c * u - s * v + shift_x, s * u + c * v + shift_y
        for i in range(n):
            d = (x - xs[i]) ** 2 + (y - ys[i]) ** 2
            if d < best:
                best, best_i, best_j = d, i, j
    return first.knots[best_i], second.knots[best_j]


@inlined
def project(flank: Flank, at: Placement, x: float, y: float, guess: float) -> float:
    """Place of the point of a flank closest to a given point, near a guess. [m]."""
    length = flank_length(flank)
    place = guess
    for _ in range(_ITERATIONS):
        px, py = placed_point(flank, at, place)
        dx, dy, ddx, ddy = placed_tangent(flank, at, place)
        residual = (px - x) * dx + (py - y) * dy
        slope = dx * dx + dy * dy + (px - x) * ddx + (py - y) * ddy
        if slope <= 0.1:
            slope = dx * dx + dy * dy
        step = min(max(-residual / slope, -0.05 * length), 0.05 * length)
        following = min(max(place + step, 0.0), length)
        change = abs(following - place)
        place = following
        if change < _TOLERANCE:
            break
    return place


@inlined
def nearest_knot(flank: Flank, at: Placement, x: float, y: float) -> float:
    """Place of the spline knot closest to a point. [m]."""
    best, place = 1e300, 0.0
    for k in range(flank.knots.size):
        px, py = placed_point(flank, at, flank.knots[k])
        d = (px - x) ** 2 + (py - y) ** 2
        if d < best:
            best, place = d, flank.knots[k]
    return place


@inlined
def common_normal(
    first: Flank, at_first: Placement, second: Flank, at_second: Placement, start: Closest
) -> tuple[float, float, bool]:
    """Newton for parallel tangents and a line at right angles to them: places [m], whether found.

    Well conditioned at zero distance, where minimising the distance is not.
    """
    s, t = start.first, start.second
    limit_s, limit_t = 0.03 * flank_length(first), 0.03 * flank_length(second)
    for _ in range(_ITERATIONS):
        px, py = placed_point(first, at_first, s)
        qx, qy = placed_point(second, at_second, t)
        ax, ay, axx, ayy = placed_tangent(first, at_first, s)
        bx, by, bxx, byy = placed_tangent(second, at_second, t)
        gx, gy = qx - px, qy - py
        parallel, across = ax * by - ay * bx, gx * ax + gy * ay
        j11, j12 = axx * by - ayy * bx, ax * byy - ay * bxx
        j21, j22 = gx * axx + gy * ayy - ax * ax - ay * ay, bx * ax + by * ay
        det = j11 * j22 - j12 * j21
        if abs(det) < 1e-9:
            return s, t, False
        step_s = (j12 * across - j22 * parallel) / det
        step_t = (j21 * parallel - j11 * across) / det
        scale = max(abs(step_s) / limit_s, abs(step_t) / limit_t, 1.0)
        s, t = s + step_s / scale, t + step_t / scale
        if s < 0.0 or t < 0.0 or s > flank_length(first) or t > flank_length(second):
            return s, t, False
        if abs(step_s) + abs(step_t) < _TOLERANCE:
            return s, t, True
    return s, t, abs(step_s) + abs(step_t) < 1e-10


@inlined
def distance(
    first: Flank, at_first: Placement, second: Flank, at_second: Placement, pair: Closest
) -> float:
    """Distance of two points on the flanks. [m]."""
    px, py = placed_point(first, at_first, pair.first)
    qx, qy = placed_point(second, at_second, pair.second)
    return np.sqrt((px - qx) ** 2 + (py - qy) ** 2)


@inlined
def alternated(
    first: Flank,
    at_first: Placement,
    second: Flank,
    at_second: Placement,
    start: Closest,
    rounds: int,
) -> Closest:
    """Project in turn from one flank onto the other: slow, but never lost, corners included."""
    s, t = start.first, start.second
    for _ in range(rounds):
        x, y = placed_point(first, at_first, s)
        following = project(second, at_second, x, y, t)
        x, y = placed_point(second, at_second, following)
        place = project(first, at_first, x, y, s)
        change = abs(place - s) + abs(following - t)
        s, t = place, following
        if change < _TOLERANCE:
            break
    mode = FREE
    if t >= flank_length(second):
        mode = SECOND_AT_CORNER
    elif s >= flank_length(first):
        mode = FIRST_AT_CORNER
    return Closest(s, t, mode)


@inlined
def closest_points(
    first: Flank, at_first: Placement, second: Flank, at_second: Placement
) -> Closest:
    """Closest points of two flanks: on a common normal, or with one at its tip corner."""
    s0, t0 = nearest_knots(first, at_first, second, at_second)
    start = Closest(s0, t0, FREE)
    reach = distance(first, at_first, second, at_second, start)
    for rounds in (4, 40, 300):
        start = alternated(first, at_first, second, at_second, start, rounds)
        reach = min(reach, distance(first, at_first, second, at_second, start))
        s, t, found = common_normal(first, at_first, second, at_second, start)
        free = Closest(s, t, FREE)
        within = max(reach * _ROUNDING, _OVERLAP)
        if found and distance(first, at_first, second, at_second, free) <= within:
            return free
        if start.mode != FREE:
            break
    return start


@inlined
def refined(
    first: Flank, at_first: Placement, second: Flank, at_second: Placement, near: Closest
) -> Closest:
    """Closest points at a slightly different placement, lying as before."""
    if near.mode == FIRST_AT_CORNER:
        x, y = placed_point(first, at_first, near.first)
        return Closest(near.first, project(second, at_second, x, y, near.second), near.mode)
    if near.mode == SECOND_AT_CORNER:
        x, y = placed_point(second, at_second, near.second)
        return Closest(project(first, at_first, x, y, near.first), near.second, near.mode)
    s, t, found = common_normal(first, at_first, second, at_second, near)
    if found:
        return Closest(s, t, FREE)
    return near
