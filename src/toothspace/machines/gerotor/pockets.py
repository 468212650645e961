r"""Volumes of the pockets between neighbouring lobes, with exact derivatives.

A pocket between the throats b (behind) and a (ahead) changes by the walls that turn with
:math:`\omega_1, \omega_2` between their radii about both centres,

.. math:: \dot A = \tfrac12 \left[\omega_1 (r_{1a}^2 - r_{1b}^2)
                 - \omega_2 (r_{2a}^2 - r_{2b}^2)\right],

with the middles of the throats. These are the points of contact of the rotors without
clearance: the fluid in the thin layers between the middle of the gap and the walls is carried
round with the walls, and passing a throat it drags exactly the volume that a pocket bounded by
the walls themselves would lose. The layers enter every pocket as one constant volume.

The place of a lobe or pocket is the angle of its middle about the outer rotor's centre, from
the negative y axis (smallest pocket) in the sense of rotation; pi is at the largest pocket.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
import scipy

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array
from toothspace.geometry.curve import polar, signed_area, turned
from toothspace.machines.gerotor.contact_table import distance_to_inner, nearest_place
from toothspace.machines.gerotor.profiles import Rotors, trochoid_of
from toothspace.machines.gerotor.rotor_files import RotorParameters

FULL_TURN = 2.0 * np.pi
_FINER = 8
_OVERLAP_LIMIT = 50e-6
RADIUS_RANGE = (20e-6, 1.0)
"""Relative radii of curvature are kept in this range: cusps count with the lower end. [m]."""
_LOBE_SAMPLES = 240
_MISS_WEIGHT = 0.02


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

    Throats, areas and their rates.

    Raises GeometryError if profiles from files overlap.
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
    growth = rate
    finer = 1 if parameters.kind is None else _FINER
    place = FULL_TURN * np.arange(count * finer + 1) / (count * finer)
    if finer > 1:
        fine = lobe_path(parameters, rotors, place[:-1])
        half = finer * count // (2 * rotors.outer_tooth_count)
        growth = _area_rate(rotors, fine, half)
    growth = growth - float(np.mean(growth))
    spline = scipy.interpolate.CubicSpline(place, np.append(growth, growth[0]), bc_type="periodic")
    total = spline.antiderivative()(place[:-1:finer])
    area = np.asarray(total / rotors.speed_ratio, dtype=float)
    enclosed = signed_area(rotors.outer) - signed_area(rotors.inner)
    area += enclosed / rotors.outer_tooth_count - float(np.mean(area))
    return Pockets(rotors, path, area, rate)


def _area_rate(rotors: Rotors, path: LobePath, half_pitch_nodes: int) -> Array:
    inner = np.sum((path.point - rotors.inner_center) ** 2, axis=1)
    outer = np.sum(path.point**2, axis=1)
    swept = 0.5 * (inner - rotors.speed_ratio * outer)
    return np.roll(swept, -half_pitch_nodes) - np.roll(swept, half_pitch_nodes)


def area_by_motion(pocket: Pockets) -> Array:
    """Derivative of the pocket area with respect to rigid motions of both rotors.

    By x and y of the inner rotor, by x, y and rotation of the outer rotor. Times the pressure and
    the width it is the force of the pocket, shape (n, 5). [m], [m2/rad]
    """
    behind, ahead = pocket.behind(pocket.path.point), pocket.ahead(pocket.path.point)
    chord = ahead - behind
    turned = 0.5 * (np.sum(behind**2, axis=1) - np.sum(ahead**2, axis=1))
    return np.column_stack([-chord[:, 1], chord[:, 0], chord[:, 1], -chord[:, 0], turned])


@final
@dataclass(frozen=True)
class LobePath:
    """The throat between one lobe and the inner rotor, over the lobe's place."""

    place: Array
    """Place of the lobe. Shape (n,). [rad]"""
    point: Array
    """Middle of the throat in the machine frame. Shape (n, 2). [m]"""
    normal: Array
    """Unit normal from the inner to the outer rotor. Shape (n, 2). [-]"""
    gap: Array
    """Length of the throat. [m]"""
    inner_curvature: Array
    outer_curvature: Array
    """Curvatures of the walls, positive where convex. [1/m]"""

    @property
    def relative_radius(self) -> Array:
        """Relative radius of curvature, within :data:`RADIUS_RANGE`. [m]."""
        low, high = RADIUS_RANGE
        curvature = self.inner_curvature + self.outer_curvature
        return np.asarray(1.0 / np.clip(curvature, 1.0 / high, 1.0 / low), dtype=float)


