"""Periodic tables packed for compiled evaluation."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np

from toothspace.core.compiled import kernel, passed_by_address
from toothspace.core.types import Array, IntArray
from toothspace.model.contact_pair import ContactPair
from toothspace.model.machine_parts import ChamberFamily, FlowPath
from toothspace.numerics.periodic_table import PeriodicTable, cubic_coefficients

OFFSET, NODES, CHANNELS = range(3)


@passed_by_address
class TableBank(NamedTuple):
    """Several periodic tables in one block of polynomial coefficients.

    Interval ``i`` of a table holds four rows of ``channels`` coefficients in the local
    coordinate t of 0 to 1: value = c0 + t (c1 + t (c2 + t c3)). Columns of ``layout`` are
    offset, nodes and channels of each table.
    """

    coefficients: Array
    layout: IntArray
    period: Array


@passed_by_address
class Members(NamedTuple):
    """Things that read one row of a table each, and where in their tables they stand."""

    table: IntArray
    phase: Array
    ratio: Array
    """Number of the table, its angle at shaft angle zero [rad] and the growth of that. Shape
    (members,). [-]
    """
    gate: IntArray
    packed: int
    """Channel that says by zero that a member is closed, so that others are not read; whether
    closed members are left out altogether.
    """
    origin: Array
    growth: Array
    """Place in the table in nodes at shaft angle zero, and its growth per angle. Shape (members,).
    [-], [1/rad]
    """
    interval: Array
    place: Array
    """Node below the present place, counted on beyond full turns (NaN at the start), and the place
    beyond that node, 0 to 1. Shape (members,). [-]
    """
    last: IntArray
    """Count of members up to the last that has this channel. Shape (channels,)."""
    turns: IntArray
    closed: IntArray
    """Periods passed, and CLOSED where the gate is zero over the interval, else OPEN. Other
    channels of closed members are left as they were. Shape (members,).
    """
    open: IntArray
    """Numbers of the members that are read: those that are not closed, or all if not packed. Their
    count stands at the end, and rows of values follow their order. Shape (members + 1,).
    """
    seat: IntArray
    """Place among the members that are read. Shape (members,)."""
    cubic: Array
    here: Array
    """Coefficients of the present intervals and places in them, by seat. Shapes (channels, 4,
    members) and (members,).
    """
    reach: IntArray
    """Count of seats up to the last that has this channel. Shape (channels,)."""
    channels: IntArray
    row: IntArray
    moved: IntArray
    """Channels of the table of each member, place of its interval in the bank, and numbers of the
    members that went on to another interval. Shape (members,).
    """


OPEN = -1
"""Gate of members that are never closed, and mark of those that are open."""

CLOSED, UNKNOWN = 1, 0


def make_members(
    bank: TableBank,
    parts: Sequence[ChamberFamily | FlowPath | ContactPair],
    first_table: int,
    gate: Sequence[int],
    packed: bool = False,
) -> Members:
    """Return the members of parts, which stand nowhere yet.

    Parameters
    ----------
    bank : TableBank
        Tables.
    parts : sequence of ChamberFamily, FlowPath or ContactPair
        Parts of one kind; each has a table, or one for each of its members.
    first_table : int
        Number of their first table.
    gate : sequence of int
        Gate of the members of each part.
    packed : bool
        Whether closed members are left out.
    """
    counts = [part.count for part in parts]
    # number of the table that each member reads
    first = first_table
    numbers = []
    for count, tables in zip(counts, [len(part.own) for part in parts], strict=True):
        numbers.append(first + (np.arange(count) if tables else np.zeros(count, dtype=np.int64)))
        first += max(tables, 1)
    table = np.concatenate([*numbers, np.zeros(0)]).astype(np.int64)
    phase = np.concatenate([*(part.phases for part in parts), np.zeros(0)])
    ratio = np.repeat([float(part.angle_ratio) for part in parts], counts)
    count, nodes = table.size, bank.layout[table, NODES]
    channels = bank.layout[table, CHANNELS]
    most = int(channels.max(initial=0))
    having = [np.flatnonzero(channels > k) for k in range(most)]
    return Members(
        table=table,
        phase=phase,
        ratio=ratio,
        gate=np.repeat(np.asarray(gate, dtype=np.int64), counts),
        packed=int(packed),
        origin=np.asarray(phase * nodes / bank.period[table], dtype=float),
        growth=np.asarray(ratio * nodes / bank.period[table], dtype=float),
        interval=np.full(count, np.nan),
        place=np.zeros(count),
        last=np.array([members[-1] + 1 for members in having], dtype=np.int64),
        turns=np.zeros(count, dtype=np.int64),
        closed=np.full(count, UNKNOWN),
        open=np.zeros(count + 1, dtype=np.int64),
        seat=np.zeros(count, dtype=np.int64),
        cubic=np.zeros((most, 4, count)),
        here=np.zeros(count),
        reach=np.zeros(most, dtype=np.int64),
        channels=channels,
        row=np.zeros(count, dtype=np.int64),
        moved=np.zeros(count, dtype=np.int64),
    )


def pack_tables(tables: Sequence[PeriodicTable]) -> TableBank:
    """Pack tables into one bank, in their order."""
    shortened = []
    for table in tables:
        # without trailing channels of zeros, and one node if nothing depends on the angle
        used = np.flatnonzero(np.any(table.values, axis=0) | np.any(table.slopes, axis=0))
        channels = max(used[-1] + 1 if used.size else 0, min(2, table.values.shape[1]))
        values, slopes = table.values[:, :channels], table.slopes[:, :channels]
        nodes = len(values) if np.any(slopes) or np.any(values != values[0]) else 1
        shortened.append(PeriodicTable(table.period, values[:nodes], slopes[:nodes]))
    tables = shortened
    blocks = []
    for table in tables:
        v, s = table.values, table.period / table.values.shape[0] * table.slopes
        ends = np.roll(v, -1, axis=0), s, np.roll(s, -1, axis=0)
        blocks.append(np.stack(cubic_coefficients(v, *ends), axis=1).ravel())
    offset = np.concatenate(([0], np.cumsum([block.size for block in blocks])[:-1]))
    shapes = np.array([table.values.shape for table in tables], dtype=np.int64)
    return TableBank(
        coefficients=np.concatenate(blocks),
        layout=np.column_stack([offset, shapes]).astype(np.int64),
        period=np.array([table.period for table in tables]),
    )


@kernel
def find_intervals(bank: TableBank, members: Members, shaft_angle: float) -> bool:
    """Move members on to the intervals of a shaft angle; True if one opened, closed or turned."""
    origin, growth, interval = members.origin, members.growth, members.interval
    place = members.place
    outside = 0
    for j in range(place.size):
        place[j] = origin[j] + growth[j] * shaft_angle - interval[j]
        outside += 0 if (place[j] >= 0.0) & (place[j] < 1.0) else 1
    changed = outside > 0 and move_on(bank, members, shaft_angle)
    for seat in range(members.open[-1]):
        members.here[seat] = place[members.open[seat]]
    return changed


@kernel
def move_on(bank: TableBank, members: Members, shaft_angle: float) -> bool:
    """Find and read the intervals of the members that left theirs."""
    origin, growth, interval = members.origin, members.growth, members.interval
    place = members.place
    changed = False
    moved = 0
    for j in range(place.size):
        if not 0.0 <= place[j] < 1.0:
            position = origin[j] + growth[j] * shaft_angle
            interval[j] = np.floor(position)
            place[j] = position - interval[j]
            if find_row(bank, members, j):
                changed = True
            if members.closed[j] == OPEN:
                members.moved[moved] = j
                moved += 1
    if changed:
        list_open(members)
        if members.packed > 0:
            moved = members.open[-1]
            for seat in range(moved):
                members.moved[seat] = members.open[seat]
    read_intervals(bank, members, moved)
    return changed


@kernel
def find_row(bank: TableBank, members: Members, j: int) -> bool:
    """Find one member's interval in the bank; True if the member opened, closed or turned."""
    coefficients, table, gate = bank.coefficients, members.table[j], members.gate[j]
    nodes, channels = bank.layout[table, NODES], bank.layout[table, CHANNELS]
    passed = np.floor(members.interval[j] / nodes)
    number = min(max(int(members.interval[j] - passed * nodes), 0), nodes - 1)
    first = bank.layout[table, OFFSET]
    base = first + number * 4 * channels
    following = base + 4 * channels if number + 1 < nodes else first
    members.row[j] = base
    closed = CLOSED if gate >= channels else OPEN
    if 0 <= gate < channels and coefficients[base + gate] == 0.0 == coefficients[following + gate]:
        closed = CLOSED
    changed = closed != members.closed[j] or int(passed) != members.turns[j]
    members.closed[j], members.turns[j] = closed, int(passed)
    if closed == CLOSED and changed and gate < channels and members.packed == 0:
        for power in range(4):
            members.cubic[gate, power, j] = 0.0
    return changed


