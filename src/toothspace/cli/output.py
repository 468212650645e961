"""What commands share: options, exit codes, summaries, messages and progress."""

from __future__ import annotations

import json
import math
import sys
import time
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any, final

import typer

from toothspace.core.errors import CaseError
from toothspace.core.files import plain
from toothspace.core.progress import Progress, reporting_to
from toothspace.core.status import Status

if TYPE_CHECKING:
    from toothspace.case import Case
    from toothspace.model.description import DesignCheck


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
_LINE_EVERY = 10.0
"""Interval of progress lines when output is not a terminal. [s]"""
_LONGEST_LIST = 20
"""Longer lists of numbers are shown by their range; JSON and the result hold all."""


def load(case_file: Path, overrides: Sequence[str] | None) -> Case:
    """Read a case with the values of ``--set`` laid over it, and refuse an impossible machine.

    Says so where compiled code is made anew, in a checkout whose sources have changed.
    """
    from toothspace.case import load_case
    from toothspace.core.compilation.library import compiles_first

    reason = compiles_first()
    if reason:
        message(f"Note: {reason}; what is used is compiled first. make kernels builds it.")
    return load_case(case_file, overrides or ()).check()


def exit_code(case_file: Path, status: Status) -> int:
    """Say what a status other than done means; returns the exit code."""
    if status is not Status.DONE:
        message(f"{case_file}: {status.name.lower()}: {status.value}")
    return code_of(status)


def code_of(status: Status) -> int:
    """Exit code that a status gives."""
    return _EXIT_CODES.get(status, NUMERICAL_FAILURE)


def read_quantity(option: str, text: str, unit: str) -> float:
    """Return the quantity of an option. [SI unit].

    Raises CaseError if it is no number with a unit of that dimension.
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


def line(text: str) -> None:
    """Write one text to standard output."""
    sys.stdout.write(text + "\n")


def message(text: str) -> None:
    """Write one line to standard error."""
    sys.stderr.write(text + "\n")


def write(summary: Mapping[str, Any], *, as_json: bool) -> None:
    """Write named numbers, as one JSON object or as aligned text."""
    values = plain(summary)
    if as_json:
        line(json.dumps(values, allow_nan=False))
        return
    width = max((len(name) for name in values), default=0)
    for name, value in values.items():
        line(f"{name:<{width}}  {shown(value)}")


def write_tables(groups: Mapping[str, Any]) -> None:
    """Write named lists of named numbers as text, one block for each item."""
    for name, items in groups.items():
        for number, item in enumerate(items):
            one = name.removesuffix("ies") + "y" if name.endswith("ies") else name.removesuffix("s")
            line(f"{one.replace('_', ' ')} {number + 1}" if len(items) > 1 else name)
            write({f"  {key}": value for key, value in item.items()}, as_json=False)


def write_comparison(pairs: Mapping[str, tuple[float, float]]) -> None:
    """Write pairs of numbers with their difference, also in percent of the first."""
    # with what draws pages
    from toothspace.report.comparison import shown_change

    width = max((len(name) for name in pairs), default=0)
    line(f"{'':<{width}}  {'first':>12} {'second':>12} {'difference':>12} {'':>9}")
    for name, (one, two) in pairs.items():
        change = shown_change(name, one, two)
        line(f"{name:<{width}}  {one:12.6g} {two:12.6g} {two - one:12.4g} {change:>9}")


def shown(value: Any) -> str:
    """Return a value as short text."""
    if isinstance(value, float):
        return f"{value:.6g}"
    is_list = isinstance(value, list)
    found = [v for v in value if v is not None] if is_list else []
    if len(found) > _LONGEST_LIST and all(isinstance(v, (int, float)) for v in found):
        missing = f" and {len(value) - len(found)} missing" * (len(found) < len(value))
        return f"{len(found)} values{missing}, {shown(min(found))} to {shown(max(found))}"
    if is_list:
        return ", ".join(shown(item) for item in value) or "none"
    if isinstance(value, dict):
        return ", ".join(f"{name} {shown(item)}" for name, item in value.items()) or "none"
    return "-" if value is None else str(value)


def write_checks(checks: Sequence[DesignCheck]) -> None:
    """Write the design-rule report as text."""
    for check in checks:
        verdict = "ok  " if check.passed else "LOOK"
        unit = f" {check.unit}" if check.unit not in {"", "-", "1"} else ""
        line(f"{verdict}  {check.name}: {check.value:.4g}{unit} (allowed {check.allowed})")
        if not check.passed:
            line(f"      {check.reason}")


@contextmanager
def progress(title: str) -> Iterator[Progress]:
    """Show on standard error how far a run is: a bar, or a line now and then without a terminal."""
    if not sys.stderr.isatty():
        lines = _Lines(title)
        with reporting_to(lines):
            yield lines
        return
    from rich.console import Console
    from rich.progress import BarColumn, TextColumn, TimeElapsedColumn, TimeRemainingColumn
    from rich.progress import Progress as Bar

    columns = (
        TextColumn("{task.description}"),
        BarColumn(),
        TimeElapsedColumn(),
        TimeRemainingColumn(elapsed_when_finished=True),
    )
    with Bar(*columns, console=Console(stderr=True), transient=True) as bar:
        task, before = bar.add_task(title, total=None), math.inf

        def advance(share: float, text: str = "") -> None:
            nonlocal task, before
            known = math.isfinite(share)
            if not share >= before:
                # another phase, with a pace of its own
                bar.remove_task(task)
                task = bar.add_task(title, total=1.0 if known else None)
            before = share if known else math.inf
            done = share if known else 0.0
            bar.update(task, completed=done, description=f"{title} {text}".strip())

        with reporting_to(advance):
            yield advance


@final
class _Lines:
    """Progress as plain lines, none before a run has taken some time."""

    def __init__(self, title: str) -> None:
        self._title = title
        self._shown = time.monotonic()

    def __call__(self, share: float, text: str = "") -> None:
        now = time.monotonic()
        if now - self._shown < _LINE_EVERY:
            return
        self._shown = now
        done = f", {100.0 * share:.0f} %" if math.isfinite(share) else ""
        message(f"{self._title} {text}{done}".strip())
