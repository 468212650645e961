"""Compiled contact laws: inverse of the closed forms, energy, stiffness, smooth onset."""

from __future__ import annotations

import numpy as np
import pytest

from tests.reference_formulas.cylinder_contact import hertz_approach, johnson_indentation
from toothspace.closures.contact_cylindrical import pereira_force
from toothspace.closures.contact_law import (
    hertz_scale,
    johnson_scale,
    logarithmic_law,
    power_law,
    rounded_depth,
    series_level,
)

STEEL = 206e9 / (2.0 * (1.0 - 0.3**2))
DEPTHS = [1e-9, 1e-7, 3e-6, 2e-5]
LEVEL = float(np.log(4e-3))


@pytest.mark.parametrize("depth", DEPTHS)
def test_law_inverts_johnson(depth: float) -> None:
    load, _, _, _ = logarithmic_law(depth, LEVEL, STEEL)
    assert johnson_indentation(load, 4e-3, STEEL) == pytest.approx(depth, rel=1e-12, abs=0.0)


@pytest.mark.parametrize("other", [25e-3, -20e-3])
def test_law_inverts_hertz_where_bodies_are_deep(other: float) -> None:
    """Two cylinders of 15 and 25 mm, or 15 mm in a groove of 20 mm: Johnson (1985), 5.6."""
    scale = float(hertz_scale(15e-3, other, np.inf))
    assert scale == pytest.approx(johnson_scale(15e-3, other))
    load, _, _, _ = logarithmic_law(5e-6, float(np.log(scale)), STEEL)
    assert hertz_approach(load, 15e-3, other, STEEL) == pytest.approx(5e-6, rel=1e-12)


def test_structure_in_series_adds_its_deflection() -> None:
    """Hertz plus q/kappa by hand."""
    kappa, load = 15e9, 3e5
    by_hand = johnson_indentation(load, 4e-3, STEEL) + load / kappa
    level = float(series_level(4e-3, STEEL, kappa))
    assert logarithmic_law(by_hand, level, STEEL)[0] == pytest.approx(load, rel=1e-11)


@pytest.mark.parametrize("depth", [*DEPTHS, 3e-3])
def test_force_is_the_slope_of_the_energy(depth: float) -> None:
    """Also beyond the range of the logarithm (last depth), and by the level."""
    step = 1e-4
    load, stiffness, _, by_level = logarithmic_law(depth, LEVEL, STEEL)
    up, down = (logarithmic_law(depth * (1.0 + s * step), LEVEL, STEEL) for s in (1, -1))
    assert (up[2] - down[2]) / (2.0 * step * depth) == pytest.approx(load, rel=1e-6)
    assert (up[0] - down[0]) / (2.0 * step * depth) == pytest.approx(stiffness, rel=1e-6)
    up, down = (logarithmic_law(depth, LEVEL + s * step, STEEL) for s in (1, -1))
    assert (up[2] - down[2]) / (2.0 * step) == pytest.approx(by_level, rel=1e-5, abs=0.0)


def test_law_goes_on_straight_without_a_jump() -> None:
    edge = 4.0 * np.exp(LEVEL - 3.0)
    below, above = (logarithmic_law(edge * f, LEVEL, STEEL) for f in (1.0 - 1e-9, 1.0 + 1e-9))
    assert above[:3] == pytest.approx(below[:3], rel=1e-7)


def test_power_law_is_pereira() -> None:
    exponent = 1.094
    level = float(np.log(pereira_force(1e-3, 30e-3, 1.0, STEEL, False)) - exponent * np.log(1e-3))
    for depth in DEPTHS:
        found = power_law(depth, level, exponent)
        assert found[0] == pytest.approx(pereira_force(depth, 30e-3, 1.0, STEEL, False))
        step = 1e-5
        up, down = (power_law(depth * (1.0 + s * step), level, exponent) for s in (1, -1))
        assert (up[2] - down[2]) / (2.0 * step * depth) == pytest.approx(found[0], rel=1e-7)
        up, down = (power_law(depth, level, exponent + s * step) for s in (1, -1))
        assert (up[2] - down[2]) / (2.0 * step) == pytest.approx(found[4], rel=1e-6)


def test_onset_is_smooth() -> None:
    """Value, slope and bend meet at both ends and are each other's derivatives."""
    onset = 0.4e-6
    assert rounded_depth(-onset, onset) == (0.0, 0.0, 0.0)
    assert rounded_depth(onset, onset) == (onset, 1.0, 0.0)
    near = rounded_depth(onset * (1.0 - 1e-9), onset)
    assert near[:2] == pytest.approx((onset, 1.0), rel=1e-8)
    x = np.linspace(-1.2, 1.2, 2401) * onset
    rows = np.array([rounded_depth(float(v), onset) for v in x])
    scale = x[1] - x[0]
    assert np.gradient(rows[:, 0], scale) == pytest.approx(rows[:, 1], abs=2e-3)
    assert np.gradient(rows[:, 1], scale) * onset == pytest.approx(rows[:, 2] * onset, abs=3e-3)


@pytest.mark.parametrize(("other", "millimetres"), [(50e-3, 9.945), (-50e-3, 7.055)])
def test_bodies_deform_no_deeper_than_they_are_held(other: float, millimetres: float) -> None:
    """A lobe of 8.5 mm, both held 8.5 mm below the contact: 8.5 (1 +- 8.5/50) mm."""
    assert hertz_scale(8.5e-3, other, 8.5e-3) == pytest.approx(1e-3 * millimetres)
    assert hertz_scale(other, 8.5e-3, 8.5e-3) == pytest.approx(1e-3 * millimetres)
