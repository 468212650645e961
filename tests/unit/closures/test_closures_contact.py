"""Contact laws of cylinders against each other and hand calculation."""

from __future__ import annotations

import math

import numpy as np
import pytest

from tests.reference_formulas.cylinder_contact import hertz_half_width, johnson_line_load
from toothspace.closures.contact_cylindrical import (
    hertz_pressure,
    in_pereira_range,
    pereira_force,
)
from toothspace.closures.contact_law import impact_damping, impact_factor
from toothspace.core.compiled import njit

STEEL = 206e9 / (2.0 * (1.0 - 0.3**2))


@pytest.mark.parametrize(
    ("difference", "expected"), [(5e-3, 1.04), (10e-3, 0.94), (20e-3, 0.91), (40e-3, 0.92)]
)
def test_external_pereira_against_johnson(difference: float, expected: float) -> None:
    """Johnson (1985), steel, indentation 0.1 to 10 um: mean ratio over the range."""
    depth = np.geomspace(0.1e-6, 10e-6, 21)
    pereira = pereira_force(depth, difference, 1.0, STEEL, False)
    johnson = [johnson_line_load(d, difference, STEEL) for d in depth]
    assert np.mean(pereira / johnson) == pytest.approx(expected, abs=0.03)


@pytest.mark.parametrize("difference", [0.05e-3, 0.2e-3, 1e-3])
def test_internal_pereira_against_johnson(difference: float) -> None:
    """Johnson (1985): ratio 0.83 to 1.15 for differences of 0.05 to 1 mm."""
    depth = np.geomspace(0.1e-6, min(10e-6, 0.05 * difference), 21)
    johnson = [johnson_line_load(d, difference, STEEL) for d in depth]
    ratio = pereira_force(depth, difference, 1.0, STEEL, True) / johnson
    assert ratio.min() > 0.78
    assert ratio.max() < 1.2


@pytest.mark.parametrize(
    ("millimetres", "exponent"),
    [(0.7, 1.51 * math.log(700.0) ** -0.151), (0.8, 0.0151 * 0.8 + 1.151), (5.0, 1.2265)],
)
def test_the_internal_law_stiffens_with_the_exponent_of_its_range(
    millimetres: float, exponent: float
) -> None:
    """The logarithm of the force rises by n = Y dR^-0.005 with that of the indentation."""
    forces = [
        float(pereira_force(depth, millimetres * 1e-3, 20e-3, 1.15e11, internal=True))
        for depth in (2e-6, 8e-6)
    ]
    found = math.log(forces[1] / forces[0]) / math.log(4.0)
    assert found == pytest.approx(exponent * millimetres**-0.005, rel=1e-9)


@pytest.mark.parametrize(("millimetres", "stiffness"), [(0.2, 0.2895), (2.0, 2.0265)])
def test_the_internal_law_by_hand(millimetres: float, stiffness: float) -> None:
    """One millimetre deep (any power of it is one): (0.965 dR + 0.0965) L E*/dR."""
    found = pereira_force(1e-3, 1e-3 * millimetres, 7.5e-3, STEEL, True)
    assert found == pytest.approx(stiffness / millimetres * 7.5 * 1e-6 * STEEL)


def test_pereira_does_not_depend_on_units() -> None:
    """By hand in mm, N, N/mm2: (0.39*10 + 0.85) * 7.5 * E* / 10 * 0.001^1.094."""
    hand = (0.39 * 10 + 0.85) * 7.5 * (STEEL / 1e6) / 10 * 0.001**1.094
    assert pereira_force(1e-6, 10e-3, 7.5e-3, STEEL, False) == pytest.approx(hand)


@pytest.mark.parametrize(
    ("millimetres", "allowed"),
    [(0.004, False), (0.0051, True), (5.0, True), (9.9, True), (10.1, False)],
)
def test_range_of_the_internal_law(millimetres: float, allowed: bool) -> None:
    assert in_pereira_range(1e-3 * millimetres, True) is allowed


def test_the_external_law_asks_for_a_nanometre_of_difference() -> None:
    assert [in_pereira_range(1e-9 * part, False) for part in (0.95, 1.05, 1e9)] == [
        False,
        True,
        True,
    ]


def test_hertz() -> None:
    """Half width and pressure carry the load: q = pi b p0 / 2."""
    load, radius = 88e3, 4e-3
    width = hertz_half_width(load, radius, STEEL)
    assert 0.5 * np.pi * width * hertz_pressure(load, radius, STEEL) == pytest.approx(load)
    assert width == pytest.approx(2.0 * np.sqrt(load * radius / (np.pi * STEEL)))


def test_impact_damping() -> None:
    """Three quarters of what the restitution loses at the speed of first touch; no pull."""
    damping = impact_damping(0.8, 0.1)
    assert impact_factor(0.1, damping) == pytest.approx(1.0 + 0.75 * 0.36)
    assert impact_factor(0.0, damping) == 1.0
    assert impact_factor(-1.0, damping) == 0.0
    assert impact_damping(1.0, 0.1) == 0.0


@njit
def _compiled(depth: float) -> tuple[float, float]:
    return (
        pereira_force(depth, 1e-3, 1.0, STEEL, True),
        impact_factor(0.1, impact_damping(0.8, 0.2)),
    )


def test_compiled_contact_equals_python() -> None:
    assert _compiled(2e-6) == pytest.approx(_compiled.py_func(2e-6), rel=1e-12)
