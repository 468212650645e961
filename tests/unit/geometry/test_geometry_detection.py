from dataclasses import replace

import numpy as np
import pytest

from tests.reference_formulas.involute_deviation import deviations
from toothspace.core.errors import GeometryError
from toothspace.geometry.curve import arc_lengths
from toothspace.geometry.involute import InvoluteGear, generate_profile, tooth_form
from toothspace.geometry.involute_fit import fit_involute, folded_points
from toothspace.geometry.profile_detection import gear_profile_from_curve, gear_profile_from_tooth

MOTOR = InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.3, tip_diameter=40.372e-3)
ROTATION, CENTER = 0.123, (1e-3, -30e-3)


def fit(profile):
    points = folded_points(profile.closed_polygon(), profile.tooth_count, 0.0)
    return fit_involute(points, profile.root_radius, profile.tip_radius)


def measured(noise, gear=MOTOR, points_per_tooth=400):
    """Outline as a coordinate measuring machine gives it: even steps, noise."""
    outline = generate_profile(gear).closed_polygon(ROTATION, CENTER)
    closed = np.vstack([outline, outline[:1]])
    along = arc_lengths(closed)
    steps = np.linspace(0.0, along[-1], gear.tooth_count * points_per_tooth + 1)[:-1]
    points = np.column_stack([np.interp(steps, along, closed[:, axis]) for axis in (0, 1)])
    return points + noise * np.random.default_rng(7).standard_normal(points.shape)


@pytest.mark.parametrize("direction", [1, -1])
def test_exact_outline(direction):
    outline = generate_profile(MOTOR).closed_polygon(ROTATION, CENTER)
    found = gear_profile_from_curve(np.roll(outline, 333, axis=0)[::direction])
    assert found.tooth_count == 12
    assert found.center == pytest.approx(CENTER, abs=1e-9)
    assert found.phase == pytest.approx(ROTATION, abs=1e-7)
    assert found.tooth_deviation.max() < 1e-9
    profile = found.profile
    assert profile.base_radius == pytest.approx(MOTOR.base_radius, abs=1e-6)
    assert profile.tip_radius == pytest.approx(MOTOR.tip_radius, abs=1e-8)
    corner = np.arctan2(*profile.points[profile.tip_end][::-1])
    assert corner == pytest.approx(tooth_form(MOTOR).tip_half_angle, abs=1e-6)
    assert np.abs(deviations(profile, MOTOR)).max() < 1e-7


def test_measured_outline_with_a_micrometre_of_noise():
    found = gear_profile_from_curve(measured(1e-6))
    assert found.tooth_count == 12
    assert found.center == pytest.approx(CENTER, abs=3e-7)
    assert found.phase == pytest.approx(ROTATION, abs=2e-5)
    assert 1e-6 < found.tooth_deviation.max() < 1e-5
    assert found.profile.tip_radius == pytest.approx(MOTOR.tip_radius, abs=1e-6)
    assert found.profile.base_radius == pytest.approx(MOTOR.base_radius, abs=2e-6)
    assert found.profile.area == pytest.approx(generate_profile(MOTOR).area, rel=2e-4)


def test_damaged_tooth_is_named_and_does_not_move_the_centre():
    outline = measured(0.0)
    local = outline - CENTER
    angle = (np.arctan2(local[:, 1], local[:, 0]) - ROTATION) % (2.0 * np.pi)
    radius = np.hypot(*local.T)
    damaged = (np.abs(angle - 3 * np.pi / 6) < np.pi / 12) & (radius > 19.9e-3)
    local[damaged] *= (19.9e-3 / radius[damaged])[:, None]
    found = gear_profile_from_curve(local + CENTER)
    assert int(np.argmax(found.tooth_deviation)) == 3
    assert found.tooth_deviation[3] == pytest.approx(0.286e-3, rel=0.05)
    assert np.delete(found.tooth_deviation, 3).max() < 2e-5
    assert found.center == pytest.approx(CENTER, abs=5e-7)
    assert found.profile.tip_radius == pytest.approx(MOTOR.tip_radius, abs=1e-6)


def test_deviation_of_a_thick_tooth_is_its_excess():
    thick = InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.31, tip_diameter=40.372e-3)
    found = deviations(generate_profile(thick), MOTOR)
    # profile shift moves both flanks outwards along their normal by x m sin(alpha)
    excess = 0.01 * 2.75e-3 * np.sin(np.deg2rad(20.0))
    assert found == pytest.approx(excess, rel=1e-6)
    assert np.ptp(found) < 1e-9


