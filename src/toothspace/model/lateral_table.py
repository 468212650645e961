"""Lateral films reduced to tables over the axial load on the floating bearing."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.types import Array
from toothspace.model.description import MachineDescription
from toothspace.model.films import lateral_face_torque
from toothspace.model.lateral_balance import LAND, FilmInterface, LateralBalance
from toothspace.model.operating_point import OperatingCondition
from toothspace.model.path_category import LATERAL_PATHS
from toothspace.model.quasi_static import quasi_static_pressures
from toothspace.numerics.periodic_table import PeriodicTable

_ROWS, _LANES, _ANGLES = 144, 24, 4
_MARGIN = 0.1
"""Part of the range of a table by which a load may lie outside and takes the edge. [-]"""


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class LateralTable:
    """Friction and leakage beside the gears over force and moment on the floating bearing.

    Parameters
    ----------
    force : ndarray, shape (n,)
        Unbalanced axial force F_z, positive away from the gears, rising. [N]
    moment : ndarray, shape (m,)
        Unbalanced moment M_x about the middle of the face, rising; one where nothing tilts. [N m]
    extra_share : ndarray, shape (n, m)
        Torque at the shaft beyond that of the closed form, over it, both at the condition. [-]
    pressure_share : ndarray, shape (n, m)
        Part of the torque that does not depend on viscosity and speed, over the same. [-]
    leakage_factor : ndarray, shape (n, m)
        Leakage over that of the closed form; its logarithm is linear between the nodes. [-]
    condition_load : tuple of float
        Force [N] and moment [N m] at the condition that the table was made at.
    condition_slide : float
        Viscosity times shaft speed there. [Pa]
    """

    force: Array
    moment: Array
    extra_share: Array
    pressure_share: Array
    leakage_factor: Array
    condition_load: tuple[float, float]
    condition_slide: float

    def __call__(
        self, force: float, moment: float, slide: float | None = None
    ) -> tuple[float, float]:
        """Extra torque over the closed form and leakage factor at a force [N] and moment [N m].

        ``slide`` is viscosity times shaft speed [Pa], by default that of the condition. A load
        outside the table counts as its edge; :meth:`check` refuses it.
        """
        places = (_place(self.force, force), _place(self.moment, moment))
        leakage = float(np.exp(_bilinear(np.log(self.leakage_factor), *places)))
        extra = _bilinear(self.extra_share, *places)
        if slide is not None:
            # what does not grow with the speed is the less of a torque that does
            growth = self.condition_slide / slide - 1.0
            extra += growth * _bilinear(self.pressure_share, *places)
        return extra, leakage

    def force_of(self, factor: float, moment: float) -> float:
        """Force [N] at which films leak by a factor [-] more, at a moment [N m]; rising with it."""
        column = _place(self.moment, moment)
        found = [
            _bilinear(np.log(self.leakage_factor), float(i), column) for i in range(self.force.size)
        ]
        return float(np.interp(np.log(factor), np.maximum.accumulate(found), self.force))

    def check(self, force: float, moment: float) -> None:
        """Refuse a load far outside the table.

        Raises
        ------
        CaseError
            If the load lies outside by more than a tenth of its range.
        """
        _check(self.force, force, "F_z", "N")
        _check(self.moment, moment, "M_x", "N m")


def _place(nodes: Array, value: float) -> float:
    """Place between the nodes; outside counts as the edge."""
    return float(np.interp(value, nodes, np.arange(nodes.size)))


def _check(nodes: Array, value: float, name: str, unit: str) -> None:
    margin = _MARGIN * (nodes[-1] - nodes[0])
    if nodes.size > 1 and not nodes[0] - margin <= value <= nodes[-1] + margin:
        raise CaseError(
            f"run.film_tables: found {name} = {value:.5g} {unit} at this condition, allowed "
            f"{nodes[0]:.5g} to {nodes[-1]:.5g} {unit}: make tables near it"
        )


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
    force, about_x = np.array(bearing.high_pressure.moments)[:2] * (high - low)
    push = np.array(bearing.preload.moments)[:2]
    return np.array([force, about_x]) + push + low * face