@kernel
def read_intervals(bank: TableBank, members: Members, moved: int) -> None:
    """Copy the coefficients of the members that moved on, channel by channel."""
    for k in range(members.last.size):
        for entry in range(moved):
            j = members.moved[entry]
            seat, channels, base = members.seat[j], members.channels[j], members.row[j] + k
            if seat >= members.reach[k]:
                break
            for power in range(4):
                there = bank.coefficients[base + power * channels] if k < channels else 0.0
                members.cubic[k, power, seat] = there


@kernel
def list_open(members: Members) -> None:
    """List the members that are read, and how many of them each channel reaches."""
    count = 0
    for j in range(members.closed.size):
        members.seat[j] = count
        if members.closed[j] == OPEN or members.packed == 0:
            members.open[count] = j
            count += 1
    members.open[-1] = count
    for k in range(members.last.size):
        last = members.last[k]
        members.reach[k] = members.seat[last] if last < members.seat.size else count


@kernel
def fill_values(members: Members, values: Array) -> None:
    """Evaluate all channels of the members that are read; values has one row for each seat."""
    here, columns = members.here, values.T
    for k in range(members.last.size):
        c0, c1 = members.cubic[k, 0], members.cubic[k, 1]
        c2, c3 = members.cubic[k, 2], members.cubic[k, 3]
        column = columns[k]
        for j in range(members.reach[k]):
            t = here[j]
            column[j] = c0[j] + t * (c1[j] + t * (c2[j] + t * c3[j]))


@kernel
def fill_slopes(members: Members, slopes: Array) -> None:
    """Evaluate the derivatives of all channels with respect to the shaft angle."""
    here, growth, columns = members.here, members.growth, slopes.T
    for k in range(members.last.size):
        c1, c2, c3 = members.cubic[k, 1], members.cubic[k, 2], members.cubic[k, 3]
        column = columns[k]
        for j in range(members.reach[k]):
            t = here[j]
            column[j] = growth[members.open[j]] * (c1[j] + t * (2.0 * c2[j] + 3.0 * t * c3[j]))
