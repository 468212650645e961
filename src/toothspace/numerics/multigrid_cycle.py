"""One V-cycle of the geometric multigrid in single precision.

Every level is stored by colours, see :mod:`toothspace.numerics.colouring`. The passes of a
level (two relaxations of either colour and the transfer) follow each other closely: while one
works on a block of rows, the next works on the block before. So a level too large for the cache
is read once on the way down and once on the way up. Several threads take tiles of blocks that
shrink by one block from pass to pass; what is left around the seams of the tiles comes after.
"""

from __future__ import annotations

import os
import threading
from collections.abc import Iterator
from contextlib import contextmanager
from itertools import pairwise
from typing import NamedTuple

import numba
import numpy as np
from numpy.typing import NDArray

from toothspace.core.compiled import inlined, kernel, njit, prange
from toothspace.core.processes import threads
from toothspace.numerics.colouring import (
    ColouredGrid,
    close_ring,
    fetch,
    neighbours,
    row_start,
    span,
    store,
)

Single = NDArray[np.float32]

# waiting threads must sleep: on a busy machine spinning ones take the time of those that work
os.environ.setdefault("OMP_WAIT_POLICY", "passive")
_ONE_AT_A_TIME = threading.Lock()
"""Numba's simplest threading layer ends the program if two threads start parallel loops."""
PASSES = 5
"""Passes of a level on the way down, and as many on the way up. [-]"""
CHUNK = 1024
"""Cells of one colour whose sums are kept at a time. [-]"""
BLOCK = 2048
"""Cells of a block of rows. [-]"""
RESIDENT = 40000
"""Cells up to which a level stays in cache, so that its passes need no blocks. [-]"""
TILE = 100000
"""Cells from which another thread pays; to wake one takes as long as ten thousand cells. [-]"""
NEAR, FAR = np.float32(0.75), np.float32(0.25)
"""Weights of the bilinear transfer along one direction."""
NONE, ONE = np.float32(0.0), np.float32(1.0)


@contextmanager
def parallel_loops() -> Iterator[None]:
    """Let loops run on the threads of a cycle, those of one Python thread at a time."""
    with _ONE_AT_A_TIME:
        before = numba.get_num_threads()
        numba.set_num_threads(min(max(1, threads()), before))
        yield
        numba.set_num_threads(before)


class Level(NamedTuple):
    """One grid of the hierarchy; stored fields but for ``plain``."""

    rows: int
    lanes: int
    stride: int
    ring: bool
    gx: Single  # conductance between a free cell and its western neighbour
    gy: Single  # ... and its southern neighbour
    inverse: Single  # inverse diagonal, zero where not free
    x: Single
    b: Single
    r: Single  # (places,), residual of the first colour; the other has none
    plain: Single  # (rows, lanes + 2), x or b in rows with a border; no lanes on the finest
    work: Single  # (threads, chunk)
    merge_x: int  # cells of this grid that one coarser cell holds along each direction
    merge_y: int


@inlined
def grid_of(level: Level) -> ColouredGrid:
    """Storage of a level; parallel loops cannot take tuples in tuples."""
    return ColouredGrid(level.rows, level.lanes, level.stride, level.ring)


@inlined
def _sums(level: Level, colour: int, low: int, high: int, out: Single) -> None:
    """Right-hand side plus what the neighbours conduct to the cells of one colour."""
    west, south, east = neighbours(grid_of(level), colour, low)
    other, count = 1 - colour, high - low
    x, b = level.x[other], level.b[colour, low:high]
    g_west, g_east = level.gx[colour, low:high], level.gx[other, east : east + count]
    x_west, x_east = x[west : west + count], x[east : east + count]
    for n in range(count):
        out[n] = b[n] + g_west[n] * x_west[n] + g_east[n] * x_east[n]
    g_south, g_north = level.gy[colour, low:high], level.gy[other, south + 1 : south + 1 + count]
    x_beside = x[south : south + count + 1]
    for n in range(count):
        out[n] += g_south[n] * x_beside[n] + g_north[n] * x_beside[n + 1]


@inlined
def _relax(level: Level, colour: int, rows: tuple[int, int], work: Single) -> None:
    """Gauss-Seidel on the cells of one colour."""
    low, end = span(grid_of(level), rows[0], rows[1], colour)
    while low < end:
        high = min(low + CHUNK, end)
        _sums(level, colour, low, high, work)
        x, inverse = level.x[colour, low:high], level.inverse[colour, low:high]
        for n in range(high - low):
            x[n] = work[n] * inverse[n]
        low = high


@inlined
def _begin(level: Level, rows: tuple[int, int]) -> None:
    """Relax the first colour from zero everywhere."""
    low, high = span(grid_of(level), rows[0], rows[1], 0)
    x, b = level.x[0, low:high], level.b[0, low:high]
    inverse = level.inverse[0, low:high]
    for n in range(high - low):
        x[n] = b[n] * inverse[n]


