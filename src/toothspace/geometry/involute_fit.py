"""Involute flanks in a given outline, and their deviations as a gear tester names them."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise
from typing import final

import numpy as np
import scipy
from numpy.typing import NDArray

from toothspace.core.types import Array
from toothspace.geometry.gear_profile import InvoluteFlank
from toothspace.geometry.involute_gear import involute_function


@final
@dataclass(frozen=True)
class ProfileDeviation:
    """Distance of one flank from an involute along its normal, over the roll length.

    References
    ----------
    .. [1] ISO 1328-1:2013, Cylindrical gears, ISO system of flank tolerance classification,
       section 4.4: profile deviations.
    """

    roll_length: Array
    """Length of the tangent from the base circle to each compared point, rising. [m]"""
    deviation: Array
    """Deviation, positive for excess material. [m]"""

    @property
    def total(self) -> float:
        """Total profile deviation F_alpha, peak to peak [m]."""
        return float(np.ptp(self.deviation))

    @property
    def slope(self) -> float:
        """Profile slope deviation f_H_alpha, rise of the mean line over its length [m]."""
        return float(self._mean_line()[-1] - self._mean_line()[0])

    @property
    def form(self) -> float:
        """Profile form deviation f_f_alpha, peak to peak about the mean line [m]."""
        return float(np.ptp(self.deviation - self._mean_line()))

    def _mean_line(self) -> Array:
        if len(self.deviation) < 3:
            return self.deviation
        weight = np.sqrt(np.abs(np.gradient(self.roll_length)))
        line = np.polynomial.Polynomial.fit(self.roll_length, self.deviation, 1, w=weight)
        return np.asarray(line(self.roll_length))


@final
@dataclass(frozen=True)
class PitchDeviation:
    """Places of the teeth on a measuring circle about the centre that fits all teeth.

    References
    ----------
    .. [1] ISO 1328-1:2013, Cylindrical gears, ISO system of flank tolerance classification,
       section 4.3: pitch deviations; annex on run-out.
    """

    left: Array
    right: Array
    """Index deviation of the flanks, arc from the even place, counter-clockwise positive. Shape
    (tooth_count,). [m]
    """
    radial: Array
    """Radial place of a ball in the space after each tooth. Shape (tooth_count,). [m]"""

    @property
    def single(self) -> float:
        """Largest single pitch deviation f_p of both flanks [m]."""
        steps = [np.abs(np.roll(side, -1) - side).max() for side in (self.left, self.right)]
        return float(max(steps))

    @property
    def cumulative(self) -> float:
        """Total cumulative pitch deviation F_p, larger of both flanks [m]."""
        return float(max(np.ptp(self.left), np.ptp(self.right)))

    @property
    def run_out(self) -> float:
        """Run-out F_r of a ball in the tooth spaces [m]."""
        return float(np.ptp(self.radial))


_LARGEST_RESIDUAL = 0.01
"""Of the tooth height: beyond it the flank is no involute. [-]"""
_SHORTEST = 0.4
"""Least part of the tooth height that the involute must cover. [-]"""
_START = (0.5, 0.9)
_LARGEST_GAP = 0.02
"""Of the tooth height: a deviation that a flank may have between points that fit. [-]"""
_MOST_OF_THEM, _ERROR_FACTOR = 0.9, 1.3
_LEAST_TOLERANCE = 3e-4, 3e-5
"""Of the tooth height, for flanks of few and of many points: splines of CAD programs leave the
involute as far, and few points do not show it. [-]"""
_MANY_NODES = 60
_MOST_POINTS = 24000
_MOST_NODES = 240
_ROUNDS = 12
_FLATTEST = 0.35
LEFT, RIGHT = 1.0, -1.0


@final
@dataclass(frozen=True)
class FlankPoints:
    """Points of all teeth turned onto one tooth that is centred on the x axis."""

    radius: Array
    angle: Array
    """Polar coordinates; positive angles are on the left flank. Shape (n,). [m], [rad]"""
    weight: Array
    """Part of the tooth height that each point stands for, any common factor. Shape (n,). [-]"""
    tooth: NDArray[np.int64]
    """Tooth that each point belongs to, counter-clockwise. Shape (n,)."""
    tooth_count: int
    """Number of teeth that were turned onto one."""

    def on_side(self, side: float) -> FlankPoints:
        """Points of one flank, angles positive on either side."""
        chosen = self.taken(np.flatnonzero(np.sign(self.angle) == side))
        return replace(chosen, angle=side * chosen.angle)

    def taken(self, index: NDArray[np.intp]) -> FlankPoints:
        """Points with the given indices."""
        return replace(
            self,
            radius=self.radius[index],
            angle=self.angle[index],
            weight=self.weight[index],
            tooth=self.tooth[index],
        )


@final
@dataclass(frozen=True)
class InvoluteFit:
    """Involute that lies closest to both flanks of a tooth, and how far they leave it."""

    flank: InvoluteFlank
    """The involute and its ends."""
    turn: float
    """Polar angle of the tooth axis of the involute in the frame of the points. [rad]"""
    left: ProfileDeviation
    right: ProfileDeviation
    """Deviation of each flank between the ends, median of all teeth."""
    cut: float
    """Largest distance of the flanks inside the involute between base circle and form radius, 0
    without undercut. [m]
    """
    left_offset: Array
    right_offset: Array
    """Median distance of each tooth's flank from the involute, positive for excess material. Shape
    (tooth_count,). [m]
    """

    def pitch_deviation(self, radius: float) -> PitchDeviation:
        """Deviations of pitch and run-out on a circle of a radius [m]; see ``PitchDeviation``."""
        angle = self.flank.pressure_angle(radius)
        indices = []
        for place in (self.left_offset, -self.right_offset):
            indices.append((place - place.mean()) / np.cos(angle))
        # a ball in the space after tooth k touches its left flank and the next right flank
        moved = self.left_offset + np.roll(self.right_offset, -1)
        return PitchDeviation(indices[0], indices[1], 0.5 * moved / np.sin(angle))

    @property
    def form_error(self) -> float:
        """Larger total profile deviation of both flanks [m]."""
        return max(self.left.total, self.right.total)

    @property
    def base_diameter_uncertainty(self) -> float:
        r"""Change of the base diameter that tilts the involute by the form error [m].

        At the roll angle :math:`\xi` the involute moves by :math:`\xi\,\mathrm{d}r_b` along its
        normal.
        """
        flank = self.flank
        rolled = flank.roll_length(flank.tip_form_radius) - flank.roll_length(flank.form_radius)
        return 2.0 * self.form_error * flank.base_radius / rolled


def folded_points(points: Array, tooth_count: int, phase: float) -> FlankPoints:
    """Turn the flank points of a gear onto one tooth.

    Points at which the outline rises or falls; those of root and tip circle are left out.

    Parameters
    ----------
    points : ndarray, shape (n, 2)
        Closed outline about the gear centre. [m]
    phase : float
        Polar angle of a tooth axis. [rad]
    """
    pitch = 2.0 * np.pi / tooth_count
    radius = np.hypot(points[:, 0], points[:, 1])
    turned = np.arctan2(points[:, 1], points[:, 0]) - phase
    tooth = np.floor((turned + 0.5 * pitch) / pitch).astype(np.int64)
    angle = turned - pitch * tooth
    step = np.roll(points, -1, axis=0) - points
    length = np.maximum(np.hypot(step[:, 0], step[:, 1]), 1e-300)
    rise = np.abs(np.roll(radius, -1) - radius)
    steepest = np.maximum(rise / length, np.roll(rise / length, 1))
    weight = 0.5 * (rise + np.roll(rise, 1))
    keep = (steepest > _FLATTEST) & (weight > 0.0)
    tooth = tooth[keep] % tooth_count
    return FlankPoints(radius[keep], angle[keep], weight[keep], tooth, tooth_count)


def fit_involute(points: FlankPoints, root_radius: float, tip_radius: float) -> InvoluteFit | None:
    r"""Fit one involute to both flanks of a tooth and find where it begins and ends.

    The fit; None where it leaves more than 1 % of the tooth height or covers less than 40 % of it,
    so that the flank is no involute.

    Parameters
    ----------
    root_radius, tip_radius : float
        Ends of the tooth. [m]

    Notes
    -----
    A point of radius :math:`r` and polar angle :math:`\vartheta` from the tooth axis has the
    normal distance

    .. math:: d = r_b \left(\vartheta - \vartheta_b + \mathrm{inv}\arccos(r_b/r)\right)

    from the involute with base radius :math:`r_b` and half angle :math:`\vartheta_b`. Both are
    found by robust least squares (soft L1) over a range of radii that begins at 50 to 90 % of the
    tooth height and is widened or narrowed to the points whose distance is no more than 1.3 times
    what nine tenths of those inside have, at least 0.003 % of the tooth height, 0.03 % for few
    points. A dent between points that fit does not end the range. The
    points themselves count, not the chords between them.
    """
    height = tip_radius - root_radius
    sides = {side: points.on_side(side) for side in (LEFT, RIGHT)}
    for side, own in sides.items():
        # by rising radius, a limited number
        order = np.argsort(own.radius, kind="stable")
        sides[side] = own.taken(order[:: max(len(order) // _MOST_POINTS, 1)])
    if min(len(side.radius) for side in sides.values()) < 3 or height <= 0.0:
        return None
    low, high = (root_radius + share * height for share in _START)
    unknowns = _first_guess(sides, low, high)
    for _ in range(_ROUNDS):
        unknowns = _least_squares(sides, unknowns, low, high)
        nodes = {side: _nodes(sides[side], unknowns, side) for side in sides}
        # the ends allow a multiple of the error of the flank found so far
        inner = [
            distance[(radius >= low) & (radius <= high)] for radius, distance in nodes.values()
        ]
        distance = np.abs(np.concatenate(inner))
        error = float(np.quantile(distance, _MOST_OF_THEM)) if len(distance) else 0.0
        least = _LEAST_TOLERANCE[len(distance) >= _MANY_NODES]
        tolerance = max(_ERROR_FACTOR * error, least * height)
        ends = [_ends(*nodes[side], unknowns[0], tolerance, height, (low, high)) for side in nodes]
        found = max(end[0] for end in ends), min(end[1] for end in ends)
        if found[1] - found[0] < _SHORTEST * height:
            return None
        if found == (low, high):
            break
        low, high = found
    walked = [_walked(sides[side], unknowns, side, (low, high), tolerance) for side in sides]
    found = max(end[0] for end in walked), min(end[1] for end in walked)
    base, left, right = unknowns
    residual = _residual(sides, unknowns, *found)
    if not residual <= _LARGEST_RESIDUAL * height:
        return None
    curves = {side: _curve(*nodes[side], base, found) for side in nodes}
    # most negative distance between base circle and form radius
    below = [distance[(r > base) & (r < found[0])] for r, distance in nodes.values()]
    depth = min(float(distance.min(initial=0.0)) for distance in below)
    cut = -depth if depth < -max(tolerance, 1e-3 * height) else 0.0
    half = float(0.5 * (left + right))
    flank = InvoluteFlank(float(base), half, *found, undercut=cut > 0.0, residual=residual)
    offsets = {side: _offsets(sides[side], unknowns, side, found) for side in sides}
    return InvoluteFit(
        flank=flank,
        turn=float(0.5 * (left - right)),
        left=curves[LEFT],
        right=curves[RIGHT],
        cut=cut,
        left_offset=offsets[LEFT],
        right_offset=offsets[RIGHT],
    )


def _offsets(points: FlankPoints, unknowns: Array, side: float, ends: tuple[float, float]) -> Array:
    distance = _distance(points.radius, points.angle, unknowns, side)
    inside = (points.radius >= ends[0]) & (points.radius <= ends[1])
    own = [distance[inside & (points.tooth == k)] for k in range(points.tooth_count)]
    return np.array([float(np.median(part)) if len(part) else 0.0 for part in own])


def _distance(radius: Array, angle: Array, unknowns: Array, side: float) -> Array:
    # below the base circle the involute goes on as a radial line
    base, offset = unknowns[0], unknowns[1] if side == LEFT else unknowns[2]
    roll = involute_function(np.arccos(np.minimum(base / radius, 1.0)))
    return np.asarray(np.minimum(base, radius) * (angle - offset + roll))


def distance_from_involute(
    radius: Array, angle: Array, flank: InvoluteFlank
) -> tuple[Array, Array]:
    """Roll length and distance along the normal of points beside an involute flank.

    Roll length, 0 inside the base circle, and distance, positive for excess material. [m]

    Parameters
    ----------
    radius, angle : ndarray
        Polar coordinates, angles from the tooth axis towards the flank. [m], [rad]
    """
    unknowns = np.array([flank.base_radius, flank.base_half_angle, flank.base_half_angle])
    return flank.roll_length(radius), _distance(radius, angle, unknowns, LEFT)


def _first_guess(sides: dict[float, FlankPoints], low: float, high: float) -> Array:
    best, guess = np.inf, np.zeros(3)
    inside = {side: _inside(points, low, high) for side, points in sides.items()}
    for base in high * np.linspace(0.5, 0.995, 100):
        cost, offsets = 0.0, []
        for side, points in inside.items():
            distance = _distance(points.radius, points.angle, np.array([base, 0.0, 0.0]), side)
            order, share = np.argsort(distance), points.weight / points.weight.sum()
            total = np.cumsum(points.weight[order])
            offset = float(distance[order][np.searchsorted(total, 0.5 * total[-1])])
            cost += float(np.sum(share * np.abs(distance - offset)))
            offsets.append(offset / base)
        if cost < best:
            best, guess = cost, np.array([base, *offsets])
    return guess


def _inside(points: FlankPoints, low: float, high: float) -> FlankPoints:
    # the range, or all points above its begin where a coarse outline has hardly any in it
    inside = (points.radius >= low) & (points.radius <= high)
    if not inside.any() or np.ptp(points.radius[inside]) < 0.4 * (high - low):
        inside = points.radius >= low
    return points.taken(np.flatnonzero(inside)) if inside.any() else points


def _least_squares(sides: dict[float, FlankPoints], start: Array, low: float, high: float) -> Array:

    inside = {side: _inside(points, low, high) for side, points in sides.items()}
    first = [_distance(points.radius, points.angle, start, side) for side, points in inside.items()]
    scale = max(1.4826 * float(np.median(np.abs(np.concatenate(first)))), 1e-9)
    size = np.array([start[0], 1.0, 1.0])

    def residuals(unknowns: Array) -> Array:
        parts = []
        for side, points in inside.items():
            weight = np.sqrt(points.weight / points.weight.mean())
            distance = _distance(points.radius, points.angle, unknowns * size, side)
            parts.append(weight * distance / scale)
        return np.concatenate(parts)

    bounds = (np.array([0.3 * high / start[0], -np.pi, -np.pi]),
              np.array([0.9999 * high / start[0], np.pi, np.pi]))  # fmt: skip
    solution = scipy.optimize.least_squares(
        residuals, start / size, bounds=bounds, loss="soft_l1", xtol=1e-14, ftol=1e-14, gtol=1e-14
    )
    return np.asarray(solution.x * size)


def _nodes(points: FlankPoints, unknowns: Array, side: float) -> tuple[Array, Array]:
    # medians over groups of neighbouring radii: one point of every tooth, or more
    distance = _distance(points.radius, points.angle, unknowns, side)
    count = len(distance)
    size = max(points.tooth_count, -(-count // _MOST_NODES))
    groups = max(round(count / size), min(count, 3))
    edges = np.linspace(0, count, groups + 1).round().astype(int)
    pairs = list(pairwise(edges))
    radius = np.array([np.median(points.radius[a:b]) for a, b in pairs])
    return radius, np.array([np.median(distance[a:b]) for a, b in pairs])


def _ends(
    radius: Array,
    distance: Array,
    base: float,
    tolerance: float,
    height: float,
    present: tuple[float, float],
) -> tuple[float, float]:
    # from the best point of the present range outwards to the last points that fit
    inside = (radius >= present[0]) & (radius <= present[1]) & (radius > base)
    if not inside.any():
        return np.inf, 0.0
    start = int(np.flatnonzero(inside)[np.argmin(np.abs(distance[inside]))])
    bridged = (np.abs(distance) <= max(_LARGEST_GAP * height, tolerance)) & (radius > base)
    fits = (np.abs(distance) <= tolerance) & (radius > base)
    outwards = np.flatnonzero(~bridged[start:])
    inwards = np.flatnonzero(~bridged[: start + 1])
    last = start + int(outwards[0]) if len(outwards) else len(radius)
    first = int(inwards[-1]) + 1 if len(inwards) else 0
    good = np.flatnonzero(fits[first:last]) + first
    if len(good) == 0:
        return np.inf, 0.0
    return float(radius[good[0]]), float(radius[good[-1]])


def _walked(
    points: FlankPoints, unknowns: Array, side: float, ends: tuple[float, float], tolerance: float
) -> tuple[float, float]:
    # single points beyond the last groups of points, as long as they fit
    distance = _distance(points.radius, points.angle, unknowns, side)
    stray = (np.abs(distance) > tolerance) | (points.radius <= unknowns[0])
    below = points.radius[stray & (points.radius < ends[0])].max(initial=0.0)
    above = points.radius[stray & (points.radius > ends[1])].min(initial=np.inf)
    good = points.radius[~stray & (points.radius > below) & (points.radius < above)]
    return min(float(good.min(initial=ends[0])), ends[0]), max(
        float(good.max(initial=ends[1])), ends[1]
    )


def _residual(sides: dict[float, FlankPoints], unknowns: Array, low: float, high: float) -> float:
    total, weight = 0.0, 0.0
    for side, points in sides.items():
        keep = (points.radius >= low) & (points.radius <= high)
        distance = _distance(points.radius[keep], points.angle[keep], unknowns, side)
        total += float(np.sum(points.weight[keep] * distance**2))
        weight += float(points.weight[keep].sum())
    return float(np.sqrt(total / weight)) if weight > 0.0 else np.inf


def _curve(
    radius: Array, distance: Array, base: float, ends: tuple[float, float]
) -> ProfileDeviation:
    keep = (radius >= ends[0]) & (radius <= ends[1])
    rolled = np.sqrt(np.maximum(radius[keep] ** 2 - base**2, 0.0))
    return ProfileDeviation(rolled, distance[keep])
