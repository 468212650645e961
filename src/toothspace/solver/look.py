"""What is seen of a revolution: at its samples, and at states close enough for extremes."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.model import arrays as col
from toothspace.model.description import MachineDescription
from toothspace.model.path_category import PathRole
from toothspace.numerics.periodic_table import PeriodicTable
from toothspace.solver.compiled_model import Observation, observe
from toothspace.solver.cyclic import History

SEEN = 4
"""Every so many of the dense states of a revolution are evaluated."""
_TRAPPED: tuple[PathRole, ...] = ("inlet_groove", "outlet_groove", "mesh")
"""Roles of the paths through which a chamber that is sealed from both ports still flows."""

_PORTS: tuple[PathRole, ...] = (
    "inlet_port",
    "outlet_port",
    "drain",
    "inlet_groove",
    "outlet_groove",
)
"""Roles of openings in the order of the dimension ``port``."""


@final
@dataclass(frozen=True)
class Look:
    """States of a revolution and everything seen there."""

    history: History
    """Its samples are the states looked at."""
    seen: Observation
    """Pressures, flows and forces there."""
    openings: Array
    """Areas by which chambers are open to ports and grooves. [m2]"""
    trapped: BoolArray
    """Paths in grooves and mesh at an end of which a chamber is sealed from both ports."""

    def at(self, rows: IntArray, history: History) -> Look:
        """Part of it that a history with fewer samples has."""
        part = {name: values[rows] for name, values in self.seen._asdict().items()}
        seen = self.seen._replace(**part)
        return Look(history, seen, self.openings[rows], self.trapped[rows])

    def trapped_losses(self) -> dict[str, float]:
        """Throttling of trapped fluid in grooves and mesh, by account. [J]."""
        lost = np.where(self.trapped, self.seen.path_loss, 0.0)
        power = np.trapezoid(lost, self.history.times, axis=0)
        account = self.history.system.arrays.path_index[:, col.CATEGORY]
        return {
            category.account: float(power[account == k].sum())
            for k, category in enumerate(self.history.system.categories)
            if category.role in _TRAPPED
        }


def look_at(history: History) -> Look:
    """Look at the samples of a history."""
    system = history.system
    seen = observe(system.arrays, history.states)
    opened = openings(system.description, history.states[:, 0])
    return Look(history, seen, opened, _trapped_flows(history, seen, opened))


def looks_at(history: History) -> tuple[Look, Look]:
    """Look at the samples of a revolution, and at close states of it whatever its samples are."""
    dense = history.dense
    if dense is None or dense.times.size <= SEEN:
        samples = look_at(history)
        return samples, samples
    close = look_at(
        replace(history, times=dense.times[::SEEN], states=dense.states[::SEEN], dense=None)
    )
    rows = np.searchsorted(close.history.times, history.times)
    rows = np.minimum(rows, close.history.times.size - 1)
    if np.array_equal(close.history.times[rows], history.times):
        return close.at(rows, history), close
    return look_at(history), close


def openings(description: MachineDescription, shaft_angle: Array) -> Array:
    """Areas by which every chamber is open to each port and groove, over the angle. [m2]."""
    area = np.zeros((shaft_angle.size, description.chamber_count, len(_PORTS)))
    for path in description.paths:
        if path.kind != "orifice" or path.category.role not in _PORTS:
            continue
        angles = path.phases + path.angle_ratio * shaft_angle[:, None]
        table = path.geometry
        areas = PeriodicTable(table.period, table.values[:, :1], table.slopes[:, :1])
        open_area = path.multiplicity * areas(angles)[..., 0]
        port = _PORTS.index(path.category.role)
        area[:, path.nodes_a, port] += np.maximum(open_area, 0.0)
    return area


def _trapped_flows(history: History, seen: Observation, opened: Array) -> BoolArray:
    system, size = history.system, history.system.arrays.size
    sealed = np.zeros((history.times.size, size.nodes), dtype=bool)
    sealed[:, : size.chambers] = opened[..., :2].max(axis=2) <= 0.0
    roles = np.array([category.role in _TRAPPED for category in system.categories])
    inside = roles[system.arrays.path_index[:, col.CATEGORY]]
    first = sealed[:, system.arrays.path_index[:, col.NODE_A]]
    second = np.take_along_axis(sealed, seen.path_partner, axis=1)
    return np.asarray(inside & (first | second) & (seen.path_flow != 0.0))
