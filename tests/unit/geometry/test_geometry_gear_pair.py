import numpy as np
import pytest

from tests.reference_formulas.involute_contact import contact_points, curvature_radii
from toothspace.advice.gear_rules import pair_checks
from toothspace.core.errors import GeometryError
from toothspace.geometry.gear_pair import (
    GearPair,
    flank_clearance,
    pair_from_backlash,
    pair_from_center_distance,
    trapped_volume_change,
)
from toothspace.geometry.involute import InvoluteGear, generate_profile

MOTOR = InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.3, tip_diameter=40.372e-3)
WHEEL = InvoluteGear(17, 2.75e-3, np.deg2rad(20.0), 0.1)


@pytest.fixture(params=["equal", "unequal"])
def pair(request):
    return pair_from_backlash(MOTOR, MOTOR if request.param == "equal" else WHEEL, 2e-5)


def test_unshifted_gears_without_backlash_keep_the_reference_distance():
    gear = InvoluteGear(20, 3e-3)
    pair = pair_from_backlash(gear, gear, 0.0)
    assert pair.center_distance == pytest.approx(60e-3, rel=1e-12)
    assert pair.operating_pressure_angle == pytest.approx(np.deg2rad(20.0))
    assert pair.pitch_radii == pytest.approx((30e-3, 30e-3))


def test_radii_of_contact_points_follow_from_roll_lengths(pair):
    position = np.linspace(*pair.path_of_contact, 9)
    for mode in ("pump", "motor"):
        points = contact_points(pair, position, mode)
        rolls = curvature_radii(pair, position, mode)
        first = np.hypot(points[:, 0], points[:, 1])
        second = np.hypot(points[:, 0], points[:, 1] - pair.center_distance)
        assert first == pytest.approx(np.hypot(pair.drive.base_radius, rolls[0]))
        assert second == pytest.approx(np.hypot(pair.driven.base_radius, rolls[1]))
        # contacts move from the outlet side to the inlet side
        assert np.all(np.diff(points[:, 0]) < 0.0)


def test_path_of_contact_ends_on_the_tip_circles(pair):
    start, end = contact_points(pair, np.array(pair.path_of_contact))
    assert np.hypot(start[0], start[1] - pair.center_distance) == pytest.approx(
        pair.driven.tip_radius
    )
    assert np.hypot(*end) == pytest.approx(pair.drive.tip_radius)


def test_ideal_flow_is_the_area_swept_between_tip_and_contact(pair):
    position = np.array([-1e-3, 0.0, 2e-3])
    points = contact_points(pair, position)
    first = pair.drive.tip_radius**2 - np.sum(points**2, axis=1)
    second = pair.driven.tip_radius**2 - np.sum((points - (0.0, pair.center_distance)) ** 2, axis=1)
    expected = 0.5 * 8e-3 * (first - pair.speed_ratio * second)
    assert pair.flow_per_radian(8e-3, position) == pytest.approx(expected, rel=1e-12)


def test_play_between_profiles_is_half_the_backlash_and_shrinks_with_the_distance(pair):
    first, second = generate_profile(pair.drive), generate_profile(pair.driven)
    play = flank_clearance(first, second, pair.center_distance)
    assert 0.9e-5 < play < 1.3e-5
    assert flank_clearance(first, second, pair.center_distance - 1e-4) < 0.0


def test_tip_rounding_shortens_the_path_of_contact():
    rounded = InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.3, 40.372e-3, tip_rounding=1e-4)
    pair = pair_from_backlash(rounded, rounded, 2e-5)
    sharp = pair_from_backlash(MOTOR, MOTOR, 2e-5)
    assert pair.contact_ratio < sharp.contact_ratio


def test_no_trapped_volume_below_contact_ratio_one():
    short = InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.3, tip_diameter=38.5e-3)
    pair = pair_from_backlash(short, short, 2e-5)
    assert pair.contact_ratio < 1.0
    assert trapped_volume_change(pair, 1e-2) == 0.0


