"""Which module simulates a case."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from toothspace.results.solution import Solution
from toothspace.simulation import circuit, elastic, ideal, lumped
from toothspace.simulation.setup import Progress, Setup

Simulate = Callable[[Setup, Progress | None], Solution]

STEADY: Mapping[str, Simulate] = {
    "ideal": ideal.simulate,
    "lumped": lumped.simulate,
    "films": lumped.simulate,
    "elastic": elastic.simulate,
}
"""How a case with an operating point is simulated, by the name of its preset."""


def simulate(setup: Setup, progress: Progress | None = None) -> Solution:
    """Simulate a case at its operating point or over the time of its circuit."""
    if setup.case.circuit is not None:
        return circuit.simulate(setup, progress)
    return STEADY[setup.case.run.fidelity](setup, progress)
