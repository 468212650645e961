"""Full journal bearing against converged solutions of the case of Raimondi and Boyd."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.validation.claim import rows_of
from toothspace.validation.published_films import raimondi_bearing

ROWS = rows_of("raimondi_boyd_1958")


@pytest.mark.parametrize("cavitation", ["reynolds", "jfo"])
@pytest.mark.parametrize(
    "row", ROWS, ids=lambda r: f"{r['length_over_diameter']}-{r['eccentricity_ratio']}"
)
def test_load_attitude_and_pressure(row: dict[str, str], cavitation: str) -> None:
    value = {key: float(text) for key, text in row.items()}
    bearing = raimondi_bearing(value["length_over_diameter"], cavitation=cavitation)
    film = bearing.solve(eccentricity=(value["eccentricity_ratio"], 0.0), shaft_speed=200.0)
    mean = film.load / (bearing.diameter * bearing.length)
    peak = film.max_pressure - bearing.cavitation_pressure
    assert film.sommerfeld_number == pytest.approx(value["sommerfeld_number"], rel=0.007)
    assert np.degrees(film.attitude_angle) == pytest.approx(value["attitude_angle_deg"], abs=0.1)
    assert mean / peak == pytest.approx(value["pressure_ratio"], rel=0.007)
    if cavitation == "reynolds":
        friction = -film.friction_torque / (0.5 * bearing.diameter * film.load)
        scaled = friction * 0.5 * bearing.diameter / bearing.radial_clearance
        assert scaled == pytest.approx(value["friction"], rel=0.007)
