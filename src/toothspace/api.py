"""What a notebook or a script calls, and the only place that sees machines and runs together."""

from __future__ import annotations

import reprlib
import time
from collections.abc import Iterable, Mapping, Sequence
from functools import partial
from importlib import import_module
from numbers import Integral
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from toothspace.case import Case, load_case
from toothspace.case.fingerprint import cached_by_hash
from toothspace.core.compiled import compile_seconds
from toothspace.core.errors import CaseError
from toothspace.core.processes import outcomes
from toothspace.core.progress import Progress
from toothspace.core.registry import machine_type, machine_type_names, optional_function
from toothspace.core.types import Array
from toothspace.core.units import (
    Quantity,
    as_text,
    from_si,
    parse_quantity,
    split_quantity,
    to_si,
)
from toothspace.model.description import MachineDescription
from toothspace.results.credibility import with_interval, with_warnings
from toothspace.results.solution import Solution
from toothspace.run.condition import (
    condition_of,
    fluid_findings,
    fluid_limits,
    fluid_of,
)
from toothspace.run.run import Run

if TYPE_CHECKING:
    from toothspace.geometry.body_section import SectionRequest
    from toothspace.geometry.evaluated_designs import EvaluatedDesigns

__all__ = [
    "describe",
    "draft_case",
    "evaluate_designs",
    "fluid_of",
    "load_case",
    "new_case",
    "prepare",
    "simulate",
    "simulate_all",
    "solve_bearing",
    "solve_film",
]


AnyCase = Case | str | Path | Mapping[str, Any]
"""What stands for a case: itself, its file, the name of a shipped one, or its tables."""

NOT_REBUILT = (
    "The machine could not be rebuilt from the case in the result, so its section and design "
    "rules are missing: "
)

_PROPOSALS = 10
"""First designs that are tried, until one meets every design rule."""
_KEPT_MACHINES = 4
_machines: dict[str, MachineDescription] = {}


def describe(case: AnyCase) -> MachineDescription:
    """Turn the machine of a case into its tables over the shaft angle.

    Those of the last few machines are kept.

    Parameters
    ----------
    case : Case, str, Path or mapping
        Case, its file or its tables.
    """
    given = load_case(case)
    name, spec = given.machine_type, given.machine_spec
    if spec is None:
        raise CaseError("machine", "none", "a case with a [machine] table")
    make = partial(machine_type(name).describe, spec)
    return cached_by_hash(_machines, _KEPT_MACHINES, make, name, spec)


def prepare(case: Case) -> Run:
    """Machine, fluid and condition of a case, ready to be run.

    Raises
    ------
    CaseError
        If the case has no machine, no fluid or no condition.
    """
    machine, fluid = describe(case), fluid_of(case)
    return Run(case, machine, fluid, condition_of(case, machine, fluid))


def simulate(case: AnyCase, progress: Progress | None = None, **overrides: Any) -> Solution:
    """Run a case; a numerical failure is a status of the solution.

    Parameters
    ----------
    case : Case, str, Path or mapping
        Case, its file or its tables.
    progress : callable, optional
        Called with the finished share and a short text.
    **overrides : object
        Values of key paths as for :meth:`toothspace.Case.replace`, two underscores for the dot:
        ``operating_point__shaft_speed="2000 rpm"``.

    Raises
    ------
    CaseError
        If the case has a study, which asks for more than one run, or for the impossible.

    Examples
    --------
    >>> import toothspace as ts
    >>> ts.simulate("cases/egm12_pump.toml", run__fidelity="ideal")  # doctest: +SKIP
    """
    given = load_case(case)
    if overrides:
        given = given.replace({name.replace("__", "."): v for name, v in overrides.items()})
    if given.study is not None:
        allowed = "toothspace.run_study for it, or study = None for one run of the case"
        raise CaseError("study", f"{given.study_kind!r}", allowed).in_file(given.label)
    started, compiled = time.perf_counter(), compile_seconds()
    run, simulated = prepare(given), import_module(given.run.preset.module).simulate
    known = fluid_limits(given)
    solution = with_warnings(simulated(run, progress), *known)
    solution = solution.with_note(*fluid_findings(given, run.fluid))
    if run.machine.as_drawn:
        try:
            drawn = prepare(given.replace(run.machine.as_drawn))
        except CaseError as error:
            solution = solution.with_note(f"Flanks as in the file cannot be computed with: {error}")
        else:
            solution = with_interval(solution, simulated(drawn, None))
    compiling = compile_seconds() - compiled
    wall = time.perf_counter() - started - compiling
    return solution.with_note(wall_time=wall, compile_time=compiling)


