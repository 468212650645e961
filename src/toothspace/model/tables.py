"""Periodic tables packed for compiled evaluation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from toothspace.core.compiled import njit
from toothspace.core.types import Array, IntArray
from toothspace.numerics.periodic_table import PeriodicTable


class TableBank(NamedTuple):
    """Several periodic tables in one block of polynomial coefficients.

    Interval ``i`` of a table holds four rows of ``channels`` coefficients in the local
    coordinate t of 0 to 1: value = c0 + t (c1 + t (c2 + t c3)).
    """

    coefficients: Array
    offset: IntArray
    nodes: IntArray
    channels: IntArray
    period: Array


def pack_tables(tables: Sequence[PeriodicTable]) -> TableBank:
    """Pack tables into one bank, in their order."""
    blocks = [_hermite_coefficients(table).ravel() for table in tables]
    sizes = [block.size for block in blocks]
    return TableBank(
        coefficients=np.concatenate(blocks) if blocks else np.zeros(0),
        offset=np.concatenate(([0], np.cumsum(sizes)[:-1])).astype(np.int64),
        nodes=np.array([table.values.shape[0] for table in tables], dtype=np.int64),
        channels=np.array([table.values.shape[1] for table in tables], dtype=np.int64),
        period=np.array([table.period for table in tables]),
    )


def _hermite_coefficients(table: PeriodicTable) -> Array:
    step = table.period / table.values.shape[0]
    v0, v1 = table.values, np.roll(table.values, -1, axis=0)
    s0, s1 = step * table.slopes, step * np.roll(table.slopes, -1, axis=0)
    c2 = 3.0 * (v1 - v0) - 2.0 * s0 - s1
    c3 = s0 + s1 - 2.0 * (v1 - v0)
    return np.ascontiguousarray(np.stack([v0, s0, c2, c3], axis=1))


@njit(cache=True)
def table_values(bank: TableBank, table: int, angle: float, out: Array) -> int:
    """Fill ``out`` with all channels at an angle; return the number of full periods passed."""
    nodes = bank.nodes[table]
    channels = bank.channels[table]
    turns = np.floor(angle / bank.period[table])
    position = (angle / bank.period[table] - turns) * nodes
    interval = min(int(position), nodes - 1)
    t = position - interval
    base = bank.offset[table] + interval * 4 * channels
    c = bank.coefficients
    for k in range(channels):
        i = base + k
        out[k] = c[i] + t * (c[i + channels] + t * (c[i + 2 * channels] + t * c[i + 3 * channels]))
    return int(turns)


@njit(cache=True)
def table_slopes(bank: TableBank, table: int, angle: float, out: Array) -> None:
    """Fill ``out`` with the derivatives of all channels with respect to the angle."""
    nodes = bank.nodes[table]
    channels = bank.channels[table]
    turns = np.floor(angle / bank.period[table])
    position = (angle / bank.period[table] - turns) * nodes
    interval = min(int(position), nodes - 1)
    t = position - interval
    base = bank.offset[table] + interval * 4 * channels
    scale = nodes / bank.period[table]
    c = bank.coefficients
    for k in range(channels):
        i = base + k
        out[k] = scale * (
            c[i + channels] + t * (2.0 * c[i + 2 * channels] + 3.0 * t * c[i + 3 * channels])
        )
