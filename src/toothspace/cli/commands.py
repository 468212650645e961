"""What each command does; everything heavy is imported when it is needed."""

from __future__ import annotations

import json
import os
import tempfile
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from importlib import import_module
from importlib.util import find_spec
from pathlib import Path
from threading import Thread
from typing import TYPE_CHECKING, Any, final

from toothspace.cli import output
from toothspace.core.errors import CaseError, ToothspaceError
from toothspace.core.files import require_writable
from toothspace.core.interrupts import interrupts_held
from toothspace.core.registry import machine_modules
from toothspace.core.status import Status

if TYPE_CHECKING:
    from toothspace.case import Case
    from toothspace.geometry.body_section import SectionRequest
    from toothspace.results.solution import Solution

EXPORT_FORMATS = ("dxf", "stl", "step", "txt")
_FILE_UNITS = ("mm", "m", "um", "in")
PICTURE_SUFFIXES = (".png", ".svg", ".pdf")
_NUMERICAL_FAILURE = 3
_STUDY_FILES = ("points.jsonl", "study.nc", "summary.json")
_BAD_INPUT = 2
_INTERRUPTED = 130
_EXIT_CODES = {Status.DONE: 0, Status.INTERRUPTED: _INTERRUPTED}


@final
@dataclass(frozen=True)
class Target:
    """File that a command writes at its end.

    Parameters
    ----------
    path : Path
        File.
    force : bool
        Whether it may replace a file that exists.
    """

    path: Path
    force: bool = False

    def checked(self, option: str = "-o") -> Path:
        """Return the path if it can be written.

        Raises
        ------
        CaseError
            If it cannot, or a file is there that must be kept.
        """
        return require_writable(self.path, option, replace=self.force)


@final
@dataclass(frozen=True)
class FilmOutputs:
    """What ``bearing`` and ``film`` write.

    Parameters
    ----------
    fields : Path or None
        File of the fields.
    grids : bool
        Whether the film is solved on other grids too.
    force : bool
        Whether files that exist are replaced.
    """

    fields: Path | None = None
    grids: bool = False
    force: bool = False


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
    force : bool
        Whether files that exist are replaced.
    """

    tables: Path | None = None
    text_folder: Path | None = None
    plot: Path | None = None
    export: str | None = None
    force: bool = False


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
    force : bool
        Whether results that the folder holds are replaced.
    """

    folder: Path | None = None
    workers: int = 1
    scheduler: str = ""
    resume: bool = False
    force: bool = False


@final
@dataclass(frozen=True)
class FmuOptions:
    """What ``fmu`` tabulates and writes.

    Parameters
    ----------
    pressures, speeds : sequence of str
        Pressure differences and shaft speeds with their units.
    drive : str
        ``speed`` or ``torque``.
    binary : bool
        Whether the unit gets a binary for this computer.
    workers : int
        Processes.
    """

    pressures: Sequence[str]
    speeds: Sequence[str]
    drive: str = "speed"
    binary: bool = True
    workers: int = 1


@final
@dataclass(frozen=True)
class GearFileOptions:
    """How ``gear`` reads a file.

    Parameters
    ----------
    unit : str
        Length unit of the file.
    axis : str or None
        ``x``, ``y`` or ``z``; None finds it.
    plane : str or None
        Height of the section with its unit; None takes the middle of the teeth.
    center_distance : str or None
        Distance at which the backlash is wanted, with its unit.
    """

    unit: str
    axis: str | None
    plane: str | None
    center_distance: str | None


