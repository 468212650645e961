"""Flow paths of a description as arrays."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from toothspace.circuit.network import CircuitNetwork
from toothspace.core.types import Array, IntArray
from toothspace.model import arrays as col
from toothspace.model.description import FlowPath, MachineDescription
from toothspace.model.path_category import (
    CIRCUIT_ORIFICE,
    LATERAL_PATHS,
    LOAD_ORIFICE,
    PathCategory,
)
from toothspace.numerics.periodic_table import PeriodicTable

_KINDS = {
    "curved_gap": col.CURVED_GAP,
    "fitted_gap": col.FITTED_GAP,
    "parallel_gap": col.PARALLEL_GAP,
    "orifice": col.ORIFICE,
}


def load_orifice(node: int, load: int, area: float) -> FlowPath:
    """Return the orifice from the outlet volume, or the end of a line, to the load. [m2]."""
    return _orifice("load_orifice", LOAD_ORIFICE, (node, load), area)


def circuit_orifices(circuit: CircuitNetwork, places: Mapping[str, int]) -> tuple[FlowPath, ...]:
    """Return the orifices of a circuit as flow paths."""
    found = []
    for k, orifice in enumerate(circuit.orifices):
        ends = places[orifice.node_a], places[orifice.node_b]
        found.append(_orifice(f"circuit_orifice_{k}", CIRCUIT_ORIFICE, ends, orifice.area))
    return tuple(found)


def _orifice(name: str, category: PathCategory, ends: tuple[int, int], area: float) -> FlowPath:
    constant = np.tile([area, np.sqrt(4.0 * area / np.pi)], (2, 1))
    return FlowPath(
        name=name,
        category=category,
        kind="orifice",
        nodes_a=np.array(ends[:1]),
        nodes_b=np.array(ends[1:]),
        angle_ratio=1.0,
        phases=np.zeros(1),
        geometry=PeriodicTable(2.0 * np.pi, constant, np.zeros_like(constant)),
    )


def by_kind(paths: Sequence[FlowPath]) -> tuple[FlowPath, ...]:
    """Order paths by their kind, as compiled code runs through them."""
    return tuple(sorted(paths, key=lambda path: _KINDS[path.kind]))


def path_tables(path: FlowPath, motion_map: Array) -> list[PeriodicTable]:
    """Tables that compiled code reads of a path, one or one for each of its members."""
    tables = []
    for geometry in path.own or (path.geometry,):
        # channels: geometry (3), drag, shear, dh/dq
        period, shape = geometry.period, geometry.values.shape
        motions = motion_map.shape[1]
        values = np.zeros((shape[0], 5 + motions))
        slopes = np.zeros_like(values)
        parts: list[tuple[PeriodicTable | None, slice, Array | None]] = [
            (geometry, slice(0, shape[1]), None),
            (path.drag_speed, slice(3, 4), None),
            (path.shear_speed, slice(4, 5), None),
            (path.height_by_motion, slice(5, 5 + motions), motion_map),
        ]
        for table, columns, mix in parts:
            if table is None:
                continue
            if table.values.shape[0] != shape[0] or table.period != period:
                raise ValueError(f"path {path.name}: tables differ in nodes or period")
            values[:, columns] = table.values if mix is None else table.values @ mix
            slopes[:, columns] = table.slopes if mix is None else table.slopes @ mix
        tables.append(PeriodicTable(period, values, slopes))
    return tables


def path_arrays(
    description: MachineDescription, paths: Sequence[FlowPath], categories: Sequence[PathCategory]
) -> dict[str, Any]:
    """Integer and real columns of every path as compiled code reads them, first of each kind."""
    counts = [path.count for path in paths]
    node_a = drain_joined(description, np.concatenate([path.nodes_a for path in paths]))
    node_b = drain_joined(description, np.concatenate([path.nodes_b for path in paths]))
    family_first, family_count = node_b.copy(), np.ones_like(node_b)
    start = 0
    for family in description.families:
        inside = (node_b >= start) & (node_b < start + family.count)
        family_first[inside], family_count[inside] = start, family.count
        start += family.count
    index = np.column_stack(
        [
            np.repeat([_KINDS[path.kind] for path in paths], counts),
            np.repeat([categories.index(path.category) for path in paths], counts),
            node_a,
            node_b,
            node_b,
            family_first,
            family_count,
            np.repeat([path.partner_shift for path in paths], counts),
        ]
    ).astype(np.int64)
    data = np.column_stack(
        [
            np.repeat([path.multiplicity for path in paths], counts),
            np.repeat([path.minimum_height for path in paths], counts),
            np.repeat([path.throat_speed for path in paths], counts),
            np.repeat([float(path.drags_opening_only) for path in paths], counts),
            np.repeat([path.viscosity_ratio for path in paths], counts),
            np.repeat([float(path.category in LATERAL_PATHS) for path in paths], counts),
        ]
    ).astype(float)
    starts = np.searchsorted(index[:, 0], range(len(_KINDS) + 1))
    return {
        "kinds": starts.astype(np.int64),
        "path_index": np.asfortranarray(index),
        "path_data": np.asfortranarray(data),
        "open_kinds": np.zeros(len(starts), dtype=np.int64),
        "open_index": np.zeros_like(index, order="F"),
        "open_data": np.zeros_like(data, order="F"),
    }


def drain_joined(description: MachineDescription, nodes: IntArray) -> IntArray:
    """Lead the drain into the port that collects it."""
    target = {
        "inlet": description.inlet_node,
        "outlet": description.outlet_node,
        "external": description.drain_node,
    }[description.drain]
    return np.where(nodes == description.drain_node, target, nodes).astype(np.int64)
