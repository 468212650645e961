"""Names follow the glossary."""

from __future__ import annotations

import ast
from collections.abc import Iterator

import pytest

from tests.architecture.sources import Source, every_source, for_every, parameters

NEVER = {"rpm", "tsv", "cv", "Cq", "visc"}
"""Not a name of anything."""

NOT_PUBLIC_PARAMETERS = NEVER | {"n", "theta", "beta", "mu", "eta"}
"""Symbols: allowed inside a function next to its equation, not in a public signature."""

FORBIDDEN_MODULES = {"helpers", "helper", "utils", "util", "misc", "common"}


def identifiers(tree: ast.AST) -> Iterator[str]:
    for node in ast.walk(tree):
        match node:
            case ast.Name(id=name, ctx=ast.Store()):
                yield name
            case ast.arg(arg=name) | ast.Attribute(attr=name, ctx=ast.Store()):
                yield name
            case ast.FunctionDef(name=name) | ast.ClassDef(name=name):
                yield name
            case ast.alias(asname=str(name)):
                yield name


@every_source
def test_forbidden_names_are_not_used(source: Source) -> None:
    assert not NEVER & set(identifiers(source.tree))


@every_source
def test_public_signatures_use_words(source: Source) -> None:
    found = [
        f"{name}({argument.arg})"
        for name, node in source.public_functions()
        for argument in parameters(node)
        if argument.arg in NOT_PUBLIC_PARAMETERS
    ]
    assert not found


@every_source
def test_modules_and_classes_say_what_they_are(source: Source) -> None:
    assert source.path.stem not in FORBIDDEN_MODULES
    assert source.path.parent.name not in FORBIDDEN_MODULES
    classes = [node.name for node in ast.walk(source.tree) if isinstance(node, ast.ClassDef)]
    assert not [name for name in classes if name.endswith(("Manager", "Helper", "Utils"))]


def test_the_search_sees_every_kind_of_name() -> None:
    code = "import x as a\nb = 1\no.c = 2\nclass D:\n    def e(self, f): ...\nfor g in (): ...\n"
    assert {"a", "b", "c", "D", "e", "f", "g"} <= set(identifiers(ast.parse(code)))


@every_source
def test_nothing_is_printed(source: Source) -> None:
    calls = [
        node.lineno
        for node in ast.walk(source.tree)
        if isinstance(node, ast.Call)
        and isinstance(node.func, ast.Name)
        and node.func.id == "print"
    ]
    assert not calls, f"print in lines {calls}"


def test_every_source_that_breaks_a_rule_is_named() -> None:
    @for_every([("first", (1,)), ("second", (2,))])
    def test_is_odd(number: int) -> None:
        assert number % 2

    with pytest.raises(AssertionError, match="second"):
        test_is_odd()
