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


class Reading(NamedTuple):
    """Things that read one row of a table each: which table, phase and growth of its angle.

    Where the channel ``gate`` is zero the thing is closed and its other channels are not read.
    """

    table: IntArray
    phase: Array
    ratio: Array
    gate: IntArray


class Members(NamedTuple):
    """Things that read one row of a table each, and where in their tables they stand.

    Parameters
    ----------
    table : ndarray of int
        Number of the table.
    phase, ratio : ndarray
        Angle of the table at shaft angle zero, and its growth. [rad], [-]
    gate : ndarray of int
        Where this channel is zero the thing is closed and its other channels are not read.
    origin, growth : ndarray
        Place in the table in nodes at shaft angle zero, and its growth per angle. [-], [1/rad]
    interval : ndarray
        Node below the present place, counted on beyond full turns; NaN at the start. [-]
    base : ndarray of int
        First coefficient of that interval; CLOSED where the thing is closed.
    turns : ndarray of int
        Periods passed.
    moving, open : ndarray of int
        Numbers of the things to be interpolated, and of all that are not closed; their
        count stands at the end.
    """

    table: IntArray
    phase: Array
    ratio: Array
    gate: IntArray
    origin: Array
    growth: Array
    interval: Array
    base: IntArray
    turns: IntArray
    moving: IntArray
    open: IntArray


OPEN = -1
"""Gate of members that are never closed."""

CLOSED = -1
"""Place of the coefficients of a closed member."""


def make_members(bank: TableBank, reading: Reading) -> Members:
    """Return members that stand nowhere yet."""
    table = np.asarray(reading.table, dtype=np.int64)
    count, nodes = table.size, bank.layout[table, NODES]
    return Members(
        table=table,
        phase=np.asarray(reading.phase, dtype=float),
        ratio=np.asarray(reading.ratio, dtype=float),
        gate=np.asarray(reading.gate, dtype=np.int64),
        origin=np.asarray(reading.phase * nodes / bank.period[table], dtype=float),
        growth=np.asarray(reading.ratio * nodes / bank.period[table], dtype=float),
        interval=np.full(count, np.nan),
        base=np.full(count, CLOSED),
        turns=np.zeros(count, dtype=np.int64),
        moving=np.zeros(count + 1, dtype=np.int64),
        open=np.zeros(count + 1, dtype=np.int64),
    )


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
    """Drop trailing channels of zeros, and all nodes but one if nothing depends on the angle."""
    used = np.flatnonzero(np.any(table.values, axis=0) | np.any(table.slopes, axis=0))
    channels = max(used[-1] + 1 if used.size else 0, min(2, table.values.shape[1]))
    values, slopes = table.values[:, :channels], table.slopes[:, :channels]
    nodes = len(values) if np.any(slopes) or np.any(values != values[0]) else 1
    return PeriodicTable(table.period, values[:nodes], slopes[:nodes])


def _hermite_coefficients(table: PeriodicTable) -> Array:
    step = table.period / table.values.shape[0]
    v0, v1 = table.values, np.roll(table.values, -1, axis=0)
    s0, s1 = step * table.slopes, step * np.roll(table.slopes, -1, axis=0)
    c2 = 3.0 * (v1 - v0) - 2.0 * s0 - s1
    c3 = s0 + s1 - 2.0 * (v1 - v0)
    return np.ascontiguousarray(np.stack([v0, s0, c2, c3], axis=1))


@kernel
def find_intervals(bank: TableBank, members: Members, shaft_angle: float, values: Array) -> bool:
    """Move members on to the intervals of a shaft angle; False if all stayed in theirs."""
    origin, growth, interval = members.origin, members.growth, members.interval
    moved = False
    for j in range(interval.size):
        place = origin[j] + growth[j] * shaft_angle
        if not 0.0 <= place - interval[j] < 1.0:
            interval[j] = np.floor(place)
            find_coefficients(bank, members, j)
            moved = True
    if moved:
        list_members(bank, members, values)
    return moved


@kernel
def find_coefficients(bank: TableBank, members: Members, j: int) -> None:
    """Point one member to the coefficients of its interval, or close it."""
    coefficients, table, gate = bank.coefficients, members.table[j], members.gate[j]
    nodes, channels = bank.layout[table, NODES], bank.layout[table, CHANNELS]
    passed = np.floor(members.interval[j] / nodes)
    number = min(max(int(members.interval[j] - passed * nodes), 0), nodes - 1)
    first = bank.layout[table, OFFSET]
    base = first + number * 4 * channels
    following = first + (number + 1) % nodes * 4 * channels
    members.turns[j] = int(passed)
    closed = gate >= channels
    if 0 <= gate < channels:
        closed = coefficients[base + gate] == 0.0 == coefficients[following + gate]
    members.base[j] = CLOSED if closed else base


@kernel
def list_members(bank: TableBank, members: Members, values: Array) -> None:
    """List the members to be interpolated and those that are not closed; close the gates."""
    moving, free = 0, 0
    for j in range(members.base.size):
        if members.base[j] == CLOSED:
            values[j, members.gate[j]] = 0.0
            continue
        members.open[free] = j
        free += 1
        if bank.layout[members.table[j], NODES] > 1:
            members.moving[moving] = j
            moving += 1
    members.moving[-1], members.open[-1] = moving, free


@kernel
def fill_values(bank: TableBank, members: Members, shaft_angle: float, values: Array) -> None:
    """Evaluate all channels of the open members' tables at the angle of their intervals."""
    coefficients, moving = bank.coefficients, members.moving
    for entry in range(moving[-1]):
        j = moving[entry]
        channels, base = bank.layout[members.table[j], CHANNELS], members.base[j]
        t = members.origin[j] + members.growth[j] * shaft_angle - members.interval[j]
        for k in range(channels):
            c0 = coefficients[base + k]
            c1 = coefficients[base + k + channels]
            c2 = coefficients[base + k + 2 * channels]
            c3 = coefficients[base + k + 3 * channels]
            values[j, k] = c0 + t * (c1 + t * (c2 + t * c3))


@kernel
def fill_slopes(bank: TableBank, members: Members, shaft_angle: float, slopes: Array) -> None:
    """Evaluate the derivatives of all channels with respect to the shaft angle."""
    coefficients, moving = bank.coefficients, members.moving
    for entry in range(moving[-1]):
        j = moving[entry]
        channels, base = bank.layout[members.table[j], CHANNELS], members.base[j]
        scale = members.growth[j]
        t = members.origin[j] + scale * shaft_angle - members.interval[j]
        for k in range(channels):
            c1 = coefficients[base + k + channels]
            c2 = coefficients[base + k + 2 * channels]
            c3 = coefficients[base + k + 3 * channels]
            slopes[j, k] = scale * (c1 + t * (2.0 * c2 + 3.0 * t * c3))
