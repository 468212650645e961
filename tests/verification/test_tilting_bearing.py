"""Bearing and gears of the fuel pump that lift and tilt freely and find their equilibrium."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from toothspace.api import prepare
from toothspace.case import load_case
from toothspace.floating.equilibrium import Equilibrium
from toothspace.floating.problem import LateralProblem, lateral_problem
from toothspace.floating.stack import leaning, rim_levers
from toothspace.run.elastic import lateral_settings

CASE = Path(__file__).parents[2] / "cases" / "hysteresis_055.toml"
WALL = 1e6
DISTANCE = 63.06e-3

pytestmark = [pytest.mark.verification, pytest.mark.slow]


def _problem(*changes: str, file: Path = CASE) -> LateralProblem:
    given = [
        'run.fidelity="elastic"',
        "run.deformation=winkler",  # alike on both sides of a gear, as bodies that bend are not
        "run.max_revolutions=3",
        'machine.floating_bearing.motion="full"',
        f'machine.floating_bearing.wall_stiffness="{WALL} N m/rad"',
        'machine.floating_bearing.shaft_stiffness="0 N m/rad"',
        'operating_point.outlet_pressure="38.8 bar"',
    ]
    case = load_case(file, [*given, *changes])
    run = prepare(case).worn().with_films()
    data = run.march().data
    settings = replace(lateral_settings(case), grid=(84, 10), angles=2)
    return lateral_problem(run.machine, run.fluid, data, settings)


def _moment(problem: LateralProblem, found: Equilibrium) -> float:
    """Mean moment about y of films, back and springs on the bearing. [N m]."""
    back = problem.loads.back
    forces = [s.film_force() + s.back_force(back) for s in found.balance.states]
    return float(np.mean(forces, axis=0)[2])


def test_bearing_leans_on_the_wall_and_gears_stand_between_equal_films() -> None:
    """Two alike films on both sides of a gear leave it halfway between the bearings, tilt included.

    Pressure behind it acts nearer to the outlet than that of the films, so the bearing opens
    towards the inlet (positive about y); it stands higher over the driven gear (positive about x).
    """
    problem = _problem()
    found = problem.settle(problem.started(2e-6))
    q = found.balance.position
    assert found.settled
    assert found.balance.residual < 1e-6
    bearing, drive, driven = q[:3], q[3:6], q[6:9]
    assert drive == pytest.approx(0.5 * bearing, rel=1e-3)
    assert driven[1:] == pytest.approx(0.5 * bearing[1:], rel=1e-3)
    assert driven[0] == pytest.approx(0.5 * (bearing[0] + bearing[1] * DISTANCE), rel=1e-3)
    assert _moment(problem, found) == pytest.approx(WALL * bearing[2], rel=1e-3)
    assert 0.0 < bearing[1] < 2e-4
    assert 0.0 < bearing[2] < 1e-4


@pytest.mark.parametrize(
    "changes",
    [
        ['machine.lateral.arrangement="symmetric"'],
        ['machine.lateral.arrangement="plates"', 'machine.floating_bearing.length="6 mm"'],
    ],
)
def test_gears_stay_in_the_middle_between_two_tilting_bearings(changes: list[str]) -> None:
    problem = _problem(*changes)
    found = problem.settle(problem.started(2e-6))
    q = found.balance.position
    assert found.settled
    middle, other = 2e-6, q[9:12]
    assert q[3:9] == pytest.approx([middle, 0.0, 0.0] * 2, abs=1e-9)
    assert other[0] - middle == pytest.approx(middle - q[0], rel=1e-3)
    assert other[1:] == pytest.approx(-q[1:3], rel=1e-3)


def test_bearing_that_trapped_pressure_pushes_off_settles_on_its_cover() -> None:
    """Grooves beyond single-flank timing shut spaces early, and these lift it off wide films."""
    stiff = 'machine.floating_bearing.shaft_stiffness="1e6 N m/rad"'
    late = [f'machine.relief_grooves.{side}_side_offset="6 mm"' for side in ("closing", "opening")]
    problem = _problem(stiff, *late, file=CASE.parent / "fuel14_pump.toml")
    found = problem.settle(problem.started(2e-6))
    q, play = found.balance.position, problem.stack.balance.floating.axial_play
    assert found.settled
    assert found.balance.residual < 1e-6
    assert leaning(problem.stack, q) == ["the floating bearing has lifted to its cover"]
    lift = rim_levers(problem.stack, problem.stack.moving_bearings[0]) @ q[:3]
    # flat on the cover, the gears upright and midway
    assert lift == pytest.approx(play, rel=0.02)
    assert q[[4, 5, 7, 8]] == pytest.approx(np.zeros(4), abs=1e-5)
    assert q[[3, 6]] == pytest.approx(0.5 * play, rel=0.02)


def test_journal_films_hold_the_shafts_where_nothing_is_given() -> None:
    """Two bearings 61.4 mm apart with the mean load F each at 25 um: F d^2 / (2 c), the less."""
    case = load_case(CASE, ["run.max_revolutions=3", 'machine.floating_bearing.motion="full"'])
    run = prepare(case).worn().with_films()
    data = run.march().data
    settings = replace(lateral_settings(case), grid=(42, 6), angles=1)
    problem = lateral_problem(run.machine, run.fluid, data, settings)
    force = 0.5 * np.linalg.norm(data["journal_force"].values.mean(axis=0)[:, :2], axis=1)
    wanted = force.min() * (23.4e-3 + 38e-3) ** 2 / (2.0 * 25e-6)
    assert problem.stack.balance.shaft_stiffness == pytest.approx(wanted, rel=1e-6)
