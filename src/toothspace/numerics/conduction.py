"""Conduction on masked structured grids: conjugate gradients with a multigrid cycle.

The cycle of :mod:`toothspace.numerics.multigrid` works in single precision, the iteration
around it in double precision.
"""

from __future__ import annotations

from typing import final

import numpy as np

from toothspace.core.compiled import njit
from toothspace.core.types import Array, BoolArray
from toothspace.numerics.multigrid import Single, cycle, finest_grid, hierarchy, neighbour_rows
from toothspace.numerics.structured_grid import CellBalance
from toothspace.numerics.vectors import add_scaled, dot, norm


@njit(cache=True, fastmath={"contract"})
def _conduct(gx: Array, gy: Array, diagonal: Array, p: Array, q: Array, ring: bool) -> None:
    """Product of the conductive operator of the free cells and a field."""
    rows, lanes = p.shape
    for i in range(rows):
        west, east = neighbour_rows(i, rows, ring)
        centre, out, d = p[i], q[i], diagonal[i]
        p_west, p_east, g_west, g_east = p[west], p[east], gx[i], gx[i + 1]
        for j in range(lanes):
            out[j] = d[j] * centre[j] - g_west[j] * p_west[j] - g_east[j] * p_east[j]
        between = gy[i, 1:lanes]
        upper, lower, tail = centre[1:], centre[: lanes - 1], out[1:]
        for j in range(lanes - 1):
            out[j] -= between[j] * upper[j]
        for j in range(lanes - 1):
            tail[j] -= between[j] * lower[j]


@njit(cache=True)
def _load(target: Single, source: Array, factor: float) -> None:
    flat = target.reshape(target.size)
    for k in range(source.size):
        flat[k] = source[k] * factor


@njit(cache=True, fastmath={"contract"})
def _turn(p: Array, z: Single, beta: float) -> None:
    """New search direction: preconditioned residual plus a part of the last direction."""
    flat = z.reshape(z.size)
    for k in range(p.size):
        p[k] = flat[k] + beta * p[k]


@njit(cache=True, fastmath={"contract", "reassoc"})
def _mixed_dot(a: Array, b: Single) -> float:
    flat = b.reshape(b.size)
    total = 0.0
    for k in range(a.size):
        total += a[k] * flat[k]
    return total


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
        c = finest_grid(balance, free)
        self._gx, self._gy = c.gx, c.gy
        diagonal = c.gx[:-1] + c.gx[1:] + c.gy[:, :-1] + c.gy[:, 1:] + c.outer_x + c.outer_y
        self._diagonal = np.where(diagonal > 0.0, diagonal, 1.0)
        self._free = free
        self._ring = balance.ring
        self._levels, self._scale = hierarchy(c, balance.ring)

    @property
    def memory(self) -> int:
        """Size of operator, hierarchy and work vectors. [byte]."""
        fields = [self._gx, self._gy, self._diagonal, self._free]
        levels = [array for level in self._levels for array in level[:6]]
        return sum(int(array.nbytes) for array in fields + levels) + 4 * self._diagonal.nbytes

    def precondition(self, rhs: Array) -> Array:
        """One cycle: approximate solution, zero where not free."""
        size = norm(rhs)
        if size == 0.0:
            return np.zeros_like(rhs)
        _load(self._levels[0].b, rhs, 1.0 / size)
        cycle(self._levels)
        return self._levels[0].x.astype(np.float64).ravel() * (size / self._scale)

    def solve(
        self,
        rhs: Array,
        start: Array | None = None,
        *,
        relative_tolerance: float = 1e-10,
        max_iterations: int = 100,
    ) -> tuple[Array, int]:
        """Potentials of the free cells for one right-hand side, and the number of iterations.

        Parameters
        ----------
        rhs : ndarray, shape (rows, lanes)
            Net flow into the cells; ignored where not free. [any]
        start : ndarray, optional
            Potentials to begin with, as of a former solution. [any]
        relative_tolerance : float
            Residual over right-hand side at which to stop. [-]
        max_iterations : int
            Limit. [-]
        """
        shape = rhs.shape
        target = np.where(self._free, rhs, 0.0).ravel()
        x = np.zeros_like(target) if start is None else np.where(self._free, start, 0.0).ravel()
        p, q = np.zeros_like(target), np.zeros_like(target)
        self._product(x, q)
        r = target - q
        limit = relative_tolerance * norm(target)
        former, unit = 1.0, 1.0 / max(norm(r), 1e-300)
        for count in range(max_iterations):
            if norm(r) <= limit:
                return x.reshape(shape), count
            # one factor for all cycles, so that single precision neither overflows nor vanishes
            _load(self._levels[0].b, r, unit)
            cycle(self._levels)
            z = self._levels[0].x
            product = _mixed_dot(r, z)
            _turn(p, z, product / former if count else 0.0)
            self._product(p, q)
            step = product / dot(p, q)
            former = product
            add_scaled(x, step, p)
            add_scaled(r, -step, q)
        return x.reshape(shape), max_iterations

    def _product(self, p: Array, q: Array) -> None:
        shape = self._free.shape
        _conduct(self._gx, self._gy, self._diagonal, p.reshape(shape), q.reshape(shape), self._ring)
