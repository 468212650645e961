"""Public functions say what they do; formulas give the unit of every quantity."""

from __future__ import annotations

import ast
import inspect
import re

import toothspace
import toothspace.films
from tests.architecture.sources import (
    SOURCES,
    FunctionNode,
    Source,
    every_source,
    for_every,
    parameters,
)

UNIT = re.compile(r"\[[^\[\]]+\](?!_)")
NUMERIC = re.compile(r"float|int\b|Any|Array|ndarray")
ENTRY = re.compile(r"^(\w[\w, *]*?)\s*(?::.*)?$")

HELD_BY_USERS = {
    *dir(toothspace), *dir(toothspace.films), "Columns", "EvaluatedDesigns", "Ledger",
    "MachineDescription", "StudyResult",
}  # fmt: skip

CLOSURES = [source for source in SOURCES if source.label.startswith("closures/")]


def section(doc: str, title: str) -> list[str]:
    """Lines of a numpydoc section."""
    match = re.search(rf"^{title}\n-+\n(.*?)(?=^\w[\w ]*\n-+\n|\Z)", doc, re.MULTILINE | re.DOTALL)
    return match.group(1).splitlines() if match else []


def described(lines: list[str]) -> dict[str, str]:
    """Text of every entry of a section by name; ``a, b : float`` describes both."""
    texts: dict[str, str] = {}
    names: list[str] = []
    for line in lines:
        heading = ENTRY.match(line)
        if heading and not line.startswith(" "):
            names = [name.strip(" *") for name in heading.group(1).split(",")]
            texts.update(dict.fromkeys(names, ""))
        else:
            for name in names:
                texts[name] += line + "\n"
    return texts


def numeric(annotation: ast.expr | None) -> bool:
    return annotation is not None and bool(NUMERIC.search(ast.unparse(annotation)))


def missing_units(node: FunctionNode) -> list[str]:
    """Numeric parameters, and the result, that the docstring gives no unit for."""
    doc = inspect.cleandoc(ast.get_docstring(node) or "")
    texts = described(section(doc, "Parameters"))
    missing = [
        argument.arg
        for argument in parameters(node)
        if numeric(argument.annotation) and not UNIT.search(texts.get(argument.arg, ""))
    ]
    if numeric(node.returns) and not UNIT.search("\n".join(section(doc, "Returns"))):
        missing.append("result")
    return missing


@every_source
def test_public_functions_have_a_docstring(source: Source) -> None:
    assert ast.get_docstring(source.tree), "module without docstring"
    told = source.documented_by_a_base()
    silent = [
        name
        for name, node in source.public_functions()
        if not ast.get_docstring(node) and name not in told
    ]
    assert not silent


@every_source
def test_fields_say_once_what_they_mean(source: Source) -> None:
    """Below the field; only classes that a user makes or holds list them, for ``help``."""
    twice = []
    for node in ast.walk(source.tree):
        if isinstance(node, ast.ClassDef) and node.name not in HELD_BY_USERS:
            listed = described(section(ast.get_docstring(node) or "", "Parameters"))
            fields = [one.target for one in node.body if isinstance(one, ast.AnnAssign)]
            if any(isinstance(one, ast.Name) and one.id in listed for one in fields):
                twice.append(node.name)
    assert not twice


@for_every([(source.label, (source,)) for source in CLOSURES])
def test_formulas_give_every_unit(source: Source) -> None:
    missing = {name: missing_units(node) for name, node in source.public_functions()}
    assert not {name: found for name, found in missing.items() if found}


def test_a_missing_unit_is_noticed() -> None:
    code = '''
def flow(height: float, width: float, law: str) -> float:
    """Flow.

    Parameters
    ----------
    height, width : float
        Size. [m]
    law : str
        Name.

    Returns
    -------
    float
        Flow. [m3/s]
    """
'''
    (node,) = ast.parse(code).body
    assert isinstance(node, ast.FunctionDef)
    assert missing_units(node) == []
    (node,) = ast.parse(code.replace("[m]", "").replace("[m3/s]", "")).body
    assert isinstance(node, ast.FunctionDef)
    assert missing_units(node) == ["height", "width", "result"]
