"""Mid-plane pressure of a heavily loaded journal bearing at high speed, viscosity of Barus."""

from __future__ import annotations

import csv

import numpy as np
import pytest

from toothspace.films import Groove, JournalBearing
from toothspace.validation.claim import data_file

ROWS = list(csv.DictReader(data_file("comsol_journal").read_text().splitlines()))
LOAD, SPEED = 40e3, 10000.0 * np.pi / 30.0


@pytest.mark.parametrize("cavitation", ["jfo", "reynolds", "guembel"])
def test_pressure_in_the_mid_plane(cavitation: str) -> None:
    bearing = JournalBearing(
        diameter=0.2,
        length=0.067,
        radial_clearance=200e-6,
        dynamic_viscosity=0.075,
        pressure_viscosity=25e-9,
        grid=(180, 21),
        cavitation=cavitation,
        grooves=tuple(Groove(angle, np.radians(10.0), 0.067, 0.0) for angle in (0.0, np.pi)),
        end_pressure=0.0,
        cavitation_pressure=0.0,
    )
    film = bearing.equilibrium(load=(0.0, -LOAD), shaft_speed=SPEED)
    assert film.status.succeeded
    angle = np.array([float(row["phi_deg"]) for row in ROWS])
    published = 1e5 * np.array([float(row["p_bar"]) for row in ROWS])
    found = np.interp(angle, np.degrees(film.angle), film.pressure[:, 10], period=360.0)
    assert found == pytest.approx(published, abs=0.07 * published.max())
    assert film.pressure.max() == pytest.approx(published.max(), rel=0.05)
