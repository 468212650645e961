"""Which module simulates a case."""

from __future__ import annotations

from collections.abc import Mapping
from importlib import import_module

from toothspace.core.progress import Progress
from toothspace.results.solution import Solution
from toothspace.simulation.setup import Setup

STEADY: Mapping[str, str] = {
    "ideal": "toothspace.simulation.ideal",
    "lumped": "toothspace.simulation.lumped",
    "films": "toothspace.simulation.lumped",
    "elastic": "toothspace.simulation.elastic",
}
"""Module that simulates a case with an operating point, by the name of its preset."""


def simulate(setup: Setup, progress: Progress | None = None) -> Solution:
    """Simulate a case at its operating point or over the time of its circuit."""
    over_time = setup.case.circuit is not None
    module = "toothspace.simulation.circuit" if over_time else STEADY[setup.case.run.fidelity]
    solution: Solution = import_module(module).simulate(setup, progress)
    return solution
