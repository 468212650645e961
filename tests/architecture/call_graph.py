"""Who calls whom: a static walk through the package from its entry points.

A definition is a function or class of a module, with all that stands in it; the statements that
run when a module is imported are one more. Names are followed through imports and re-exports.
"""

from __future__ import annotations

import ast
from collections.abc import Iterable, Iterator
from dataclasses import dataclass
from functools import cached_property

from tests.architecture.sources import PACKAGE, SOURCES, Source
from toothspace.core.registry import VIEWS

Definition = tuple[str, str]
"""Name of a module and of what it defines."""

BODY = "<module>"
"""What a module runs when it is imported."""

MACHINE_PARTS = {"parameters", "cad", "designs", "new_case"}
"""Modules of a machine type that are found by their name."""

EXTENSIONS = {"numba.extending": "", "toothspace.core.compiled": "stand_in"}
"""Modules whose decorators tell the compiler what a function or class is for; all or one."""

BUILT = ("toothspace.core.compilation.records", "by_address")
"""What the library of compiled code is built with, outside the package."""


@dataclass(frozen=True)
class Module:
    """Definitions and imports of one module."""

    name: str
    tree: ast.Module

    @cached_property
    def definitions(self) -> dict[str, list[ast.stmt]]:
        found: dict[str, list[ast.stmt]] = {BODY: []}
        for statement in self.tree.body:
            if isinstance(statement, ast.FunctionDef | ast.ClassDef):
                found.setdefault(statement.name, []).append(statement)
            else:
                found[BODY].append(statement)
                for name in _assigned(statement):
                    found.setdefault(name, []).append(statement)
        return found

    @cached_property
    def imports(self) -> dict[str, tuple[str, str]]:
        """What each imported name stands for; an empty second entry is a module."""
        found: dict[str, tuple[str, str]] = {}
        for node in ast.walk(self.tree):
            if isinstance(node, ast.ImportFrom) and node.module:
                for alias in node.names:
                    found[alias.asname or alias.name] = (node.module, alias.name)
            elif isinstance(node, ast.Import):
                for alias in node.names:
                    found[alias.asname or alias.name.split(".")[0]] = (
                        alias.name if alias.asname else alias.name.split(".")[0],
                        "",
                    )
        return found

    @cached_property
    def registered(self) -> list[Definition]:
        """What Python calls by its name, or a decorator hands over, as commands to a parser."""
        return [
            (self.name, statement.name)
            for statement in self.tree.body
            if isinstance(statement, ast.FunctionDef | ast.ClassDef)
            and (
                statement.name.startswith("__")
                or any(self._registers(_root(decorator)) for decorator in statement.decorator_list)
            )
        ]

    def _registers(self, decorator: str) -> bool:
        """Whether a decorator is one of the module itself or extends the compiler."""
        module, name = self.imports.get(decorator, ("", ""))
        return decorator in self.definitions or EXTENSIONS.get(module) in {"", name}


def _root(node: ast.expr) -> str:
    while not isinstance(node, ast.Name):
        match node:
            case ast.Call(func=inner) | ast.Attribute(value=inner):
                node = inner
            case _:
                return ""
    return node.id


def _assigned(statement: ast.stmt) -> Iterator[str]:
    for node in ast.walk(statement):
        if isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
            yield node.id


def module_name(source: Source) -> str:
    """Dotted name of a module of the package."""
    parts = source.path.relative_to(PACKAGE.parent).with_suffix("").parts
    return ".".join(parts[:-1] if parts[-1] == "__init__" else parts)


