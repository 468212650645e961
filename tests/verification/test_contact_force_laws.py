"""Elastic laws of line contacts against plane strain finite elements of one lobe pair.

The oracle clamps both bodies at a depth of one lobe radius below the contact; approach is that
of the clamped bases, as the laws count it.
"""

from __future__ import annotations

from functools import cache

import numpy as np
import pytest

from tests.plane_contact import lobe_in_groove
from tests.reference_formulas.cylinder_contact import hertz_half_width
from toothspace.closures.contact_cylindrical import pereira_force
from toothspace.closures.contact_law import hertz_scale, johnson_scale, logarithmic_law

STEEL = 206e9 / (2.0 * (1.0 - 0.3**2))
LOBE = 8.5e-3
APPROACH = np.array([1e-6, 4e-6])


@cache
def oracle(other: float) -> np.ndarray:
    """Load over the approach of a lobe and a groove or second lobe of this radius."""
    return lobe_in_groove(LOBE, other, (LOBE, LOBE), APPROACH)


def line_loads(scale: float) -> np.ndarray:
    level = float(np.log(scale))
    return np.array([logarithmic_law(float(d), level, STEEL)[0] for d in APPROACH])


@pytest.mark.parametrize(
    "other",
    [*(pytest.param(one, marks=pytest.mark.slow) for one in (-9.5e-3, -12e-3, -50e-3)), 20e-3],
)
def test_hertz_line_against_finite_elements(other: float) -> None:
    """Within 6 %: lobe in narrow and wide grooves, and on a second lobe."""
    found = line_loads(float(hertz_scale(LOBE, other, LOBE)))
    assert found == pytest.approx(oracle(other), rel=0.06)


@pytest.mark.slow
def test_johnson_and_pereira_against_finite_elements() -> None:
    """Within 10 % in a groove of similar radius; in a flat one both are far too soft."""
    johnson = line_loads(float(johnson_scale(LOBE, -9.5e-3)))
    assert johnson == pytest.approx(oracle(-9.5e-3), rel=0.10)
    pereira = pereira_force(APPROACH, 1e-3, 1.0, STEEL, True)
    assert pereira == pytest.approx(oracle(-9.5e-3), rel=0.10)
    assert np.all(line_loads(float(johnson_scale(LOBE, -50e-3))) < 0.86 * oracle(-50e-3))


def test_oracle_is_hertzian() -> None:
    """Far from the bases: load grows by the closed form of the half width, K. L. Johnson 4.2."""
    load = oracle(20e-3)
    relative = LOBE * 20e-3 / (LOBE + 20e-3)
    half_width = hertz_half_width(load, relative, STEEL)
    stiffness = np.diff(load) / np.diff(APPROACH)
    mean = np.pi * STEEL / (2.0 * np.log(4.0 * LOBE / half_width.mean()) - 1.0)
    assert stiffness == pytest.approx(mean, rel=0.15)