def run(
    case_file: Path,
    result: Path | None,
    overrides: Sequence[str],
    *,
    as_json: bool,
    force: bool = False,
) -> int:
    """Simulate a case, write the result and print its summary; returns the exit code."""
    case = _load(case_file, overrides)
    for table in ("bearing", "film"):
        if getattr(case, table) is not None:
            allowed = f"with 'toothspace {table}' only"
            raise CaseError(f"{case_file}: {table}: found a stand-alone {table}, allowed {allowed}")
    target = Target(result or Path(f"{case_file.stem}.nc"), force).checked()
    from toothspace import api
    from toothspace.simulation.presets import unused_tables

    Thread(target=_load_ahead, daemon=True).start()
    try:
        with _file_named(case_file), output.progress(case.title) as progress:
            solution = api.simulate(case, progress=progress)
    except KeyboardInterrupt:
        output.message(f"{case_file}: interrupted before there was a result")
        return _INTERRUPTED
    with interrupts_held():
        kept = _keep(solution, target)
        output.write(solution.summary(), as_json=as_json)
        if solution.status is not Status.DONE:
            output.message(f"{case_file}: {solution.status.name.lower()}: {solution.status.value}")
        for warning in filter(None, solution.provenance.get("warnings", "").splitlines()):
            output.message(f"Warning: {warning}")
        for path, reason in unused_tables(case).items():
            output.message(f"Note: [{path}] is not used {reason}")
        output.message(f"Result: {kept or 'the numbers above only'}")
    if kept != target:
        return _BAD_INPUT
    return _EXIT_CODES.get(solution.status, _NUMERICAL_FAILURE)


def _load_ahead() -> None:
    """Load what keeps results; compiled code leaves the interpreter free for it."""
    with suppress(Exception):  # who needs a library says what it lacks
        for library in ("xarray", "h5netcdf"):
            import_module(library)


def _keep(solution: Solution, target: Path) -> Path | None:
    """Save a result, where its place refuses it in the temporary folder or here; return where."""
    elsewhere = (Path(folder) / f"{target.stem}_{os.getpid()}.nc" for folder in _last_folders())
    for place in (target, *elsewhere):
        try:
            return solution.save(place)
        except OSError as error:
            output.message(f"{place}: found {error.strerror or error} on writing")
    return None


def _last_folders() -> Iterator[str]:
    with suppress(OSError):
        yield tempfile.gettempdir()
    yield "."


def geometry(
    case_file: Path, outputs: GeometryOutputs, overrides: Sequence[str], *, as_json: bool
) -> int:
    """Describe a machine, write what is wanted and print its numbers; returns the exit code."""
    if outputs.export is not None and outputs.export not in EXPORT_FORMATS:
        allowed = ", ".join(EXPORT_FORMATS)
        raise CaseError(f"{case_file}: --export: found {outputs.export!r}, allowed {allowed}")
    case = _load(case_file, overrides)
    plots = () if outputs.plot is None else (outputs.plot, _second_plot(outputs.plot))
    for path, option in ((outputs.tables, "-o"), *((plot, "--plot") for plot in plots)):
        if path is not None:
            Target(path, outputs.force).checked(option)
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


def gear(
    files: Sequence[Path], section: GearFileOptions, outputs: Mapping[str, Target], *, as_json: bool
) -> int:
    """Find the gears of files and print their numbers; returns the exit code.

    Outputs are the targets of ``--plot`` and ``--case``.
    """
    from toothspace.core.units import to_si
    from toothspace.geometry.body_section import AXES, SectionRequest
    from toothspace.geometry.cad_import import STEP_SUFFIXES
    from toothspace.geometry.gear_finder import find_in_files
    from toothspace.geometry.gear_report import file_report, flank_warnings, likelier_units

    file = files[0]
    if section.unit not in _FILE_UNITS:
        allowed = ", ".join(_FILE_UNITS)
        raise CaseError(f"{file}: --unit: found {section.unit!r}, allowed {allowed}")
    if section.axis not in (None, *AXES):
        raise CaseError(f"{file}: --axis: found {section.axis!r}, allowed {', '.join(AXES)}")
    targets = {option: target.checked(option) for option, target in outputs.items()}
    picture = _picture(targets["--plot"]) if "--plot" in targets else None
    request = SectionRequest(section.axis, _quantity(section.plane, "--plane"))
    try:
        contents = find_in_files(files, to_si(1.0, section.unit), request)
    except CaseError:
        # rotors with few lobes are no gears
        if "--case" not in targets:
            raise
        _draft(files, section.unit, request, targets["--case"])
        return 0
    if file.suffix.lower() not in STEP_SUFFIXES:
        scales = {name: to_si(1.0, name) / to_si(1.0, section.unit) for name in _FILE_UNITS}
        for better in likelier_units(contents, scales):
            output.message(f"Note: with --unit {better} the gear has a standard module")
    for warning in flank_warnings(contents):
        output.message(f"Warning: {warning}")
    found = file_report(contents, _quantity(section.center_distance, "--center-distance"))
    if as_json:
        output.write(found, as_json=True)
    else:
        output.write_tables(found)
    fits = {
        one.name or f"gear {number + 1}": one.detected.involute
        for number, one in enumerate(contents.gears)
        if one.detected.involute is not None
    }
    if picture is not None and fits:
        from toothspace.plotting.flank_deviation import flank_deviation
        from toothspace.plotting.style import save_figure

        save_figure(flank_deviation(fits), picture)
        output.message(f"Picture: {picture}")
    if "--case" in targets:
        _draft(files, section.unit, request, targets["--case"])
    return 0


