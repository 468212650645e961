"""Direct solution of five-point systems on structured grids, ordered lane by lane.

The band of the matrix is as wide as one row of lanes. A ring is cut at one row; what the cut
drops, and the digits beyond single precision, are left to the caller
(:mod:`toothspace.numerics.krylov`).

Entry ``[r, reach + c - r]`` of a band holds row ``r`` and column ``c`` of the matrix, every row
over its diagonal. The reach is the number of lanes rounded up to whole vectors. What lies beyond
the lanes stays zero, so that loops have one length for all four rows of a panel; a last panel is
filled with rows of the identity.
"""

from __future__ import annotations

from math import prod
from typing import Any

import numpy as np
from numpy.typing import NDArray

from toothspace.core.compiled import inlined, kernel, njit
from toothspace.core.errors import CaseError
from toothspace.core.types import Array

Single = NDArray[np.float32]

PANEL = 4
"""Pivots that are eliminated together, so that a row is read and written once for all of them."""
_VECTOR = 8
"""Numbers to which the lengths of loops are rounded up."""
MOST_MEMORY, _SINGLE = 2 * 2**30, 4
"""Memory that the band of one film may take, and that of one number. [B]"""
_NONE, _ONE = np.float32(0.0), np.float32(1.0)


@inlined
def _reach(band: Single) -> int:
    return (band.shape[1] - PANEL) // 2


def empty_band(rows: int, lanes: int) -> Single:
    """Storage for the band of a grid."""
    return np.empty(_band_shape(rows, lanes), dtype=np.float32)


