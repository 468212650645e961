"""The program with its commands in their order."""

from __future__ import annotations

from typing import Annotated

import typer

import toothspace
from toothspace.cli import lists, machines, pages, runs

application = typer.Typer(
    name="toothspace",
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
    lists.init,
    lists.cases,
    lists.fluids,
    pages.app,
    lists.warmup,
    lists.schema,
):
    application.command()(_command)
