"""Find teeth, centre and phase in a closed gear outline and fold all teeth into one pitch."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import final

import numpy as np
import scipy

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array, BoolArray
from toothspace.geometry.curve import (
    CurveSegment,
    arc_lengths,
    checked_polygon,
    chord_heights,
    counter_clockwise,
    even_points,
    polar,
    resample_by_curvature,
    sample_segments,
    signed_area,
    turned,
)
from toothspace.geometry.gear_profile import GearProfile, InvoluteFlank
from toothspace.geometry.involute_fit import (
    LEFT,
    RIGHT,
    FlankPoints,
    InvoluteFit,
    distance_from_involute,
    fit_involute,
    folded_points,
)
from toothspace.geometry.involute_gear import MAX_TOOTH_COUNT, MIN_TOOTH_COUNT
from toothspace.geometry.tooth_count import area_elements, area_phase, centroid, repeating_teeth
from toothspace.geometry.tooth_deviations import ToothDeviations, even_nodes

_CORNER_ANGLE = np.deg2rad(20.0)
_SECTION_POINTS = 1501
_CENTER_STEPS = 6
_CENTER_TOLERANCE = 1e-9
_FLAT_LAND = 2e-3
_FEWEST_POINTS = 16


@final
@dataclass(frozen=True)
class DetectedGear:
    """What a gear outline contains."""

    profile: GearProfile
    """Smooth tooth, own frame, centred on the x axis: where the flanks are involutes, the one that
    fits all teeth; root and tip are the median of all teeth.
    """
    drawn: GearProfile
    """Median of all teeth as in the outline."""
    involute: InvoluteFit | None
    """The fit with its form error; None where the flanks are no involutes."""
    chord_height: float
    """Largest distance of the chords of the outline from the flanks between its points. [m]"""
    center: tuple[float, float]
    """Gear centre in the frame of the outline. [m]"""
    phase: float
    """Polar angle of the first tooth axis about the centre, 0 to one pitch. [rad]"""
    tooth_count: int
    """Number of teeth."""
    tooth_deviation: Array
    """Largest distance of each tooth from the median tooth, shape (tooth_count,). [m]"""
    deviations: ToothDeviations | None = None
    """Deviations of every tooth from the fit; None without one, or in an outline of one pitch."""


def gear_profile_from_curve(
    points: Array, points_per_tooth: int = 200, key: str = "profile", tooth_count: int | None = None
) -> DetectedGear:
    r"""Gear in a closed outline of all its teeth, or of one pitch if the tooth count is given.

    Median tooth, centre, phase, tooth count, deviation of every tooth.

    Raises GeometryError for an empty or self-crossing curve, or one without 5 to 400 equal teeth.

    Parameters
    ----------
    points : ndarray
        Closed curve, shape (n, 2), in any position and direction. [m]
    points_per_tooth : int
        Number of intervals of the resulting pitch, even, at least 40.
    key : str
        Name of the outline for error messages.
    tooth_count : int or None
        Needed for an outline of a single pitch, root middle to root middle with the gear centre at
        the origin and any connection inside the root; not used for a whole gear.

    Notes
    -----
    The tooth count is the strongest term of the area spectrum
    :math:`c_k = \frac12 \oint r^2 e^{-ik\vartheta} d\vartheta`, which also holds for undercut
    teeth whose radius is not a function of the angle; its argument gives the phase. The outline
    is divided finely before, so that the distance of its points does not count. The centre
    starts at the centroid and is shifted until the mean of the opposing deviations vanishes.
    Involutes are fitted to the points of the outline, not to the chords between them.
    """
    checked = checked_polygon(points, key)
    if tooth_count is not None and _polar_span(checked) < 1.5 * 2.0 * np.pi / tooth_count:
        # the outer side of a counter-clockwise curve runs from the smallest to the largest angle
        radius = np.hypot(checked[:, 0], checked[:, 1])
        outer = checked[radius > 1e-6 * radius.max()]
        toward = float(np.arctan2(outer[:, 1].mean(), outer[:, 0].mean()))
        upright = turned(outer, -toward)
        radius = np.hypot(upright[:, 0], upright[:, 1])
        angle = np.arctan2(upright[:, 1], upright[:, 0])
        first = int(np.argmax(np.where(angle < angle.min() + 1e-6, radius, 0.0)))
        last = int(np.argmax(np.where(angle > angle.max() - 1e-6, radius, 0.0)))
        path = np.roll(upright, -first, axis=0)[: (last - first) % len(upright) + 1]
        found = gear_profile_from_tooth(path, tooth_count, points_per_tooth, key)
        return replace(found, phase=(toward + found.phase) % (2.0 * np.pi / tooth_count))
    # the closed curve is cut at a corner or, without any, at an ordinary point
    corners = np.flatnonzero(_bends(np.vstack([checked[-1:], checked, checked[:1]])))
    rolled = np.roll(checked, -int(corners[0]) if len(corners) else 0, axis=0)
    outline = _smooth_open(np.vstack([rolled, rolled[:1]]))[:-1]
    center = centroid(outline)
    about = outline - center
    _, area = area_elements(about)
    if abs(area.sum() - abs(signed_area(about))) > 0.05 * abs(signed_area(about)):
        raise GeometryError(key, "an outline that does not run round its centre", "a whole gear")
    teeth_found = repeating_teeth(about)
    if teeth_found is None:
        raise GeometryError(
            key,
            "no repeating teeth",
            f"an outline of {MIN_TOOTH_COUNT} to {MAX_TOOTH_COUNT} equal teeth",
        )
    for _ in range(_CENTER_STEPS):
        phase = area_phase(outline - center, teeth_found)
        teeth = _teeth_in_sections(outline - center, teeth_found, phase, key)
        # a shift d moves every point by its normal part n.d: least squares over all teeth
        middle = np.median(teeth, axis=0)
        normals, length = _normals(middle)
        apart = np.sum((teeth - middle) * normals, axis=2)
        pitch = 2.0 * np.pi / len(teeth)
        directions = np.vstack([turned(normals, phase + k * pitch) for k in range(len(teeth))])
        limit = 3.0 * np.median(np.abs(apart)) + 1e-12
        weight = np.minimum(1.0, limit / np.maximum(np.abs(apart.ravel()), 1e-15))
        weight *= np.tile(length, len(teeth))
        matrix = directions.T @ (directions * weight[:, None])
        shift = np.linalg.solve(matrix, directions.T @ (weight * apart.ravel()))
        center = center + shift
        if np.hypot(*shift) < _CENTER_TOLERANCE:
            break
    median = np.median(teeth, axis=0)
    turn = _flank_symmetry(median)
    folded = folded_points(checked - center, teeth_found, phase + turn)
    found = _found(turned(median, -turn), folded, teeth_found, points_per_tooth)
    # the largest distance of every tooth from the median one
    normal, _ = _normals(median)
    nearest = scipy.spatial.KDTree(median)
    largest = []
    for tooth in teeth:
        index = nearest.query(tooth[::4])[1]
        gap = np.sum((tooth[::4] - median[index]) * normal[index], axis=1)
        largest.append(float(np.abs(gap).max()))
    return replace(
        found,
        center=(float(center[0]), float(center[1])),
        phase=float((phase + turn + found.phase) % (2.0 * np.pi / teeth_found)),
        chord_height=_chord_height(checked - center),
        tooth_deviation=np.array(largest),
        deviations=_flank_deviations(teeth, turn, found),
    )


def _flank_deviations(teeth: Array, turn: float, found: DetectedGear) -> ToothDeviations | None:
    if found.involute is None:
        return None
    flank = found.involute.flank
    nodes = even_nodes(flank)
    sides = []
    for side, part in (
        (LEFT, slice(2 * _SECTION_POINTS, None)),
        (RIGHT, slice(0, _SECTION_POINTS)),
    ):
        rows = []
        for tooth in teeth:
            radius = np.hypot(*tooth[part].T)
            angle = np.arctan2(tooth[part][:, 1], tooth[part][:, 0]) - turn - found.involute.turn
            roll, distance = distance_from_involute(radius, side * angle, flank)
            order = np.argsort(roll)
            rows.append(np.interp(nodes, roll[order], distance[order]))
        sides.append(np.array(rows))
    tips = np.hypot(teeth[..., 0], teeth[..., 1]).max(axis=1)
    return ToothDeviations(nodes, sides[0], sides[1], tips - np.median(tips))


def _found(
    tooth: Array, points: FlankPoints, tooth_count: int, points_per_tooth: int
) -> DetectedGear:
    # about the centre, phase measured from the x axis of the tooth
    drawn = _profile_from_tooth(tooth, tooth_count, points_per_tooth)
    fit = fit_involute(points, drawn.root_radius, drawn.tip_radius)
    smooth, turn = drawn, 0.0
    if fit is not None:
        turn = fit.turn
        right, _, left = np.split(_round_land(turned(tooth, -turn)),
                                  [_SECTION_POINTS, 2 * _SECTION_POINTS])  # fmt: skip
        smooth = fitted_profile(right, left, fit.flank, tooth_count, points_per_tooth)
    return DetectedGear(
        profile=smooth,
        drawn=drawn,
        involute=fit,
        chord_height=0.0,
        center=(0.0, 0.0),
        phase=turn,
        tooth_count=tooth_count,
        tooth_deviation=np.zeros(1),
    )


def gear_profile_from_tooth(
    points: Array, tooth_count: int, points_per_tooth: int = 200, key: str = "profile"
) -> DetectedGear:
    """Gear from the open curve of a single pitch, root middle to root middle.

    The pitch, tooth turned to the x axis; its phase is that of the curve.

    Raises GeometryError if the curve does not span one pitch within 1 %, or its ends differ in
    radius by over 1 %.

    Parameters
    ----------
    points : ndarray
        Open curve, shape (n, 2), gear centre at the origin, in either direction. [m]
    points_per_tooth : int
        Number of intervals of the resulting pitch.
    key : str
        Name of the curve for error messages.
    """
    angle = np.unwrap(np.arctan2(points[:, 1], points[:, 0]))
    ordered = points if angle[-1] > angle[0] else points[::-1]
    span, pitch = abs(angle[-1] - angle[0]), 2.0 * np.pi / tooth_count
    radius = np.hypot(ordered[:, 0], ordered[:, 1])
    if abs(span - pitch) > 0.01 * pitch or abs(radius[0] - radius[-1]) > 0.01 * radius[0]:
        raise GeometryError(
            key,
            f"an open curve over {np.rad2deg(span):.4g} deg with end radii {radius[0] * 1e3:.4g} "
            f"and {radius[-1] * 1e3:.4g} mm",
            f"one pitch of {np.rad2deg(pitch):.4g} deg between equal radii",
        )
    middle = 0.5 * (angle[0] + angle[-1])
    centered = turned(_smooth_open(ordered), -middle)
    tooth = _in_sections(centered, _tip_tolerance(centered))
    turn = _flank_symmetry(tooth)
    closed = turned(np.vstack([ordered, np.zeros((1, 2))]), -middle - turn)
    folded = folded_points(closed, tooth_count, 0.0)
    folded = replace(folded, tooth=np.zeros_like(folded.tooth), tooth_count=1)
    found = _found(turned(tooth, -turn), folded, tooth_count, points_per_tooth)
    return replace(found, chord_height=_chord_height(closed), phase=middle + turn + found.phase)


def _polar_span(points: Array) -> float:
    radius = np.hypot(points[:, 0], points[:, 1])
    outer = points[radius > 1e-6 * radius.max()]
    angle = np.sort(np.arctan2(outer[:, 1], outer[:, 0]))
    gaps = np.diff(np.append(angle, angle[0] + 2.0 * np.pi))
    return float(2.0 * np.pi - gaps.max())


def _smooth_open(points: Array) -> Array:
    # cubic splines between corners
    cuts = [0, *(np.flatnonzero(_bends(points)) + 1), len(points) - 1]
    pieces = []
    for a, b in pairwise(cuts):
        # four points per interval; straight where a spline would swing out
        piece = points[a : b + 1]
        along = arc_lengths(piece)
        fine = np.interp(np.arange(4 * (b - a) + 1) / 4.0, np.arange(len(along)), along)
        found = np.column_stack([np.interp(fine, along, piece[:, axis]) for axis in (0, 1)])
        if len(piece) >= 5:
            smooth = np.asarray(scipy.interpolate.CubicSpline(along, piece)(fine))
            interval = np.repeat(np.diff(along), 4)
            swing = np.hypot(*(smooth - found).T)[:-1] > 0.1 * interval
            found = np.where(np.append(swing, False)[:, None], found, smooth)
            found[::4] = piece
        pieces.append(found[:-1])
    return np.vstack([*pieces, points[-1:]])


def _bends(points: Array) -> BoolArray:
    # whether the polyline has a corner at each inner point
    step = np.diff(points, axis=0)
    heading = np.arctan2(step[:, 1], step[:, 0])
    bend = (np.diff(heading) + np.pi) % (2.0 * np.pi) - np.pi
    return np.abs(bend) > _CORNER_ANGLE


def _chord_height(points: Array) -> float:
    # largest on the flanks
    radius = np.hypot(*(0.5 * (points + np.roll(points, -1, axis=0))).T)
    low, high = radius.min() + np.array([0.2, 0.98]) * np.ptp(radius)
    flank = (radius > low) & (radius < high)
    return float(chord_heights(points)[flank].max(initial=0.0))


def _teeth_in_sections(points: Array, tooth_count: int, phase: float, key: str) -> Array:
    # every tooth turned to the x axis and described by the same number of points per section
    outline = counter_clockwise(points)
    angle = np.unwrap(np.arctan2(outline[:, 1], outline[:, 0]))
    pitch = 2.0 * np.pi / tooth_count
    start = phase - 0.5 * pitch
    cut = int(np.argmin(np.abs((angle - start + np.pi) % (2.0 * np.pi) - np.pi)))
    outline = np.roll(outline, -cut, axis=0)
    angle = np.unwrap(np.arctan2(outline[:, 1], outline[:, 0]))
    turns = np.round((angle[0] - start) / (2.0 * np.pi)) * 2.0 * np.pi
    angle = np.append(angle - turns, angle[0] - turns + 2.0 * np.pi)
    outline = np.vstack([outline, outline[:1]])
    pieces = [
        turned(_between(outline, angle, start + k * pitch, pitch, key), -(phase + k * pitch))
        for k in range(tooth_count)
    ]
    heights = [float(np.hypot(*piece.T).max()) for piece in pieces]
    scatter = float(np.ptp(heights))
    if scatter > 0.2 * (max(heights) - min(float(np.hypot(*p.T).min()) for p in pieces)):
        raise GeometryError(
            key,
            f"teeth whose tip radii differ by {scatter * 1e3:.3g} mm",
            f"{tooth_count} equal teeth",
        )
    return np.array([_in_sections(piece, _tip_tolerance(piece)) for piece in pieces])


def _between(outline: Array, angle: Array, start: float, span: float, key: str) -> Array:
    # first passage of both root middles, with the end points interpolated
    first = int(np.argmax(angle >= start - 1e-12))
    last = int(np.argmax(angle >= start + span - 1e-12))
    last = last if last > first else len(angle) - 1
    if last - first < _FEWEST_POINTS:
        raise GeometryError(
            key,
            f"{last - first} points on a tooth",
            f"at least {_FEWEST_POINTS} (an outline of one pitch needs tooth_count)",
        )
    begin = _at_angle(outline, angle, first, start)
    end = _at_angle(outline, angle, last, start + span)
    inner = outline[first:last]
    inner = inner[1:] if np.hypot(*(inner[0] - begin)) < 1e-12 else inner
    return np.vstack([begin, inner, end])


def _at_angle(outline: Array, angle: Array, index: int, at: float) -> Array:
    below = max(index - 1, 0)
    rise = angle[index] - angle[below]
    share = 1.0 if rise == 0.0 else float(np.clip((at - angle[below]) / rise, 0.0, 1.0))
    return outline[below] + share * (outline[index] - outline[below])


def _tip_tolerance(tooth: Array) -> float:
    # noise of the radius about a smooth curve on the middle half of the tip
    radius = np.hypot(tooth[:, 0], tooth[:, 1])
    height = float(np.ptp(radius))
    angle = np.arctan2(tooth[:, 1], tooth[:, 0])
    noise = []
    for share in (0.01, 0.001):  # round tips leave their land by less than the first
        top = np.flatnonzero(radius > radius.max() - share * height)
        low, high = angle[top].min(), angle[top].max()
        middle = top[np.abs(angle[top] - 0.5 * (low + high)) < 0.25 * (high - low)]
        if len(middle) > 12:
            smooth = np.polynomial.Polynomial.fit(angle[middle], radius[middle], 4)(angle[middle])
            noise.append(float(np.std(radius[middle] - smooth)))
    return max(2e-8, 1e-5 * height, 3.0 * min(noise, default=0.0))


def _in_sections(tooth: Array, tolerance: float) -> Array:
    radius = np.hypot(tooth[:, 0], tooth[:, 1])
    top = np.flatnonzero(radius >= radius.max() - tolerance)
    first, last = int(top[0]), int(top[-1])
    if last - first < 1:
        first, last = max(first - 1, 1), min(last + 1, len(tooth) - 2)
    sections = (tooth[: first + 1], tooth[first : last + 1], tooth[last:])
    return np.vstack([even_points(section, _SECTION_POINTS) for section in sections])


def _normals(curve: Array) -> tuple[Array, Array]:
    tangent = np.gradient(curve, axis=0)
    length = np.hypot(tangent[:, 0], tangent[:, 1])
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    return normal / np.maximum(length, 1e-15)[:, None], length


def _flank_symmetry(tooth: Array) -> float:
    # mean polar angle of both flanks at half height
    radius = np.hypot(tooth[:, 0], tooth[:, 1])
    angle = np.arctan2(tooth[:, 1], tooth[:, 0])
    right, left = slice(0, _SECTION_POINTS), slice(2 * _SECTION_POINTS, None)
    top, bottom = radius.max(), radius.min()
    levels = bottom + np.linspace(0.4, 0.8, 41) * (top - bottom)
    rising = np.interp(levels, np.maximum.accumulate(radius[right]), angle[right])
    falling = np.interp(levels, np.maximum.accumulate(radius[left][::-1]), angle[left][::-1])
    return float(0.5 * np.mean(rising + falling))


def _profile_from_tooth(tooth: Array, tooth_count: int, points_per_tooth: int) -> GearProfile:
    right, land, left = np.split(_round_land(tooth), [_SECTION_POINTS, 2 * _SECTION_POINTS])
    flank_intervals = int(0.46 * points_per_tooth)
    tip_end = points_per_tooth - flank_intervals
    first = resample_by_curvature(_thinned(right), flank_intervals)
    top = resample_by_curvature(_thinned(land), tip_end - flank_intervals)
    last = resample_by_curvature(_thinned(left), flank_intervals)
    points = np.vstack([first, top[1:], last[1:]])
    # neighbouring pitches share their end point
    half, end = np.pi / tooth_count, 0.5 * (np.hypot(*points[0]) + np.hypot(*points[-1]))
    points[0] = end * np.cos(half), -end * np.sin(half)
    points[-1] = end * np.cos(half), end * np.sin(half)
    radius = np.hypot(points[:, 0], points[:, 1])
    return GearProfile(
        tooth_count=tooth_count,
        points=points,
        tip_start=flank_intervals,
        tip_end=tip_end,
        tip_radius=float(radius.max()),
        root_radius=float(radius.min()),
    )


def _round_land(tooth: Array) -> Array:
    # noise and facets of a nearly circular land are replaced by its median circle
    radius = np.hypot(tooth[:, 0], tooth[:, 1])
    land = slice(_SECTION_POINTS - 1, 2 * _SECTION_POINTS + 1)
    middle = float(np.median(radius[land]))
    if np.abs(radius[land] - middle).max() > _FLAT_LAND * np.ptp(radius):
        return tooth
    rounded = tooth.copy()
    rounded[land] *= (middle / radius[land])[:, None]
    return rounded


def _thinned(points: Array) -> Array:
    step = np.hypot(*np.diff(points, axis=0).T)
    return points[np.concatenate([[True], step > 1e-12])]


_ROOT_POINTS = 120
_SHARP = 1e-3
"""Of the tooth height: an involute that ends closer to the tip circle has a sharp corner. [-]"""

_TOUCH = 1e-6


def fitted_profile(
    right: Array, left: Array, flank: InvoluteFlank, tooth_count: int, points_per_tooth: int
) -> GearProfile:
    """Replace the flanks of an outline by the involute that fits them.

    The pitch. Root fillet and tip rounding are those of the outline, turned about the centre by no
    more than the outline leaves the involute at its ends.

    Parameters
    ----------
    right, left : ndarray, shape (n, 2)
        Sides of a tooth whose involute is centred on the x axis: right from the root middle to
        the tip corner, left from the tip corner to the root middle. [m]
    flank : InvoluteFlank
        The involute and its ends.
    points_per_tooth : int
        Number of intervals of the pitch, even.
    """
    tip_radius = float(max(np.hypot(*right[-1]), np.hypot(*left[0])))
    root_radius = 0.5 * float(np.hypot(*right[0]) + np.hypot(*left[-1]))
    halves = []
    for outwards in (right * (1.0, -1.0), left[::-1]):
        segments = _half_tooth(outwards, flank, tooth_count, tip_radius, root_radius)
        halves.append(sample_segments(segments, points_per_tooth // 2))
    (below, below_breaks), (above, above_breaks) = halves
    middle = points_per_tooth // 2
    points = np.vstack([below[:0:-1] * (1.0, -1.0), above])
    radius = np.hypot(points[:, 0], points[:, 1])
    return GearProfile(
        tooth_count=tooth_count,
        points=points,
        tip_start=middle - below_breaks[0],
        tip_end=middle + above_breaks[0],
        tip_radius=tip_radius,
        root_radius=float(radius.min()),
        involute=flank,
        breaks=tuple(middle - index for index in reversed(below_breaks))
        + tuple(middle + index for index in above_breaks),
    )


def _half_tooth(
    outwards: Array, flank: InvoluteFlank, tooth_count: int, tip_radius: float, root_radius: float
) -> list[CurveSegment]:
    # from the tooth axis: land, rounding, involute, root
    radius, angle = np.hypot(*outwards.T), np.arctan2(outwards[:, 1], outwards[:, 0])
    sharp = tip_radius - flank.tip_form_radius < _SHARP * (tip_radius - root_radius)
    end = tip_radius if sharp else flank.tip_form_radius
    corner = float(flank.half_angle(tip_radius))
    rounding = []
    if not sharp:
        # from the tip corner inwards to the end of the involute
        tip_end = flank.tip_form_radius
        last = int(np.flatnonzero(radius <= tip_end)[-1]) + 1
        half = float(flank.half_angle(tip_end))
        shift = half - float(
            np.interp(tip_end, radius[last - 1 : last + 1], angle[last - 1 : last + 1])
        )
        outer = polar(radius[last:], angle[last:] + shift)
        path = np.vstack([outer[::-1], polar(np.array([tip_end]), np.array([half]))])
        path[0] *= tip_radius / np.hypot(*path[0])
        corner = float(np.arctan2(path[0, 1], path[0, 0]))
        rounding = [CurveSegment(_along(path), (0.7, 1.0))]
    level = 0.0 if sharp else 1.0
    # from the begin of the involute inwards to the middle of the tooth space
    begin = flank.form_radius
    # an involute may begin on the root circle itself
    first = max(int(np.argmax(radius > begin + _TOUCH * begin)), 1)
    root_half = float(flank.half_angle(begin))
    near = slice(first - 1, first + 1)
    root_shift = root_half - float(np.interp(begin, radius[near], angle[near]))
    share = (radius[:first] - radius[0]) / max(begin - radius[0], _TOUCH * begin)
    inner = polar(radius[:first], angle[:first] + np.maximum(share, 0.0) * root_shift)
    inner[0] = polar(np.array([root_radius]), np.array([np.pi / tooth_count]))[0]
    inwards = np.vstack([polar(np.array([begin]), np.array([root_half])), inner[::-1]])
    if len(inwards) > _ROOT_POINTS:
        inwards = even_points(inwards, _ROOT_POINTS)
    return [
        CurveSegment(lambda u: polar(tip_radius, corner * u), (0.0, 0.7 * level)),
        *rounding,
        CurveSegment(flank.curve(end), (level, 1.0)),
        CurveSegment(_along(inwards), (1.0, 0.0)),
    ]  # fmt: skip


def _along(path: Array) -> Callable[[Array], Array]:
    step = np.hypot(*np.diff(path, axis=0).T)
    kept = path[np.concatenate([[True], step > 1e-9])]
    kept[-1] = path[-1]
    along = arc_lengths(kept)
    if len(kept) < 4:
        return lambda u: np.column_stack(
            [np.interp(u * along[-1], along, kept[:, axis]) for axis in (0, 1)]
        )
    spline = scipy.interpolate.CubicSpline(along, kept)
    return lambda u: np.asarray(spline(u * along[-1]))