def _band_shape(rows: int, lanes: int) -> tuple[int, int]:
    reach, height = -(-lanes // _VECTOR) * _VECTOR, -(-rows * lanes // PANEL) * PANEL
    return height, 2 * reach + PANEL


def check_grid(key: str, grid: tuple[int, int]) -> None:
    """Refuse a grid whose band does not fit into the memory that one film may take.

    Raises CaseError with the key, the memory of the band and the number of lanes that would fit.
    """
    rows, lanes = grid
    needed = _SINGLE * prod(_band_shape(rows, lanes))
    if needed > MOST_MEMORY:
        fitting = lanes
        while _SINGLE * prod(_band_shape(rows, fitting)) > MOST_MEMORY:
            fitting -= 1
        raise CaseError(
            key,
            f"{rows} x {lanes} cells, whose equations take {needed / 2**30:.1f} GiB of memory",
            f"are {MOST_MEMORY / 2**30:g} GiB: {rows} x {fitting} cells fit",
        )


@kernel
def fill_band(stencil: Array, rows: int, lanes: int, cut: int, band: Single) -> None:
    """Fill the band storage of a five-point matrix, rows counted from the cut.

    Columns of the stencil: west, south, centre, north, east.
    """
    centre = _reach(band)
    band[:] = _NONE
    band[:, centre] = _ONE
    for position in range(rows):
        i = (position + cut) % rows
        for j in range(lanes):
            r, s = position * lanes + j, i * lanes + j
            unit = 1.0 / stencil[s, 2]
            if position > 0:
                band[r, centre - lanes] += stencil[s, 0] * unit
            if position < rows - 1:
                band[r, centre + lanes] += stencil[s, 4] * unit
            if j > 0:
                band[r, centre - 1] += stencil[s, 1] * unit
            if j < lanes - 1:
                band[r, centre + 1] += stencil[s, 3] * unit


@inlined
def _factor_panel(flat: Single, columns: int, reach: int, first: int) -> None:
    """Eliminate among the four rows of a panel; ``first`` is the place of its first pivot."""
    for m in range(PANEL - 1):
        pivot = first + m * columns
        lead = flat[pivot + 1 : pivot + 1 + reach]
        for d in range(1, PANEL - m):
            place = pivot + d * (columns - 1)
            factor = flat[place] / flat[pivot]
            flat[place] = factor
            row = flat[place + 1 : place + 1 + reach]
            for c in range(reach):
                row[c] -= factor * lead[c]


@inlined
def _multipliers(flat: Single, place: int, panel: tuple[Any, ...]) -> tuple[Any, ...]:
    """Multipliers of the four pivots of a panel for a row, in place; zero off the band."""
    i0, i1, i2, i3, u01, u02, u03, u12, u13, u23 = panel
    f0 = flat[place] * i0
    f1 = (flat[place + 1] - f0 * u01) * i1
    f2 = (flat[place + 2] - f0 * u02 - f1 * u12) * i2
    f3 = (flat[place + 3] - f0 * u03 - f1 * u13 - f2 * u23) * i3
    flat[place], flat[place + 1], flat[place + 2], flat[place + 3] = f0, f1, f2, f3
    return f0, f1, f2, f3


@njit(nogil=True, fastmath={"contract", "reassoc"}, error_model="numpy", _nrt=False)
def factor_band(band: Single, lanes: int) -> None:
    """Triangular factors in place, without exchange of rows.

    Safe for matrices whose columns are diagonally dominant, as cell balances are.
    Rows without a multiplier are skipped, so that cells without fill cost nothing.
    """
    n, columns = band.shape
    reach, flat = _reach(band), band.reshape(n * columns)
    for first in range(0, n, PANEL):
        p0 = first * columns + reach
        p1, p2, p3 = p0 + columns, p0 + 2 * columns, p0 + 3 * columns
        _factor_panel(flat, columns, reach, p0)
        i0, i1, i2, i3 = _ONE / flat[p0], _ONE / flat[p1], _ONE / flat[p2], _ONE / flat[p3]
        u01, u02, u03 = flat[p0 + 1], flat[p0 + 2], flat[p0 + 3]
        u12, u13, u23 = flat[p1 + 1], flat[p1 + 2], flat[p2 + 1]
        panel = i0, i1, i2, i3, u01, u02, u03, u12, u13, u23
        # slices, because a loop counter from zero is known to need no wrap-around
        r0, r1 = flat[p0 + 4 : p0 + 4 + reach], flat[p1 + 3 : p1 + 3 + reach]
        r2, r3 = flat[p2 + 2 : p2 + 2 + reach], flat[p3 + 1 : p3 + 1 + reach]
        # two rows at a time need half the loads
        for row in range(first + PANEL, min(first + PANEL + lanes, n), 2):
            e = row * columns + reach - row + first
            g = e + columns - 1
            e0, e1, e2, e3 = _multipliers(flat, e, panel)
            g0, g1, g2, g3 = _multipliers(flat, g, panel)
            if e0 == e1 == e2 == e3 == g0 == g1 == g2 == g3 == _NONE:
                continue
            one, two = flat[e + 4 : e + 4 + reach], flat[g + 4 : g + 4 + reach]
            for c in range(reach):
                a0, a1, a2, a3 = r0[c], r1[c], r2[c], r3[c]
                one[c] -= e0 * a0 + e1 * a1 + e2 * a2 + e3 * a3
                two[c] -= g0 * a0 + g1 * a1 + g2 * a2 + g3 * a3


@inlined
def _four_sums(flat: Single, first: int, columns: int, x: Single) -> tuple[Any, ...]:
    """Sums over the same columns of four rows."""
    b0, b1 = flat[first : first + x.size], flat[first + columns : first + columns + x.size]
    third = first + 2 * columns
    b2, b3 = flat[third : third + x.size], flat[third + columns : third + columns + x.size]
    t0, t1, t2, t3 = _NONE, _NONE, _NONE, _NONE
    for c in range(x.size):
        t0 += b0[c] * x[c]
        t1 += b1[c] * x[c]
        t2 += b2[c] * x[c]
        t3 += b3[c] * x[c]
    return t0, t1, t2, t3


@njit(nogil=True, fastmath={"contract", "reassoc"}, error_model="numpy", _nrt=False)
def _substitute(band: Single, x: Single) -> None:
    """Forward and backward substitution in place: a panel serves all sides while in cache.

    Every side begins and ends with as many zeros as the band reaches.
    """
    n, columns = band.shape
    reach, flat = _reach(band), band.reshape(n * columns)
    for first in range(0, n, PANEL):
        p0 = first * columns + reach
        p1, p2, p3 = p0 + columns, p0 + 2 * columns, p0 + 3 * columns
        for k in range(len(x)):
            t0, t1, t2, t3 = _four_sums(flat, p0 - reach, columns - 1, x[k, first : first + reach])
            own = x[k, first + reach : first + reach + PANEL]
            own[0] -= t0
            own[1] -= t1 + flat[p1 - 1] * own[0]
            own[2] -= t2 + flat[p2 - 2] * own[0] + flat[p2 - 1] * own[1]
            own[3] -= t3 + flat[p3 - 3] * own[0] + flat[p3 - 2] * own[1] + flat[p3 - 1] * own[2]
    for first in range(n - PANEL, -1, -PANEL):
        p0 = first * columns + reach
        p1, p2, p3 = p0 + columns, p0 + 2 * columns, p0 + 3 * columns
        for k in range(len(x)):
            behind = first + reach + PANEL
            t0, t1, t2, t3 = _four_sums(flat, p0 + 4, columns - 1, x[k, behind : behind + reach])
            own = x[k, behind - PANEL : behind]
            own[3] = (own[3] - t3) / flat[p3]
            own[2] = (own[2] - t2 - flat[p2 + 1] * own[3]) / flat[p2]
            own[1] = (own[1] - t1 - flat[p1 + 1] * own[2] - flat[p1 + 2] * own[3]) / flat[p1]
            total = t0 + flat[p0 + 1] * own[1] + flat[p0 + 2] * own[2] + flat[p0 + 3] * own[3]
            own[0] = (own[0] - total) / flat[p0]


def solve_bands(band: Single, factored: Array, stencil: Array, rhs: Array, shift: int) -> Array:
    """Solutions for several right-hand sides in grid order, in one pass over the factors.

    ``rhs`` has one row per right-hand side, the band begins ``shift`` cells behind the first one.
    It is that of the matrix ``factored``; where the diagonal of the matrix to solve differs, a
    cell holds another unknown, in units that differ as much.
    """
    x = np.zeros((len(rhs), len(band) + 2 * _reach(band)), dtype=np.float32)
    out, sizes = np.empty(rhs.shape), np.zeros(len(rhs))
    _solve(band, factored, stencil, rhs, shift, x, sizes, out)
    return out


@kernel
def _solve(
    band: Single,
    factored: Array,
    stencil: Array,
    rhs: Array,
    shift: int,
    x: Single,
    sizes: Array,
    out: Array,
) -> None:
    sides, n = rhs.shape
    reach = _reach(band)
    for k in range(sides):
        for r in range(n):
            out[k, r] = rhs[k, r] / factored[r, 2]
            sizes[k] = max(sizes[k], abs(out[k, r]))
        unit = 1.0 / sizes[k] if sizes[k] > 0.0 else 0.0
        for r in range(n):
            x[k, reach + (r - shift if r >= shift else r - shift + n)] = out[k, r] * unit
    _substitute(band, x)
    for k in range(sides):
        for r in range(n):
            found = x[k, reach + (r - shift if r >= shift else r - shift + n)]
            out[k, r] = sizes[k] * found * (factored[r, 2] / stencil[r, 2])


@njit(nogil=True, fastmath={"contract"}, _nrt=False)
def stencil_products(stencil: Array, x: Array, rows: int, lanes: int, y: Array) -> None:
    """Products of a five-point matrix on a ring and several vectors in grid order, one per row."""
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


def stencil_product(stencil: Array, x: Array, rows: int, lanes: int) -> Array:
    """Product of a five-point matrix on a ring and one vector in grid order."""
    found = np.empty((1, x.size))
    stencil_products(stencil, x.reshape(1, -1), rows, lanes, found)
    return found[0]
