"""Parsed sources of the package, shared by the tests of conventions."""

from __future__ import annotations

import ast
from collections.abc import Callable, Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property
from pathlib import Path
from typing import Any

REPOSITORY = Path(__file__).resolve().parents[2]
PACKAGE = REPOSITORY / "src" / "toothspace"

FunctionNode = ast.FunctionDef | ast.AsyncFunctionDef


@dataclass(frozen=True)
class Source:
    """One module of the package."""

    path: Path

    @cached_property
    def text(self) -> str:
        return self.path.read_text(encoding="utf-8")

    @cached_property
    def tree(self) -> ast.Module:
        return ast.parse(self.text, filename=str(self.path))

    @property
    def label(self) -> str:
        """Path inside the package, for messages."""
        return self.path.relative_to(PACKAGE).as_posix()

    def functions(self) -> Iterator[tuple[str, FunctionNode]]:
        """Every function and method with its qualified name."""
        yield from _functions(self.tree, "")

    def public_functions(self) -> Iterator[tuple[str, FunctionNode]]:
        """Functions and methods whose qualified name has no private part."""
        for name, node in self.functions():
            if not any(part.startswith("_") for part in name.split(".")):
                yield name, node

    def documented_by_a_base(self) -> set[str]:
        """Methods whose meaning the base class of the same module says once for all."""
        classes = {node.name: node for node in self.tree.body if isinstance(node, ast.ClassDef)}
        found = set()
        for name, node in classes.items():
            for base in node.bases:
                above = classes.get(base.id) if isinstance(base, ast.Name) else None
                for method in above.body if above is not None else ():
                    if isinstance(method, FunctionNode) and ast.get_docstring(method):
                        found.add(f"{name}.{method.name}")
        return found


def _functions(node: ast.AST, prefix: str) -> Iterator[tuple[str, FunctionNode]]:
    for child in ast.iter_child_nodes(node):
        if isinstance(child, FunctionNode):
            yield prefix + child.name, child
            # a nested function is private to its owner
            yield from _functions(child, f"{prefix}{child.name}._local.")
        elif isinstance(child, ast.ClassDef):
            yield from _functions(child, f"{prefix}{child.name}.")
        else:
            yield from _functions(child, prefix)


def parameters(node: FunctionNode) -> list[ast.arg]:
    """Parameters of a function without ``self`` and ``cls``."""
    group = node.args
    found = [*group.posonlyargs, *group.args, *group.kwonlyargs]
    found += [extra for extra in (group.vararg, group.kwarg) if extra is not None]
    return [argument for argument in found if argument.arg not in {"self", "cls"}]


def body_lines(node: FunctionNode) -> int:
    """Lines of a function from its ``def`` to its end, without the docstring."""
    assert node.end_lineno is not None
    length = node.end_lineno - node.lineno + 1
    first = node.body[0]
    if ast.get_docstring(node) is not None:
        assert first.end_lineno is not None
        length -= first.end_lineno - first.lineno + 1
    return length


SOURCES = [Source(path) for path in sorted(PACKAGE.rglob("*.py"))]


def for_every(
    items: Iterable[tuple[str, tuple[Any, ...]]],
) -> Callable[[Callable[..., None]], Callable[[], None]]:
    """Turn a check of one thing into a test of all, which names every one that fails."""

    def whole(check: Callable[..., None]) -> Callable[[], None]:
        def test() -> None:
            failures = {}
            for label, arguments in items:
                try:
                    check(*arguments)
                except AssertionError as error:
                    failures[label] = str(error)
            assert not failures, failures

        test.__name__, test.__doc__ = check.__name__, check.__doc__
        return test

    return whole


every_source = for_every([(source.label, (source,)) for source in SOURCES])
