"""Views of a result as a page that needs no server, for notebooks and for sending on."""

from __future__ import annotations

from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import final

from toothspace.core.files import path_of, write_text
from toothspace.core.finding import status_line
from toothspace.report.html import turning_section
from toothspace.report.page import quantity, render
from toothspace.report.views import views_html, views_of
from toothspace.results.solution import Solution


@final
@dataclass(frozen=True)
class ViewPage:
    """Views of a result as one page that needs no server; a notebook shows it in a frame."""

    html: str
    """The page."""

    def _repr_html_(self) -> str:
        held = escape(self.html, quote=True)
        style = "width:100%;height:44rem;border:1px solid #ccc;border-radius:6px"
        return f'<iframe sandbox="allow-scripts" style="{style}" srcdoc="{held}"></iframe>'

    def __repr__(self) -> str:
        return f"<ViewPage: {len(self.html) / 1e6:.2g} MB of HTML>"

    def save(self, path: str | Path) -> Path:
        """Write the page, by custom ``*.html``, and return its path.

        Parameters
        ----------
        path : str or Path
            File to write.
        """
        target = path_of(path, "views", "a file to write")
        target.parent.mkdir(parents=True, exist_ok=True)
        return write_text(target, self.html)


def solution_page(solution: Solution) -> ViewPage:
    """Return the views of a result, with its section turning, as a page of their own."""
    description, turning = solution.description, ""
    if description is not None and "gear_section" in solution.plot.names():
        turning = turning_section(solution, description)
    numbers = [quantity(n, v) for n, v in solution.summary().items() if isinstance(v, float)]
    return ViewPage(
        render(
            "views.html.j2",
            title=solution.data.attrs.get("title") or "Result",
            status=status_line(solution.status, solution.findings),
            turning=turning,
            numbers=numbers,
            views=views_html(views_of(solution)),
        )
    )
