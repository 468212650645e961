"""The page of the architecture, drawn from the sources.

``python -m tests.architecture.architecture_page docs/developer/architecture.md`` writes the table
of packages anew.
"""

from __future__ import annotations

import ast
import sys
import tomllib
from pathlib import Path

from tests.architecture.sources import PACKAGE, REPOSITORY, SOURCES, Source

BEGIN, END = "<!-- packages: begin -->", "<!-- packages: end -->"
_ROOT = "toothspace"


def package_of(source: Source) -> str:
    """Name of the package or module under the root that a source belongs to."""
    return source.path.relative_to(PACKAGE).parts[0].removesuffix(".py")


def imported(source: Source) -> set[str]:
    """Packages under the root that a source imports anywhere, inside functions too."""
    names: set[str] = set()
    for node in ast.walk(source.tree):
        if isinstance(node, ast.ImportFrom) and node.module == _ROOT:
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and (node.module or "").startswith(f"{_ROOT}."):
            names.add(str(node.module).split(".")[1])
        elif isinstance(node, ast.Import):
            names |= {a.name.split(".")[1] for a in node.names if a.name.startswith(f"{_ROOT}.")}
    return names


def arrows() -> dict[str, set[str]]:
    """Packages and what each imports."""
    found: dict[str, set[str]] = {}
    for source in SOURCES:
        found.setdefault(package_of(source), set()).update(imported(source))
    known = found.keys() - {"__init__", "__main__"}
    return {name: (found[name] & known) - {name} for name in known}


def layers() -> list[list[str]]:
    """Layers of the import contract from the top down."""
    settings = tomllib.loads((REPOSITORY / "pyproject.toml").read_text(encoding="utf-8"))
    (contract,) = (
        c for c in settings["tool"]["importlinter"]["contracts"] if c["type"] == "layers"
    )
    return [
        [part.strip(" ()") for part in line.replace(":", "|").split("|")]
        for line in contract["layers"]
    ]


def responsibility(package: str) -> str:
    """First sentence of the docstring of a package."""
    path = PACKAGE / package / "__init__.py"
    path = path if path.is_file() else PACKAGE / f"{package}.py"
    doc = ast.get_docstring(ast.parse(path.read_text(encoding="utf-8"))) or ""
    return " ".join(doc.split("\n\n")[0].split()).rstrip(".")


def table() -> str:
    """Table of the packages from the top layer down."""
    found = arrows()
    order = [name for layer in layers() for name in layer if name in found]
    order += sorted(found.keys() - set(order))
    lines = ["| package | responsibility | imports |", "|---|---|---|"]
    for name in order:
        targets = sorted(found[name], key=order.index)
        lines.append(f"| `{name}` | {responsibility(name)} | {', '.join(targets) or 'nothing'} |")
    return "\n".join(lines)


def rewritten(page: str) -> str:
    """Page with the table as the sources have it."""
    before, _, rest = page.partition(BEGIN)
    _, _, after = rest.partition(END)
    return f"{before}{BEGIN}\n{table()}\n{END}{after}"


if __name__ == "__main__":
    path = Path(sys.argv[1])
    path.write_text(rewritten(path.read_text(encoding="utf-8")), encoding="utf-8")
