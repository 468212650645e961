"""Lumped run with reduced lateral films against the elastic run that they were reduced from."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest

from toothspace import api
from toothspace.case import load_case
from toothspace.core.status import Status
from toothspace.studies.reduce import reduce_films

CASES = Path(__file__).parents[2] / "cases"


@pytest.mark.slow
def test_reduced_films_give_load_leakage_and_torque_of_the_elastic_run(tmp_path: Path) -> None:
    # tables of one speed hold for films of one temperature
    case = load_case(CASES / "egm12_motor_reduced.toml", ["heat.model=network"])
    plain = replace(
        case.run,
        film_tables=None,
        film_grid=(84, 12),
        film_steps_per_revolution=36,
        samples_per_revolution=180,
    )
    tables = reduce_films(replace(case, run=plain), ["lateral"])
    assert bool(tables["lateral_converged"].all())
    tables.to_netcdf(tmp_path / "films.nc", engine="h5netcdf")
    reduced = api.simulate(replace(case, run=replace(plain, film_tables=tmp_path / "films.nc")))
    elastic = api.simulate(replace(case, run=replace(plain, fidelity="elastic")))
    assert reduced.status is Status.DONE
    assert elastic.status is Status.DONE
    found, wanted = reduced.summary(), elastic.summary()
    # the load within 1 % of the force of the balanced area, 1400 mm2 at 199 bar
    assert found["axial_load_N"] == pytest.approx(wanted["axial_load_N"], abs=0.01 * 27.9e3)
    leakage = found["leakage_lateral_L_per_min"] + found["leakage_drain_L_per_min"]  # type: ignore[operator]
    # three agreements within 2 % each: films and chambers of table, elastic run and reduced run
    within = 1.02**3 - 1.0
    assert leakage == pytest.approx(wanted["lateral_leakage_L_per_min"], rel=within)
    torque = _faces(found)
    assert torque == pytest.approx(wanted["lateral_torque_N_m"], rel=within)
    # at two thirds of the speed thinner films and asperities leave more than two thirds of it
    slower = replace(case.operating_point, shaft_speed=case.operating_point.shaft_speed / 1.5)
    runs = [
        api.simulate(replace(case, operating_point=slower, run=replace(plain, **changes)))
        for changes in ({"film_tables": tmp_path / "films.nc"}, {"fidelity": "elastic"})
    ]
    found, wanted = (run.summary() for run in runs)
    left = _faces(found)
    assert left == pytest.approx(wanted["lateral_torque_N_m"], rel=0.15)
    assert 0.6 * torque < left < torque


def _faces(numbers) -> float:
    parts = ("viscous", "asperity")
    return sum(numbers[f"torque_loss_lateral_{part}_N_m"] for part in parts)
