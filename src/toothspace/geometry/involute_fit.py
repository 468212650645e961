"""Involute flanks in a given profile: base circle, tooth thickness, deviation."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from scipy.optimize import least_squares

from toothspace.core.types import Array
from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.involute import InvoluteGear, involute_function, tooth_form

_LARGEST_RESIDUAL = 0.01


@final
@dataclass(frozen=True)
class InvoluteFit:
    """Involute that lies closest to both flanks of a tooth.

    Parameters
    ----------
    base_radius : float
        Radius of the base circle. [m]
    base_half_angle : float
        Half of the tooth's angular thickness on the base circle. [rad]
    residual : float
        Root mean square of the normal distance over the fitted part. [m]
    """

    base_radius: float
    base_half_angle: float
    residual: float

    def pressure_angle(self, reference_radius: float) -> float:
        """Pressure angle of the flank at a radius of at least the base radius [rad]."""
        return float(np.arccos(self.base_radius / reference_radius))


@final
@dataclass(frozen=True)
class InvoluteDeviation:
    """Normal distance of both flanks of a profile from an ideal involute.

    Parameters
    ----------
    right_radius, left_radius : ndarray
        Distances of the compared points from the gear centre. [m]
    right, left : ndarray
        Deviation, positive for excess material. [m]
    """

    right_radius: Array
    right: Array
    left_radius: Array
    left: Array

    @property
    def largest(self) -> float:
        """Largest absolute deviation of both flanks [m]."""
        return float(max(np.abs(self.right).max(), np.abs(self.left).max()))

    @property
    def total_profile_deviation(self) -> float:
        """Larger of the two flanks' peak to peak deviations [m]."""
        return float(max(np.ptp(self.right), np.ptp(self.left)))


def fit_involute(points: Array, tip_start: int, tip_end: int) -> InvoluteFit | None:
    """Fit one involute to both flanks of a tooth that is centred on the x axis.

    Parameters
    ----------
    points : ndarray
        One pitch, shape (n, 2), as in ``GearProfile``. [m]
    tip_start, tip_end : int
        Ends of the tip land.

    Returns
    -------
    InvoluteFit or None
        Fit over 45 to 90 % of the tooth height; None where it leaves more than 1 % of the tooth
        height, so that the flank is no involute.
    """
    radius, angle, weight = _flank_samples(points, tip_start, tip_end)
    height = float(np.ptp(np.hypot(points[:, 0], points[:, 1])))
    if len(radius) < 8:
        return None

    def residuals(unknowns: Array) -> Array:
        base = min(unknowns[0], 0.9999) * radius.min()
        ideal = unknowns[1] - involute_function(np.arccos(base / radius))
        return weight * base * (angle - ideal) / height

    start = np.array([0.95, float(angle.mean()) + 0.05])
    solution = least_squares(residuals, start, xtol=1e-14, ftol=1e-14, gtol=1e-14)
    residual = float(np.sqrt(np.sum(solution.fun**2) / np.sum(weight**2))) * height
    if residual > _LARGEST_RESIDUAL * height or not 0.3 < solution.x[0] < 0.9999:
        return None
    return InvoluteFit(float(solution.x[0] * radius.min()), float(solution.x[1]), residual)


def involute_deviation(profile: GearProfile, reference: InvoluteGear) -> InvoluteDeviation:
    r"""Distance of a profile's flanks from the ideal involute, as a gear measuring machine gives.

    Parameters
    ----------
    profile : GearProfile
        Profile to judge, for example measured.
    reference : InvoluteGear
        Ideal gear with the same tooth count.

    Returns
    -------
    InvoluteDeviation
        Deviation along the flank normal between the ends of the ideal involute. [m]

    Notes
    -----
    At equal radius an angular difference :math:`\Delta\vartheta` is the normal distance
    :math:`r_b \Delta\vartheta`.
    """
    form = tooth_form(reference)
    right_radius, right = _deviation(profile.right_flank * (1.0, -1.0), reference)
    left_radius, left = _deviation(profile.left_flank, reference)
    keep_right = (right_radius >= form.form_radius) & (right_radius <= form.tip_form_radius)
    keep_left = (left_radius >= form.form_radius) & (left_radius <= form.tip_form_radius)
    return InvoluteDeviation(
        right_radius[keep_right], right[keep_right], left_radius[keep_left], left[keep_left]
    )


def deviation_from_best_involute(profile: GearProfile) -> InvoluteDeviation | None:
    """Distance of both flanks from the one involute that fits them best.

    Parameters
    ----------
    profile : GearProfile
        Profile to judge, for example measured.

    Returns
    -------
    InvoluteDeviation or None
        Deviation along the flank normal over 45 to 90 % of the tooth height [m]; None if the
        flanks are no involutes.
    """
    fit = fit_involute(profile.points, profile.tip_start, profile.tip_end)
    if fit is None:
        return None
    height = profile.tip_radius - profile.root_radius
    sides = []
    for flank in (profile.right_flank * (1.0, -1.0), profile.left_flank):
        radius = np.hypot(flank[:, 0], flank[:, 1])
        share = (radius - profile.root_radius) / height
        keep = (share >= 0.45) & (share <= 0.90) & (radius > fit.base_radius)
        angle = np.arctan2(flank[keep, 1], flank[keep, 0])
        roll = involute_function(np.arccos(fit.base_radius / radius[keep]))
        sides += [radius[keep], fit.base_radius * (angle - fit.base_half_angle + roll)]
    return InvoluteDeviation(*sides)


def _deviation(flank: Array, reference: InvoluteGear) -> tuple[Array, Array]:
    radius = np.hypot(flank[:, 0], flank[:, 1])
    angle = np.arctan2(flank[:, 1], flank[:, 0])
    ideal = reference.half_angle(np.maximum(radius, reference.base_radius))
    return radius, reference.base_radius * (angle - np.asarray(ideal))


def _flank_samples(points: Array, tip_start: int, tip_end: int) -> tuple[Array, Array, Array]:
    # every point counts with the part of the tooth height that it stands for
    radius = np.hypot(points[:, 0], points[:, 1])
    angle = np.abs(np.arctan2(points[:, 1], points[:, 0]))
    low, high = radius.min() + np.array([0.45, 0.90]) * np.ptp(radius)
    index = np.arange(len(points))
    flank = ((index < tip_start) | (index > tip_end)) & (radius > low) & (radius < high)
    share = np.abs(np.gradient(radius))
    return radius[flank], angle[flank], np.sqrt(share[flank] / share[flank].max(initial=1e-30))
