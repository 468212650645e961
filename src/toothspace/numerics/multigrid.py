"""Hierarchy of a geometric multigrid for conduction on masked structured grids.

The operator is the conduction of a :class:`~toothspace.numerics.structured_grid.CellBalance` on
its free cells. Cells are merged in pairs along the directions in which they are strongly
coupled, so stretched grids need no line smoother; the coarsest level is inverted. The cycle
(:mod:`toothspace.numerics.multigrid_cycle`) works in single precision; the Krylov iteration
(:mod:`toothspace.numerics.krylov`) around it works in double precision. The fine level holds
22 bytes per cell.
"""

from __future__ import annotations

from typing import NamedTuple, final

import numpy as np

from toothspace.core.compiled import inlined, njit
from toothspace.core.processes import threads
from toothspace.core.types import Array, BoolArray
from toothspace.numerics.colouring import ColouredGrid, coloured_grid, fetch, store, stored
from toothspace.numerics.multigrid_cycle import CHUNK, Level, Single, cycle, grid_of
from toothspace.numerics.structured_grid import CellBalance
from toothspace.numerics.vectors import norm


class _Conductances(NamedTuple):
    """Conductances between free cells, and from them to given potentials, per direction."""

    gx: Array
    gy: Array
    outer_x: Array
    outer_y: Array


STRETCH = 3.0
"""Ratio of the couplings from which cells are merged in the strong direction only. [-]"""
SMALLEST = 6
"""Number of cells along a direction below which it is not merged further. [-]"""
COARSEST = 64
"""Number of cells up to which a level is inverted. [-]"""
OUTER = 0.6
"""Part of a conductance to a given potential that is left when cells are merged. [-]

A given cell is then three halves of a cell away instead of one (2/3), the rim of the grid a whole
cell instead of half a one (1/2).
"""
FLOATING = 1e-5
"""Share of the diagonal that holds a coarsest grid without given potentials. [-]"""


@njit(nogil=True)
def _known(free: BoolArray, ring: bool) -> Array:
    """One where free, zero elsewhere, with a border of one cell."""
    rows, lanes = free.shape
    known = np.zeros((rows + 2, lanes + 2))
    known[1:-1, 1:-1] = free
    if ring:
        known[0], known[-1] = known[-2], known[1]
    return known


@njit(nogil=True)
def _finest_grid(b: CellBalance, free: BoolArray, scale: float) -> _Conductances:
    """Conductances of the finest grid over a scale."""
    rows, lanes = free.shape
    unit, known = 1.0 / scale, _known(free, b.ring)
    gx, gy = np.zeros((rows + 1, lanes)), np.zeros((rows, lanes + 1))
    outer_x, outer_y = np.zeros((rows, lanes)), np.zeros((rows, lanes))
    for i in range(rows + 1):
        west, east = known[i, 1:], known[i + 1, 1:]
        given, out = b.conductance_x[i], gx[i]
        for j in range(lanes):
            out[j] = unit * given[j] * (west[j] * east[j])
    for i in range(rows):
        own, west, east = known[i + 1, 1:], known[i, 1:], known[i + 2, 1:]
        g_west, g_east, out = b.conductance_x[i], b.conductance_x[i + 1], outer_x[i]
        for j in range(lanes):
            out[j] = g_west[j] * (own[j] - own[j] * west[j])
        for j in range(lanes):
            out[j] = unit * (out[j] + g_east[j] * (own[j] - own[j] * east[j]))
    for i in range(rows):
        row, given, between, out = known[i + 1], b.conductance_y[i], gy[i], outer_y[i]
        for j in range(lanes + 1):
            between[j] = unit * given[j] * (row[j] * row[j + 1])
        for j in range(lanes):
            lost = given[j] * (1.0 - row[j]) + given[j + 1] * (1.0 - row[j + 2])
            out[j] = unit * lost * row[j + 1]
    return _Conductances(gx, gy, outer_x, outer_y)


