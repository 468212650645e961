"""The commands and their options."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

import toothspace
from toothspace.cli import commands

application = typer.Typer(
    name="toothspace",
    help="Simulate hydraulic gear machines.",
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)

CaseFile = Annotated[Path, typer.Argument(metavar="CASE.toml", help="Case file.")]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object.")]
Fields = Annotated[
    Path | None,
    typer.Option("-o", "--output", metavar="FIELDS", help="Fields of the film, .nc or .vts."),
]
Grids = Annotated[
    bool,
    typer.Option("--grids", help="Also on half and twice the cells: how far the grid matters."),
]
Force = Annotated[bool, typer.Option("--force", help="Replace files that exist.")]
Overrides = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Override a key of the case, repeatable."),
]


def _show_version(wanted: bool) -> None:
    if wanted:
        typer.echo(f"toothspace {toothspace.__version__}")
        raise typer.Exit


@application.callback()
def _options(
    _version: Annotated[
        bool,
        typer.Option("--version", callback=_show_version, is_eager=True, help="Show the version."),
    ] = False,
) -> None:
    """Simulate hydraulic gear machines."""


@application.command()
def run(
    case: CaseFile,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Result file; default CASE.nc here.")
    ] = None,
    as_json: Json = False,
    fidelity: Annotated[
        str | None, typer.Option(metavar="P", help="ideal, lumped, films or elastic.")
    ] = None,
    overrides: Overrides = None,
    force: Force = False,
) -> int:
    """Simulate a case and write the result."""
    given = [*(overrides or ()), *([f"run.fidelity={fidelity}"] if fidelity else ())]
    return commands.run(case, output, given, as_json=as_json, force=force)


@application.command()
def geometry(
    case: CaseFile,
    output: Annotated[
        Path | None, typer.Option("-o", "--output", help="Tables over the angle, NetCDF.")
    ] = None,
    text_folder: Annotated[
        Path | None, typer.Option("--txt", metavar="DIR", help="Tables as plain text.")
    ] = None,
    as_json: Json = False,
    plot: Annotated[
        Path | None,
        typer.Option(metavar="FILE.png", help="Pictures of volumes, and FILE_openings.png."),
    ] = None,
    export: Annotated[
        str | None,
        typer.Option(metavar="FORMAT", help="Profiles as dxf, stl, step or txt, written here."),
    ] = None,
    overrides: Overrides = None,
    force: Force = False,
) -> int:
    """Build the geometry tables of a machine and check its design."""
    outputs = commands.GeometryOutputs(output, text_folder, plot, export, force)
    return commands.geometry(case, outputs, overrides or [], as_json=as_json)


@application.command()
def gear(
    files: Annotated[
        list[Path],
        typer.Argument(metavar="FILE...", help="STEP, STL, DXF or points; parts of one frame."),
    ],
    unit: Annotated[str, typer.Option(help="mm, m, um or in; STEP has its own.")] = "mm",
    axis: Annotated[
        str | None, typer.Option(metavar="x|y|z", help="Gear axis; default by symmetry.")
    ] = None,
    plane: Annotated[
        str | None, typer.Option(metavar="LENGTH", help="Height of the section, as '3 mm'.")
    ] = None,
    distance: Annotated[
        str | None,
        typer.Option("--center-distance", metavar="LENGTH", help="Backlash at this distance."),
    ] = None,
    plot: Annotated[
        Path | None, typer.Option(metavar="FILE.png", help="Picture of the flank deviations.")
    ] = None,
    case: Annotated[
        Path | None, typer.Option(metavar="CASE.toml", help="Case file of the machine found.")
    ] = None,
    as_json: Json = False,
    force: Force = False,
) -> int:
    """Find the gears in CAD files and print what a drawing and a gear tester say."""
    section = commands.GearFileOptions(unit, axis, plane, distance)
    outputs = {
        option: commands.Target(path, force)
        for option, path in (("--plot", plot), ("--case", case))
        if path is not None
    }
    return commands.gear(files, section, outputs, as_json=as_json)


@application.command()
def report(
    result: Annotated[Path, typer.Argument(metavar="RESULT.nc", help="Result of a run.")],
    output: Annotated[
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
) -> int:
    """Write the report of a result: a self-contained HTML page or a PDF document."""
    return commands.report(result, output, measured, force=force)


@application.command()
def compare(
    first: Annotated[Path, typer.Argument(metavar="A.nc", help="Result of a run.")],
    second: Annotated[Path, typer.Argument(metavar="B.nc", help="Result of another run.")],
    output: Annotated[
        Path | None, typer.Option("-o", "--output", metavar="PAGE.html", help="HTML file.")
    ] = None,
    as_json: Json = False,
    force: Force = False,
) -> int:
    """Put two results side by side: keys, numbers, causes of loss."""
    target = None if output is None else commands.Target(output, force)
    return commands.compare(first, second, target, as_json=as_json)


@application.command()
def study(
    case: CaseFile,
    output: Annotated[
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
    options = commands.StudyOptions(output, workers, scheduler, resume, force)
    return commands.study(case, options, overrides or [], as_json=as_json)


@application.command()
def bearing(
    case: CaseFile,
    fields: Fields = None,
    as_json: Json = False,
    grids: Grids = False,
    overrides: Overrides = None,
    force: Force = False,
) -> int:
    """Solve a stand-alone journal bearing."""
    outputs = commands.FilmOutputs(fields, grids, force)
    return commands.stand_alone_film(case, "bearing", outputs, overrides or [], as_json=as_json)


@application.command()
def film(
    case: CaseFile,
    fields: Fields = None,
    as_json: Json = False,
    grids: Grids = False,
    overrides: Overrides = None,
    force: Force = False,
) -> int:
    """Solve a stand-alone film, as a pad, a ring or the face of a machine's bearing."""
    outputs = commands.FilmOutputs(fields, grids, force)
    return commands.stand_alone_film(case, "film", outputs, overrides or [], as_json=as_json)


