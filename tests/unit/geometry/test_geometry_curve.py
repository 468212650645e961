import numpy as np
import pytest

from toothspace.core.errors import GeometryError
from toothspace.geometry.cad_import import load_polygons
from toothspace.geometry.curve import (
    CurveSegment,
    arc_lengths,
    checked_polygon,
    counter_clockwise,
    enclosed,
    first_self_crossing,
    resample_by_curvature,
    sample_segments,
    signed_area,
    without_repeats,
)

SQUARE = np.array([[0.0, 0.0], [2.0, 0.0], [2.0, 2.0], [0.0, 2.0]])
BOW_TIE = np.array([[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]])


def circle(radius, count):
    angle = 2.0 * np.pi * np.arange(count) / count
    return radius * np.column_stack([np.cos(angle), np.sin(angle)])


def test_signed_area_of_both_directions():
    assert signed_area(SQUARE) == 4.0
    assert signed_area(SQUARE[::-1] + 100.0) == pytest.approx(-4.0)
    assert signed_area(counter_clockwise(SQUARE[::-1])) == 4.0
    assert counter_clockwise(SQUARE[::-1])[0] == pytest.approx(SQUARE[-1])


def test_repeated_points_are_dropped():
    doubled = np.repeat(np.vstack([SQUARE, SQUARE[:1]]), 2, axis=0)
    assert signed_area(without_repeats(doubled)) == 4.0
    assert len(without_repeats(doubled)) == 4


def test_self_crossing_is_located():
    assert first_self_crossing(SQUARE) is None
    assert first_self_crossing(BOW_TIE) == pytest.approx((0.5, 0.5))


def test_segments_are_sampled_on_the_curve_and_crowd_at_the_junction():
    def line(u):
        return np.column_stack([u, np.zeros_like(u)])

    def arc(u):
        return np.column_stack([1.0 + np.sin(u), 1.0 - np.cos(u)])

    points, breaks = sample_segments(
        [CurveSegment(line, (0.0, 1.0)), CurveSegment(arc, (1.0, 0.0))], 60
    )
    assert len(points) == 61
    junction = breaks[0]
    assert points[junction] == pytest.approx((1.0, 0.0))
    assert np.hypot(*(points[junction + 1 :] - (1.0, 1.0)).T) == pytest.approx(1.0)
    step = np.hypot(*np.diff(points, axis=0).T)
    assert step[junction] < 0.01 * step.max()
    assert step[junction - 1] < 0.01 * step.max()


def test_resampling_follows_the_curvature():
    half = np.linspace(0.0, np.pi, 200)
    ellipse = np.column_stack([10.0 * np.cos(half), np.sin(half)])
    points = resample_by_curvature(ellipse, 100)
    assert (points[:, 0] / 10.0) ** 2 + points[:, 1] ** 2 == pytest.approx(1.0, abs=1e-4)
    step = np.diff(arc_lengths(points))
    assert step[0] < 0.2 * step[50]


@pytest.mark.parametrize(
    ("points", "found"),
    [
        (np.zeros((0, 2)), "empty"),
        (SQUARE[:2], "2 distinct points"),
        (np.vstack([SQUARE[:2], SQUARE[:2]]), "crosses itself|distinct"),
        (BOW_TIE, "crosses itself at x = 500 mm, y = 500 mm"),
        (np.vstack([SQUARE, [[np.nan, 0.0]]]), "not finite"),
    ],
)
def test_wrong_polygons_are_refused(points, found):
    with pytest.raises(GeometryError, match=found) as caught:
        checked_polygon(points, "machine.casing.contour")
    assert str(caught.value).startswith("machine.casing.contour: found")
    assert "allowed" in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("place", range(7))
def test_an_outline_that_crosses_itself_keeps_its_area(place):
    # a loop of the other sense at the highest point
    crossed = np.array([[0, 0], [2, 0], [2, 2], [0.9, 2.1], [1, 2.2], [1.1, 2.1], [0, 2]])
    (shape,) = enclosed([np.roll(crossed, place, axis=0)])
    assert shape.is_valid
    assert shape.area == pytest.approx(4.0, rel=0.04)


def test_polygon_file(tmp_path):
    path = tmp_path / "groove.txt"
    path.write_text("0 0\n0 2\n2 2\n2 0\n\n10 10\n11 10\n11 11\n")
    first, second = load_polygons(path, 1e-3)
    assert signed_area(first) == pytest.approx(4e-6)
    assert signed_area(second) == pytest.approx(0.5e-6)
