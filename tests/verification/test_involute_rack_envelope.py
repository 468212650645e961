"""The generated tooth against a brute-force rack: no point is cut, every point is touched."""

import numpy as np
import pytest

from toothspace.geometry.involute import InvoluteGear, generate_profile, tooth_form

GEARS = {
    "reference motor": InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.3),
    "fuel pump, full round tool": InvoluteGear(14, 4.5e-3, np.deg2rad(25.0)),
    "undercut": InvoluteGear(8, 3e-3, np.deg2rad(20.0), 0.05),
    "nearly sharp tool": InvoluteGear(17, 2e-3, np.deg2rad(20.0), 0.1, tool_tip_radius=0.1),
    "deep, many teeth": InvoluteGear(60, 1e-3, np.deg2rad(17.5), -0.2, dedendum=1.4),
}


def rack_distance(gear, depth, side):
    """Signed distance to one tooth of the rack, negative inside, from its outline alone."""
    m, alpha, rho = gear.module, gear.pressure_angle, gear.rack_tip_radius
    tip = (gear.dedendum - gear.profile_shift) * m
    half = m * (0.25 * np.pi - gear.profile_shift * np.tan(alpha))
    side = np.abs(side)
    flank = (side - half + depth * np.tan(alpha)) * np.cos(alpha)
    center = tip - rho
    center_side = half - center * np.tan(alpha) - rho / np.cos(alpha)
    down, out = depth - center, side - center_side
    corner = np.hypot(down, out) - rho
    # the corner arc counts between the normals of the tip line and of the flank
    in_corner = (out > 0.0) & (down * np.cos(alpha) > out * np.sin(alpha))
    return np.where(in_corner, corner, np.maximum(flank, depth - tip))


def smallest_distance(gear, points):
    roll = np.linspace(-1.2, 1.2, 24001) * 4.0 * gear.module / gear.reference_radius
    spaces = np.exp(-1j * np.pi / gear.tooth_count) * (points @ np.array([1.0, 1j]))
    closest = np.empty(len(points))
    for index, point in enumerate(spaces):
        turned = point * np.exp(1j * roll)
        depth = gear.reference_radius - turned.real
        side = turned.imag - gear.reference_radius * roll
        closest[index] = rack_distance(gear, depth, side).min()
    return closest


@pytest.mark.parametrize("name", GEARS)
def test_rack_touches_every_point_of_root_and_flank(name):
    gear = GEARS[name]
    profile = generate_profile(gear, 80)
    # left flank of the tooth = right side of the space that the rack tooth cuts
    flank = profile.left_flank[1:]
    closest = smallest_distance(gear, flank)
    # the step of the roll angle leaves at most 2e-9 m between a touching point and its contact
    assert closest.min() > -1e-10
    assert closest.max() < 2e-8


def test_brute_force_rack_sees_a_wrong_fillet():
    gear = GEARS["reference motor"]
    flank = generate_profile(gear, 80).left_flank
    assert smallest_distance(gear, flank * 1.0001).min() < -1e-6
    assert smallest_distance(gear, flank * 0.9999).max() > 1e-6


def test_undercut_begins_at_the_limit_of_profile_shift():
    # z sin^2(alpha) / 2 reached by the straight part of the rack: 1.25 - 0.38 (1 - sin(alpha))
    # less 12 sin^2(20 deg) / 2 is 0.298; Litvin and Fuentes, Gear Geometry, 2004, chapter 10
    limit = GEARS["reference motor"].smallest_shift_without_undercut
    assert limit == pytest.approx(0.298, abs=5e-4)
    above = InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), limit + 1e-4)
    below = InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), limit - 1e-4)
    assert not tooth_form(above).undercut
    assert tooth_form(below).undercut
    assert tooth_form(below).form_radius == pytest.approx(tooth_form(above).form_radius, rel=1e-4)
