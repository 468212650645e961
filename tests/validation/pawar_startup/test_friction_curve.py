"""Mixed-lubrication sweep of the reference motor's bearing against the published fit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from toothspace.closures.journal_friction import PUBLISHED_CURVE
from toothspace.films import JournalBearing, RoughSurfaces, save_friction_table, sweep_friction


@pytest.mark.parametrize("cavitation", ["jfo", "reynolds"])
def test_film_of_the_reference_design_has_the_published_friction(
    cavitation: str, tmp_path: Path
) -> None:
    """Load of Table 2; at every point, not at the ends and the minimum alone."""
    bearing = JournalBearing(
        diameter=18e-3,
        length=19e-3,
        radial_clearance=9e-6,
        dynamic_viscosity=0.026,
        grid=(144, 15),
        cavitation=cavitation,
        surfaces=RoughSurfaces(
            moving_roughness=0.13e-6,
            resting_roughness=0.27e-6,
            correlation_length=15e-6,
            effective_modulus=50e9,
            hardness=0.3e9,
            boundary_friction=0.05,
        ),
    )
    numbers = np.geomspace(0.001, 0.2, 16)
    sweep = sweep_friction(bearing, load=5500.0, sommerfeld_numbers=numbers)
    curve = save_friction_table(sweep, tmp_path / "friction.csv")
    table = np.loadtxt(tmp_path / "friction.csv", delimiter=",")
    np.testing.assert_allclose(table[:, 1], sweep.friction_coefficient, rtol=1e-5)
    assert sweep.converged
    assert np.all(np.diff(sweep.contact_share) <= 1e-12)
    np.testing.assert_allclose(sweep.friction_coefficient, PUBLISHED_CURVE(numbers), rtol=0.2)
    fitted = curve(numbers) / sweep.friction_coefficient
    assert np.abs(np.log(fitted)).max() < 0.15
