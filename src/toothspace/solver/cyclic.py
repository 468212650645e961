"""Marches revolution by revolution until the machine repeats itself."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, final

import numpy as np

from toothspace.core.progress import UNKNOWN, Progress, tell
from toothspace.core.status import Event, Status
from toothspace.core.types import Array, IntArray
from toothspace.model import arrays as col
from toothspace.model.assembly import System
from toothspace.model.description import MachineDescription
from toothspace.numerics.acceleration import Mixing
from toothspace.results.ripple import AGREEMENT
from toothspace.solver.compiled_model import observe
from toothspace.solver.initial import start_state
from toothspace.solver.integrator import March, Piece, start_march

_TURN = 2.0 * np.pi
MEANS = 5e-3
"""Largest standard error of the means of a machine that never repeats itself, over those of an
ideal machine. [-]"""
_FIRST_ASKED = 8
"""Revolutions after which it is asked first whether they tell means. [-]"""
_SHOWN_WHOLE = 16
"""Revolutions up to which all samples are kept. [-]"""
_PIECES = 48
"""Parts of a revolution after each of which the march is looked at. [-]"""
DENSE = 11520
"""States of a revolution between which extremes and spectra are looked for."""
SEEN = 4
"""Every so many of the dense states of a revolution are evaluated."""
_COMPARED = 128
"""Every so many of them are compared from one revolution to the next."""
_CYCLIC_PRESSURE = AGREEMENT
_CYCLIC_POSITION = 2e-3
_SAME_PLACE = 1e-9
_COMPARED_IN_PITCH = 12
_MOST_PITCHES = 60
_SAME_PITCH = 0.25
"""Change of the pressures from pitch to pitch, over what counts as none in a revolution. [-]"""
_NEAR_TOLERANCE, _NEAR = 1e-5, 4.0
"""Relative tolerance near the cyclic state, and change there over that of cyclic ones. [-]"""
_SAME_TEETH = 1e-6
_PATIENCE = 4
"""Revolutions marched freely before the periodic state is searched for."""
_HURRY = 8
"""Revolutions up to which the search moves on from every one, then from every second one."""
_WAIT = 6
"""Changes among which one is expected to be smaller than those before."""
_NEARER = 0.8
_MEMORY = 10
"""Revolutions that the search for the periodic state remembers."""
_COMPRESSION = 0.01
"""Change of a chamber's mass that counts as much as one of a body by its clearance. [-]"""
_LARGEST_MOVE = 0.5
"""Largest step of the search, of a mass or a clearance. [-]"""


@final
@dataclass(frozen=True)
class RunPlan:
    """How long to march and how densely to sample."""

    revolutions: int | None = None
    """Shaft revolutions, or None to go on until cyclic."""
    max_revolutions: int = 40
    """Largest number of revolutions on the way to the cyclic state."""
    averaged_revolutions: int = 64
    """Most revolutions that tell the means of a machine which never repeats itself."""
    samples_per_revolution: int = 720
    """Samples kept in each revolution."""
    max_steps: int = 50_000_000
    """Most time steps."""
    by_pitch: bool = False
    """Whether to look for a state that repeats after each tooth pitch, which takes few of them.

    Energies are then not held to their balance, and the dense states are those of the first pitch.
    Machines whose teeth differ go by revolutions.
    """


@final
@dataclass(frozen=True)
class DenseStates:
    """States of a revolution close enough for extremes, however few samples are kept."""

    times: Array
    """Times at :data:`DENSE` equal intervals, both ends. [s]"""
    states: Array
    """States there."""


@final
@dataclass(frozen=True)
class History:
    """The last revolution of a march: states at its samples (both ends) and its events.

    Of a machine that does not repeat itself after one, several.
    """

    status: Status
    system: System
    times: Array
    states: Array
    events: tuple[Event, ...]
    revolutions: int
    statistics: dict[str, float]
    dense: DenseStates | None = None
    """All states that extremes are looked for in, if it has them: of the same revolution, or of the
    first of the parts that are alike.
    """
    apart: float = np.inf
    """Smallest of the last changes from one revolution to the next, over what counts as none."""
    alike: int = 1
    """Equal parts of the revolution that differ by the names of the chambers alone. [-]"""
    spanned: int = 1
    """Revolutions of the states: several where one does not repeat itself. [-]"""
    mean_errors: tuple[float, float] | None = None
    """Of a machine that never repeats itself, standard errors of its mean flow and torque. [-]"""