def lobe_path(parameters: RotorParameters, rotors: Rotors, place: Array) -> LobePath:
    """Find the throats of one lobe at given places.

    Throats; those of generated pairs lie on the path of contact.

    Parameters
    ----------
    parameters : RotorParameters
        Design; generated pairs have exact contact points.
    place : ndarray
        Places of the lobe. [rad]
    """
    if parameters.kind == "trochoidal":
        design = trochoid_of(parameters)
        angle = place - 0.5 * np.pi
        center = polar(design.generating_radius, angle)
        normal = center - rotors.pitch_point
        normal /= np.hypot(*normal.T)[:, None]
        half_pitch = np.pi / design.lobe_count
        path = design.path_curvature((place - half_pitch) / design.tooth_count)
        inner_radius = 1.0 / path - design.lobe_radius - 0.5 * rotors.tip_clearance
        outer_radius = design.lobe_radius - 0.5 * rotors.tip_clearance
        return LobePath(
            place=place,
            point=center - design.lobe_radius * normal,
            normal=normal,
            gap=np.full_like(place, rotors.tip_clearance),
            inner_curvature=1.0 / inner_radius,
            outer_curvature=np.full_like(place, 1.0 / outer_radius),
        )
    if parameters.kind == "cycloidal":
        return _cycloidal(rotors, place)
    # throats where a lobe comes closest to the inner rotor; beside the lobe there are none
    curve = rotors.outer_curve
    step = curve.length / (rotors.outer_tooth_count * _LOBE_SAMPLES)
    points = np.asarray(curve.tree.data)
    cavity = float(curve.nearest(points[[np.argmin(points[:, 1])]])[0][0])
    over_lobe = cavity + step * (np.arange(_LOBE_SAMPLES) + 0.5)
    concave = np.flatnonzero(curve.curvature(np.asarray(over_lobe, dtype=float)) >= 0.0)
    middle = _LOBE_SAMPLES // 2
    first = int(concave[concave < middle].max(initial=-1)) + 1
    last = int(concave[concave > middle].min(initial=_LOBE_SAMPLES))
    lobe = np.asarray(over_lobe[first:last])
    turn = place - 0.5 * rotors.pitch
    angle, along = np.broadcast_arrays(turn[:, None], lobe)
    gap, _, normal, point = _throats(rotors, angle, along)
    to_pitch = point - rotors.pitch_point
    miss = normal[..., 0] * to_pitch[..., 1] - normal[..., 1] * to_pitch[..., 0]
    best = np.argmin(gap + _MISS_WEIGHT * miss**2 / rotors.eccentricity, axis=1)
    outer = nearest_place(rotors, turn, lobe[best], step)
    gap, inner, normal, point = _throats(rotors, turn, outer)
    return LobePath(
        place=place,
        point=point - 0.5 * gap[:, None] * normal,
        normal=normal,
        gap=gap,
        inner_curvature=rotors.inner_curve.curvature(inner),
        outer_curvature=-rotors.outer_curve.curvature(outer),
    )


def _cycloidal(rotors: Rotors, place: Array) -> LobePath:
    # a lobe touches along the large generating circle, and near the pitch point along the small
    count, lobes, q = rotors.inner_tooth_count, rotors.outer_tooth_count, 0.5 * rotors.eccentricity
    large = (2 * count + 1) * q
    rolled = np.mod(place - 0.5 * np.pi / lobes, 2.0 * np.pi) * 2.0 * lobes * q
    on_small = rolled > 2.0 * np.pi * large
    turn = np.where(on_small, (rolled - 2.0 * np.pi * large) / q, rolled / large)
    radius = np.where(on_small, q, large)
    chord = radius[:, None] * np.column_stack([np.sin(turn), 1.0 - np.cos(turn)])
    distance = 2.0 * radius * np.abs(np.sin(0.5 * turn))
    # half of the turn about the pitch point gives the direction also where the chord vanishes
    away = np.column_stack([np.cos(0.5 * turn), np.sin(0.5 * turn)])
    normal = np.where(on_small[:, None], -away, away)
    half = 0.5 * rotors.tip_clearance
    # Euler and Savary: radius of the path of a point on a circle that rolls in another
    concave = -distance * (2 * count - 1) / (count - 1)
    convex = distance * (2 * lobes - 1) / (lobes - 1)
    inner_radius = np.where(on_small, concave, distance / lobes) - half
    outer_radius = np.where(on_small, convex, distance / count) - half
    return LobePath(
        place=place,
        point=rotors.pitch_point + chord,
        normal=normal,
        gap=np.full_like(place, rotors.tip_clearance),
        inner_curvature=_inverse(inner_radius),
        outer_curvature=_inverse(outer_radius),
    )


def _inverse(radius: Array) -> Array:
    # near a cusp the offset has cut the convex part away: its edge remains
    edge = 0.5 * RADIUS_RANGE[0]
    sharp = np.abs(radius) < edge
    return np.asarray(1.0 / np.where(sharp, edge, radius), dtype=float)


def _throats(rotors: Rotors, angle: Array, along: Array) -> tuple[Array, Array, Array, Array]:
    """Gap [m], arc length on the inner outline [m], normal and point on the outer outline."""
    inner, gap = distance_to_inner(rotors, angle, along)
    tangent = turned(rotors.inner_curve.tangent(inner), rotors.turns * angle)
    normal = np.stack([tangent[..., 1], -tangent[..., 0]], axis=-1)
    return gap, inner, normal, turned(rotors.outer_curve.point(along), angle)
