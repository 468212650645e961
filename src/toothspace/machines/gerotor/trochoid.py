r"""Trochoidal sets: circular lobes on the outer rotor, their envelope on the inner one.

With the outer rotor at rest but for its turn :math:`\varphi_2 = z_1 \sigma` and the inner one at
:math:`\varphi_1 = z_2 \sigma`, the centre of a lobe runs in the frame of the inner rotor on the
trochoid (complex notation)

.. math:: c(\sigma) = R\, e^{i (a_0 - \sigma)} + i\, e\, e^{-i z_2 \sigma},

and the inner profile is its inward parallel curve at the lobe radius.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array

_SAMPLES = 2000
_LEAST_LOBE = 1.05


@final
@dataclass(frozen=True)
class Trochoid:
    """Generating data of a trochoidal set."""

    tooth_count: int
    """Teeth of the inner rotor."""
    eccentricity: float
    """Distance of the centres. [m]"""
    generating_radius: float
    """Radius of the lobe centres. [m]"""
    lobe_radius: float
    """Radius of the outer rotor's lobes, without clearance. [m]"""

    @property
    def lobe_count(self) -> int:
        """Lobes of the outer rotor."""
        return self.tooth_count + 1

    @property
    def no_undercut_limit(self) -> float:
        """Largest lobe radius that the inner profile bears without undercut. [m]."""
        curvature = self.path_curvature(np.linspace(0.0, 2.0 * np.pi / self.tooth_count, _SAMPLES))
        return float(1.0 / curvature.max())

    @property
    def closure_limit(self) -> float:
        """Lobe radius at which neighbouring lobes touch. [m]."""
        return float(self.generating_radius * np.sin(np.pi / self.lobe_count))

    @property
    def floor_limit(self) -> float:
        """Lobe radius at which the cavity floor cuts into the part of a lobe that touches. [m]."""
        radius, e = self.generating_radius, self.eccentricity
        slope = np.sqrt(1.0 - (self.lobe_count * e / radius) ** 2)
        return float(2.0 * e * (e + radius) / (radius + 2.0 * e - radius * slope))

    @property
    def cavity_radius(self) -> float:
        """Radius of the outer rotor's cavity floor, which the inner tips touch. [m]."""
        return self.generating_radius - self.lobe_radius + 2.0 * self.eccentricity

    def check(self) -> None:
        """Refuse designs that cannot be built.

        Raises
        ------
        GeometryError
            For a generating radius inside the pitch circle, undercut, lobes that overlap, or lobes
            that end before the floor of the cavities.
        """
        e, pitch = self.eccentricity, self.lobe_count * self.eccentricity
        if self.generating_radius <= pitch:
            raise _found("generating_radius", self.generating_radius, "above", pitch)
        limit = min(self.no_undercut_limit, self.closure_limit, self.floor_limit)
        if self.lobe_radius >= limit:
            raise _found("lobe_radius", self.lobe_radius, "below", limit)
        # a smaller lobe does not reach the cavity floor, which the inner tips need
        if self.lobe_radius <= _LEAST_LOBE * e:
            raise _found("lobe_radius", self.lobe_radius, "above", _LEAST_LOBE * e)

    def center_path(self, sigma: Array) -> tuple[Array, Array, Array]:
        """Lobe centre in the inner rotor's frame and two derivatives, complex. [m]."""
        count, lobes = self.tooth_count, self.lobe_count
        start = -0.5 * np.pi + np.pi / lobes
        # at sigma zero the lobe stands half a pitch from the cavity on the negative y axis
        first = self.generating_radius * np.exp(1j * (start - sigma))
        second = 1j * self.eccentricity * np.exp(-1j * (count + 1) * sigma)
        return (first + second, -1j * first - 1j * lobes * second, -first - lobes**2 * second)

    def path_curvature(self, sigma: Array) -> Array:
        """Curvature of the trochoid, positive where convex. [1/m]."""
        _, rate, bend = self.center_path(sigma)
        return np.asarray(-np.imag(np.conj(rate) * bend) / np.abs(rate) ** 3, dtype=float)


def _found(key: str, value: float, relation: str, bound: float) -> GeometryError:
    return GeometryError(
        f"machine.rotors.{key}", f"{value * 1e3:.5g} mm", f"{relation} {bound * 1e3:.5g} mm"
    )


def inner_outline(design: Trochoid, points_per_tooth: int, offset: float) -> Array:
    """Outline of the inner rotor.

    Parameters
    ----------
    points_per_tooth : int
        Points on one tooth.
    offset : float
        What the profile is set back along its normal. [m]

    Returns
    -------
    ndarray, shape (n, 2)
        Closed counter-clockwise curve about the inner rotor's centre. [m]
    """
    sigma = -_even_sagitta(design, points_per_tooth, offset)
    center, rate, _ = design.center_path(sigma)
    # the path runs clockwise over sigma: its inward normal is on the right of the rate
    inward = -1j * rate / np.abs(rate)
    point = center + (design.lobe_radius + offset) * inward
    return np.column_stack([point.real, point.imag])


def _even_sagitta(design: Trochoid, points_per_tooth: int, offset: float) -> Array:
    # chords of one sagitta: steps with the inverse square root of the curvature
    pitch = 2.0 * np.pi / design.tooth_count
    fine = pitch * np.arange(_SAMPLES + 1) / _SAMPLES
    _, rate, _ = design.center_path(-fine)
    path = design.path_curvature(-fine)
    moved = 1.0 - (design.lobe_radius + offset) * path
    length = np.abs(rate) * np.abs(moved)
    bend = np.sqrt(length * np.abs(path * rate)) + 0.2 * length / design.lobe_radius
    summed = np.concatenate([[0.0], np.cumsum(0.5 * (bend[1:] + bend[:-1]))])
    levels = summed[-1] * np.arange(points_per_tooth) / points_per_tooth
    one = np.interp(levels, summed, fine)
    return (one[None, :] + pitch * np.arange(design.tooth_count)[:, None]).ravel()


def outer_outline(design: Trochoid, points_per_lobe: int, offset: float) -> Array:
    """Inside of the outer rotor: lobe arcs joined by the arcs of the cavity floor.

    Parameters
    ----------
    points_per_lobe : int
        Points on one lobe and cavity.
    offset : float
        What the profile is set back along its normal. [m]

    Returns
    -------
    ndarray, shape (n, 2)
        Closed counter-clockwise curve about the outer rotor's centre. [m]
    """
    distance, radius = design.generating_radius, design.lobe_radius - offset
    floor, half_pitch = design.cavity_radius + offset, np.pi / design.lobe_count
    # angles of the corner between lobe and floor about the origin and about the lobe centre
    corner = np.arccos((distance**2 + floor**2 - radius**2) / (2.0 * distance * floor))
    swing = np.arccos((distance**2 + radius**2 - floor**2) / (2.0 * distance * radius))
    corner = min(corner, half_pitch)
    on_lobe = 2 * (points_per_lobe // 3) + 1
    turn = np.linspace(-swing, swing, on_lobe)
    lobe = distance - radius * np.exp(-1j * turn)
    rest = np.linspace(corner, 2.0 * half_pitch - corner, points_per_lobe - on_lobe + 2)
    one = np.concatenate([lobe, floor * np.exp(1j * rest[1:-1])])
    places = -0.5 * np.pi + half_pitch * (1.0 + 2.0 * np.arange(design.lobe_count))
    points = (np.exp(1j * places)[:, None] * one[None, :]).ravel()
    return np.column_stack([points.real, points.imag])
