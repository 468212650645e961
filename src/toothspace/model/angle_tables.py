"""Tables of a machine over the angle, listed with names and units."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np

from toothspace.core.types import Array
from toothspace.model.contact_pair import CONTACT_CHANNELS, ContactPair
from toothspace.model.machine_parts import PATH_CHANNELS, ChamberFamily, FlowPath, Motion
from toothspace.numerics.periodic_table import PeriodicTable

if TYPE_CHECKING:
    import xarray as xr

_CHANNEL_UNITS = {
    "area": "m2",
    "hydraulic_diameter": "m",
    "height": "m",
    "width": "m",
    "length": "m",
    "relative_radius": "m",
    "gap": "m",
    "load_share": "1",
    "radius_a": "m",
    "radius_b": "m",
    "sliding_speed": "m/rad",
    "rolling_speed_sum": "m/rad",
}


@final
@dataclass(frozen=True)
class Column:
    """One tabulated quantity: name, SI unit and values at the nodes of its table."""

    name: str
    units: str
    values: Array


@final
@dataclass(frozen=True)
class AngleTable:
    """All columns of one chamber family, path or contact over its table angle."""

    name: str
    """Name of the family, path or contact."""
    meaning: str
    """What it is, for the header."""
    angle_ratio: float
    """Growth of the table angle per shaft angle. [-]"""
    phases: Array
    """Table angle of each member at shaft angle zero. [rad]"""
    columns: tuple[Column, ...]
    """Quantities; the first is the table angle [rad]."""


def angle_tables(
    families: Sequence[ChamberFamily],
    paths: Sequence[FlowPath],
    contacts: Sequence[ContactPair],
    motions: Sequence[Motion],
) -> list[AngleTable]:
    """List every table of a machine: chamber families, flow paths, contacts."""
    return [
        *(_family_table(family, motions) for family in families),
        *(_path_table(path, motions) for path in paths),
        *(_contact_table(contact, motions) for contact in contacts),
    ]


def tables_dataset(
    tables: Sequence[AngleTable],
    outlines: Mapping[str, Array],
    attributes: Mapping[str, str | float],
) -> xr.Dataset:
    """Collect the tables of a machine in one dataset; each has its own angle dimension.

    Parameters
    ----------
    tables : sequence of AngleTable
        Tables of the machine.
    outlines : mapping of str to ndarray
        Outlines by name, shape (n, 2). [m]
    attributes : mapping
        Attributes of the dataset.

    Returns
    -------
    xarray.Dataset
        Variables ``<table>_<quantity>`` over ``<table>_angle``, phases of the members and
        outlines.
    """
    import xarray as xr

    dataset = xr.Dataset(attrs=dict(attributes))
    for table in tables:
        dimension = f"{table.name}_angle"
        for column in table.columns:
            labels = {"units": column.units, "long_name": f"{table.meaning}: {column.name}"}
            dataset[f"{table.name}_{column.name}"] = (dimension, column.values, labels)
        labels = {"units": "rad", "long_name": "table angle of each member at shaft angle zero"}
        dataset[f"{table.name}_phase"] = (f"{table.name}_member", table.phases, labels)
    for name, points in outlines.items():
        labels = {"units": "m", "long_name": f"outline of {name}"}
        dataset[f"{name}_outline"] = ((f"{name}_point", "plane_axis"), points, labels)
    return dataset


def _family_table(family: ChamberFamily, motions: Sequence[Motion]) -> AngleTable:
    nodes = _nodes(family.volume)
    columns = [
        Column("volume", "m3", family.volume.values[:, 0]),
        Column("volume_slope", "m3/rad", family.volume.slopes[:, 0]),
        *_motion_columns("volume", family.volume_by_motion(nodes), motions, ("m2", "m3/rad")),
    ]
    return _angle_table("chamber family", family, nodes, columns)


def _path_table(path: FlowPath, motions: Sequence[Motion]) -> AngleTable:
    nodes = _nodes(path.geometry)
    columns = _channel_columns(PATH_CHANNELS[path.kind], path.geometry)
    for name, table in (("drag_speed", path.drag_speed), ("shear_speed", path.shear_speed)):
        if table is not None:
            columns.append(Column(name, "m/rad", table(nodes)[:, 0]))
    if path.height_by_motion is not None:
        columns += _motion_columns("height", path.height_by_motion(nodes), motions, ("1", "m/rad"))
    return _angle_table(f"{path.kind} path ({path.category.name})", path, nodes, columns)


def _contact_table(contact: ContactPair, motions: Sequence[Motion]) -> AngleTable:
    nodes = _nodes(contact.geometry)
    columns = _channel_columns(CONTACT_CHANNELS, contact.geometry)
    columns += _motion_columns("gap", contact.gap_by_motion(nodes), motions, ("1", "m/rad"))
    if contact.gap_by_shift_and_turn is not None:
        second = contact.gap_by_shift_and_turn(nodes)
        names = ("gap_by_shifts", "1/m"), ("gap_by_shift_and_turn", "1"), ("gap_by_turns", "m")
        columns += [Column(*n, v) for n, v in zip(names, second.T, strict=True)]
    meaning = f"contact of {contact.body_a} and {contact.body_b}"
    return _angle_table(meaning, contact, nodes, columns)


def _nodes(table: PeriodicTable) -> Array:
    count = table.values.shape[0]
    return table.period * np.arange(count) / count


def _angle_table(
    meaning: str,
    part: ChamberFamily | FlowPath | ContactPair,
    nodes: Array,
    columns: Sequence[Column],
) -> AngleTable:
    angle = Column("angle", "rad", nodes)
    return AngleTable(part.name, meaning, part.angle_ratio, part.phases, (angle, *columns))


def _channel_columns(names: Sequence[str], table: PeriodicTable) -> list[Column]:
    return [Column(n, _CHANNEL_UNITS[n], table.values[:, k]) for k, n in enumerate(names)]


def _motion_columns(
    name: str, values: Array, motions: Sequence[Motion], units: tuple[str, str]
) -> list[Column]:
    return [
        Column(
            f"{name}_by_{motion.body}_{motion.axis}",
            units[1] if motion.axis == "rotation" else units[0],
            values[:, k],
        )
        for k, motion in enumerate(motions)
    ]
