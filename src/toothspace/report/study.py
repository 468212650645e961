"""One self-contained HTML page per study."""

from __future__ import annotations

import math
from pathlib import Path
from typing import TYPE_CHECKING, Any

from toothspace.core.files import write_text
from toothspace.plotting.style import figure_to_svg, readable
from toothspace.report.card import machine_head
from toothspace.report.page import format_value, quantity, render, shown_unit
from toothspace.report.views import study_views, views_html
from toothspace.studies.study import StudyResult, StudyTable, study_figures

if TYPE_CHECKING:
    import xarray as xr

_LONGEST_TABLE = 400
_WIDEST_TABLE = 12
_MAPS = ({"shaft_speed", "pressure_difference"}, {"shaft_speed", "outlet_pressure"})
"""Axes of a map."""
_GOALS = (
    ("overall_efficiency", max, "Most efficient"),
    ("max_chamber_pressure_bar", min, "Lowest peak"),
    ("pressure_ripple_bar", min, "Quietest"),
)
"""Number, which of its values is best, and what a point with it is called."""


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
        machine=machine_head(result.provenance),
        answer=study_answer(result),
        views=views_html(study_views(result)),
        tables=[_table(table) for table in result.tables],
        provenance=[(k.replace("_", " "), v or "none") for k, v in provenance.items()],
        case_toml=result.provenance.get("case_toml", ""),
    )


def study_answer(result: StudyResult) -> list[str]:
    """Verdict on a study: its best points, or those of its map; else how many points were done."""
    said = [sentence for table in result.tables[:1] for sentence in best_points(table)]
    said = said or _best_of_map(result.data)
    if said:
        return said
    points, failed = (result.summary().get(name, 0) for name in ("points", "points_failed"))
    count = f"{points} points" if isinstance(points, int) and points > 1 else ""
    return [f"{count}, {failed or 'none'} failed."] if count else []


def _best_of_map(data: xr.Dataset) -> list[str]:
    """Sentence on the point of a map at which the machine is most efficient."""
    name = "overall_efficiency"
    if name not in data or set(data[name].dims) not in _MAPS:
        return []
    if not data[name].notnull().any():
        return []
    best = data[name].stack(point=data[name].dims)
    best = best[int(best.fillna(-1.0).argmax("point"))]
    speed = float(best["shaft_speed"]) * 30.0 / math.pi
    other = next(dim for dim in data[name].dims if dim != "shaft_speed")
    pressure, least = float(best[other]) / 1e5, float(data[name].min())
    return [
        f"Most efficient: overall {100.0 * float(best):.4g} % at {speed:.5g} rpm and "
        f"{pressure:.4g} bar {readable(str(other)).lower()}; least {100.0 * least:.4g} %."
    ]


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


def best_points(table: StudyTable) -> list[str]:
    """Sentences on the points of a table at which its numbers are best; none where they are equal.

    Each names the values that were varied there.
    """
    head, said = list(table.head), []
    varied = [k for k, name in enumerate(head) if "." in name]
    for name, goal, text in _GOALS:
        if name not in head or not varied or len(table.rows) < 2:
            continue
        column = head.index(name)
        values = [row[column] for row in table.rows]
        known = [k for k, v in enumerate(values) if isinstance(v, float) and math.isfinite(v)]
        found = [_cell(values[k]) for k in known]
        if len(set(found)) < 2:
            continue
        best = goal(known, key=lambda k: float(values[k]))
        label, value, unit = quantity(name, values[best])
        places = ", ".join(f"{_heading(head[k])[0]} {_cell(table.rows[best][k])}" for k in varied)
        said.append(f"{text}: {label.lower()} {value} {unit}".rstrip() + f" at {places}.")
    return said


def _heading(name: str) -> tuple[str, str]:
    """Name of a column in plain words with its unit, and the key behind it if it is one."""
    key, bracket, unit = name.partition(" (")
    if "." in key:
        words = key.removeprefix("machine.").replace(".", ", ").replace("_", " ")
        text = words[:1].upper() + words[1:]
        return f"{text}{bracket}{shown_unit(unit)}", key
    label, _, unit = quantity(name, "")
    return (f"{label} ({unit})" if unit else label), name


def _cell(value: float | str) -> str:
    if isinstance(value, str):
        return value
    return format_value(float(value)) if math.isfinite(value) else "–"