def simulate_all(cases: Iterable[AnyCase], workers: int = 1) -> list[Solution | Exception]:
    """Run several cases; a case that cannot run is returned as its exception.

    A numerical failure within a run is a solution with its status, as in :func:`simulate`.

    Parameters
    ----------
    cases : iterable of Case, str, Path or mapping
        Cases, their files or their tables.
    workers : int
        Processes.
    """
    if not isinstance(cases, Iterable) or isinstance(cases, (str, Mapping)):
        raise CaseError("cases", reprlib.repr(cases), "a list of cases")
    return outcomes(simulate, [load_case(case) for case in cases], process_count(workers))


def process_count(workers: object) -> int:
    """Number of processes, checked."""
    if isinstance(workers, bool) or not isinstance(workers, Integral) or workers < 1:
        raise CaseError("workers", reprlib.repr(workers), "a whole number above 0")
    return int(workers)


def case_of(solution: Solution) -> Case:
    """Return the case that a result carries; files are looked for beside the case file.

    Raises
    ------
    CaseError
        If a file is gone, or the case is none of this version.
    """
    folder = Path(solution.provenance.get("case_file", "")).parent
    return Case.from_toml(solution.provenance.get("case_toml", ""), folder)


def machine_of(solution: Solution) -> tuple[MachineDescription | None, str]:
    """Describe the machine of a result, rebuilt from the case that it carries.

    Parameters
    ----------
    solution : Solution
        Result with ``case_toml``, ``case_hash`` and ``case_file`` in its provenance.

    Returns
    -------
    MachineDescription or None
        None if it cannot be rebuilt, for example because a profile file is gone.
    str
        Why not; empty if it was.
    """
    try:
        case = case_of(solution)
        if case.hash != solution.provenance.get("case_hash", case.hash):
            return None, NOT_REBUILT + "files that the case names have changed since the run."
        return describe(case), ""
    except CaseError as error:
        return None, f"{NOT_REBUILT}{error}"


def evaluate_designs(
    case: Case | str | Path,
    values: Mapping[str, Any],
    *,
    addendum: float | None = None,
    displacement: Quantity | str | float | None = None,
) -> EvaluatedDesigns:
    """Kinematics of many gear designs at once, without a run: closed forms over arrays.

    Parameters
    ----------
    case : Case, str or Path
        Machine with gears given by parameters; its keys count where none are given here.
    values : mapping of key path to array
        Numbers, in SI units where the key has a unit, or texts with units; arrays are broadcast
        together. Keys of the teeth, ``helix_angle``, ``face_width``, ``normal_backlash`` and
        ``center_distance``; ``family`` as words, whose keys that do not act on one are passed over.
    addendum : float, optional
        Height of the teeth above the shifted reference line, in modules: tip diameters follow
        module, tooth count and profile shift. Left out, they are those given.
    displacement : Quantity, str or float, optional
        Such as ``"4.95 cm^3/rev"``, or a number in m3/rad: the face width of each design is
        chosen for it.

    Returns
    -------
    EvaluatedDesigns
        Numbers as of ``toothspace geometry``, of the shape of the arrays, NaN of designs that
        cannot be made or do not turn; ``reasons``, ``valid``, ``keeps_rules`` and ``why(index)``
        say what is against a design.

    Raises
    ------
    CaseError
        If a key does not act on the kinematics, or the teeth come from a file.

    Examples
    --------
    >>> import toothspace as ts
    >>> designs = ts.evaluate_designs(
    ...     "egm12_pump", {"machine.gears.tooth_count": [10, 12, 14]}, addendum=1.0
    ... )
    >>> designs["flow_ripple_percent"].round(1).tolist()
    [19.6, 16.7, 14.5]
    """
    if not isinstance(values, Mapping):
        raise CaseError("values", reprlib.repr(values), "a table of keys and arrays")
    arrays = {
        path: np.asarray(raw, str) if path.endswith("gears.family") else _in_si(raw)
        for path, raw in values.items()
    }
    try:
        shape = np.broadcast_shapes(*(array.shape for array in arrays.values()))
    except ValueError as error:
        found = ", ".join(f"{path} {array.shape}" for path, array in arrays.items())
        allowed = "shapes that go together"
        raise CaseError("values", f"arrays of shapes {found}", allowed) from error
    rows = {path: np.broadcast_to(array, shape).ravel() for path, array in arrays.items()}
    volume = displacement
    if volume is not None and not isinstance(volume, float):
        volume = parse_quantity(str(volume), "cm^3/rev")
    given = load_case(case)
    name, label = given.machine_type, given.label
    evaluate = optional_function(name, "evaluate_designs") if name else None
    if evaluate is None:
        names = machine_type_names()
        able = [repr(one) for one in names if optional_function(one, "evaluate_designs")]
        found = repr(name) if name else "no machine"
        raise CaseError("machine.type", found, " or ".join(able)).in_file(label)
    inner = {path.removeprefix("machine."): row for path, row in rows.items()}
    try:
        evaluated: EvaluatedDesigns = evaluate(given.machine, inner, addendum, volume)
    except CaseError as error:
        raise error.under("machine").in_file(label) from error
    return evaluated.shaped(shape)


