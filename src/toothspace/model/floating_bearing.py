"""Faces, films and floating bearings beside the gears: what the axial force balance needs.

Axial positions are positive from the solid towards the floating side.
"""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass
from typing import Literal, Protocol, final

from toothspace.closures.friction import SMOOTH_LAWS
from toothspace.core.keys import choice, number, quantity
from toothspace.model.film_faces import FilmFace

Side = Literal["floating", "solid"]

STICK = "stick"
"""Name of the set-valued friction of bearing and housing."""

FRICTION_LAWS = (STICK, *SMOOTH_LAWS)
"""Names of the laws of that friction."""


LoadSource = Literal[
    "constant",
    "high",
    "nose",
    "node",
    "journal_x",
    "journal_y",
    "contact",
    "contact_share",
    "thrust",
]
"""What a load follows: one, the pressure of the high-pressure area, of the nose or of a node above
the low pressure [Pa], a component of the force of the journal bearings on a body, the force of a
contact between turning bodies [N], its share of all contact forces [-], or that share of the axial
force with which a helix pushes the body [N]."""


@final
@dataclass(frozen=True)
class BodyLoad:
    """What a named load of an elastic body is."""

    body: str
    """Bearing ``floating`` or ``solid``, a part of one, or a turning body. Journal forces on a
    turning body are in its own frame, on a bearing in that of the machine.
    """
    load: str
    """Name of the load."""
    source: LoadSource
    """What it follows."""
    index: int = 0
    """Node of a pressure, turning body of a journal force, or contact. [-]"""
    factor: float = 1.0
    """Load over what it follows; of a constant or a share the load itself. [-], [1/m2] or [N]"""


class ElasticBodies(Protocol):
    """Definition of the elastic bodies of a machine, made when it is asked for."""

    def __call__(self) -> Mapping[str, object]:
        """Bearings ``floating`` and ``solid``, or their parts, and the turning bodies, by name."""
        ...  # pragma: no cover

    def loads(self, shaft_angle: float) -> tuple[BodyLoad, ...]:
        """What acts on them besides the films at a shaft angle [rad]; one name adds up."""
        ...  # pragma: no cover


@final
@dataclass(frozen=True)
class FilmInterface:
    """Film between one face of a turning body and a bearing."""

    name: str
    """Label, for example ``floating_drive_gear``."""
    body: str
    """Turning body."""
    side: Side
    """Which bearing it runs against."""
    face: FilmFace
    """Film, chambers and grooves before the bearing, about the axis of the body."""
    speed_ratio: float
    """Angular speed over shaft speed. [-]"""
    winkler_compliance: float = 0.0
    """Compliance of the Winkler foundation that stands for body and bearing: approach of the faces
    over the film pressure. [m/Pa]
    """
    body_angle: float = 0.0
    """Angle of the body's own frame at shaft angle zero. [rad]"""
    root_radius: float = 0.0
    """Where tooth spaces begin; zero for a face without any. [m]"""
    lead: float = 0.0
    """Shaft angle by which this end of a body that winds about its axis leads its middle. [rad]"""
    first_node: int = 0
    """Number of its first chamber among all pressures, where spaces that wind about the axis are
    more than one chamber: those of the middle stand first, then those of this end. [-]
    """
    part: str = ""
    """Elastic body of the part of the bearing beside it; empty where the bearing is whole."""

    @property
    def bearing(self) -> str:
        """Elastic body of the bearing that it runs against."""
        return self.part or self.side


@final
@dataclass(frozen=True)
class Patch:
    """Part of the back face of a bearing with one pressure."""

    area: float
    """Area. [m2]"""
    center: tuple[float, float]
    """Centroid. [m]"""

    @property
    def moments(self) -> tuple[float, float, float]:
        """Area and its first moments about x and y: lift and rotations of a unit pressure."""
        return _moments(self.area, self.center)


@final
@dataclass(frozen=True)
class AxialForce:
    """Force along the axes that acts at a place."""

    size: float
    """Size. [N]"""
    place: tuple[float, float] = (0.0, 0.0)
    """Point of action. [m]"""

    @property
    def moments(self) -> tuple[float, float, float]:
        """Force [N] and its moments about x and y [N m]."""
        return _moments(self.size, self.place)


