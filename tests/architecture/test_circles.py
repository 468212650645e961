"""No module imports itself over others: inside functions and for types counts as well."""

from __future__ import annotations

import ast
from collections.abc import Mapping
from graphlib import CycleError, TopologicalSorter

from tests.architecture.sources import PACKAGE, SOURCES, Source


def module_name(source: Source) -> str:
    """Dotted name of a module of the package."""
    parts = source.path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


def imported(tree: ast.AST, known: set[str]) -> set[str]:
    """Modules among those known that a source imports, anywhere in it."""
    found = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Import):
            found |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom) and node.module:
            for alias in node.names:
                inner = f"{node.module}.{alias.name}"
                found.add(inner if inner in known else node.module)
    return found & known


def circle(graph: Mapping[str, set[str]]) -> list[str]:
    """Modules of one circle in the order of their imports, none without."""
    try:
        TopologicalSorter(graph).prepare()
    except CycleError as error:
        return list(reversed(error.args[1]))
    return []


def test_no_module_imports_itself_over_others() -> None:
    sources = {module_name(source): source for source in SOURCES}
    known = set(sources)
    graph = {name: imported(source.tree, known) - {name} for name, source in sources.items()}
    assert sum(map(len, graph.values())) > len(graph)
    assert not circle(graph)


def test_imports_in_functions_and_for_types_are_seen() -> None:
    code = (
        "from typing import TYPE_CHECKING\n"
        "if TYPE_CHECKING:\n    from a.b import C\n"
        "def f():\n    from a import d\n    import a.e\n"
    )
    known = {"a", "a.b", "a.d", "a.e"}
    assert imported(ast.parse(code), known) == {"a.b", "a.d", "a.e"}


def test_a_circle_is_found() -> None:
    assert circle({"a": {"b"}, "b": {"c"}, "c": set()}) == []
    assert set(circle({"a": {"b"}, "b": {"c"}, "c": {"b"}})) == {"b", "c"}
