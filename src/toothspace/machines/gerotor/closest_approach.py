"""Throats between rotors without an analytic definition: points of closest approach."""

from __future__ import annotations

import numpy as np

from toothspace.core.types import Array
from toothspace.geometry.curve import turned
from toothspace.machines.gerotor.contact_search import (
    PlacedRotors,
    distance_to_inner,
    nearest_place,
    placed_rotors,
)
from toothspace.machines.gerotor.profiles import Rotors

_LOBE_SAMPLES = 240
_MISS_WEIGHT = 0.02


def closest_approach(rotors: Rotors, place: Array) -> tuple[Array, Array, Array, Array, Array]:
    """Find where a lobe comes closest to the inner rotor.

    Parameters
    ----------
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
    placed = placed_rotors(rotors)
    lobe, step = _lobe_samples(placed)
    turn = place - 0.5 * placed.pitch
    angle, along = np.broadcast_arrays(turn[:, None], lobe)
    gap, _, normal, point = _throats(placed, angle, along)
    to_pitch = point - rotors.pitch_point
    miss = normal[..., 0] * to_pitch[..., 1] - normal[..., 1] * to_pitch[..., 0]
    best = np.argmin(gap + _MISS_WEIGHT * miss**2 / rotors.eccentricity, axis=1)
    outer = nearest_place(placed, turn, lobe[best], step)
    gap, inner, normal, point = _throats(placed, turn, outer)
    return (
        point - 0.5 * gap[:, None] * normal,
        normal,
        gap,
        placed.inner.curvature(inner),
        -placed.outer.curvature(outer),
    )


def _throats(placed: PlacedRotors, angle: Array, along: Array) -> tuple[Array, Array, Array, Array]:
    """Gap [m], arc length on the inner outline [m], normal and point on the outer outline."""
    inner, gap = distance_to_inner(placed, angle, along)
    tangent = turned(placed.inner.tangent(inner), placed.turns * angle)
    normal = np.stack([tangent[..., 1], -tangent[..., 0]], axis=-1)
    return gap, inner, normal, turned(placed.outer.point(along), angle)


def _lobe_samples(placed: PlacedRotors) -> tuple[Array, float]:
    """Arc lengths over the lobe that follows the cavity on the negative y axis, and their step.

    The cavity floor beside the lobe is concave: no throat between pockets lies there.
    """
    outer = placed.outer
    step = outer.length / (placed.outer_count * _LOBE_SAMPLES)
    points = np.asarray(outer.tree.data)
    cavity = float(outer.nearest(points[[np.argmin(points[:, 1])]])[0])
    along = cavity + step * (np.arange(_LOBE_SAMPLES) + 0.5)
    concave = np.flatnonzero(outer.curvature(np.asarray(along, dtype=float)) >= 0.0)
    middle = _LOBE_SAMPLES // 2
    first = int(concave[concave < middle].max(initial=-1)) + 1
    last = int(concave[concave > middle].min(initial=_LOBE_SAMPLES))
    return np.asarray(along[first:last]), step
