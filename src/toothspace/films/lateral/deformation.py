"""Widening of the gaps by distant pressures within a step, and what films and forces make of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, final

import numpy as np

from toothspace.core.types import Array
from toothspace.films.lateral.basis_functions import Patterns
from toothspace.films.lateral.face_film import FaceFilm
from toothspace.films.lateral.stack import StackState, mean_coefficients
from toothspace.numerics.acceleration import Mixing, mixed
from toothspace.numerics.side_by_side import side_by_side

Fields = list[list[Array]]
"""Widening of every scene and film. [m]"""


@final
@dataclass(frozen=True, eq=False)
class Response:
    """What films, bodies and forces make of smooth patterns that open the gaps.

    Parameters
    ----------
    patterns : tuple of Patterns
        Patterns of every film.
    gain : ndarray, shape (n, n)
        Sizes of patterns of the distant widening by the pressures per size of a pattern. [-]
    force : ndarray, shape (coordinates, n)
        Film force on the coordinates per size. [N/m, N]
    planes : ndarray, shape (n, coordinates)
        Sizes per unit of the coordinates. [-, m]
    squeezed : ndarray, shape (n, coordinates)
        Sizes of patterns of the distant widening per rate of the coordinates. [s, m s]
    drag : ndarray, shape (coordinates, coordinates)
        Damping of the films where the distant widening stays. [N s/m, N s, N m s]
    frequency : float
        Inverse of the step over which patterns grow, 0 where the widening is steady. [1/s]
    """

    patterns: tuple[Patterns, ...]
    gain: Array
    force: Array
    planes: Array
    squeezed: Array
    drag: Array
    frequency: float
    settled: Array = field(init=False, repr=False)
    """Sizes in the end, per size of what the widening misses. [-]"""
    pull: Array = field(init=False, repr=False)
    """Film force in the end, per size of what the widening misses. [N/m, N]"""

    def __post_init__(self) -> None:
        object.__setattr__(self, "settled", np.linalg.inv(np.eye(len(self.gain)) - self.gain))
        object.__setattr__(self, "pull", self.force @ self.settled)

    @property
    def coefficients(self) -> tuple[Array, Array]:
        """Stiffness and damping of the films with the widening that follows.

        Of patterns that grow over a step the first holds the damping of that step, too.
        """
        return -self.pull @ self.planes, self.drag - self.pull @ self.squeezed

    def follow(self, missing: Array, step: Array, rate: Array) -> Array:
        """Sizes by which the widening changes until it misses nothing. [m].

        Parameters
        ----------
        missing : ndarray
            Sizes of what it misses. [m]
        step, rate : ndarray
            Change of the coordinates and of their rates. [m, rad, m/s, rad/s]
        """
        asked = missing + self.gain @ (self.planes @ step) + self.squeezed @ rate
        return np.asarray(self.settled @ asked)

    def sizes(self, fields: Sequence[Array]) -> Array:
        """Sizes of the patterns nearest to the fields of all films. [m]."""
        return np.concatenate([p.sizes(f) for p, f in zip(self.patterns, fields, strict=True)])

    def fields(self, sizes: Array) -> list[Array]:
        """Fields of all films with patterns of given sizes. [m]."""
        parts = np.split(sizes, np.cumsum([p.count for p in self.patterns])[:-1])
        return [p.total(s) for p, s in zip(self.patterns, parts, strict=True)]


class Fineness(NamedTuple):
    """Patterns of widening whose response is kept, and for how many phases of a tooth pitch."""

    waves: int
    degree: int
    phases: int = 1


def response(state: StackState, fineness: Fineness, frequency: float) -> Response:
    """Response of solved films to patterns that open the gaps.

    Parameters
    ----------
    state : StackState
        Films.
    fineness : Fineness
        Waves and degree of the patterns. [-]
    frequency : float
        Inverse of the length of a step over which patterns grow and the coordinates move; 0 where
        the widening counts as steady and rates of the coordinates are told apart. [1/s]
    """
    stack = state.stack
    patterns = tuple(Patterns(grid, fineness.waves, fineness.degree) for grid in stack.grids)

    films, size = range(len(patterns)), stack.grids[0].area.size

    def one(k: int) -> Array:
        film, asked = state.films[k], patterns[k].lifts(frequency)
        return np.array([film.pressure_changes([lift])[0] for lift in asked])

    changes = side_by_side(one, films, size)
    loads = [_loads(film, c) for film, c in zip(state.films, changes, strict=True)]
    force = [chain.T @ load for chain, load in zip(stack.chains, loads, strict=True)]
    planes = [own.planes() @ chain for own, chain in zip(patterns, stack.chains, strict=True)]
    gain = stack.compliance.gain(changes, state.scene, patterns)
    squeezed, drag = np.zeros((len(gain), stack.size)), np.zeros((stack.size, stack.size))
    if frequency == 0.0:
        rates = side_by_side(lambda k: _squeezed(state.films[k]), films, size)
        squeezed = stack.compliance.gain(rates, state.scene, patterns) @ np.vstack(stack.chains)
        for film, chain, rate in zip(state.films, stack.chains, rates, strict=True):
            drag -= chain.T @ _loads(film, rate) @ chain
    return Response(patterns, gain, np.hstack(force), np.vstack(planes), squeezed, drag, frequency)


def _squeezed(film: FaceFilm) -> Array:
    """Change of the pressure with the rates of the upper face. [Pa s/m, Pa s]."""
    return np.array(film.pressure_changes(film.rates()))


def _loads(film: FaceFilm, changes: Array) -> Array:
    """Forces and moments of changes of the pressure, one column each. [N, N m]."""
    return np.array([film.grid.moments(c, film.around.mask.film) for c in changes]).T


def widened(states: Sequence[StackState], used: Fields, low: float) -> tuple[Fields, float]:
    """Widening [m] under the pressures found, and its largest change over the gap [-].

    Parameters
    ----------
    states : sequence of StackState
        Solved films, one state per scene.
    used : list
        Widening that they were solved with. [m]
    low : float
        Pressure under which nothing gives way. [Pa]
    """
    change, found = 0.0, []
    for state, old in zip(states, used, strict=True):
        new = state.stack.compliance.distant(state.face_pressures(low), state.scene)
        for film, a, b in zip(state.films, new, old, strict=True):
            if not (a.any() or b.any()):
                continue
            inside = film.around.mask.film
            floor = np.maximum(film.gap, max(film.law.roughness, 1e-8))
            change = max(change, float((np.abs(a - b) / floor)[inside].max()))
        found.append(new)
    return found, change


@final
class Widening:
    """Iteration of the distant widening beside that of films and positions.

    Parameters
    ----------
    states : sequence of StackState
        Films before the step, one state per scene.
    angles : sequence of float
        Shaft angles of the scenes. [rad]
    memory : int
        Former iterations from which the next is foreseen. [-]
    fineness : Fineness, optional
        Patterns whose response is taken along.
    kept : mapping of int to Response
        Responses that served at phases of the tooth pitch.
    frequency : float
        Inverse of the length of the step, 0 if the widening counts as steady. [1/s]
    """

    def __init__(
        self,
        states: Sequence[StackState],
        angles: Sequence[float],
        memory: int,
        fineness: Fineness | None,
        kept: Mapping[int, Response],
        frequency: float,
    ) -> None:
        self.used: Fields = [list(s.distant) for s in states]
        """Widening of the next films. [m]"""
        self.responses = {k: own for k, own in kept.items() if own.frequency == frequency}
        """Responses that serve the next steps, by the phase of the tooth pitch."""
        self._fineness, self._frequency = fineness, frequency
        self._phases: list[int] = []
        if fineness is not None:
            pitch = states[0].stack.balance.interfaces[0].period
            self._phases = [int(np.mod(a / pitch, 1.0) * fineness.phases) for a in angles]
        self._memory, self._mixing = memory, Mixing(memory)
        self._new = self.used
        self._missing: list[Array] = []

    @property
    def _own(self) -> list[Response]:
        """Responses of all scenes; none if they are not foreseen or not known yet."""
        if any(phase not in self.responses for phase in self._phases):
            return []
        return [self.responses[phase] for phase in self._phases]

    def take(self, states: Sequence[StackState], low: float) -> float:
        """Widening under the pressures found, and its largest change over the gap. [-]."""
        self._new, change = widened(states, self.used, low)
        return change

    def serving(
        self, jacobian: tuple[Array, Array] | None, age: int
    ) -> tuple[tuple[Array, Array] | None, int]:
        """Stiffness and damping to begin with, and the iterations that they have served."""
        if self._fineness is None:
            return jacobian, age
        return (_mean_of(self._own) if self._own else None), 0

    def renew(self, states: Sequence[StackState]) -> tuple[Array, Array]:
        """Stiffness and damping of the films, with the widening that follows if it is foreseen."""
        if self._fineness is None:
            return mean_coefficients(states)
        found: dict[int, Response] = {}
        for phase, state in zip(self._phases, states, strict=True):
            if phase not in found:
                found[phase] = response(state, self._fineness, self._frequency)
        self.responses |= found
        return _mean_of(self._own)

    def pull(self) -> Array | float:
        """Film force that the widening still missing will add. [N, N m]."""
        self._missing = []
        for own, used, new in zip(self._own, self.used, self._new, strict=False):
            self._missing.append(own.sizes([b - a for a, b in zip(used, new, strict=True)]))
        pulls = [own.pull @ m for own, m in zip(self._own, self._missing, strict=True)]
        return np.mean(pulls, axis=0) if pulls else 0.0

    def follow(self, states: Sequence[StackState], step: Array, rate: Array) -> Array:
        """Set the widening to use next and return the step of the coordinates to take. [m, rad].

        Parameters
        ----------
        states : sequence of StackState
            Films that were solved last.
        step, rate : ndarray
            Step that balances forces and its change of the rates. [m, rad, m/s, rad/s]
        """
        if self._memory == 0:
            return limited(states, step)
        new = self._new
        if self._own:
            pairs = zip(self._own, self._missing, strict=True)
            more = [own.fields(own.follow(m, step, rate) - m) for own, m in pairs]
            new = _sum(new, more)
        place = states[0].position, step
        new, step = mixed(self._mixing, (self.used, new), place, states[0].stack.arms)
        change = _sum(new, self.used, -1.0)
        part = 1.0 / overstep(states, step, change)
        self.used = _sum(self.used, change, part)
        return part * step

    def beside(
        self, slides: tuple[int, ...] | None, revised: tuple[int, ...] | None
    ) -> tuple[int, ...] | None:
        """Rest or slide of the bearings as revised; what was learnt with another is forgotten."""
        if revised != slides:
            self._mixing = Mixing(self._memory)
        return revised


def _sum(fields: Fields, others: Fields, part: float = 1.0) -> Fields:
    """Fields with a part of others added, scene by scene and film by film."""
    pairs = zip(fields, others, strict=True)
    return [[a + part * b for a, b in zip(*pair, strict=True)] for pair in pairs]


def film_coefficients(
    states: Sequence[StackState], fineness: Fineness | None
) -> tuple[Array, Array]:
    """Stiffness and damping of films, with the widening that follows if it is foreseen."""
    if fineness is None:
        return mean_coefficients(states)
    return _mean_of([response(state, fineness, 0.0) for state in states])


def limited(states: Sequence[StackState], step: Array) -> Array:
    """Longest part of a step [m, rad] that neither closes nor opens a gap by too much."""
    still = [[np.zeros_like(d) for d in state.distant] for state in states]
    return np.asarray(step / overstep(states, step, still))


def overstep(states: Sequence[StackState], step: Array, openings: Fields) -> float:
    """Step over the longest that neither closes nor opens a gap by too much, one at least. [-].

    Parameters
    ----------
    states : sequence of StackState
        Solved films, one state per scene.
    step : ndarray
        Step of the coordinates. [m, rad]
    openings : list
        What the step adds to the widening of every scene and film. [m]
    """
    still, most = np.zeros_like(step), 1.0
    for state, fields in zip(states, openings, strict=True):
        for k, (film, opening) in enumerate(zip(state.films, fields, strict=True)):
            motion = state.stack.film_place(k, step, still).position
            most = max(most, film.overstep(motion, opening))
    return most


def _mean_of(responses: Sequence[Response]) -> tuple[Array, Array]:
    """Stiffness and damping, means over scenes."""
    pairs = [own.coefficients for own in responses]
    return np.mean([k for k, _ in pairs], axis=0), np.mean([d for _, d in pairs], axis=0)
