"""Film faces: what stands before a plane wall beside turning bodies, over the shaft angle.

Every machine type describes its faces in these terms. The conductances of rigid films, a film
solved on its own and the films of floating bearings read the same description.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import Literal, NamedTuple, Protocol, final

import numpy as np

from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.model.machine_parts import ChamberFamily
from toothspace.numerics.periodic_table import PeriodicTable

FILM = -1
"""Node number of points where a film stands between a body and the wall."""
NO_BODY = -1
"""Body number of points before which no body stands."""

_FULL_TURN = 2.0 * np.pi


class FaceCells(NamedTuple):
    """What stands before points of a wall."""

    node: IntArray
    """Node of the chamber or recess whose pressure acts there, FILM where there is a film."""
    body: IntArray
    """Number of the body whose face stands there, NO_BODY where none does."""


class FaceMap(Protocol):
    """Bodies, chambers, recesses and films before a wall over the shaft angle."""

    def __call__(self, shaft_angle: float, x: Array, y: Array) -> FaceCells:
        """Classify points of the machine frame at a shaft angle [rad] and places [m]."""
        ...  # pragma: no cover


@final
@dataclass(frozen=True)
class FaceBody:
    """A turning body before the wall."""

    name: str
    """The body."""
    center: tuple[float, float]
    """Its axis. [m]"""
    outer_radius: float
    """Radius up to which it reaches. [m]"""
    inner_radius: float = 0.0
    """Radius from which on it reaches. [m]"""


@final
@dataclass(frozen=True, eq=False)
class ChamberRing:
    """Chambers that follow each other round an axis and turn with a body."""

    nodes: IntArray
    """Nodes of the chambers, evenly spaced."""
    phases: Array
    """Their table angles at shaft angle zero. [rad]"""
    angle_ratio: float = 1.0
    """Growth of the table angles per shaft angle. [-]"""
    zero_angle: float = 0.0
    """Polar angle of the table angle zero. [rad]"""
    direction: float = 1.0
    """1 if table angles grow from x towards y, else -1. [-]"""
    center: tuple[float, float] = (0.0, 0.0)
    """The axis. [m]"""

    @property
    def pitch(self) -> float:
        """Angle from one chamber to the next. [rad]."""
        return _FULL_TURN / self.nodes.size

    def nearest(self, shaft_angle: float, x: Array, y: Array) -> IntArray:
        """Number of the chamber in whose sector points of the machine frame lie."""
        polar = np.arctan2(y - self.center[1], x - self.center[0])
        table = self.direction * (polar - self.zero_angle) - self.angle_ratio * shaft_angle
        order = np.argsort(self.phases)
        place = np.rint((table - self.phases[order[0]]) / self.pitch).astype(np.int64)
        return np.asarray(order[np.mod(place, self.nodes.size)])


@final
@dataclass(frozen=True)
class FaceSurfaces:
    """Rough faces of bodies and wall."""

    moving_roughness: float
    resting_roughness: float
    """Root mean square roughness of bodies and wall. [m]"""
    effective_modulus: float
    """E' = 2 / [(1 - nu1^2)/E1 + (1 - nu2^2)/E2]. [Pa]"""
    hardness: float
    """Hardness of the softer face. [Pa]"""
    correlation_length: float = 15e-6
    """Half-height correlation length of the combined roughness. [m]"""
    boundary_friction: float = 0.1
    """Friction coefficient of touching asperities. [-]"""

    @property
    def roughness(self) -> float:
        """Combined root mean square roughness. [m]."""
        return float(np.hypot(self.moving_roughness, self.resting_roughness))


