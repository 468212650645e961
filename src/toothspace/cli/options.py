"""Arguments that several commands share, and what all of them do with cases and files."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from toothspace.cli import output
from toothspace.core.errors import CaseError
from toothspace.core.status import Status

if TYPE_CHECKING:
    from toothspace.case import Case

CaseFile = Annotated[
    Path, typer.Argument(metavar="CASE.toml", help="Case file, or name of a shipped case.")
]
Json = Annotated[bool, typer.Option("--json", help="Print one JSON object.")]
Force = Annotated[bool, typer.Option("--force", help="Replace files that exist.")]
Overrides = Annotated[
    list[str] | None,
    typer.Option("--set", metavar="KEY=VALUE", help="Override a key of the case, repeatable."),
]

BAD_INPUT, NUMERICAL_FAILURE, INTERRUPTED = 2, 3, 130
_EXIT_CODES = {Status.DONE: 0, Status.INTERRUPTED: INTERRUPTED}


def load(case_file: Path, overrides: Sequence[str] | None) -> Case:
    """Read a case with the values of ``--set`` laid over it, and refuse an impossible machine."""
    from toothspace.case import load_case

    return load_case(case_file, overrides or ()).check()


def exit_code(case_file: Path, status: Status) -> int:
    """Say what a status other than done means; returns the exit code."""
    if status is not Status.DONE:
        output.message(f"{case_file}: {status.name.lower()}: {status.value}")
    return code_of(status)


def code_of(status: Status) -> int:
    """Exit code that a status gives."""
    return _EXIT_CODES.get(status, NUMERICAL_FAILURE)


def read_quantity(option: str, text: str, unit: str) -> float:
    """Return the quantity of an option. [SI unit].

    Raises
    ------
    CaseError
        If it is no number with a unit of that dimension.
    """
    from toothspace.core.units import parse_quantity

    try:
        return parse_quantity(text, unit)
    except CaseError as error:
        raise error.read_for(option) from error


@contextmanager
def named(case_file: Path) -> Iterator[None]:
    """Put the case file in front of messages of later stages."""
    try:
        yield
    except CaseError as error:
        raise error.in_file(str(case_file)) from error
