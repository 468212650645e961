"""Geometric multigrid for conduction on masked structured grids, as a preconditioner.

The operator is the conduction of a :class:`~toothspace.numerics.structured_grid.CellBalance` on
its free cells. Cells are merged in pairs along the directions in which they are strongly
coupled, so stretched grids need no line smoother. One cycle works in single precision; the
Krylov iteration around it works in double precision. The fine level holds 32 bytes per cell.
"""

from __future__ import annotations

import os
import threading
from itertools import pairwise
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from toothspace.core.compiled import inlined, njit, prange
from toothspace.core.types import Array, BoolArray
from toothspace.numerics.structured_grid import CellBalance

Single = NDArray[np.float32]


class Conductances(NamedTuple):
    """Conductances between free cells, and from them to given potentials, per direction."""

    gx: Array
    gy: Array
    outer_x: Array
    outer_y: Array


STRETCH = 3.0
"""Ratio of the couplings from which cells are merged in the strong direction only. [-]"""
SMALLEST = 6
"""Number of cells along a direction below which it is not merged further. [-]"""
PARALLEL_CELLS = 30000
"""Number of cells of a grid from which several threads pay. [-]"""
THREADS = int(os.environ.get("TOOTHSPACE_THREADS", min(2, os.cpu_count() or 1)))
"""Threads of one cycle. [-]"""
# waiting threads must sleep: on a busy machine spinning ones take the time of those that work
os.environ.setdefault("OMP_WAIT_POLICY", "passive")
_ONE_AT_A_TIME = threading.Lock()
"""Numba's simplest threading layer ends the program if two threads start parallel loops."""
COARSEST_SWEEPS = 24
"""Pairs of sweeps on the coarsest grid. [-]"""


class Level(NamedTuple):
    """One grid of the hierarchy."""

    gx: Single  # (rows + 1, lanes) conductances between free cells
    gy: Single  # (rows, lanes + 1)
    inverse: Single  # (rows, lanes) inverse diagonal, zero where not free
    x: Single  # (sides, rows, lanes), as many as right-hand sides are solved together
    b: Single  # (sides, rows, lanes)
    r: Single  # (sides, rows, lanes)
    ring: bool
    merge_x: int  # cells of this grid that one coarser cell holds along each direction
    merge_y: int


@inlined
def _share(
    conductance: float, first: bool, second: bool, outer_first: float, outer_second: float
) -> tuple[float, float, float]:
    """Conductance between two free cells, or what each free one has towards the outside."""
    if first and second:
        return conductance, outer_first, outer_second
    if first:
        return 0.0, outer_first + conductance, outer_second
    if second:
        return 0.0, outer_first, outer_second + conductance
    return 0.0, outer_first, outer_second


@njit(cache=True)
def finest_grid(b: CellBalance, free: BoolArray) -> Conductances:
    """Conductances of the finest grid; its arrays of the outside have a border of one cell."""
    rows, lanes = free.shape
    gx = np.zeros((rows + 1, lanes))
    gy = np.zeros((rows, lanes + 1))
    known = np.zeros((rows + 2, lanes + 2), dtype=np.bool_)
    known[1:-1, 1:-1] = free
    if b.ring:
        known[0], known[-1] = known[-2], known[1]
    ox, oy = np.zeros((rows + 2, lanes + 2)), np.zeros((rows + 2, lanes + 2))
    for i in range(rows + 1):
        for j in range(lanes):
            k = j + 1
            gx[i, j], ox[i, k], ox[i + 1, k] = _share(
                b.conductance_x[i, j], known[i, k], known[i + 1, k], ox[i, k], ox[i + 1, k]
            )
    for i in range(rows):
        for j in range(lanes + 1):
            k = i + 1
            gy[i, j], oy[k, j], oy[k, j + 1] = _share(
                b.conductance_y[i, j], known[k, j], known[k, j + 1], oy[k, j], oy[k, j + 1]
            )
    return Conductances(gx, gy, ox[1:-1, 1:-1].copy(), oy[1:-1, 1:-1].copy())


