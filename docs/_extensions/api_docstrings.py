"""Docstrings as Sphinx wants them: numbered sources become lists, one page may have many."""

from __future__ import annotations

import re

from sphinx.application import Sphinx

SOURCE = re.compile(r"\s*\.\. (\[\d+\]) ?(.*)")


def list_sources(
    app: Sphinx, what: str, name: str, obj: object, options: object, lines: list[str]
) -> None:
    """Turn the footnotes of ``References`` into a list, since each docstring counts from one."""
    found, inside = [], False
    for line in lines:
        if match := SOURCE.match(line):
            inside = True
            found += ["", f"* {match.group(1)} {match.group(2)}"]
        elif inside and line.startswith("  "):
            found.append(f"  {line.strip()}")
        else:
            inside = inside and not line.strip()
            found.append(re.sub(r"(\[\d+\])_", r"\1", line))
    lines[:] = found


def setup(app: Sphinx) -> dict[str, bool]:
    """Listen to every docstring after it became reStructuredText."""
    app.connect("autodoc-process-docstring", list_sources, priority=900)
    return {"parallel_read_safe": True, "parallel_write_safe": True}