def march_revolutions(
    system: System, plan: RunPlan, progress: Progress | None = None, state: Array | None = None
) -> History:
    """March until cyclic, or for a number of revolutions; an interrupt keeps what is done.

    Two revolutions agree when the pressures differ by less than 2e-4 of the largest port
    pressure (root mean square over chambers and samples) and all bodies by less than 2e-3 of
    their clearance. The march ends before its last revolution where they no longer come closer.
    """
    if plan.by_pitch:
        found = _march_pitches(system, plan, progress, state, 1.0)
        if found is not None:
            return found
    march = start_march(system, start_state(system) if state is None else state, plan.max_steps)
    grid, offsets = _samples_of_a_turn(system, plan)
    limit = plan.revolutions or plan.max_revolutions
    previous: Piece | None = None
    status = Status.DONE if plan.revolutions else Status.NOT_CYCLIC
    done = 0
    changes: list[float] = []
    search: _PeriodicSearch | None = None
    try:
        for k in range(limit):
            piece = _revolution(march, k, offsets, progress, limit if plan.revolutions else 0)
            if piece.status is not Status.DONE:
                previous, status = piece, piece.status
                break
            done = k + 1
            # a revolution that was begun elsewhere says nothing about the one before
            if previous is not None and not (search and search.moved):
                every = grid.dense[::_COMPARED]
                changes.append(max(_change(system, previous.states[every], piece.states[every])))
            previous = piece
            if plan.revolutions is not None:
                continue
            if changes and changes[-1] <= 1.0:
                status = Status.DONE
                break
            # the last changes are as large as those before
            recent, earlier = changes[-_WAIT:], changes[-2 * _WAIT : -_WAIT]
            if len(earlier) == _WAIT and min(recent) > _NEARER * min(earlier):
                status = Status.NOT_REPEATING
                break
            # beginning elsewhere costs steps at first order: only where closing takes long
            search = search or _PeriodicSearch(system, piece)
            search.learn(piece)
            # changes that fall fast enough let the next revolution agree
            free = (
                search.closes(piece)
                if search.moved
                else (len(changes) > 1 and changes[-1] ** 2 <= changes[-2])
            )
            search.moved = done >= _PATIENCE and not free and not (search.moved and done >= _HURRY)
            if search.moved:
                march.restart(float(piece.times[-1]), search.start(piece))
    except KeyboardInterrupt:
        status = Status.INTERRUPTED
        if previous is None:
            raise
    assert previous is not None
    return replace(
        grid.history(status, system, previous),
        revolutions=done,
        statistics={**march.statistics, "revolutions": float(done)},
        apart=min(changes[-_WAIT:], default=np.inf),
    )


