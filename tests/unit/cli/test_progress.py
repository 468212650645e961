"""Progress: phases with names, shares that stay in order, and what is shown of them."""

from __future__ import annotations

import io
import math
import sys
from pathlib import Path

import pytest

from toothspace import api
from toothspace.case import load_case
from toothspace.cli import output
from toothspace.core.progress import UNKNOWN, part, report_share, reporting_to, tell

CASES = Path(__file__).resolve().parents[3] / "cases"


class Told:
    """Keeps what is reported."""

    def __init__(self) -> None:
        self.reports: list[tuple[float, str]] = []

    def __call__(self, share: float, text: str) -> None:
        self.reports.append((share, text))


def test_a_part_lies_within_the_whole() -> None:
    told = Told()
    second = part(told, "journals", 0.5, 1.0)
    tell(second, 0.0, "")
    tell(second, 0.5, "drive")
    tell(second, UNKNOWN, "driven")
    assert told.reports == [(0.5, "journals"), (0.75, "journals, drive"), (0.5, "journals, driven")]


def test_the_end_of_a_phase_of_its_own_may_be_unknown() -> None:
    told = Told()
    tell(part(told, "running-in"), UNKNOWN, "revolution 3")
    ((share, text),) = told.reports
    assert math.isnan(share)
    assert text == "running-in, revolution 3"


def test_nobody_listens() -> None:
    assert part(None, "running-in") is None
    tell(None, 0.5, "revolution")


def test_running_in_and_run_are_told(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    from toothspace.run import running_in

    monkeypatch.setattr(running_in, "load_arrays", lambda path: None)
    monkeypatch.setattr(running_in, "keep_arrays", lambda *given: None)
    told = Told()
    api.simulate(load_case(CASES / "egm12_pump.toml"), told)
    texts = [text for _, text in told.reports]
    assert texts[0] == "running-in, revolution 1"
    assert texts[-1].startswith("revolution ")


def test_without_a_terminal_lines_are_rare(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    clock = iter([0.0, 1.0, 9.9, 10.1, 11.0, 25.0])
    monkeypatch.setattr(output.time, "monotonic", lambda: next(clock))
    with output.progress("EGM-12") as progress:
        for k in range(5):
            progress(0.2 * k if k < 4 else UNKNOWN, f"point {k}")
    assert capsys.readouterr().err.splitlines() == ["EGM-12 point 2, 40 %", "EGM-12 point 4"]


class Terminal(io.StringIO):
    def isatty(self) -> bool:
        return True


def test_the_bar_begins_anew_with_each_phase(monkeypatch: pytest.MonkeyPatch) -> None:
    from rich.progress import Progress as Bar

    seen: list[tuple[float | None, float]] = []
    update = Bar.update

    def watched(bar: Bar, task: object, **given: object) -> None:
        update(bar, task, **given)  # type: ignore[arg-type]
        seen.append((bar.tasks[0].total, bar.tasks[0].completed))

    monkeypatch.setattr(Bar, "update", watched)
    monkeypatch.setattr(sys, "stderr", Terminal())
    with output.progress("EGM-12") as progress:
        for share in (0.5, 1.0, UNKNOWN, UNKNOWN, 0.1, 0.6, 0.2):
            progress(share, "phase")
    totals = [total for total, _ in seen]
    assert totals == [1.0, 1.0, None, None, 1.0, 1.0, 1.0]
    assert [done for _, done in seen] == [0.5, 1.0, 0.0, 0.0, 0.1, 0.6, 0.2]


def test_only_the_innermost_listener_hears_what_is_said_inside_its_block() -> None:
    outer: list[tuple[float, str]] = []
    inner: list[tuple[float, str]] = []
    with reporting_to(lambda share, text: outer.append((share, text))):
        with reporting_to(lambda share, text: inner.append((share, text))):
            report_share(0.5, "condensing")
        report_share(1.0, "done")
    report_share(0.0, "nobody listens")
    assert inner == [(0.5, "condensing")]
    assert outer == [(1.0, "done")]
