"""A case or a solution as a notebook and the page show it: what it is, numbers, section."""

from __future__ import annotations

import math
from html import escape
from typing import Any

from toothspace import api
from toothspace.case import Case
from toothspace.case.document import CONDITIONS
from toothspace.core.finding import status_line
from toothspace.plotting.style import figure_to_svg, html_table, readable
from toothspace.results.solution import Solution

_KEY_NUMBERS = 12


def case_card(case: Case) -> str:
    """Return a case as a short piece of HTML: machine, condition, section before any run."""
    given = case.to_dict()
    condition = next(name for name in CONDITIONS if getattr(case, name) is not None)
    rows: dict[str, Any] = {"fidelity": case.run.fidelity, **given.get("fluid", {})}
    rows |= {name: v for name, v in given[condition].items() if not isinstance(v, (dict, list))}
    section = ""
    if case.machine is not None:
        displacement = 2e6 * math.pi * api.describe(case).displacement
        head = {"machine": f"{readable(case.machine_type)}, {case.machine.mode}"}
        rows = head | {"displacement": f"{displacement:.4g} cm³/rev"} | rows
        section = figure_to_svg(case.plot.section())
    return f"<h4>{escape(case.title)}</h4>{html_table(rows)}<div>{section}</div>"


def solution_card(solution: Solution) -> str:
    """Return a solution as a short piece of HTML."""
    rows = dict(list(solution.summary().items())[:_KEY_NUMBERS])
    plot = solution.plot
    section = figure_to_svg(plot.section()) if "gear_section" in plot.names() else ""
    head = escape(solution.provenance.get("title", solution.data.attrs.get("title", "")))
    status = escape(status_line(solution.status, solution.findings))
    found = "".join(f"<li>{escape(str(finding))}</li>" for finding in solution.findings)
    return f"<h4>{head}</h4><p>{status}</p><ul>{found}</ul>{html_table(rows)}<div>{section}</div>"