class CallGraph:
    """Definitions of a set of modules, and what each of them uses."""

    def __init__(self, modules: Iterable[Module]) -> None:
        self.modules = {module.name: module for module in modules}

    def reached(self, roots: Iterable[Definition]) -> set[Definition]:
        """Everything that runs, or may run, because of the roots."""
        found: set[Definition] = set()
        ahead = list(roots)
        while ahead:
            here = ahead.pop()
            if here not in found:
                found.add(here)
                ahead += self._used(here)
        return found

    def public(self, module: str) -> list[Definition]:
        """What a module offers: its own public definitions, or the names in ``__all__``."""
        own = self.modules[module]
        for statement in own.tree.body:
            if isinstance(statement, ast.Assign) and list(_assigned(statement)) == ["__all__"]:
                names = [
                    item.value
                    for item in ast.walk(statement.value)
                    if isinstance(item, ast.Constant)
                ]
                return [*self.resolved(module, names), (module, BODY)]
        return [(module, name) for name in own.definitions if not name.startswith("_")]

    def resolved(self, module: str, names: Iterable[str]) -> Iterator[Definition]:
        """Where names of a module are defined."""
        for name in names:
            target = self._lookup(module, name)
            if target is not None:
                yield target

    def _lookup(self, module: str, name: str) -> Definition | None:
        """Where a name of a module is defined, or None outside the package."""
        own = self.modules.get(module)
        if own is None:
            return None
        if name in own.definitions:
            return module, name
        if name in own.imports:
            target, attribute = own.imports[name]
            package = self.modules.get(target)
            shadowed = package is not None and attribute in package.imports
            if f"{target}.{attribute}" in self.modules and not shadowed:
                return f"{target}.{attribute}", BODY
            return self._lookup(target, attribute) if attribute else (target, BODY)
        return None

    def _used(self, definition: Definition) -> Iterator[Definition]:
        module, name = definition
        own = self.modules.get(module)
        if own is None:
            return
        yield module, BODY
        if "." in module:
            yield module.rpartition(".")[0], BODY
        if name == BODY:
            yield from own.registered
        for statement in own.definitions.get(name, []):
            local = set(_local(statement)) if name != BODY else set()
            for node in ast.walk(statement):
                yield from self._used_by(node, own, local)
                if name != BODY and isinstance(node, ast.ImportFrom) and node.module:
                    # what a function imports itself may have the name of a function beside it
                    yield from self.resolved(node.module, [alias.name for alias in node.names])

    def _used_by(self, node: ast.AST, own: Module, local: set[str]) -> Iterator[Definition]:
        if isinstance(node, ast.Name) and node.id not in local:
            yield from self.resolved(own.name, [node.id])
        elif isinstance(node, ast.Attribute) and isinstance(node.value, ast.Name):
            target, attribute = own.imports.get(node.value.id, ("", ""))
            inner = f"{target}.{attribute}" if attribute else target
            if inner in self.modules:
                yield from self.resolved(inner, [node.attr])
        elif isinstance(node, ast.ImportFrom) and node.module in self.modules:
            yield node.module, BODY
            for alias in node.names:
                if f"{node.module}.{alias.name}" in self.modules:
                    yield f"{node.module}.{alias.name}", BODY
        elif isinstance(node, ast.Constant) and node.value in self.modules:
            # a module that is imported by its name in a string
            yield from self.public(node.value)


def _local(statement: ast.stmt) -> Iterator[str]:
    """Names that a function binds itself: they hide those of its module."""
    if isinstance(statement, ast.FunctionDef):
        for node in ast.walk(statement):
            if isinstance(node, ast.arg):
                yield node.arg
            elif isinstance(node, ast.Name) and isinstance(node.ctx, ast.Store):
                yield node.id


def _is_main(statement: ast.stmt) -> bool:
    return isinstance(statement, ast.If) and "__main__" in ast.unparse(statement.test)


def package_graph() -> CallGraph:
    """Call graph of the whole package."""
    return CallGraph(Module(module_name(source), source.tree) for source in SOURCES)


def public_names(graph: CallGraph) -> Iterator[Definition]:
    """What the package offers by name, and what shows its results."""
    stub = ast.parse((PACKAGE / "__init__.pyi").read_text(encoding="utf-8"))
    for node in ast.walk(stub):
        if isinstance(node, ast.ImportFrom) and node.module:
            names = [alias.name for alias in node.names]
            yield from graph.resolved(f"toothspace.{node.module}", names)
    for place in VIEWS.values():
        module, _, name = place.partition(":")
        yield from graph.resolved(module, [name])


def entry_points(graph: CallGraph) -> list[Definition]:
    """Command line, Python, films, bodies, machine types, studies, modules run by ``-m``."""
    found = [*graph.public("toothspace.cli"), *graph.public("toothspace.api"), *public_names(graph)]
    found += [
        *graph.public("toothspace.films.public"),
        *graph.public("toothspace.elasticity"),
        BUILT,
    ]
    for module, own in graph.modules.items():
        parts = module.split(".")
        if module.startswith("toothspace.studies.") and "STUDY" in own.definitions:
            found.append((module, "STUDY"))
        if any(_is_main(statement) for statement in own.tree.body):
            found.append((module, BODY))
        if parts[:2] == ["toothspace", "machines"] and (
            len(parts) == 3 or (len(parts) == 4 and parts[3] in MACHINE_PARTS)
        ):
            found += graph.public(module)
    return found
