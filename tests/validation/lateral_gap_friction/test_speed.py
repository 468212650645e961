"""What shaft speed changes under the bearing of the fuel pump: chambers first, films second."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from toothspace.case import Case, load_case
from toothspace.core.status import Status
from toothspace.floating.problem import lateral_problem
from toothspace.model.floating_bearing import HousingContact
from toothspace.studies.bearing_path import solve_path
from toothspace.studies.bearing_points import LateralPoints, PointCondition, prepare

CASES = Path(__file__).parents[3] / "cases"
FAST, SLOW = 4675.0, 2550.0
TELL = 0.05e-6


def _nose_case() -> Case:
    """Case with its outlet at 55 degrees, where speed decides how many spaces hold pressure."""
    case = load_case(CASES / "nose_pressure.toml", ["machine.casing.outlet_angle=55 deg"])
    return replace(case, run=replace(case.run, film_grid=(84, 10), film_angles_per_pitch=4))


def _filled(points: LateralPoints, case: Case, speed: float) -> xr.Dataset:
    """Chambers at OC1 or OC2."""
    assert case.operating_point is not None
    condition = PointCondition(
        label="",
        outlet_pressure=29.1e5,
        inlet_pressure=case.operating_point.inlet_pressure,
        shaft_speed=speed * np.pi / 30.0,
    )
    return points.lumped(condition)(points.run.machine).data


def _opening(points: LateralPoints, chambers: xr.Dataset, film: float) -> float:
    """Force of the films on the bearing at 2 um, whatever speed filled the chambers. [N]."""
    speed = chambers["shaft_speed"] * 0.0 + film * np.pi / 30.0
    data, run = chambers.assign(shaft_speed=speed), points.run
    problem = lateral_problem(run.machine, run.fluid, data, points.settings)
    return float(np.mean([s.film_force()[0] for s in problem.started(2e-6).states]))


@pytest.mark.validation
@pytest.mark.slow
def test_chambers_and_not_films_make_the_bearing_depend_on_speed() -> None:
    case = _nose_case()
    points = prepare(case, HousingContact(friction_coefficient=1.0))
    slowly, quickly = _filled(points, case, SLOW), _filled(points, case, FAST)
    slow, fast = _opening(points, slowly, SLOW), _opening(points, quickly, FAST)
    assert fast < slow - 300.0
    assert abs(_opening(points, slowly, FAST) - slow) < 0.15 * abs(fast - slow)
    assert abs(_opening(points, quickly, SLOW) - fast) < 0.15 * abs(fast - slow)


@pytest.mark.validation
@pytest.mark.slow
def test_claims_about_nose_and_speed_on_the_shipped_case() -> None:
    """Low pressure fast, low pressure slow, high pressure fast, five nose pressures each.

    Against the source, friction holds the bearing at low pressure, and high pressure moves it
    (claim ``fuel_pump_nose`` of the validation book, which fails).
    """
    study = solve_path(load_case(CASES / "nose_pressure.toml"))
    assert study.status is Status.DONE
    fast, slow, high = np.array([p.numbers.position for p in study.points]).reshape(3, 5)
    held = np.reshape(study.held_by_friction, (3, 5))
    assert held[:2].all()
    assert np.ptp(fast) < TELL
    assert np.ptp(slow) < TELL
    assert not held[2].any()
    # the nose presses it towards the gears
    assert high[-1] < high[0] - TELL
