"""Widening of the gaps by distant pressures within a step, and what films and forces make of it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import final

import numpy as np

from toothspace.core.types import Array
from toothspace.films.lateral_gap.mixing import Mixing, mixed
from toothspace.films.lateral_gap.patterns import Patterns
from toothspace.films.lateral_gap.stack import StackState
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

    def sizes(self, fields: Sequence[Array]) -> Array:
        """Sizes of the patterns nearest to the fields of all films. [m]."""
        return np.concatenate([p.sizes(f) for p, f in zip(self.patterns, fields, strict=True)])

    def fields(self, sizes: Array) -> list[Array]:
        """Fields of all films with patterns of given sizes. [m]."""
        parts = np.split(sizes, np.cumsum([p.count for p in self.patterns])[:-1])
        return [p.total(s) for p, s in zip(self.patterns, parts, strict=True)]


def response(state: StackState, fineness: tuple[int, int], frequency: float) -> Response:
    """Response of solved films to patterns that grow over a step.

    Parameters
    ----------
    state : StackState
        Films.
    fineness : tuple of int
        Waves and degree of the patterns. [-]
    frequency : float
        Inverse of the length of the step. [1/s]
    """
    stack = state.stack
    patterns = tuple(Patterns(grid, *fineness) for grid in stack.grids)

    def one(k: int) -> Array:
        film = state.films[k]
        changes = (film.pressure_changes([lift])[0] for lift in patterns[k].lifts(frequency))
        return np.array([np.where(film.around.mask.film, c, 0.0) for c in changes])

    changes = side_by_side(one, range(len(patterns)), stack.grids[0].area.size)
    force, planes = [], []
    for film, chain, change, own in zip(state.films, stack.chains, changes, patterns, strict=True):
        loads = [film.grid.moments(c, film.around.mask.film) for c in change]
        force.append(chain.T @ np.array(loads).T)
        planes.append(own.planes() @ chain)
    gain = stack.compliance.gain(changes, state.scene, patterns)
    return Response(patterns, gain, np.hstack(force), np.vstack(planes))


@final
class Widening:
    """Iteration of the distant widening beside that of films and positions.

    Parameters
    ----------
    states : sequence of StackState
        Films before the step, one state per scene.
    memory : int
        Former iterations from which the next is foreseen. [-]
    fineness : tuple of int, optional
        Waves and degree of patterns whose response is taken along. [-]
    kept : Response, optional
        Response that served before.
    """

    def __init__(
        self,
        states: Sequence[StackState],
        memory: int,
        fineness: tuple[int, int] | None,
        kept: Response | None,
    ) -> None:
        self.used: Fields = [list(s.distant) for s in states]
        """Widening of the next films. [m]"""
        self.response = kept if fineness else None
        """What serves now."""
        self._fineness = fineness
        self._memory, self._mixing = memory, Mixing(memory)
        self._new = self.used
        self._missing = np.zeros(0)

    def take(self, states: Sequence[StackState], low: float) -> float:
        """Widening under the pressures found, and its largest change over the gap. [-]."""
        change, self._new = 0.0, []
        for state, old in zip(states, self.used, strict=True):
            new = state.stack.compliance.distant(state.face_pressures(low), state.scene)
            for film, a, b in zip(state.films, new, old, strict=True):
                if not (a.any() or b.any()):
                    continue
                inside = film.around.mask.film
                floor = np.maximum(film.gap, max(film.law.roughness, 1e-8))
                change = max(change, float((np.abs(a - b) / floor)[inside].max()))
            self._new.append(new)
        return change

    def serving(self, jacobian: tuple[Array, Array] | None) -> tuple[Array, Array] | None:
        """Jacobian of the step before, unless it lacks the response of the widening."""
        return jacobian if self._fineness is None or self.response is not None else None

    def renew(self, states: Sequence[StackState], duration: float) -> tuple[Array, Array]:
        """Stiffness and damping of the films, with the widening that follows if it is foreseen."""
        if self._fineness is None:
            pairs = [state.coefficients() for state in states]
            return np.mean([k for k, _ in pairs], axis=0), np.mean([d for _, d in pairs], axis=0)
        self.response = found = response(states[0], self._fineness, 1.0 / duration)
        # the damping is that of the step and stands with the stiffness
        stiffness = -found.pull @ found.planes
        return stiffness, np.zeros_like(stiffness)

    def pull(self) -> Array | float:
        """Film force that the widening still missing will add. [N, N m]."""
        if self.response is None:
            return 0.0
        missing = [b - a for a, b in zip(self.used[0], self._new[0], strict=True)]
        self._missing = self.response.sizes(missing)
        return self.response.pull @ self._missing

    def follow(self, q: Array, step: Array, reach: float) -> Array:
        """Set the widening to use next and return the step of the coordinates to take. [m, rad]."""
        if self._memory == 0:
            return step
        if self.response is not None:
            own = self.response
            sizes = own.settled @ (self._missing + own.gain @ own.planes @ step) - self._missing
            more = own.fields(sizes)
            self._new = [[a + b for a, b in zip(self._new[0], more, strict=True)]]
        self.used, step = mixed(self._mixing, (self.used, self._new), (q, step), reach)
        return step

    def beside(
        self, slides: tuple[int, ...] | None, revised: tuple[int, ...] | None
    ) -> tuple[int, ...] | None:
        """Rest or slide of the bearings as revised; what was learnt with another is forgotten."""
        if revised != slides:
            self._mixing = Mixing(self._memory)
        return revised
