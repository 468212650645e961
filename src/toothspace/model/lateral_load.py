"""Axial load on the floating bearing, and machines whose lateral films fit it."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from toothspace.core.types import Array
from toothspace.model.description import MachineDescription
from toothspace.model.film_faces import FILM
from toothspace.model.films import lateral_face_torque
from toothspace.model.lateral_balance import FilmInterface, LateralBalance
from toothspace.model.operating_point import OperatingCondition
from toothspace.model.path_category import LATERAL_PATHS
from toothspace.model.quasi_static import quasi_static_pressures
from toothspace.numerics.periodic_table import PeriodicTable

_ROWS, _LANES, _ANGLES = 144, 24, 4


def with_lateral_table(
    description: MachineDescription, condition: OperatingCondition
) -> MachineDescription:
    """Machine with the drag and leakage of its table at the load of a condition.

    Parameters
    ----------
    description : MachineDescription
        Machine; returned as it is without a table.
    condition : OperatingCondition
        Its quasi-static chamber pressures give the load.

    Raises
    ------
    CaseError
        If the load lies outside the table.

    Notes
    -----
    Quasi-static pressures are those of a machine that turns slowly: nothing is carried from port
    to port. A run at one condition looks up the load of its own pressures instead.
    """
    table, balance = description.lateral_table, description.lateral_balance
    if table is None or balance is None:
        return description
    load = axial_load(balance, chamber_pressures(description, condition))
    table.check(*load)
    return with_lateral_films(description, *table(*load))


def with_lateral_films(
    description: MachineDescription, extra_share: float, leakage_factor: float
) -> MachineDescription:
    """Machine without a table whose lateral films drag and leak by given factors more.

    Parameters
    ----------
    description : MachineDescription
        Machine with closed-form films.
    extra_share : float
        Torque beyond that of the closed form, over it. [-]
    leakage_factor : float
        Leakage over that of the closed form. [-]
    """
    share = max(1.0 + extra_share, 0.0)
    laterals = tuple(replace(f, drag=share * lateral_face_torque(f)) for f in description.laterals)
    changed = with_lateral_leakage(description, leakage_factor)
    return replace(changed, laterals=laterals, lateral_table=None)


def with_lateral_leakage(description: MachineDescription, factor: float) -> MachineDescription:
    """Widen the lateral and drain paths so that they leak by a factor more. [-]."""
    paths = tuple(
        replace(p, geometry=_scaled(p.geometry, factor ** (1.0 / 3.0)))
        if p.category in LATERAL_PATHS
        else p
        for p in description.paths
    )
    return replace(description, paths=paths)


def _scaled(table: PeriodicTable, factor: float) -> PeriodicTable:
    values, slopes = table.values.copy(), table.slopes.copy()
    values[:, 0] *= factor
    slopes[:, 0] *= factor
    return PeriodicTable(table.period, values, slopes)


def chamber_pressures(
    description: MachineDescription, condition: OperatingCondition
) -> Callable[[float], Array]:
    """Quasi-static pressures of all nodes over the shaft angle. [Pa]."""
    ports = {
        "inlet": condition.inlet_pressure,
        "outlet": condition.outlet_pressure,
        "external": condition.drain_pressure,
    }
    rest = np.array([ports["inlet"], ports["outlet"], ports[description.drain]])

    def at(shaft_angle: float) -> Array:
        return np.concatenate([quasi_static_pressures(description, condition, shaft_angle), rest])

    return at


def axial_load(balance: LateralBalance, pressures: Callable[[float], Array]) -> tuple[float, float]:
    """Unbalanced force and moment on the floating bearing from the chamber pressures.

    Parameters
    ----------
    balance : LateralBalance
        Faces and areas behind the bearing.
    pressures : callable
        Pressures of all nodes at a shaft angle. [Pa]

    Returns
    -------
    tuple of float
        F_z, positive away from the gears [N], and M_x about the middle of the face. [N m]

    Notes
    -----
    Under teeth and gear the pressure falls with the logarithm of the radius from that of the
    space beyond to that of the bore; motion of the faces and gaps play no part. Mean of a pitch.

    References
    ----------
    .. [1] R. Pawar, A. Vacca, M. Rigosi, start-up of external gear motors, equation 2.9.
    """
    sides = [i for i in balance.interfaces if i.side == "floating"]
    angles = (np.arange(_ANGLES) + 0.5) * sides[0].face.period / _ANGLES
    found = np.zeros(2)
    for angle in angles:
        pressure = pressures(float(angle))
        pushes = [_face_push(i, float(angle), pressure) for i in sides]
        area, load = np.sum(pushes, axis=0)
        found += (load - _back_push(balance, pressure, area)) / _ANGLES
    middle = balance.floating.face.center[1]
    return float(found[0]), float(found[1] - middle * found[0])


def _face_push(own: FilmInterface, angle: float, pressure: Array) -> tuple[Array, Array]:
    """Area and pressure over one side of a gear, each with its moment about x."""
    face = own.face
    radius = _middles(np.linspace(face.inner_radius, face.outer_radius, _LANES + 1))
    turn = (np.arange(_ROWS) + 0.5) * 2.0 * np.pi / _ROWS
    x, y = face.places(turn, radius)
    cells = face.face_map(angle, x, y)
    tip = np.array([face.outer_radius * (1.0 + 1e-6)])
    rim = face.face_map(angle, *face.places(turn, tip))
    land = cells.node == FILM
    edge = np.where(land.all(axis=1), face.outer_radius, radius[np.argmin(land, axis=1)])
    ramp = np.log(radius / face.inner_radius) / np.log(edge / face.inner_radius)[:, None]
    bore, outside = pressure[face.inner_node], pressure[rim.node]
    under = bore + (outside - bore) * np.clip(ramp, 0.0, 1.0)
    p = np.where(land, under, pressure[np.where(land, 0, cells.node)])
    body = face.body_number(own.body)
    owned = (cells.body == body) | face.open_wall(body, cells, x, y)
    area = np.where(owned, radius * (radius[1] - radius[0]) * 2.0 * np.pi / _ROWS, 0.0)
    return (
        np.array([area.sum(), (area * y).sum()]),
        np.array([(p * area).sum(), (p * area * y).sum()]),
    )


def _middles(edges: Array) -> Array:
    return np.asarray(0.5 * (edges[1:] + edges[:-1]))


def _back_push(balance: LateralBalance, pressure: Array, face: Array) -> Array:
    """Force and moment about x behind the bearing, its face as the films see it."""
    bearing = balance.floating
    high, low = pressure[balance.high_node], pressure[balance.low_node]
    force, about_x = np.array(bearing.high_pressure.moments)[:2] * (high - low)
    push = np.array(bearing.preload.moments)[:2]
    return np.array([force, about_x]) + push + low * face
