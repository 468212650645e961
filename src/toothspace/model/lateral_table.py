"""Lateral films reduced to tables over the axial load on the pressed bearing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.types import Array
from toothspace.model.description import FlowPath, MachineDescription
from toothspace.model.films import lateral_face_torque, lateral_torque_coefficient
from toothspace.model.lateral_balance import LAND, FilmInterface, LateralBalance, Patch
from toothspace.model.operating_point import OperatingCondition
from toothspace.model.quasi_static import quasi_static_pressures
from toothspace.numerics.periodic_table import PeriodicTable

LATERAL_PATHS = ("lateral", "drain")
"""Categories of the flow paths beside the gears."""
_ROWS, _LANES, _ANGLES = 144, 24, 4
_MARGIN = 0.1
"""Part of the range of a table by which a load may lie outside and takes the edge. [-]"""


@final
@dataclass(frozen=True, eq=False)
class LateralTable:
    """Friction and leakage beside the gears over force and moment on the pressed bearing.

    Parameters
    ----------
    force : ndarray, shape (n,)
        Unbalanced axial force F_z, positive away from the gears, rising. [N]
    moment : ndarray, shape (m,)
        Unbalanced moment M_x about the middle of the face, rising; one where nothing tilts. [N m]
    extra_drag : ndarray, shape (n, m)
        Torque at the shaft beyond the closed form, per viscosity and shaft speed. [m3]
    leakage_factor : ndarray, shape (n, m)
        Leakage over that of the closed form. [-]
    """

    force: Array
    moment: Array
    extra_drag: Array
    leakage_factor: Array

    def __call__(self, force: float, moment: float) -> tuple[float, float]:
        """Extra drag [m3] and leakage factor [-] at a force [N] and a moment [N m].

        Raises
        ------
        CaseError
            If the load lies outside the table.
        """
        places = (
            _place(self.force, force, "F_z", "N"),
            _place(self.moment, moment, "M_x", "N m"),
        )
        return _bilinear(self.extra_drag, *places), _bilinear(self.leakage_factor, *places)


def _place(nodes: Array, value: float, name: str, unit: str) -> float:
    """Place between the nodes; little outside counts as the edge."""
    if nodes.size == 1:
        return 0.0
    margin = _MARGIN * (nodes[-1] - nodes[0])
    if not nodes[0] - margin <= value <= nodes[-1] + margin:
        raise CaseError(
            f"run.film_tables: found {name} = {value:.5g} {unit} at this condition, allowed "
            f"{nodes[0]:.5g} to {nodes[-1]:.5g} {unit}: make tables near it"
        )
    return float(np.interp(value, nodes, np.arange(nodes.size)))


def _bilinear(values: Array, row: float, column: float) -> float:
    last_row, last_column = (n - 1 for n in values.shape)
    i, j = int(row), int(column)
    k, m = min(i + 1, last_row), min(j + 1, last_column)
    s, t = row - i, column - j
    low = (1.0 - t) * values[i, j] + t * values[i, m]
    high = (1.0 - t) * values[k, j] + t * values[k, m]
    return float((1.0 - s) * low + s * high)


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
    """
    table, balance = description.lateral_table, description.lateral_balance
    if table is None or balance is None:
        return description
    extra, factor = table(*axial_load(balance, chamber_pressures(description, condition)))
    plain = lateral_torque_coefficient(description)
    share = max(1.0 + extra / plain, 0.0)
    laterals = tuple(replace(f, drag=share * lateral_face_torque(f)) for f in description.laterals)
    changed = with_lateral_leakage(description, factor)
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


def closed_form_leakage(
    description: MachineDescription, condition: OperatingCondition, viscosity: float
) -> float:
    """Flow between the ports that loses the power of the lateral and drain paths. [m3/s]."""
    pressures = chamber_pressures(description, condition)
    span = abs(condition.outlet_pressure - condition.inlet_pressure)
    paths = [p for p in description.paths if p.category in LATERAL_PATHS]
    angles = 2.0 * np.pi * (np.arange(24) + 0.5) / 24
    power = [sum(_power(p, pressures(float(a)), float(a)) for p in paths) for a in angles]
    return float(np.mean(power)) / (viscosity * span)


def _power(path: FlowPath, pressure: Array, shaft_angle: float) -> float:
    geometry = path.geometry(path.phases + path.angle_ratio * shaft_angle)
    drop = pressure[path.nodes_a] - pressure[path.nodes_b]
    height, width = np.maximum(geometry[:, 0], 0.0), np.maximum(geometry[:, 1], 0.0)
    cube = width * height**3 / (12.0 * np.maximum(geometry[:, 2], 1e-9))
    return float(path.multiplicity * (cube * drop**2).sum())


def axial_load(balance: LateralBalance, pressures: Callable[[float], Array]) -> tuple[float, float]:
    """Unbalanced force and moment on the pressed bearing as the chamber pressures tell.

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
    angles = (np.arange(_ANGLES) + 0.5) * sides[0].period / _ANGLES
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
    radius = _middles(np.linspace(own.inner_radius, own.outer_radius, _LANES + 1))
    turn = (np.arange(_ROWS) + 0.5) * 2.0 * np.pi / _ROWS
    x = own.center[0] + np.cos(turn)[:, None] * radius
    y = own.center[1] + np.sin(turn)[:, None] * radius
    cells = own.face_map(angle, x, y)
    tip = own.outer_radius * (1.0 + 1e-6)
    rim = own.face_map(
        angle, own.center[0] + tip * np.cos(turn), own.center[1] + tip * np.sin(turn)
    )
    land = cells.node == LAND
    edge = np.where(land.all(axis=1), own.outer_radius, radius[np.argmin(land, axis=1)])
    ramp = np.log(radius / own.inner_radius) / np.log(edge / own.inner_radius)[:, None]
    bore, outside = pressure[own.bore_node], pressure[rim.node][:, None]
    under = bore + (outside - bore) * np.clip(ramp, 0.0, 1.0)
    p = np.where(land, under, pressure[np.where(land, 0, cells.node)])
    area = np.where(cells.owned, radius * (radius[1] - radius[0]) * 2.0 * np.pi / _ROWS, 0.0)
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
    preload = Patch(bearing.preload, bearing.preload_center)
    force, about_x = np.array(bearing.high_pressure.moments)[:2] * (high - low)
    push = np.array(preload.moments)[:2]
    return np.array([force, about_x]) + push + low * face
