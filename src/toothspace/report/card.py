"""A solution as a notebook and the page show it: status, findings, key numbers, section."""

from __future__ import annotations

from html import escape

from toothspace.core.finding import status_line
from toothspace.plotting.style import figure_to_svg
from toothspace.results.solution import Solution

_KEY_NUMBERS = 12


def solution_card(solution: Solution) -> str:
    """Return a solution as a short piece of HTML."""
    rows = [
        f"<tr><th style='text-align:left'>{escape(name)}</th>"
        f"<td>{f'{value:.5g}' if isinstance(value, float) else escape(str(value))}</td></tr>"
        for name, value in list(solution.summary().items())[:_KEY_NUMBERS]
    ]
    plot = solution.plot
    section = figure_to_svg(plot.section()) if "gear_section" in plot.names() else ""
    head = escape(solution.provenance.get("title", solution.data.attrs.get("title", "")))
    status = escape(status_line(solution.status, solution.findings))
    found = "".join(f"<li>{escape(str(finding))}</li>" for finding in solution.findings)
    table = f"<table>{''.join(rows)}</table>"
    return f"<h4>{head}</h4><p>{status}</p><ul>{found}</ul>{table}<div>{section}</div>"
