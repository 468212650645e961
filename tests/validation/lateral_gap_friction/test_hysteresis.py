"""Loops of the floating bearing of the fuel pump; the book judges their films and its claims."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from toothspace.case import load_case
from toothspace.core.status import Status
from toothspace.studies.bearing_path import HysteresisStudy, loop_area, solve_path
from toothspace.studies.bearing_points import LateralStudy

CASES = Path(__file__).parents[3] / "cases"
GRID = "run.film_grid=[105, 15]", "run.film_angles_per_pitch=4"
REST = 1e-9


def _study(**changes: object) -> LateralStudy:
    case = load_case(CASES / "hysteresis_078.toml", GRID)
    assert isinstance(case.study, HysteresisStudy)
    return solve_path(replace(case, study=replace(case.study, **changes)))  # type: ignore[arg-type]


@pytest.mark.validation
@pytest.mark.slow
def test_bearing_stays_higher_on_the_way_down_and_the_loop_closes_without_friction() -> None:
    study = _study()
    assert study.status is Status.DONE
    # bodies bend: films grow where the rigid face hardly moves
    films = [float(np.mean(point.numbers.gaps)) for point in study.points]
    position = np.array([point.numbers.position for point in study.points])
    top = len(position) // 2
    assert np.all(np.diff(films[: top + 1]) >= 0.05e-6)
    up, down = position[: top + 1], position[top:][::-1]
    assert up[-1] > up[0] + 1e-6
    assert np.all(down >= up - REST)
    assert (down - up).max() > 0.1e-6
    for point in study.points:
        assert point.residual < 1e-6
        assert point.numbers.hold_down_force > 0.0
    rubbed, free = loop_area(study), loop_area(_study(friction_coefficient=0.0))
    assert rubbed > 0.0
    assert abs(free) < 0.02 * rubbed
