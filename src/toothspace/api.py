"""Composition root: the only place that sees machine types and simulation together."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from functools import partial
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

from toothspace.case import Case, load_case
from toothspace.case.fingerprint import kept_by_content
from toothspace.case.study import study_kind
from toothspace.core.compiled import compile_seconds
from toothspace.core.errors import CaseError
from toothspace.core.processes import outcomes
from toothspace.core.progress import Progress
from toothspace.core.registry import machine_type
from toothspace.machines import shared_designs
from toothspace.machines.shared_draft import draft_case
from toothspace.model.description import MachineDescription
from toothspace.results.credibility import with_interval, with_warnings
from toothspace.results.solution import Solution
from toothspace.run.condition import condition_of, fluid_of, known_pressure
from toothspace.run.run import Run

if TYPE_CHECKING:
    from toothspace.core.types import Array
    from toothspace.geometry.evaluated_designs import EvaluatedDesigns

_KEPT_MACHINES = 4
_machines: dict[str, MachineDescription] = {}


def describe(case: Case) -> MachineDescription:
    """Turn the machine of a case into its tables; those of the last few machines are kept."""
    name, spec = case.machine_type, case.machine_spec
    if spec is None:
        raise CaseError("machine: found none, allowed a case with a [machine] table")
    make = partial(machine_type(name).describe, spec)
    return kept_by_content(_machines, _KEPT_MACHINES, make, name, spec)


def evaluate_designs(
    case: Case,
    varied: Mapping[str, Array],
    addendum: float | None = None,
    displacement: float | None = None,
) -> EvaluatedDesigns:
    """See :func:`toothspace.machines.shared_designs.evaluate_designs`. [SI unit]."""
    fixed = case.label, case.machine_type, case.machine
    return shared_designs.evaluate_designs(*fixed, varied, addendum, displacement)


def prepare(case: Case) -> Run:
    """Machine, fluid and condition of a case, ready to be run.

    Raises
    ------
    CaseError
        If the case has no machine, no fluid or no condition.
    """
    machine, fluid = describe(case), fluid_of(case)
    return Run(case, machine, fluid, condition_of(case, machine, fluid))


def simulate(case: Case, progress: Progress | None = None) -> Solution:
    """Run a case and return its solution; a numerical failure is a status of it.

    ``progress`` is called with the finished share and a short text.

    Raises
    ------
    CaseError
        If the case has a study, which asks for more than one run, or for the impossible.
    """
    if case.study is not None:
        allowed = "toothspace.studies.run_study for it, or study = None for one run of the case"
        raise CaseError(f"{case.label}: study: found {study_kind(case.study)!r}, allowed {allowed}")
    started, compiled = time.perf_counter(), compile_seconds()
    run, simulated = prepare(case), import_module(case.run.preset.module).simulate
    solution = with_warnings(simulated(run, progress), known_pressure(case))
    if run.machine.as_drawn:
        try:
            drawn = prepare(case.replace(run.machine.as_drawn))
        except CaseError as error:
            solution = solution.with_note(f"Flanks as in the file cannot be computed with: {error}")
        else:
            solution = with_interval(solution, simulated(drawn, None))
    compiling = compile_seconds() - compiled
    wall = time.perf_counter() - started - compiling
    return solution.with_note(wall_time=wall, compile_time=compiling)


def simulate_all(cases: Iterable[Case], workers: int = 1) -> list[Solution | Exception]:
    """Run several cases; a case that cannot run is returned as its exception.

    A numerical failure within a run is a solution with its status, as in :func:`simulate`.
    """
    return outcomes(simulate, cases, workers)


def solve_bearing(case: Case, fields: Path | None = None) -> dict[str, Any]:
    """As :func:`solve_film` for ``[bearing]``; forces and torques act on the shaft by the film."""
    from toothspace.run.stand_alone import solve

    return solve(case, case.bearing, describe, fields)


def solve_film(case: Case, fields: Path | None = None) -> dict[str, Any]:
    """Solve the table ``[film]`` of a case to numbers with unit suffixes.

    The load of a pad is that of the pressure above ambient. ``fields`` names a file for the
    fields, NetCDF (.nc) or VTK (.vts); one per body of a machine.
    """
    from toothspace.run.stand_alone import solve

    return solve(case, case.film, describe, fields)


__all__ = [
    "describe",
    "draft_case",
    "evaluate_designs",
    "fluid_of",
    "load_case",
    "prepare",
    "simulate",
    "simulate_all",
    "solve_bearing",
    "solve_film",
]
