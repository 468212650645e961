"""Gear geometry against published reports and the two reference designs."""

from dataclasses import replace

import numpy as np
import pytest

from tests.reference_formulas.involute_contact import curvature_radii
from tests.reference_formulas.trapped_area import trapped_area
from toothspace.geometry.gear_pair import (
    pair_from_backlash,
    pair_from_center_distance,
    trapped_volume_change,
)
from toothspace.geometry.involute import InvoluteGear, generate_profile

# MAAG reports of the FZG gears; lengths in mm, tolerances 0.002 mm (radii), 0.01 (others)
SPUR = {
    "module": 4.5, "alpha": 20.0, "beta": 0.0, "z": (16, 24), "x": (0.1817, 0.1715), "a": 91.5,
    "rf": (31.193, 49.147), "rb": (33.829, 50.743), "rw": (36.600, 54.900),
    "ra": (41.318, 59.272), "eps": 1.46, "T1T2": 34.93, "AB": 6.14, "AC": 9.68, "AD": 13.28,
    "AE": 19.43,
}  # fmt: skip
HELICAL = {
    "module": 3.5, "alpha": 20.0, "beta": 15.0, "z": (20, 30), "x": (0.1809, 0.0891), "a": 91.5,
    "rf": (32.493, 50.289), "rb": (None, None), "rw": (36.600, 54.900), "ra": (40.336, 58.132),
    "eps": 1.46, "T1T2": 34.45, "AB": 4.90, "AC": 7.48, "AD": 10.65, "AE": 15.55,
}  # fmt: skip


def transverse_pair(row):
    cosine = np.cos(np.deg2rad(row["beta"]))
    alpha = np.arctan(np.tan(np.deg2rad(row["alpha"])) / cosine)
    gears = [
        InvoluteGear(
            count,
            row["module"] * 1e-3 / cosine,
            float(alpha),
            shift * cosine,
            tip_diameter=2e-3 * tip,
            dedendum=1.25 * cosine,
        )
        for count, shift, tip in zip(row["z"], row["x"], row["ra"], strict=True)
    ]
    return pair_from_center_distance(gears[0], gears[1], row["a"] * 1e-3)


@pytest.mark.parametrize("row", [SPUR, HELICAL], ids=["C14 and C40", "H501 transverse"])
def test_radii_and_path_of_contact_of_reports(row):
    pair = transverse_pair(row)
    for index, gear in enumerate((pair.drive, pair.driven)):
        assert gear.root_radius * 1e3 == pytest.approx(row["rf"][index], abs=0.002)
        assert pair.pitch_radii[index] * 1e3 == pytest.approx(row["rw"][index], abs=0.002)
        if row["rb"][index] is not None:
            assert gear.base_radius * 1e3 == pytest.approx(row["rb"][index], abs=0.002)
    start, end = pair.path_of_contact
    assert pair.contact_ratio == pytest.approx(row["eps"], abs=0.01)
    assert sum(pair.pitch_roll_lengths) * 1e3 == pytest.approx(row["T1T2"], abs=0.01)
    assert -start * 1e3 == pytest.approx(row["AC"], abs=0.01)
    assert pair.base_pitch * 1e3 == pytest.approx(row["AD"], abs=0.01)
    assert (end - start) * 1e3 == pytest.approx(row["AE"], abs=0.01)
    assert (end - start - pair.base_pitch) * 1e3 == pytest.approx(row["AB"], abs=0.01)


def test_default_tip_circle_of_reports():
    gear = InvoluteGear(16, 4.5e-3, np.deg2rad(20.0), 0.1817)
    assert gear.tip_radius * 1e3 == pytest.approx(41.318, abs=0.002)


@pytest.mark.parametrize(
    ("force", "face_width", "pressure"), [(5912.1, 14e-3, 1347.3e6), (6370.7, 40e-3, 827.4e6)]
)
def test_curvature_at_pitch_point_gives_reported_hertz_pressure(force, face_width, pressure):
    # steel on steel, 206 GPa and 0.3, face widths 14 and 40 mm of the FZG gears
    first, second = curvature_radii(transverse_pair(SPUR), 0.0)
    radius = first * second / (first + second)
    modulus = 206e9 / (2.0 * (1.0 - 0.3**2))
    found = np.sqrt(force / face_width * modulus / (np.pi * radius))
    assert found == pytest.approx(pressure, rel=0.01)


@pytest.fixture
def motor():
    gear = InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.3, tip_diameter=40.372e-3)
    return pair_from_backlash(gear, gear, 0.02e-3)


@pytest.fixture
def fuel_pump():
    gear = InvoluteGear(14, 4.5e-3, np.deg2rad(25.0), 0.0, tip_diameter=72.12e-3)
    return pair_from_center_distance(gear, gear, 63.06e-3)


