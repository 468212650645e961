"""Mixed-lubrication sweep of the reference motor's bearing against the published fit."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from toothspace.closures.journal_friction import PUBLISHED_CURVE
from toothspace.films import save_friction_table
from toothspace.validation.published_films import pawar_sweep


@pytest.mark.parametrize("cavitation", ["jfo", "reynolds"])
def test_film_of_the_reference_design_has_the_published_friction(
    cavitation: str, tmp_path: Path
) -> None:
    """Load of Table 2; at every point, not at the ends and the minimum alone."""
    numbers = np.geomspace(0.001, 0.2, 16)
    sweep = pawar_sweep(numbers, cavitation=cavitation)
    curve = save_friction_table(sweep, tmp_path / "friction.csv")
    table = np.loadtxt(tmp_path / "friction.csv", delimiter=",")
    np.testing.assert_allclose(table[:, 1], sweep.friction_coefficient, rtol=1e-5)
    assert sweep.converged
    assert np.all(np.diff(sweep.contact_share) <= 1e-12)
    np.testing.assert_allclose(sweep.friction_coefficient, PUBLISHED_CURVE(numbers), rtol=0.2)
    fitted = curve(numbers) / sweep.friction_coefficient
    assert np.abs(np.log(fitted)).max() < 0.15