@inlined
def _add_merged(given: Array, factor: float, merge: int, out: Array) -> None:
    """Add the sums over merged lanes of one row."""
    if merge == 1:
        for j in range(given.size):
            out[j] += factor * given[j]
        return
    behind = given[1:]
    for j in range(given.size // 2):
        out[j] += factor * (given[2 * j] + behind[2 * j])
    if given.size % 2 == 1:
        out[out.size - 1] += factor * given[given.size - 1]


@njit(nogil=True)
def _merge(fine: _Conductances, merge_x: int, merge_y: int) -> _Conductances:
    """Conductances of merged cells: longer paths in series, faces side by side in parallel."""
    rows, lanes = fine.outer_x.shape
    coarse_rows, coarse_lanes = (rows + merge_x - 1) // merge_x, (lanes + merge_y - 1) // merge_y
    gx = np.zeros((coarse_rows + 1, coarse_lanes))
    gy = np.zeros((coarse_rows, coarse_lanes + 1))
    outer_x, outer_y = np.zeros((coarse_rows, coarse_lanes)), np.zeros((coarse_rows, coarse_lanes))
    along, across = 1.0 / merge_x, 1.0 / merge_y
    for i in range(coarse_rows + 1):
        _add_merged(fine.gx[min(merge_x * i, rows)], along, merge_y, gx[i])
    for i in range(rows):
        k = i // merge_x
        out, given = gy[k], fine.gy[i]
        for j in range(coarse_lanes):
            out[j] += across * given[merge_y * j]
        out[coarse_lanes] += across * given[lanes]
        _add_merged(fine.outer_x[i], OUTER if merge_x == 2 else 1.0, merge_y, outer_x[k])
        _add_merged(fine.outer_y[i], OUTER if merge_y == 2 else 1.0, merge_y, outer_y[k])
    return _Conductances(gx, gy, outer_x, outer_y)


@njit(nogil=True)
def _diagonal_of(c: _Conductances) -> Array:
    """Sum of the conductances of every free cell, zero where not free."""
    rows, lanes = c.outer_x.shape
    out = np.empty((rows, lanes))
    for i in range(rows):
        total, west, east, between = out[i], c.gx[i], c.gx[i + 1], c.gy[i]
        outer_x, outer_y = c.outer_x[i], c.outer_y[i]
        for j in range(lanes):
            total[j] = west[j] + east[j] + between[j] + between[j + 1] + outer_x[j] + outer_y[j]
    return out


def _merges(c: _Conductances) -> tuple[int, int]:
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


def _hierarchy(c: _Conductances, ring: bool) -> tuple[tuple[Level, ...], Single]:
    """Levels from fine to coarse, and the inverse of the operator of the last one."""
    levels: list[Level] = []
    while True:
        merges = _merges(c)
        rows, lanes = c.outer_x.shape
        finest = not levels and merges != (1, 1)
        levels.append(_level(c, coloured_grid(rows, lanes, ring=ring), merges, plain=not finest))
        if merges == (1, 1):
            inverse = np.linalg.inv(_matrix(c, ring))
            inverse *= _diagonal_of(c).ravel()[:, None] > 0.0
            return tuple(levels), inverse.astype(np.float32)
        c = _merge(c, *merges)


def _level(c: _Conductances, grid: ColouredGrid, merges: tuple[int, int], *, plain: bool) -> Level:
    gx, gy, inverse = (np.zeros(stored(grid), dtype=np.float32) for _ in range(3))
    store(grid, c.gx, gx)
    store(grid, c.gy, gy)
    diagonal = _diagonal_of(c)
    np.divide(1.0, diagonal, out=diagonal, where=diagonal > 0.0)
    store(grid, diagonal, inverse)
    x, b = np.zeros(stored(grid), dtype=np.float32), np.zeros(stored(grid), dtype=np.float32)
    rows = np.zeros((grid.rows, grid.lanes + 2 if plain else 0), dtype=np.float32)
    work = np.zeros((max(1, threads()), max(CHUNK, grid.lanes + 2)), dtype=np.float32)
    return Level(*grid, gx, gy, inverse, x, b, np.zeros_like(x[0]), rows, work, *merges)


@njit
def _matrix(c: _Conductances, ring: bool) -> Array:
    """Operator of a small grid as a dense matrix, unity where not free."""
    rows, lanes = c.outer_x.shape
    out = np.zeros((rows * lanes, rows * lanes))
    total = _diagonal_of(c).ravel()
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


@final
class MultigridPreconditioner:
    """One cycle as approximate inverse for the free cells of a balance.

    The hierarchy is built once and serves any number of right-hand sides.

    Parameters
    ----------
    balance : CellBalance
        Coefficients; only the conductances are used. [any]
    free : ndarray of bool
        Cells with unknown potential. [-]
    """

    def __init__(self, balance: CellBalance, free: BoolArray) -> None:
        largest = max(balance.conductance_x.max(), balance.conductance_y.max())
        # a power of two: to divide by it rounds nothing
        self._scale = float(2.0 ** np.round(np.log2(largest))) if largest > 0.0 else 1.0
        finest = _finest_grid(balance, free, self._scale)
        self._levels, self._coarsest = _hierarchy(finest, bool(balance.ring))

    def apply(self, rhs: Array) -> Array:
        """Approximate solution, zero where not free; one row per right-hand side. [any]."""
        finest = self._levels[0]
        grid, out = grid_of(finest), np.empty(rhs.shape)
        shape = -1, finest.rows, finest.lanes
        for side, x in zip(rhs.reshape(shape), out.reshape(shape), strict=True):
            # of length one, so that single precision neither overflows nor vanishes
            size = norm(side.ravel())
            unit = 1.0 / size if size > 0.0 else 1.0
            store(grid, unit * side, finest.b)
            cycle(self._levels, self._coarsest)
            fetch(grid, finest.x, x)
            x *= size / self._scale
        return out
