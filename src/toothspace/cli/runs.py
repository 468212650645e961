"""Commands that compute: runs, studies and films; everything heavy is imported when needed."""

from __future__ import annotations

import os
import tempfile
from collections.abc import Callable
from contextlib import suppress
from importlib import import_module
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Annotated, Any

import typer

from toothspace.cli import output
from toothspace.cli.output import (
    BAD_INPUT,
    INTERRUPTED,
    NUMERICAL_FAILURE,
    CaseFile,
    Force,
    Json,
    Overrides,
    code_of,
    exit_code,
    load,
    named,
    read_quantity,
)
from toothspace.core.errors import CaseError
from toothspace.core.files import require_writable
from toothspace.core.interrupts import interrupts_held
from toothspace.core.status import Status

if TYPE_CHECKING:
    from toothspace.results.solution import Solution

_STUDY_FILES = ("points.jsonl", "study.nc", "summary.json")

Fields = Annotated[
    Path | None,
    typer.Option("-o", "--output", metavar="FIELDS", help="Fields of the film, .nc or .vts."),
]
Grids = Annotated[
    bool,
    typer.Option("--grids", help="Also on half and twice the cells: how far the grid matters."),
]


def run(
    case_file: CaseFile,
    result: Annotated[
        Path | None, typer.Option("-o", "--output", help="Result file; default CASE.nc here.")
    ] = None,
    as_json: Json = False,
    fidelity: Annotated[
        str | None, typer.Option(metavar="P", help="ideal, lumped, films or elastic.")
    ] = None,
    overrides: Overrides = None,
    without_study: Annotated[
        bool, typer.Option("--without-study", help="One run of a case that has a [study].")
    ] = False,
    force: Force = False,
) -> int:
    """Simulate a case and write the result."""
    case = load(
        case_file, [*(overrides or ()), *([f"run.fidelity={fidelity}"] if fidelity else ())]
    )
    for table in ("bearing", "film"):
        if getattr(case, table) is not None:
            allowed = f"with 'toothspace {table}' only"
            raise CaseError(f"{case_file}: {table}", f"a stand-alone {table}", allowed)
    if case.study is not None and without_study:
        case = case.replace({"study": None})
    elif case.study is not None:
        allowed = f"with 'toothspace study {case_file}', or --without-study for one run of the case"
        raise CaseError(f"{case_file}: study", f"{case.study_kind!r}", allowed)
    target = require_writable(
        result or Path(f"{case_file.stem}.nc"), "-o", replace=force, endings=(".nc",)
    )
    from toothspace import api
    from toothspace.core.finding import status_line
    from toothspace.run.run import unused_tables

    Thread(target=_load_ahead, daemon=True).start()
    try:
        with named(case_file), output.progress(case.title) as progress:
            solution = api.simulate(case, progress=progress)
    except KeyboardInterrupt:
        output.message(f"{case_file}: interrupted before there was a result")
        return INTERRUPTED
    with interrupts_held():
        kept = _keep(solution, target)
        findings, summary = solution.findings, solution.summary()
        found = {"findings": [finding.to_dict() for finding in findings]} if as_json else {}
        output.write({**summary, **found}, as_json=as_json)
        for finding in findings:
            output.message(str(finding))
        for path, reason in unused_tables(case).items():
            output.message(f"Note: {path} is not used {reason}")
        output.message(f"{case_file}: {status_line(solution.status, findings)}")
        output.message(f"Result: {kept or 'the numbers above only'}")
    code = code_of(solution.status)
    return code if kept == target else BAD_INPUT


def _load_ahead() -> None:
    """Load what keeps results; compiled code leaves the interpreter free for it."""
    with suppress(Exception):  # who needs a library says what it lacks
        import_module("h5netcdf")
        import xarray as xr

        from toothspace.core.netcdf import spare_array_packages

        spare_array_packages()
        # xarray loads the array types that it knows when it first meets an array
        xr.Variable("x", [0.0]).to_numpy()


def _keep(solution: Solution, target: Path) -> Path | None:
    """Save a result, where its place refuses it in the temporary folder or here; return where."""
    folders = [Path()]
    with suppress(OSError):
        folders.insert(0, Path(tempfile.gettempdir()))
    for place in (target, *(folder / f"{target.stem}_{os.getpid()}.nc" for folder in folders)):
        try:
            return solution.save(place)
        except OSError as error:
            output.message(f"{place}: found {error.strerror or error} on writing")
    return None


