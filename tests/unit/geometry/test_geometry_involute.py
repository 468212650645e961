import numpy as np
import pytest
from scipy.interpolate import CubicSpline

from toothspace.core.errors import GeometryError
from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.involute import (
    InvoluteGear,
    generate_profile,
    involute_function,
    involute_point,
    tooth_form,
)

MOTOR = {"tooth_count": 12, "module": 2.75e-3, "profile_shift": 0.3}


def test_involute_function():
    # inv 20 deg = 0.014904, any gear handbook
    assert involute_function(np.deg2rad(20.0)) == pytest.approx(0.014904, abs=1e-6)


def test_standard_gear():
    gear = InvoluteGear(20, 2e-3)
    assert gear.reference_radius == pytest.approx(20e-3)
    assert gear.base_radius == pytest.approx(20e-3 * np.cos(np.deg2rad(20.0)))
    assert gear.root_radius == pytest.approx(17.5e-3)
    assert gear.tip_radius == pytest.approx(22e-3)
    assert 2.0 * 20e-3 * gear.half_angle(20e-3) == pytest.approx(np.pi * 1e-3)
    assert gear.base_pitch == pytest.approx(np.pi * 2e-3 * np.cos(np.deg2rad(20.0)))


def test_involute_unwinds_from_the_base_circle():
    gear = InvoluteGear(**MOTOR)
    radius = np.linspace(gear.base_radius * 1.001, gear.tip_radius, 400)
    points = involute_point(gear, radius)
    tangent = np.gradient(points, axis=0)[1:-1]
    normal = np.column_stack([tangent[:, 1], -tangent[:, 0]])
    normal /= np.hypot(normal[:, 0], normal[:, 1])[:, None]
    # distance of the flank normal from the gear centre
    lever = np.abs(points[1:-1, 0] * normal[:, 1] - points[1:-1, 1] * normal[:, 0])
    assert lever[20:] == pytest.approx(gear.base_radius, rel=1e-4)


def test_tip_rounding_is_tangent_to_flank_and_tip_circle():
    gear = InvoluteGear(**MOTOR, tip_diameter=40.372e-3, tip_rounding=0.2e-3)
    profile, form = generate_profile(gear, 400), tooth_form(gear)
    points = profile.left_flank
    radius = np.hypot(*points.T)
    arc = points[(radius > form.tip_form_radius) & (radius <= gear.tip_radius)]
    # heading of the arc at both ends: along the tip circle, and along the involute
    headings = np.unwrap(np.arctan2(*np.diff(arc, axis=0).T[::-1]))
    along_tip = np.arctan2(points[0, 1], points[0, 0]) + 0.5 * np.pi
    assert headings[0] == pytest.approx(along_tip, abs=0.02)
    lower = involute_point(gear, np.array([form.tip_form_radius, form.tip_form_radius - 1e-7]))
    assert headings[-1] == pytest.approx(np.arctan2(*np.diff(lower, axis=0)[0][::-1]), abs=0.02)
    assert profile.points[profile.tip_end] == pytest.approx(points[0])
    sharp = tooth_form(InvoluteGear(**MOTOR, tip_diameter=40.372e-3))
    assert form.tip_half_angle < sharp.tip_half_angle


@pytest.mark.parametrize(
    "gear",
    [
        InvoluteGear(**MOTOR, tip_diameter=40.372e-3),
        InvoluteGear(14, 4.5e-3, np.deg2rad(25.0)),
        InvoluteGear(10, 3e-3),
        InvoluteGear(**MOTOR, tip_diameter=40.372e-3, tip_rounding=0.1e-3),
    ],
    ids=["motor", "fuel pump", "undercut", "rounded"],
)
@pytest.mark.parametrize(("count", "tolerance"), [(200, 4e-9), (320, 1e-9)])
def test_cubic_spline_through_a_flank_is_exact(gear, count, tolerance):
    flank = generate_profile(gear, count).left_flank
    along = np.concatenate([[0.0], np.cumsum(np.hypot(*np.diff(flank, axis=0).T))])
    index = np.linspace(0, len(along) - 1, 10 * len(along))
    between = CubicSpline(along, flank)(np.interp(index, np.arange(len(along)), along))
    form, radius = tooth_form(gear), np.hypot(*between.T)
    on_flank = (radius > form.form_radius) & (radius < form.tip_form_radius)
    angle = np.arctan2(between[on_flank, 1], between[on_flank, 0])
    error = gear.base_radius * (angle - gear.half_angle(radius[on_flank]))
    assert np.abs(error).max() < tolerance


