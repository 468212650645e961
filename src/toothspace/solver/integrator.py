"""Marches one system in time with the compiled stiff integrator."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.status import Event, Status
from toothspace.core.types import Array, BoolArray
from toothspace.model import arrays as col
from toothspace.model.assembly import System
from toothspace.model.contact_data import loaded_contacts
from toothspace.numerics.ndf_types import (
    DONE,
    MAX_ORDER,
    MAX_STEPS,
    STOP_AT_EVENT,
    TERMINAL_EVENT,
    NdfSettings,
    NdfState,
    make_record,
    make_settings,
    make_state,
)
from toothspace.numerics.static_lu import LuProgram, analyse
from toothspace.solver.compiled_model import NO_RECORD, Integration, advance, begin, observe

_EVENT_CAPACITY = 20_000
_STEPS_PER_RADIAN = 40.0
_SHORTEST_STEP = 1e-15
_SLOWEST_SPEED = 0.1
_DAMPED_ORDER = 2
"""Highest order where bodies ring: beyond it, lightly damped oscillations bound the step. [-]"""
_SOLID = 1e9
"""Pressure at which oils are glass; a march that ends beyond it had no way out for its fluid
(S. Alsaad et al., "Glass transitions in lubricants", J. Lubr. Technol. 100, 1978). [Pa]"""
_STATUS = {
    DONE: Status.DONE,
    TERMINAL_EVENT: Status.DONE,
    MAX_STEPS: Status.MAX_STEPS,
}
_COUNTERS = {
    "steps": "steps",
    "rejected": "rejected",
    "rhs": "rhs_calls",
    "jac": "jacobian_calls",
    "lu": "factorisations",
}


@final
@dataclass(frozen=True)
class March:
    """One integration, advanced piece by piece."""

    system: System
    """What is integrated."""
    program: LuProgram
    settings: NdfSettings
    state: NdfState
    """Elimination program, settings and memory of the integrator."""

    def advance(self, sample_times: Array) -> Piece:
        """Integrate to the last sample time [s] and return the samples on the way."""
        record = make_record(sample_times, self.system.arrays.size.total, _EVENT_CAPACITY)
        end = float(sample_times[-1])
        integration = Integration(self.program, self.settings, self.state, record)
        code = advance(self.system.arrays, integration, end)
        written = int(record.counts[0])
        status = _STATUS.get(code, Status.STEP_TOO_SMALL)
        if skips(self.system, record.samples[:written]).any():
            status = Status.OUT_OF_MESH
        elif status is Status.STEP_TOO_SMALL and self._highest_pressure() > _SOLID:
            status = Status.FLUID_ENCLOSED
        count = min(int(record.counts[1]), record.event_times.size)
        events = []
        for k in range(count):
            time = float(record.event_times[k])
            kind = self._event_text(int(record.event_index[k]), int(record.event_direction[k]))
            events.append(Event(self.system.condition.shaft_speed * time, time, *kind))
        return Piece(
            status=status,
            stopped=code == TERMINAL_EVENT,
            times=record.sample_times[:written],
            states=record.samples[:written],
            events=tuple(events),
        )

    def restart(self, time: float, state: Array) -> None:
        """Go on from a state at a time [s] after a terminal event, at first order."""
        before = self.state.control.copy()
        integration = Integration(self.program, self.settings, self.state, NO_RECORD)
        begin(self.system.arrays, integration, time, state)
        for name in _COUNTERS.values():
            self.state.control[name] += before[name]

    def _highest_pressure(self) -> float:
        """Highest pressure in a chamber at the state that was reached. [Pa]."""
        arrays = self.system.arrays
        seen = observe(arrays, self.state.y[None], self.state.control["time"])
        return float(seen.pressure[0, : arrays.size.chambers].max())

    @property
    def statistics(self) -> dict[str, float]:
        """Counters of the integrator since its start."""
        control = self.state.control[0]
        return {key: float(control[name]) for key, name in _COUNTERS.items()}

    def _event_text(self, index: int, direction: int) -> tuple[str, str]:
        description = self.system.description
        if index < description.chamber_count:
            kind = "cavitation_onset" if direction < 0 else "cavitation_end"
            return kind, description.chamber_labels[index]
        journal = index - description.chamber_count
        if journal < self.system.arrays.size.journals:
            kind = "body_at_stop" if direction < 0 else "body_off_stop"
            blocks = description.free_blocks
            films = (*description.journals, *((blocks.film,) if blocks else ()))
            return kind, films[journal].body
        contact = journal - self.system.arrays.size.journals
        size = self.system.arrays.size
        if contact == (size.compliant if size.compliant else min(size.contacts, 1)):
            sticking = self.system.arrays.drive[col.DIRECTION] == 0.0
            return ("shaft_released" if sticking else "shaft_stopped"), "shaft"
        kind = "contact_lost" if direction < 0 else "contact_made"
        if self.system.arrays.size.compliant:
            return kind, self.system.contact_labels[contact]
        return kind, loaded_contacts(description, self.system.condition)[0].name


def skips(system: System, states: Array) -> BoolArray:
    """Whether a body has turned by more than half a tooth pitch from its place in the mesh.

    Tables and contacts are those of the teeth that belong together, to first order in small
    motions: beyond they are of other teeth, and nothing that follows means anything.

    Parameters
    ----------
    system : System
        Machine with its free motions.
    states : ndarray
        States over time.

    Returns
    -------
    ndarray of bool
        One value for each state.
    """
    first, motions = system.arrays.size.position, system.description.motions
    turning = [
        first + k for k, m in enumerate(system.free_motions) if motions[m].axis == "rotation"
    ]
    half_pitch = np.pi / system.description.families[0].count
    return np.asarray((np.abs(states[:, turning]) > half_pitch).any(axis=1))


@final
@dataclass(frozen=True)
class Piece:
    """Part of a history: states at the sample times, and events."""

    status: Status
    times: Array
    states: Array
    events: tuple[Event, ...]
    stopped: bool = False

    @classmethod
    def joined(cls, pieces: Sequence[Piece]) -> Piece:
        """One piece of several that follow each other, with the status of the last."""
        return cls(
            pieces[-1].status,
            np.concatenate([piece.times for piece in pieces]),
            np.concatenate([piece.states for piece in pieces]),
            tuple(event for piece in pieces for event in piece.events),
        )


def start_march(system: System, state: Array, max_steps: int = 50_000_000) -> March:
    """Prepare an integration from a state at time zero."""
    size = system.arrays.size
    events = size.chambers + size.journals
    events += size.compliant if size.compliant else min(size.contacts, 1)
    program = analyse(system.pattern, system.basis)
    actions = np.zeros(events, dtype=np.int64)
    longest, shortest = np.inf, _SHORTEST_STEP
    if system.condition.free_shaft:
        actions = np.append(actions, STOP_AT_EVENT)
    else:
        schedule = system.condition.speed_schedule
        speeds = np.append(schedule[:, 1], system.condition.shaft_speed)
        speed = max(float(np.abs(speeds).max()), _SLOWEST_SPEED)
        longest, shortest = 1.0 / (_STEPS_PER_RADIAN * speed), 1e-16 / speed
    highest = _DAMPED_ORDER if system.description.rings_on_films else MAX_ORDER
    settings = make_settings(actions, longest, shortest, max_steps, (1, highest))
    memory = make_state(program, size.total, actions.size)
    begin(system.arrays, Integration(program, settings, memory, NO_RECORD), 0.0, state)
    return March(system, program, settings, memory)
