"""Widening of the gaps by distant pressures within a step, and what films and forces make of it."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import NamedTuple, final

import numpy as np

from toothspace.core.types import Array
from toothspace.films.lateral_gap.mixing import Mixing, mixed
from toothspace.films.lateral_gap.patterns import Patterns
from toothspace.films.lateral_gap.stack import StackState, mean_coefficients
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
    """

    patterns: tuple[Patterns, ...]
    gain: Array
    force: Array
    planes: Array
    settled: Array = field(init=False, repr=False)
    """Sizes in the end, per size of what the widening misses. [-]"""
    pull: Array = field(init=False, repr=False)
    """Film force in the end, per size of what the widening misses. [N/m, N]"""

    def __post_init__(self) -> None:
        object.__setattr__(self, "settled", np.linalg.inv(np.eye(len(self.gain)) - self.gain))
        object.__setattr__(self, "pull", self.force @ self.settled)

    @property
    def stiffness(self) -> tuple[Array, Array]:
        """Stiffness and damping of the films, both in the first, with the widening that follows.

        The damping is that of the step for which the patterns grow.
        """
        found = -self.pull @ self.planes
        return found, np.zeros_like(found)

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
    """Response of solved films to patterns that grow over a step.

    Parameters
    ----------
    state : StackState
        Films.
    fineness : Fineness
        Waves and degree of the patterns. [-]
    frequency : float
        Inverse of the length of the step. [1/s]
    """
    stack = state.stack
    patterns = tuple(Patterns(grid, fineness.waves, fineness.degree) for grid in stack.grids)

    def one(k: int) -> Array:
        film = state.films[k]
        changes = (film.pressure_changes([lift])[0] for lift in patterns[k].lifts(frequency))
        return np.array(list(changes))

    changes = side_by_side(one, range(len(patterns)), stack.grids[0].area.size)
    force, planes = [], []
    for film, chain, change, own in zip(state.films, stack.chains, changes, patterns, strict=True):
        loads = [film.grid.moments(c, film.around.mask.film) for c in change]
        force.append(chain.T @ np.array(loads).T)
        planes.append(own.planes() @ chain)
    gain = stack.compliance.gain(changes, state.scene, patterns)
    return Response(patterns, gain, np.hstack(force), np.vstack(planes))


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
    memory : int
        Former iterations from which the next is foreseen. [-]
    fineness : Fineness, optional
        Patterns whose response is taken along.
    kept : mapping of int to Response
        Responses that served at phases of the tooth pitch.
    shaft_angle : float
        Angle at the end of the step. [rad]
    """

    def __init__(
        self,
        states: Sequence[StackState],
        memory: int,
        fineness: Fineness | None,
        kept: Mapping[int, Response],
        shaft_angle: float,
    ) -> None:
        self.used: Fields = [list(s.distant) for s in states]
        """Widening of the next films. [m]"""
        self.responses = dict(kept)
        """Responses that serve the next steps."""
        self._fineness, self._phase = fineness, 0
        if fineness is not None:
            pitch = states[0].stack.balance.interfaces[0].period
            self._phase = int(np.mod(shaft_angle / pitch, 1.0) * fineness.phases)
        self._memory, self._mixing = memory, Mixing(memory)
        self._new = self.used
        self._missing = np.zeros(0)

    @property
    def _response(self) -> Response | None:
        return self.responses.get(self._phase) if self._fineness is not None else None

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
        return None if self._response is None else self._response.stiffness, 0

    def renew(self, states: Sequence[StackState], duration: float) -> tuple[Array, Array]:
        """Stiffness and damping of the films, with the widening that follows if it is foreseen."""
        if self._fineness is None:
            return mean_coefficients(states)
        found = response(states[0], self._fineness, 1.0 / duration)
        self.responses[self._phase] = found
        return found.stiffness

    def pull(self) -> Array | float:
        """Film force that the widening still missing will add. [N, N m]."""
        if self._response is None:
            return 0.0
        missing = [b - a for a, b in zip(self.used[0], self._new[0], strict=True)]
        self._missing = self._response.sizes(missing)
        return self._response.pull @ self._missing

    def follow(self, q: Array, step: Array, arms: Array) -> Array:
        """Set the widening to use next and return the step of the coordinates to take. [m, rad]."""
        if self._memory == 0:
            return step
        own = self._response
        if own is not None:
            sizes = own.settled @ (self._missing + own.gain @ own.planes @ step) - self._missing
            more = own.fields(sizes)
            self._new = [[a + b for a, b in zip(self._new[0], more, strict=True)]]
        self.used, step = mixed(self._mixing, (self.used, self._new), (q, step), arms)
        return step

    def beside(
        self, slides: tuple[int, ...] | None, revised: tuple[int, ...] | None
    ) -> tuple[int, ...] | None:
        """Rest or slide of the bearings as revised; what was learnt with another is forgotten."""
        if revised != slides:
            self._mixing = Mixing(self._memory)
        return revised
