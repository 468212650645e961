"""Module, pressure angle, profile shift and tip rounding that a tooth profile was made with."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.geometry.gear_profile import GearProfile, InvoluteFlank
from toothspace.geometry.involute import involute_function
from toothspace.numerics.roots import root_between

_ANGLES = np.deg2rad([20.0, 14.5, 25.0, 15.0, 22.5, 17.5, 28.0, 30.0, 24.0, 18.0, 16.0])
"""Usual pressure angles, the commonest first. [rad]"""
_MODULES = 1e-3 * np.array([0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.125, 1.25, 1.375, 1.5, 1.75,
                            2.0, 2.25, 2.5, 2.75, 3.0, 3.25, 3.5, 3.75, 4.0, 4.5, 5.0, 5.5, 6.0,
                            6.5, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 14.0, 16.0, 18.0, 20.0, 22.0,
                            25.0])  # fmt: skip
"""ISO 54 with the quarter steps in use. [m]"""
_PITCHES = np.concatenate([np.arange(1.0, 6.0, 0.25), np.arange(6.0, 21.0), np.arange(22.0, 66, 2)])
"""Diametral pitches in use. [1/in]"""
_INCH = 25.4e-3
_MATCH = 3e-4


@final
@dataclass(frozen=True)
class GearData:
    """What a drawing of a gear gives."""

    tooth_count: int
    """Number of teeth."""
    module: float
    """Transverse module. [m]"""
    pressure_angle: float
    """Transverse pressure angle at the reference circle. [rad]"""
    profile_shift: float
    """Shift that gives the tooth thickness found, thinning included. [module]"""
    tip_rounding: float
    """Radius of an arc between involute and tip circle, 0 for a sharp corner. [m]"""
    standard: bool
    """Whether module or diametral pitch is one in use; else the pressure angle is assumed to be 20
    deg.
    """

    @property
    def diametral_pitch(self) -> float:
        """Teeth per inch of the reference diameter. [1/in]."""
        return _INCH / self.module


def gear_data(profile: GearProfile) -> GearData | None:
    r"""Data of the gear behind a profile with involute flanks.

    Parameters
    ----------
    profile : GearProfile
        One tooth pitch.

    Returns
    -------
    GearData or None
        The data; None where the flanks are no involutes.

    Notes
    -----
    An involute profile holds the product :math:`m \cos\alpha = 2 r_b / z` only. Of the usual
    pressure angles the first is taken that gives a module of ISO 54 or a whole diametral pitch
    within 0.03 %. The profile shift follows from the tooth thickness,
    :math:`\vartheta_b = \pi/(2z) + 2 x \tan\alpha / z + \mathrm{inv}\,\alpha`.

    References
    ----------
    .. [1] ISO 54:1996, Cylindrical gears for general and heavy engineering: modules.
    .. [2] ISO 21771:2007, Gears: cylindrical involute gears and gear pairs, section 4.
    """
    flank = profile.involute
    if flank is None:
        return None
    product = 2.0 * flank.base_radius / profile.tooth_count
    known = np.concatenate([_MODULES, _INCH / _PITCHES])
    off = [np.min(np.abs(known / (product / np.cos(angle)) - 1.0)) for angle in _ANGLES]
    fitting = np.flatnonzero(np.array(off) < _MATCH)
    angle = float(_ANGLES[fitting[0] if fitting.size else 0])
    half = flank.base_half_angle - float(involute_function(angle))
    shift = 0.5 * (half * profile.tooth_count - 0.5 * np.pi) / np.tan(angle)
    return GearData(
        tooth_count=profile.tooth_count,
        module=float(product / np.cos(angle)),
        pressure_angle=angle,
        profile_shift=float(shift),
        tip_rounding=tip_rounding(flank, profile.tip_radius),
        standard=fitting.size > 0,
    )


def tip_rounding(flank: InvoluteFlank, tip_radius: float) -> float:
    """Radius of the arc that joins the end of an involute to the tip circle tangentially. [m]."""
    end = flank.roll_length(flank.tip_form_radius)

    def excess(radius: float) -> float:
        return flank.roll_length(tip_radius - radius) + radius - end

    largest = tip_radius - flank.base_radius
    if tip_radius - flank.tip_form_radius < 1e-5 * tip_radius or excess(0.0) <= 0.0:
        return 0.0
    steps = np.linspace(0.0, largest, 200)
    below = next((step for step in steps if excess(step) <= 0.0), None)
    return 0.0 if below is None else root_between(excess, 0.0, below)
