"""What solving the films of a machine on grids needs, and gives back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Protocol, final

from toothspace.core.types import Array, IntArray


@final
@dataclass(frozen=True, eq=False)
class SolvedJournal:
    """What a solved Reynolds equation puts in place of the closed form of a journal bearing.

    Parameters
    ----------
    force_nodes : ndarray
        Nodes of a :class:`~toothspace.closures.bearing_map.JournalMap`. [-]
    shear : ndarray, shape (n,)
        Viscous shear over that of the closed form, at eccentricity ratios from 0 to
        ``shear_range`` in equal steps. [-]
    shear_range : float
        Last eccentricity ratio; beyond it the last value holds. [-]
    """

    force_nodes: Array
    shear: Array
    shear_range: float = 1.0


@final
@dataclass(frozen=True, eq=False)
class FaceOutline:
    """Shape of the film on one face of a body, for solving it on a grid.

    Parameters
    ----------
    polygon : ndarray, shape (n, 2)
        Outline of the body at shaft angle zero. [m]
    center : tuple of float
        Its axis. [m]
    zero_angle : float
        Polar angle of the table angle zero. [rad]
    direction : float
        1 if table angles grow from x towards y, else -1. [-]
    nodes : ndarray of int
        Chambers between the teeth.
    phases : ndarray
        Table angles of the chambers at shaft angle zero; they grow along the rotation. [rad]
    recesses : tuple of (int, ndarray)
        Deep recesses of the opposite face: node that feeds them, and outline. [m]
    """

    polygon: Array
    center: tuple[float, float]
    zero_angle: float
    direction: float
    nodes: IntArray
    phases: Array
    recesses: tuple[tuple[int, Array], ...] = ()


BARE = -1
"""Node of points that no chamber, recess or rim covers, and body of points that none covers."""


class SharedFaceMap(Protocol):
    """What stands before a cover that several bodies share, over the shaft angle."""

    def __call__(self, shaft_angle: float, x: Array, y: Array) -> tuple[IntArray, IntArray]:
        """Nodes and bodies at a shaft angle [rad] and points of the machine frame [m].

        Node of the chamber or recess there or BARE; number of the body there or BARE. Where
        there is a body and no node, there is film.
        """
        ...  # pragma: no cover


@final
@dataclass(frozen=True, eq=False)
class Cover:
    """One of the plane walls beside bodies that share it.

    Parameters
    ----------
    gap : float
        Height of the films. [m]
    face_map : SharedFaceMap
        Chambers, recesses and bodies before it.
    """

    gap: float
    face_map: SharedFaceMap


@final
@dataclass(frozen=True)
class FaceRoughness:
    """Rough faces of bodies that find their own place between two covers.

    Parameters
    ----------
    roughness : float
        Combined root mean square roughness of body and cover. [m]
    correlation_length : float
        Its half-height correlation length. [m]
    effective_modulus : float
        E' = 2 / [(1 - nu1^2)/E1 + (1 - nu2^2)/E2]. [Pa]
    hardness : float
        Hardness of the softer face. [Pa]
    """

    roughness: float
    correlation_length: float
    effective_modulus: float
    hardness: float


@final
@dataclass(frozen=True)
class RimFilm:
    """Film between the rim of a turning body and the bore that carries it.

    Parameters
    ----------
    body : str
        The body, about the origin of the machine.
    radius, length, clearance : float
        Radius and width of the rim, radial clearance in the bore. [m]
    roughness : float
        Combined root mean square roughness. [m]
    open_ends : bool
        Whether fluid leaves at the axial ends to the inner node; else walls close them and the
        films of the faces lead into it.
    chamber : int
        Last of the chambers: the film in closed form.
    sectors : int
        Parts of the solved film on one pitch of the chambers.
    """

    body: str
    radius: float
    length: float
    clearance: float
    roughness: float
    open_ends: bool
    chamber: int
    sectors: int


@final
@dataclass(frozen=True, eq=False)
class SharedFaces:
    """Films between several bodies and the covers that these share, and at the outer rim.

    Parameters
    ----------
    covers : tuple of Cover
        Covers on both sides.
    bodies : tuple of str
        Bodies in the numbers of the map.
    inner_radius : float
        Inner rim of the films about the origin of the machine. [m]
    rim : RimFilm
        Film at the outer rim.
    chambers : ndarray of int
        Chambers between the bodies; each takes the place of the next in turn.
    phases : ndarray
        Table angles of the chambers at shaft angle zero. [rad]
    angle_ratio : float
        Growth of the table angle per shaft angle. [-]
    zero_angle : float
        Polar angle of the table angle zero. [rad]
    recesses : ndarray of int
        Nodes that feed recesses of the covers.
    inner_node : int
        Node beyond the inner rim.
    replaced : tuple of str
        Flow paths of the machine that stand for these films in closed form.
    floating : FaceRoughness or None
        Bodies stand where films and asperities of both sides hold their balance; None: where
        the gaps of the covers put them.
    """

    covers: tuple[Cover, ...]
    bodies: tuple[str, ...]
    inner_radius: float
    rim: RimFilm
    chambers: IntArray
    phases: Array
    angle_ratio: float
    zero_angle: float
    recesses: IntArray
    inner_node: int
    replaced: tuple[str, ...]
    floating: FaceRoughness | None = None
