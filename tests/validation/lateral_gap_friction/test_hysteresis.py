"""Claims about the floating bearing of the fuel pump, on the shipped cases."""

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
REST = 1e-9


def _study(name: str, **changes: object) -> LateralStudy:
    case = load_case(CASES / f"{name}.toml")
    assert isinstance(case.study, HysteresisStudy)
    return solve_path(replace(case, study=replace(case.study, **changes)))  # type: ignore[arg-type]


def _ways(study: LateralStudy) -> tuple[np.ndarray, np.ndarray]:
    """Positions on the way up, and on the way down at the same pressures. [m]."""
    position = np.array([point.numbers.position for point in study.points])
    top = len(position) // 2
    return position[: top + 1], position[top:][::-1]


@pytest.mark.validation
@pytest.mark.slow
@pytest.mark.parametrize("name", ["hysteresis_055", "hysteresis_078"])
def test_bearing_rises_and_stays_higher_on_the_way_down(name: str) -> None:
    study = _study(name)
    assert study.status is Status.DONE
    # bodies bend: films grow where the rigid face hardly moves
    films = [float(np.mean(point.numbers.gaps)) for point in study.points]
    assert np.all(np.diff(films[: len(films) // 2 + 1]) >= 0.05e-6)
    up, down = _ways(study)
    assert up[-1] > up[0] + 1e-6
    assert np.all(down >= up - REST)
    assert (down - up).max() > 0.1e-6
    assert loop_area(study) > 0.0
    for point in study.points:
        assert point.residual < 1e-6
        assert point.numbers.hold_down_force > 0.0


@pytest.mark.validation
@pytest.mark.slow
def test_loop_closes_without_friction() -> None:
    rubbed = loop_area(_study("hysteresis_078"))
    free = loop_area(_study("hysteresis_078", friction_coefficient=0.0))
    assert abs(free) < 0.02 * rubbed
