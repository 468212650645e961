"""Mid-plane pressure of a heavily loaded journal bearing at high speed, viscosity of Barus."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.validation.claim import rows_of
from toothspace.validation.published_films import comsol_film

ROWS = rows_of("comsol_journal")


@pytest.mark.parametrize("cavitation", ["jfo", "reynolds", "guembel"])
def test_pressure_in_the_mid_plane(cavitation: str) -> None:
    film = comsol_film(cavitation=cavitation)
    assert film.status.succeeded
    angle = np.array([float(row["phi_deg"]) for row in ROWS])
    published = 1e5 * np.array([float(row["p_bar"]) for row in ROWS])
    found = np.interp(angle, np.degrees(film.angle), film.pressure[:, 10], period=360.0)
    assert found == pytest.approx(published, abs=0.07 * published.max())
    assert film.pressure.max() == pytest.approx(published.max(), rel=0.05)
