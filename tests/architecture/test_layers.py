"""Imports point downwards only, and are absolute."""

from __future__ import annotations

import ast
import subprocess
import sys
from pathlib import Path

import pytest

from tests.architecture.sources import PACKAGE, SOURCES, Source

LAYERS = {
    "cli", "app", "fmi", "report", "plotting", "studies", "api", "simulation", "config", "case",
    "machines", "solver", "gearing", "results", "films", "elasticity", "model", "geometry",
    "closures", "numerics", "core",
}  # fmt: skip
"""Parts of the package that the import contract orders."""

BESIDE_THE_LAYERS = {"library"}
"""Data files: no layer of their own."""


def test_import_contracts_hold(repository: Path) -> None:
    lint = Path(sys.executable).with_name("lint-imports")
    run = subprocess.run([lint, "--no-cache"], cwd=repository, capture_output=True, text=True)
    assert run.returncode == 0, run.stdout + run.stderr


def test_every_part_of_the_package_has_a_layer() -> None:
    parts = {path.stem for path in PACKAGE.iterdir() if path.suffix == ".py" or path.is_dir()}
    unknown = parts - LAYERS - BESIDE_THE_LAYERS - {"__init__", "__main__", "__pycache__"}
    assert not unknown, f"not ordered by the import contract: {sorted(unknown)}"


@pytest.mark.parametrize("source", SOURCES, ids=lambda source: source.label)
def test_imports_are_absolute(source: Source) -> None:
    relative = [
        node.lineno
        for node in ast.walk(source.tree)
        if isinstance(node, ast.ImportFrom) and node.level > 0
    ]
    assert not relative, f"relative imports in lines {relative}"
