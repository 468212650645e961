"""Public names are made of the terms of the glossary and of ordinary English words."""

from __future__ import annotations

import ast
import re
from collections.abc import Iterator
from pathlib import Path

import pytest

from tests.architecture.sources import PACKAGE, REPOSITORY, SOURCES, parameters

GLOSSARY = REPOSITORY / "docs" / "developer" / "glossary.md"
PLAIN = Path(__file__).with_name("plain_words.txt")
WORD = re.compile(r"[A-Z]+(?=[A-Z][a-z])|[A-Z]?[a-z]+|[A-Z]+")

REPLACED = {
    "yielding", "yields", "widening", "widened", "foretold", "told", "chequerboard", "scene",
    "scenes", "live", "pressed", "guide",
}  # fmt: skip
"""Words for which the field has others; the glossary says which."""


def words(name: str) -> set[str]:
    """Words of a name in either spelling, in lower case."""
    return {word.lower() for word in WORD.findall(name)}


def public_names(tree: ast.AST) -> Iterator[str]:
    """Classes, functions, their parameters and fields whose names are public."""
    for node in ast.iter_child_nodes(tree):
        if isinstance(node, ast.ClassDef) and not node.name.startswith("_"):
            yield node.name
            yield from public_names(node)
        elif isinstance(node, ast.FunctionDef) and not node.name.startswith("_"):
            yield node.name
            yield from (argument.arg for argument in parameters(node))
        elif isinstance(node, ast.AnnAssign) and isinstance(tree, ast.ClassDef):
            name = ast.unparse(node.target)
            if not name.startswith("_"):
                yield name


def used() -> dict[str, str]:
    """Every word of a public name with one name that holds it."""
    found: dict[str, str] = {}
    for source in SOURCES:
        names = [*source.path.relative_to(PACKAGE).with_suffix("").parts]
        names += public_names(source.tree)
        for name in names:
            if not name.startswith("_"):
                found |= dict.fromkeys(words(name), name)
    return found


def terms() -> set[str]:
    """Words in the first column of the tables of the glossary."""
    rows = [line.split("|")[1] for line in GLOSSARY.read_text("utf-8").splitlines() if "|" in line]
    names = re.findall(r"`([^`]+)`", "".join(rows))
    return set().union(*map(words, names))


def plain() -> list[str]:
    return PLAIN.read_text(encoding="utf-8").split()


def test_public_names_are_made_of_known_words() -> None:
    known = terms() | set(plain())
    unknown = {word: name for word, name in used().items() if word not in known}
    assert not unknown, f"add a term to {GLOSSARY.name} or an ordinary word to {PLAIN.name}"


def test_plain_words_are_in_order_and_no_terms() -> None:
    given = plain()
    assert given == sorted(set(given))
    assert not set(given) & terms()


def test_replaced_words_are_gone() -> None:
    assert not REPLACED & set(used())


@pytest.mark.parametrize(
    ("name", "parts"),
    [
        ("gap_height", {"gap", "height"}),
        ("StackState", {"stack", "state"}),
        ("FMIState", {"fmi", "state"}),
    ],
)
def test_names_are_split_into_words(name: str, parts: set[str]) -> None:
    assert words(name) == parts


def test_an_unknown_word_is_seen() -> None:
    code = "class Wobble:\n    fudge: float\n    def _a(self, x): ...\ndef run(tweak): ...\n"
    assert list(public_names(ast.parse(code))) == ["Wobble", "fudge", "run", "tweak"]


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
