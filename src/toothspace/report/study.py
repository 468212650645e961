"""One self-contained HTML page per study."""

from __future__ import annotations

import math
from pathlib import Path
from typing import Any

from toothspace.core.files import write_text
from toothspace.plotting.style import figure_to_svg
from toothspace.report.page import format_value, quantity, render
from toothspace.studies.study import StudyResult, StudyTable, study_figures

_LONGEST_TABLE = 400
_WIDEST_TABLE = 12


def write_study_report(result: StudyResult, path: str | Path) -> Path:
    """Write the page of a study; returns its path.

    Parameters
    ----------
    result : StudyResult
        Result, complete or not.
    """
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    return write_text(target, study_report_html(result))


def study_report_html(result: StudyResult) -> str:
    """Return the page of a study as HTML text."""
    figures = study_figures(result.kind, result.data)
    provenance = {k: v for k, v in result.provenance.items() if k != "case_toml"}
    return render(
        "study.html.j2",
        title=result.title,
        kind=result.kind.replace("_", " "),
        status=result.status,
        # its lists stand in the tables
        numbers=[
            quantity(name, value)
            for name, value in result.summary().items()
            if isinstance(value, (int, float, str)) and name != "status"
        ],
        figures=[(f.name, f.caption, figure_to_svg(f.figure)) for f in figures],
        tables=[_table(table) for table in result.tables],
        provenance=[(k.replace("_", " "), v or "none") for k, v in provenance.items()],
        case_toml=result.provenance.get("case_toml", ""),
    )


def _table(table: StudyTable) -> dict[str, Any]:
    """Head and text of a table, with few enough columns to be read on a page."""
    # those in which something changes
    changing = [
        k
        for k in range(len(table.head))
        if len(table.rows) < 2 or len({_cell(row[k]) for row in table.rows}) > 1
    ]
    kept = changing[:_WIDEST_TABLE]
    rows = [[_cell(row[k]) for k in kept] for row in table.rows[:_LONGEST_TABLE]]
    return {
        "name": table.name,
        "head": [_heading(table.head[k]) for k in kept],
        "rows": rows,
        "left_out": len(table.rows) - len(rows),
        "columns_left_out": len(table.head) - len(kept),
    }


def _heading(name: str) -> str:
    """Key paths stay as they are in a case file."""
    if "." in name:
        return name
    label, _, unit = quantity(name, "")
    return f"{label} ({unit})" if unit else label


def _cell(value: float | str) -> str:
    if isinstance(value, str):
        return value
    return format_value(float(value)) if math.isfinite(value) else "–"
