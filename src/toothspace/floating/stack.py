"""Positions of bearings and gears, films between them, forces on them and stops that limit them."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple, Protocol, final

import numpy as np

from toothspace.core.types import Array, IntArray
from toothspace.floating.face_film import (
    FaceDeformation,
    FaceFilm,
    FaceMotion,
    FilmBoundary,
    FilmLaw,
    solve_face,
)
from toothspace.floating.face_grid import BasisFunctions, FaceGrid, Mask
from toothspace.model.floating_bearing import FilmInterface, FloatingBearing, LateralBalance, Side
from toothspace.numerics.parallel import in_parallel

_MOTIONS = 3
_THRUSTS = 8
"""Shaft angles of a pitch over which axial forces are averaged. [-]"""


class Compliance(Protocol):
    """Elastic approach of the faces under the pressures of all films."""

    @property
    def local(self) -> Sequence[float]:
        """Part of the approach that follows the pressure at the same place, by film. [m/Pa]."""
        ...  # pragma: no cover

    def distant(self, pressures: Sequence[Array], snapshot: Snapshot) -> list[Array]:
        """Distant deformation of every gap [m] under pressures above the low one. [Pa]."""
        ...  # pragma: no cover

    def gain(
        self, changes: Sequence[Array], snapshot: Snapshot, basis: Sequence[BasisFunctions]
    ) -> Array:
        """Coefficients of that part per change of pressure, film by film. [m/Pa]."""
        ...  # pragma: no cover


@final
@dataclass(frozen=True)
class WinklerFoundation:
    """Every point deforms under its own pressure alone; zero for rigid faces."""

    local: tuple[float, ...]
    """Approach over pressure of each interface. [m/Pa]"""

    def distant(self, pressures: Sequence[Array], snapshot: Snapshot) -> list[Array]:
        """Return none: all of the deformation is local. [m]."""
        return [np.zeros_like(p) for p in pressures]

    def gain(
        self, changes: Sequence[Array], snapshot: Snapshot, basis: Sequence[BasisFunctions]
    ) -> Array:
        """Return none: all of the deformation is local. [m/Pa]."""
        return np.zeros((sum(p.count for p in basis), sum(map(len, changes))))


class BackPressure(NamedTuple):
    """Pressures behind the floating bearing. [Pa]."""

    high: float
    low: float
    nose: float


class Snapshot(NamedTuple):
    """Masks and node pressures at one shaft angle."""

    shaft_angle: float  # [rad]
    masks: tuple[Mask, ...]  # one per interface
    node_pressure: Array  # [Pa]
    thrust: Array | None = None  # axial forces of a helix, by body [N]


class HoldingSpring(NamedTuple):
    """Spring that holds the mean lift of all floating bearings at a given value.

    It stands in for what else answers a lift, such as chambers that wider gaps drain.
    """

    opening: float  # [m]
    stiffness: float  # [N/m]


class PreviousStep(NamedTuple):
    """State of the films at the begin of a step, and its length."""

    state: StackState
    duration: float  # [s]


class MovingBearing(NamedTuple):
    """One floating bearing, or one of its parts that move on their own."""

    first: int  # first of its three coordinates
    side: Side
    sign: float  # sense in which its back is pushed, along z
    bearing: FloatingBearing
    bodies: tuple[str, ...]  # that it runs against
    thrust_to_cover: bool  # whether the teeth push these towards it, so that its cover holds all

    @property
    def play(self) -> float:
        """Travel from the gears up to its cover. [m]."""
        return 0.0 if self.thrust_to_cover else self.bearing.axial_play


@final
@dataclass(frozen=True, eq=False)
class Stack:
    """Bearings, gears and films of a machine.

    Notes
    -----
    Coordinates, three each (lift and rotations about x and y): floating bearing, gears, and the
    second floating bearing if there is one; then the drive gear stays where it is. Covers that
    rest stand in the place of a floating bearing that never moves. A bearing that
    is split has three for every part; between two split ones all gears stay where they are.
    Forces of the teeth that do not cancel push what is between two floating bearings to the cover
    of one of them, which carries them. Bearings turn about the x and y axes of the machine
    frame, gears about their own.
    """

    balance: LateralBalance
    """The machine's data."""
    grids: tuple[FaceGrid, ...]
    """One per interface."""
    laws: tuple[FilmLaw, ...]
    """One per interface."""
    compliance: Compliance
    """Elastic approach."""
    shaft_speed: float
    """Shaft speed. [rad/s]"""
    thrust: Callable[[float], Array] | None = None
    """Axial forces with which a helix pushes the turning bodies at a shaft angle; none with
    straight teeth. [N]
    """
    holding_spring: HoldingSpring | None = None
    """Spring on the mean lift of the floating bearings; none in a machine."""
    moving_bearings: tuple[MovingBearing, ...] = field(init=False, repr=False)
    _maps: tuple[tuple[Array, Array], ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        # floating bearings or their parts: before the bodies those of the floating side
        bodies = self.balance.bodies
        parts = self.balance.halves or (self.balance.floating,)
        beside = tuple((b,) for b in bodies) if self.balance.halves else (bodies,)
        sides: tuple[tuple[Side, float, int], ...] = (("floating", -1.0, 0),)
        if self.balance.arrangement in ("symmetric", "plates"):
            sides += (("solid", 1.0, len(parts) + len(bodies)),)
        object.__setattr__(
            self,
            "moving_bearings",
            tuple(
                MovingBearing(
                    _MOTIONS * (start + k),
                    side,
                    sign,
                    part,
                    beside[k],
                    len(sides) > 1 and sign * self._net_thrust(beside[k]) < 0.0,
                )
                for side, sign, start in sides
                for k, part in enumerate(parts)
            ),
        )
        object.__setattr__(self, "_maps", tuple(map(self._lift_maps, self.balance.interfaces)))

    @property
    def size(self) -> int:
        """Number of coordinates."""
        return _MOTIONS * (len(self.moving_bearings) + len(self.balance.bodies))

    @property
    def first_body(self) -> int:
        """First coordinate of the first turning body."""
        return _MOTIONS * max(len(self.balance.halves), 1)

    @property
    def two_floating(self) -> bool:
        """Whether there is a floating bearing on both sides."""
        return self.balance.arrangement in ("symmetric", "plates")

    @property
    def free(self) -> IntArray:
        """Coordinates that move."""
        axial = self.balance.motion == "axial"
        found = np.arange(0, self.size, _MOTIONS if axial else 1)
        if self.balance.arrangement == "fixed":
            references = [part.first for part in self.moving_bearings]
        else:
            groups = {part.bodies: 0 for part in self.moving_bearings} if self.two_floating else {}
            references = [self._body(own[0]) for own in groups if self._net_thrust(own) == 0.0]
        return found[~np.isin(found - found % _MOTIONS, references)]

    def _net_thrust(self, bodies: tuple[str, ...]) -> float:
        """Axial force that pushes bodies and all films beside them along z. [N].

        The pressures that push the flanks of a helix push the bearings as much the other way, at
        the end of the spaces that is the wider one. What is left are the contacts, which push one
        body against the other.
        """
        given = self.balance.thrust(bodies)
        if self.thrust is None or bodies == self.balance.bodies:
            return given
        period, every = self.balance.interfaces[0].face.period, self.balance.bodies
        angles = np.arange(_THRUSTS) * period / _THRUSTS
        first, second = np.mean([self.thrust(float(angle)) for angle in angles], axis=0)
        contact = 0.5 * float(first - second)
        return given + (contact if bodies == every[:1] else -contact)

    def _body(self, name: str) -> int:
        """First coordinate of a turning body."""
        return self.first_body + _MOTIONS * self.balance.bodies.index(name)

    @property
    def arms(self) -> Array:
        """Distance at which every coordinate counts as a lift: one for lifts. [-, m]."""
        reach = self.balance.interfaces[0].face.outer_radius
        return np.where(np.arange(self.size) % _MOTIONS == 0, 1.0, reach)

    @property
    def chains(self) -> list[Array]:
        """Matrices from the coordinates to lift [m] and tilts [rad] of every upper film face."""
        return [bearing + body for bearing, body in self._maps]

    @property
    def film_motions(self) -> tuple[int, ...]:
        """Motions of the film faces that occur."""
        return (0,) if self.balance.motion == "axial" else (0, 1, 2)

    def snapshot(self, shaft_angle: float, node_pressure: Array) -> Snapshot:
        """Masks at a shaft angle [rad] with the pressures of all nodes there. [Pa]."""
        own = [grid.interface for grid in self.grids]
        faces = [(i.body, i.face.face_map, i.lead, i.first_node) for i in own]
        first = dict(zip(reversed(faces), reversed(self.grids), strict=True))
        size = self.grids[0].area.size
        found = in_parallel(lambda face: first[face].mask(shaft_angle), first, size)
        masks = dict(zip(first, found, strict=True))
        thrust = None if self.thrust is None else self.thrust(shaft_angle)
        return Snapshot(shaft_angle, tuple(masks[face] for face in faces), node_pressure, thrust)

    def start(self, gap: float) -> Array:
        """Coordinates with one gap everywhere. [m]."""
        q = np.zeros(self.size)
        first = self.first_body
        q[:first:_MOTIONS] = self.play if self.balance.arrangement == "fixed" else 2.0 * gap
        q[first : first + _MOTIONS * len(self.balance.bodies) : _MOTIONS] = gap
        for held in self.moving_bearings:
            if held.thrust_to_cover:  # it begins on its cover
                beside = [part.first for part in self.moving_bearings if part.bodies == held.bodies]
                q[beside + [self._body(body) for body in held.bodies]] -= q[held.first]
        return q

    @property
    def play(self) -> float:
        """Gaps of both sides of a body together, as designed. [m]."""
        own = self.balance.bodies[0]
        return sum(i.face.gap for i in self.balance.interfaces if i.body == own)

    def gauge(self, q: Array) -> float:
        """Position of the floating bearing at its gauge point, away from the gears. [m]."""
        return float(self.positions(q)[0])

    def positions(self, q: Array) -> Array:
        """Positions of all floating bearings or parts at their gauge points, along z. [m]."""
        found = []
        for part in self.moving_bearings:
            (x, y), k = part.bearing.gauge_point, part.first
            found.append(float(q[k] + q[k + 1] * y - q[k + 2] * x))
        return np.array(found)

    @property
    def levers(self) -> list[Array]:
        """Row from the coordinates to the lift of the middle of every floating bearing. [m]."""
        tilts = self.balance.motion == "full"
        found = []
        for part in self.moving_bearings:
            x, y = part.bearing.face.center
            lever = np.zeros(self.size)
            lever[part.first : part.first + _MOTIONS] = 1.0, y * tilts, -x * tilts
            found.append(lever)
        return found

    @property
    def opening(self) -> Array:
        """Row from the coordinates to the mean lift of all floating bearings. [m]."""
        outwards = [-part.sign / len(self.moving_bearings) for part in self.moving_bearings]
        return np.asarray(outwards @ np.array(self.levers))

    def tilts(self, q: Array) -> list[float]:
        """Tilt of every floating bearing or part. [rad]."""
        return [
            float(np.hypot(q[part.first + 1], q[part.first + 2])) for part in self.moving_bearings
        ]

    def film_face_motion(self, index: int, q: Array, v: Array) -> FaceMotion:
        """Position and velocity of a film's upper face about the axis of its body."""
        chain = self.chains[index]
        return FaceMotion(chain @ q, chain @ v)

    def solve(
        self,
        snapshot: Snapshot,
        q: Array,
        v: Array,
        former: StackState | None,
        distant: Sequence[Array],
        previous: PreviousStep | None = None,
    ) -> StackState:
        """All films at positions and velocities, with given deformation by distant pressures.

        Without ``previous`` the faces count as steady.
        """
        low = float(snapshot.node_pressure[self.balance.low_node])

        def one(k: int) -> FaceFilm:
            boundary = FilmBoundary(
                snapshot.masks[k], snapshot.node_pressure, self.shaft_speed, low
            )
            start = former.films[k] if former is not None else None
            deformation = FaceDeformation(self.compliance.local[k], distant[k], distant[k])
            if previous is not None:
                before = previous.state.films[k].deformation
                deformation = deformation._replace(
                    previous=before, frequency=1.0 / previous.duration
                )
            here = self.film_face_motion(k, q, v)
            film = solve_face(self.grids[k], self.laws[k], boundary, here, deformation, start)
            _ = film.covered_load  # kept, and found here beside the other films
            return film

        films = in_parallel(one, range(len(self.grids)), self.grids[0].area.size)
        return StackState(self, snapshot, q, v, films, tuple(distant))

    def solve_all(
        self,
        snapshots: Sequence[Snapshot],
        q: Array,
        v: Array,
        former: Sequence[StackState],
        distant: Sequence[Sequence[Array]],
        previous: PreviousStep | None = None,
    ) -> tuple[StackState, ...]:
        """Films of all snapshots at one place, see :meth:`solve`."""

        def one(n: int) -> StackState:
            return self.solve(snapshots[n], q, v, former[n], distant[n], previous)

        return in_parallel(one, range(len(snapshots)), self.cells)

    @property
    def cells(self) -> int:
        """Cells of all films. [-]."""
        return sum(grid.area.size for grid in self.grids)

    def with_passes(self, passes: int) -> Stack:
        """Same stack whose films make at most so many passes at a time."""
        if passes == self.laws[0].accuracy.passes:
            return self
        laws = (law._replace(accuracy=law.accuracy._replace(passes=passes)) for law in self.laws)
        return replace(self, laws=tuple(laws))

    def _lift_maps(self, interface: FilmInterface) -> tuple[Array, Array]:
        """Upper face of a film from the coordinates: part of the bearing, part of the body."""
        x, y = interface.face.center
        about = np.array([[1.0, y, -x], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
        bearing, body = np.zeros((_MOTIONS, self.size)), np.zeros((_MOTIONS, self.size))
        first = self._body(interface.body)
        sign = 1.0 if interface.side == "floating" else -1.0
        body[:, first : first + _MOTIONS] = -sign * np.eye(_MOTIONS)
        for part in self.moving_bearings:
            if part.side == interface.side and interface.body in part.bodies:
                bearing[:, part.first : part.first + _MOTIONS] = sign * about
        return bearing, body


@final
@dataclass(frozen=True, eq=False)
class StackState:
    """Solved films of a stack at one shaft angle."""

    stack: Stack
    snapshot: Snapshot
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
        """Forces [N] and moments [N m] of films, asperities and tooth spaces on the coordinates."""
        force = np.zeros(self.stack.size)
        for film, (bearing, body) in zip(self.films, self.stack._maps, strict=True):
            force += (bearing + body).T @ film.covered_load + bearing.T @ film.open_load
        return force

    def back_force(self, back: BackPressure) -> Array:
        """Forces [N] and moments [N m] behind the floating bearings, of springs and teeth."""
        stack = self.stack
        force = np.zeros(stack.size)
        # the face as the films see it, so that equal pressure everywhere balances exactly
        for first, side, sign, bearing, bodies, _ in stack.moving_bearings:
            high, nose = (np.array(p.moments) for p in (bearing.high_pressure, bearing.nose))
            rest = self._face(side, bodies) - high - nose
            push = back.high * high + back.nose * nose + back.low * rest
            push += np.array(bearing.preload.moments)
            force[first : first + _MOTIONS] += sign * push
        beyond = self.snapshot.thrust
        for k, load in enumerate(stack.balance.body_forces):
            first, now = stack.first_body + _MOTIONS * k, load
            if beyond is not None:
                now = replace(load, size=load.size + float(beyond[k]))
            force[first : first + _MOTIONS] += now.moments
        return force

    @property
    def coefficients(self) -> tuple[Array, Array]:
        """Stiffness and damping of all films: minus the derivatives of the film force."""
        size = self.stack.size
        stiffness, damping = np.zeros((size, size)), np.zeros((size, size))
        for film, chain in zip(self.films, self.stack.chains, strict=True):
            k, d = film.coefficients(self.stack.film_motions)
            stiffness += chain.T @ k @ chain
            damping += chain.T @ d @ chain
        return stiffness, damping

    def face_pressures(self, low: float) -> list[Array]:
        """Pressures on the faces above the low pressure. [Pa]."""
        return [film.total - low for film in self.films]

    def smallest_gap(self) -> float:
        """Smallest gap under film. [m]."""
        return min(float(f.gap[f.boundary.mask.film].min()) for f in self.films)

    def mean_gaps(self) -> Array:
        """Mean gap of every film over its area. [m]."""
        found = []
        for f in self.films:
            area = np.where(f.boundary.mask.film, f.grid.area, 0.0)
            found.append(float((f.gap * area).sum() / area.sum()))
        return np.array(found)

    def hold_down(self, low: float) -> Array:
        """Force [N] and moments [N m] that press the solid bearing on its cover.

        The force is negative if the bearing lifts off; moments are about the x and y axes of the
        machine.
        """
        load = -low * self._face("solid", self.stack.balance.bodies)
        for film in self.films:
            if film.grid.interface.side == "solid":
                x, y = film.grid.interface.face.center
                force, about_x, about_y = film.covered_load + film.open_load
                load += np.array([force, about_x + y * force, about_y - x * force])
        return load

    def tipping_margin(self, low: float) -> float:
        """How far inside its rim the solid bearing is pressed, negative if it tips. [m]."""
        force, about_x, about_y = self.hold_down(low)
        if force <= 0.0:
            return -np.inf
        balance = self.stack.balance
        faces = [interface.face for interface in balance.interfaces]
        first, last = faces[0], faces[len(balance.bodies) - 1]
        # the rim is the edge of the belt round the bodies
        start = np.array(first.center)
        place, along = np.array([-about_y, about_x]) / force - start, np.array(last.center) - start
        share = np.clip(place @ along / max(float(along @ along), 1e-300), 0.0, 1.0)
        radius = min(first.outer_radius, last.outer_radius)
        return radius - float(np.linalg.norm(place - share * along))

    def _face(self, side: str, bodies: tuple[str, ...]) -> Array:
        found = np.zeros(_MOTIONS)
        for film in self.films:
            if film.grid.interface.side == side and film.grid.interface.body in bodies:
                found += film.grid.face_moments(film.boundary.mask.owned)
        return found


def mean_force(states: Sequence[StackState], back: BackPressure) -> Array:
    """Force of films and of the pressures behind the bearing, mean over snapshots. [N, N m]."""
    return np.mean([s.film_force() + s.back_force(back) for s in states], axis=0)


class HasCoefficients(Protocol):
    """Films that resist a motion of the coordinates."""

    @property
    def coefficients(self) -> tuple[Array, Array]:
        """Stiffness and damping."""
        ...  # pragma: no cover


def mean_coefficients(films: Sequence[HasCoefficients]) -> tuple[Array, Array]:
    """Stiffness and damping, means over snapshots."""
    pairs = [own.coefficients for own in films]
    return np.mean([k for k, _ in pairs], axis=0), np.mean([d for _, d in pairs], axis=0)


_STIFFNESS = 1e9
"""Stiffness of the cover at one place of the rim. [N/m]"""
_SHAFT_STIFFNESS = 1e6
"""Stiffness of a shaft that leans on the far ends of its journal bearings. [N m/rad]"""
_PLACES = 12
"""Places of the rim beside every body at which the cover may be met."""


def stop_forces(stack: Stack, q: Array) -> tuple[Array, Array]:
    """Forces of cover, wall and journal bearings on the coordinates, and their stiffness.

    Generalised forces [N, N m] and minus their derivatives with the coordinates.

    Parameters
    ----------
    q : ndarray
        Coordinates. [m, rad]

    Notes
    -----
    The cover is met where a place of the rim has travelled by the axial play, so that a bearing
    which films push off on one side leans on it. The wall of the housing holds the tilt about y.
    Turning bodies are held by their journal bearings, weakly until the clearance is used up.
    """
    force, stiffness = np.zeros(stack.size), np.zeros((stack.size, stack.size))
    for part in stack.moving_bearings:
        here = slice(part.first, part.first + 3)
        levers = rim_levers(stack, part)
        over = -part.sign * (levers @ q[here]) - part.play
        met = levers[over > 0.0]
        force[here] += part.sign * _STIFFNESS * (over[over > 0.0] @ met)
        stiffness[here, here] += _STIFFNESS * met.T @ met
        wall = part.bearing.wall_stiffness
        force[part.first + 2] -= wall * q[part.first + 2]
        stiffness[part.first + 2, part.first + 2] += wall
    if stack.holding_spring is not None:
        lever, spring = stack.opening, stack.holding_spring
        force += spring.stiffness * (spring.opening - float(lever @ q)) * lever
        stiffness += spring.stiffness * np.outer(lever, lever)
    held = stack.balance.shaft_stiffness or 0.0
    for tilts, most in _shafts(stack):
        # a shaft that is tilted by more than its bearings allow is pushed back
        tilt, moment, slope = q[tilts], np.zeros(2), np.zeros((2, 2))
        size = float(np.hypot(*tilt))
        beyond = size - most
        if beyond > 0.0:
            sense = np.outer(tilt, tilt) / size**2
            bend = sense + beyond / size * (np.eye(2) - sense)
            moment, slope = -_SHAFT_STIFFNESS * beyond / size * tilt, _SHAFT_STIFFNESS * bend
        force[tilts] += moment - held * q[tilts]
        stiffness[tilts, tilts] += slope + held * np.eye(2)
    return force, stiffness


def leaning(stack: Stack, q: Array) -> list[str]:
    """What leans on its cover or in its journal bearings at coordinates [m, rad], in words."""
    found = []
    for part in stack.moving_bearings:
        lift = -part.sign * (rim_levers(stack, part) @ q[part.first : part.first + 3])
        if lift.max() > part.bearing.axial_play:
            beside = "" if len(stack.moving_bearings) == 1 else f" ({part.side} side)"
            found.append(f"the floating bearing{beside} has lifted to its cover")
    for body, (tilts, most) in zip(stack.balance.bodies, _shafts(stack), strict=False):
        if np.hypot(*q[tilts]) > most:
            found.append(f"{body} has tilted by the clearance of its journal bearings")
    return found


def rim_levers(stack: Stack, part: MovingBearing) -> Array:
    """Rows from lift and tilts of a bearing to the lift of places on its rim. [-, m, m]."""
    own = [
        i.face for i in stack.balance.interfaces if i.side == part.side and i.body in part.bodies
    ]
    turn = 2.0 * np.pi * np.arange(_PLACES) / _PLACES
    x = np.concatenate([i.center[0] + i.outer_radius * np.cos(turn) for i in own])
    y = np.concatenate([i.center[1] + i.outer_radius * np.sin(turn) for i in own])
    return np.stack([np.ones_like(x), y, -x], axis=1)


def _shafts(stack: Stack) -> list[tuple[slice, float]]:
    """Rotations of every turning body, and how large they may be. [rad]."""
    count = len(stack.balance.bodies)
    most = stack.balance.body_tilts or (np.inf,) * count
    places = [stack.first_body + 3 * k for k in range(count)]
    return [(slice(p + 1, p + 3), m) for p, m in zip(places, most, strict=True)]
