"""Finite journal bearing in pure rotation and pure squeeze."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.validation.claim import rows_of
from toothspace.validation.published_films import SPEED, butenschoen_bearing


def _rows(name: str, largest: float) -> list[dict[str, float]]:
    rows = rows_of("butenschoen_1976", name)
    numbers = [{key: float(text) for key, text in row.items()} for row in rows]
    return [row for row in numbers if abs(row["eps"]) <= largest]


@pytest.mark.parametrize(
    "row", _rows("rotation.csv", 0.9), ids=lambda r: f"{r['B_over_D']}-{r['eps']}"
)
def test_rotation(row: dict[str, float]) -> None:
    bearing = butenschoen_bearing(row["B_over_D"])
    film = bearing.solve(eccentricity=(row["eps"], 0.0), shaft_speed=SPEED)
    flow = film.side_flow / ((0.5 * bearing.diameter) ** 2 * bearing.radial_clearance * SPEED)
    assert film.sommerfeld_number_din == pytest.approx(row["So"], rel=0.007)
    assert np.degrees(film.attitude_angle) == pytest.approx(row["beta_deg"], abs=0.15)
    assert flow == pytest.approx(row["Q"], rel=0.005)


@pytest.mark.parametrize(
    "row", _rows("squeeze.csv", 0.9)[::3], ids=lambda r: f"{r['B_over_D']}-{r['eps']}"
)
def test_squeeze(row: dict[str, float]) -> None:
    rate = 200.0
    bearing = butenschoen_bearing(row["B_over_D"])
    velocity = (rate * bearing.radial_clearance, 0.0)
    film = bearing.solve(eccentricity=(row["eps"], 0.0), shaft_speed=0.0, velocity=velocity)
    ratio = 2 * bearing.radial_clearance / bearing.diameter
    mean = film.load / (bearing.diameter * bearing.length)
    assert mean * ratio**2 / (bearing.dynamic_viscosity * rate) == pytest.approx(
        row["So"], rel=0.007
    )
    flow = film.side_flow / ((0.5 * bearing.diameter) ** 3 * ratio * rate)
    assert flow == pytest.approx(row["Q"], rel=0.025)
    assert film.force[0] < 0.0
