"""Marches a machine with a free shaft through time, stick and slip included."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import final

import numpy as np

from toothspace.closures.set_valued_friction import STUCK, next_direction
from toothspace.core.progress import Progress
from toothspace.core.status import Event, Status
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.assembly import System
from toothspace.solver.compiled_model import hold_shaft
from toothspace.solver.initial import start_state
from toothspace.solver.integrator import March, start_march

_CELLS_PER_CHUNK = 50
_KINKS = 1000


@final
@dataclass(frozen=True)
class TimePlan:
    """Duration and sampling of a transient run."""

    duration: float
    """Simulated time. [s]"""
    cells: int = 4000
    """Rows of the result; each keeps mean, lowest and highest value of its samples."""
    samples_per_cell: int = 8
    """Samples evaluated in each cell."""
    max_steps: int = 50_000_000
    """Most time steps."""
    channels: tuple[str, ...] | None = None
    """Kept variables of those with several values in each sample; all if not given."""


@final
@dataclass
class TransientMarch:
    """A transient run in progress: chunks of sampled states, and events."""

    system: System
    """Machine with a free shaft."""
    plan: TimePlan
    """Duration and sampling."""
    status: Status = Status.DONE
    events: list[Event] = field(default_factory=list)
    statistics: dict[str, float] = field(default_factory=dict)
    first: Array = field(default_factory=lambda: np.zeros(0))
    last: Array = field(default_factory=lambda: np.zeros(0))
    time: float = 0.0

    def chunks(self, progress: Progress | None = None) -> Iterator[tuple[Array, Array]]:
        """Yield times [s] and states of whole cells until the end, a failure or an interrupt."""
        state = start_state(self.system)
        self.first = self.last = state
        settle(self.system, state, 0.0)
        march = start_march(self.system, state, self.plan.max_steps)
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
        """States at the times; restarts at kinks of schedules and where the shaft switches."""
        parts: list[Array] = []
        begin = times[0] - (times[1] - times[0])
        for kink in [*self._kinks(begin, times[-1]), None]:
            until = times.size if kink is None else int(np.searchsorted(times, kink, "right"))
            ahead = times[sum(map(len, parts)) : until]
            if kink is not None and (ahead.size == 0 or ahead[-1] < kink):
                ahead = np.append(ahead, kink)
            states = self._advance_smoothly(march, ahead)
            parts.append(states[: until - sum(map(len, parts))])
            if self.status is not Status.DONE:
                break
            if kink is not None:
                self._pass_kink(march, kink)
        return np.vstack(parts)

    def _advance_smoothly(self, march: March, times: Array) -> Array:
        parts = [np.zeros((0, self.system.arrays.size.total))]
        while times.size:
            piece = march.advance(times)
            parts.append(piece.states)
            self.events.extend(piece.events)
            self.statistics = march.statistics
            self.status = piece.status
            times = times[len(piece.states) :]
            if not piece.stopped:
                break
            state = march.state.y.copy()
            time = float(march.state.control[0]["valid_until"])
            drive = self.system.arrays.drive
            if drive[col.DIRECTION] == STUCK:
                drive[col.DIRECTION] = next_direction(0.0, drive[col.DRIVING_TORQUE], 0.0)
            else:
                state[1] = 0.0
                settle(self.system, state, time)
            march.restart(time, state)
        return np.vstack(parts)

    def _kinks(self, begin: float, end: float) -> list[float]:
        speed = self.system.condition.speed_schedule
        circuit = self.system.condition.circuit
        tables = [e.history for e in circuit.elements] if circuit else []
        knots = np.unique(np.concatenate([table[:, 0] for table in (speed, *tables)]))
        if knots.size > _KINKS:
            knots = np.unique(speed[:, 0])
        return [float(knot) for knot in knots if begin < knot <= end]

    def _pass_kink(self, march: March, time: float) -> None:
        state = march.state.y.copy()
        speed = self.system.condition.speed_schedule
        if len(speed):
            state[1] = np.interp(time, speed[:, 0], speed[:, 1])
        settle(self.system, state, time)
        march.restart(time, state)


def settle(system: System, state: Array, time: float) -> None:
    """Let the shaft stick if it is at rest and friction can hold it; else set its direction."""
    drive = system.arrays.drive
    drive[col.DIRECTION] = np.sign(state[1])
    if drive[col.FREE] == 0.0:
        speed = system.condition.speed_schedule
        if state[1] == 0.0 and len(speed):
            later = speed[speed[:, 0] > time, 1]
            drive[col.DIRECTION] = np.sign(later[0]) if later.size else 0.0
        return
    if state[1] != 0.0:
        return
    hold_shaft(system.arrays, state, time)
    holding = drive[col.HOLDING_TORQUE] if drive[col.BREAKAWAY] > 0.0 else 0.0
    drive[col.DIRECTION] = next_direction(0.0, drive[col.DRIVING_TORQUE], holding)
