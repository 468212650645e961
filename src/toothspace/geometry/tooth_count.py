"""How many equal teeth a closed outline repeats."""

from __future__ import annotations

import numpy as np

from toothspace.core.types import Array
from toothspace.geometry.curve import counter_clockwise, signed_area
from toothspace.geometry.involute_gear import MAX_TOOTH_COUNT, MIN_TOOTH_COUNT

_SECTORS = 8192
SMALLEST_MODULATION = 5e-3
"""Share of the outline's area that must vary with the tooth angle. [-]"""
_LARGEST_OTHER = 0.7
"""Of the term of the teeth: terms that do not repeat with them, as of a box. [-]"""
_LEAST_AREA = 1e-14


def repeating_teeth(outline: Array, fewest: int = MIN_TOOTH_COUNT) -> int | None:
    r"""Number of equal teeth round the centroid of an outline.

    Tooth count up to 400; None for an outline without repeating teeth.

    Parameters
    ----------
    outline : ndarray, shape (n, 2)
        Closed curve. [m]
    fewest : int
        Fewest teeth that count, at least 2.

    Notes
    -----
    The strongest term of the area spectrum
    :math:`c_k = \frac12 \oint r^2 e^{-ik\vartheta} d\vartheta`, which also holds for undercut teeth
    whose radius is not a function of the angle; terms that are no multiple of it must be weaker.
    Edges are divided finely, so that the distance of the points does not count.
    """
    if len(outline) < 3 or abs(signed_area(outline)) < _LEAST_AREA:
        return None
    points = counter_clockwise(outline)
    points = points - centroid(points)
    # magnitudes of the terms of the area over the angle about the origin [m2]
    angle, area = area_elements(points)
    place = angle / (2.0 * np.pi) * _SECTORS
    sector = np.floor(place).astype(int)
    # shared by two sectors, or even pieces of a circle would beat with the sectors like teeth
    share = place - sector
    total = np.bincount(sector % _SECTORS, (1.0 - share) * area, _SECTORS)
    total += np.bincount((sector + 1) % _SECTORS, share * area, _SECTORS)
    spectrum = np.asarray(np.abs(np.fft.rfft(total)))
    count = fewest + int(np.argmax(spectrum[fewest : MAX_TOOTH_COUNT + 1]))
    weak = spectrum[count] < SMALLEST_MODULATION * abs(signed_area(points))
    orders = np.arange(2, MAX_TOOTH_COUNT + 1)
    others = spectrum[orders[orders % count != 0]].max()
    return None if weak or others > _LARGEST_OTHER * spectrum[count] else count


def centroid(points: Array) -> Array:
    """Centre of area of a closed curve of shape (n, 2) [m]."""
    start = points.mean(axis=0)
    local = points - start
    following = np.roll(local, -1, axis=0)
    cross = local[:, 0] * following[:, 1] - following[:, 0] * local[:, 1]
    middle = (local + following) * cross[:, None]
    return np.asarray(start + middle.sum(axis=0) / (3.0 * cross.sum()))


def area_phase(points: Array, tooth_count: int) -> float:
    """Polar angle of the first tooth axis by the area spectrum, 0 to one pitch [rad]."""
    angle, area = area_elements(points)
    term = np.sum(area * np.exp(-1j * tooth_count * angle))
    return float(-np.angle(term) / tooth_count) % (2.0 * np.pi / tooth_count)


def area_elements(points: Array) -> tuple[Array, Array]:
    """Middle angles [rad] and areas [m2] of the sectors under finely divided edges."""
    # edges are divided, so that no sector is wider than the finest one asked for
    step = np.roll(points, -1, axis=0) - points
    length = np.hypot(step[:, 0], step[:, 1])
    counts = np.maximum(np.ceil(length / length.sum() * 4 * _SECTORS).astype(int), 1)
    start = np.repeat(np.arange(len(points)), counts)
    share = (np.arange(len(start)) - np.repeat(np.cumsum(counts) - counts, counts)) / counts[start]
    fine = np.asarray(points[start] + share[:, None] * step[start])
    following = np.roll(fine, -1, axis=0)
    area = 0.5 * (fine[:, 0] * following[:, 1] - fine[:, 1] * following[:, 0])
    middle = fine + following
    return np.arctan2(middle[:, 1], middle[:, 0]), area