def _draft(files: Sequence[Path], unit: str, request: SectionRequest, target: Path) -> None:
    from toothspace import api
    from toothspace.core.files import write_text

    write_text(target, api.draft_case(files, unit, request, target.parent))
    output.message(f"Case: {target}")
    try:
        api.load_case(target)
    except CaseError as error:
        output.message(f"Note: it does not run as it is: {error}")


def _quantity(text: str | None, option: str, unit: str = "mm") -> float | None:
    return None if text is None else _read_quantity(text, option, unit)


def _read_quantity(text: str, option: str, unit: str) -> float:
    from toothspace.core.units import parse_quantity

    try:
        return parse_quantity(text, unit)
    except CaseError as error:
        raise CaseError(f"{option}: {error}") from error


def _positive(option: str, text: str, unit: str) -> float:
    value = _read_quantity(text, option, unit)
    if not value > 0.0:
        raise CaseError(f"{option}: found {text!r}, allowed above zero")
    return value


def report(
    result: Path, page: Path | None, measured: Path | None = None, *, force: bool = False
) -> int:
    """Write the report of a result as HTML or PDF; returns the exit code."""
    from toothspace.report import write_report
    from toothspace.results.io import load_solution

    target = Target(page or result.with_suffix(".html"), force).checked()
    overlay = _measured(measured) if measured else None
    write_report(load_solution(result), target, measured=overlay)
    output.message(f"Report: {target}")
    return 0


def _measured(path: Path) -> dict[str, Any]:
    """Signals of a measurement that figures can lay over results."""
    from toothspace.core.signals import column_names, read_columns

    known = {"shaft_speed": "rpm", "pressure_difference": "bar"}
    given = {name: unit for name, unit in known.items() if name in column_names(path)}
    return read_columns(path, {"time": "s", **(given or known)})


