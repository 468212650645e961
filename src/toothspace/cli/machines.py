"""Commands on the shape of machines: geometry tables, and gears in CAD files."""

from __future__ import annotations

import tempfile
from collections.abc import Callable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from toothspace.cli import output
from toothspace.cli.output import CaseFile, Force, Json, Overrides, load, named, read_quantity
from toothspace.core.errors import CaseError
from toothspace.core.files import require_writable
from toothspace.core.registry import machine_type_names, optional_function

if TYPE_CHECKING:
    from toothspace.case import Case
    from toothspace.geometry.body_section import SectionRequest

_EXPORT_FORMATS = ("dxf", "stl", "step", "txt")
_FILE_UNITS = ("mm", "m", "um", "in")
_PICTURES = (".png", ".svg", ".pdf")


def geometry(
    case_file: CaseFile,
    tables: Annotated[
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
) -> None:
    """Build the geometry tables of a machine and check its design."""
    if export is not None and export not in _EXPORT_FORMATS:
        allowed = ", ".join(_EXPORT_FORMATS)
        raise CaseError(f"{case_file}: --export", f"{export!r}", allowed)
    case = load(case_file, overrides)
    plots = [] if plot is None else [plot, plot.with_stem(f"{plot.stem}_openings")]
    if tables is not None:
        require_writable(tables, "-o", replace=force, endings=(".nc",))
    for picture in plots:
        require_writable(picture, "--plot", replace=force, endings=_PICTURES)
    from toothspace import api
    from toothspace.results.file_layout import save_tables, save_tables_txt

    with named(case_file):
        description = api.describe(case)
        _ = description.lateral_balance  # an impossible floating bearing is refused here, too
        if tables is not None:
            save_tables(description, tables)
        if text_folder is not None:
            _put(text_folder, "--txt", force, lambda place: save_tables_txt(description, place))
        if plots:
            from toothspace.plotting.geometry import openings, volumes
            from toothspace.plotting.style import save_figure

            for draw, picture in zip((volumes, openings), plots, strict=True):
                save_figure(draw(description), picture)
        if export is not None:
            _export(case, export, force=force)
    summary = dict(description.geometry_summary)
    summary.setdefault("warnings", [check.name for check in description.checks if not check.passed])
    output.write(summary, as_json=as_json)
    if not as_json:
        output.write_checks(description.checks)


def _put(folder: Path, option: str, force: bool, write: Callable[[Path], object]) -> list[Path]:
    """Let files be written beside a folder and move them into it where they may stand."""
    folder.mkdir(parents=True, exist_ok=True)
    with tempfile.TemporaryDirectory(dir=folder) as name:
        write(Path(name))
        drafts = sorted(Path(name).iterdir())
        targets = [
            require_writable(folder / one.name, option, replace=force, endings=(one.suffix,))
            for one in drafts
        ]
        for draft, target in zip(drafts, targets, strict=True):
            draft.replace(target)
    return targets


def _export(case: Case, suffix: str, *, force: bool) -> None:
    export = optional_function(case.machine_type, "export_profiles")
    if export is None:
        names = machine_type_names()
        allowed = ", ".join(name for name in names if optional_function(name, "export_profiles"))
        raise CaseError("--export", f"machine type {case.machine_type!r}", allowed)

    def write(place: Path) -> None:
        export(case.machine_spec, place / case.name, suffix)

    for path in _put(Path(), "--export", force, write):
        output.message(f"Profile: {path}")


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
    layer: Annotated[str | None, typer.Option(metavar="NAME", help="Layer of DXF files.")] = None,
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
) -> None:
    """Find the gears in CAD files and print what a drawing and a gear tester say."""
    from toothspace.core.units import to_si
    from toothspace.geometry.body_section import AXES, SectionRequest
    from toothspace.geometry.cad_import import STEP_SUFFIXES
    from toothspace.geometry.gear_data import (
        contact_notes,
        file_report,
        flank_warnings,
        likelier_units,
    )
    from toothspace.geometry.gear_finder import find_in_files

    file = files[0]
    if unit not in _FILE_UNITS:
        allowed = ", ".join(_FILE_UNITS)
        raise CaseError(f"{file}: --unit", f"{unit!r}", allowed)
    if axis not in (None, *AXES):
        raise CaseError(f"{file}: --axis", f"{axis!r}", ", ".join(AXES))
    if plot is not None:
        require_writable(plot, "--plot", replace=force, endings=_PICTURES)
    if case is not None:
        require_writable(case, "--case", replace=force, endings=(".toml",))
    height = None if plane is None else read_quantity("--plane", plane, "mm")
    request = SectionRequest(axis, height, layer=layer)
    try:
        contents = find_in_files(files, to_si(1.0, unit), request)
    except CaseError:
        # rotors with few lobes are no gears
        if case is None:
            raise
        _draft(files, unit, request, case)
        return
    if file.suffix.lower() not in STEP_SUFFIXES:
        scales = {name: to_si(1.0, name) / to_si(1.0, unit) for name in _FILE_UNITS}
        for better in likelier_units(contents, scales):
            output.message(f"Note: with --unit {better} the gear has a standard module")
    for warning in flank_warnings(contents):
        output.message(f"Warning: {warning}")
    for note in contact_notes(contents):
        output.message(f"Note: {note}")
    length = None if distance is None else read_quantity("--center-distance", distance, "mm")
    found = file_report(contents, length)
    fits = {
        one.name or f"gear {number + 1}": one.detected.involute
        for number, one in enumerate(contents.gears)
        if one.detected.involute is not None
    }
    if plot is not None and fits:
        from toothspace.plotting.geometry import flank_deviation
        from toothspace.plotting.style import save_figure

        save_figure(flank_deviation(fits), plot)
        output.message(f"Picture: {plot}")
    if case is not None:
        _draft(files, unit, request, case)
    # after the files, as its reader may leave early
    if as_json:
        output.write(found, as_json=True)
    else:
        output.write_tables(found)


def _draft(files: Sequence[Path], unit: str, request: SectionRequest, target: Path) -> None:
    from toothspace import api
    from toothspace.core.files import write_text

    write_text(target, api.draft_case(files, unit, request, target.parent))
    output.message(f"Case: {target}")
    try:
        api.load_case(target).check()
    except CaseError as error:
        output.message(f"Note: it does not run as it is: {error}")
