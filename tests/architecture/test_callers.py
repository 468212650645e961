"""What the package holds is what its users reach; nothing lives on tests and benchmarks alone."""

from __future__ import annotations

import ast

from tests.architecture.call_graph import BODY, CallGraph, Module, entry_points, package_graph
from tests.architecture.sources import SOURCES

CALLED_FROM_OUTSIDE = {"EntryCache", "EvaluatedDesigns", "Figures", "Quantity"}
"""Classes whose methods the compiler or a user of Python calls."""

PLAIN = {"Enum", "Generic", "IntEnum", "NamedTuple", "Protocol"}
"""Bases that call no method of their own accord."""


def test_every_function_and_class_is_reached_from_an_entry_point() -> None:
    graph = package_graph()
    reached = graph.reached(entry_points(graph))
    idle = [
        f"{module}:{statement.name}"
        for module, own in graph.modules.items()
        for statement in own.tree.body
        if isinstance(statement, ast.FunctionDef | ast.ClassDef)
        and (module, statement.name) not in reached
    ]
    assert not idle


def test_every_module_is_imported() -> None:
    graph = package_graph()
    reached = {module for module, name in graph.reached(entry_points(graph)) if name == BODY}
    assert not set(graph.modules) - reached


def named(trees: list[ast.Module]) -> set[str]:
    """Names that are read from some object, or stand in a string."""
    nodes = [node for tree in trees for node in ast.walk(tree)]
    found = {node.attr for node in nodes if isinstance(node, ast.Attribute)}
    return found | {
        node.value
        for node in nodes
        if isinstance(node, ast.Constant) and isinstance(node.value, str)
    }


def idle_methods(trees: list[ast.Module]) -> list[tuple[str, str]]:
    """Public methods whose name nothing reads, but for those that another package may call."""
    classes = [n for tree in trees for n in ast.walk(tree) if isinstance(n, ast.ClassDef)]
    bases = {node.name: {ast.unparse(b).split("[")[0] for b in node.bases} for node in classes}
    own = set(bases) - CALLED_FROM_OUTSIDE
    while outside := {name for name in own if bases[name] - own - PLAIN}:
        own -= outside
    used = named(trees)
    return [
        (node.name, method.name)
        for node in classes
        for method in node.body
        if node.name in own
        and isinstance(method, ast.FunctionDef)
        and not method.name.startswith("_")
        and method.name not in used
    ]


def test_every_method_is_named_by_a_caller() -> None:
    assert not idle_methods([source.tree for source in SOURCES])


def test_a_method_that_nobody_names_is_found() -> None:
    code = """
class A:
    def used(self): return self._own()
    def idle(self): ...
    def text(self): ...
    def _own(self): ...
class B(A):
    def late(self): ...
class C(Foreign):
    def called_from_outside(self): ...
A().used(), getattr(A(), "text")
"""
    assert idle_methods([ast.parse(code)]) == [("A", "idle"), ("B", "late")]


def test_the_walk_follows_imports_and_leaves_out_what_nobody_calls() -> None:
    modules = {
        "p": "from p.b import shown as seen\n__all__ = ['seen']",
        "p.a": (
            "import p.c as c\nLATE = 'p.d'\ndef used(idle): return c.deep(idle)\ndef idle(): ..."
        ),
        "p.b": "from p.a import used\ndef shown(): return used(1)\ndef hidden(): ...",
        "p.c": "def deep(x): return made[x]\nmade = [1]\ndef lonely(): return deep(0)",
        "p.d": "def run(): ...",
    }
    graph = CallGraph(Module(name, ast.parse(text)) for name, text in modules.items())
    constants = {BODY, "__all__", "LATE"}
    reached = {entry for entry in graph.reached(graph.public("p")) if entry[1] not in constants}
    assert reached == {
        ("p.b", "shown"), ("p.a", "used"), ("p.c", "deep"), ("p.c", "made"), ("p.d", "run")
    }  # fmt: skip
