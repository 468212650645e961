"""Friction in the housing over the velocity of a floating bearing, for a study of it."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from toothspace.films.lateral.housing_friction import BREAKAWAY_RATIO, HousingFriction
from toothspace.model.lateral_balance import HousingContact

if TYPE_CHECKING:
    import xarray as xr

COEFFICIENT_FACTORS = (0.5, 1.0, 1.5, 2.0)
BREAKAWAY_SPEED_FACTORS = (0.25, 0.5, 1.0, 2.0)
_SPAN, _SAMPLES = 6.0, 481


def friction_curves(contact: HousingContact, breakaway_force: float) -> xr.Dataset:
    """Smooth friction law over velocity, with other coefficients and other breakaway speeds.

    Parameters
    ----------
    contact : HousingContact
        Coefficient and breakaway speed of the study.
    breakaway_force : float
        Breakaway force at the point with the largest one. [N]

    Returns
    -------
    xarray.Dataset
        Force [N] over ``friction_curve`` and ``bearing_velocity_mm_per_s``, and what the curves
        stand for; empty for a bearing without friction.

    References
    ----------
    .. [1] D. Thiagarajan, A. Vacca, S. Watkins, On the lubrication performance of external gear
       pumps for aerospace fuel delivery applications, Mech. Syst. Signal Process. 129 (2019)
       659-676, equation 15 and figure 14.
    """
    import xarray as xr

    if breakaway_force <= 0.0:
        return xr.Dataset()
    coulomb, speed = breakaway_force / BREAKAWAY_RATIO, contact.breakaway_speed
    velocity = np.linspace(-1.0, 1.0, _SAMPLES) * _SPAN * speed
    factors = [(f, 1.0) for f in COEFFICIENT_FACTORS]
    factors += [(1.0, f) for f in BREAKAWAY_SPEED_FACTORS]
    laws = [HousingFriction(coulomb * a, speed * b, holds=False) for a, b in factors]
    forces = [[law.force(float(v))[0] for v in velocity] for law in laws]
    varied = ["friction_coefficient"] * len(COEFFICIENT_FACTORS)
    varied += ["breakaway_speed"] * len(BREAKAWAY_SPEED_FACTORS)
    coefficients = [contact.friction_coefficient * a for a, _ in factors]
    speeds = [law.breakaway_speed * 1e3 for law in laws]
    return xr.Dataset(
        {
            "friction_curve_force_N": (
                ("friction_curve", "bearing_velocity_mm_per_s"), forces, {"units": "N"},
            ),
            "friction_curve_varied": ("friction_curve", varied),
            "friction_curve_coefficient": ("friction_curve", coefficients, {"units": "1"}),
            "friction_curve_breakaway_speed_mm_per_s": (
                "friction_curve", speeds, {"units": "mm/s"},
            ),
        },
        coords={
            "bearing_velocity_mm_per_s": (
                "bearing_velocity_mm_per_s", velocity * 1e3, {"units": "mm/s"},
            )
        },
    )  # fmt: skip
