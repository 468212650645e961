"""Micro-motions, chambers and flow paths of a machine, as tables over angles."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Literal, final

import numpy as np

from toothspace.core.types import Array, IntArray
from toothspace.model.path_category import PathCategory
from toothspace.numerics.periodic_table import PeriodicTable

PathKind = Literal["orifice", "parallel_gap", "curved_gap", "fitted_gap"]

PATH_CHANNELS: Mapping[PathKind, tuple[str, ...]] = {
    "orifice": ("area", "hydraulic_diameter"),
    "parallel_gap": ("height", "width", "length"),
    "curved_gap": ("height", "width", "relative_radius"),
    "fitted_gap": ("height", "width", "relative_radius"),
}
"""Channels of the geometry table of each kind of path. [m2, m] or [m, m, m]"""


@final
@dataclass(frozen=True)
class Motion:
    """One micro-motion q of a body: ``x``, ``y``, ``z`` [m] or ``rotation`` [rad].

    A rotation is what the body turns ahead of its kinematic angle. A motion is a degree of
    freedom with mass or inertia wherever something holds it: ``x`` and ``y`` of a body in a
    journal bearing, and every motion that changes the gap of a compliant contact. The motion
    that a rigid mesh ties follows from the others; all else stands still.
    """

    body: str
    axis: Literal["x", "y", "z", "rotation"]


@final
@dataclass(frozen=True)
class ChamberFamily:
    r"""Chambers that are copies of one another, shifted in angle.

    Notes
    -----
    .. math:: V = V_0(\theta) + \sum_k \frac{\partial V}{\partial q_k}(\theta)\, q_k
    """

    name: str
    """Label, for example ``drive_gear``."""
    angle_ratio: float
    """Growth of the table angle per shaft angle, positive. [-]"""
    phases: Array
    """Table angle of each chamber at shaft angle zero. Shape (count,). [rad]"""
    volume: PeriodicTable
    """Volume over the table angle. One channel. [m3]"""
    volume_by_motion: PeriodicTable
    """Derivative of the volume with respect to every micro-motion. It is also the generalised force
    of the chamber's pressure on that motion. [m3/m] or One channel per motion of the description.
    [m3/rad]
    """
    own: tuple[PeriodicTable, ...] = ()
    """Volume of each chamber where teeth differ, in place of the one that all share. [m3]"""

    @property
    def count(self) -> int:
        """Number of chambers."""
        return int(self.phases.size)


@final
@dataclass(frozen=True)
class FlowPath:
    """Paths of one kind that join pairs of nodes, with geometry over an angle."""

    name: str
    """Label, unique in the machine, for example ``tooth_tip_drive``."""
    category: PathCategory
    """What the ledger books it under, and what it does in the network."""
    kind: PathKind
    """``orifice``, ``parallel_gap``, ``curved_gap`` or ``fitted_gap``."""
    nodes_a: IntArray
    nodes_b: IntArray
    """Nodes at both ends; flow is counted from a to b. Shape (count,)."""
    angle_ratio: float
    """Growth of the table angle per shaft angle. [-]"""
    phases: Array
    """Table angle of each path at shaft angle zero. Shape (count,). [rad]"""
    geometry: PeriodicTable
    """Channels of :data:`PATH_CHANNELS`. A closed path has zero area or width."""
    height_by_motion: PeriodicTable | None = None
    """Derivative of the gap height with respect to every micro-motion. [-] or [m/rad]"""
    drag_speed: PeriodicTable | None = None
    """Mean speed of the walls towards b, relative to the throat, per shaft speed: drag flow from a
    to b is ``width * height * drag_speed * shaft_speed``. One channel. [m/rad]
    """
    shear_speed: PeriodicTable | None = None
    """Speed of one wall relative to the other per shaft speed, for viscous friction in the gap,
    booked under ``tip_shear``. One channel. [m/rad]
    """
    throat_speed: float = 0.0
    """Speed of the throat towards b per shaft speed, where volumes count to the casing as bodies
    move but to the body's own boundary at rest (tooth tips): that part of the gap which
    micro-motion opens is carried along, not dragged through. [m/rad]
    """
    drags_opening_only: bool = False
    """Whether walls drag fluid only through that part of the gap which micro-motion opens: the
    layers that fill the nominal gap are carried with the walls in the chambers' account.
    """
    multiplicity: float = 1.0
    """Equal paths in parallel, for example both faces. [-]"""
    end: float = 0.0
    """Face in which an opening lies where both differ: 1 at the end of the teeth that leads, -1 at
    the one that lags, 0 of others. [-]
    """
    partner_shift: int = 0
    """Shift of node b (within its family) each time the table angle passes a full period: tooth
    pairing of gears with unequal tooth counts.
    """
    worn_by: str | None = None
    """Body that cuts the gap deeper by running-in where it would touch the casing."""
    minimum_height: float = 0.0
    """Residual height that the gap keeps, level of the roughness. [m]"""
    viscosity_ratio: float = 1.0
    """Viscosity in the gap over that of the fluid at its ends. [-]"""
    own: tuple[PeriodicTable, ...] = ()
    """Geometry of each path where teeth differ, in place of the one that all share."""

    @property
    def count(self) -> int:
        """Number of paths."""
        return int(self.phases.size)

    def partners(self, shaft_angle: Array) -> IntArray:
        """Node b of each path at shaft angles [rad], shape (angles, paths)."""
        places = self.phases + self.angle_ratio * shaft_angle[:, None]
        turns = np.floor(places / self.geometry.period).astype(int)
        first, last = int(self.nodes_b.min()), int(self.nodes_b.max())
        shifted = self.nodes_b - first + turns * self.partner_shift
        return np.asarray(first + shifted % (last - first + 1))
