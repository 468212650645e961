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
