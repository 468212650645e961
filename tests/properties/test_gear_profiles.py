"""Invariants of generated gears for any valid parameters."""

import numpy as np
import pytest
import shapely
from hypothesis import given, settings
from hypothesis import strategies as st

from toothspace.core.errors import GeometryError
from toothspace.geometry.gear_pair import (
    flank_clearance,
    pair_from_backlash,
    pair_from_center_distance,
)
from toothspace.geometry.involute import InvoluteGear, generate_profile, tooth_form
from toothspace.geometry.profile_detection import gear_profile_from_curve

SETTINGS = settings(max_examples=25)


@st.composite
def gears(draw, module=None, pressure_angle=None):
    count = draw(st.integers(8, 40))
    alpha = draw(st.floats(15.0, 27.0)) if pressure_angle is None else pressure_angle
    shift = draw(st.floats(0.0, 0.5)) + max(0.0, 0.4 - 0.02 * count)
    return InvoluteGear(
        tooth_count=count,
        module=draw(st.floats(0.5e-3, 8e-3)) if module is None else module,
        pressure_angle=np.deg2rad(alpha),
        profile_shift=shift,
        tip_rounding=0.0,
    )


@st.composite
def pairs(draw):
    module, alpha = draw(st.floats(1e-3, 5e-3)), draw(st.floats(18.0, 27.0))
    first, second = draw(gears(module, alpha)), draw(gears(module, alpha))
    return first, second, draw(st.floats(0.0, 0.04)) * module


def valid(build, *arguments):
    try:
        return build(*arguments)
    except GeometryError:
        return None


@SETTINGS
@given(gears())
def test_profile_is_symmetric_closed_and_between_root_and_tip(gear):
    profile = valid(generate_profile, gear, 80)
    if profile is None:
        return
    points = profile.points
    assert np.allclose(points[::-1] * (1.0, -1.0), points, rtol=0.0, atol=1e-15)
    radius = np.hypot(*points.T)
    assert radius.min() == pytest.approx(gear.root_radius, rel=1e-12)
    assert radius.max() == pytest.approx(gear.tip_radius, rel=1e-12)
    assert shapely.Polygon(profile.closed_polygon()).is_valid
    pitch = np.pi / gear.tooth_count
    assert np.arctan2(*points[-1][::-1]) == pytest.approx(pitch, rel=1e-12)


@SETTINGS
@given(gears(), st.floats(0.1, 10.0))
def test_area_scales_with_the_square_of_the_module(gear, factor):
    profile = valid(generate_profile, gear, 80)
    if profile is None:
        return
    larger = InvoluteGear(
        gear.tooth_count, gear.module * factor, gear.pressure_angle, gear.profile_shift
    )
    assert generate_profile(larger, 80).area == pytest.approx(factor**2 * profile.area, rel=1e-9)
    outline = shapely.Polygon(profile.closed_polygon(0.3, (1e-2, -2e-2)))
    assert outline.area == pytest.approx(profile.area, rel=1e-9)
    assert profile.scaled(factor).area == pytest.approx(factor**2 * profile.area, rel=1e-12)


@SETTINGS
@given(pairs())
def test_gears_do_not_overlap_through_one_pitch(parameters):
    pair = valid(pair_from_backlash, *parameters)
    if pair is None:
        return
    first, second = generate_profile(pair.drive, 100), generate_profile(pair.driven, 100)
    # centred in the backlash: a drive space and a driven tooth on the y axis
    space = 0.5 * np.pi - np.pi / first.tooth_count
    for turn in np.linspace(0.0, first.pitch_angle, 7):
        drive = shapely.Polygon(first.closed_polygon(space + turn))
        rotation = -0.5 * np.pi + pair.speed_ratio * turn
        driven = shapely.Polygon(second.closed_polygon(rotation, (0.0, pair.center_distance)))
        # chords cut corners, overlap stays below a micrometre over the flank height
        assert drive.intersection(driven).area < 1e-6 * 4.0 * pair.drive.module


@SETTINGS
@given(pairs())
def test_play_follows_backlash(parameters):
    first, second, backlash = parameters
    pair = valid(pair_from_backlash, first, second, backlash + 0.02 * first.module)
    if pair is None or min(pair.involute_margins) < 0.0:
        return
    play = flank_clearance(
        generate_profile(first, 200), generate_profile(second, 200), pair.center_distance
    )
    # arc play at a radius between base and tip circle is the normal play over a cosine
    arc_play = pair.normal_backlash / np.cos(pair.operating_pressure_angle)
    assert 0.5 * pair.normal_backlash * 0.95 <= play <= 0.5 * arc_play * 1.1


@SETTINGS
@given(pairs())
def test_backlash_and_center_distance_are_inverse(parameters):
    pair = valid(pair_from_backlash, *parameters)
    if pair is None:
        return
    again = pair_from_center_distance(pair.drive, pair.driven, pair.center_distance)
    assert again.normal_backlash == pytest.approx(parameters[2], abs=1e-12)
    assert pair.speed_ratio == -pair.drive.tooth_count / pair.driven.tooth_count


@SETTINGS
@given(pairs())
def test_swapping_the_gears_keeps_the_volume_per_tooth(parameters):
    first, second, backlash = parameters
    pair = valid(pair_from_backlash, first, second, backlash)
    if pair is None:
        return
    swapped = pair_from_backlash(second, first, backlash)
    per_tooth = pair.displacement_per_radian(1e-2) / first.tooth_count
    assert swapped.displacement_per_radian(1e-2) / second.tooth_count == pytest.approx(per_tooth)
    assert swapped.contact_ratio == pytest.approx(pair.contact_ratio)


@settings(max_examples=6)
@given(gears(), st.floats(-3.0, 3.0), st.floats(-1.0, 1.0), st.floats(-1.0, 1.0))
def test_detection_finds_a_moved_gear(gear, rotation, right, up):
    profile = valid(generate_profile, gear, 120)
    if profile is None or tooth_form(gear).tip_land_angle * gear.tip_radius < 0.1 * gear.module:
        return
    moved = profile.closed_polygon(rotation, (right * 0.1, up * 0.1))
    found = gear_profile_from_curve(moved, 120)
    size = gear.tip_radius
    assert found.tooth_count == gear.tooth_count
    assert found.center == pytest.approx((right * 0.1, up * 0.1), abs=1e-6 * size)
    turn = (found.phase - rotation) / profile.pitch_angle
    assert turn == pytest.approx(np.round(turn), abs=1e-5)
    assert found.profile.area == pytest.approx(profile.area, rel=2e-4)