@pytest.mark.parametrize(
    ("build", "message"),
    [
        (lambda: pair_from_center_distance(MOTOR, MOTOR, 34.0e-3), "center_distance: found 34 mm"),
        (lambda: pair_from_center_distance(MOTOR, MOTOR, 45.0e-3), "tips no longer meet"),
        (lambda: pair_from_center_distance(MOTOR, MOTOR, float("nan")), "center_distance: found"),
        (lambda: pair_from_backlash(MOTOR, MOTOR, -1e-5), "normal_backlash: found -0.01 mm"),
        (lambda: pair_from_backlash(MOTOR, MOTOR, 2e-3), "normal_backlash: found 2 mm"),
        (lambda: pair_from_backlash(MOTOR, InvoluteGear(12, 3e-3), 1e-5), "base pitch"),
        (
            lambda: pair_from_backlash(
                InvoluteGear(8, 3e-3, tip_diameter=31.5e-3), InvoluteGear(60, 3e-3, 0.35, -0.9), 0.0
            ),
            "base pitch",
        ),
        (
            lambda: pair_from_backlash(
                InvoluteGear(18, 3e-3, profile_shift=0.2, dedendum=1.0),
                InvoluteGear(18, 3e-3, profile_shift=0.2, tip_diameter=63.0e-3),
                1e-5,
            ),
            "into the drive gear's root",
        ),
        (
            lambda: pair_from_backlash(
                InvoluteGear(18, 3e-3, tool_tip_radius=0.3, dedendum=1.45),
                InvoluteGear(100, 3e-3, tip_diameter=308.5e-3),
                1e-5,
            ),
            "tip_diameter: .*teeth interfere",
        ),
    ],
)
def test_impossible_pairs_are_refused(build, message):
    with pytest.raises(GeometryError, match=message) as caught:
        build()
    assert "allowed" in str(caught.value)
    assert "\n" not in str(caught.value)


def test_reference_motor_passes_every_design_rule():
    findings = pair_checks(pair_from_backlash(MOTOR, MOTOR, 1.1e-4), 7.63e-3)
    assert [finding.name for finding in findings if not finding.passed] == []
    assert all(finding.reason.endswith(".") and len(finding.reason) > 40 for finding in findings)
    values = {finding.name: finding.value for finding in findings}
    assert values["contact ratio"] == pytest.approx(1.303, abs=1e-3)
    assert values["tip land, drive gear"] == pytest.approx(1.02, abs=5e-3)
    assert values["root clearance, driven gear"] == pytest.approx(0.494, abs=1e-3)


@pytest.mark.parametrize(
    ("drive", "driven", "backlash", "rule"),
    [
        (InvoluteGear(10, 3e-3), InvoluteGear(30, 3e-3), 2e-5, "undercut, drive gear"),
        (
            InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.3, tip_diameter=38.5e-3),
            InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.3, tip_diameter=38.5e-3),
            2e-5,
            "contact ratio",
        ),
        (MOTOR, MOTOR, 0.0, "normal backlash"),
        (MOTOR, MOTOR, 2e-5, "normal backlash"),
        (MOTOR, InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.75), 2e-5, "tip land, driven gear"),
        (
            MOTOR,
            InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.3, tip_diameter=40.9e-3),
            2e-5,
            "root clearance, drive gear",
        ),
    ],
)
def test_design_rule_fails_where_it_should(drive, driven, backlash, rule):
    findings = pair_checks(pair_from_backlash(drive, driven, backlash), 7.5e-3)
    failed = [finding.name for finding in findings if not finding.passed]
    assert rule in failed


def test_contact_below_the_involute_is_reported_as_interference():
    drive = InvoluteGear(20, 3e-3, tool_tip_radius=0.2)
    driven = InvoluteGear(100, 3e-3, tip_diameter=308e-3)
    pair = GearPair(drive, driven, 180.2e-3)
    failed = [f.name for f in pair_checks(pair, 1e-2) if not f.passed]
    assert "fillet interference, drive gear" in failed
    assert "fillet interference, driven gear" not in failed


def test_undercut_ends_the_path_of_contact_early():
    pinion, wheel = InvoluteGear(9, 3e-3), InvoluteGear(30, 3e-3, profile_shift=0.1)
    pair = pair_from_backlash(pinion, wheel, 2e-5)
    start = contact_points(pair, pair.path_of_contact[0])[0]
    assert np.hypot(*start) == pytest.approx(pair.forms[0].form_radius, rel=1e-9)
    rolls = [np.sqrt(gear.tip_radius**2 - gear.base_radius**2) for gear in (pinion, wheel)]
    to_both_tips = (sum(rolls) - sum(pair.pitch_roll_lengths)) / pair.base_pitch
    assert pair.contact_ratio < to_both_tips
    swapped = pair_from_backlash(wheel, pinion, 2e-5)
    assert swapped.contact_ratio == pytest.approx(pair.contact_ratio)


def test_play_does_not_depend_on_the_order_of_the_gears():
    first, second = generate_profile(MOTOR, 80), generate_profile(WHEEL, 400)
    distance = pair_from_backlash(MOTOR, WHEEL, 2e-5).center_distance
    assert flank_clearance(first, second, distance) == flank_clearance(second, first, distance)
