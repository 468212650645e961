"""Hierarchy of a geometric multigrid for conduction on masked structured grids.

The operator is the conduction of a :class:`~toothspace.numerics.structured_grid.CellBalance` on
its free cells. Cells are merged in pairs along the directions in which they are strongly
coupled, so stretched grids need no line smoother; the coarsest level is inverted. The cycle
(:mod:`toothspace.numerics.multigrid_cycle`) works in single precision; the Krylov iteration
around it works in double precision. The fine level holds 22 bytes per cell.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from toothspace.core.compiled import inlined, njit
from toothspace.core.types import Array, BoolArray
from toothspace.numerics.chequerboard import Board, board_of, store, stored
from toothspace.numerics.multigrid_cycle import CHUNK, THREADS, Level, Single, board_in
from toothspace.numerics.structured_grid import CellBalance


class Conductances(NamedTuple):
    """Conductances between free cells, and from them to given potentials, per direction."""

    gx: Array
    gy: Array
    outer_x: Array
    outer_y: Array


class Hierarchy(NamedTuple):
    """Levels from fine to coarse, and the inverse of the coarsest operator."""

    levels: tuple[Level, ...]
    coarsest: Single


STRETCH = 3.0
"""Ratio of the couplings from which cells are merged in the strong direction only. [-]"""
SMALLEST = 6
"""Number of cells along a direction below which it is not merged further. [-]"""
COARSEST = 64
"""Number of cells up to which a level is inverted. [-]"""
FLOATING = 1e-5
"""Share of the diagonal that holds a coarsest grid without given potentials. [-]"""


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
def diagonal_of(c: Conductances) -> Array:
    """Sum of the conductances of every free cell, zero where not free."""
    rows, lanes = c.outer_x.shape
    out = np.empty((rows, lanes))
    for i in range(rows):
        for j in range(lanes):
            out[i, j] = c.gx[i, j] + c.gx[i + 1, j] + c.gy[i, j] + c.gy[i, j + 1]
            out[i, j] += c.outer_x[i, j] + c.outer_y[i, j]
    return out


def scaled(c: Conductances) -> tuple[Conductances, float]:
    """Conductances over a power of two near the largest, and that power."""
    largest = max(float(values.max()) for values in c)
    scale = 2.0 ** np.round(np.log2(largest)) if largest > 0.0 else 1.0
    return Conductances(*(values / scale for values in c)), float(scale)


def _merges(c: Conductances) -> tuple[int, int]:
    """Along which directions to merge: the strongly coupled ones that have cells left."""
    rows, lanes = c.outer_x.shape
    if rows * lanes <= COARSEST:
        return 1, 1
    along, across = float(c.gx.mean()), float(c.gy.mean())
    merge_x = 2 if along * STRETCH > across and rows > SMALLEST else 1
    merge_y = 2 if across * STRETCH > along and lanes > SMALLEST else 1
    if merge_x == merge_y == 1:
        return (2, 1) if rows > lanes else (1, 2)
    return merge_x, merge_y


def hierarchy(c: Conductances, ring: bool) -> Hierarchy:
    """Levels for conductances of order one, with work space for one right-hand side.

    Parameters
    ----------
    c : Conductances
        Of the finest grid, scaled so that single precision holds them. [any]
    ring : bool
        The last row is followed by the first.

    Returns
    -------
    Hierarchy
        Levels from fine to coarse, and the inverse of the coarsest operator.
    """
    levels = []
    while True:
        merges = _merges(c)
        rows, lanes = c.outer_x.shape
        levels.append(_level(c, board_of(rows, lanes, ring=ring), merges))
        if merges == (1, 1):
            inverse = np.linalg.inv(_matrix(c, ring))
            inverse *= diagonal_of(c).ravel()[:, None] > 0.0
            return Hierarchy(tuple(levels), inverse.astype(np.float32))
        c = _merge(c, *merges)


def _level(c: Conductances, board: Board, merges: tuple[int, int]) -> Level:
    gx, gy, inverse = (np.zeros(stored(board), dtype=np.float32) for _ in range(3))
    store(board, c.gx, gx)
    store(board, c.gy, gy)
    diagonal = diagonal_of(c)
    np.divide(1.0, diagonal, out=diagonal, where=diagonal > 0.0)
    store(board, diagonal, inverse)
    x, b, r, plain = _space(board, 1)
    work = np.zeros((max(1, THREADS), max(CHUNK, board.lanes + 2)), dtype=np.float32)
    return Level(*board, gx, gy, inverse, x, b, r, plain, work, *merges)


def _space(board: Board, sides: int) -> tuple[Single, Single, Single, Single]:
    """Work space of a level: solution, right-hand side, residual, values in rows."""
    colours, places = stored(board)
    shape = (sides, colours, places)
    x, b = np.zeros(shape, dtype=np.float32), np.zeros(shape, dtype=np.float32)
    r = np.zeros((sides, places), dtype=np.float32)
    return x, b, r, np.zeros((sides, board.rows, board.lanes + 2), dtype=np.float32)


@njit(cache=True)
def _matrix(c: Conductances, ring: bool) -> Array:
    """Operator of a small grid as a dense matrix, unity where not free."""
    rows, lanes = c.outer_x.shape
    out = np.zeros((rows * lanes, rows * lanes))
    total = diagonal_of(c).ravel()
    for k in range(rows * lanes):
        out[k, k] = total[k] * (1.0 + FLOATING) if total[k] > 0.0 else 1.0
    for k in range(rows * lanes):
        i, j = k // lanes, k % lanes
        east = (k + lanes) % (rows * lanes)
        if i + 1 < rows or ring:
            out[k, east] -= c.gx[i + 1, j]
            out[east, k] -= c.gx[i + 1, j]
        if j + 1 < lanes:
            out[k, k + 1] -= c.gy[i, j + 1]
            out[k + 1, k] -= c.gy[i, j + 1]
    return out


def for_sides(levels: tuple[Level, ...], sides: int) -> tuple[Level, ...]:
    """Levels with the same operators and work space for a number of right-hand sides."""
    return tuple(_with_space(level, sides) for level in levels)


def _with_space(level: Level, sides: int) -> Level:
    x, b, r, plain = _space(board_in(level), sides)
    return level._replace(x=x, b=b, r=r, plain=plain)
