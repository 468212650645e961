"""Asperities round a journal: their sums against quadrature, and the curve through their table."""

from __future__ import annotations

import numpy as np
import pytest
from scipy.integrate import quad

from toothspace.closures.contact_rough import asperity_pressure
from toothspace.model.lumped_films import _asperity_integrals, _spline

CLEARANCE, ROUGH = 10e-6, (0.5e-6, 8e-6, 2.2e11, 1.5e9)
"""Radial clearance; roughness, correlation length, modulus, hardness. [m, m, m, Pa, Pa]"""


@pytest.mark.parametrize("ratio", [0.0, 0.9, 1.0])
def test_forces_of_asperities_are_the_integrals_of_their_pressure(ratio: float) -> None:
    """A journal in the middle has none, one at the wall is pressed along its eccentricity."""
    force, load = np.zeros((2, 1))
    _asperity_integrals(np.array([ratio]), CLEARANCE, *ROUGH, force, load)

    def pressure(angle: float) -> float:
        height = CLEARANCE * (1.0 - ratio * np.cos(angle))
        return float(asperity_pressure(height, *ROUGH)) if height <= 4.0 * ROUGH[0] else 0.0

    # up to the angle at which walls are four roughness heights apart
    end = np.arccos(np.clip((1.0 - 4.0 * ROUGH[0] / CLEARANCE) / max(ratio, 1e-9), -1.0, 1.0))
    end = end if ratio > 0.0 else 0.0
    along, _ = quad(lambda angle: pressure(angle) * np.cos(angle), -end, end)
    whole, _ = quad(pressure, -end, end)
    assert force[0] == pytest.approx(along, rel=1e-3, abs=1e-12)
    assert load[0] == pytest.approx(whole, rel=1e-3, abs=1e-12)
    assert (load[0] > force[0] > 0.0) == (ratio > 0.85)


def test_a_curve_through_a_table_is_monotone_and_keeps_straight_lines() -> None:
    def through(values: list[float], places: np.ndarray) -> np.ndarray:
        part = np.minimum(places.astype(int), len(values) - 2)
        rest = places - part
        rows = _spline(np.array(values))[part]
        return np.asarray(sum(rows[:, k] * rest**k for k in range(4)))

    places = np.linspace(0.0, 4.0, 81)
    # it begins level, as a table that is zero at first
    assert through([0.0, 1.0, 2.0, 3.0, 4.0], places)[20:] == pytest.approx(places[20:], rel=1e-12)
    steep = through([0.0, 0.0, 1.0, 5.0, 6.0], places)
    assert np.all(np.diff(steep) >= -1e-12)
    # harmonic mean of the steps 1 and 4 in the middle node
    slope = (through([0.0, 0.0, 1.0, 5.0, 6.0], np.array([2.0, 2.0 + 1e-7])) @ [-1.0, 1.0]) / 1e-7
    assert slope == pytest.approx(1.6, rel=1e-5)
