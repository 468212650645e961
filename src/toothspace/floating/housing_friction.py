r"""Friction of a floating bearing in its housing.

The set-valued law holds any load up to the breakaway force at rest and resists motion with the
Coulomb force. The smooth ones, :data:`toothspace.closures.friction.SMOOTH_LAWS`, vanish at rest, so
a bearing under load creeps.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.closures.friction import SMOOTH_LAWS
from toothspace.core.types import Array
from toothspace.model.floating_bearing import STICK, HousingContact

BREAKAWAY_RATIO = 2.5
"""Breakaway over Coulomb force. [-]"""


@final
@dataclass(frozen=True)
class HousingFriction:
    """Friction law with the forces of an operating point.

    References
    ----------
    .. [1] D. Thiagarajan, A. Vacca, S. Watkins, On the lubrication performance of external gear
       pumps for aerospace fuel delivery applications, Mech. Syst. Signal Process. 129 (2019)
       659-676, equations 15 and 16 and table 2.
    """

    coulomb_force: float
    """Friction force in motion. [N]"""
    breakaway_speed: float
    """Speed of the friction peak. [m/s]"""
    law: str
    """Set-valued ``stick``, or a smooth one."""

    @property
    def holds(self) -> bool:
        """Whether the bearing can stick under load."""
        return self.law == STICK

    @property
    def breakaway_force(self) -> float:
        """Largest force that friction holds at rest. [N]."""
        return BREAKAWAY_RATIO * self.coulomb_force

    def force(self, velocity: float) -> tuple[float, float]:
        """Force of a smooth law against the motion and its derivative. [N, N s/m].

        Parameters
        ----------
        velocity : float
            Velocity of the bearing. [m/s]
        """
        if self.coulomb_force == 0.0:
            return 0.0, 0.0
        force, slope = SMOOTH_LAWS[self.law](
            velocity, self.breakaway_force, self.coulomb_force, self.breakaway_speed
        )
        return float(force), float(slope)


def normal_force(
    contact: HousingContact, pressure_difference: float, journal_force: Array
) -> float:
    """Force that presses the bearing against the low-pressure wall of its housing. [N].

    Parameters
    ----------
    contact : HousingContact
        Area of the outer face between high and low pressure.
    pressure_difference : float
        High less low pressure. [Pa]
    journal_force : ndarray, shape (2,)
        Force of the shafts on the bearing, in the plane of the gears; the low-pressure side
        is at negative x. [N]

    Notes
    -----
    The magnitude of the vector sum, where the publication adds magnitudes.
    """
    wall = np.array([-pressure_difference * contact.area, 0.0])
    return float(np.hypot(*(wall + journal_force)))


def housing_friction(contact: HousingContact, normal: float) -> HousingFriction:
    """Friction law of a contact under a normal force. [N]."""
    coulomb = contact.friction_coefficient * normal
    return HousingFriction(coulomb, contact.breakaway_speed, contact.law)
