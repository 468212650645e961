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

from toothspace.core.types import Array, IntArray
from toothspace.model.contact_pair import ContactPair
from toothspace.model.description import MachineDescription

if TYPE_CHECKING:
    import xarray as xr

LOADED_SHARE = 0.01
"""Share of the mean total contact force from which a tooth counts as loaded. [-]"""


@final
@dataclass(frozen=True)
class ToothForces:
    """Contact forces of the teeth of a body."""

    force: Array
    """Sum of the contact forces on each tooth. Shape (samples, teeth). [N]"""
    place: Array
    """Angle of each tooth from the largest pocket, in the sense of rotation. Shape (samples,
    teeth). [rad]
    """

    @property
    def mean_total(self) -> float:
        """Mean of the sum of all forces. [N]."""
        return float(np.mean(np.sum(self.force, axis=1)))

    def loaded(self, share: float = LOADED_SHARE) -> IntArray:
        """Return how many teeth carry more than a share of the mean total force."""
        return np.asarray(np.count_nonzero(self.force > share * self.mean_total, axis=1))

    def span(self, share: float = LOADED_SHARE) -> float:
        """Return the part of its turn in which a tooth is loaded, in pitches. [-].

        One pitch is the span of single-contact theory: one tooth after the other.
        """
        return float(np.mean(self.loaded(share)))


def has_tooth_contacts(description: MachineDescription) -> bool:
    """Whether the outer body of the contacts turns freely, as the rotor of a gerotor does."""
    bodies = {contact.body_b for contact in description.contacts}
    return len(bodies) == 1 and description.mesh is None


def tooth_forces(data: xr.Dataset, description: MachineDescription) -> ToothForces:
    """Assign the contact forces of a result to the teeth of the outer body.

    Parameters
    ----------
    data : xarray.Dataset
        Result with ``contact_force``.
    description : MachineDescription
        Machine whose contacts have one outer body about the origin, with a tooth at plus y at
        shaft angle zero and as many teeth as its first family has chambers.
    """
    angle = np.asarray(data["shaft_angle"])
    force = np.asarray(data["contact_force"])
    teeth = description.families[0].count
    body = description.bodies[description.body_index(description.contacts[0].body_b)]
    turned = body.speed_ratio * angle[:, None]
    place = turned + 2.0 * np.pi * np.arange(teeth) / teeth
    found = np.zeros((angle.size, teeth))
    column = 0
    for pair in description.contacts:
        for phase in pair.phases:
            beyond = contact_azimuth(description, pair, angle, float(phase)) - turned[:, 0]
            tooth = np.mod(np.round(beyond * teeth / (2.0 * np.pi)), teeth).astype(int)
            found[np.arange(angle.size), tooth] += force[:, column]
            column += 1
    return ToothForces(found, np.mod(place, 2.0 * np.pi))


def contact_azimuth(
    description: MachineDescription, pair: ContactPair, angle: Array, phase: float
) -> Array:
    """Angle of a contact about the centre of its outer body, from the y axis.

    Parameters
    ----------
    pair : ContactPair
        Contacts of one kind.
    angle : ndarray
        Shaft angles. [rad]
    phase : float
        Table angle of the contact at shaft angle zero. [rad]

    Returns
    -------
    ndarray
        Angle, counter-clockwise. [rad]
    """
    x, y, rotation = (description.motion_index(pair.body_b, a) for a in ("x", "y", "rotation"))
    assert pair.slip_by_motion is not None
    own = phase + pair.angle_ratio * angle
    gap, slip = pair.gap_by_motion(own), pair.slip_by_motion(own)
    normal = gap[:, x] + 1j * gap[:, y]
    point = (slip[:, rotation] - 1j * gap[:, rotation]) * normal
    return np.asarray(np.angle(point / 1j), dtype=float)
