"""Generic layers know no machine by name."""

from __future__ import annotations

import ast
from pathlib import Path

from tests.architecture.sources import PACKAGE, for_every
from toothspace.core.registry import machine_type_names

GENERIC = ("model", "solver", "simulation", "results", "report", "plotting", "cli")
PARTS = (
    "drive_gear",
    "driven_gear",
    "inner_rotor",
    "outer_rotor",
    "pinion",
    "ring_gear",
    "tooth_tip",
    "machine.floating_bearing",
)
"""Bodies, paths and keys of the machine types that are shipped."""

FILES = [path for room in GENERIC for path in sorted((PACKAGE / room).rglob("*.py"))]


def texts(path: Path) -> list[str]:
    """All strings of a module that are no docstrings."""
    tree = ast.parse(path.read_text(encoding="utf-8"))
    bare = {id(n.value) for n in ast.walk(tree) if isinstance(n, ast.Expr)}
    found = [n for n in ast.walk(tree) if isinstance(n, ast.Constant) and id(n) not in bare]
    return [n.value for n in found if isinstance(n.value, str)]


@for_every([(str(path.relative_to(PACKAGE)), (path,)) for path in FILES])
def test_no_text_names_a_machine_or_a_part_of_one(path: Path) -> None:
    names = (*machine_type_names(), *PARTS)
    assert [text for text in texts(path) if any(name in text for name in names)] == []
