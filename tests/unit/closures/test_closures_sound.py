"""Sound of simple bodies against closed forms, quadrature and printed tables."""

from __future__ import annotations

import math

import numpy as np
import pytest
from scipy.integrate import quad

from toothspace.closures.sound import (
    AIR_DENSITY,
    BAND_NUMBERS,
    SOUND_SPEED,
    a_weighting,
    plate_bending_stiffness,
    plate_critical_frequency,
    plate_near_field_power,
    plate_point_mobility,
    plate_radiation_efficiency,
    plate_transfer_ratio,
    radiated_power,
    sound_power_level,
    sphere_radiation_efficiency,
    third_octave_sums,
)

STIFFNESS = plate_bending_stiffness(2.1e11, 0.3, 0.01)
MASS = 78.5
CRITICAL = plate_critical_frequency(STIFFNESS, MASS)


def test_a_weighting_is_that_of_the_standard() -> None:
    """Printed values of IEC 61672-1 at exact frequencies of bands, rounded to 0.1 dB."""
    printed = {-15: -39.4, -10: -19.1, -7: -10.9, -3: -3.2, 0: 0.0, 3: 1.2, 6: 1.0, 10: -2.5}
    frequency = 1000.0 * 10.0 ** (0.1 * np.array(list(printed)))
    assert a_weighting(frequency) == pytest.approx(list(printed.values()), abs=0.051)
    assert a_weighting(np.array([1000.0]))[0] == 0.0


def test_third_octaves_keep_the_power_inside_them() -> None:
    frequency = np.geomspace(20.0, 20e3, 977)
    power = np.random.default_rng(1).uniform(size=(2, frequency.size))
    edges = 1000.0 * 10.0 ** np.array([-1.05, 1.05])
    inside = (frequency >= edges[0]) & (frequency < edges[1])
    sums = third_octave_sums(frequency, power)
    assert sums.sum(axis=1) == pytest.approx(power[:, inside].sum(axis=1), rel=1e-12)
    tone = third_octave_sums(np.array([1000.0]), np.array([3.0]))
    assert BAND_NUMBERS[np.argmax(tone)] == 0
    assert tone.max() == 3.0


def test_levels_of_power() -> None:
    assert sound_power_level(1e-12) == pytest.approx(0.0, abs=1e-12)
    assert sound_power_level(np.array([1e-3]))[0] == pytest.approx(90.0)
    assert np.isnan(sound_power_level(0.0))


@pytest.mark.parametrize("ka", [0.03, 0.5, 1.0, 3.0, 20.0])
def test_spheres_against_their_closed_forms(ka: float) -> None:
    found = [float(sphere_radiation_efficiency(degree, ka / 0.1, 0.1)) for degree in range(3)]
    two = ka**6 / (81.0 + 9.0 * ka**2 - 2.0 * ka**4 + ka**6)
    expected = [ka**2 / (1.0 + ka**2), ka**4 / (4.0 + ka**4), two]
    assert found == pytest.approx(expected, rel=1e-9, abs=0.0)


def test_a_small_pulsating_sphere_is_a_monopole() -> None:
    """Power of a monopole of volume velocity Q is rho c k^2 Q^2/(8 pi), whatever its size."""
    radius, wave_number, velocity = 1e-3, 5.0, 0.02
    area = 4.0 * np.pi * radius**2
    efficiency = sphere_radiation_efficiency(0, wave_number, radius)
    power = radiated_power(efficiency, area, 0.5 * velocity**2)
    strength = AIR_DENSITY * SOUND_SPEED * wave_number**2 * (area * velocity) ** 2
    assert power == pytest.approx(strength / (8.0 * np.pi), rel=1e-4, abs=0.0)


def test_bending_stiffness_by_hand() -> None:
    """E h^3/(12 (1 - nu^2)) of 10 mm of steel: 210e3/10.92 N m."""
    assert plate_bending_stiffness(2.1e11, 0.3, 0.01) == pytest.approx(210e3 / 10.92)
    assert plate_critical_frequency(210e3 / 10.92, 78.5) == pytest.approx(1197.6, rel=1e-3)


def test_bending_waves_at_the_critical_frequency_are_as_fast_as_sound() -> None:
    omega = 2.0 * np.pi * CRITICAL
    assert np.sqrt(omega) * (STIFFNESS / MASS) ** 0.25 == pytest.approx(SOUND_SPEED)
    assert pytest.approx(1200.0, rel=0.02) == CRITICAL


def test_plates_radiate_as_pistons_far_above_and_little_below_the_critical_frequency() -> None:
    frequency = np.array([20.0, 100.0, 300.0, 0.9 * CRITICAL, CRITICAL, 2.0 * CRITICAL, 1e6])
    found = plate_radiation_efficiency(frequency, CRITICAL, 1.5, 1.0)
    assert np.all((found > 0.0) & (found <= 2.0))
    assert np.all(np.diff(found[:4]) > 0.0)
    assert found[2] < 0.2
    assert found[4] == 2.0
    assert found[5] == pytest.approx(np.sqrt(2.0))
    assert found[6] == pytest.approx(1.0, abs=1e-3)
    small = plate_radiation_efficiency(np.array([100.0]), CRITICAL, 0.2, 0.15)
    assert small[0] == pytest.approx(4.0 * 0.03 * (100.0 / SOUND_SPEED) ** 2)


