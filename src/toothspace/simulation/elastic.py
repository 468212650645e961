"""The ``elastic`` preset: lateral films with deformation, floating bearings in balance."""

from __future__ import annotations

from functools import partial

from toothspace.case import Case
from toothspace.core.progress import Progress
from toothspace.results.solution import Solution
from toothspace.simulation.heating import lateral_heating, run_with_heat
from toothspace.simulation.lateral.coupled_run import coupled_solution
from toothspace.simulation.lateral.coupling import PointRequest
from toothspace.simulation.lateral.problem import LateralSettings, balance_of, require_floating_part
from toothspace.simulation.lumped import run_in_machine
from toothspace.simulation.setup import Setup


def simulate(setup: Setup, progress: Progress | None = None) -> Solution:
    """Chambers and lateral films in agreement, then one revolution of the films."""
    require_floating_part(setup.case)
    case, condition, balance = setup.case, setup.condition, balance_of(setup.description)
    machine = run_in_machine(setup, progress)
    request = PointRequest(settings=lateral_settings(case), start=balance.interfaces[0].face.gap)
    return coupled_solution(
        machine.description,
        machine.fluid,
        machine.at(condition, progress),
        request,
        case.run.film_steps_per_revolution,
        progress,
        heated=partial(run_with_heat, case),
    )


def lateral_settings(case: Case) -> LateralSettings:
    """Grids and laws of the lateral films of a case."""
    run, heating = case.run, lateral_heating(case)
    grid, angles, law = run.film_grid, run.film_angles_per_pitch, run.deformation
    return LateralSettings(grid=grid, angles=angles, deformation=law, heating=heating)
