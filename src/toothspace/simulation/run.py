"""Which module simulates a case."""

from __future__ import annotations

from collections.abc import Callable, Mapping

from toothspace.core.progress import Progress
from toothspace.results.solution import Solution
from toothspace.simulation.setup import Setup

Simulate = Callable[[Setup, Progress | None], Solution]


def _ideal() -> Simulate:
    from toothspace.simulation.ideal import simulate

    return simulate


def _lumped() -> Simulate:
    from toothspace.simulation.lumped import simulate

    return simulate


def _elastic() -> Simulate:
    from toothspace.simulation.elastic import simulate

    return simulate


STEADY: Mapping[str, Callable[[], Simulate]] = {
    "ideal": _ideal,
    "lumped": _lumped,
    "films": _lumped,
    "elastic": _elastic,
}
"""What imports the simulation of a case with an operating point, by the name of its preset."""


def simulate(setup: Setup, progress: Progress | None = None) -> Solution:
    """Simulate a case at its operating point or over the time of its circuit."""
    if setup.case.circuit is not None:
        from toothspace.simulation import circuit

        return circuit.simulate(setup, progress)
    return STEADY[setup.case.run.fidelity]()(setup, progress)