def test_pressure_angle_error_tilts_the_deviation():
    steep = InvoluteGear(12, 2.75e-3, np.deg2rad(20.1), 0.3, tip_diameter=40.372e-3)
    profile = generate_profile(steep)
    assert np.ptp(deviations(profile, MOTOR)) > 3e-6
    found = fit(profile)
    assert found is not None
    assert np.rad2deg(found.flank.pressure_angle(16.5e-3)) == pytest.approx(20.1, abs=1e-3)


def test_deviation_from_the_best_involute_shows_a_bump_not_a_wrong_angle():
    steep = generate_profile(replace(MOTOR, pressure_angle=np.deg2rad(20.1)), 400)
    ideal = fit(steep)
    assert ideal is not None
    assert max(ideal.right.total, ideal.left.total) < 1e-7
    radius, angle = np.hypot(*steep.points.T), np.arctan2(*steep.points.T[::-1])
    share = (radius - steep.root_radius) / (steep.tip_radius - steep.root_radius)
    bump = 5e-6 * np.exp(-(((share - 0.68) / 0.06) ** 2)) / steep.base_radius
    moved = angle + np.sign(angle) * bump
    points = np.column_stack([radius * np.cos(moved), radius * np.sin(moved)])
    worn = replace(steep, points=points)
    found = fit(worn)
    assert found is not None
    # the fit leaves the bump aside
    assert max(found.right.total, found.left.total) == pytest.approx(5e-6, rel=0.01)


def test_single_pitch():
    profile = generate_profile(MOTOR)
    turned = profile.closed_polygon(1.0)[:201]
    for points in (turned, turned[::-1]):
        found = gear_profile_from_tooth(points, 12).profile
        assert found.area == pytest.approx(profile.area, rel=1e-4)
        assert found.points[0] == pytest.approx(profile.points[0], abs=1e-7)
    with pytest.raises(GeometryError, match="found an open curve over 30 deg"):
        gear_profile_from_tooth(turned, 13)


@pytest.mark.parametrize("inner", ["open", "centre", "arc"])
def test_closed_curve_of_one_tooth(inner):
    profile = generate_profile(MOTOR)
    pitch = profile.closed_polygon(2.5)[:201]
    closing = {
        "open": np.zeros((0, 2)),
        "centre": np.zeros((1, 2)),
        "arc": 0.5 * pitch[[-1, 100, 0]] / np.hypot(*pitch[[-1, 100, 0]].T)[:, None] * 0.02,
    }[inner]
    found = gear_profile_from_curve(np.vstack([pitch, closing])[::-1], tooth_count=12)
    assert found.profile.area == pytest.approx(profile.area, rel=1e-4)
    assert found.profile.tip_radius == pytest.approx(profile.tip_radius, abs=1e-8)
    assert found.phase == pytest.approx(2.5 % profile.pitch_angle, abs=1e-6)
    with pytest.raises(GeometryError, match="profile: found"):
        gear_profile_from_curve(np.vstack([pitch, closing]), tooth_count=15)


def test_flank_that_is_no_involute_has_no_base_circle():
    angle = 2.0 * np.pi * np.arange(4000) / 4000
    radius = 20e-3 + 2e-3 * np.tanh(6.0 * np.cos(9 * angle)) / np.tanh(6.0)
    outline = np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])
    found = gear_profile_from_curve(outline)
    assert found.tooth_count == 9
    assert found.profile.base_radius is None


def circle(count=600):
    angle = 2.0 * np.pi * np.arange(count) / count
    return 1e-2 * np.column_stack([np.cos(angle), np.sin(angle)])


def unequal_teeth():
    angle = 2.0 * np.pi * np.arange(6000) / 6000
    radius = 20e-3 + 2e-3 * np.cos(12 * angle) * (1.0 + 0.8 * np.cos(angle))
    return np.column_stack([radius * np.cos(angle), radius * np.sin(angle)])


@pytest.mark.parametrize(
    ("points", "message"),
    [
        (circle(), "no repeating teeth"),
        (unequal_teeth(), "tip radii differ"),
        (np.array([[0.0, 0.0], [1.0, 1.0], [1.0, 0.0], [0.0, 1.0]]), "crosses itself"),
        (np.zeros((0, 2)), "empty"),
        (np.array([[0.0, 0.0], [1.0, 0.0], [1.0, 1.0], [0.0, 1.0]]), "profile: found"),
    ],
    ids=["circle", "unequal", "crossing", "empty", "square"],
)
def test_outlines_that_are_no_gear(points, message):
    with pytest.raises(GeometryError, match=message) as caught:
        gear_profile_from_curve(points)
    assert "allowed" in str(caught.value)