@njit(cache=True)
def _merge(fine: Conductances, merge_x: int, merge_y: int) -> Conductances:
    """Conductances of merged cells: longer paths in series, faces side by side in parallel."""
    rows, lanes = fine.outer_x.shape
    coarse_rows, coarse_lanes = (rows + merge_x - 1) // merge_x, (lanes + merge_y - 1) // merge_y
    gx = np.zeros((coarse_rows + 1, coarse_lanes))
    gy = np.zeros((coarse_rows, coarse_lanes + 1))
    outer_x, outer_y = np.zeros((coarse_rows, coarse_lanes)), np.zeros((coarse_rows, coarse_lanes))
    for i in range(coarse_rows + 1):
        k = min(merge_x * i, rows)
        for j in range(lanes):
            gx[i, j // merge_y] += fine.gx[k, j] / merge_x
    for i in range(rows):
        for j in range(coarse_lanes + 1):
            gy[i // merge_x, j] += fine.gy[i, min(merge_y * j, lanes)] / merge_y
    for i in range(rows):
        for j in range(lanes):
            outer_x[i // merge_x, j // merge_y] += fine.outer_x[i, j] / merge_x
            outer_y[i // merge_x, j // merge_y] += fine.outer_y[i, j] / merge_y
    return Conductances(gx, gy, outer_x, outer_y)


@njit(cache=True)
def _inverse_diagonal(c: Conductances, scale: float) -> Single:
    rows, lanes = c.outer_x.shape
    out = np.zeros((rows, lanes), dtype=np.float32)
    for i in range(rows):
        for j in range(lanes):
            total = c.gx[i, j] + c.gx[i + 1, j] + c.gy[i, j] + c.gy[i, j + 1]
            total += c.outer_x[i, j] + c.outer_y[i, j]
            if total > 0.0:
                out[i, j] = scale / total
    return out


def _level(c: Conductances, scale: float, ring: bool, merges: tuple[int, int]) -> Level:
    shape = c.outer_x.shape
    x, b, r = (np.zeros((1, *shape), dtype=np.float32) for _ in range(3))
    gx, gy = (c.gx / scale).astype(np.float32), (c.gy / scale).astype(np.float32)
    return Level(gx, gy, _inverse_diagonal(c, scale), x, b, r, ring, merges[0], merges[1])


def _merges(c: Conductances) -> tuple[int, int]:
    """Along which directions to merge: the strongly coupled ones that have cells left."""
    along, across = float(c.gx.mean()), float(c.gy.mean())
    rows, lanes = c.outer_x.shape
    merge_x = 2 if along * STRETCH > across and rows > SMALLEST else 1
    merge_y = 2 if across * STRETCH > along and lanes > SMALLEST else 1
    if merge_x == merge_y == 1 and max(rows, lanes) > SMALLEST:
        return (2, 1) if rows > lanes else (1, 2)
    return merge_x, merge_y


def build_hierarchy(balance: CellBalance, free: BoolArray) -> tuple[tuple[Level, ...], float]:
    """Levels for the conductive part of a balance on its free cells.

    Parameters
    ----------
    balance : CellBalance
        Coefficients. [any]
    free : ndarray of bool
        Cells whose potential is unknown; all others stand at a given potential. [-]

    Returns
    -------
    tuple
        Levels from fine to coarse, and the conductance that they are scaled with. [any]
    """
    return hierarchy(finest_grid(balance, free), balance.ring)


def hierarchy(c: Conductances, ring: bool) -> tuple[tuple[Level, ...], float]:
    """Build the levels from the finest down, and the scale of their conductances."""
    scale = max(float(values.max()) for values in c)
    levels = []
    while True:
        merges = _merges(c)
        levels.append(_level(c, scale, ring, merges))
        if merges == (1, 1):
            return tuple(levels), scale
        c = _merge(c, *merges)


def for_sides(levels: tuple[Level, ...], sides: int) -> tuple[Level, ...]:
    """Levels with the same operators and work space for a number of right-hand sides."""
    return tuple(_with_space(level, sides) for level in levels)


def _with_space(level: Level, sides: int) -> Level:
    shape = (sides, *level.inverse.shape)
    x, b, r = (np.zeros(shape, dtype=np.float32) for _ in range(3))
    return level._replace(x=x, b=b, r=r)


@inlined
def neighbour_rows(i: int, rows: int, ring: bool) -> tuple[int, int]:
    """Rows west and east of a row; at a border the row itself, where no conductance leads on."""
    west, east = i - 1, i + 1
    if west < 0:
        west = rows - 1 if ring else 0
    if east == rows:
        east = 0 if ring else rows - 1
    return west, east


@inlined
def _row_balance(level: Level, side: int, i: int, west: int, east: int, out: Single) -> None:
    """Right-hand side plus what the neighbours conduct to the cells of one row."""
    x, gy = level.x[side, i], level.gy[i]
    x_west, x_east = level.x[side, west], level.x[side, east]
    g_west, g_east = level.gx[i], level.gx[i + 1]
    b = level.b[side, i]
    last = x.size - 1
    for j in range(x.size):
        out[j] = b[j] + g_west[j] * x_west[j] + g_east[j] * x_east[j]
    if last > 0:
        lower, upper = x[:last], x[1:]
        between = gy[1 : last + 1]
        for j in range(last):
            out[j] += between[j] * upper[j]
        tail = out[1:]
        for j in range(last):
            tail[j] += between[j] * lower[j]


@njit(cache=True, parallel=True, fastmath={"contract"})
def _relax(level: Level, colour: int) -> None:
    """Gauss-Seidel on the cells of one colour of the chequerboard."""
    x, inverse = level.x, level.inverse
    rows, lanes = inverse.shape
    for row in prange(rows):
        i = np.int64(row)
        west, east = neighbour_rows(i, rows, level.ring)
        total = np.empty(lanes, dtype=np.float32)
        for k in range(x.shape[0]):
            _row_balance(level, k, i, west, east, total)
            for j in range((i + colour) % 2, lanes, 2):
                x[k, i, j] = total[j] * inverse[i, j]


@njit(cache=True, parallel=True, fastmath={"contract"})
def _remainder(level: Level, colour: int) -> None:
    """Residual into ``r`` of the cells of one colour; those relaxed last have none."""
    x, inverse, r = level.x, level.inverse, level.r
    rows, lanes = inverse.shape
    for row in prange(rows):
        i = np.int64(row)
        west, east = neighbour_rows(i, rows, level.ring)
        total = np.empty(lanes, dtype=np.float32)
        for k in range(x.shape[0]):
            _row_balance(level, k, i, west, east, total)
            for j in range(lanes):
                r[k, i, j] = 0.0
            for j in range((i + colour) % 2, lanes, 2):
                if inverse[i, j] > 0.0:
                    r[k, i, j] = total[j] - x[k, i, j] / inverse[i, j]


@njit(cache=True)
def _other(index: int, merge: int, count: int, ring: bool) -> int:
    """Second coarse cell that a fine cell lies next to, itself at a border."""
    home = index // merge
    if merge == 1:
        return home
    other = home - 1 if index % 2 == 0 else home + 1
    if other < 0:
        return count - 1 if ring else 0
    if other >= count:
        return 0 if ring else count - 1
    return other


@inlined
def _gather_lanes(values: Single, merge: int, out: Single) -> None:
    """Adjoint of :func:`_spread_lanes` for one row."""
    near, far = np.float32(0.75), np.float32(0.25)
    count, lanes = out.size, values.size
    if merge == 1:
        for m in range(count):
            out[m] = values[m]
        return
    pairs = lanes // 2
    for m in range(pairs):
        out[m] = near * (values[2 * m] + values[2 * m + 1])
    if lanes % 2:
        out[count - 1] = near * values[lanes - 1]
    for m in range(1, count):
        out[m] += far * values[2 * m - 1]
    for m in range(count - 1):
        out[m] += far * values[2 * m + 2]
    out[0] += far * values[0]
    out[count - 1] += far * values[lanes - 1] if lanes % 2 == 0 else np.float32(0.0)


@inlined
def _spread_lanes(values: Single, merge: int, out: Single) -> None:
    """Interpolate one row from coarse to fine centres, constant beyond the outermost."""
    near, far = np.float32(0.75), np.float32(0.25)
    count, lanes = values.size, out.size
    if merge == 1:
        for j in range(lanes):
            out[j] = values[j]
        return
    out[0] = values[0]
    for m in range(1, count):
        out[2 * m] = near * values[m] + far * values[m - 1]
    for m in range(count - 1):
        out[2 * m + 1] = near * values[m] + far * values[m + 1]
    if lanes % 2 == 0:
        out[lanes - 1] = values[count - 1]


@njit(cache=True, fastmath={"contract"})
def _restrict(fine: Level, coarse: Level) -> None:
    """Adjoint of :func:`_prolong`."""
    b, r = coarse.b, fine.r
    sides, count_x, count_y = b.shape
    near = np.float32(0.75 if fine.merge_x == 2 else 1.0)
    far = np.float32(1.0) - near
    b[:] = 0.0
    row = np.empty(count_y, dtype=np.float32)
    for k in range(sides):
        for i in range(r.shape[1]):
            _gather_lanes(r[k, i], fine.merge_y, row)
            home = b[k, i // fine.merge_x]
            other = b[k, _other(i, fine.merge_x, count_x, fine.ring)]
            for m in range(row.size):
                home[m] += near * row[m]
            for m in range(row.size):
                other[m] += far * row[m]


@njit(cache=True, parallel=True, fastmath={"contract"})
def _prolong(fine: Level, coarse: Level) -> None:
    """Add the coarse correction, bilinear between the centres of coarse cells."""
    x, inverse, target = coarse.x, fine.inverse, fine.x
    rows, lanes = inverse.shape
    sides, count_x, count_y = x.shape
    near = np.float32(0.75 if fine.merge_x == 2 else 1.0)
    far = np.float32(1.0) - near
    for row in prange(rows):
        i = np.int64(row)
        beyond = _other(i, fine.merge_x, count_x, fine.ring)
        mixed = np.empty(count_y, dtype=np.float32)
        spread = np.empty(lanes, dtype=np.float32)
        for k in range(sides):
            home, other = x[k, i // fine.merge_x], x[k, beyond]
            for m in range(count_y):
                mixed[m] = near * home[m] + far * other[m]
            _spread_lanes(mixed, fine.merge_y, spread)
            for j in range(lanes):
                target[k, i, j] += spread[j] if inverse[i, j] > 0.0 else np.float32(0.0)


@njit(cache=True)
def _descend(fine: Level, coarse: Level) -> None:
    """Smooth a level from zero and hand its residual down."""
    fine.x[:] = 0.0
    for colour in (0, 1, 0, 1):
        _relax(fine, colour)
    _remainder(fine, 0)
    _restrict(fine, coarse)


@njit(cache=True)
def _ascend(fine: Level, coarse: Level) -> None:
    """Take the coarse correction and smooth in reversed order."""
    _prolong(fine, coarse)
    for colour in (1, 0, 1, 0):
        _relax(fine, colour)


@njit(cache=True)
def _solve_coarsest(level: Level) -> None:
    level.x[:] = 0.0
    for _ in range(COARSEST_SWEEPS):
        _relax(level, 0)
        _relax(level, 1)
    for _ in range(COARSEST_SWEEPS):
        _relax(level, 1)
        _relax(level, 0)


def cycle(levels: tuple[Level, ...]) -> None:
    """One symmetric V-cycle on every ``b`` of the finest level, results in ``x``."""
    with _ONE_AT_A_TIME:
        _cycle(levels)


def _cycle(levels: tuple[Level, ...]) -> None:
    before = numba.get_num_threads()
    for fine, coarse in pairwise(levels):
        _use_threads(fine, before)
        _descend(fine, coarse)
    _use_threads(levels[-1], before)
    _solve_coarsest(levels[-1])
    for coarse, fine in pairwise(reversed(levels)):
        _use_threads(fine, before)
        _ascend(fine, coarse)
    numba.set_num_threads(before)


def _use_threads(level: Level, available: int) -> None:
    numba.set_num_threads(min(THREADS, available) if level.x.size >= PARALLEL_CELLS else 1)
