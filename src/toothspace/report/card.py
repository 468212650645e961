"""A case or a solution as a notebook and the page show it: what it is, numbers, section."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import Any, final

from toothspace import api
from toothspace.case import Case
from toothspace.case.document import CONDITIONS
from toothspace.core.errors import CaseError
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


@final
@dataclass(frozen=True)
class MachineHead:
    """The machine of a result, as its page begins with."""

    words: str = ""
    """Type, use and displacement."""
    section: str = ""
    """Its section as SVG; empty without a machine, or where it cannot be rebuilt."""


def machine_head(provenance: Mapping[str, str]) -> MachineHead:
    """Return the machine of the case that a result carries.

    Parameters
    ----------
    provenance : mapping
        ``case_toml``, and ``case_file``, beside which the files of the case are.
    """
    file = provenance.get("case_file", "")
    try:
        case = Case.from_toml(provenance.get("case_toml", ""), Path(file).parent)
        if case.machine is None:
            return MachineHead()
        displacement = 2e6 * math.pi * api.describe(case).displacement
        section = figure_to_svg(case.plot.section())
    except CaseError:
        return MachineHead()
    kind = readable(case.machine_type)
    return MachineHead(f"{kind}, {case.machine.mode}, {displacement:.4g} cm³/rev", section)


def solution_card(solution: Solution) -> str:
    """Return a solution as a short piece of HTML."""
    rows = dict(list(solution.summary().items())[:_KEY_NUMBERS])
    plot = solution.plot
    section = figure_to_svg(plot.section()) if "gear_section" in plot.names() else ""
    head = escape(solution.provenance.get("title", solution.data.attrs.get("title", "")))
    status = escape(status_line(solution.status, solution.findings))
    found = "".join(f"<li>{escape(str(finding))}</li>" for finding in solution.findings)
    return f"<h4>{head}</h4><p>{status}</p><ul>{found}</ul>{html_table(rows)}<div>{section}</div>"
