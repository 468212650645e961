"""Positions of bearings and gears, the films between them and the forces on them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, field, replace
from typing import NamedTuple, Protocol, TypeVar, final

import numpy as np

from toothspace.core.types import Array, IntArray
from toothspace.films.lateral_gap.face_film import (
    Approach,
    FaceFilm,
    FilmLaw,
    Place,
    Surroundings,
    solve_face,
)
from toothspace.films.lateral_gap.faces import FaceGrid, Mask
from toothspace.model.lateral_balance import FilmInterface, LateralBalance, Patch
from toothspace.numerics import multigrid

T = TypeVar("T")
_MOTIONS = 3
_THREADED_CELLS = 10_000
"""Cells of a film from which a thread of its own pays. [-]"""


class Compliance(Protocol):
    """Elastic approach of the faces under the pressures of all films."""

    @property
    def local(self) -> Sequence[float]:
        """Part of the approach that follows the pressure at the same place, by film. [m/Pa]."""
        ...  # pragma: no cover

    def distant(self, pressures: Sequence[Array], scene: Scene) -> list[Array]:
        """Rest of the widening of every gap [m] under pressures above the low one. [Pa]."""
        ...  # pragma: no cover


@final
@dataclass(frozen=True)
class Columns:
    """Every point gives way like a column under its own pressure; zero for rigid faces.

    Parameters
    ----------
    local : tuple of float
        Approach over pressure of each interface. [m/Pa]
    """

    local: tuple[float, ...]

    def distant(self, pressures: Sequence[Array], scene: Scene) -> list[Array]:
        """Return no further widening. [m]."""
        return [np.zeros_like(p) for p in pressures]


class BackPressure(NamedTuple):
    """Pressures behind the pressed bearing. [Pa]."""

    high: float
    low: float
    nose: float


class Scene(NamedTuple):
    """Masks and node pressures at one shaft angle."""

    shaft_angle: float  # [rad]
    masks: tuple[Mask, ...]  # one per interface
    node_pressure: Array  # [Pa]


@final
@dataclass(frozen=True, eq=False)
class Stack:
    """Bearings, gears and films of a machine.

    Parameters
    ----------
    balance : LateralBalance
        The machine's data.
    grids : tuple of FaceGrid
        One per interface.
    laws : tuple of FilmLaw
        One per interface.
    compliance : Compliance
        Elastic approach.
    shaft_speed : float
        Shaft speed. [rad/s]

    Notes
    -----
    Coordinates, three each (lift and rotations about x and y): pressed bearing, gears, and the
    second pressed bearing if there is one; then the drive gear stays where it is. Bearings turn
    about the x and y axes of the machine frame, gears about their own.
    """

    balance: LateralBalance
    grids: tuple[FaceGrid, ...]
    laws: tuple[FilmLaw, ...]
    compliance: Compliance
    shaft_speed: float
    _maps: tuple[tuple[Array, Array], ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_maps", tuple(map(self._lift_maps, self.balance.interfaces)))

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return _MOTIONS * (1 + len(self.balance.bodies) + int(self.two_pressed))

    @property
    def two_pressed(self) -> bool:
        """Whether a second bearing is pressed from the other side."""
        return self.balance.arrangement != "asymmetric"

    @property
    def free(self) -> IntArray:
        """Coordinates that move."""
        axial = self.balance.motion == "axial"
        found = np.arange(0, self.size, _MOTIONS if axial else 1)
        # nothing changes when all bodies move together, so the first gear is the reference
        first = (found >= _MOTIONS) & (found < 2 * _MOTIONS)
        return found[~first] if self.two_pressed else found

    @property
    def film_motions(self) -> tuple[int, ...]:
        """Motions of the film faces that occur."""
        return (0,) if self.balance.motion == "axial" else (0, 1, 2)

    def scene(self, shaft_angle: float, node_pressure: Array) -> Scene:
        """Masks at a shaft angle [rad] with the pressures of all nodes there. [Pa]."""
        masks: dict[str, Mask] = {}
        for grid in self.grids:
            if grid.interface.body not in masks:
                masks[grid.interface.body] = grid.mask(shaft_angle)
        return Scene(shaft_angle, tuple(masks[g.interface.body] for g in self.grids), node_pressure)

    def start(self, gap: float) -> Array:
        """Coordinates with one gap everywhere. [m]."""
        q = np.zeros(self.size)
        q[0] = 2.0 * gap
        bodies = len(self.balance.bodies)
        q[_MOTIONS : _MOTIONS * (1 + bodies) : _MOTIONS] = gap
        return q

    def gauge(self, q: Array) -> float:
        """Position of the pressed bearing at its gauge point, away from the gears. [m]."""
        x, y = self.balance.floating.gauge_point
        return float(q[0] + q[1] * y - q[2] * x)

    def film_place(self, index: int, q: Array, v: Array) -> Place:
        """Position and velocity of a film's upper face about the axis of its body."""
        bearing, body = self._maps[index]
        chain = bearing + body
        return Place(chain @ q, chain @ v)

    def solve(
        self, scene: Scene, q: Array, v: Array, former: StackState | None, distant: Sequence[Array]
    ) -> StackState:
        """All films at positions and velocities, with given widening by distant pressures."""
        low = float(scene.node_pressure[self.balance.low_node])

        def one(k: int) -> FaceFilm:
            around = Surroundings(scene.masks[k], scene.node_pressure, self.shaft_speed, low)
            start = former.films[k] if former is not None else None
            approach = Approach(self.compliance.local[k], distant[k])
            place = self.film_place(k, q, v)
            return solve_face(self.grids[k], self.laws[k], around, place, approach, start)

        return StackState(self, scene, q, v, self.side_by_side(one), tuple(distant))

    def with_passes(self, passes: int) -> Stack:
        """Same stack whose films make at most so many passes at a time."""
        if passes == self.laws[0].accuracy.passes:
            return self
        laws = (law._replace(accuracy=law.accuracy._replace(passes=passes)) for law in self.laws)
        return replace(self, laws=tuple(laws))

    def side_by_side(self, one: Callable[[int], T]) -> tuple[T, ...]:
        """Outcome of a function for every film; large films are worked on at the same time."""
        films = range(len(self.grids))
        if multigrid.THREADS < 2 or self.grids[0].area.size < _THREADED_CELLS:
            return tuple(map(one, films))
        with ThreadPoolExecutor(multigrid.THREADS) as pool:
            return tuple(pool.map(one, films))

    def _lift_maps(self, interface: FilmInterface) -> tuple[Array, Array]:
        """Upper face of a film from the coordinates: part of the bearing, part of the body."""
        x, y = interface.center
        about = np.array([[1.0, y, -x], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        bearing, body = np.zeros((_MOTIONS, self.size)), np.zeros((_MOTIONS, self.size))
        first = _MOTIONS * (1 + self.balance.bodies.index(interface.body))
        sign = 1.0 if interface.side == "floating" else -1.0
        body[:, first : first + _MOTIONS] = -sign * np.eye(_MOTIONS)
        if interface.side == "floating":
            bearing[:, :_MOTIONS] = about
        elif self.two_pressed:
            bearing[:, -_MOTIONS:] = -about
        return bearing, body


@final
@dataclass(frozen=True, eq=False)
class StackState:
    """Solved films of a stack at one shaft angle."""

    stack: Stack
    scene: Scene
    position: Array
    velocity: Array
    films: tuple[FaceFilm, ...]
    distant: tuple[Array, ...]

    @property
    def converged(self) -> bool:
        """Whether all films settled."""
        return all(film.plane.status.succeeded for film in self.films)

    @property
    def change(self) -> float:
        """Largest change of a gap by the last pass of its film over the gap. [-]."""
        return max(film.solution.change for film in self.films)

    def film_force(self) -> Array:
        """Generalised forces of films, asperities and tooth spaces on the coordinates."""
        force = np.zeros(self.stack.size)
        for film, (bearing, body) in zip(self.films, self.stack._maps, strict=True):
            force += (bearing + body).T @ film.covered_load() + bearing.T @ film.open_load()
        return force

    def back_force(self, back: BackPressure) -> Array:
        """Generalised forces behind the pressed bearings, springs and tooth forces."""
        stack, bearing = self.stack, self.stack.balance.floating
        force = np.zeros(stack.size)
        # the face as the films see it, so that equal pressure everywhere balances exactly
        for side, first, sign in (("floating", 0, -1.0), ("solid", stack.size - _MOTIONS, 1.0)):
            if side == "solid" and not stack.two_pressed:
                continue
            high, nose = (np.array(p.moments) for p in (bearing.high_pressure, bearing.nose))
            rest = self._face(side) - high - nose
            push = back.high * high + back.nose * nose + back.low * rest
            push += np.array(Patch(bearing.preload, bearing.preload_center).moments)
            force[first : first + _MOTIONS] += sign * push
        for k, load in enumerate(stack.balance.body_forces):
            force[_MOTIONS * (1 + k)] += load
        return force

    def coefficients(self) -> tuple[Array, Array]:
        """Stiffness and damping of all films: minus the derivatives of the film force."""
        size = self.stack.size
        stiffness, damping = np.zeros((size, size)), np.zeros((size, size))
        for film, (bearing, body) in zip(self.films, self.stack._maps, strict=True):
            chain = bearing + body
            k, d = film.coefficients(self.stack.film_motions)
            stiffness += chain.T @ k @ chain
            damping += chain.T @ d @ chain
        return stiffness, damping

    def face_pressures(self, low: float) -> list[Array]:
        """Pressures on the faces above the low pressure. [Pa]."""
        return [film.total - low for film in self.films]

    def smallest_gap(self) -> float:
        """Smallest gap under film. [m]."""
        return min(float(f.gap[f.around.mask.film].min()) for f in self.films)

    def mean_gaps(self) -> Array:
        """Mean gap of every film over its area. [m]."""
        found = []
        for f in self.films:
            area = np.where(f.around.mask.film, f.grid.area, 0.0)
            found.append(float((f.gap * area).sum() / area.sum()))
        return np.array(found)

    def solid_seat_force(self, low: float) -> float:
        """Force that holds the solid bearing on its cover, negative if it lifts off. [N]."""
        load = 0.0
        for film in self.films:
            if film.grid.interface.side == "solid":
                load += float(film.covered_load()[0] + film.open_load()[0])
        return load - low * float(self._face("solid")[0])

    def _face(self, side: str) -> Array:
        found = np.zeros(_MOTIONS)
        for film in self.films:
            if film.grid.interface.side == side:
                found += film.grid.face_moments(film.around.mask.cells.owned)
        return found