@final
@dataclass(frozen=True, eq=False)
class FilmFace:
    """Plane wall beside turning bodies, with the films between them."""

    bodies: tuple[FaceBody, ...]
    """Bodies in the numbers of the map."""
    center: tuple[float, float]
    """Axis about which the films are solved. [m]"""
    inner_radius: float
    outer_radius: float
    """Rims of the films about it. [m]"""
    gap: float
    """Film height as designed. [m]"""
    face_map: FaceMap
    """What stands before the wall."""
    chambers: ChamberRing
    """Chambers between the teeth."""
    recesses: IntArray
    """Nodes that feed deep recesses of the wall."""
    inner_node: int
    """Node within the inner rim."""
    sectors: int = 0
    """Parts of the outer rim on one pitch of the chambers, each with a pressure of its own; zero:
    no flow passes the outer rim.
    """
    surfaces: FaceSurfaces | None = None
    """Roughness and contact; None: smooth."""

    @property
    def period(self) -> float:
        """Shaft angle after which the face looks the same. [rad]."""
        return self.chambers.pitch / self.chambers.angle_ratio

    @property
    def sector_phases(self) -> Array:
        """Table angles of the middles of the rim's sectors at shaft angle zero. [rad]."""
        width = self.chambers.pitch / self.sectors
        own = (np.arange(self.sectors) - 0.5 * (self.sectors - 1)) * width
        return np.asarray((self.chambers.phases[:, None] + own).ravel())

    def places(self, angle: Array, radius: Array) -> tuple[Array, Array]:
        """Points of the machine frame at polar angles [rad] and radii about the axis. [m]."""
        x, y = self.center
        return x + np.outer(np.cos(angle), radius), y + np.outer(np.sin(angle), radius)

    def body_number(self, name: str) -> int:
        """Number of a body in the map."""
        return [body.name for body in self.bodies].index(name)

    def open_wall(self, body: int, cells: FaceCells, x: Array, y: Array) -> BoolArray:
        """Where no body stands and the wall counts with one: its outer circle is the nearest.

        Parameters
        ----------
        body : int
            The body.
        cells : FaceCells
            What stands before the points.
        x, y : ndarray
            Points of the machine frame. [m]
        """
        power = [
            (x - b.center[0]) ** 2 + (y - b.center[1]) ** 2 - b.outer_radius**2 for b in self.bodies
        ]
        nearest = np.logical_and.reduce([power[body] <= other for other in power])
        return np.asarray(nearest & (cells.body == NO_BODY))


@final
@dataclass(frozen=True, eq=False)
class FacePlaces:
    """Where bodies stand between two covers while the shaft turns."""

    bodies: tuple[str, ...]
    """The bodies."""
    places: PeriodicTable
    """Over the shaft angle, four columns for each body: displacement along z [m], rotations about x
    and y [rad], smallest film height at both covers [m].
    """
    warning: str = ""
    """Why the places are doubtful, in words; empty if they are not."""

    def at(self, shaft_angle: Array) -> Array:
        """Columns of all bodies at shaft angles [rad], shape (..., bodies, 4)."""
        found = self.places(shaft_angle)
        return found.reshape(*found.shape[:-1], len(self.bodies), -1)


@final
@dataclass(frozen=True)
class RimFilm:
    """Film between the rim of a turning body and the bore that carries it."""

    body: str
    """The body, about the origin of the machine."""
    radius: float
    length: float
    clearance: float
    """Radius and width of the rim, radial clearance in the bore. [m]"""
    roughness: float
    """Combined root mean square roughness. [m]"""
    open_ends: bool
    """Whether fluid leaves at the axial ends to the inner node; else walls close them and the films
    of the faces lead into it.
    """
    chamber: int
    """Last of the chambers: the film in closed form."""


@final
@dataclass(frozen=True)
class SharedFaces:
    """Two covers that several bodies share, and the film at their outer rim."""

    covers: tuple[FilmFace, ...]
    """Covers on both sides, the lower z first; alike but for gap, surfaces and what stands before
    them.
    """
    rim: RimFilm
    """Film at the outer rim."""
    families: tuple[ChamberFamily, ...]
    """Chambers of the machine without the part of that film which they feed in closed form."""
    replaced: tuple[str, ...]
    """Flow paths of the machine that stand for these films in closed form."""
    motion: Literal["none", "axial", "full"] = "none"
    """Whether bodies lift, or lift and tilt, to where films and asperities of both sides hold their
    balance; ``none``: they stand parallel where the gaps of the covers put them.
    """

    @property
    def face(self) -> FilmFace:
        """Chambers, rims and nodes that all covers share."""
        return self.covers[0]