def study(
    case_file: CaseFile,
    folder: Annotated[
        Path | None, typer.Option("-o", "--output", help="Folder; default CASE_study here.")
    ] = None,
    as_json: Json = False,
    workers: Annotated[int, typer.Option(min=1, max=1024, help="Processes.")] = 1,
    scheduler: Annotated[
        str, typer.Option(metavar="ADDRESS", help="Dask scheduler instead of processes.")
    ] = "",
    resume: Annotated[
        bool, typer.Option("--resume", help="Take finished points from the folder.")
    ] = False,
    overrides: Overrides = None,
    force: Force = False,
) -> int:
    """Run the study of a case: many runs with one question."""
    case = load(case_file, overrides)
    from toothspace.studies.study import run_study

    folder = folder or Path(f"{case_file.stem}_study")
    if folder.exists() and not folder.is_dir():
        raise CaseError(f"{folder}: -o", "a file", "a folder")
    if not (resume or force) and any((folder / name).exists() for name in _STUDY_FILES):
        raise CaseError(
            f"{folder}: -o", "results of a study", "another folder, --resume or --force"
        )
    with named(case_file), output.progress(f"{case.study_kind}:") as progress:
        result = run_study(
            case, folder, progress=progress, workers=workers, scheduler=scheduler, resume=resume
        )
    from toothspace.report.study import write_study_report

    write_study_report(result, folder / "report.html")
    output.write(result.summary(), as_json=as_json)
    code = exit_code(case_file, result.status)
    output.message(f"Results: {folder}")
    return code


def _film_command(table: str, meaning: str) -> Callable[..., int]:
    """Command that solves the film in a table of a case."""

    def command(
        case_file: CaseFile,
        fields: Fields = None,
        as_json: Json = False,
        grids: Grids = False,
        overrides: Overrides = None,
        force: Force = False,
    ) -> int:
        target = (
            None
            if fields is None
            else require_writable(fields, "-o", replace=force, endings=(".nc", ".vts"))
        )
        case = load(case_file, overrides)
        from toothspace import api
        from toothspace.films.summaries import grid_report

        solve = api.solve_bearing if table == "bearing" else api.solve_film
        with named(case_file):
            summary = solve(case, target)

            def on_grid(cells: tuple[int, int]) -> dict[str, Any]:
                return solve(load(case_file, [*(overrides or ()), f"{table}.grid={list(cells)}"]))

            own = tuple(getattr(case, table).grid)
            report = grid_report(on_grid, own, summary) if grids else {}
        if as_json and grids:
            output.write({**summary, "grid_report": report}, as_json=True)
        else:
            output.write(summary, as_json=as_json)
            output.write(report, as_json=False)
        return exit_code(case_file, Status[summary["status"].upper()])

    command.__name__, command.__doc__ = table, meaning
    return command


bearing = _film_command("bearing", "Solve a stand-alone journal bearing.")
film = _film_command(
    "film", "Solve a stand-alone film, as a pad, a ring or the face of a machine's bearing."
)


def reduce(
    case_file: CaseFile,
    tables_file: Annotated[
        Path, typer.Option("-o", "--output", metavar="TABLES.nc", help="File of the tables.")
    ],
    film: Annotated[
        list[str] | None,
        typer.Option(metavar="KIND", help="Kind of film, as journal; repeatable; default all."),
    ] = None,
    pressure: Annotated[
        list[str] | None,
        typer.Option(help="Pressure difference of lateral films, as '50 bar'; repeatable."),
    ] = None,
    speed: Annotated[
        list[str] | None,
        typer.Option(help="Shaft speed of lateral films, as '300 rpm'; repeatable."),
    ] = None,
    as_json: Json = False,
    overrides: Overrides = None,
    force: Force = False,
) -> int:
    """Solve the films of a machine and reduce them to tables for the lumped preset."""
    target = require_writable(tables_file, "-o", replace=force, endings=(".nc",))
    case = load(case_file, overrides)
    from toothspace.core.netcdf import write_dataset
    from toothspace.studies.reduce import reduce_films, reduce_summary

    pressures = _positive("--pressure", pressure, "bar")
    speeds = _positive("--speed", speed, "rpm")
    with named(case_file), output.progress(case.title) as progress:
        tables = reduce_films(case, film or (), progress, pressures=pressures, speeds=speeds)
    write_dataset(tables, target)
    summary = reduce_summary(tables)
    output.write(summary, as_json=as_json)
    output.message(f"Tables: {target}; read by [run] film_tables")
    return 0 if summary["status"] == Status.DONE.name.lower() else NUMERICAL_FAILURE