def _in_si(raw: Any) -> Array:
    given = np.asarray(raw)
    if given.dtype.kind in "OU":
        numbers = [to_si(*split_quantity(str(as_text(one)))) for one in given.flat]
        return np.asarray(numbers).reshape(given.shape)
    return given.astype(float)


def solve_bearing(case: Case, fields: Path | None = None) -> dict[str, Any]:
    """As :func:`solve_film` for ``[bearing]``; forces and torques act on the shaft by the film."""
    from toothspace.run.stand_alone import solve

    return solve(case, "bearing", describe, fields)


def solve_film(case: Case, fields: Path | None = None) -> dict[str, Any]:
    """Solve the table ``[film]`` of a case to numbers with unit suffixes.

    The load of a pad is that of the pressure above ambient. ``fields`` names a file for the
    fields, NetCDF (.nc) or VTK (.vts); one per body of a machine. Raises CaseError if the case has
    no such table.
    """
    from toothspace.run.stand_alone import solve

    return solve(case, "film", describe, fields)


def draft_case(files: Sequence[Path], unit: str, request: SectionRequest, folder: Path) -> str:
    """First case file of the machine whose parts are in CAD files of one frame.

    Parameters
    ----------
    files : sequence of Path
        Files.
    unit : str
        Length unit of those that have none of their own.
    request : SectionRequest
        Axis and plane of the gears, None to find them.
    folder : Path
        Where the case file will be.

    Returns
    -------
    str
        TOML of the machine type that uses most of the parts, with comments on what is assumed.

    Raises
    ------
    CaseError
        If no machine type finds its parts.
    """
    makers = [optional_function(name, "draft_case") for name in machine_type_names()]
    drafts = [make(files, unit, request, folder) for make in makers if make is not None]
    found = [draft for draft in drafts if draft is not None]
    if not found:
        raise CaseError(f"{files[0]}: --case", "no machine", "gears or rotors of one")
    return max(found, key=lambda draft: draft.parts).text


def new_case(machine: str, displacement: str, pressure: str, speed: str) -> str:
    """First design of a machine by the design rules, as a case file.

    Parameters
    ----------
    machine : str
        Machine type, such as ``external_gear``.
    displacement : str
        Of a turn, such as ``"14 cm^3"``.
    pressure : str
        Outlet pressure, absolute, such as ``"210 bar"``.
    speed : str
        Shaft speed, such as ``"1500 rpm"``.

    Returns
    -------
    str
        TOML: complete, with the reason for each number. Of the proposals of the machine type it
        is the first that meets every design rule, or else the one that breaks the fewest.

    Raises
    ------
    CaseError
        If the machine type designs nothing, or no such machine can be built.

    Examples
    --------
    >>> import toothspace as ts
    >>> text = ts.new_case("external_gear", "14 cm^3", "210 bar", "1500 rpm")
    >>> case = ts.Case.from_toml(text)
    >>> round(ts.describe(case).displacement * 2e6 * 3.14159265, 1)
    14.0
    """
    names = machine_type_names()
    able = [repr(name) for name in names if optional_function(name, "new_case") is not None]
    make = optional_function(machine, "new_case") if machine in names else None
    if make is None:
        raise CaseError("machine.type", repr(machine), " or ".join(able))
    text = displacement.removesuffix("/rev").strip()
    given = {
        "displacement": (text, "cm^3", (0.02, 5000.0)),
        "pressure": (pressure, "bar", (2.0, 500.0)),
        "speed": (speed, "rpm", (10.0, 20000.0)),
    }
    numbers = []
    for name, (value, unit, (least, most)) in given.items():
        found = from_si(parse_quantity(value, unit), unit)
        if not least <= found <= most:
            raise CaseError(name, repr(value), f"{least:g} to {most:g} {unit}")
        numbers.append(float(f"{found:.9g}"))
    estimate = Case.from_toml(make(*numbers))
    share = numbers[0] / (2e6 * np.pi * describe(estimate).displacement)
    best, least = "", np.inf
    for step in range(_PROPOSALS):
        proposed: str = make(*numbers, share, step)
        broken = sum(not rule.passed for rule in describe(Case.from_toml(proposed).check()).checks)
        if broken < least:
            best, least = proposed, broken
        if not broken:
            break
    # remarks stand in a column of their own
    parts = [line.partition("  #") for line in best.split("\n")]
    return "\n".join(f"{a.rstrip():<33}#{remark}" if mark else a for a, mark, remark in parts)