@inlined
def _remainder(level: Level, rows: tuple[int, int], work: Single) -> None:
    """Residual of the first colour; the one relaxed last has none."""
    low, end = span(grid_of(level), rows[0], rows[1], 0)
    while low < end:
        high = min(low + CHUNK, end)
        _sums(level, 0, low, high, work)
        x, inverse, r = level.x[0, low:high], level.inverse[0, low:high], level.r
        residual = r[low:high]
        for n in range(high - low):
            residual[n] = work[n] - x[n] / inverse[n] if inverse[n] > NONE else NONE
        low = high


@inlined
def _beyond(index: int, merge: int, count: int, ring: bool) -> int:
    """Second coarse row that a fine row lies next to, itself at a border."""
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
def _prolong(fine: Level, coarse: Level, i: int, mixed: Single) -> None:
    """Add the coarse correction to the first colour of a row; the other is relaxed next."""
    lane, place, count = row_start(grid_of(fine), i, 0)
    near = NEAR if fine.merge_x == 2 else ONE
    far = ONE - near
    beyond = _beyond(i, fine.merge_x, coarse.rows, fine.ring)
    home, other = coarse.plain[i // fine.merge_x], coarse.plain[beyond]
    for m in range(home.size):
        mixed[m] = near * home[m] + far * other[m]
    x, inverse = fine.x[0, place : place + count], fine.inverse[0, place : place + count]
    if fine.merge_y == 1:
        given = mixed[1 + lane :]
        for n in range(count):
            x[n] += given[2 * n] if inverse[n] > NONE else NONE
        return
    home, other = mixed[1:], mixed[2 * lane :]
    for n in range(count):
        x[n] += NEAR * home[n] + FAR * other[n] if inverse[n] > NONE else NONE


@kernel
def _pass(
    fine: Level, coarse: Level, down: bool, stage: int, rows: tuple[int, int], work: Single
) -> None:
    """One pass over a block of rows."""
    if down and stage == 0:
        _begin(fine, rows)
    elif down and stage == PASSES - 1:
        _remainder(fine, rows, work)
    elif stage == 0:
        for i in range(rows[0], rows[1]):
            _prolong(fine, coarse, i, work)
    else:
        _relax(fine, stage % 2, rows, work)


@inlined
def _block_rows(grid: ColouredGrid) -> int:
    return max(1, BLOCK // grid.stride)


@inlined
def _blocks(grid: ColouredGrid) -> int:
    size = _block_rows(grid)
    return (grid.rows + size - 1) // size


@inlined
def _block(grid: ColouredGrid, q: int) -> tuple[int, int]:
    """Rows of a block, counted round the ring."""
    size = _block_rows(grid)
    first = (q % _blocks(grid)) * size
    return first, min(first + size, grid.rows)


@kernel
def _close(level: Level, stage: int) -> None:
    """Join the ends of a ring after a pass.

    In a ring of an odd number of rows the ends have neighbours of their own colour; relaxed in
    turn they come so near to each other that the residual of either may be left out.
    """
    grid, last = grid_of(level), level.rows - 1
    close_ring(grid, level.x)
    if level.ring and level.rows % 2 == 1 and 0 < stage < PASSES - 1:
        for row in (0, last, 0, last):
            _relax(level, stage % 2, (row, row + 1), level.work[0])
            close_ring(grid, level.x)


@kernel
def _one_after_another(fine: Level, coarse: Level, down: bool) -> None:
    """All passes of a level that stays in cache."""
    for stage in range(PASSES):
        _pass(fine, coarse, down, stage, (0, fine.rows), fine.work[0])
        _close(fine, stage)


@kernel
def _tile(fine: Level, coarse: Level, down: bool, tile: int, tiles: int) -> None:
    """Passes in a tile of blocks, one block less from pass to pass at ends with a neighbour."""
    grid, blocks = grid_of(fine), _blocks(grid_of(fine))
    first, last = tile * blocks // tiles, (tile + 1) * blocks // tiles
    at_first = 1 if grid.ring or tile > 0 else 0
    at_last = 1 if grid.ring or tile < tiles - 1 else 0
    for time in range(first, last + PASSES - 1):
        for stage in range(PASSES):
            q = time - stage
            if first + at_first * stage <= q < last - at_last * stage:
                _pass(fine, coarse, down, stage, _block(grid, q), fine.work[tile])


@kernel
def _seam(fine: Level, coarse: Level, down: bool, tile: int, tiles: int) -> None:
    """What the tiles left on either side of the beginning of a tile."""
    grid, begin = grid_of(fine), tile * _blocks(grid_of(fine)) // tiles
    if tile == 0:
        if not grid.ring:
            return
        _close(fine, 0)
    for stage in range(1, PASSES):
        for q in range(begin - stage, begin + stage):
            _pass(fine, coarse, down, stage, _block(grid, q), fine.work[tile])
        if tile == 0:
            _close(fine, stage)


@njit(parallel=True)
def _tiles(fine: Level, coarse: Level, down: bool, tiles: int) -> None:
    for tile in prange(tiles):
        _tile(fine, coarse, down, tile, tiles)


@njit(parallel=True)
def _seams(fine: Level, coarse: Level, down: bool, tiles: int) -> None:
    """Apart from :func:`_tiles`, because two parallel loops in one function may be merged."""
    for tile in prange(tiles):
        _seam(fine, coarse, down, tile, tiles)


@inlined
def _gather(fine: Level, i: int, weight: float, out: Single) -> None:
    """Add what :func:`_prolong` would take from a coarse row, its adjoint, to that row."""
    lane, place, count = row_start(grid_of(fine), i, 0)
    r = fine.r
    if fine.merge_y == 1:
        target = out[lane:]
        for n in range(count):
            target[2 * n] += weight * r[place + n]
        return
    near, far, size = NEAR * weight, FAR * weight, out.size
    home, beside = r[place : place + size], r[place + 1 - 2 * lane : place + 1 - 2 * lane + size]
    for n in range(size):
        out[n] += near * home[n] + far * beside[n]
    if lane == 0:
        out[0] += far * home[0]
    elif fine.lanes % 2 == 0:
        out[size - 1] += far * home[size - 1]


@inlined
def _gather_rows(fine: Level, m: int, out: Single) -> None:
    """Restrict the residual to one coarse row."""
    rows, ring = fine.rows, fine.ring
    if fine.merge_x == 1:
        _gather(fine, m, ONE, out)
        return
    even = rows % 2 == 0
    _gather(fine, 2 * m, NEAR, out)
    if 2 * m + 1 < rows:
        _gather(fine, 2 * m + 1, NEAR, out)
    if m > 0:
        _gather(fine, 2 * m - 1, FAR, out)
    elif even or not ring:
        _gather(fine, rows - 1 if ring else 0, FAR, out)
    if 2 * m + 2 < rows:
        _gather(fine, 2 * m + 2, FAR, out)
    elif even or ring:
        _gather(fine, 0 if ring else rows - 1, FAR, out)


@kernel
def _restrict(fine: Level, coarse: Level) -> None:
    """Right-hand side of the coarser level: the adjoint of the prolongation of the residual."""
    lanes = coarse.lanes
    plain = coarse.plain
    for m in range(coarse.rows):
        out = plain[m, 1 : lanes + 1]
        out[:] = NONE
        _gather_rows(fine, m, out)
    store(grid_of(coarse), plain[:, 1:], coarse.b)


@kernel
def _lay_out(level: Level) -> None:
    """Write the solution of a level into rows with a border of equal values."""
    lanes = level.lanes
    plain = level.plain
    fetch(grid_of(level), level.x, plain[:, 1:])
    for i in range(level.rows):
        plain[i, 0], plain[i, lanes + 1] = plain[i, 1], plain[i, lanes]


@kernel
def _solve_coarsest(level: Level, inverse: Single) -> None:
    rows, lanes = level.rows, level.lanes
    x = level.work[0]
    plain = level.plain
    fetch(grid_of(level), level.b, plain[:, 1:])
    for k in range(rows * lanes):
        total = NONE
        for m in range(rows * lanes):
            total += inverse[k, m] * plain[m // lanes, m % lanes + 1]
        x[k] = total
    for k in range(rows * lanes):
        plain[k // lanes, k % lanes + 1] = x[k]
    store(grid_of(level), plain[:, 1:], level.x)


def _leg(fine: Level, coarse: Level, down: bool) -> None:
    """All passes of a level on the way down or up."""
    cells, tiles = fine.rows * fine.stride, fine.work.shape[0]
    blocks = -(-fine.rows // max(1, BLOCK // fine.stride)) // (2 * PASSES)
    if cells < RESIDENT or blocks == 0:
        _one_after_another(fine, coarse, down)
        return
    tiles = min(tiles, blocks, max(1, cells // TILE))
    if tiles == 1:
        _tile(fine, coarse, down, 0, 1)
        _seam(fine, coarse, down, 0, 1)
        return
    with parallel_loops():
        _tiles(fine, coarse, down, tiles)
        _seams(fine, coarse, down, tiles)


def cycle(levels: tuple[Level, ...], coarsest: Single) -> None:
    """One symmetric V-cycle on ``b`` of the finest level, result in ``x``.

    Parameters
    ----------
    levels : tuple of Level
        From fine to coarse. [-]
    coarsest : ndarray
        Inverse of the operator of the coarsest level. [any]
    """
    for fine, coarse in pairwise(levels):
        _leg(fine, coarse, True)
        _restrict(fine, coarse)
    _solve_coarsest(levels[-1], coarsest)
    for coarse, fine in pairwise(reversed(levels)):
        _lay_out(coarse)
        _leg(fine, coarse, False)