def compare(first: Path, second: Path, page: Target | None, *, as_json: bool) -> int:
    """Put two results side by side, as text, JSON or a page; returns the exit code."""
    target = None if page is None else page.checked()
    from toothspace.report.comparison import Comparison
    from toothspace.results.io import load_solution

    comparison = Comparison(load_solution(first), load_solution(second))
    if as_json:
        output.write(comparison.to_dict(), as_json=True)
    else:
        for name, (one, two) in comparison.keys().items():
            output.line(f"{name}: {output.shown(one)} -> {output.shown(two)}")
        output.write_comparison(comparison.numbers())
        output.write_comparison({f"{n}, W": both for n, both in comparison.losses().items()})
    for warning in comparison.warnings():
        output.message(f"Warning: {warning}")
    if target is not None:
        output.message(f"Comparison: {comparison.write(target)}")
    return 0


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
    if not (options.resume or options.force) and any(
        (folder / name).exists() for name in _STUDY_FILES
    ):
        raise CaseError(
            f"{folder}: -o: found results of a study, allowed another folder, --resume or --force"
        )
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
    case_file: Path, table: str, outputs: FilmOutputs, overrides: Sequence[str], *, as_json: bool
) -> int:
    """Solve the table ``bearing`` or ``film`` of a case; returns the exit code."""
    fields, grids = outputs.fields, outputs.grids
    target = None if fields is None else Target(fields, outputs.force).checked()
    case = _load(case_file, overrides)
    if getattr(case, table) is None:
        raise CaseError(f"{case_file}: {table}: found nothing, allowed a table [{table}]")
    from toothspace import api
    from toothspace.films.summaries import grid_report

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
    tables_file: Target,
    kinds: Sequence[str],
    grid: tuple[Sequence[str], Sequence[str]],
    overrides: Sequence[str],
    *,
    as_json: bool,
) -> int:
    """Reduce the films of a machine to a file of tables; returns the exit code."""
    target = tables_file.checked()
    case = _load(case_file, overrides)
    from toothspace.core.netcdf import write_dataset
    from toothspace.studies.reduce import reduce_films, reduce_summary

    pressures = [_positive("--pressure", text, "bar") for text in grid[0]]
    speeds = [_positive("--speed", text, "rpm") for text in grid[1]]
    with _file_named(case_file), output.progress(case.title) as progress:
        tables = reduce_films(case, kinds, progress, pressures=pressures, speeds=speeds)
    write_dataset(tables, target)
    summary = reduce_summary(tables)
    output.write(summary, as_json=as_json)
    output.message(f"Tables: {target}; read by [run] film_tables")
    return 0 if summary["status"] == Status.DONE.name.lower() else _NUMERICAL_FAILURE


def fmu(
    case_file: Path,
    unit: Target,
    options: FmuOptions,
    overrides: Sequence[str],
    *,
    as_json: bool,
) -> int:
    """Write a machine as a functional mock-up unit; returns the exit code."""
    target = unit.checked()
    case = _load(case_file, overrides)
    from toothspace.fmi.export import export_fmu

    pressures = [_positive("--pressure", text, "bar") for text in options.pressures]
    speeds = [_positive("--speed", text, "rpm") for text in options.speeds]
    with _file_named(case_file), output.progress(case.title) as progress:
        result = export_fmu(
            case,
            target,
            pressures=pressures,
            speeds=speeds,
            drive=options.drive,
            binary=options.binary,
            workers=options.workers,
            progress=progress,
        )
    summary = result.summary()
    output.write(summary, as_json=as_json)
    for warning in summary["warnings"]:
        output.message(f"Warning: {warning}")
    if result.status is not Status.DONE:
        output.message(f"{case_file}: no unit is written; the same command goes on from here.")
    elif summary["binary"]:
        output.message(f"Unit: {target}, sources and binary for {summary['binary']}")
    else:
        output.message(f"Unit: {target}, sources alone: importers compile them")
    return _EXIT_CODES.get(result.status, _NUMERICAL_FAILURE)


def validate(only: str, book: Target, *, short: bool, as_json: bool) -> int:
    """Examine the claims, write the book and print the verdicts; returns the exit code."""
    from toothspace.report.validation_book import summary_of, write_book
    from toothspace.validation.book import examine_all, selected

    target, claims = book.checked(), selected(only)
    with output.progress("validate:") as progress:
        examined = examine_all(claims, "short" if short else "full", progress)
    write_book(examined, target)
    summary = summary_of(examined)
    if as_json:
        output.write(summary, as_json=True)
    else:
        verdicts = summary["claims"].items()
        output.write({name: found["verdict"] for name, found in verdicts}, as_json=False)
    output.message(f"Validation book: {target}")
    return 0 if summary["status"] == "done" else _NUMERICAL_FAILURE


