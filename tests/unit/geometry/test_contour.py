"""Outlines as splines: nearest points and least distances against closed forms and brute force."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.core.types import Array
from toothspace.geometry.contour import (
    Contour,
    Turning,
    beside_of,
    contour,
    nearest_places,
    on_contour,
    seen_from,
)
from toothspace.geometry.curve import polar

RADIUS = 10e-3


def _circle() -> Contour:
    return contour(polar(RADIUS, np.linspace(0.0, 2.0 * np.pi, 721)[:-1]))


def _wavy(waves: int = 6, radius: float = RADIUS) -> Contour:
    angle = np.linspace(0.0, 2.0 * np.pi, 2401)[:-1]
    return contour(polar(radius + 1.5e-3 * np.cos(waves * angle), angle))


def test_points_and_derivatives_are_those_of_the_spline() -> None:
    """Also beyond both ends, from any sample that the search begins at."""
    outline = _wavy()
    for place in outline.length * np.array([-0.3, -1e-9, 0.0, 0.2, 0.77, 1.0, 1.4]):
        wrapped = place % outline.length
        expected = np.concatenate([outline.spline(wrapped, order) for order in range(3)])
        for sample in (0, 4000, 11_999):
            found = np.array(on_contour(outline.data, place, sample))
            assert found == pytest.approx(expected, rel=1e-14, abs=1e-17)


def test_nearest_points_of_a_circle() -> None:
    """Along the radius, negative inside."""
    angle = np.random.default_rng(1).uniform(0.0, 2.0 * np.pi, 300)
    radius = RADIUS + np.linspace(-3e-3, 3e-3, 300)
    outline = _circle()
    place, gap = outline.nearest(polar(radius, angle))
    assert gap == pytest.approx(radius - RADIUS, abs=1e-11)
    assert place == pytest.approx(outline.length * angle / (2.0 * np.pi), abs=1e-10)


def test_neighbours_lead_to_the_same_nearest_points() -> None:
    """From the sample of a point beside it, to the digits of a search of all samples."""
    outline = _wavy()
    way = 60e-6
    points = outline.point(np.arange(0.0, outline.length, way)) * 1.02
    samples = outline.near_samples(points[::2])
    near = np.repeat(samples, 2)[: len(points)]
    found = outline.nearest_from(points, near, beside_of(outline, 1.1 * way))
    expected = outline.nearest(points)
    assert np.abs(np.subtract(found, expected)).max() < 1e-15


def test_points_far_from_every_sample_have_no_distance() -> None:
    outline = _circle()
    points = polar(RADIUS * np.array([1.01, 1.4]), np.zeros(2))
    samples = outline.near_samples(points, 0.1 * RADIUS)
    _, gap = outline.nearest_from(points, samples, 2)
    assert gap[0] == pytest.approx(0.01 * RADIUS, abs=1e-10)
    assert np.isinf(gap[1])


@pytest.mark.parametrize("angle", [0.0, 0.4, 2.9])
def test_least_distance_against_many_points(angle: float) -> None:
    """Nowhere within a step is the other outline nearer, and both tangents are parallel there."""
    own, other = _wavy(7, 12e-3), _wavy()
    turning, step = Turning(0.0, -1.5e-3, 7.0 / 6.0), 0.4e-3
    around = np.linspace(-step, step, 4001)

    def gaps(places: Array) -> Array:
        return other.nearest(seen_from(turning, np.full(places.shape, angle), own.point(places)))[1]

    starts = np.arange(0.0, own.length, 0.5 * step)
    reach = gaps(starts)
    least = (reach < np.roll(reach, 1)) & (reach < np.roll(reach, -1)) & (np.abs(reach) < 1e-3)
    starts = starts[least]
    assert starts.size > 2
    found = nearest_places(own, other, turning, np.full(starts.shape, angle), starts, step)
    for start, place, gap in zip(starts, found, gaps(found), strict=True):
        every = gaps(start + around)
        assert gap <= every.min() + 1e-12
        assert place == pytest.approx(start + around[np.argmin(every)], abs=3e-7)
