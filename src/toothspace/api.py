"""Composition root: the only place that sees machine types and simulation together."""

from __future__ import annotations

import time
from collections.abc import Iterable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from toothspace.case import Case, load_case
from toothspace.case.fingerprint import fingerprint
from toothspace.core.compiled import compile_seconds
from toothspace.core.errors import CaseError
from toothspace.core.keys import KeyRuleError
from toothspace.core.processes import start_worker
from toothspace.core.progress import Progress
from toothspace.core.registry import machine_type, machine_type_names
from toothspace.machines.shared_draft import draft_case
from toothspace.model.description import MachineDescription
from toothspace.results.credibility import with_interval, with_warnings
from toothspace.results.solution import Solution
from toothspace.simulation import run
from toothspace.simulation.setup import Setup, fluid_of, known_pressure, require_condition

if TYPE_CHECKING:
    from toothspace.core.types import Array
    from toothspace.geometry.evaluated_designs import EvaluatedDesigns

_KEPT_MACHINES = 4

_machines: dict[str, MachineDescription] = {}


def describe(case: Case) -> MachineDescription:
    """Turn the machine of a case into its tables; those of the last few machines are kept."""
    if case.machine_spec is None:
        raise CaseError("machine: found none, allowed a case with a [machine] table")
    key = fingerprint(case.machine_type, case.machine_spec)
    if key not in _machines:
        while len(_machines) >= _KEPT_MACHINES:
            del _machines[next(iter(_machines))]
        _machines[key] = machine_type(case.machine_type).describe(case.machine_spec)
    return _machines[key]


def evaluate_designs(
    case: Case,
    varied: Mapping[str, Array],
    addendum: float | None = None,
    displacement: float | None = None,
) -> EvaluatedDesigns:
    """Kinematics of the machine of a case with other values of some keys, many at once.

    Parameters
    ----------
    case : Case
        Everything that does not vary.
    varied : mapping of str to ndarray
        Values by key path, arrays of one shape (n,). [SI unit]
    addendum : float or None
        Height of the teeth above the shifted reference line, from which tip diameters follow;
        None for those given. [module]
    displacement : float or None
        Geometric displacement for which face widths are chosen; None for those given. [m3/rad]

    Raises
    ------
    CaseError
        If the machine has no closed form, or a key does not act on its kinematics.
    """
    evaluate = None
    if case.machine is not None:
        evaluate = machine_type(case.machine_type).evaluate_designs
    if evaluate is None:
        found = repr(case.machine_type) if case.machine_type else "no machine"
        able = [repr(name) for name in machine_type_names() if machine_type(name).evaluate_designs]
        raise CaseError(f"{case.label}: machine.type: found {found}, allowed {' or '.join(able)}")
    inner = {path.removeprefix("machine."): values for path, values in varied.items()}
    try:
        evaluated: EvaluatedDesigns = evaluate(case.machine, inner, addendum, displacement)
    except KeyRuleError as error:
        raise CaseError(f"{case.label}: machine.{error}") from error
    return evaluated


def set_up(case: Case) -> Setup:
    """Machine and fluid of a case, ready to be simulated.

    Raises
    ------
    CaseError
        If the case has no machine, no fluid or no condition.
    """
    require_condition(case)
    return Setup(case, describe(case), fluid_of(case))


def simulate(case: Case, progress: Progress | None = None) -> Solution:
    """Run a case and return its solution; a numerical failure is a status of it.

    Parameters
    ----------
    case : Case
        What to run.
    progress : callable, optional
        Called with the finished share and a short text.
    """
    started, compiled = time.perf_counter(), compile_seconds()
    setup = set_up(case)
    checks = setup.description.checks
    solution = with_warnings(run.simulate(setup, progress), known_pressure(setup), checks)
    if setup.description.as_drawn:
        solution = _with_both_flanks(setup, solution)
    compiling = compile_seconds() - compiled
    wall = time.perf_counter() - started - compiling
    return solution.with_note(wall_time=wall, compile_time=compiling)


def _with_both_flanks(setup: Setup, solution: Solution) -> Solution:
    try:
        drawn = set_up(setup.case.replace(setup.description.as_drawn))
    except CaseError as error:
        return solution.with_note(f"Flanks as in the file cannot be computed with: {error}")
    return with_interval(solution, run.simulate(drawn, None))


def simulate_all(cases: Iterable[Case], workers: int = 1) -> list[Solution | Exception]:
    """Run several cases; a case that cannot run is returned as its exception.

    A numerical failure within a run is a solution with its status, as in :func:`simulate`.
    """
    items = list(cases)
    if workers <= 1:
        return [_simulate_safely(case) for case in items]
    from concurrent.futures import ProcessPoolExecutor

    with ProcessPoolExecutor(workers, initializer=start_worker) as pool:
        return list(pool.map(_simulate_safely, items))


def solve_bearing(case: Case, fields: Path | None = None) -> dict[str, Any]:
    """Solve the table ``[bearing]`` of a case, as :func:`solve_film` does.

    Forces and torques act on the shaft by the film.
    """
    from toothspace.simulation.stand_alone import solve

    return solve(case, case.bearing, None, fields)


def solve_film(case: Case, fields: Path | None = None) -> dict[str, Any]:
    """Solve the table ``[film]`` of a case.

    Parameters
    ----------
    case : Case
        Case with the table.
    fields : Path, optional
        File for the fields, NetCDF (.nc) or VTK (.vts); one per body of a machine.

    Returns
    -------
    dict
        Numbers with unit suffixes; the load of a pad is that of the pressure above ambient.
    """
    from toothspace.simulation.stand_alone import solve

    return solve(case, case.film, None if case.machine_spec is None else describe(case), fields)


def _simulate_safely(case: Case) -> Solution | Exception:
    try:
        return simulate(case)
    except CaseError as error:
        # its subclasses may not survive the way between processes
        return CaseError(str(error))
    except Exception as error:  # one case that fails must not end the others
        return error


__all__ = [
    "describe",
    "draft_case",
    "evaluate_designs",
    "fluid_of",
    "load_case",
    "set_up",
    "simulate",
    "simulate_all",
    "solve_bearing",
    "solve_film",
]
