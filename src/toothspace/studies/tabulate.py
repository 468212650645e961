"""Records of points as datasets, JSON lists and tables."""

from __future__ import annotations

from collections.abc import Iterable, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from toothspace.results.variables import unit_of
from toothspace.studies.study import Record, StudyTable, failed_count
from toothspace.studies.variation import Axis

if TYPE_CHECKING:
    import xarray as xr

NOT_A_RESULT = ("wall_time_s",)
"""Summary numbers that say nothing about the machine."""


def number_names(records: Sequence[Record]) -> list[str]:
    """Return the names of the numbers that any record holds, in their order."""
    found: dict[str, None] = {}
    for record in records:
        for name, value in record.numbers.items():
            if isinstance(value, (int, float)) and not isinstance(value, bool):
                found[name] = None
    return [name for name in found if name not in NOT_A_RESULT]


def columns(records: Sequence[Record]) -> dict[str, list[float]]:
    """Return the numbers of records by name; NaN where a point has none."""
    return {name: [r.number(name) for r in records] for name in number_names(records)}


def numbers_table(
    name: str,
    values: Mapping[str, Sequence[float | str]],
    shown: Iterable[tuple[str, str]],
    records: Sequence[Record],
) -> StudyTable:
    """Build the table of the numbers that a study shows.

    Parameters
    ----------
    values : mapping
        Varied values of the points, by the heads of their columns.
    shown : iterable of (str, str)
        Names of numbers and heads of their columns.
    records : sequence of Record
        The points.
    """
    numbers = {head: [r.number(number) for r in records] for number, head in shown}
    return StudyTable.of(name, {**values, **numbers, "status": [r.status for r in records]})


def record_arrays(
    records: Sequence[Record], dimensions: Sequence[str] = ("point",), shape: Sequence[int] = (-1,)
) -> dict[str, Any]:
    """Return numbers with their units, and statuses, as variables of a dataset."""
    arrays = {
        name: (dimensions, np.asarray(values).reshape(shape), {"units": unit_of(name)})
        for name, values in columns(records).items()
    }
    statuses = np.asarray([r.status for r in records], dtype=str)
    return {**arrays, "point_status": (dimensions, statuses.reshape(shape))}


def points_dataset(
    axes: Sequence[Axis], rows: Sequence[Sequence[Any]], records: Sequence[Record]
) -> xr.Dataset:
    """Build the dataset over ``point``: varied keys, numbers and statuses."""
    import xarray as xr

    data: dict[str, Any] = {
        axis.path: ("point", np.asarray([row[k] for row in rows]), {"units": axis.unit or "1"})
        for k, axis in enumerate(axes)
    }
    data |= record_arrays(records)
    data["point_message"] = ("point", np.asarray([r.message for r in records], dtype=str))
    return xr.Dataset(data, coords={"point": np.arange(len(records))})


def map_dataset(
    axes: Mapping[str, tuple[Sequence[float], str]], records: Sequence[Record]
) -> xr.Dataset:
    """Build the dataset over the axes of a map: numbers and statuses.

    Parameters
    ----------
    axes : mapping
        Values and unit of every axis, the last one running fastest.
    records : sequence of Record
        Points of the map in that order.
    """
    import xarray as xr

    data = record_arrays(records, tuple(axes), [len(values) for values, _ in axes.values()])
    coords = {
        name: (name, np.asarray(values), {"units": unit}) for name, (values, unit) in axes.items()
    }
    return xr.Dataset(data, coords=coords)


def points_table(
    axes: Sequence[Axis], rows: Sequence[Sequence[Any]], records: Sequence[Record]
) -> StudyTable:
    """Build the table of all points."""
    names = number_names(records)
    head = [f"{axis.path} ({axis.unit})" if axis.unit else axis.path for axis in axes]
    lines = [
        (
            *(x if isinstance(x, str) else float(x) for x in row),
            *(r.number(name) for name in names),
            r.status,
            r.message,
        )
        for row, r in zip(rows, records, strict=True)
    ]
    return StudyTable("points", (*head, *names, "status", "message"), tuple(lines))


def point_lists(values: Mapping[str, Sequence[Any]], records: Sequence[Record]) -> dict[str, Any]:
    """Return what ``--json`` prints of points: their values and numbers, in their order."""
    return {
        "points": len(records),
        "points_failed": failed_count(records),
        **values,
        **{name: found for name, found in columns(records).items() if name not in values},
        "point_status": [r.status for r in records],
    }
