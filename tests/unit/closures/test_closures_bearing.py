"""Closed form of the journal bearing, as the simulator reads it, against published tables."""

from __future__ import annotations

import csv
from functools import cache
from pathlib import Path

import numpy as np
import pytest

from tests.reference_formulas.journal_bearing import (
    friction_number,
    short_bearing_dynamic_force,
    short_bearing_force,
)
from toothspace.closures.bearing_map import JournalMap, build_journal_map, journal_force
from toothspace.closures.journal_friction import (
    PUBLISHED_CURVE,
    FrictionCurve,
    FrictionCurves,
    journal_pressure_torque,
    journal_shear_torque,
    sommerfeld_number,
)

CONVERGED = {  # converged Reynolds solutions: (L/D, eps): S, phi, f R/c
    (1.0, 0.2): (0.6317, 73.86, 12.82),
    (1.0, 0.4): (0.2604, 62.57, 5.785),
    (1.0, 0.6): (0.1209, 50.53, 3.215),
    (1.0, 0.8): (0.04455, 36.23, 1.702),
    (1.0, 0.9): (0.01882, 26.47, 1.053),
    (0.5, 0.2): (2.032, 75.13, 41.02),
    (0.5, 0.4): (0.7853, 61.77, 17.09),
    (0.5, 0.6): (0.3192, 48.05, 8.100),
    (0.5, 0.8): (0.0917, 32.93, 3.234),
    (0.5, 0.9): (0.03124, 23.56, 1.594),
    (0.25, 0.2): (7.577, 75.38, 152.7),
    (0.25, 0.4): (2.841, 61.20, 61.36),
    (0.25, 0.6): (1.078, 46.82, 26.81),
    (0.25, 0.8): (0.2633, 31.25, 8.868),
    (0.25, 0.9): (0.07365, 21.79, 3.502),
}
RAIMONDI_BOYD = [  # Trans. ASLE 1 (1958) 159-209: L/D, eps, S, phi, f R/c
    (1.0, 0.1, 1.33, 79.5, 26.4),
    (1.0, 0.6, 0.121, 50.58, 3.22),
    (1.0, 0.97, 0.00474, 15.47, 0.514),
    (0.5, 0.6, 0.319, 48.14, 8.10),
    (0.25, 0.9, 0.0736, 21.85, 3.50),
]
LOAD_ERROR = {0.25: 0.012, 0.5: 0.035, 1.0: 0.065}  # of build_journal_map: 1, 3, 6 %


@cache
def journal_map(slenderness: float) -> JournalMap:
    return build_journal_map(slenderness)


def force(
    slenderness: float, eccentricity: float, speed: float, velocity: tuple[float, float] = (0, 0)
) -> np.ndarray:
    """Force along and across the eccentricity at unit film scale and clearance.

    Over mu omega R L (R/c)^2, with speeds over that of the shaft.
    """
    shape = journal_map(slenderness)
    return np.array(journal_force(eccentricity, 0.0, *velocity, speed, 1.0, 1.0, shape)[:2])


def number_of(slenderness: float, load: float) -> float:
    """Sommerfeld number of a dimensionless load."""
    length = 2.0 * slenderness
    return float(sommerfeld_number(1.0, load, 1.0, 1.0, length, np.sqrt(length)))


@pytest.mark.parametrize(("slenderness", "eccentricity"), CONVERGED)
def test_steady_load_and_attitude(slenderness: float, eccentricity: float) -> None:
    sommerfeld, attitude, friction = CONVERGED[slenderness, eccentricity]
    along, across = force(slenderness, eccentricity, 1.0)
    ours = number_of(slenderness, np.hypot(along, across))
    angle = np.arctan2(across, -along)
    assert ours == pytest.approx(sommerfeld, rel=LOAD_ERROR[slenderness])
    assert np.degrees(angle) == pytest.approx(attitude, abs=4.0)  # worst at 0.2
    found = friction_number(ours, eccentricity, angle)
    assert found == pytest.approx(friction, rel=LOAD_ERROR[slenderness])


@pytest.mark.parametrize(
    ("slenderness", "eccentricity", "sommerfeld", "attitude", "friction"), RAIMONDI_BOYD
)
def test_friction_reproduces_raimondi_and_boyd(
    slenderness: float, eccentricity: float, sommerfeld: float, attitude: float, friction: float
) -> None:
    """From their own S and attitude angle: the sheared full circumference."""
    number = friction_number(sommerfeld, eccentricity, np.radians(attitude))
    assert number == pytest.approx(friction, rel=0.02)


def test_film_with_squeeze_is_close_to_the_full_solution() -> None:
    """Reynolds solutions (0.2871, 0.2136) and 6.728, over 3 mu omega R L (R/c)^2."""
    found = force(0.5, 0.5, 1.0, (0.1, 0.0)) / 3.0
    assert np.hypot(*(found - [-0.2871, 0.2136])) < 0.01 * np.hypot(0.2871, 0.2136)
    radial = -force(1.0, 0.8, 0.0, (0.2, 0.0))[0] / 3.0
    assert radial == pytest.approx(6.728, rel=0.04)


def squeeze_table() -> list[tuple[float, float, float]]:
    path = Path(__file__).parent / "data" / "butenschoen_squeeze.csv"
    with path.open(encoding="utf-8") as file:
        rows = [{k: float(v) for k, v in row.items()} for row in csv.DictReader(file)]
    return [(row["B_over_D"], row["eps"], row["So"]) for row in rows]


