"""What solving the films of a machine on grids needs, and gives back."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

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
