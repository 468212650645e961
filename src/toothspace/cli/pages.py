"""Commands that write pages or serve one; everything heavy is imported when it is needed."""

from __future__ import annotations

from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from toothspace.cli import output
from toothspace.cli.output import NUMERICAL_FAILURE, Force, Json
from toothspace.core.errors import CaseError
from toothspace.core.files import require_writable, write_text
from toothspace.core.status import Status

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

    from toothspace.results.solution import Solution

_MEASURED = {"shaft_speed": "rpm", "pressure_difference": "bar"}
"""Signals of a measurement that figures can lay over results."""
_EXPORTS = (".csv", ".xlsx", ".mat", ".vtkhdf", ".json", ".data", ".mo", ".zarr")
"""Formats of results for other programs, by the ending of the file."""


def report(
    result: Annotated[Path, typer.Argument(metavar="RESULT.nc", help="Result of a run.")],
    page: Annotated[
        Path | None,
        typer.Option("-o", "--output", help="HTML or PDF by suffix; default RESULT.html."),
    ] = None,
    measured: Annotated[
        Path | None,
        typer.Option(
            "--measured",
            help="CSV with 'time [s]' and 'shaft_speed [rpm]' or 'pressure_difference [bar]', "
            "laid over a run over time.",
        ),
    ] = None,
    force: Force = False,
) -> None:
    """Write the report of a result: a self-contained HTML page or a PDF document."""
    from toothspace.core.signals import column_names, read_columns
    from toothspace.report import ENDINGS, write_report
    from toothspace.results.solution import load_solution

    target = require_writable(
        page or result.with_suffix(".html"), "-o", replace=force, endings=ENDINGS
    )
    overlay = None
    if measured:
        names = column_names(measured)
        given = {name: unit for name, unit in _MEASURED.items() if name in names}
        overlay = read_columns(measured, {"time": "s", **(given or _MEASURED)})
    write_report(load_solution(result), target, measured=overlay)
    output.message(f"Report: {target}")


def compare(
    first: Annotated[Path, typer.Argument(metavar="A.nc", help="Result of a run.")],
    second: Annotated[Path, typer.Argument(metavar="B.nc", help="Result of another run.")],
    page: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="PAGE.html", help="HTML file.")
    ] = None,
    as_json: Json = False,
    force: Force = False,
) -> None:
    """Put two results side by side: keys, numbers, causes of loss."""
    target = (
        None if page is None else require_writable(page, "-o", replace=force, endings=(".html",))
    )
    from toothspace.report.comparison import Comparison
    from toothspace.results.solution import load_solution

    comparison = Comparison(load_solution(first), load_solution(second))
    # before the text, whose reader may leave early
    written = None if target is None else comparison.write(target)
    if as_json:
        output.write(comparison.to_dict(), as_json=True)
    else:
        for name, (one, two) in comparison.keys().items():
            output.line(f"{name}: {output.shown(one)} -> {output.shown(two)}")
        output.write_comparison(comparison.numbers())
        output.write_comparison({f"{n}, W": both for n, both in comparison.losses().items()})
    for warning in comparison.warnings():
        output.message(f"Warning: {warning}")
    for finding in comparison.finding_lines():
        output.message(finding)
    if written is not None:
        output.message(f"Comparison: {written}")


def animate(
    source: Annotated[
        Path, typer.Argument(metavar="CASE_OR_RESULT", help="Case to be run, or RESULT.nc.")
    ],
    film: Annotated[
        Path, typer.Option("-o", "--output", metavar="FILE", help="GIF, or MP4 by ffmpeg.")
    ],
    frames: Annotated[int, typer.Option(min=4, max=720, help="Pictures of one pitch.")] = 36,
    force: Force = False,
) -> int:
    """Draw a machine that turns, coloured by pressure, with forces and a cursor in a curve."""
    from toothspace.api import load_case, simulate
    from toothspace.plotting.animation import ENDINGS, write_animation
    from toothspace.results.solution import load_solution

    target = require_writable(film, "-o", replace=force, endings=ENDINGS)
    with output.progress(f"{source.stem}:") as progress:
        if source.suffix == ".nc":
            solution = load_solution(source)
        else:
            solution = simulate(load_case(source), progress)
        write_animation(solution, target, frames, progress)
    output.message(f"Moving picture: {target}")
    return 0 if solution.status.succeeded else NUMERICAL_FAILURE