def test_a_couple_of_near_forces_is_a_moment() -> None:
    """Mobility of an infinite plate for a moment has the real part omega/(16 B)."""
    distance, omega, moment = 1e-3, 2.0 * np.pi * 500.0, 3.0
    wave_number = np.array([np.sqrt(omega) * (MASS / STIFFNESS) ** 0.25])
    ratio = plate_transfer_ratio(wave_number, distance)
    mobility = plate_point_mobility(STIFFNESS, MASS) * (1.0 - ratio).real
    power = (moment / distance) ** 2 * mobility[0]
    assert power == pytest.approx(0.5 * moment**2 * omega / (16.0 * STIFFNESS), rel=1e-4)
    assert abs(plate_transfer_ratio(wave_number * 1e-6, distance)[0] - 1.0) < 1e-9


def test_the_near_field_of_a_force_is_the_radiation_of_long_waves() -> None:
    """One side: rho omega/(8 pi^2) times the integral of |v(k)|^2/sqrt(k0^2 - k^2) over waves
    longer than in air, where the plate is mass alone: v(k) = F/(j omega m'').
    """
    omega, force = 2.0 * np.pi * 50.0, 7.0
    k0 = omega / SOUND_SPEED
    waves = quad(lambda s: k0 * np.sin(s), 0.0, 0.5 * np.pi)[0]  # k = k0 sin s
    power = AIR_DENSITY * omega / (8.0 * np.pi**2) * (force / (omega * MASS)) ** 2
    expected = power * 2.0 * np.pi * waves
    assert plate_near_field_power(0.5 * force**2, MASS) == pytest.approx(expected, rel=1e-9)


def test_edges_of_a_plate_radiate_below_the_critical_frequency() -> None:
    """At 3/4 of it corners are mute, and 0.4844 of the edges' strip is heard."""
    length, width, critical = 1.2, 0.8, 2000.0
    root = math.sqrt(0.75)
    part = (0.25 * math.log((1.0 + root) / (1.0 - root)) + 2.0 * root) / (0.5 * math.pi**2)
    assert part == pytest.approx(0.4844, abs=1e-4)
    strip = 2.0 * (length + width) / (length * width) * SOUND_SPEED / critical
    found = plate_radiation_efficiency(np.array([1500.0]), critical, length, width)
    assert float(found[0]) == pytest.approx(strip * part, rel=1e-9)


def test_corners_of_a_plate_radiate_below_half_of_the_critical_frequency() -> None:
    """At a quarter of it, by hand: edges (3/4 ln 3 + 1)/(4 pi^2 (3/4)^1.5), and corners."""
    length, width, critical = 1.2, 0.8, 2000.0
    edges = (0.75 * math.log(3.0) + 1.0) / (4.0 * math.pi**2 * 0.75**1.5)
    corners = 4.0 * SOUND_SPEED**2 / (critical**2 * math.pi**4 * 0.96 * 0.5 * math.sqrt(0.75))
    strip = 2.0 * (length + width) / 0.96 * SOUND_SPEED / critical
    found = plate_radiation_efficiency(np.array([500.0]), critical, length, width)
    assert float(found[0]) == pytest.approx(strip * edges + corners, rel=1e-9)


def test_a_small_plate_is_limited_by_its_size_above_the_critical_frequency() -> None:
    """sqrt(2 pi f (l + b)/(16 c)) where that is less than of a large one."""
    found = plate_radiation_efficiency(np.array([2000.0]), 1200.0, 0.2, 0.15)
    expected = math.sqrt(2.0 * math.pi * 2000.0 * 0.35 / (16.0 * SOUND_SPEED))
    assert expected < 1.0 / math.sqrt(1.0 - 0.6)
    assert float(found[0]) == pytest.approx(expected, rel=1e-9)


def test_below_its_first_resonance_a_large_plate_radiates_as_a_piston_at_most() -> None:
    """First resonance c^2/(4 f_c) (1/l^2 + 1/b^2): 5.5 Hz here; below it 4 l b (f/c)^2."""
    length, width, critical = 1.2, 0.8, 12e3
    first = SOUND_SPEED**2 / (4.0 * critical) * (length**-2 + width**-2)
    frequency = first * np.array([0.3, 0.95, 0.99, 1.01])
    found = plate_radiation_efficiency(frequency, critical, length, width)
    piston = 4.0 * length * width * (frequency / SOUND_SPEED) ** 2
    assert found[:3] == pytest.approx(piston[:3], rel=1e-9)
    assert found[3] > 2.0 * piston[3]
