"""Direct solution of five-point systems on structured grids, ordered lane by lane.

The band of the matrix is as wide as one row of lanes. A ring is cut at one row; what the cut
drops is left to the caller (:mod:`toothspace.numerics.krylov`).
"""

from __future__ import annotations

import numpy as np

from toothspace.core.compiled import inlined, njit
from toothspace.core.types import Array
from toothspace.numerics.vectors import dot


@njit
def fill_band(stencil: Array, rows: int, lanes: int, cut: int, band: Array) -> None:
    """Fill the band storage of a five-point matrix, rows counted from the cut.

    Entry ``[r, lanes + c - r]`` holds row ``r`` and column ``c``. Columns of the stencil:
    west, south, centre, north, east.
    """
    width = lanes
    band[:] = 0.0
    for position in range(rows):
        i = (position + cut) % rows
        for j in range(lanes):
            r = position * lanes + j
            s = i * lanes + j
            band[r, width] = stencil[s, 2]
            if position > 0:
                band[r, width - lanes] += stencil[s, 0]
            if position < rows - 1:
                band[r, width + lanes] += stencil[s, 4]
            if j > 0:
                band[r, width - 1] += stencil[s, 1]
            if j < lanes - 1:
                band[r, width + 1] += stencil[s, 3]


PANEL = 4
"""Pivots that are eliminated together, so that a row is read and written once for all of them."""


@njit(fastmath={"contract"})
def _factor_panel(flat: Array, columns: int, first: int, count: int, inverse: Array) -> None:
    """Eliminate among the rows of one panel; keep the inverse pivots."""
    width = columns // 2
    n = flat.size // columns
    for m in range(count):
        k = first + m
        base = k * columns + width
        inverse[m] = 1.0 / flat[base]
        reach = min(width, n - 1 - k)
        for d in range(1, min(count - m, reach + 1)):
            start = base + d * (columns - 1)
            factor = flat[start] * inverse[m]
            flat[start] = factor
            if factor != 0.0:
                for c in range(1, reach + 1):
                    flat[start + c] -= factor * flat[base + c]


@njit(fastmath={"contract"})
def _multiplier(flat: Array, columns: int, first: int, row: int, m: int) -> float:
    """Multiplier of pivot m of a panel for one row below it, stored in place; zero off the band."""
    width = columns // 2
    entry = row * columns + width - row  # flat[entry + c] is column c of the row
    column = first + m
    if column < row - width:
        return 0.0
    value = flat[entry + column]
    for k in range(max(0, row - width - first), m):
        value -= flat[entry + first + k] * flat[(first + k) * columns + width + m - k]
    value /= flat[column * columns + width]
    flat[entry + column] = value
    return value


@inlined
def _beyond(flat: Array, columns: int, first: int, entry: int, factors: tuple[float, ...]) -> None:
    """Columns that the later pivots of a panel reach, but not the first one."""
    width = columns // 2
    n = flat.size // columns
    p0 = first * columns + width - first
    for c in range(max(first + 4, first + width + 1), min(first + 3 + width, n - 1) + 1):
        total = factors[3] * flat[p0 + 3 * (columns - 1) + c]
        if c <= first + 1 + width:
            total += factors[1] * flat[p0 + columns - 1 + c]
        if c <= first + 2 + width:
            total += factors[2] * flat[p0 + 2 * (columns - 1) + c]
        flat[entry + c] -= total


@njit(fastmath={"contract"})
def _update_rows(flat: Array, columns: int, first: int, inverse: Array) -> int:
    """Eliminate the columns of a panel from the rows that hold all four; return the next row."""
    width = columns // 2
    n = flat.size // columns
    p0 = first * columns + width - first
    p1, p2, p3 = p0 + columns - 1, p0 + 2 * (columns - 1), p0 + 3 * (columns - 1)
    i0, i1, i2, i3 = inverse[0], inverse[1], inverse[2], inverse[3]
    u01, u02, u03 = flat[p0 + first + 1], flat[p0 + first + 2], flat[p0 + first + 3]
    u12, u13, u23 = flat[p1 + first + 2], flat[p1 + first + 3], flat[p2 + first + 3]
    # slices, because a loop counter from zero is known to need no wrap-around
    start, stop = first + 4, min(first + width, n - 1) + 1
    r0, r1 = flat[p0 + start : p0 + stop], flat[p1 + start : p1 + stop]
    r2, r3 = flat[p2 + start : p2 + stop], flat[p3 + start : p3 + stop]
    last = min(first + width + 1, n)
    for row in range(first + 4, last):
        entry = row * columns + width - row
        e = entry + first
        f0 = flat[e] * i0
        f1 = (flat[e + 1] - f0 * u01) * i1
        f2 = (flat[e + 2] - f0 * u02 - f1 * u12) * i2
        f3 = (flat[e + 3] - f0 * u03 - f1 * u13 - f2 * u23) * i3
        if f0 == 0.0 and f1 == 0.0 and f2 == 0.0 and f3 == 0.0:
            continue
        flat[e], flat[e + 1], flat[e + 2], flat[e + 3] = f0, f1, f2, f3
        target = flat[entry + start : entry + stop]
        for c in range(target.size):
            target[c] -= f0 * r0[c] + f1 * r1[c] + f2 * r2[c] + f3 * r3[c]
        _beyond(flat, columns, first, entry, (f0, f1, f2, f3))
    return max(first + 4, last)