def march_several(
    history: History,
    plan: RunPlan,
    errors_of: Callable[[Sequence[History]], tuple[float, float]],
    progress: Progress | None = None,
) -> History:
    """Go on from a march whose revolutions do not agree, for what several of them tell.

    A machine may repeat itself after some revolutions: they are returned, and ``done``. Lobes and
    teeth that knock may never do so: then as many are returned as tell the means to :data:`MEANS`,
    at most ``plan.averaged_revolutions``, which are ``not_repeating`` where they do not. A march
    that ends early is the last of these, with its status.

    Parameters
    ----------
    errors_of : callable
        Standard errors of means over revolutions. It is asked of some and of each time twice as
        many.
    """
    system = history.system
    march = start_march(system, first_turn_state(history), plan.max_steps)
    grid, offsets = _samples_of_a_turn(system, plan, DENSE // SEEN)
    every = grid.dense[:: _COMPARED // SEEN]
    turned: list[History] = []
    compared: list[_Seen] = []
    asked = min(_FIRST_ASKED, plan.averaged_revolutions)
    found, k = history, 0
    try:
        for k in range(1, plan.averaged_revolutions + 1):
            piece = _revolution(march, k - 1, offsets, progress)
            one = grid.history(piece.status, system, piece)
            if piece.status is not Status.DONE:
                found = one
                break
            turned.append(one)
            compared.append(_seen(system, piece.states[every]))
            agreeing = (
                back
                for back in range(1, k)
                if max(_difference(system, compared[-1 - back], compared[-1], back * _TURN)) <= 1.0
            )
            period = next(agreeing, 0)
            if period:
                found = _joined(turned[-period:])
                break
            if k == asked:
                errors = errors_of(turned)
                status = Status.DONE if max(errors) <= MEANS else Status.NOT_REPEATING
                asked = min(2 * asked, plan.averaged_revolutions)
                if status is Status.DONE or k == asked:
                    found = replace(_joined(turned), status=status, mean_errors=errors)
                    break
    except KeyboardInterrupt:
        found = replace(history, status=Status.INTERRUPTED)
    return replace(
        found,
        revolutions=k,
        statistics={**march.statistics, "revolutions": float(k)},
        apart=history.apart,
    )


def _joined(parts: Sequence[History]) -> History:
    """Revolutions that follow each other as one history, with the status of the last.

    Many of them keep no more states in all than some.
    """
    most = -(-len(parts) // _SHOWN_WHOLE)

    def chained(arrays: Iterable[Array]) -> Array:
        first, *others = arrays
        # the end of one is the beginning of the next
        whole = np.concatenate([first, *(own[1:] for own in others)])
        return whole[:: next(k for k in range(most, 0, -1) if (len(whole) - 1) % k == 0)]

    dense = [part.dense for part in parts if part.dense]
    return replace(
        parts[-1],
        times=chained(part.times for part in parts),
        states=chained(part.states for part in parts),
        events=tuple(event for part in parts for event in part.events),
        dense=DenseStates(
            chained(own.times for own in dense), chained(own.states for own in dense)
        ),
        spanned=len(parts),
    )


def _samples_of_a_turn(
    system: System, plan: RunPlan, dense: int = DENSE
) -> tuple[_SampleGrid, Array]:
    """Samples of a revolution, and their times after its start. [s]."""
    grid = _SampleGrid.with_samples(plan.samples_per_revolution, dense)
    return grid, _TURN / system.condition.shaft_speed * grid.shares


def _revolution(
    march: March, before: int, offsets: Array, progress: Progress | None, of: int = 0
) -> Piece:
    """March one revolution after so many before, of so many in all where that is known."""
    pieces: list[Piece] = []
    # in short pieces, so that a march ends soon where it went astray
    for part in np.array_split(before * offsets[-1] + offsets, _PIECES):
        pieces.append(march.advance(part))
        share = (before + len(pieces) / _PIECES) / of if of else UNKNOWN
        tell(progress, share, f"revolution {before + 1}")
        if pieces[-1].status is not Status.DONE:
            break
    return Piece.joined(pieces)


def march_near(
    system: System, plan: RunPlan, progress: Progress | None = None, state: Array | None = None
) -> History | None:
    """Revolution near the cyclic state, made of a tooth pitch that is much like the one before.

    Its mean flows and losses, and its last state to go on from, are those of a machine that has
    nearly settled. None where teeth differ from one another, or where no pitch is like another.
    """
    tolerance = max(_NEAR_TOLERANCE, system.condition.relative_tolerance)
    return _march_pitches(system.at(relative_tolerance=tolerance), plan, progress, state, _NEAR)


def _march_pitches(
    system: System, plan: RunPlan, progress: Progress | None, state: Array | None, alike: float
) -> History | None:
    """March until a pitch is like the one before, and make a revolution of the last one.

    None where teeth differ from one another, or where no pitch is like the one before.

    Parameters
    ----------
    alike : float
        Change from pitch to pitch that counts as none, over that of cyclic states. [-]
    """
    size, count = system.arrays.size, round(_TURN / system.description.pitch_angle)
    pitch = _TURN / count
    time = pitch / system.condition.shaft_speed
    march = start_march(system, start_state(system) if state is None else state, plan.max_steps)
    grid = _SampleGrid.with_samples(plan.samples_per_revolution)
    # every sample of a revolution is one of a pitch, with other chambers
    shares = grid.shares[grid.own] if plan.by_pitch else grid.shares
    pitches = np.minimum((count * shares + _SAME_PLACE).astype(int), count - 1)
    offsets = np.round(count * shares - pitches, 9)
    closer = SEEN * -(-DENSE // (SEEN * count))
    dense = np.round(np.arange(closer + 1) / closer, 9) if plan.by_pitch else offsets[:0]
    inside = np.unique(np.concatenate([offsets, dense]))
    places = np.searchsorted(inside, offsets)
    few = np.linspace(0.0, 1.0, _COMPARED_IN_PITCH + 1)
    before, closed = np.zeros((0, 0)), False
    for k in range(_MOST_PITCHES):
        piece = march.advance(time * (k + (inside if closed else few)))
        tell(progress, UNKNOWN, f"pitch {k + 1}")
        if piece.status is not Status.DONE:
            return None
        if closed:
            break
        if k == 0:
            if not _teeth_alike(system, piece.states, pitch):
                return None
        else:
            pressures, places_of_bodies = _change(system, before, piece.states, pitch)
            change = max(pressures / _SAME_PITCH, count * places_of_bodies)
            closed = k > 1 and change <= alike
        before = piece.states
    else:
        return None
    # back to the first pitch, where the revolution begins
    states = _turned(system, piece.states, -k * pitch)
    sums = slice(size.core, None)
    states[:, sums] -= states[0, sums]
    # what little it has moved on is taken back evenly, so that no seam shows in the flows
    rest = slice(1, size.core)
    drift = states[-1, rest] - _turned(system, states[:1], pitch)[0, rest]
    states[:, rest] -= inside[:, None] * drift
    whole = np.empty((shares.size, states.shape[1]))
    for j in range(count):
        rows = np.flatnonzero(pitches == j)
        whole[rows] = _turned(system, states[places[rows]], j * pitch)
        whole[rows, sums] += j * states[-1, sums]
    times = count * time * shares
    found = History(
        Status.DONE,
        system,
        times,
        whole,
        piece.events,
        1,
        {**march.statistics, "revolutions": (k + 1) / count},
    )
    if plan.by_pitch:
        close = np.searchsorted(inside, dense)
        return replace(found, dense=DenseStates(time * dense, states[close]), alike=count)
    return replace(
        found,
        times=times[grid.own],
        states=whole[grid.own],
        dense=DenseStates(times[grid.dense], whole[grid.dense]),
    )


def _teeth_alike(system: System, states: Array, pitch: float) -> bool:
    """Whether a machine that has turned on by a pitch [rad] is the same, with other chambers."""
    here = observe(system.arrays, states)
    there = observe(system.arrays, _turned(system, states, pitch))
    return all(
        np.allclose(
            old, new, rtol=_SAME_TEETH, atol=_SAME_TEETH * float(np.abs(old).max(initial=0.0))
        )
        for old, new in (
            (here.torque, there.torque),
            (here.pressure_force, there.pressure_force),
            (np.abs(here.path_flow).sum(axis=1), np.abs(there.path_flow).sum(axis=1)),
        )
    )


@final
@dataclass(frozen=True)
class _SampleGrid:
    """Where in a revolution states are wanted: at its samples, and densely."""

    shares: Array
    """Ascending shares of the revolution. [-]"""
    own: IntArray
    dense: IntArray
    """Places of the samples and of the dense states among them."""

    @classmethod
    def with_samples(cls, samples: int, states: int = DENSE) -> _SampleGrid:
        """Grid with so many samples and dense states, which mostly are the same."""
        dense, own = (np.arange(count + 1) / count for count in (states, samples))
        shares = dense if states % samples == 0 else np.union1d(dense, own)
        return cls(shares, np.searchsorted(shares, own), np.searchsorted(shares, dense))

    def history(self, status: Status, system: System, piece: Piece) -> History:
        """What a piece, that may have been cut short, says of a revolution."""
        own, dense = (places[places < piece.times.size] for places in (self.own, self.dense))
        return History(
            status,
            system,
            piece.times[own],
            piece.states[own],
            piece.events,
            0,
            {},
            DenseStates(piece.times[dense], piece.states[dense]) if dense.size > 1 else None,
        )


@final
class _PeriodicSearch:
    """Looks for the state that a revolution leads back to, from the revolutions marched.

    Slow changes, as of a body that spirals to its place, take hundreds of revolutions to die
    away; Anderson's mixing of the map from one revolution to the next finds where they lead.
    """

    def __init__(self, system: System, piece: Piece) -> None:
        # mixing weighs all parts of the state together: each in units of what a machine notices
        size, state = system.arrays.size, piece.states[-1]
        self._system, self._part = system, slice(size.mass, size.load)
        scale = np.ones_like(state)
        mass, gas = slice(size.mass, size.gas), slice(size.gas, size.position)
        scale[mass] = _COMPRESSION * state[mass].mean()
        scale[gas] = max(float(state[gas].mean()), 1e-12)
        clearance = system.arrays.motion[:, col.CLEARANCE]
        scale[size.position : size.velocity] = clearance
        scale[size.velocity : size.column] = clearance * system.condition.shaft_speed
        scale[size.column : size.load] = (
            np.abs(piece.states[:, size.column : size.load]).max(axis=0) + 1e-12
        )
        self._scale = scale[self._part]
        self._mixing = Mixing(_MEMORY)
        self._found = np.zeros(0)
        self.moved = False

    def learn(self, piece: Piece) -> None:
        """Take a marched revolution into account."""
        first, last = (
            _in_first_turn(self._system, piece.states[k])[self._part] / self._scale for k in (0, -1)
        )
        self._found = self._mixing.following(first, last - first)

    def closes(self, piece: Piece) -> bool:
        """Whether a revolution ends where it began: the next one shows whether it repeats."""
        return max(_change(self._system, piece.states[:1], piece.states[-1:])) <= 1.0

    def start(self, piece: Piece) -> Array:
        """State to begin the next revolution with, not too far from where this one ended."""
        system, last = self._system, piece.states[-1]
        size = system.arrays.size
        state = _in_first_turn(system, last)
        state[self._part] = self._found * self._scale
        step = _turned(system, state[None], last[0] - state[0])[0] - last
        masses, place = slice(size.mass, size.position), slice(size.position, size.velocity)
        moved = np.concatenate(
            [
                step[masses] / np.maximum(last[masses], 1e-30),
                step[place] / system.arrays.motion[:, col.CLEARANCE],
            ]
        )
        return np.asarray(last + min(1.0, _LARGEST_MOVE / np.abs(moved).max()) * step)


def successors(description: MachineDescription, turn: float = _TURN) -> IntArray:
    """Chamber that stood, a turn of the shaft [rad] before, where each chamber stands now.

    A chamber family may come back onto itself in one shaft revolution with its chambers
    exchanged, as the pockets of a rotor that turns more slowly than the shaft.

    Number of that chamber; the chamber itself where none stood there.
    """
    places, first = np.arange(description.chamber_count), 0
    for family in description.families:
        moved = turn * family.angle_ratio
        ahead = family.phases[:, None] + moved - family.phases[None, :]
        period = family.volume.period
        distance = np.abs(np.mod(ahead + 0.5 * period, period) - 0.5 * period)
        nearest = np.argmin(distance, axis=1)
        if distance[np.arange(family.count), nearest].max() < _SAME_PLACE * period:
            places[first : first + family.count] = first + nearest
        first += family.count
    return places


def first_turn_state(history: History) -> Array:
    """Last state of a march, with the shaft angle and the chambers back in the first turn."""
    return _in_first_turn(history.system, history.states[-1])


def _in_first_turn(system: System, state: Array) -> Array:
    """State of the same machine whole turns before, its chambers renamed for it."""
    turns = np.floor(state[0] / _TURN + 0.5)
    return _turned(system, state[None], -_TURN * turns)[0]


def _turned(system: System, states: Array, turn: float) -> Array:
    """States of the same machine turned by an angle after which its chambers look the same. [rad].

    They are renamed for it.
    """
    moved, size = states.copy(), system.arrays.size
    moved[:, 0] += turn
    node = system.arrays.dynamic_index[: size.chambers]
    before = node[successors(system.description, turn)]
    for first in (size.mass, size.gas):
        moved[:, first + node] = states[:, first + before]
    return moved


class _Seen(NamedTuple):
    """What states are compared by."""

    pressure: Array
    """Of every node. [Pa]"""
    place: Array
    """Of every motion. [m] or [rad]"""


def _seen(system: System, states: Array) -> _Seen:
    size = system.arrays.size
    pressure = observe(system.arrays, states).pressure
    return _Seen(pressure, states[:, size.position : size.velocity])


def _change(
    system: System, before: Array, after: Array, turn: float = _TURN
) -> tuple[float, float]:
    """Changes of pressures and of places over what counts as none, between states a turn apart.

    Parameters
    ----------
    turn : float
        Shaft angle after which the chambers look the same. [rad]
    """
    return _difference(system, _seen(system, before), _seen(system, after), turn)


def _difference(system: System, before: _Seen, after: _Seen, turn: float) -> tuple[float, float]:
    """Changes as of :func:`_change`, of states that were looked at."""
    old, chambers = before.pressure.copy(), system.arrays.size.chambers
    old[:, :chambers] = old[:, successors(system.description, turn)]
    scale = max(system.condition.inlet_pressure, system.condition.outlet_pressure)
    apart = float(np.sqrt(np.mean((after.pressure - old) ** 2)))
    allowed = _CYCLIC_POSITION * system.arrays.motion[:, col.CLEARANCE]
    moved = np.abs(after.place - before.place)
    return apart / (_CYCLIC_PRESSURE * scale), float(np.max(moved / allowed, initial=0.0))