def fmu(
    case_file: CaseFile,
    unit: Annotated[
        Path, typer.Option("-o", "--output", metavar="UNIT.fmu", help="File of the unit.")
    ],
    model: Annotated[
        str,
        typer.Option(
            metavar="KIND",
            help="tables: a unit of steady runs; full: the whole machine, as UNIT.fmu or, for "
            "programs in C, UNIT.machine.",
        ),
    ] = "tables",
    fmi: Annotated[
        str, typer.Option(metavar="VERSION", help="FMI of the whole machine: 2 or 3.")
    ] = "2",
    flow: Annotated[
        list[str] | None,
        typer.Option(
            metavar="PORT",
            help="Port of the whole machine whose flow is the input, not its pressure: inlet or "
            "outlet; repeatable.",
        ),
    ] = None,
    pressure: Annotated[
        list[str] | None,
        typer.Option(help="Pressure difference of the tables, as '50 bar'; repeatable."),
    ] = None,
    speed: Annotated[
        list[str] | None,
        typer.Option(help="Shaft speed of the tables, as '500 rpm'; repeatable."),
    ] = None,
    drive: Annotated[
        str, typer.Option(metavar="KIND", help="What moves the shaft: speed or torque.")
    ] = "speed",
    binary: Annotated[
        bool, typer.Option(help="Compile for this computer if it has a C compiler.")
    ] = True,
    workers: Annotated[int, typer.Option(min=1, max=1024, help="Processes.")] = 1,
    as_json: Json = False,
    overrides: Overrides = None,
    force: Force = False,
) -> int:
    """Write a machine as a functional mock-up unit for simulators of systems (FMI)."""
    if model not in {"tables", "full"}:
        raise CaseError("--model", repr(model), "'tables' or 'full'")
    if model == "tables" and (fmi != "2" or flow):
        option, found = ("--flow", repr(flow[0])) if flow else ("--fmi", repr(fmi))
        raise CaseError(option, found, "that option with --model full only")
    endings = (".fmu", ".machine") if model == "full" else (".fmu",)
    target = require_writable(unit, "-o", replace=force, endings=endings)
    case = load(case_file, overrides)
    if model == "full":
        from toothspace.fmi.machine_unit import export_machine

        with named(case_file), output.progress(case.title) as progress:
            export_machine(case, target, drive=drive, flows=flow or (), fmi=fmi, progress=progress)
        if target.suffix == ".machine":
            output.message(f"Machine: {target}, read by the functions of toothspace.h")
        else:
            output.message(f"Unit: {target}, the whole machine for FMI {fmi}.0")
        return 0
    from toothspace.fmi.export import write_fmu

    with named(case_file), output.progress(case.title) as progress:
        result = write_fmu(
            case,
            target,
            pressures=_positive("--pressure", pressure, "bar"),
            speeds=_positive("--speed", speed, "rpm"),
            drive=drive,
            binary=binary,
            workers=workers,
            progress=progress,
        )
    summary = result.summary()
    output.write(summary, as_json=as_json)
    for warning in summary["warnings"]:
        output.message(f"Warning: {warning}")
    code = exit_code(case_file, result.status)
    if result.status is not Status.DONE:
        output.message(f"{case_file}: no unit is written; the same command goes on from here.")
    elif summary["binary"]:
        output.message(f"Unit: {target}, sources and binary for {summary['binary']}")
    else:
        output.message(f"Unit: {target}, sources alone: importers compile them")
    return code


def _positive(option: str, texts: list[str] | None, unit: str) -> list[float]:
    values = [read_quantity(option, text, unit) for text in texts or ()]
    for text, value in zip(texts or (), values, strict=True):
        if not value > 0.0:
            raise CaseError(option, f"{text!r}", "above zero")
    return values
