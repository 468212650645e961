r"""Which teeth carry the contacts of a rotor pair, and over which part of the turn.

Gap and slip derivatives of a contact by the motions of its outer body tell where it is: with
the unit normal n, the lever :math:`\ell = (\mathbf r \times \mathbf n)_z` and
:math:`a = \mathbf r \cdot \mathbf n`, the place is
:math:`\mathbf r = a\,\mathbf n - \ell\,(-n_y, n_x)`.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np

from toothspace.core.errors import ToothspaceError
from toothspace.core.types import Array, IntArray
from toothspace.model.contact_pair import ContactPair
from toothspace.model.description import MachineDescription

if TYPE_CHECKING:
    import xarray as xr

LOADED_SHARE = 0.01
"""Share of the mean total contact force from which a tooth counts as loaded. [-]"""


@final
@dataclass(frozen=True)
class ToothContacts:
    """Contact forces of the teeth of a body."""

    force: Array
    """Sum of the forces of contacts that touch on each tooth. Shape (samples, teeth). [N]"""
    place: Array
    """Angle of each tooth from the largest pocket, in the sense of rotation. Shape (samples,
    teeth). [rad]
    """

    @property
    def mean_total(self) -> float:
        """Mean of the sum of all forces. [N]."""
        return float(np.mean(np.sum(self.force, axis=1)))

    @property
    def loaded(self) -> IntArray:
        """Number of loaded teeth at each sample. [-]."""
        return self.loaded_above(LOADED_SHARE)

    @property
    def span(self) -> float:
        """Part of its turn in which a tooth is loaded, in pitches. [-].

        One pitch is the span of single-contact theory: one tooth after the other.
        """
        return self.span_above(LOADED_SHARE)

    def loaded_above(self, share: float) -> IntArray:
        """Return how many teeth carry more than a share of the mean total force."""
        return np.asarray(np.count_nonzero(self.force > share * self.mean_total, axis=1))

    def span_above(self, share: float) -> float:
        """Return the span of contact at another share of the mean total force. [pitches]."""
        return float(np.mean(self.loaded_above(share)))


def tooth_contacts(data: xr.Dataset) -> ToothContacts:
    """Contacts of the teeth at the samples of a result.

    Raises ToothspaceError if the result has none.
    """
    if "tooth_force" not in data:
        machine, allowed = (
            data.attrs.get("machine", "unknown"),
            "allowed rotors, by lumped or films",
        )
        raise ToothspaceError(f"tooth_contacts: found a result of machine {machine}, {allowed}")
    return ToothContacts(np.asarray(data["tooth_force"]), np.asarray(data["tooth_place"]))


def contact_numbers(data: xr.Dataset) -> dict[str, float]:
    """Parts of the turn with two and with three teeth loaded, and the span of contact."""
    if "tooth_force" not in data:
        return {}
    found = tooth_contacts(data)
    return {
        "loaded_contacts_two_or_more": float(np.mean(found.loaded >= 2)),
        "loaded_contacts_three_or_more": float(np.mean(found.loaded >= 3)),
        "contact_span": found.span,
    }


def has_tooth_contacts(description: MachineDescription) -> bool:
    """Whether the outer body of the contacts turns freely, as the rotor of a gerotor does."""
    bodies = {contact.body_b for contact in description.contacts}
    return len(bodies) == 1 and description.mesh is None


def tooth_forces(
    angle: Array, contact_force: Array, contact_gap: Array, description: MachineDescription
) -> tuple[Array, Array]:
    """Assign the forces of contacts that touch to the teeth of the outer body.

    Oil that is squeezed out between lobes which come closer does not count.

    As in :class:`ToothContacts`. [N], [rad]

    Parameters
    ----------
    angle : ndarray
        Shaft angles. Shape (samples,). [rad]
    contact_force : ndarray
        Normal forces. Shape (samples, contacts). [N]
    contact_gap : ndarray
        Gaps; surfaces touch where asperities begin to carry. [m]
    description : MachineDescription
        Machine whose contacts have one outer body about the origin, with a tooth at plus y at
        shaft angle zero and as many teeth as its first family has chambers.
    """
    teeth = description.families[0].count
    body = description.bodies[description.body_index(description.contacts[0].body_b)]
    turned = body.speed_ratio * angle[:, None]
    place = turned + 2.0 * np.pi * np.arange(teeth) / teeth
    found = np.zeros((angle.size, teeth))
    column = 0
    for pair in description.contacts:
        reach = pair.roughness if pair.onset is None else pair.onset
        for phase in pair.phases:
            beyond = contact_azimuth(description, pair, angle, float(phase)) - turned[:, 0]
            tooth = np.mod(np.round(beyond * teeth / (2.0 * np.pi)), teeth).astype(int)
            touching = contact_gap[:, column] < reach
            found[np.arange(angle.size), tooth] += np.where(touching, contact_force[:, column], 0.0)
            column += 1
    return found, np.mod(place, 2.0 * np.pi)


def contact_azimuth(
    description: MachineDescription, pair: ContactPair, angle: Array, phase: float
) -> Array:
    """Angle of a contact about the centre of its outer body, from the y axis.

    Angle, counter-clockwise. [rad]

    Parameters
    ----------
    pair : ContactPair
        Contacts of one kind.
    angle : ndarray
        Shaft angles. [rad]
    phase : float
        Table angle of the contact at shaft angle zero. [rad]
    """
    x, y, rotation = (description.motion_index(pair.body_b, a) for a in ("x", "y", "rotation"))
    assert pair.slip_by_motion is not None
    own = phase + pair.angle_ratio * angle
    gap, slip = pair.gap_by_motion(own), pair.slip_by_motion(own)
    normal = gap[:, x] + 1j * gap[:, y]
    point = (slip[:, rotation] - 1j * gap[:, rotation]) * normal
    return np.asarray(np.angle(point / 1j), dtype=float)
