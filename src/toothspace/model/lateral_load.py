"""Axial load on the floating bearing by the pressures, and lateral gaps that leak more."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from itertools import takewhile
from typing import NamedTuple

import numpy as np

from toothspace.core.types import Array
from toothspace.model.description import ChamberFamily, MachineDescription
from toothspace.model.film_faces import FILM
from toothspace.model.floating_bearing import FilmInterface, LateralBalance
from toothspace.model.lateral_table import LATERAL_NOW, LateralLookup
from toothspace.model.operating_point import OperatingCondition
from toothspace.model.path_category import LATERAL_PATHS
from toothspace.model.paths import drain_joined
from toothspace.model.quasi_static import quasi_static_pressures
from toothspace.numerics.periodic_table import PeriodicTable, smooth_table

_ROWS, _LANES, _ANGLES = 360, 24, 4
_SAMPLES = 16
"""Angles of one pitch at which the load on a face is sampled. [-]"""


def with_lateral_leakage(description: MachineDescription, factor: float) -> MachineDescription:
    """Raise the lateral and drain gaps so that they leak by a factor more. [-]."""
    scale = np.array([factor ** (1.0 / 3.0), 1.0, 1.0])
    paths = list(description.paths)
    for k, path in enumerate(paths):
        if path.category in LATERAL_PATHS:
            table = path.geometry
            raised = PeriodicTable(table.period, table.values * scale, table.slopes * scale)
            paths[k] = replace(path, geometry=raised)
    return replace(description, paths=tuple(paths))


def chamber_pressures(
    description: MachineDescription, condition: OperatingCondition
) -> Callable[[float], Array]:
    """Quasi-static pressures of all nodes over the shaft angle. [Pa]."""
    rest = condition.port_pressures(description.drain)

    def at(shaft_angle: float) -> Array:
        return np.concatenate([quasi_static_pressures(description, condition, shaft_angle), rest])

    return at


def axial_load(balance: LateralBalance, pressures: Callable[[float], Array]) -> tuple[float, float]:
    """Unbalanced force and moment on the floating bearing from the chamber pressures.

    F_z, positive away from the gears [N], and M_x about the middle of the face. [N m]

    Parameters
    ----------
    balance : LateralBalance
        Faces and areas behind the bearing.
    pressures : callable
        Pressures of all nodes at a shaft angle. [Pa]

    Notes
    -----
    Under teeth and gear the pressure falls with the logarithm of the radius from that of the
    space beyond to that of the bore; motion of the faces and gaps play no part. Mean of a pitch.

    References
    ----------
    .. [1] R. Pawar, A. Vacca, M. Rigosi, start-up of external gear motors, equation 2.9.
    """
    angles = (np.arange(_ANGLES) + 0.5) * load_period(balance) / _ANGLES
    found = -preload_of(balance)
    for angle in angles:
        pressure = pressures(float(angle))
        found = found + pressure @ load_weights(balance, float(angle), pressure.size) / _ANGLES
    return float(found[0]), float(found[1])


def load_period(balance: LateralBalance) -> float:
    """Shaft angle after which the load depends on the pressures in the same way. [rad]."""
    return next(i.face.period for i in balance.interfaces if i.side == "floating")


def preload_of(balance: LateralBalance) -> Array:
    """Force of springs and seal towards the gears [N], and its moment about x [N m]."""
    force, about_x, _ = balance.floating.preload.moments
    return np.array([force, about_x - balance.floating.face.center[1] * force])


def load_weights(balance: LateralBalance, shaft_angle: float, nodes: int) -> Array:
    """Force [m2] and moment about x [m3] on the floating bearing by the pressure of every node.

    The same pressure everywhere gives none: low pressure acts on what is left behind the bearing.
    """
    weights = np.zeros((nodes, 2))
    for own in balance.interfaces:
        if own.side == "floating":
            _add_face(weights, own, shaft_angle)
    high = np.array(balance.floating.high_pressure.moments)[:2]
    weights[balance.high_node] -= high
    weights[balance.low_node] -= weights.sum(axis=0)
    weights[:, 1] -= balance.floating.face.center[1] * weights[:, 0]
    return weights


class SampledLoads(NamedTuple):
    """Force [m2] and moment about x [m3] by the pressure of every node at shaft angles [rad]."""

    angles: Array
    weights: Array


def load_table(
    description: MachineDescription, family: ChamberFamily, loads: SampledLoads
) -> PeriodicTable:
    """Force [m2] and moment about x [m3] on the floating bearing by the pressure of a chamber.

    Over the table angle of the family, on the nodes of its volume.
    """
    angles, weights = loads
    before = takewhile(lambda other: other is not family, description.families)
    first = sum(other.count for other in before)
    period = family.volume.period
    theta = np.mod(family.phases + family.angle_ratio * angles[:, None], period).ravel()
    own = weights[:, first : first + family.count].reshape(-1, 2)
    order = np.argsort(theta)
    nodes = family.volume.values.shape[0]
    places = period * np.arange(nodes) / nodes
    columns = [np.interp(places, theta[order], c[order], period=period) for c in own.T]
    return smooth_table(period, np.stack(columns, axis=1))


def lateral_lookup(
    description: MachineDescription, nodes: int, loads: SampledLoads
) -> LateralLookup:
    """Table of the lateral films of a machine as compiled code reads it, for so many nodes."""
    table, balance = description.lateral_table, description.lateral_balance
    assert table is not None
    assert balance is not None
    counts = np.array([axis.size for axis in table.axes], dtype=np.int64)
    axes = np.zeros((counts.size, counts.max()))
    for row, axis in zip(axes, table.axes, strict=True):
        row[: axis.size] = axis
    resting = np.zeros((nodes, 2))
    mean = loads.weights.mean(axis=0)
    ends = drain_joined(description, np.arange(len(mean)))
    np.add.at(resting, ends[description.chamber_count :], mean[description.chamber_count :])
    area, reach = balance.floating.high_pressure.area, balance.interfaces[0].face.outer_radius
    warmth = float(np.mean([film.viscosity_ratio for film in description.laterals]))
    ports = balance.high_node, balance.low_node
    scales = [area, reach, *preload_of(balance), *ports, warmth]
    return LateralLookup(
        axes, counts, table.packed(), resting, np.array(scales), np.zeros(LATERAL_NOW)
    )


def sampled_loads(description: MachineDescription) -> SampledLoads | None:
    """Loads on the floating bearing over one pitch; None without such a bearing."""
    balance = description.lateral_balance
    if balance is None:
        return None
    nodes = description.drain_node + 1
    angles = (np.arange(_SAMPLES) + 0.5) * load_period(balance) / _SAMPLES
    weights = np.stack([load_weights(balance, float(a), nodes) for a in angles])
    return SampledLoads(angles, weights)


def _add_face(weights: Array, own: FilmInterface, angle: float) -> None:
    """Add area and moment about x of one side of a gear, by the nodes whose pressure acts."""
    face, angle = own.face, angle + own.lead
    edges = np.linspace(face.inner_radius, face.outer_radius, _LANES + 1)
    radius = 0.5 * (edges[1:] + edges[:-1])
    turn = (np.arange(_ROWS) + 0.5) * 2.0 * np.pi / _ROWS
    x, y = face.places(turn, radius)
    cells = face.face_map(angle, x, y)
    tip = np.array([face.outer_radius * (1.0 + 1e-6)])
    rim = face.face_map(angle, *face.places(turn, tip))
    land = cells.node == FILM
    edge = np.where(land.all(axis=1), face.outer_radius, radius[np.argmin(land, axis=1)])
    ramp = np.log(radius / face.inner_radius) / np.log(edge / face.inner_radius)[:, None]
    beyond = np.where(land, np.clip(ramp, 0.0, 1.0), 1.0)
    body = face.body_number(own.body)
    owned = (cells.body == body) | face.open_wall(body, cells, x, y)
    area = np.where(owned, radius * (radius[1] - radius[0]) * 2.0 * np.pi / _ROWS, 0.0)
    outside = np.where(land, rim.node, cells.node).ravel() + own.first_node
    for column, arm in enumerate((area, area * y)):
        weights[:, column] += np.bincount(outside, (arm * beyond).ravel(), len(weights))
        weights[face.inner_node, column] += float((arm * (1.0 - beyond)).sum())
