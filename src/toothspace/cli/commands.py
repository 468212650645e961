"""What each command does; everything heavy is imported when it is needed."""

from __future__ import annotations

import json
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

from toothspace.cli import output
from toothspace.core.errors import CaseError, ToothspaceError
from toothspace.core.registry import machine_modules
from toothspace.core.status import Status
from toothspace.simulation.presets import PRESETS

if TYPE_CHECKING:
    from toothspace.case import Case

EXPORT_FORMATS = ("dxf", "stl", "step", "txt")
PICTURE_SUFFIXES = (".png", ".svg", ".pdf")
_NUMERICAL_FAILURE = 3
_START_TABLE = "machine.startup"  # acts on a free shaft only, in a circuit
_BEARING_TABLE = "machine.floating_bearing"
_INTERRUPTED = 130
_EXIT_CODES = {Status.DONE: 0, Status.INTERRUPTED: _INTERRUPTED}


@final
@dataclass(frozen=True)
class GeometryOutputs:
    """Files that ``geometry`` writes; None for those not wanted.

    Parameters
    ----------
    tables : Path or None
        NetCDF file of the tables.
    text_folder : Path or None
        Folder of the tables as plain text.
    plot : Path or None
        Picture.
    export : str or None
        Format of the exported profiles.
    """

    tables: Path | None = None
    text_folder: Path | None = None
    plot: Path | None = None
    export: str | None = None


@final
@dataclass(frozen=True)
class StudyOptions:
    """Where and how ``study`` computes.

    Parameters
    ----------
    folder : Path or None
        Folder of the results; None takes CASE_study here.
    workers : int
        Processes.
    scheduler : str
        Address of a Dask scheduler, empty for processes.
    resume : bool
        Whether finished points are taken from the folder.
    """

    folder: Path | None = None
    workers: int = 1
    scheduler: str = ""
    resume: bool = False


def run(case_file: Path, result: Path | None, overrides: Sequence[str], *, as_json: bool) -> int:
    """Simulate a case, write the result and print its summary; returns the exit code."""
    case = _load(case_file, overrides)
    for table in ("bearing", "film"):
        if getattr(case, table) is not None:
            allowed = f"with 'toothspace {table}' only"
            raise CaseError(f"{case_file}: {table}: found a stand-alone {table}, allowed {allowed}")
    target = _writable(result or Path(f"{case_file.stem}.nc"), "-o")
    from toothspace import api

    try:
        with _file_named(case_file), output.progress(case.title) as progress:
            solution = api.simulate(case, progress=progress)
    except KeyboardInterrupt:
        output.message(f"{case_file}: interrupted before there was a result")
        return _INTERRUPTED
    solution.save(target)
    output.write(solution.summary(), as_json=as_json)
    if solution.status is not Status.DONE:
        output.message(f"{case_file}: {solution.status.name.lower()}: {solution.status.value}")
    _tell_unused(case)
    output.message(f"Result: {target}")
    return _EXIT_CODES.get(solution.status, _NUMERICAL_FAILURE)


def geometry(
    case_file: Path, outputs: GeometryOutputs, overrides: Sequence[str], *, as_json: bool
) -> int:
    """Describe a machine, write what is wanted and print its numbers; returns the exit code."""
    if outputs.export is not None and outputs.export not in EXPORT_FORMATS:
        allowed = ", ".join(EXPORT_FORMATS)
        raise CaseError(f"{case_file}: --export: found {outputs.export!r}, allowed {allowed}")
    case = _load(case_file, overrides)
    from toothspace import api

    with _file_named(case_file):
        description = api.describe(case)
        _write_geometry(case, description, outputs)
    summary = dict(description.geometry_summary)
    summary.setdefault("warnings", [check.name for check in description.checks if not check.passed])
    output.write(summary, as_json=as_json)
    if not as_json:
        output.write_checks(description.checks)
    return 0


