"""Periodic tables packed for compiled evaluation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from toothspace.core.compiled import kernel
from toothspace.core.types import Array, IntArray
from toothspace.numerics.periodic_table import PeriodicTable

OFFSET, NODES, CHANNELS = range(3)


class TableBank(NamedTuple):
    """Several periodic tables in one block of polynomial coefficients.

    Interval ``i`` of a table holds four rows of ``channels`` coefficients in the local
    coordinate t of 0 to 1: value = c0 + t (c1 + t (c2 + t c3)). Columns of ``layout`` are
    offset, nodes and channels of each table.
    """

    coefficients: Array
    layout: IntArray
    period: Array


class Members(NamedTuple):
    """Things that read one row of a table each: which table, phase and growth of its angle.

    Where the channel ``gate`` is zero the thing is closed and its other channels are not read.
    """

    table: IntArray
    phase: Array
    ratio: Array
    gate: IntArray


OPEN = -1
"""Gate of members that are never closed."""


def fill_constants(bank: TableBank, members: Members, values: Array) -> None:
    """Write the rows of members with constant tables, which :func:`fill_values` leaves alone."""
    for j, table in enumerate(members.table):
        offset, nodes, channels = bank.layout[table]
        if nodes == 1:
            values[j, :channels] = bank.coefficients[offset : offset + channels]


def pack_tables(tables: Sequence[PeriodicTable]) -> TableBank:
    """Pack tables into one bank, in their order."""
    tables = [_shortened(table) for table in tables]
    blocks = [_hermite_coefficients(table).ravel() for table in tables]
    offset = np.concatenate(([0], np.cumsum([block.size for block in blocks])[:-1]))
    shapes = np.array([table.values.shape for table in tables], dtype=np.int64)
    return TableBank(
        coefficients=np.concatenate(blocks),
        layout=np.column_stack([offset, shapes]).astype(np.int64),
        period=np.array([table.period for table in tables]),
    )


def _shortened(table: PeriodicTable) -> PeriodicTable:
    """Keep one node of a table that does not depend on the angle."""
    if np.any(table.slopes) or np.any(table.values != table.values[0]):
        return table
    return PeriodicTable(table.period, table.values[:1], table.slopes[:1])


def _hermite_coefficients(table: PeriodicTable) -> Array:
    step = table.period / table.values.shape[0]
    v0, v1 = table.values, np.roll(table.values, -1, axis=0)
    s0, s1 = step * table.slopes, step * np.roll(table.slopes, -1, axis=0)
    c2 = 3.0 * (v1 - v0) - 2.0 * s0 - s1
    c3 = s0 + s1 - 2.0 * (v1 - v0)
    return np.ascontiguousarray(np.stack([v0, s0, c2, c3], axis=1))


@kernel
def fill_values(
    bank: TableBank, members: Members, shaft_angle: float, values: Array, turns: IntArray
) -> None:
    """Evaluate all channels of every member's table, one row each, and the periods passed."""
    coefficients, layout, period = bank.coefficients, bank.layout, bank.period
    for j in range(members.table.size):
        table = members.table[j]
        nodes, channels = layout[table, NODES], layout[table, CHANNELS]
        if nodes == 1:
            continue
        turn = (members.phase[j] + members.ratio[j] * shaft_angle) / period[table]
        passed = np.floor(turn)
        position = (turn - passed) * nodes
        interval = min(int(position), nodes - 1)
        turns[j] = int(passed)
        t = position - interval
        base = layout[table, OFFSET] + interval * 4 * channels
        gate = members.gate[j]
        if gate >= 0:
            following = layout[table, OFFSET] + ((interval + 1) % nodes) * 4 * channels
            if coefficients[base + gate] == 0.0 and coefficients[following + gate] == 0.0:
                values[j, gate] = 0.0
                continue
        for k in range(channels):
            c0 = coefficients[base + k]
            c1 = coefficients[base + k + channels]
            c2 = coefficients[base + k + 2 * channels]
            c3 = coefficients[base + k + 3 * channels]
            values[j, k] = c0 + t * (c1 + t * (c2 + t * c3))


@kernel
def fill_slopes(bank: TableBank, members: Members, shaft_angle: float, slopes: Array) -> None:
    """Evaluate the derivatives of all channels with respect to the shaft angle."""
    coefficients, layout, period = bank.coefficients, bank.layout, bank.period
    for j in range(members.table.size):
        table = members.table[j]
        nodes, channels = layout[table, NODES], layout[table, CHANNELS]
        turn = (members.phase[j] + members.ratio[j] * shaft_angle) / period[table]
        position = (turn - np.floor(turn)) * nodes
        interval = min(int(position), nodes - 1)
        t = position - interval
        base = layout[table, OFFSET] + interval * 4 * channels
        gate = members.gate[j]
        if gate >= 0:
            following = layout[table, OFFSET] + ((interval + 1) % nodes) * 4 * channels
            if coefficients[base + gate] == 0.0 and coefficients[following + gate] == 0.0:
                continue
        scale = members.ratio[j] * nodes / period[table]
        for k in range(channels):
            c1 = coefficients[base + k + channels]
            c2 = coefficients[base + k + 2 * channels]
            c3 = coefficients[base + k + 3 * channels]
            slopes[j, k] = scale * (c1 + t * (2.0 * c2 + 3.0 * t * c3))
