"""Contacts between bodies: compliant ones, and the rigid mesh that replaces them."""

from __future__ import annotations

import math
from dataclasses import dataclass
from typing import Literal, final

from toothspace.core.types import Array
from toothspace.numerics.periodic_table import PeriodicTable

CONTACT_CHANNELS = (
    "gap",
    "load_share",
    "radius_a",
    "radius_b",
    "sliding_speed",
    "rolling_speed_sum",
)
"""Channels of a contact table: [m], [-], [m], [m], [m/rad], [m/rad] (per shaft radian)."""


@final
@dataclass(frozen=True)
class ContactPair:
    r"""Contacts of one kind between two bodies over an angle.

    With a rigid mesh one pair carries its load by shares. Without, every contact of every
    pair is compliant: it pushes where its gap closes, and nothing else ties the bodies.

    Notes
    -----
    Compliant contact with overlap :math:`x = -g` and elastic energy U(x):

    .. math:: F = U'(x) \max\left(0, 1 + \tfrac34 (1 - c_r^2) \frac{\dot x}{v_0}\right),
        \qquad g = g_0(\theta) + \sum_k \frac{\partial g}{\partial q_k}(\theta) q_k
        + \tfrac12 \left(A u^2 + 2 B u \delta + C \delta^2\right) .

    The last term is that of finite displacements: curved surfaces that shift by u along each other
    and turn by :math:`\delta` touch at other places. A squeeze film adds
    :math:`c(g) L \max(0, \dot x)`.
    """

    name: str
    """Label, for example ``drive_flank``."""
    body_a: str
    body_b: str
    """Bodies in contact; the normal points from a to b."""
    angle_ratio: float
    """Growth of the table angle per shaft angle. [-]"""
    phases: Array
    """Table angle of each contact at shaft angle zero. Shape (count,). [rad]"""
    geometry: PeriodicTable
    """Channels of :data:`CONTACT_CHANNELS`; a negative radius is concave. The gap is that at zero
    micro-motion. Sliding is the speed of body b relative to body a along the tangent (normal turned
    by +90 degrees), signed, per shaft speed; ``load_share`` counts only in a rigid mesh. Where two
    surfaces face away, give the ``facing_gap`` or more.
    """
    gap_by_motion: PeriodicTable
    """Derivative of the gap; also the generalised direction of the contact force. One channel per
    motion. [-], [m/rad]
    """
    width: float
    """Length of the contact line. [m]"""
    effective_modulus: float
    """E' = 2 / [...] of the pair. [Pa]"""
    roughness: float
    """Combined root mean square roughness of the flanks. [m]"""
    boundary_friction: float = 0.10
    """Friction coefficient of touching asperities. [-]"""
    limiting_shear: float = 0.05
    """Limiting shear strength proportionality of the lubricant (gamma). [-]"""
    slip_by_motion: PeriodicTable | None = None
    """Derivative of the tangential displacement of body b relative to body a by every motion: with
    the tangent t for x and y of body b, minus t for those of body a, and for a rotation the
    distance of the contact from the body's centre along the normal, minus it for body a. Friction
    then acts on these motions; None: on the shaft only. [-], [m/rad]
    """
    gap_by_shift_and_turn: PeriodicTable | None = None
    """Second derivatives A, B, C of the gap by the tangential displacement u of body b relative to
    body a, by u and its relative rotation, and by that rotation twice, for a body a that does not
    turn but with the shaft; None: the gap is linear in the motions. [1/m], [-], [m]
    """
    law: Literal["hertz_line", "johnson", "pereira", "linear"] = "hertz_line"
    """Elastic law of a compliant contact: ``hertz_line`` (approach of points below the surface),
    ``johnson``, ``pereira`` (``hertz_line`` where radii inside each other differ by more than 10
    mm) or ``linear`` (``structure_stiffness`` alone).
    """
    structure_stiffness: float = math.inf
    """Stiffness of teeth and bodies behind the contact, in series. [N/m]"""
    depth: float = math.inf
    """Largest depth of the points of ``hertz_line``, size of the bodies. [m]"""
    onset: float | None = None
    """Overlap over which contact builds up, on both sides of touch; None: the roughness. [m]"""
    restitution: float = 0.8
    """Coefficient of restitution of an impact at ``approach_speed``. [-]"""
    approach_speed: float | None = 0.1
    """Speed of that impact; None: each impact at the speed at which its surfaces meet, so that the
    restitution holds for all. [m/s]
    """
    friction_account: Literal["mesh_friction", "contact_friction"] = "contact_friction"
    """Ledger entry of the friction: ``mesh_friction`` or ``contact_friction``."""
    squeeze_film: bool = False
    """Whether liquid between the surfaces resists their approach."""
    part: float = 1.0
    """Part of the face width of one contact, where lines of contact are cut in slices. [-]"""
    facing_gap: float = math.inf
    """Gap from which on the surfaces face away from each other and cannot touch. [m]"""
    own: tuple[PeriodicTable, ...] = ()
    """Geometry of each contact where teeth differ, in place of the one that all share."""

    @property
    def count(self) -> int:
        """Number of contacts."""
        return int(self.phases.size)


@final
@dataclass(frozen=True)
class RigidMesh:
    """Contact of rigid flanks that ties one rotation to the other motions."""

    contact: str
    """Name of the :class:`ContactPair` that carries the load."""
    motion: int
    """Index of the rotation that follows from contact."""
    coefficients: Array
    """``q[motion] = coefficients @ q`` of the other motions. One per motion. [1/m]"""
    lever: float
    """Derivative of the contact's gap with respect to that rotation, signed; its size is the base
    radius of the driven body. Contact force = -(torque on that body) / lever. [m]
    """
