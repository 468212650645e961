"""Deformation of the gaps by distant pressures within a step, and the response to it."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from itertools import islice
from typing import NamedTuple, TypeVar, final

import numpy as np

from toothspace.core.compiled import njit
from toothspace.core.types import Array, IntArray
from toothspace.floating.face_film import FaceFilm
from toothspace.floating.face_grid import BasisFunctions
from toothspace.floating.stack import StackState, mean_coefficients
from toothspace.model.film_faces import FILM
from toothspace.numerics.acceleration import Mixing
from toothspace.numerics.parallel import in_parallel

_SERVING = 1e-3
"""Accuracy of responses that only lead an iteration on. [-]"""
Fields = list[list[Array]]
"""Deformation of every snapshot and film. [m]"""


@final
@dataclass(frozen=True, eq=False)
class DeformationResponse:
    """Response of films, bodies and forces to smooth basis functions of the gaps."""

    basis: tuple[BasisFunctions, ...]
    """Those of every film."""
    gain: Array
    """Coefficients of the distant deformation by the pressures per coefficient of the gap. Shape
    (n, n). [-]
    """
    force: Array
    """Film force on the coordinates per coefficient. Shape (coordinates, n). [N/m, N]"""
    planes: Array
    """Coefficients per unit of the coordinates. Shape (n, coordinates). [-, m]"""
    squeezed: Array
    """Coefficients of the distant deformation per rate of the coordinates. Shape (n, coordinates).
    [s, m s]
    """
    drag: Array
    """Damping of the films where the distant deformation stays. Shape (coordinates, coordinates).
    [N s/m, N s, N m s]
    """
    frequency: float
    """Inverse of the step over which the gaps change, 0 where the deformation is steady. [1/s]"""
    settled: Array = field(init=False, repr=False)
    """Final coefficients per coefficient of what the deformation misses. [-]"""
    pull: Array = field(init=False, repr=False)
    """Final film force per coefficient of what the deformation misses. [N/m, N]"""

    def __post_init__(self) -> None:
        # the deformation answers to pressures that it changes itself: a geometric series
        object.__setattr__(self, "settled", np.linalg.inv(np.eye(len(self.gain)) - self.gain))
        object.__setattr__(self, "pull", self.force @ self.settled)

    @property
    def coefficients(self) -> tuple[Array, Array]:
        """Stiffness and damping of the films with the deformation that follows.

        Where gaps change over a step the stiffness holds the damping of that step, too.
        """
        return -self.pull @ self.planes, self.drag - self.pull @ self.squeezed

    def follow(self, missing: Array, step: Array, rate: Array) -> Array:
        """Coefficients by which the deformation changes until it misses nothing. [m].

        Parameters
        ----------
        missing : ndarray
            Coefficients of what it misses. [m]
        step, rate : ndarray
            Change of the coordinates and of their rates. [m, rad, m/s, rad/s]
        """
        asked = missing + self.gain @ (self.planes @ step) + self.squeezed @ rate
        return np.asarray(self.settled @ asked)

    def fields(self, coefficients: Array) -> list[Array]:
        """Fields of all films with given coefficients. [m]."""
        parts = np.split(coefficients, np.cumsum([p.count for p in self.basis])[:-1])
        return [p.combine(s) for p, s in zip(self.basis, parts, strict=True)]


T = TypeVar("T")
_AT_A_TIME = 200_000
"""Cells of the changes that are held at a time for one film: each takes six fields. [-]"""


class Fineness(NamedTuple):
    """Basis functions whose response is kept, and for how many phases of a tooth pitch."""

    waves: int
    degree: int
    phases: int = 1


def response(
    state: StackState, fineness: Fineness, frequency: float, accuracy: float = 0.0
) -> DeformationResponse:
    """Response of solved films to basis functions of the gaps.

    Parameters
    ----------
    fineness : Fineness
        Waves and degree of the basis functions. [-]
    frequency : float
        Inverse of the length of a step over which the gaps change and the coordinates move; 0
        where the deformation counts as steady and rates of the coordinates have a response of
        their own. [1/s]
    accuracy : float
        Residual of the linear solutions over their right-hand sides that is small enough, if it
        is larger than that of the films. [-]
    """
    stack = state.stack
    basis = basis_on(state, fineness)

    films, size = range(len(basis)), stack.grids[0].area.size

    def one(k: int) -> Array:
        film, asked = state.films[k], basis[k].gap_changes(frequency)
        several = max(1, _AT_A_TIME // size)
        found = np.empty((basis[k].count, *film.gap.shape))
        for first in range(0, len(found), several):
            part = list(islice(asked, several))
            found[first : first + several] = film.pressure_changes(part, accuracy)
        return found

    changes = in_parallel(one, films, size)
    loads = [_loads(film, c) for film, c in zip(state.films, changes, strict=True)]
    force = [chain.T @ load for chain, load in zip(stack.chains, loads, strict=True)]
    planes = [own.planes() @ chain for own, chain in zip(basis, stack.chains, strict=True)]
    gain = stack.compliance.gain(changes, state.snapshot, basis)
    squeezed, drag = np.zeros((len(gain), stack.size)), np.zeros((stack.size, stack.size))
    if frequency == 0.0:
        # change of the pressures with the rates of the upper face [Pa s/m, Pa s]
        rates = in_parallel(
            lambda k: np.array(state.films[k].pressure_changes(state.films[k].rates())), films, size
        )
        squeezed = stack.compliance.gain(rates, state.snapshot, basis) @ np.vstack(stack.chains)
        for film, chain, rate in zip(state.films, stack.chains, rates, strict=True):
            drag -= chain.T @ _loads(film, rate) @ chain
    return DeformationResponse(
        basis, gain, np.hstack(force), np.vstack(planes), squeezed, drag, frequency
    )


def basis_on(state: StackState, fineness: Fineness) -> tuple[BasisFunctions, ...]:
    """Basis functions of every face of a state, fitted where there is film."""
    pairs = zip(state.stack.grids, state.snapshot.masks, strict=True)
    return tuple(BasisFunctions(grid, *fineness[:2], mask.film) for grid, mask in pairs)


def fitted(basis: Sequence[BasisFunctions], fields: Sequence[Array]) -> Array:
    """Coefficients that fit the fields of all films. [m]."""
    return np.concatenate([own.fit(field) for own, field in zip(basis, fields, strict=True)])


def _loads(film: FaceFilm, changes: Array) -> Array:
    """Forces and moments of changes of the pressure, one column each. [N, N m]."""
    return np.array([film.grid.moments(c, film.boundary.mask.film) for c in changes]).T


def _of_each(one: Callable[[StackState], T], states: Sequence[StackState]) -> tuple[T, ...]:
    """Outcome of a function for every state, at the same time where their films are large."""
    return in_parallel(one, states, states[0].stack.cells)


def next_deformation(
    states: Sequence[StackState], used: Fields, low: float
) -> tuple[Fields, float]:
    """Deformation [m] under the pressures found, and its largest change over the gap [-].

    Parameters
    ----------
    states : sequence of StackState
        Solved films, one state per snapshot.
    used : list
        Deformation that they were solved with. [m]
    low : float
        Pressure under which nothing deforms. [Pa]
    """

    def one(state: StackState) -> list[Array]:
        return state.stack.compliance.distant(state.face_pressures(low), state.snapshot)

    change, found = 0.0, list(_of_each(one, states))
    for state, new, old in zip(states, found, used, strict=True):
        for film, a, b in zip(state.films, new, old, strict=True):
            floor = max(film.law.roughness, 1e-8)
            change = max(change, _largest(a, b, film.gap, film.boundary.mask.node, floor))
    return found, change


@njit(nogil=True)
def _largest(new: Array, old: Array, gap: Array, node: IntArray, floor: float) -> float:
    """Largest difference of two deformations over the gap where there is film. [-]."""
    found = 0.0
    for i in range(gap.shape[0]):
        for j in range(gap.shape[1]):
            if node[i, j] == FILM:
                found = max(found, abs(new[i, j] - old[i, j]) / max(gap[i, j], floor))
    return found


@final
class DeformationIteration:
    """Iteration of the distant deformation beside that of films and positions.

    Parameters
    ----------
    states : sequence of StackState
        Films before the step, one state per snapshot.
    angles : sequence of float
        Shaft angles of the snapshots. [rad]
    memory : int
        Former iterations from which the next is predicted. [-]
    fineness : Fineness, optional
        Basis functions whose response is taken along.
    kept : mapping of int to DeformationResponse
        Responses that served at phases of the tooth pitch.
    frequency : float
        Inverse of the length of the step, 0 if the deformation counts as steady. [1/s]
    """

    def __init__(
        self,
        states: Sequence[StackState],
        angles: Sequence[float],
        memory: int,
        fineness: Fineness | None,
        kept: Mapping[int, DeformationResponse],
        frequency: float,
    ) -> None:
        self.used: Fields = [list(s.distant) for s in states]
        """Deformation of the next films. [m]"""
        self.responses = {k: own for k, own in kept.items() if own.frequency == frequency}
        """Responses that serve the next steps, by the phase of the tooth pitch."""
        self._fineness, self._frequency = fineness, frequency
        self._phases: list[int] = []
        if fineness is not None:
            pitch = states[0].stack.balance.interfaces[0].face.period
            self._phases = [int(np.mod(a / pitch, 1.0) * fineness.phases) for a in angles]
        self._memory, self._mixing = memory, Mixing(memory)
        self._new = self.used
        self._missing: list[Array] = []
        self._bases: list[tuple[BasisFunctions, ...]] = []

    @property
    def _own(self) -> list[DeformationResponse]:
        """Responses of all snapshots; none if they are not predicted or not known yet."""
        if any(phase not in self.responses for phase in self._phases):
            return []
        return [self.responses[phase] for phase in self._phases]

    def take(self, states: Sequence[StackState], low: float) -> float:
        """Deformation under the pressures found, and its largest change over the gap. [-]."""
        self._new, change = next_deformation(states, self.used, low)
        if self._fineness is not None and not self._bases:
            self._bases = [basis_on(state, self._fineness) for state in states]
        return change

    def serving(
        self, jacobian: tuple[Array, Array] | None, age: int
    ) -> tuple[tuple[Array, Array] | None, int]:
        """Stiffness and damping to begin with, and the iterations that they have served."""
        if self._fineness is None:
            return jacobian, age
        return (mean_coefficients(self._own) if self._own else None), 0

    def renew(self, states: Sequence[StackState]) -> tuple[Array, Array]:
        """Stiffness and damping of the films, with the predicted deformation if there is one."""
        if self._fineness is None:
            return mean_coefficients(states)
        own = dict(zip(reversed(self._phases), reversed(states), strict=True))
        fineness = self._fineness

        def one(state: StackState) -> DeformationResponse:
            return response(state, fineness, self._frequency, _SERVING)

        self.responses |= zip(own, _of_each(one, list(own.values())), strict=True)
        return mean_coefficients(self._own)

    def pull(self) -> Array | float:
        """Film force that the deformation still missing will add. [N, N m]."""
        self._missing = []
        if not self._own:
            return 0.0
        for basis, used, new in zip(self._bases, self.used, self._new, strict=True):
            self._missing.append(fitted(basis, [b - a for a, b in zip(used, new, strict=True)]))
        pulls = [own.pull @ m for own, m in zip(self._own, self._missing, strict=True)]
        return np.asarray(np.mean(pulls, axis=0))

    def follow(self, states: Sequence[StackState], step: Array, rate: Array) -> Array:
        """Set the deformation to use next and return the step of the coordinates to take. [m, rad].

        Parameters
        ----------
        states : sequence of StackState
            Films that were solved last.
        step, rate : ndarray
            Step that balances forces and its change of the rates. [m, rad, m/s, rad/s]
        """
        if self._memory == 0:
            return np.asarray(step / overstep(states, step))
        new = self._new
        # what the deformation will ask for beyond this iteration, where the response tells it
        if self._own:
            pairs = zip(self._own, self._missing, strict=True)
            more = [own.fields(own.follow(m, step, rate) - m) for own, m in pairs]
            new = _sum(new, more)
        old, found = (np.concatenate([a.ravel() for s in w for a in s]) for w in (self.used, new))
        # the coordinates count as much as the deformation of all cells
        weight, here = states[0].stack.arms * np.sqrt(old.size), states[0].position
        residual = np.concatenate([found - old, weight * step])
        mixture = self._mixing.following(np.concatenate([old, weight * here]), residual)
        pieces = iter(np.split(mixture, np.cumsum([a.size for s in new for a in s])))
        new = [[next(pieces).reshape(a.shape) for a in s] for s in new]
        step = next(pieces) / weight - here
        # positions and deformation are shortened alike, so that they still belong together
        change = _sum(new, self.used, -1.0)
        part = 1.0 / overstep(states, step, change)
        self.used = _sum(self.used, change, part)
        return part * step

    def beside(
        self, slides: tuple[int, ...] | None, revised: tuple[int, ...] | None
    ) -> tuple[int, ...] | None:
        """Stick or slip of the bearings as revised; the memory of another is cleared."""
        if revised != slides:
            self._mixing = Mixing(self._memory)
        return revised


def _sum(fields: Fields, others: Fields, part: float = 1.0) -> Fields:
    """Fields with a part of others added, snapshot by snapshot and film by film."""
    pairs = zip(fields, others, strict=True)
    return [[a + part * b for a, b in zip(*pair, strict=True)] for pair in pairs]


def film_coefficients(
    states: Sequence[StackState], fineness: Fineness | None
) -> tuple[Array, Array]:
    """Stiffness and damping of films, with the predicted deformation if there is one."""
    if fineness is None:
        return mean_coefficients(states)
    return mean_coefficients(_of_each(lambda s: response(s, fineness, 0.0), states))


def overstep(states: Sequence[StackState], step: Array, openings: Fields | None = None) -> float:
    """Step over the longest that neither closes nor opens a gap by too much, one at least. [-].

    Parameters
    ----------
    states : sequence of StackState
        Solved films, one state per snapshot.
    step : ndarray
        Step of the coordinates. [m, rad]
    openings : list, optional
        What the step adds to the deformation of every snapshot and film. [m]
    """
    still, most = np.zeros_like(step), 1.0
    for n, state in enumerate(states):
        for k, film in enumerate(state.films):
            opening = 0.0 if openings is None else openings[n][k]
            motion = state.stack.film_face_motion(k, step, still).position
            most = max(most, film.overstep(motion, opening))
    return most
