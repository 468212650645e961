"""Products and vector operations of conjugate gradients on fields stored by colours.

Long vectors are worked on in parts of one size by several threads, and sums are taken part by
part, so that results do not depend on the number of threads.
"""

from __future__ import annotations

import numpy as np

from toothspace.core.compiled import inlined, njit, prange
from toothspace.core.types import Array
from toothspace.numerics.colouring import ColouredGrid, close_ring, neighbours, span
from toothspace.numerics.multigrid_cycle import Single, parallel_loops
from toothspace.numerics.vectors import add_scaled, dot

Operator = tuple[Array, Array, Array]
"""Conductances to the western and southern neighbours, and their sums; stored fields."""
BLOCK = 2048
"""Cells of a block of rows that a product works on, one colour after the other. [-]"""
PART = 1 << 15
"""Elements of a part of a long vector. [-]"""
LONG = 300000
"""Elements from which vectors are divided. [-]"""


@inlined
def _conduct_colour(
    grid: ColouredGrid, operator: Operator, p: Array, q: Array, colour: int, rows: tuple[int, int]
) -> float:
    """Product on the cells of one colour in a block of rows, and its inner product with ``p``."""
    gx, gy, diagonal = operator
    low, high = span(grid, rows[0], rows[1], colour)
    west, south, east = neighbours(grid, colour, low)
    count, other = high - low, 1 - colour
    g_west, g_east = gx[colour, low:high], gx[other, east : east + count]
    p_west, p_east = p[other, west : west + count], p[other, east : east + count]
    out, d, centre = q[colour, low:high], diagonal[colour, low:high], p[colour, low:high]
    for n in range(count):
        out[n] = d[n] * centre[n] - g_west[n] * p_west[n] - g_east[n] * p_east[n]
    g_south, g_north = gy[colour, low:high], gy[other, south + 1 : south + 1 + count]
    beside = p[other, south : south + count + 1]
    for n in range(count):
        out[n] -= g_south[n] * beside[n] + g_north[n] * beside[n + 1]
    total = 0.0
    for n in range(count):
        total += out[n] * centre[n]
    return total


@njit(nogil=True, error_model="numpy", fastmath={"contract", "reassoc"})
def _conduct_part(
    grid: ColouredGrid, operator: Operator, p: Array, q: Array, part: int, sums: Array
) -> None:
    """Products in one part of the rows, every field in turn while a block is in cache."""
    parts, size = sums.shape[1], max(1, BLOCK // grid.stride)
    first, last = part * grid.rows // parts, (part + 1) * grid.rows // parts
    sums[:, part] = 0.0
    for row in range(first, last, size):
        rows = row, min(row + size, last)
        for side in range(p.shape[0]):
            for colour in range(2):
                sums[side, part] += _conduct_colour(grid, operator, p[side], q[side], colour, rows)


@njit(nogil=True)
def _conduct(grid: ColouredGrid, operator: Operator, p: Array, q: Array, sums: Array) -> None:
    for part in range(sums.shape[1]):
        _conduct_part(grid, operator, p, q, part, sums)


@njit(parallel=True)
def _conduct_parts(grid: ColouredGrid, operator: Operator, p: Array, q: Array, sums: Array) -> None:
    for part in prange(sums.shape[1]):
        _conduct_part(grid, operator, p, q, part, sums)


@njit(nogil=True)
def _close(grid: ColouredGrid, fields: Array) -> None:
    for side in range(fields.shape[0]):
        close_ring(grid, fields[side])


def conduct(grid: ColouredGrid, operator: Operator, p: Array, q: Array) -> Array:
    """Products of the conductive operator of the free cells and fields.

    Parameters
    ----------
    grid : ColouredGrid
        Storage of the fields.
    operator : tuple of ndarray
        Conductances to the western and southern neighbours, and their sums. [any]
    p : ndarray, shape (sides, 2, places)
        Fields; what is stored beyond the ends of a ring is brought up to date. [any]
    q : ndarray
        Where the products go; nothing is written outside of the grid. [any]

    Returns
    -------
    ndarray, shape (sides,)
        Inner products of each field with its product. [any]
    """
    _close(grid, p)
    parts = _parts(2 * p.shape[-1])
    sums = np.empty((len(p), parts))
    if parts == 1:
        _conduct(grid, operator, p, q, sums)
    else:
        with parallel_loops():
            _conduct_parts(grid, operator, p, q, sums)
    return np.asarray(sums.sum(axis=1))


def _parts(size: int) -> int:
    return 1 if size < LONG else -(-size // PART)


@njit(nogil=True)
def load(target: Single, source: Array, factors: Array) -> None:
    """Multiples of fields in single precision."""
    for side in range(factors.size):
        flat, given, factor = target[side].ravel(), source[side].ravel(), factors[side]
        for k in range(flat.size):
            flat[k] = given[k] * factor


@njit(parallel=True)
def _dot_parts(r: Array, z: Single, sums: Array) -> None:
    for part in prange(sums.size):
        low = part * PART
        sums[part] = dot(r[low : low + PART], z[low : low + PART])


def mixed_dot(r: Array, z: Single) -> float:
    """Inner product of a vector with one in single precision."""
    if r.size < LONG:
        return float(dot(r, z))
    sums = np.empty(_parts(r.size))
    with parallel_loops():
        _dot_parts(r, z, sums)
    return float(sums.sum())


@njit(nogil=True, fastmath={"contract"})
def _turn(p: Array, z: Single, factor: float) -> None:
    for k in range(p.size):
        p[k] = z[k] + factor * p[k]


@njit(parallel=True)
def _turn_parts(p: Array, z: Single, factor: float, parts: int) -> None:
    for part in prange(parts):
        low = part * PART
        _turn(p[low : low + PART], z[low : low + PART], factor)


def turn(p: Array, z: Single, factor: float) -> None:
    """New search direction: preconditioned residual plus a part of the last direction."""
    if p.size < LONG:
        _turn(p, z, factor)
        return
    with parallel_loops():
        _turn_parts(p, z, factor, _parts(p.size))


@njit(nogil=True, fastmath={"contract", "reassoc"})
def _reduce(r: Array, step: float, q: Array) -> float:
    total = 0.0
    for k in range(r.size):
        r[k] -= step * q[k]
        total += r[k] * r[k]
    return total


@njit(parallel=True)
def _advance_parts(x: Array, r: Array, p: Array, q: Array, step: float, sums: Array) -> None:
    for part in prange(sums.size):
        low = part * PART
        add_scaled(x[low : low + PART], step, p[low : low + PART])
        sums[part] = _reduce(r[low : low + PART], step, q[low : low + PART])


def advance(x: Array, r: Array, p: Array, q: Array, step: float) -> float:
    """Go a step along ``p``, take it from the residual, and return the norm of what remains."""
    if r.size < LONG:
        add_scaled(x, step, p)
        return float(_reduce(r, step, q) ** 0.5)
    sums = np.empty(_parts(r.size))
    with parallel_loops():
        _advance_parts(x, r, p, q, step, sums)
    return float(sums.sum() ** 0.5)
