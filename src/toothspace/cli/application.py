"""The program with its commands in their order."""

from __future__ import annotations

import json
from pathlib import Path
from typing import Annotated, Any, final

import typer
from typer.core import TyperGroup

import toothspace
from toothspace.cli import machines, output, pages, runs
from toothspace.cli.output import Force, Json, named
from toothspace.core.errors import CaseError


def init(
    name: Annotated[
        str | None, typer.Argument(metavar="NAME", help="Shipped case, see 'cases'.")
    ] = None,
    folder: Annotated[Path, typer.Argument(metavar="DIR", help="Where to.")] = Path(),
    new: Annotated[
        str, typer.Option("--new", metavar="MACHINE", help="Design a machine of this type.")
    ] = "",
    displacement: Annotated[str, typer.Option(help="Of a turn, as '14 cm^3'.")] = "",
    pressure: Annotated[str, typer.Option(help="Outlet pressure, as '210 bar'.")] = "",
    speed: Annotated[str, typer.Option(help="Shaft speed, as '1500 rpm'.")] = "",
    force: Force = False,
) -> None:
    """Start from a shipped case, or from displacement, pressure and speed of a new machine."""
    import tomllib

    from toothspace.case.shipped import copy_case

    given = {"--displacement": displacement, "--pressure": pressure, "--speed": speed}
    if new:
        missing = [option for option, text in given.items() if not text]
        if missing:
            raise CaseError(missing[0], "nothing", "a number with its unit beside --new")
        file = _designed(new, Path(name or "."), displacement, pressure, speed, force=force)
        output.message(f"Written: {file}\nNext: toothspace run {file}, or toothspace app")
        return
    if name is None:
        raise CaseError("NAME", "nothing", "a shipped case, see 'toothspace cases', or --new")
    unused = next((option for option, text in given.items() if text), None)
    if unused is not None:
        raise CaseError(unused, "a value", "leave it out without --new")
    written = copy_case(name, folder, replace=force)
    for path in written:
        output.message(f"Written: {path}")
    tables = tomllib.loads(written[0].read_text(encoding="utf-8"))
    command = next((c for c in ("study", "bearing", "film") if c in tables), "run")
    output.message(f"Next: toothspace {command} {written[0]}")


def _designed(
    machine: str, place: Path, displacement: str, pressure: str, speed: str, *, force: bool
) -> Path:
    from toothspace.api import new_case
    from toothspace.core.files import require_writable, write_text

    file = place if place.suffix == ".toml" else place / f"{machine}.toml"
    text = new_case(machine, displacement, pressure, speed)
    file.parent.mkdir(parents=True, exist_ok=True)
    return write_text(require_writable(file, "DIR", replace=force, endings=(".toml",)), text)


def cases(as_json: Json = False) -> None:
    """List the shipped cases, which every command knows by name."""
    from toothspace.case import shipped

    output.write(shipped.cases(), as_json=as_json)


def fluids(
    fluid: Annotated[
        str | None,
        typer.Argument(metavar="[FLUID]", help="Name, data sheet, table, or coolprop:NAME."),
    ] = None,
    table: Annotated[
        Path | None,
        typer.Option("-o", "--output", metavar="FILE.csv", help="Table of a fluid of CoolProp."),
    ] = None,
    as_json: Json = False,
    force: Force = False,
) -> None:
    """List the fluids of the library, or properties of one over its temperatures."""
    from toothspace import library
    from toothspace.model import coolprop

    if fluid is None:
        output.write(library.fluids(), as_json=as_json)
        return
    from toothspace.core.files import require_writable, write_text
    from toothspace.model.fluid import known_range, properties_table

    if fluid.startswith(coolprop.PREFIX) != (table is not None):
        found = "nothing" if table is None else f"{table} for {fluid}"
        allowed = f"a file .csv for the table of {coolprop.PREFIX}NAME, and only for that"
        raise CaseError("-o", found, allowed)
    if table is not None:
        require_writable(table, "-o", replace=force, endings=(".csv",))
        write_text(table, coolprop.coolprop_table(fluid.removeprefix(coolprop.PREFIX)))
        fluid = str(table)
    place = Path(fluid)
    source = place if place.suffix in {".toml", ".csv"} else fluid
    with named(place):
        rows, known = properties_table(source), known_range(source)
    if as_json:
        output.write({"properties": rows, "known": known}, as_json=True)
        return
    heads = list(rows[0])
    output.line("  ".join(heads))
    for row in rows:
        output.line("  ".join(f"{row[head]:{len(head)}.5g}" for head in heads))
    output.write(known, as_json=False)


def warmup(as_json: Json = False) -> None:
    """Compile everything that runs need, once, so that the first run starts at once."""
    from toothspace.core.compilation.sources import compiled_folder
    from toothspace.warmup import warm_up

    output.write(warm_up(), as_json=as_json)
    output.message(f"Compiled code: {compiled_folder()}")


def schema() -> None:
    """Print the JSON Schema of the case file."""
    from toothspace.case.case import case_schema

    output.line(json.dumps(case_schema(), indent=2, ensure_ascii=False))


@final
class _Commands(TyperGroup):
    """Commands with their whole first sentence, however narrow the terminal."""

    def format_commands(self, ctx: Any, formatter: Any) -> None:
        """List the commands."""
        rows = [
            (name, " ".join((command.help or "").partition("\n\n")[0].split()))
            for name in self.list_commands(ctx)
            if (command := self.get_command(ctx, name)) is not None
        ]
        with formatter.section("Commands"):
            formatter.write_dl(rows)


application = typer.Typer(
    name="toothspace",
    cls=_Commands,
    help="Simulate hydraulic gear machines.",
    rich_markup_mode=None,
    pretty_exceptions_enable=False,
    context_settings={"help_option_names": ["-h", "--help"]},
)


def _show_version(context: typer.Context, wanted: bool) -> None:
    if not wanted:
        return
    typer.echo(f"toothspace {toothspace.__version__}")
    if context.params["verbose"]:
        from toothspace.core.compilation.library import chosen

        way, reason, _ = chosen()
        typer.echo(f"compiled code: {way} ({reason})")
    raise typer.Exit


@application.callback()
def _options(
    verbose: Annotated[  # read by the callback of --version, which comes after it
        bool,
        typer.Option(
            "-v", "--verbose", is_eager=True, help="With --version: where compiled code is from."
        ),
    ] = False,
    _version: Annotated[
        bool, typer.Option("--version", callback=_show_version, help="Show the version.")
    ] = False,
) -> None:
    """Simulate hydraulic gear machines."""


for _command in (
    runs.run,
    machines.geometry,
    machines.gear,
    pages.report,
    pages.compare,
    runs.study,
    runs.bearing,
    runs.film,
    runs.reduce,
    runs.fmu,
    pages.validate,
    init,
    cases,
    fluids,
    pages.app,
    pages.animate,
    pages.export,
    warmup,
    schema,
):
    application.command()(_command)