def export(
    result: Annotated[
        Path, typer.Argument(metavar="RESULT", help="RESULT.nc of a run, or study.nc of a study.")
    ],
    target: Annotated[
        Path,
        typer.Option(
            "-o",
            "--output",
            metavar="FILE",
            help="File by its ending: .csv, .xlsx, .mat, .zarr; of a run also .vtkhdf and .json, "
            "of a map .data and .mo.",
        ),
    ],
    frames: Annotated[int, typer.Option(min=1, max=7200, help="States of a VTKHDF file.")] = 121,
    manufacturer: Annotated[
        str, typer.Option(metavar="NAME", help="Manufacturer, in technical data (.json).")
    ] = "",
    article: Annotated[
        str, typer.Option(metavar="NUMBER", help="Article number, in technical data (.json).")
    ] = "",
    client: Annotated[
        str,
        typer.Option(
            metavar="NAME", help="For whom a motor is sized: adds its submodel, and a .csv (.json)."
        ),
    ] = "",
    force: Force = False,
) -> int:
    """Write a result for other programs: tables, Excel, MATLAB, Zarr, ParaView, simulators."""
    from toothspace.core.netcdf import read_dataset
    from toothspace.results import exchange
    from toothspace.results.solution import load_solution
    from toothspace.results.technical_data import shell_files, write_technical_data

    parts = exchange.amesim_files(target) if target.suffix == ".data" else [target]
    parts = shell_files(target, client) if target.suffix == ".json" else parts
    for part in parts:
        # a Zarr store is a folder
        if not (force and part.suffix == ".zarr" and part.is_dir()):
            require_writable(part, "-o", replace=force, endings=_EXPORTS)
    data = read_dataset(result, "a NetCDF file of a run or study")
    solution = None if "study" in data.attrs else load_solution(result)
    data = data if solution is None else solution.data
    if target.suffix in {".vtkhdf", ".json"} and solution is None:
        raise CaseError("-o", f"a study for {target.suffix!r}", "the result of a run")
    if target.suffix == ".json" and solution is not None:
        write_technical_data(
            solution, target, manufacturer, article, client=client, project=result.name
        )
    elif target.suffix == ".vtkhdf" and solution is not None:
        from toothspace.plotting.space_series import write_space_series

        with output.progress(f"{result.stem}:") as progress:
            write_space_series(solution, target, frames, progress)
    elif target.suffix == ".mat":
        exchange.write_mat(data, target)
    elif target.suffix == ".zarr":
        exchange.write_zarr(data, target)
    elif target.suffix == ".data":
        exchange.write_amesim(data, target)
    elif target.suffix == ".mo":
        exchange.write_modelica(data, target)
    elif target.suffix == ".csv" and solution is not None:
        solution.to_csv(target)
    elif target.suffix == ".csv":
        write_text(target, _table(data, None).to_csv(index=False))
    else:
        exchange.write_workbook(_sheets(data, solution), target)
    output.message(f"Exported: {', '.join(map(str, parts))}")
    return 0


def _table(data: xr.Dataset, solution: Solution | None) -> pd.DataFrame:
    """Samples of a run or points of a study as rows, with ``name [unit]`` on top."""
    from toothspace.results.exchange import headed
    from toothspace.studies.study import StudyResult

    if solution is None:
        frame = StudyResult(Status.DONE, data, {}).to_dataframe()
    else:
        frame = solution.to_dataframe()
    return headed(
        frame, {str(name): str(data[name].attrs.get("units", "1")) for name in frame.index.names}
    )


def _sheets(data: xr.Dataset, solution: Solution | None) -> dict[str, pd.DataFrame]:
    """Sheets of a workbook: values, summary or coefficients of losses, and where they come from."""
    import pandas as pd

    from toothspace.results.variables import stem_and_unit

    sheets = {"points" if solution is None else "samples": _table(data, solution)}
    if solution is not None:
        rows = [(*stem_and_unit(name), value) for name, value in solution.summary().items()]
        sheets["summary"] = pd.DataFrame(rows, columns=["name", "unit", "value"])
    if "loss_coefficient" in data.sizes:
        names = [name for name in data.data_vars if data[name].dims == ("loss_coefficient",)]
        sheets["loss coefficients"] = data[names].to_dataframe().reset_index()
    attributes = data.attrs if solution is None else solution.provenance
    about = {name: value for name, value in attributes.items() if name != "case_toml"}
    sheets["about"] = pd.DataFrame(list(about.items()), columns=["name", "value"])
    return sheets


def validate(
    book: Annotated[
        Path, typer.Option("-o", "--output", help="HTML file; default validation_book.html.")
    ] = Path("validation_book.html"),
    only: Annotated[str, typer.Option(metavar="TEXT", help="Part of a claim, as elrod.")] = "",
    short: Annotated[
        bool, typer.Option("--short", help="Coarse grids and few points, in some minutes.")
    ] = False,
    workers: Annotated[int, typer.Option(min=1, max=1024, help="Processes.")] = 1,
    as_json: Json = False,
    force: Force = False,
) -> int:
    """Hold this version against published numbers and write the validation book."""
    from toothspace.report.validation_book import summary_of, write_book
    from toothspace.validation.book import examine_all, selected

    target, claims = require_writable(book, "-o", replace=force, endings=(".html",)), selected(only)
    with output.progress("validate:") as progress:
        examined = examine_all(claims, "short" if short else "full", progress, workers)
    write_book(examined, target)
    summary = summary_of(examined)
    verdicts = {name: found["verdict"] for name, found in summary["claims"].items()}
    output.write(summary if as_json else verdicts, as_json=as_json)
    output.message(f"Validation book: {target}")
    for key in summary["unexpected"]:
        output.message(f"{key}: {verdicts[key]}, other than this version announces")
    return 0 if summary["status"] == "done" else NUMERICAL_FAILURE


def app(
    folder: Annotated[
        Path, typer.Argument(metavar="DIR", help="Folder of case files and of files they name.")
    ] = Path(),
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port, 0 for a free one.")] = 0,
    host: Annotated[
        str, typer.Option(help="Address to listen on; other than 127.0.0.1, others get in.")
    ] = "127.0.0.1",
    browser: Annotated[bool, typer.Option(help="Open the browser.")] = True,
) -> None:
    """Design a machine in the browser, on this computer alone: it answers while you change it."""
    if not folder.is_dir():
        raise CaseError(folder, "no folder", "one with case files")
    import webbrowser

    from toothspace.app.server import HOST, BenchServer

    server = BenchServer(folder, port, host)
    if host != HOST:
        output.message("Warning: whoever reaches this address and knows the token gets in.")
    output.message(f"Open {server.address}\nEnd with Ctrl-C.")
    with server.door() as door:
        if browser:
            webbrowser.open(door)
        with suppress(KeyboardInterrupt):
            server.serve()
