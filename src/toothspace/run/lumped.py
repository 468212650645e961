"""The ``lumped`` and ``films`` presets: chambers marched until cyclic, or over time."""

from __future__ import annotations

from toothspace.core.progress import Progress
from toothspace.results.solution import Solution
from toothspace.run.heating import with_heat
from toothspace.run.run import Run


def simulate(run: Run, progress: Progress | None = None) -> Solution:
    """Cyclic state of a machine at its operating point, or its way through time in a circuit."""
    ready = run.worn(progress).with_films(progress)
    if ready.condition.over_time:
        return ready.march(progress)
    march = ready.repeated(progress)
    return with_heat(ready.case, ready.machine, march(ready.machine), march)
