"""Marches a machine with a free shaft through time, stick and slip included."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import final

import numpy as np

from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.model.arrays import BREAKAWAY, DIRECTION, DRIVING_TORQUE, FREE, HOLDING_TORQUE
from toothspace.model.assembly import System
from toothspace.model.system import evaluate, held_torque
from toothspace.results.solution import Event
from toothspace.solver.cyclic import Progress
from toothspace.solver.initial import start_state
from toothspace.solver.integrator import March, start_march

_CELLS_PER_CHUNK = 50


@final
@dataclass(frozen=True)
class TimePlan:
    """Duration and sampling of a transient run.

    Parameters
    ----------
    duration : float
        Simulated time. [s]
    cells : int
        Rows of the result; each keeps mean, lowest and highest value of its samples.
    samples_per_cell : int
        Samples evaluated in each cell.
    """

    duration: float
    cells: int = 4000
    samples_per_cell: int = 8


@final
@dataclass
class TransientMarch:
    """A transient run under way: chunks of sampled states, and what happened.

    Parameters
    ----------
    system : System
        Machine with a free shaft.
    plan : TimePlan
        Duration and sampling.
    """

    system: System
    plan: TimePlan
    status: Status = Status.DONE
    events: list[Event] = field(default_factory=list)
    statistics: dict[str, float] = field(default_factory=dict)
    first: Array = field(default_factory=lambda: np.zeros(0))
    last: Array = field(default_factory=lambda: np.zeros(0))
    time: float = 0.0

    def chunks(self, progress: Progress | None = None) -> Iterator[tuple[Array, Array]]:
        """Yield times [s] and states of whole cells until the end, a failure or an interrupt."""
        state = start_state(self.system)
        state[0] = self.system.condition.shaft_angle
        self.first = self.last = state
        settle(self.system, state)
        march = start_march(self.system, state)
        try:
            yield from self._march(march, progress)
        except KeyboardInterrupt:
            self.status = Status.INTERRUPTED

    def _march(self, march: March, progress: Progress | None) -> Iterator[tuple[Array, Array]]:
        plan = self.plan
        count = plan.samples_per_cell * _CELLS_PER_CHUNK
        total = plan.cells * plan.samples_per_cell
        step = plan.duration / total
        for begin in range(0, total, count):
            times: Array = step * np.arange(begin + 1.0, min(begin + count, total) + 1.0)
            states = self._advance(march, times)
            whole = len(states) // plan.samples_per_cell * plan.samples_per_cell
            if whole:
                self.last, self.time = states[whole - 1], float(times[whole - 1])
                yield times[:whole], states[:whole]
            if self.status is not Status.DONE:
                return
            if progress:
                progress(self.time / plan.duration, f"{self.time:.2f} s")

    def _advance(self, march: March, times: Array) -> Array:
        """States at the times; restarts where the shaft starts to slide or to stick."""
        parts = []
        while True:
            piece = march.advance(times)
            parts.append(piece.states)
            self.events.extend(piece.events)
            self._count(march)
            if not piece.stopped:
                self.status = piece.status
                return np.vstack(parts)
            times = times[len(piece.states) :]
            self._switch(march)
            if times.size == 0:
                return np.vstack(parts)

    def _count(self, march: March) -> None:
        """Counters restart with the integrator; keep the sum of its finished parts."""
        base = self.statistics.setdefault
        for name, value in march.statistics.items():
            before = base(f"before_{name}", 0.0)
            self.statistics[name] = before + value

    def _switch(self, march: March) -> None:
        for name in march.statistics:
            self.statistics[f"before_{name}"] = self.statistics[name]
        state = march.state.y.copy()
        time = float(march.state.control[0]["valid_until"])
        drive = self.system.arrays.drive
        if drive[DIRECTION] == 0.0:
            drive[DIRECTION] = np.sign(drive[DRIVING_TORQUE])
        else:
            state[1] = 0.0
            settle(self.system, state)
        march.restart(time, state)


def settle(system: System, state: Array) -> None:
    """Let the shaft stick if it is at rest and friction can hold it; else set its direction."""
    drive = system.arrays.drive
    if drive[FREE] == 0.0:
        return
    drive[DIRECTION] = np.sign(state[1])
    if state[1] != 0.0:
        return
    evaluate(system.arrays, state)
    held_torque(system.arrays, state)
    if drive[BREAKAWAY] == 0.0 or abs(drive[DRIVING_TORQUE]) > drive[HOLDING_TORQUE]:
        drive[DIRECTION] = np.sign(drive[DRIVING_TORQUE]) or 1.0
