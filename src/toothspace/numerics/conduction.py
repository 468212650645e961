"""Conduction on masked structured grids: conjugate gradients with a multigrid cycle.

The cycle of :mod:`toothspace.numerics.multigrid_cycle` works in single precision, the iteration
around it in double precision. All fields are stored by colours.
"""

from __future__ import annotations

from typing import final

import numpy as np

from toothspace.core.compiled import inlined, njit
from toothspace.core.types import Array, BoolArray
from toothspace.numerics.chequerboard import (
    Board,
    close_ring,
    fetch,
    neighbours,
    span,
    store,
    stored,
    stored_field,
)
from toothspace.numerics.multigrid import diagonal_of, finest_grid, for_sides, hierarchy, scaled
from toothspace.numerics.multigrid_cycle import Level, Single, board_in, cycle
from toothspace.numerics.structured_grid import CellBalance
from toothspace.numerics.vectors import add_scaled, norm

_ROWS = 2048
"""Cells of a block of rows that the product works on, one colour after the other. [-]"""


@inlined
def _conduct_colour(
    board: Board, operator: tuple[Array, Array, Array], p: Array, q: Array, colour: int, row: int
) -> None:
    """Product on the cells of one colour in a block of rows."""
    gx, gy, diagonal = operator
    last = min(row + max(1, _ROWS // board.stride), board.rows)
    low, high = span(board, row, last, colour)
    west, south, east = neighbours(board, colour, low)
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


@njit(cache=True, nogil=True, error_model="numpy", fastmath={"contract"})
def _conduct(board: Board, operator: tuple[Array, Array, Array], p: Array, q: Array) -> None:
    """Products of the conductive operator of the free cells and fields, first index the field."""
    for side in range(p.shape[0]):
        close_ring(board, p[side])
    for row in range(0, board.rows, max(1, _ROWS // board.stride)):
        for side in range(p.shape[0]):
            for colour in range(2):
                _conduct_colour(board, operator, p[side], q[side], colour, row)


@njit(cache=True, nogil=True)
def _load(target: Single, source: Array, factors: Array) -> None:
    for side in range(factors.size):
        flat, given, factor = target[side].ravel(), source[side].ravel(), factors[side]
        for k in range(flat.size):
            flat[k] = given[k] * factor


@njit(cache=True, nogil=True, fastmath={"contract"})
def _turn(p: Array, z: Single, beta: float) -> None:
    """New search direction: preconditioned residual plus a part of the last direction."""
    for k in range(p.size):
        p[k] = z[k] + beta * p[k]


@njit(cache=True, nogil=True, fastmath={"contract", "reassoc"})
def _dot(a: Array, b: Array) -> float:
    """Inner product; either vector may be in single precision."""
    total = 0.0
    for k in range(a.size):
        total += a[k] * b[k]
    return total


@njit(cache=True, nogil=True, fastmath={"contract", "reassoc"})
def _reduce(r: Array, step: float, q: Array) -> float:
    """Subtract what a step takes from a residual and return the norm of what remains."""
    total = 0.0
    for k in range(r.size):
        r[k] -= step * q[k]
        total += r[k] * r[k]
    return float(total**0.5)


@final
class ConductionSolver:
    """Conjugate gradients with a multigrid cycle for the free cells of a balance.

    The hierarchy is built once and serves any number of right-hand sides.

    Parameters
    ----------
    balance : CellBalance
        Coefficients; only the conductances are used. [any]
    free : ndarray of bool
        Cells with unknown potential. [-]
    """

    def __init__(self, balance: CellBalance, free: BoolArray) -> None:
        c, self._scale = scaled(finest_grid(balance, free))
        self._free = free
        self._levels, self._coarsest = hierarchy(c, bool(balance.ring))
        self._board = board_in(self._levels[0])
        self._operator = tuple(stored_field(self._board, f) for f in (c.gx, c.gy, diagonal_of(c)))

    @property
    def memory(self) -> int:
        """Size of operator, hierarchy and work vectors for one right-hand side. [byte]."""
        fields = [*self._operator, self._free]
        levels = [field for level in self._levels for field in level[4:11]]
        vectors = 4 * self._operator[0].nbytes
        return sum(int(field.nbytes) for field in fields + levels) + vectors

    def precondition(self, rhs: Array) -> Array:
        """One cycle: approximate solution, zero where not free; one row per right-hand side."""
        sides = rhs.reshape(-1, *self._free.shape)
        sizes = np.array([norm(side.ravel()) for side in sides])
        units = 1.0 / np.where(sizes > 0.0, sizes, 1.0)
        levels = self._levels_for(len(sides))
        for side, unit, level in zip(sides, units, levels[0].b, strict=True):
            store(self._board, side * unit, level)
        cycle(levels, self._coarsest)
        x = np.empty(sides.shape)
        for field, out in zip(levels[0].x, x, strict=True):
            fetch(self._board, field, out)
        x *= (sizes / self._scale)[:, None, None]
        return x.reshape(rhs.shape)

    def solve(
        self,
        rhs: Array,
        start: Array | None = None,
        *,
        relative_tolerance: float = 1e-10,
        max_iterations: int = 100,
    ) -> tuple[Array, int]:
        """Potentials of the free cells for one or several right-hand sides, and the iterations.

        Several right-hand sides are iterated in step, with one pass over the operators for all.

        Parameters
        ----------
        rhs : ndarray, shape (rows, lanes) or (sides, rows, lanes)
            Net flow into the cells; ignored where not free. [any]
        start : ndarray, optional
            Potentials to begin with, as of a former solution. [any]
        relative_tolerance : float
            Residual over right-hand side at which to stop. [-]
        max_iterations : int
            Limit. [-]

        Returns
        -------
        tuple of ndarray and int
            Potentials in the shape of ``rhs``, and the largest number of iterations. [any, -]
        """
        r = self._stored(rhs)
        r /= self._scale
        x = np.zeros_like(r) if start is None else self._stored(start)
        count = self._iterate(x, r, relative_tolerance, max_iterations)
        out = np.empty((len(x), *self._free.shape))
        for field, rows in zip(x, out, strict=True):
            fetch(self._board, field, rows)
        return out.reshape(rhs.shape), count

    def _stored(self, values: Array) -> Array:
        """Fields stored by colours, zero where not free."""
        given = np.where(self._free, values, 0.0).reshape(-1, *self._free.shape)
        out = np.zeros((len(given), *stored(self._board)))
        for rows, field in zip(given, out, strict=True):
            store(self._board, rows, field)
        return out

    def _iterate(self, x: Array, r: Array, tolerance: float, max_iterations: int) -> int:
        """Improve stored potentials whose right-hand sides come in ``r``."""
        limits = [tolerance * norm(side.ravel()) for side in r]
        p, q = np.zeros_like(r), np.zeros_like(r)
        if x.any():
            _conduct(self._board, self._operator, x, q)
            r -= q
        sizes = [norm(side.ravel()) for side in r]
        # one factor for all cycles, so that single precision neither overflows nor vanishes
        units = np.array([1.0 / max(size, 1e-300) for size in sizes])
        levels = self._levels_for(len(r))
        former = np.ones(len(r))
        for count in range(max_iterations):
            poor = [k for k, size in enumerate(sizes) if size > limits[k]]
            if not poor:
                return count
            _load(levels[0].b, r, units)
            cycle(levels, self._coarsest)
            for k in poor:
                z = levels[0].x[k].ravel()
                product = _dot(r[k].ravel(), z)
                _turn(p[k].ravel(), z, product / former[k] if count else 0.0)
                former[k] = product
            _conduct(self._board, self._operator, p, q)
            for k in poor:
                step = former[k] / _dot(p[k].ravel(), q[k].ravel())
                add_scaled(x[k].ravel(), step, p[k].ravel())
                sizes[k] = _reduce(r[k].ravel(), step, q[k].ravel())
        return max_iterations

    def _levels_for(self, sides: int) -> tuple[Level, ...]:
        return self._levels if sides == 1 else for_sides(self._levels, sides)
