"""Conduction on masked structured grids: conjugate gradients with a multigrid cycle.

The cycle of :mod:`toothspace.numerics.multigrid` works in single precision, the iteration
around it in double precision.
"""

from __future__ import annotations

from typing import final

import numpy as np

from toothspace.core.compiled import njit
from toothspace.core.types import Array, BoolArray
from toothspace.numerics.multigrid import (
    Level,
    Single,
    cycle,
    finest_grid,
    for_sides,
    hierarchy,
    neighbour_rows,
)
from toothspace.numerics.structured_grid import CellBalance
from toothspace.numerics.vectors import add_scaled, dot, norm


@njit(cache=True, fastmath={"contract"})
def _conduct(gx: Array, gy: Array, diagonal: Array, p: Array, q: Array, ring: bool) -> None:
    """Products of the conductive operator of the free cells and fields, first index the field."""
    sides, rows, lanes = p.shape
    for i in range(rows):
        west, east = neighbour_rows(i, rows, ring)
        d, g_west, g_east, between = diagonal[i], gx[i], gx[i + 1], gy[i, 1:lanes]
        for k in range(sides):
            centre, out, p_west, p_east = p[k, i], q[k, i], p[k, west], p[k, east]
            for j in range(lanes):
                out[j] = d[j] * centre[j] - g_west[j] * p_west[j] - g_east[j] * p_east[j]
            upper, lower, tail = centre[1:], centre[: lanes - 1], out[1:]
            for j in range(lanes - 1):
                out[j] -= between[j] * upper[j]
            for j in range(lanes - 1):
                tail[j] -= between[j] * lower[j]


@njit(cache=True)
def _load(target: Single, source: Array, factors: Array) -> None:
    for side in range(factors.size):
        flat, given, factor = target[side].reshape(source.shape[1]), source[side], factors[side]
        for k in range(flat.size):
            flat[k] = given[k] * factor


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
        """Size of operator, hierarchy and work vectors for one right-hand side. [byte]."""
        fields = [self._gx, self._gy, self._diagonal, self._free]
        levels = [array for level in self._levels for array in level[:6]]
        return sum(int(array.nbytes) for array in fields + levels) + 4 * self._diagonal.nbytes

    def precondition(self, rhs: Array) -> Array:
        """One cycle: approximate solution, zero where not free; one row per right-hand side."""
        sides = rhs.reshape(-1, self._diagonal.size)
        sizes = np.array([norm(side) for side in sides])
        units = 1.0 / np.where(sizes > 0.0, sizes, 1.0)
        levels = self._levels_for(len(sides))
        _load(levels[0].b, sides, units)
        cycle(levels)
        x = levels[0].x.reshape(sides.shape).astype(np.float64)
        x *= (sizes / self._scale)[:, None]
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
        target = np.where(self._free, rhs, 0.0).reshape(-1, self._diagonal.size)
        x = np.zeros_like(target)
        if start is not None:
            x[:] = np.where(self._free, start, 0.0).reshape(target.shape)
        p, q = np.zeros_like(target), np.zeros_like(target)
        self._product(x, q)
        r = target - q
        limits = [relative_tolerance * norm(side) for side in target]
        # one factor for all cycles, so that single precision neither overflows nor vanishes
        units = np.array([1.0 / max(norm(side), 1e-300) for side in r])
        levels = self._levels_for(len(target))
        former = np.ones(len(target))
        for count in range(max_iterations):
            poor = [k for k, side in enumerate(r) if norm(side) > limits[k]]
            if not poor:
                return x.reshape(rhs.shape), count
            _load(levels[0].b, r, units)
            cycle(levels)
            for k in poor:
                product = _mixed_dot(r[k], levels[0].x[k])
                _turn(p[k], levels[0].x[k], product / former[k] if count else 0.0)
                former[k] = product
            self._product(p, q)
            for k in poor:
                step = former[k] / dot(p[k], q[k])
                add_scaled(x[k], step, p[k])
                add_scaled(r[k], -step, q[k])
        return x.reshape(rhs.shape), max_iterations

    def _levels_for(self, sides: int) -> tuple[Level, ...]:
        return self._levels if sides == 1 else for_sides(self._levels, sides)

    def _product(self, p: Array, q: Array) -> None:
        shape = (-1, *self._free.shape)
        _conduct(self._gx, self._gy, self._diagonal, p.reshape(shape), q.reshape(shape), self._ring)