def test_profile_parts_and_polygon():
    profile = generate_profile(InvoluteGear(**MOTOR, tip_rounding=0.1e-3), 200)
    assert profile.points.shape == (201, 2)
    radius = np.hypot(*profile.points.T)
    assert radius[profile.tip_start : profile.tip_end + 1] == pytest.approx(profile.tip_radius)
    assert radius[profile.tip_start - 1] < profile.tip_radius
    assert profile.right_flank[0] == pytest.approx(profile.left_flank[-1] * (1.0, -1.0))
    assert profile.closed_polygon().shape == (12 * 200, 2)
    turned = profile.closed_polygon(0.5 * np.pi, (1.0, 2.0))
    assert turned[:5] - (1.0, 2.0) == pytest.approx(profile.points[:5] @ [[0.0, 1.0], [-1.0, 0.0]])
    assert profile.tooth_space_area == pytest.approx(
        np.pi / 12 * profile.tip_radius**2 - profile.area / 12
    )


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"tooth_count": 0}, "tooth_count: found 0, allowed an integer 5 to 400"),
        ({"tooth_count": 1}, "tooth_count: found 1, allowed"),
        ({"tooth_count": int(1e9)}, "tooth_count: found 1000000000, allowed"),
        ({"tooth_count": float("nan")}, "tooth_count: found nan, allowed"),
        ({"tooth_count": 11.5}, "tooth_count: found 11.5, allowed"),
        ({"module": -1e-3}, "module: found -1 mm, allowed"),
        ({"module": float("nan")}, "module: found nan mm, allowed"),
        ({"module": 0.0}, "module: found 0 mm, allowed"),
        ({"pressure_angle": 20.0}, "pressure_angle: found 1145.92 deg, allowed"),
        ({"pressure_angle": 0.0}, "pressure_angle: found 0 deg, allowed"),
        ({"profile_shift": 3.0}, "profile_shift: found 3 modules, allowed"),
        ({"dedendum": -1.0}, "dedendum: found -1 modules, allowed"),
        ({"dedendum": float("inf")}, "dedendum: found inf modules, allowed"),
        ({"dedendum": 1.9, "pressure_angle": 0.5}, "dedendum: .* rack tooth is pointed"),
        ({"tool_tip_radius": 0.6}, "tool_tip_radius: found 0.6 modules, allowed from 0 to 0.47"),
        ({"tool_tip_radius": -0.1}, "tool_tip_radius: found -0.1 modules, allowed"),
        ({"tip_rounding": -1e-4}, "tip_rounding: found -0.1 mm, allowed"),
        ({"tip_diameter": 0.0}, "tip_diameter: found 0 mm, allowed above 0"),
        ({"tip_diameter": float("nan")}, "tip_diameter: found nan mm, allowed"),
    ],
)
def test_impossible_values_are_refused(changes, message):
    with pytest.raises(GeometryError, match=message) as caught:
        InvoluteGear(**{**MOTOR, **changes})
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("changes", "message"),
    [
        ({"tip_diameter": 44e-3}, "tip_diameter: found 44 mm, allowed below .* pointed"),
        ({"tip_diameter": 30e-3}, "tip_diameter: found 30 mm, allowed above the base diameter"),
        ({"tooth_count": 60, "tip_diameter": 161e-3}, "tip_diameter: .*no involute is left"),
        ({"tip_rounding": 1.3e-3}, "tip_rounding: found 1.3 mm, allowed smaller"),
        ({"tooth_count": 5, "profile_shift": -0.6}, "profile_shift: .*undercut|profile_shift"),
    ],
)
def test_impossible_teeth_are_refused(changes, message):
    with pytest.raises(GeometryError, match=message) as caught:
        tooth_form(InvoluteGear(**{**MOTOR, **changes}))
    assert "allowed" in str(caught.value)
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize("count", [39, 41, 30000])
def test_number_of_points_is_limited(count):
    with pytest.raises(GeometryError, match="points_per_tooth: found"):
        generate_profile(InvoluteGear(**MOTOR), count)


def test_undercut_removes_involute():
    form = tooth_form(InvoluteGear(9, 3e-3))
    assert form.undercut
    assert form.undercut_depth > 0.0
    assert form.form_radius > InvoluteGear(9, 3e-3).base_radius
    assert not tooth_form(InvoluteGear(30, 3e-3)).undercut


@pytest.mark.parametrize(
    ("points", "tips", "message"),
    [
        (np.zeros((20, 3)), (5, 6), "points: found an array of shape"),
        (np.full((20, 2), np.nan), (5, 6), "not finite"),
        (np.zeros((20, 2)), (6, 5), "tip_start, tip_end: found 6, 5"),
    ],
)
def test_malformed_profiles_are_refused(points, tips, message):
    with pytest.raises(GeometryError, match=message):
        GearProfile(12, points, *tips, tip_radius=1.0, root_radius=0.5)
