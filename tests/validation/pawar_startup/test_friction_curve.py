"""Mixed-lubrication sweep of the reference motor's bearing against the published fit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from toothspace.closures.journal_friction import PUBLISHED_CURVE
from toothspace.films import JournalBearing, RoughSurfaces, save_friction_table, sweep_friction


@pytest.mark.parametrize(
    ("shaft", "bush", "cavitation"),
    [
        (0.15e-6, 0.3e-6, "jfo"),  # roughness of the reference design
        (0.15e-6, 0.3e-6, "reynolds"),
        (0.1e-6, 0.2e-6, "reynolds"),
    ],
)
def test_boundary_level_minimum_and_slope(
    shaft: float, bush: float, cavitation: str, tmp_path: Path
) -> None:
    bearing = JournalBearing(
        diameter=18e-3,
        length=19e-3,
        radial_clearance=8.6e-4 * 9e-3,
        dynamic_viscosity=0.026,
        grid=(144, 15),
        cavitation=cavitation,
        surfaces=RoughSurfaces(
            moving_roughness=shaft,
            resting_roughness=bush,
            correlation_length=15e-6,
            effective_modulus=50e9,
            hardness=0.3e9,
            boundary_friction=0.0455,
        ),
    )
    numbers = np.geomspace(0.001, 0.2, 16)
    sweep = sweep_friction(bearing, load=3000.0, sommerfeld_numbers=numbers)
    curve = save_friction_table(sweep, tmp_path / "friction.csv")
    table = np.loadtxt(tmp_path / "friction.csv", delimiter=",")
    np.testing.assert_allclose(table[:, 1], sweep.friction_coefficient, rtol=1e-5)
    assert sweep.converged
    assert np.all(np.diff(sweep.contact_share) <= 1e-12)
    assert curve.boundary_level == pytest.approx(PUBLISHED_CURVE.boundary_level, rel=0.2)
    assert curve.minimum()[1] == pytest.approx(PUBLISHED_CURVE.minimum()[1], rel=0.2)
    assert curve.full_film_slope() == pytest.approx(PUBLISHED_CURVE.full_film_slope(), rel=0.2)
    fitted = curve(numbers) / sweep.friction_coefficient
    assert np.abs(np.log(fitted)).max() < 0.15