@application.command()
def reduce(
    case: CaseFile,
    output: Annotated[
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
    target = commands.Target(output, force)
    grid = pressure or [], speed or []
    return commands.reduce(case, target, film or [], grid, overrides or [], as_json=as_json)


@application.command()
def fmu(
    case: CaseFile,
    output: Annotated[
        Path, typer.Option("-o", "--output", metavar="UNIT.fmu", help="File of the unit.")
    ],
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
    """Write a machine as a functional mock-up unit for simulators of systems (FMI 2.0)."""
    target = commands.Target(output, force)
    options = commands.FmuOptions(pressure or [], speed or [], drive, binary, workers)
    return commands.fmu(case, target, options, overrides or [], as_json=as_json)


@application.command()
def validate(
    output: Annotated[
        Path, typer.Option("-o", "--output", help="HTML file; default validation_book.html.")
    ] = Path("validation_book.html"),
    only: Annotated[str, typer.Option(metavar="TEXT", help="Part of a claim, as elrod.")] = "",
    short: Annotated[
        bool, typer.Option("--short", help="Coarse grids and few points, in some minutes.")
    ] = False,
    as_json: Json = False,
    force: Force = False,
) -> int:
    """Hold this version against published numbers and write the validation book."""
    return commands.validate(only, commands.Target(output, force), short=short, as_json=as_json)


@application.command()
def init(
    name: Annotated[str, typer.Argument(metavar="NAME", help="Shipped case, see 'cases'.")],
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Where to.")] = Path(),
    force: Force = False,
) -> int:
    """Start from a shipped case: copy it with the files that it names."""
    return commands.init(name, folder, force=force)


@application.command()
def cases(as_json: Json = False) -> int:
    """List the shipped cases, which 'run' and 'init' know by name."""
    return commands.cases(as_json=as_json)


@application.command()
def fluids(as_json: Json = False) -> int:
    """List the fluids of the library."""
    return commands.fluids(as_json=as_json)


@application.command()
def app(
    folder: Annotated[
        Path, typer.Argument(metavar="DIR", help="Folder of case files and of files they name.")
    ] = Path(),
    port: Annotated[int, typer.Option(min=0, max=65535, help="Port, 0 for a free one.")] = 0,
    browser: Annotated[bool, typer.Option(help="Open the browser.")] = True,
) -> int:
    """Fill in a case in the browser and run it, on this computer alone."""
    return commands.app(folder, port, browser=browser)


@application.command()
def warmup(as_json: Json = False) -> int:
    """Compile everything that runs need, once, so that the first run starts at once."""
    return commands.warmup(as_json=as_json)


@application.command()
def schema() -> int:
    """Print the JSON Schema of the case file."""
    return commands.schema()
