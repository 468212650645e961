"""Finite journal bearing in pure rotation and pure squeeze."""

from __future__ import annotations

import csv

import numpy as np
import pytest

from toothspace.films import JournalBearing
from toothspace.validation.claim import data_file

DIAMETER, CLEARANCE, VISCOSITY = 0.1, 50e-6, 0.01


def _rows(name: str, largest: float) -> list[dict[str, float]]:
    rows = csv.DictReader(data_file("butenschoen_1976", name).read_text().splitlines())
    numbers = [{key: float(text) for key, text in row.items()} for row in rows]
    return [row for row in numbers if abs(row["eps"]) <= largest]


def _bearing(row: dict[str, float]) -> JournalBearing:
    return JournalBearing(
        diameter=DIAMETER,
        length=DIAMETER * row["B_over_D"],
        radial_clearance=CLEARANCE,
        dynamic_viscosity=VISCOSITY,
        grid=(240, 31),
        cavitation="reynolds",
    )


@pytest.mark.parametrize(
    "row", _rows("rotation.csv", 0.9), ids=lambda r: f"{r['B_over_D']}-{r['eps']}"
)
def test_rotation(row: dict[str, float]) -> None:
    speed = 100.0
    film = _bearing(row).solve(eccentricity=(row["eps"], 0.0), shaft_speed=speed)
    flow = film.side_flow / ((DIAMETER / 2) ** 3 * 2 * CLEARANCE / DIAMETER * speed)
    assert film.sommerfeld_number_din == pytest.approx(row["So"], rel=0.007)
    assert np.degrees(film.attitude_angle) == pytest.approx(row["beta_deg"], abs=0.15)
    assert flow == pytest.approx(row["Q"], rel=0.005)


@pytest.mark.parametrize(
    "row", _rows("squeeze.csv", 0.9)[::3], ids=lambda r: f"{r['B_over_D']}-{r['eps']}"
)
def test_squeeze(row: dict[str, float]) -> None:
    rate = 200.0
    bearing = _bearing(row)
    film = bearing.solve(
        eccentricity=(row["eps"], 0.0), shaft_speed=0.0, velocity=(rate * CLEARANCE, 0.0)
    )
    ratio = 2 * CLEARANCE / DIAMETER
    mean = film.load / (bearing.diameter * bearing.length)
    assert mean * ratio**2 / (VISCOSITY * rate) == pytest.approx(row["So"], rel=0.007)
    flow = film.side_flow / ((DIAMETER / 2) ** 3 * ratio * rate)
    assert flow == pytest.approx(row["Q"], rel=0.025)
    assert film.force[0] < 0.0
