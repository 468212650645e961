r"""Volumes of the pockets between neighbouring lobes, with exact derivatives.

A pocket between the throats b (behind) and a (ahead) changes by the walls that turn with
:math:`\omega_1, \omega_2` between their radii about both centres,

.. math:: \dot A = \tfrac12 \left[\omega_1 (r_{1a}^2 - r_{1b}^2)
                 - \omega_2 (r_{2a}^2 - r_{2b}^2)\right],

with the middles of the throats. These are the points of contact of the rotors without
clearance: the fluid in the thin layers between the middle of the gap and the walls is carried
round with the walls, and passing a throat it drags exactly the volume that a pocket bounded by
the walls themselves would lose. The layers enter every pocket as one constant volume.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
import scipy

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array
from toothspace.geometry.curve import signed_area
from toothspace.machines.gerotor.lobe_path import LobePath, lobe_path
from toothspace.machines.gerotor.profiles import Rotors
from toothspace.machines.gerotor.rotor_parameters import RotorParameters

FULL_TURN = 2.0 * np.pi
_FINER = 8
_OVERLAP_LIMIT = 50e-6


@final
@dataclass(frozen=True)
class Pockets:
    """Pockets of a gerotor set over their place (see ``lobe_path``)."""

    rotors: Rotors
    """Both rotors."""
    path: LobePath
    """Throats at the table nodes; an even number of nodes on an outer pitch."""
    area: Array
    """Section area of a pocket at the nodes. [m2]"""
    area_rate: Array
    """Derivative of the area with respect to the shaft angle. [m2/rad]"""

    @property
    def place(self) -> Array:
        """Places of the nodes. [rad]."""
        return self.path.place

    @property
    def angle_ratio(self) -> float:
        """Growth of the place per shaft angle. [-]."""
        return self.rotors.speed_ratio

    @property
    def half_pitch_nodes(self) -> int:
        """Nodes on half an outer pitch."""
        return self.place.size // (2 * self.rotors.outer_tooth_count)

    def behind(self, values: Array) -> Array:
        """Values of the throat behind the pocket at each node, from values of a lobe."""
        return np.roll(values, self.half_pitch_nodes, axis=0)

    def ahead(self, values: Array) -> Array:
        """Values of the throat ahead of the pocket at each node, from values of a lobe."""
        return np.roll(values, -self.half_pitch_nodes, axis=0)

    @property
    def displaced_area(self) -> float:
        """Area of the largest less that of the smallest pocket. [m2]."""
        return float(np.ptp(self.area))

    @property
    def area_per_radian(self) -> float:
        """Section area displaced per shaft radian. [m2/rad]."""
        return self.rotors.inner_tooth_count * self.displaced_area / FULL_TURN


def pockets(parameters: RotorParameters, rotors: Rotors, nodes: int) -> Pockets:
    """Tabulate the pockets over one turn of the outer rotor.

    Returns
    -------
    Pockets
        Throats, areas and their rates.

    Raises
    ------
    GeometryError
        If profiles from files overlap.
    """
    per_pitch = 2 * max(round(0.5 * nodes / rotors.outer_tooth_count), 4)
    count = per_pitch * rotors.outer_tooth_count
    path = lobe_path(parameters, rotors, FULL_TURN * np.arange(count) / count)
    least = float(path.gap.min())
    if least < -_OVERLAP_LIMIT:
        raise GeometryError(
            "machine.rotors.eccentricity",
            f"{rotors.eccentricity * 1e3:.5g} mm, at which the rotors overlap by "
            f"{-least * 1e3:.3g} mm",
            f"below {_OVERLAP_LIMIT * 1e3:.2g} mm",
        )
    rate = _area_rate(rotors, path, per_pitch // 2)
    area = _integrated(parameters, rotors, count, rate)
    enclosed = signed_area(rotors.outer) - signed_area(rotors.inner)
    area += enclosed / rotors.outer_tooth_count - float(np.mean(area))
    return Pockets(rotors, path, area, rate)


def _area_rate(rotors: Rotors, path: LobePath, half_pitch_nodes: int) -> Array:
    inner = np.sum((path.point - rotors.inner_center) ** 2, axis=1)
    outer = np.sum(path.point**2, axis=1)
    swept = 0.5 * (inner - rotors.speed_ratio * outer)
    return np.roll(swept, -half_pitch_nodes) - np.roll(swept, half_pitch_nodes)


def _integrated(parameters: RotorParameters, rotors: Rotors, count: int, rate: Array) -> Array:
    finer = 1 if parameters.kind is None else _FINER
    place = FULL_TURN * np.arange(count * finer + 1) / (count * finer)
    if finer > 1:
        fine = lobe_path(parameters, rotors, place[:-1])
        half = finer * count // (2 * rotors.outer_tooth_count)
        rate = _area_rate(rotors, fine, half)
    rate = rate - float(np.mean(rate))
    spline = scipy.interpolate.CubicSpline(place, np.append(rate, rate[0]), bc_type="periodic")
    total = spline.antiderivative()(place[:-1:finer])
    return np.asarray(total / rotors.speed_ratio, dtype=float)


def area_by_motion(pocket: Pockets) -> Array:
    """Derivative of the pocket area with respect to rigid motions of both rotors.

    Returns
    -------
    ndarray, shape (n, 5)
        By x and y of the inner rotor, by x, y and rotation of the outer rotor. Times the
        pressure and the width it is the force of the pocket. [m], [m2/rad]
    """
    behind, ahead = pocket.behind(pocket.path.point), pocket.ahead(pocket.path.point)
    chord = ahead - behind
    turned = 0.5 * (np.sum(behind**2, axis=1) - np.sum(ahead**2, axis=1))
    return np.column_stack([-chord[:, 1], chord[:, 0], chord[:, 1], -chord[:, 0], turned])