def report(result: Path, page: Path | None, measured: Path | None = None) -> int:
    """Write the HTML report of a result; returns the exit code."""
    from toothspace.report import write_report
    from toothspace.results.io import load_solution

    target = _writable(page or result.with_suffix(".html"), "-o")
    overlay = _measured(measured) if measured else None
    write_report(load_solution(result), target, measured=overlay)
    output.message(f"Report: {target}")
    return 0


def _measured(path: Path) -> dict[str, Any]:
    """Signals of a measurement that figures can lay over results."""
    from toothspace.core.signals import read_columns

    known = {"shaft_speed": "rpm", "pressure_difference": "bar"}
    text = path.read_text(encoding="utf-8-sig") if path.is_file() else ""
    given = {name: unit for name, unit in known.items() if name in text.partition("\n")[0]}
    return read_columns(path, {"time": "s", **(given or known)})


def study(
    case_file: Path, options: StudyOptions, overrides: Sequence[str], *, as_json: bool
) -> int:
    """Run the study of a case, write its results and report; returns the exit code."""
    case = _load(case_file, overrides)
    from toothspace.studies.registry import kind_of, run_study

    kind = kind_of(case)
    folder = options.folder or Path(f"{case_file.stem}_study")
    if folder.exists() and not folder.is_dir():
        raise CaseError(f"{folder}: -o: found a file, allowed a folder")
    with _file_named(case_file), output.progress(f"{kind}:") as progress:
        result = run_study(
            case,
            folder,
            progress=progress,
            workers=options.workers,
            scheduler=options.scheduler,
            resume=options.resume,
        )
    from toothspace.report.study import write_study_report

    write_study_report(result, folder / "report.html")
    output.write(result.summary(), as_json=as_json)
    if result.status is not Status.DONE:
        output.message(f"{case_file}: {result.status.name.lower()}: {result.status.value}")
    output.message(f"Results: {folder}")
    return _EXIT_CODES.get(result.status, _NUMERICAL_FAILURE)


def stand_alone_film(
    case_file: Path,
    table: str,
    fields: Path | None,
    overrides: Sequence[str],
    *,
    grids: bool,
    as_json: bool,
) -> int:
    """Solve the table ``bearing`` or ``film`` of a case; returns the exit code."""
    target = None if fields is None else _writable(fields, "-o")
    case = _load(case_file, overrides)
    if getattr(case, table) is None:
        raise CaseError(f"{case_file}: {table}: found nothing, allowed a table [{table}]")
    from toothspace import api
    from toothspace.films.grid_report import grid_report

    with _file_named(case_file):
        solve = api.solve_bearing if table == "bearing" else api.solve_film
        summary = solve(case, target)

        def on_grid(cells: tuple[int, int]) -> dict[str, Any]:
            return solve(_load(case_file, [*overrides, f"{table}.grid={list(cells)}"]))

        own = tuple(getattr(case, table).grid)
        report = grid_report(on_grid, own, summary) if grids else {}
    if as_json and grids:
        output.write({**summary, "grid_report": report}, as_json=True)
    else:
        output.write(summary, as_json=as_json)
        output.write(report, as_json=False)
    status = Status[summary["status"].upper()]
    if status is not Status.DONE:
        output.message(f"{case_file}: {status.name.lower()}: {status.value}")
    return _EXIT_CODES.get(status, _NUMERICAL_FAILURE)


def reduce(
    case_file: Path,
    tables_file: Path,
    kinds: Sequence[str],
    overrides: Sequence[str],
    *,
    as_json: bool,
) -> int:
    """Reduce the films of a machine to a file of tables; returns the exit code."""
    target = _writable(tables_file, "-o")
    case = _load(case_file, overrides)
    from toothspace.results.io import write_atomically
    from toothspace.studies.reduce import reduce_films, reduce_summary

    with _file_named(case_file), output.progress(case.title) as progress:
        tables = reduce_films(case, kinds, progress)
    write_atomically(tables, target)
    summary = reduce_summary(tables)
    output.write(summary, as_json=as_json)
    output.message(f"Tables: {target}; read by [run] film_tables")
    return 0 if summary["status"] == Status.DONE.name.lower() else _NUMERICAL_FAILURE