def _moments(size: float, place: tuple[float, float]) -> tuple[float, float, float]:
    """Lift and rotations about x and y that act at a place."""
    x, y = place
    return size, size * y, -size * x


@final
@dataclass(frozen=True)
class HousingContact:
    """``housing_contact``: friction between floating bearing and housing."""

    area: float = quantity("mm^2", "Contact area.", low=0, high=1e6, default=0.0)
    """Outer area of the bearing that low pressure acts on, opposite to high pressure. [m2]"""
    friction_coefficient: float = number("Coulomb friction.", low=0, high=1, default=0.0)
    """Coulomb friction. [-]"""
    breakaway_speed: float = quantity(
        "mm/s", "Speed of the friction peak.", above=0, high=1e4, default=6.45e-3
    )
    """Speed of the friction peak. [m/s]"""
    law: str = choice("Set-valued stick, or smooth.", *FRICTION_LAWS, default=STICK)
    """Set-valued ``stick``, or one of :data:`toothspace.closures.friction.SMOOTH_LAWS`."""


@final
@dataclass(frozen=True)
class FloatingBearing:
    """Bearing block or plate that pressure on its back presses towards the gears."""

    mass: float
    """Mass. [kg]"""
    face: Patch
    """Whole face: outline less the bores."""
    high_pressure: Patch
    """Part of the back face at high pressure."""
    nose: Patch
    """Part of the back face with a pressure of its own."""
    preload: AxialForce
    """Springs and seal together, positive towards the gears."""
    housing: HousingContact
    """Friction in the housing."""
    gauge_point: tuple[float, float]
    """Where the position is measured. [m]"""
    axial_play: float
    """Travel away from the gears until the bearing meets its cover. [m]"""
    wall_stiffness: float = 0.0
    """Moment about y over the tilt about it, by the wall that the bearing leans on. [N m/rad]"""


@final
@dataclass(frozen=True)
class LateralBalance:
    """Interfaces and floating bearings of a machine."""

    arrangement: Literal["symmetric", "asymmetric", "plates", "fixed"]
    """Floating bearings on both sides, on the floating side only, plates on both sides, or covers
    that rest with the turning bodies free between them.
    """
    motion: Literal["full", "axial"]
    """Whether bearings and bodies tilt."""
    interfaces: tuple[FilmInterface, ...]
    """Films of both sides, the floating one first; the search for balance begins at its gap."""
    floating: FloatingBearing
    """The floating bearing, or each of both; of covers that rest the one on the floating side."""
    high_node: int
    low_node: int
    """Nodes of the high-pressure port and of the low pressure behind the bearing."""
    body_forces: tuple[AxialForce, ...]
    """Force on every turning body that is given, along z, its place from the axis of the body. That
    of a helix comes from a run and acts there, too.
    """
    body_masses: tuple[float, ...]
    """Masses of the turning bodies. [kg]"""
    elastic_bodies: ElasticBodies | None = None
    """Elastic bodies of the machine, where bearings and turning bodies can deform."""
    halves: tuple[FloatingBearing, ...] = ()
    """Parts of the floating bearing, one beside every turning body, where it is split; they move
    and tilt on their own. Empty where it is not split.
    """
    body_tilts: tuple[float, ...] = ()
    """Largest tilt of every turning body in its journal bearings. Empty: any. [rad]"""
    shaft_stiffness: float | None = 0.0
    """Moment over tilt by which the journal bearings hold every turning body; None: by the films
    that carry its load. [N m/rad]
    """

    @property
    def bodies(self) -> tuple[str, ...]:
        """Turning bodies in the order of the interfaces."""
        return tuple(dict.fromkeys(i.body for i in self.interfaces))

    def thrust(self, bodies: Collection[str]) -> float:
        """Given axial force on turning bodies together, along z. [N]."""
        forces = zip(self.bodies, self.body_forces, strict=True)
        return sum(force.size for body, force in forces if body in bodies)
