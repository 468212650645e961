"""One tooth pitch with exact involute flanks, root and tip as in a given outline."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
from scipy.interpolate import CubicSpline

from toothspace.core.types import Array
from toothspace.geometry.curve import CurveSegment, arc_lengths, even_points, polar, sample_segments
from toothspace.geometry.gear_profile import GearProfile, InvoluteFlank

_ROOT_POINTS = 120
_SHARP = 1e-3
"""Of the tooth height: an involute that ends closer to the tip circle has a sharp corner. [-]"""

_TOUCH = 1e-6


def fitted_profile(
    right: Array, left: Array, flank: InvoluteFlank, tooth_count: int, points_per_tooth: int
) -> GearProfile:
    """Replace the flanks of an outline by the involute that fits them.

    Parameters
    ----------
    right, left : ndarray, shape (n, 2)
        Sides of a tooth whose involute is centred on the x axis: right from the root middle to
        the tip corner, left from the tip corner to the root middle. [m]
    flank : InvoluteFlank
        The involute and its ends.
    points_per_tooth : int
        Number of intervals of the pitch, even.

    Returns
    -------
    GearProfile
        The pitch. Root fillet and tip rounding are those of the outline, turned about the centre
        by no more than the outline leaves the involute at its ends.
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
        path = _rounding_path(radius, angle, flank, tip_radius)
        corner = float(np.arctan2(path[0, 1], path[0, 0]))
        rounding = [CurveSegment(_along(path), (0.7, 1.0))]
    level = 0.0 if sharp else 1.0
    return [
        CurveSegment(lambda u: polar(tip_radius, corner * u), (0.0, 0.7 * level)),
        *rounding,
        CurveSegment(flank.curve(end), (level, 1.0)),
        CurveSegment(_along(_root_path(radius, angle, flank, tooth_count, root_radius)),
                     (1.0, 0.0)),
    ]  # fmt: skip


def _rounding_path(radius: Array, angle: Array, flank: InvoluteFlank, tip_radius: float) -> Array:
    # from the tip corner inwards to the end of the involute
    end = flank.tip_form_radius
    last = int(np.flatnonzero(radius <= end)[-1]) + 1
    half = float(flank.half_angle(end))
    shift = half - float(np.interp(end, radius[last - 1 : last + 1], angle[last - 1 : last + 1]))
    outer = polar(radius[last:], angle[last:] + shift)
    path = np.vstack([outer[::-1], polar(np.array([end]), np.array([half]))])
    path[0] *= tip_radius / np.hypot(*path[0])
    return path


def _root_path(
    radius: Array, angle: Array, flank: InvoluteFlank, tooth_count: int, root_radius: float
) -> Array:
    # from the begin of the involute inwards to the middle of the tooth space
    end = flank.form_radius
    # an involute may begin on the root circle itself
    first = max(int(np.argmax(radius > end + _TOUCH * end)), 1)
    half = float(flank.half_angle(end))
    near = slice(first - 1, first + 1)
    shift = half - float(np.interp(end, radius[near], angle[near]))
    share = (radius[:first] - radius[0]) / max(end - radius[0], _TOUCH * end)
    inner = polar(radius[:first], angle[:first] + np.maximum(share, 0.0) * shift)
    inner[0] = polar(np.array([root_radius]), np.array([np.pi / tooth_count]))[0]
    path = np.vstack([polar(np.array([end]), np.array([half])), inner[::-1]])
    return path if len(path) <= _ROOT_POINTS else even_points(path, _ROOT_POINTS)


def _along(path: Array) -> Callable[[Array], Array]:
    step = np.hypot(*np.diff(path, axis=0).T)
    kept = path[np.concatenate([[True], step > 1e-9])]
    kept[-1] = path[-1]
    along = arc_lengths(kept)
    if len(kept) < 4:
        return lambda u: np.column_stack(
            [np.interp(u * along[-1], along, kept[:, axis]) for axis in (0, 1)]
        )
    spline = CubicSpline(along, kept)
    return lambda u: np.asarray(spline(u * along[-1]))
