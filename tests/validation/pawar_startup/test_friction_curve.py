"""Mixed-lubrication sweep of the reference motor's bearing against the published fit."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.films import JournalBearing, RoughSurfaces, fit_friction_curve, sweep_friction
from toothspace.films.mixed_lubrication import PUBLISHED_CURVE


def test_boundary_level_minimum_and_slope() -> None:
    bearing = JournalBearing(
        diameter=18e-3,
        length=19e-3,
        radial_clearance=8.6e-4 * 9e-3,
        dynamic_viscosity=0.026,
        grid=(144, 15),
        cavitation="reynolds",
        surfaces=RoughSurfaces(
            moving_roughness=0.1e-6,
            resting_roughness=0.2e-6,
            correlation_length=15e-6,
            effective_modulus=50e9,
            hardness=0.3e9,
            boundary_friction=0.0455,
        ),
    )
    numbers = np.geomspace(0.001, 0.2, 16)
    sweep = sweep_friction(bearing, load=3000.0, sommerfeld_numbers=numbers)
    curve = fit_friction_curve(sweep.sommerfeld_number, sweep.friction_coefficient)
    assert sweep.converged
    assert np.all(np.diff(sweep.contact_share) <= 1e-12)
    assert curve.boundary_level == pytest.approx(PUBLISHED_CURVE.boundary_level, rel=0.2)
    assert curve.minimum()[1] == pytest.approx(PUBLISHED_CURVE.minimum()[1], rel=0.2)
    assert curve.full_film_slope() == pytest.approx(PUBLISHED_CURVE.full_film_slope(), rel=0.2)
    fitted = curve(numbers) / sweep.friction_coefficient
    assert np.abs(np.log(fitted)).max() < 0.15
