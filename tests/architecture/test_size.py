"""Modules and functions stay short enough to be read at one go."""

from __future__ import annotations

import ast

import pytest

from tests.architecture.sources import SOURCES, Source, body_lines, parameters

MODULE_LINES = 500
FUNCTION_LINES = 60
ARGUMENTS = 8

every_source = pytest.mark.parametrize("source", SOURCES, ids=lambda source: source.label)


@every_source
def test_module_length(source: Source) -> None:
    assert len(source.text.splitlines()) <= MODULE_LINES


@every_source
def test_function_length(source: Source) -> None:
    lengths = {name: body_lines(node) for name, node in source.functions()}
    too_long = {name: length for name, length in lengths.items() if length > FUNCTION_LINES}
    assert not too_long


@every_source
def test_argument_count(source: Source) -> None:
    counts = {name: len(parameters(node)) for name, node in source.functions()}
    too_many = {name: count for name, count in counts.items() if count > ARGUMENTS}
    assert not too_many


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


def test_the_measure_leaves_the_docstring_out() -> None:
    node = ast.parse('def f(a):\n    """One.\n\n    Two.\n    """\n    return a\n').body[0]
    assert isinstance(node, ast.FunctionDef)
    assert body_lines(node) == 2
