"""Report of a result as a PDF document: the numbers of the page in text, then its figures."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any, NamedTuple

from toothspace.core.files import draft_of
from toothspace.plotting.style import GREY, INK, LIGHT, ORANGE, pdf_pages

if TYPE_CHECKING:
    from matplotlib.figure import Figure

_WIDTH, _HEIGHT, _MARGIN = 8.27, 11.69, 0.75
_LINE = 0.19
_COLUMNS = 96


class TextLine(NamedTuple):
    """Cells of a line with their places from the left margin [in]; places below zero end there."""

    cells: tuple[tuple[float, str], ...]
    size: float = 8.5
    weight: str = "normal"
    colour: str = INK
    rule: bool = False


def write_document(
    path: Path, contents: Mapping[str, Any], figures: Sequence[tuple[str, Figure]]
) -> Path:
    """Write a report as PDF.

    Parameters
    ----------
    path : Path
        File to write, complete or not there.
    contents : mapping
        Numbers and texts as :func:`toothspace.report.html.report_contents` gives them.
    figures : sequence of (caption, Figure)
        Figures in their order, one page each.
    """
    with draft_of(path) as draft, pdf_pages(draft, contents["title"]) as keep:
        lines = list(document_lines(contents))
        count = int((_HEIGHT - 2.0 * _MARGIN) / _LINE)
        for first in range(0, len(lines), count):
            keep(_text_page(lines[first : first + count]))
        for caption, figure in figures:
            figure.supxlabel("\n".join(wrap(caption, 100)), fontsize=8, color=GREY)
            keep(figure, bbox_inches="tight", pad_inches=_MARGIN)
    return path


def _text_page(lines: Sequence[TextLine]) -> Figure:
    from matplotlib.figure import Figure

    page = Figure(figsize=(_WIDTH, _HEIGHT))
    for k, line in enumerate(lines):
        height = 1.0 - (_MARGIN + k * _LINE) / _HEIGHT
        for place, text in line.cells:
            right = place < 0.0
            page.text(
                (_MARGIN + abs(place)) / _WIDTH,
                height,
                text.replace("$", r"\$"),
                ha="right" if right else "left",
                va="top",
                fontsize=line.size,
                fontweight=line.weight,
                color=line.colour,
            )
        if line.rule:
            from matplotlib.lines import Line2D

            ends = (_MARGIN / _WIDTH, 1.0 - _MARGIN / _WIDTH)
            below = height - 0.9 * _LINE / _HEIGHT
            page.add_artist(Line2D(ends, (below, below), color=LIGHT, linewidth=0.8))
    return page


def document_lines(contents: Mapping[str, Any]) -> Iterator[TextLine]:
    """All text of the document, line by line."""
    yield TextLine(((0.0, contents["title"]),), 14.0, "bold")
    yield TextLine(())
    status = contents["status_line"].replace("_", " ")
    yield from _paragraph(f"{contents['machine']} {contents['mode']}, {status}", GREY, gap=False)
    yield from _paragraph(contents["verdict"])
    for finding in contents["findings"]:
        yield from _paragraph(str(finding), ORANGE)
    key = [(x.label, f"{x.value} {x.unit}") for x in contents["key_numbers"]]
    yield from _table("Key numbers", key)
    yield from _causes(contents["causes"])
    lost = [
        (row["label"].capitalize(), f"{row['flow']} L/min", f"{row['share']} %")
        for row in contents["lost_flow"]
    ]
    if lost:
        yield from _table("Lost flow, and its share of the kinematic flow", lost)
    if contents["temperatures"]:
        rows = [(x.label, f"{x.value} {x.unit}") for x in contents["temperatures"]]
        yield from _table("Temperatures", rows)
    if contents["limits"]:
        yield from _heading("Limits")
    for limit in contents["limits"]:
        colour = ORANGE if limit.verdict == "exceeded" else INK
        cells = (0.0, limit.label), (-5.2, limit.value), (5.3, limit.allowed)
        yield TextLine(cells, colour=colour)
        yield TextLine(((0.2, f"{limit.verdict}; {limit.source}"),), 7.0, colour=GREY, rule=True)
    checks = [
        (shown.label, f"{shown.value} {shown.unit}", "met" if check.passed else "not met")
        for check, shown in contents["checks"]
    ]
    yield from _table("Design rules", checks)
    ledger = [(row.label, f"{w} W", f"{share} %") for row, w, share in contents["ledger_rows"]]
    yield from _table("Power ledger", ledger)
    numbers = [(x.label, f"{x.value} {x.unit}") for x in contents["summary"].values()]
    yield from _table("All numbers", numbers)
    yield from _table("Provenance", [])
    for name, value in contents["provenance"]:
        yield from _paragraph(f"{name}: {value}", gap=False)
    for line in contents["case_toml"].splitlines():
        yield TextLine(((0.0, line[:_COLUMNS]),), 7.0)


def _heading(title: str) -> Iterator[TextLine]:
    yield TextLine(())
    yield TextLine(((0.0, title),), 10.5, "bold", rule=True)


def _paragraph(text: str, colour: str = INK, *, gap: bool = True) -> Iterator[TextLine]:
    for line in wrap(text, _COLUMNS):
        yield TextLine(((0.0, line),), colour=colour)
    if gap:
        yield TextLine((), 4.0)


def _table(title: str, rows: Sequence[tuple[str, ...]]) -> Iterator[TextLine]:
    yield from _heading(title)
    for row in rows:
        places = (0.0, -5.4, -6.6)
        yield TextLine(tuple(zip(places, row, strict=False)), rule=True)


def _causes(groups: Sequence[Mapping[str, Any]]) -> Iterator[TextLine]:
    yield from _heading("Losses by cause: power, points of efficiency, leakage")
    for group in groups:
        cells = (0.0, group["cause"].capitalize()), (-4.2, f"{group['power']} W")
        yield TextLine((*cells, (-5.4, f"{group['share']} %")), weight="bold", rule=True)
        for row in group["rows"]:
            flow = f"{row['flow']} L/min" if row["flow"] else ""
            parts = (0.2, row["label"]), (-4.2, f"{row['power']} W"), (-5.4, f"{row['share']} %")
            yield TextLine((*parts, (-6.7, flow)), rule=True)
