"""Imports point downwards only, and are absolute."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

from tests.architecture.architecture_page import layers
from tests.architecture.sources import PACKAGE, Source, every_source


def test_import_contracts_hold(repository: Path) -> None:
    lint = Path(sys.executable).with_name("lint-imports")
    run = subprocess.run([lint, "--no-cache"], cwd=repository, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr


def test_every_part_of_the_package_has_a_layer() -> None:
    ordered = {name for layer in layers() for name in layer}
    parts = {
        path.stem for path in PACKAGE.iterdir() if path.suffix == ".py" or any(path.glob("*.py"))
    }
    unknown = parts - ordered - {"__init__", "__main__", "__pycache__"}
    assert not unknown, f"not ordered by the import contract: {sorted(unknown)}"


@every_source
def test_imports_are_absolute(source: Source) -> None:
    relative = [
        node.lineno
        for node in ast.walk(source.tree)
        if isinstance(node, ast.ImportFrom) and node.level > 0
    ]
    assert not relative, f"relative imports in lines {relative}"
