"""Conduction on masked structured grids: conjugate gradients with a multigrid cycle.

The cycle of :mod:`toothspace.numerics.multigrid_cycle` works in single precision, the iteration
around it in double precision. All fields are stored by colours.
"""

from __future__ import annotations

from typing import final

import numpy as np

from toothspace.core.types import Array, BoolArray
from toothspace.numerics.colouring import fetch, store, stored, stored_field
from toothspace.numerics.conjugate import advance, conduct, load, mixed_dot, turn
from toothspace.numerics.multigrid import diagonal_of, finest_grid, for_sides, hierarchy, power_near
from toothspace.numerics.multigrid_cycle import Level, cycle, grid_of
from toothspace.numerics.structured_grid import CellBalance
from toothspace.numerics.vectors import norm


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
        largest = max(balance.conductance_x.max(), balance.conductance_y.max())
        self._scale = power_near(float(largest))
        c = finest_grid(balance, free, self._scale)
        self._free = free
        self._levels, self._coarsest = hierarchy(c, bool(balance.ring))
        self._grid = grid_of(self._levels[0])
        gx, gy, diagonal = (stored_field(self._grid, f) for f in (c.gx, c.gy, diagonal_of(c)))
        self._operator = gx, gy, diagonal

    @property
    def memory(self) -> int:
        """Size of operator, hierarchy and work vectors for one right-hand side. [byte]."""
        fields = [*self._operator, self._free]
        levels = [field for level in self._levels for field in level[4:12]]
        vectors = 4 * self._operator[0].nbytes
        return sum(int(field.nbytes) for field in fields + levels) + vectors

    def precondition(self, rhs: Array) -> Array:
        """One cycle: approximate solution, zero where not free; one row per right-hand side."""
        sides = rhs.reshape(-1, *self._free.shape)
        sizes = np.array([norm(side.ravel()) for side in sides])
        units = 1.0 / np.where(sizes > 0.0, sizes, 1.0)
        levels = self._levels_for(len(sides))
        for side, unit, level in zip(sides, units, levels[0].b, strict=True):
            store(self._grid, side * unit, level)
        cycle(levels, self._coarsest)
        x = np.empty(sides.shape)
        for field, out in zip(levels[0].x, x, strict=True):
            fetch(self._grid, field, out)
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
            fetch(self._grid, field, rows)
        return out.reshape(rhs.shape), count

    def _stored(self, values: Array) -> Array:
        """Fields stored by colours, zero where not free."""
        given = np.where(self._free, values, 0.0).reshape(-1, *self._free.shape)
        out = np.zeros((len(given), *stored(self._grid)))
        for rows, field in zip(given, out, strict=True):
            store(self._grid, rows, field)
        return out

    def _iterate(self, x: Array, r: Array, tolerance: float, max_iterations: int) -> int:
        """Improve stored potentials whose right-hand sides come in ``r``."""
        limits = [tolerance * norm(side.ravel()) for side in r]
        p, q = np.zeros_like(r), np.zeros_like(r)
        if x.any():
            conduct(self._grid, self._operator, x, q)
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
            load(levels[0].b, r, units)
            cycle(levels, self._coarsest)
            for k in poor:
                z = levels[0].x[k].ravel()
                product = mixed_dot(r[k].ravel(), z)
                turn(p[k].ravel(), z, product / former[k] if count else 0.0)
                former[k] = product
            curvature = conduct(self._grid, self._operator, p, q)
            for k in poor:
                step = former[k] / curvature[k]
                sizes[k] = advance(x[k].ravel(), r[k].ravel(), p[k].ravel(), q[k].ravel(), step)
        return max_iterations

    def _levels_for(self, sides: int) -> tuple[Level, ...]:
        return self._levels if sides == 1 else for_sides(self._levels, sides)