def validate(folder: Path | None, only: str, book: Path, *, as_json: bool) -> int:
    """Run the validation cases, write the book and print the verdicts; returns the exit code."""
    from toothspace.report.validation_book import (
        find_validation,
        run_validation,
        summary_of,
        write_book,
    )

    target = _writable(book, "-o")
    with output.progress("validate:"):
        sources = run_validation(find_validation(folder), only)
    write_book(sources, target)
    summary = summary_of(sources)
    if as_json:
        output.write(summary, as_json=True)
    else:
        verdicts = summary["sources"].items()
        output.write({name: found["verdict"] for name, found in verdicts}, as_json=False)
    output.message(f"Validation book: {target}")
    return _NUMERICAL_FAILURE if summary["deviating"] else 0


def schema() -> int:
    """Print the JSON Schema of the case file; returns the exit code."""
    from toothspace.case.json_schema import case_schema

    output.line(json.dumps(case_schema(), indent=2, ensure_ascii=False))
    return 0


def _load(case_file: Path, overrides: Sequence[str]) -> Case:
    from toothspace.case import load_case

    return load_case(case_file, overrides)


def _write_geometry(case: Case, description: Any, outputs: GeometryOutputs) -> None:
    if outputs.tables is not None or outputs.text_folder is not None:
        from toothspace.results.tables import save_tables, save_tables_txt

        if outputs.tables is not None:
            save_tables(description, _writable(outputs.tables, "-o"))
        if outputs.text_folder is not None:
            save_tables_txt(description, outputs.text_folder)
    if outputs.plot is not None:
        _plot(description, _writable(outputs.plot, "--plot"))
    if outputs.export is not None:
        _export(case, outputs.export)


def _tell_unused(case: Case) -> None:
    bends = case.run.fidelity != "elastic" or case.run.deformation == "bodies"
    if not bends and getattr(case.machine, "elastic_bodies", None) is not None:
        law = f"run.deformation = {case.run.deformation!r}"
        output.message(f"Note: [machine.elastic_bodies] is not used with {law}")
    for path in PRESETS[case.run.fidelity].unused_tables:
        if path == _START_TABLE and case.circuit is not None:
            continue
        if path == _BEARING_TABLE and case.run.film_tables is not None:
            continue
        value: Any = case
        for name in path.split("."):
            value = getattr(value, name, None)
        if value is not None:
            output.message(f"Note: [{path}] is not used by a run with {case.run.fidelity!r}")


def _plot(description: Any, path: Path) -> None:
    if path.suffix.lower() not in PICTURE_SUFFIXES:
        allowed = ", ".join(PICTURE_SUFFIXES)
        raise CaseError(f"--plot: found the ending {path.suffix!r}, allowed {allowed}")
    from toothspace.plotting.geometry import openings, volumes
    from toothspace.plotting.style import save_figure

    save_figure(volumes(description), path)
    save_figure(openings(description), path.with_stem(f"{path.stem}_openings"))


def _export(case: Case, suffix: str) -> None:
    module = f"{machine_modules()[case.machine_type]}.export"
    if find_spec(module) is None:
        raise CaseError(
            f"--export: found machine type {case.machine_type!r}, allowed external_gear, gerotor"
        )
    for path in import_module(module).export_profiles(case.machine_spec, Path(case.name), suffix):
        output.message(f"Profile: {path}")


def _writable(path: Path, option: str) -> Path:
    if path.is_dir():
        raise CaseError(f"{path}: {option}: found a directory, allowed a file name")
    if not path.parent.is_dir():
        raise CaseError(f"{path}: {option}: found no folder {path.parent}, allowed an existing one")
    return path


@contextmanager
def _file_named(case_file: Path) -> Iterator[None]:
    """Put the case file in front of messages of later stages."""
    try:
        yield
    except ToothspaceError as error:
        if str(error).startswith(str(case_file)):
            raise
        raise type(error)(f"{case_file}: {error}") from error
