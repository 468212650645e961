"""One class, one name."""

from __future__ import annotations

import ast

from tests.architecture.sources import SOURCES


def test_no_class_name_stands_for_two_things() -> None:
    """A class that extends one of its own name is the same thing with more to it."""
    places: dict[str, list[str]] = {}
    for source in SOURCES:
        for node in ast.walk(source.tree):
            if not isinstance(node, ast.ClassDef):
                continue
            if node.name not in {ast.unparse(base).split(".")[-1] for base in node.bases}:
                places.setdefault(node.name, []).append(source.label)
    assert not {name: found for name, found in places.items() if len(found) > 1}
