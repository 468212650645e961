"""Marches revolution by revolution until the machine repeats itself."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.progress import UNKNOWN, Progress, tell
from toothspace.core.status import Status
from toothspace.core.types import Array, IntArray
from toothspace.model.arrays import CLEARANCE
from toothspace.model.assembly import System
from toothspace.model.description import MachineDescription
from toothspace.results.events import Event
from toothspace.results.ripple import AGREEMENT
from toothspace.solver.initial import start_state
from toothspace.solver.integrator import March, Piece, start_march

_CYCLIC_PRESSURE = AGREEMENT
_CYCLIC_POSITION = 2e-3
_SAME_PLACE = 1e-9
_PATIENCE = 8
_NEARER = 0.8


@final
@dataclass(frozen=True)
class RunPlan:
    """How long to march and how densely to sample.

    Parameters
    ----------
    revolutions : int or None
        Shaft revolutions, or None to go on until cyclic.
    max_revolutions : int
        Largest number of revolutions on the way to the cyclic state.
    samples_per_revolution : int
        Samples kept in each revolution.
    max_steps : int
        Most time steps.
    """

    revolutions: int | None = None
    max_revolutions: int = 40
    samples_per_revolution: int = 720
    max_steps: int = 50_000_000


@final
@dataclass(frozen=True)
class History:
    """The last revolution of a march: states at its samples (both ends) and its events."""

    status: Status
    system: System
    times: Array
    states: Array
    events: tuple[Event, ...]
    revolutions: int
    statistics: dict[str, float]
    stalled: bool = False
    """Whether successive revolutions differ without coming closer."""


def march_revolutions(
    system: System, plan: RunPlan, progress: Progress | None = None, state: Array | None = None
) -> History:
    """March until cyclic, or for a number of revolutions; an interrupt keeps what is done.

    Two revolutions agree when the pressures differ by less than 2e-4 of the largest port
    pressure (root mean square over chambers and samples) and all bodies by less than 2e-3 of
    their clearance. The march ends before its last revolution where they no longer come closer.
    """
    march = start_march(system, start_state(system) if state is None else state, plan.max_steps)
    turn = 2.0 * np.pi / system.condition.shaft_speed
    offsets = np.linspace(0.0, turn, plan.samples_per_revolution + 1)
    limit = plan.revolutions or plan.max_revolutions
    previous: Piece | None = None
    status = Status.DONE if plan.revolutions else Status.NOT_CYCLIC
    done, stalled = 0, False
    changes: list[float] = []
    try:
        for k in range(limit):
            piece = march.advance(k * turn + offsets)
            if piece.status is not Status.DONE:
                return _history(march, piece, piece.status, done)
            done = k + 1
            tell(progress, done / limit if plan.revolutions else UNKNOWN, f"revolution {done}")
            if previous is not None:
                changes.append(_change(system, previous, piece))
            previous = piece
            if changes and changes[-1] <= 1.0 and plan.revolutions is None:
                status = Status.DONE
                break
            stalled = _stalled(changes) and plan.revolutions is None
            if stalled:
                break
    except KeyboardInterrupt:
        status = Status.INTERRUPTED
        if previous is None:
            raise
    assert previous is not None
    return _history(march, previous, status, done, stalled=stalled)


def _stalled(changes: list[float]) -> bool:
    """Whether the last changes from one revolution to the next are as large as those before."""
    recent, earlier = changes[-_PATIENCE:], changes[-2 * _PATIENCE : -_PATIENCE]
    return len(earlier) == _PATIENCE and min(recent) > _NEARER * min(earlier)


def _history(
    march: March, piece: Piece, status: Status, revolutions: int, *, stalled: bool = False
) -> History:
    return History(
        status,
        march.system,
        piece.times,
        piece.states,
        piece.events,
        revolutions,
        {**march.statistics, "revolutions": float(revolutions)},
        stalled,
    )


def successors(description: MachineDescription) -> IntArray:
    """Chamber that stood, one revolution before, where each chamber stands now.

    A chamber family may come back onto itself in one shaft revolution with its chambers
    exchanged, as the pockets of a rotor that turns more slowly than the shaft.

    Parameters
    ----------
    description : MachineDescription
        The machine.

    Returns
    -------
    ndarray of int
        Number of that chamber; the chamber itself where none stood there.
    """
    places, first = np.arange(description.chamber_count), 0
    for family in description.families:
        turn = 2.0 * np.pi * family.angle_ratio
        ahead = family.phases[:, None] + turn - family.phases[None, :]
        period = family.volume.period
        distance = np.abs(np.mod(ahead + 0.5 * period, period) - 0.5 * period)
        nearest = np.argmin(distance, axis=1)
        if distance[np.arange(family.count), nearest].max() < _SAME_PLACE * period:
            places[first : first + family.count] = first + nearest
        first += family.count
    return places


def first_turn_state(history: History) -> Array:
    """Last state of a march, with the shaft angle and the chambers back in the first turn.

    Parameters
    ----------
    history : History
        March of whole revolutions.

    Returns
    -------
    ndarray
        State to go on from.
    """
    system, state = history.system, history.states[-1].copy()
    turns = int(np.floor(state[0] / (2.0 * np.pi) + 0.5))
    state[0] -= 2.0 * np.pi * turns
    places, size = successors(system.description), system.arrays.size
    node = system.arrays.dynamic_index[: size.chambers]
    for first in (size.mass, size.gas):
        for _ in range(turns):
            values = state[first + node].copy()
            state[first + node[places]] = values
    return state


def _change(system: System, before: Piece, after: Piece) -> float:
    """Largest change from one revolution to the next over what counts as none. [-]."""
    from toothspace.solver.compiled_model import observe

    every = slice(None, None, 8)
    old = observe(system.arrays, before.states[every]).pressure
    new = observe(system.arrays, after.states[every]).pressure
    chambers = system.arrays.size.chambers
    old[:, :chambers] = old[:, successors(system.description)]
    scale = max(system.condition.inlet_pressure, system.condition.outlet_pressure)
    pressures = float(np.sqrt(np.mean((new - old) ** 2))) / (_CYCLIC_PRESSURE * scale)
    size = system.arrays.size
    positions = slice(size.position, size.velocity)
    moved = np.abs(after.states[:, positions] - before.states[:, positions])
    allowed = _CYCLIC_POSITION * system.arrays.motion[:, CLEARANCE]
    return max(pressures, float(np.max(moved / allowed, initial=0.0)))