def test_pure_squeeze_against_butenschoen() -> None:
    """Tables of Butenschoen (1976), opening (negative) and closing; So = F psi^2/(L D mu v)."""
    errors = {0.25: [], 0.5: [], 1.0: []}
    for slenderness, eccentricity, expected in squeeze_table():
        if abs(eccentricity) > 0.95:
            continue
        rate = -1.0 if eccentricity < 0.0 else 1.0
        radial = force(slenderness, abs(eccentricity), 0.0, (rate, 0.0))[0]
        errors[slenderness].append(abs(0.5 * abs(radial) / expected - 1.0))
    assert max(errors[0.25]) < 0.045
    assert max(errors[0.5]) < 0.065
    assert max(errors[1.0]) < 0.075


def test_short_bearing_is_the_limit_of_small_length() -> None:
    along, across = short_bearing_force(0.5, 0.05)
    assert force(0.05, 0.5, 1.0) == pytest.approx([-along, across], rel=1e-2)
    assert across / along == pytest.approx(np.pi * np.sqrt(0.75) / 2.0)


@pytest.mark.parametrize(("rate", "turn"), [(0.0, 0.0), (0.1, 0.0), (-0.05, 0.2), (0.2, -0.3)])
def test_short_bearing_in_motion(rate: float, turn: float) -> None:
    """Capone's closed form at L/D = 0.05: line of centres turning and squeezing."""
    slenderness, eccentricity = 0.05, 0.6
    found = force(slenderness, eccentricity, 1.0, (rate, eccentricity * turn))
    expected = short_bearing_dynamic_force(eccentricity, 0.0, rate, eccentricity * turn)
    assert found / slenderness**2 == pytest.approx(expected, rel=0.03)


def test_centred_journal_has_the_torque_of_petroff() -> None:
    by_hand = 2 * np.pi * 0.02 * 157.0 * 9e-3**3 * 19e-3 / 8e-6
    assert journal_shear_torque(0.0, 157.0, 0.02, 9e-3, 19e-3, 8e-6) == pytest.approx(by_hand)
    eccentric = journal_shear_torque(0.5, 157.0, 0.02, 9e-3, 19e-3, 8e-6)
    assert eccentric == pytest.approx(by_hand / np.sqrt(0.75))
    assert journal_pressure_torque(4e-6, 1e-6, 30.0, 1000.0) == pytest.approx(
        0.5 * (4e-6 * 1000.0 - 1e-6 * 30.0)
    )


def test_friction_torque_is_the_friction_number_times_load() -> None:
    """Shear of the whole film and moment of the film force, against Raimondi and Boyd's form."""
    radius, length, clearance = 9e-3, 19e-3, 8e-6
    strength = 0.02 * 157.0 * radius * length * (radius / clearance) ** 2
    along, across = strength * force(round(0.5 * length / radius, 9), 0.7, 1.0)
    load = np.hypot(along, across)
    number = friction_number(
        sommerfeld_number(157.0, load, 0.02, radius, length, clearance),
        0.7,
        np.arctan2(across, -along),
    )
    torque = journal_shear_torque(0.7, 157.0, 0.02, radius, length, clearance)
    torque += journal_pressure_torque(0.7 * clearance, 0.0, along, across)
    assert torque == pytest.approx(number * clearance / radius * load * radius)


def test_mixed_friction_curve() -> None:
    """By hand: 0.0455 at rest, 0.00102 at S = 0.0184, 0.0088 at 0.5, then a line."""
    curve = PUBLISHED_CURVE(np.array([0.0, 0.0184, 0.5, 2.0]))
    assert curve == pytest.approx([0.0455, 0.00102, 0.0088, 2 * 0.01748], rel=5e-3)
    fine = np.linspace(0.3, 0.7, 4001)
    slope = np.gradient(PUBLISHED_CURVE(fine), fine)
    assert np.abs(np.diff(slope)).max() < 1e-4  # no kink
    assert np.all(slope > 0.0)


def test_numbers_of_the_mixed_friction_curve_by_hand() -> None:
    """From 0.05 to 0.2 the boundary term is gone: c (tanh(0.2/d) - tanh(0.05/d)) / 0.15."""
    expected = 0.01897 * (np.tanh(0.2 / 1.085) - np.tanh(0.05 / 1.085)) / 0.15
    assert PUBLISHED_CURVE.full_film_slope() == pytest.approx(expected, rel=1e-6)
    assert PUBLISHED_CURVE.boundary_level == pytest.approx(0.04486 + 0.0006507)
    number, least = PUBLISHED_CURVE.minimum()
    # where a/b exp(-S/b) = c/d: S = b ln(a d/(b c))
    assert number == pytest.approx(
        0.002681 * np.log(0.04486 * 1.085 / (0.002681 * 0.01897)), rel=3e-3
    )
    assert least == pytest.approx(float(PUBLISHED_CURVE(number)))


def test_the_lowest_point_is_sought_from_a_ten_thousandth_to_one() -> None:
    """Friction that only rises is lowest at the first, friction that only falls at the last."""
    rising = FrictionCurve(0.0, 1.0, 0.02, 1.0, 0.001, 0.02)
    falling = FrictionCurve(0.1, 0.5, 0.0, 1.0, 0.001, 0.0)
    assert rising.minimum()[0] == pytest.approx(1e-4, rel=1e-9)
    assert falling.minimum()[0] == pytest.approx(1.0, rel=1e-9)
    assert rising.minimum()[1] == pytest.approx(0.001 + 0.02 * np.tanh(1e-4))


def test_friction_between_two_loads_is_linear_in_their_logarithm() -> None:
    low, high = FrictionCurve(0.1, 1.0, 0.0, 1.0, 0.0, 0.0), FrictionCurve(0.3, 1.0, 0.0, 1.0, 0, 0)
    curves = FrictionCurves((10.0, 1000.0), (low, high))
    assert [curves(0.0, load) for load in (1.0, 10.0, 100.0, 1e3, 1e5)] == pytest.approx(
        [0.1, 0.1, 0.2, 0.3, 0.3]
    )