@njit(fastmath={"contract"})
def _update_row(flat: Array, columns: int, first: int, row: int) -> None:
    """Eliminate the columns of a panel from a row that begins within it."""
    width = columns // 2
    n = flat.size // columns
    f0 = _multiplier(flat, columns, first, row, 0)
    f1 = _multiplier(flat, columns, first, row, 1)
    f2 = _multiplier(flat, columns, first, row, 2)
    f3 = _multiplier(flat, columns, first, row, 3)
    entry = row * columns + width - row
    p0 = first * columns + width - first
    for c in range(first + 4, min(first + width, n - 1) + 1):
        total = f0 * flat[p0 + c] + f1 * flat[p0 + columns - 1 + c]
        total += f2 * flat[p0 + 2 * (columns - 1) + c] + f3 * flat[p0 + 3 * (columns - 1) + c]
        flat[entry + c] -= total
    _beyond(flat, columns, first, entry, (f0, f1, f2, f3))


@njit(fastmath={"contract"})
def factor_band(band: Array) -> None:
    """Triangular factors in place, without exchange of rows.

    Safe for matrices whose columns are diagonally dominant, as cell balances are.
    Rows without a multiplier are skipped, so that cells without fill cost nothing.
    """
    n, columns = band.shape
    width = columns // 2
    flat = band.reshape(n * columns)
    inverse = np.empty(PANEL)
    for first in range(0, n, PANEL):
        count = min(PANEL, n - first)
        _factor_panel(flat, columns, first, count, inverse)
        if count == PANEL:
            begin = _update_rows(flat, columns, first, inverse)
            for row in range(begin, min(first + PANEL + width, n)):
                _update_row(flat, columns, first, row)


@njit
def _substitute(band: Array, x: Array) -> None:
    """Forward and backward substitution for one right-hand side, in place."""
    n, columns = band.shape
    width = columns // 2
    for r in range(n):
        reach = min(width, r)
        x[r] -= dot(band[r, width - reach : width], x[r - reach : r])
    for r in range(n - 1, -1, -1):
        reach = min(width, n - 1 - r)
        total = dot(band[r, width + 1 : width + 1 + reach], x[r + 1 : r + 1 + reach])
        x[r] = (x[r] - total) / band[r, width]


@njit
def _substitute_together(band: Array, x: Array) -> None:
    """The same for several right-hand sides: a row of the band serves all while in cache."""
    n, columns = band.shape
    width = columns // 2
    for r in range(n):
        first = max(0, r - width)
        row = band[r, width - r + first : width]
        for k in range(len(x)):
            x[k, r] -= dot(row, x[k, first:r])
    for r in range(n - 1, -1, -1):
        last = min(n, r + 1 + width)
        row = band[r, width + 1 : width + last - r]
        for k in range(len(x)):
            x[k, r] = (x[k, r] - dot(row, x[k, r + 1 : last])) / band[r, width]


@njit
def solve_bands(band: Array, rhs: Array, lanes: int, cut: int) -> Array:
    """Solutions for several right-hand sides in grid order, in one pass over the factors.

    ``rhs`` has one row per right-hand side.
    """
    n = rhs.shape[1]
    shift = cut * lanes
    x = np.empty(rhs.shape)
    x[:, : n - shift] = rhs[:, shift:]
    x[:, n - shift :] = rhs[:, :shift]
    if len(rhs) == 1:
        _substitute(band, x[0])
    else:
        _substitute_together(band, x)
    result = np.empty(rhs.shape)
    result[:, shift:] = x[:, : n - shift]
    result[:, :shift] = x[:, n - shift :]
    return result


@njit(nogil=True, fastmath={"contract"})
def stencil_products(stencil: Array, x: Array, rows: int, lanes: int) -> Array:
    """Products of a five-point matrix on a ring and several vectors in grid order, one per row."""
    y = np.empty(x.shape)
    for i in range(rows):
        west = (i + rows - 1) % rows
        east = (i + 1) % rows
        for k in range(len(x)):
            for j in range(lanes):
                r = i * lanes + j
                total = stencil[r, 2] * x[k, r]
                total += stencil[r, 0] * x[k, west * lanes + j]
                total += stencil[r, 4] * x[k, east * lanes + j]
                if j > 0:
                    total += stencil[r, 1] * x[k, r - 1]
                if j < lanes - 1:
                    total += stencil[r, 3] * x[k, r + 1]
                y[k, r] = total
    return y


def stencil_product(stencil: Array, x: Array, rows: int, lanes: int) -> Array:
    """Product of a five-point matrix on a ring and one vector in grid order."""
    return np.asarray(stencil_products(stencil, x.reshape(1, -1), rows, lanes)[0])
