"""The ``elastic`` preset: lateral films with deformation, floating bearings in balance."""

from __future__ import annotations

from collections.abc import Callable
from math import ceil, pi

from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.core.progress import Progress
from toothspace.floating.coupling import PointRequest, coupled_solution
from toothspace.floating.problem import (
    NO_FLOATING_PART,
    LateralSettings,
    balance_of,
)
from toothspace.model.description import MachineDescription
from toothspace.numerics.banded import check_grid
from toothspace.results.solution import Solution
from toothspace.run.heating import HeatSearch, lateral_heating
from toothspace.run.run import Marches, Run, interface_models
from toothspace.run.run import simulate as simulate_chambers

_STEPS_PER_PITCH = 3
"""Fewest steps of the films in a tooth pitch, after which all pressures repeat. [-]"""


def simulate(run: Run, progress: Progress | None = None) -> Solution:
    """Chambers and lateral films in agreement, then one revolution of the films.

    Where covers rest nothing is in balance but rotors that are free between them, which the
    solved films count already.

    Raises CaseError if the steps over the revolution are too long to follow a tooth pitch: the
    squeeze between two states a pitch apart is not that of the way between them.
    """
    if interface_models(run.case)["lateral"] == "reynolds":
        return simulate_chambers(run, progress)
    require_floating_part(run.case)
    case, balance = run.case, balance_of(run.machine)
    steps = case.run.film_steps_per_revolution
    fewest = ceil(_STEPS_PER_PITCH * 2.0 * pi / balance.interfaces[0].face.period)
    if steps < fewest:
        allowed = f"at least {fewest}, {_STEPS_PER_PITCH} for each tooth pitch"
        raise CaseError("run.film_steps_per_revolution", steps, allowed)
    request = PointRequest(settings=lateral_settings(case), start=balance.interfaces[0].face.gap)
    ready = run.worn(progress).with_films(progress)

    def heated(
        machine: MachineDescription, march: Callable[[MachineDescription], Solution]
    ) -> Solution:
        heat = HeatSearch(case, machine)
        while not heat.agree_with(march(heat.machine)):
            pass
        return heat.solution

    return coupled_solution(
        ready.machine,
        ready.fluid,
        Marches(ready, progress),
        request,
        steps,
        progress,
        heated=heated,
    )


def lateral_settings(case: Case) -> LateralSettings:
    """Grids and laws of the lateral films of a case."""
    run, heating = case.run, lateral_heating(case)
    check_grid("run.film_grid", run.film_grid)
    grid, angles, law = run.film_grid, run.film_angles_per_pitch, run.deformation
    return LateralSettings(grid=grid, angles=angles, deformation=law, heating=heating)


def require_floating_part(case: Case) -> None:
    """Refuse a machine without a floating part in balance before anything is computed.

    Raises CaseError if it has none, in the words of the machine type.
    """
    lacking = getattr(case.machine, "missing_floating_part", NO_FLOATING_PART)
    if lacking:
        raise CaseError(lacking)