def app(folder: Path, port: int, *, browser: bool) -> int:
    """Serve the form until Ctrl-C; returns the exit code."""
    if not folder.is_dir():
        raise CaseError(f"{folder}: found no folder, allowed one with case files")
    import webbrowser

    from toothspace.app.server import FormServer
    from toothspace.app.session import Session

    with FormServer(Session(folder), port) as server:
        output.message(f"Open {server.address}\nEnd with Ctrl-C.")
        if browser:
            webbrowser.open(server.address)
        with suppress(KeyboardInterrupt):
            server.serve_forever()
    return 0


def warmup(*, as_json: bool) -> int:
    """Compile everything that runs need and print how long it took; returns the exit code."""
    from toothspace.core.compilation.cache import compiled_folder
    from toothspace.warmup import warm_up

    output.write(warm_up(), as_json=as_json)
    output.message(f"Compiled code: {compiled_folder()}")
    return 0


def init(name: str, folder: Path, *, force: bool = False) -> int:
    """Copy a shipped case with its files; returns the exit code."""
    from toothspace.case.shipped import copy_case

    written = copy_case(name, folder, replace=force)
    for path in written:
        output.message(f"Written: {path}")
    output.message(f"Next: toothspace run {written[0]}")
    return 0


def cases(*, as_json: bool) -> int:
    """List the shipped cases; returns the exit code."""
    from toothspace.case.shipped import shipped_cases

    output.write(shipped_cases(), as_json=as_json)
    return 0


def fluids(*, as_json: bool) -> int:
    """List the fluids of the library with their range of temperature; returns the exit code."""
    from toothspace.library import library_names, load_fluid

    found = {}
    for name in library_names("fluids"):
        low, high = load_fluid(name)["temperature_range_degC"]
        found[name] = f"{load_fluid(name)['title']}, {low:g} to {high:g} degC"
    output.write(found, as_json=as_json)
    return 0


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
            save_tables(description, outputs.tables)
        if outputs.text_folder is not None:
            folder = outputs.text_folder
            _put(folder, "--txt", outputs.force, lambda place: save_tables_txt(description, place))
    if outputs.plot is not None:
        _plot(description, outputs.plot)
    if outputs.export is not None:
        _export(case, outputs.export, force=outputs.force)


def _put(folder: Path, option: str, force: bool, write: Callable[[Path], object]) -> list[Path]:
    """Let files be written beside a folder and move them into it where they may stand."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder) as name:
        write(Path(name))
        drafts = sorted(Path(name).iterdir())
        targets = [Target(folder / draft.name, force).checked(option) for draft in drafts]
        for draft, target in zip(drafts, targets, strict=True):
            draft.replace(target)
    return targets


def _picture(path: Path) -> Path:
    if path.suffix.lower() not in PICTURE_SUFFIXES:
        allowed = ", ".join(PICTURE_SUFFIXES)
        raise CaseError(f"--plot: found the ending {path.suffix!r}, allowed {allowed}")
    return path


def _plot(description: Any, path: Path) -> None:
    from toothspace.plotting.geometry import openings, volumes
    from toothspace.plotting.style import save_figure

    save_figure(volumes(description), path)
    save_figure(openings(description), _second_plot(path))


def _second_plot(path: Path) -> Path:
    return path.with_stem(f"{path.stem}_openings")


def _export(case: Case, suffix: str, *, force: bool) -> None:
    exports = {name: f"{package}.export" for name, package in machine_modules().items()}
    module = exports[case.machine_type]
    if find_spec(module) is None:
        allowed = ", ".join(sorted(name for name, one in exports.items() if find_spec(one)))
        raise CaseError(f"--export: found machine type {case.machine_type!r}, allowed {allowed}")
    export = import_module(module).export_profiles
    for path in _put(
        Path(),
        "--export",
        force,
        lambda place: export(case.machine_spec, place / case.name, suffix),
    ):
        output.message(f"Profile: {path}")


@contextmanager
def _file_named(case_file: Path) -> Iterator[None]:
    """Put the case file in front of messages of later stages."""
    try:
        yield
    except ToothspaceError as error:
        if str(error).startswith(str(case_file)):
            raise
        raise type(error)(f"{case_file}: {error}") from error