def test_motor_of_4_95_cm3(motor):
    # by hand from the equations of ISO 21771:2007; rack with a dedendum of 1.25 modules
    assert motor.drive.base_radius * 1e3 == pytest.approx(15.505, abs=1e-3)
    assert motor.center_distance * 1e3 == pytest.approx(34.465, abs=1e-3)
    assert np.rad2deg(motor.operating_pressure_angle) == pytest.approx(25.87, abs=0.01)
    assert motor.drive.root_radius * 1e3 == pytest.approx(13.887, abs=1e-3)
    assert motor.root_clearances[0] * 1e3 == pytest.approx(0.39, abs=5e-3)
    assert motor.base_pitch * 1e3 == pytest.approx(8.118, abs=1e-3)
    assert motor.contact_ratio == pytest.approx(1.332, abs=1e-3)
    land = 2.0 * motor.drive.tip_radius * motor.drive.half_angle(motor.drive.tip_radius)
    assert land * 1e3 == pytest.approx(1.02, abs=5e-3)
    assert 0.5 * motor.relief_groove_spacing * 1e3 == pytest.approx(3.652, abs=1e-3)


@pytest.mark.parametrize(("sealing", "volume"), [("single", 4.949), ("dual", 5.144)])
def test_displacement_of_motor(motor, sealing, volume):
    found = motor.displacement_per_radian(7.5e-3, sealing) * 2e6 * np.pi
    assert found == pytest.approx(volume, rel=2e-4)


@pytest.mark.parametrize(("sealing", "volume"), [("single", 43.01), ("dual", 44.5)])
def test_displacement_of_fuel_pump(fuel_pump, sealing, volume):
    found = fuel_pump.displacement_per_radian(23.4e-3, sealing) * 2e6 * np.pi
    assert found == pytest.approx(volume, rel=1e-3)


def test_fuel_pump(fuel_pump):
    # by hand from the equations of ISO 21771:2007
    assert fuel_pump.contact_ratio == pytest.approx(1.35, abs=1e-3)
    assert np.rad2deg(fuel_pump.operating_pressure_angle) == pytest.approx(25.1, abs=0.05)
    assert fuel_pump.normal_backlash * 1e3 == pytest.approx(0.05, abs=1e-3)
    assert fuel_pump.relief_groove_spacing * 1e3 == pytest.approx(11.60, abs=5e-3)


def test_flow_ripple(motor, fuel_pump):
    # (pb^2 / 4) / (ra^2 - rw^2 - pb^2 / 12), dual flank with a quarter of pb^2: Manring and
    # Kasaragadda, J. Dyn. Syst. Meas. Control 125 (2003) 396-404
    assert motor.flow_ripple() == pytest.approx(0.1569, abs=5e-5)
    assert motor.flow_ripple("dual") == pytest.approx(0.0377, abs=5e-5)
    assert fuel_pump.flow_ripple() == pytest.approx(0.1403, abs=5e-5)
    assert fuel_pump.flow_ripple("dual") == pytest.approx(0.0339, abs=5e-5)


def unequal_pair():
    return pair_from_backlash(
        InvoluteGear(12, 2.75e-3, np.deg2rad(20.0), 0.35),
        InvoluteGear(17, 2.75e-3, np.deg2rad(20.0), 0.1),
        2e-5,
    )


def test_mean_of_ideal_flow_is_displacement_for_unequal_gears():
    pair = unequal_pair()
    position = (np.arange(2000) + 0.5) / 2000 - 0.5
    flow = pair.flow_per_radian(10e-3, position * pair.base_pitch)
    assert np.mean(flow) == pytest.approx(pair.displacement_per_radian(10e-3), rel=1e-6)


def test_sealing_contact_stays_on_a_one_sided_path(motor):
    """A short driven tip ends the path before half a pitch: the window moves to the other side."""
    short = replace(motor.driven, tip_diameter=38.4e-3)
    pair = pair_from_backlash(motor.drive, short, 2e-5)
    start, end = pair.path_of_contact
    assert -0.5 * pair.base_pitch < start < end - pair.base_pitch
    assert pair.sealing_window() == (start, start + pair.base_pitch)
    position = start + (np.arange(4000) + 0.5) / 4000 * pair.base_pitch
    flow = np.asarray(pair.flow_per_radian(10e-3, position))
    assert pair.displacement_per_radian(10e-3) == pytest.approx(flow.mean(), rel=1e-6)
    assert pair.flow_ripple() == pytest.approx(np.ptp(flow) / flow.mean(), rel=1e-3)


@pytest.mark.parametrize("make", [unequal_pair, None], ids=["unequal", "motor"])
def test_trapped_outline_changes_as_the_closed_form(make, motor):
    pair = motor if make is None else make()
    first = generate_profile(pair.drive, 1000)
    second = generate_profile(pair.driven, 1000)
    midpoint = pair.path_of_contact[0] + 0.5 * pair.base_pitch
    change = trapped_area(pair, first, second, midpoint) - trapped_area(pair, first, second)
    assert change * 8e-3 == pytest.approx(trapped_volume_change(pair, 8e-3), rel=2e-3)
