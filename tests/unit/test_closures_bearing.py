"""Lumped journal bearing against PHYSICS 7 and published tables."""

from __future__ import annotations

import csv
from pathlib import Path

import numpy as np
import pytest

from toothspace.closures.bearing_lumped import (
    JournalSize,
    bearing_friction_number,
    finite_bearing_force,
    journal_friction_torque,
    petroff_torque,
    short_bearing_dynamic_force,
    short_bearing_force,
    sommerfeld_number,
)
from toothspace.closures.journal_friction import PUBLISHED_CURVE

CONVERGED = {  # PHYSICS 7.1, converged Reynolds solutions: (L/D, eps): S, phi, f R/c
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
RAIMONDI_BOYD = [  # PHYSICS 7.1: L/D, eps, S, phi, f R/c
    (1.0, 0.1, 1.33, 79.5, 26.4),
    (1.0, 0.6, 0.121, 50.58, 3.22),
    (1.0, 0.97, 0.00474, 15.47, 0.514),
    (0.5, 0.6, 0.319, 48.14, 8.10),
    (0.25, 0.9, 0.0736, 21.85, 3.50),
]
LOAD_ERROR = {0.25: 0.012, 0.5: 0.035, 1.0: 0.065}  # PHYSICS 7.2: 1, 1-3, 3-6 %


def unit_size(slenderness: float) -> JournalSize:
    """Bearing with mu omega (R/c)^2 R L = 1 at unit viscosity and speed."""
    length = 2.0 * slenderness
    return JournalSize(1.0, length, np.sqrt(length))


@pytest.mark.parametrize(("slenderness", "eccentricity"), CONVERGED)
def test_steady_load_and_attitude(slenderness: float, eccentricity: float) -> None:
    sommerfeld, attitude, friction = CONVERGED[slenderness, eccentricity]
    size = unit_size(slenderness)
    radial, cross = finite_bearing_force(eccentricity, 1.0, 0.0, 1.0, size)
    ours = sommerfeld_number(1.0, np.hypot(radial, cross), 1.0, size)
    angle = np.arctan2(cross, radial)
    assert ours == pytest.approx(sommerfeld, rel=LOAD_ERROR[slenderness])
    assert np.degrees(angle) == pytest.approx(attitude, abs=4.0)  # worst at 0.2
    number = bearing_friction_number(ours, eccentricity, angle)
    assert number == pytest.approx(friction, rel=LOAD_ERROR[slenderness])


@pytest.mark.parametrize(
    ("slenderness", "eccentricity", "sommerfeld", "attitude", "friction"), RAIMONDI_BOYD
)
def test_friction_reproduces_raimondi_and_boyd(
    slenderness: float, eccentricity: float, sommerfeld: float, attitude: float, friction: float
) -> None:
    """From their own S and attitude angle: the sheared full circumference."""
    number = bearing_friction_number(sommerfeld, eccentricity, np.radians(attitude))
    assert number == pytest.approx(friction, rel=0.02)


def test_closed_form_with_squeeze() -> None:
    """PHYSICS 7.2, film from the widest gap: (.2948, .2203) and (7.157, 0) over 3 mu..."""
    size = unit_size(0.5)
    force = np.array(finite_bearing_force(0.5, 1.0, 0.1, 1.0, size, from_widest_gap=True))
    assert force / 3.0 == pytest.approx([0.2948, 0.2203], abs=4e-4)
    force = np.array(finite_bearing_force(0.8, 0.0, 0.2, 1.0, unit_size(1.0), True))
    assert force / 3.0 == pytest.approx([7.157, 0.0], rel=4e-3, abs=1e-9)


def test_free_film_is_closer_to_the_full_solution() -> None:
    """PHYSICS 7.2: Reynolds solution (.2871, .2136) and 6.728."""
    force = np.array(finite_bearing_force(0.5, 1.0, 0.1, 1.0, unit_size(0.5))) / 3.0
    assert np.hypot(*(force - [0.2871, 0.2136])) < 0.01 * np.hypot(0.2871, 0.2136)
    radial = finite_bearing_force(0.8, 0.0, 0.2, 1.0, unit_size(1.0))[0] / 3.0
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
        size = unit_size(slenderness)
        radial = finite_bearing_force(abs(eccentricity), 0.0, rate, 1.0, size)[0]
        errors[slenderness].append(abs(0.5 * abs(radial) / expected - 1.0))
    assert max(errors[0.25]) < 0.045
    assert max(errors[0.5]) < 0.065
    assert max(errors[1.0]) < 0.075


def test_short_bearing_is_the_limit_of_small_length() -> None:
    size = unit_size(0.02)
    force = np.array(finite_bearing_force(0.5, 1.0, 0.0, 1.0, size))
    assert force == pytest.approx(np.array(short_bearing_force(0.5, 0.02)), rel=2e-3)
    attitude = np.arctan2(*short_bearing_force(0.5, 0.1)[::-1])
    assert np.tan(attitude) == pytest.approx(np.pi * np.sqrt(0.75) / 2.0)  # PHYSICS 7.3


@pytest.mark.parametrize(("rate", "turn"), [(0.0, 0.0), (0.1, 0.0), (-0.05, 0.2), (0.2, -0.3)])
def test_short_bearing_in_motion(rate: float, turn: float) -> None:
    """Capone's closed form at L/D = 0.05: line of centres turning and squeezing."""
    slenderness, eccentricity = 0.05, 0.6
    size = unit_size(slenderness)
    radial, cross = finite_bearing_force(eccentricity, 1.0 - 2.0 * turn, rate, 1.0, size)
    # eccentricity along x: x' = squeeze, y' = eccentricity * turn
    x, y = short_bearing_dynamic_force(eccentricity, 0.0, rate, eccentricity * turn)
    scale = slenderness**2
    assert np.array([-radial, cross]) / scale == pytest.approx([x, y], rel=0.03)


def test_petroff_and_friction_torque() -> None:
    """A centred journal; and the pressure term e x F / 2 of an eccentric one."""
    size = JournalSize(9e-3, 19e-3, 8e-6)
    viscous = petroff_torque(157.0, 0.02, size)
    assert viscous == pytest.approx(2 * np.pi * 0.02 * 157.0 * 9e-3**3 * 19e-3 / 8e-6)
    assert journal_friction_torque(0.0, 0.0, 10.0, -5.0, viscous, 8e-6) == pytest.approx(viscous)
    torque = journal_friction_torque(4e-6, 0.0, 0.0, 1000.0, viscous, 8e-6)
    assert torque == pytest.approx(viscous / np.sqrt(0.75) + 0.5 * 4e-6 * 1000.0)
    assert np.isfinite(journal_friction_torque(9e-6, 0.0, 0.0, 1000.0, viscous, 8e-6))


def test_friction_torque_is_the_friction_number_times_load() -> None:
    size = JournalSize(9e-3, 19e-3, 8e-6)
    radial, cross = finite_bearing_force(0.7, 157.0, 0.0, 0.02, size)
    load = np.hypot(radial, cross)
    number = bearing_friction_number(
        sommerfeld_number(157.0, load, 0.02, size), 0.7, np.arctan2(cross, radial)
    )
    viscous = petroff_torque(157.0, 0.02, size)
    torque = journal_friction_torque(0.7 * 8e-6, 0.0, -radial, cross, viscous, 8e-6)
    assert torque == pytest.approx(number * 8e-6 / 9e-3 * load * 9e-3)


def test_mixed_friction_curve() -> None:
    """PHYSICS 1.1 and 0.11: 0.0455 at rest, 0.00102 at S = 0.0184, 0.0088 at 0.5, then a line."""
    curve = PUBLISHED_CURVE(np.array([0.0, 0.0184, 0.5, 2.0]))
    assert curve == pytest.approx([0.0455, 0.00102, 0.0088, 2 * 0.01748], rel=5e-3)
    fine = np.linspace(0.3, 0.7, 4001)
    slope = np.gradient(PUBLISHED_CURVE(fine), fine)
    assert np.abs(np.diff(slope)).max() < 1e-4  # no kink
    assert np.all(slope > 0.0)
