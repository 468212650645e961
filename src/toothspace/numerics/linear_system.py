"""One pass of an active-set method as a linear system: direct, or iterative with multigrid."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol, final

import numpy as np

from toothspace.core.compiled import njit
from toothspace.core.types import Array, IntArray
from toothspace.numerics.banded import (
    Single,
    empty_band,
    factor_band,
    fill_band,
    solve_bands,
    stencil_products,
)
from toothspace.numerics.krylov import Operator, gmres
from toothspace.numerics.multigrid import MultigridPreconditioner
from toothspace.numerics.structured_grid import CellBalance, grid_shape
from toothspace.numerics.vectors import norm

SATURATED = 0
UNSATURATED = 1
PRESCRIBED = 2

DIRECT_LIMIT = 5.0e8
"""Cells times squared lanes up to which the band is factored. [-]"""
TIGHT = 1e-12
"""Relative residual of a finished solution. [-]"""
LOOSE = 1e-5
"""Relative residual that is enough to revise an active set with an iterative method. [-]"""
LEAST_CORRECTION = 1e-13
"""Relative residual below which one round of Krylov iterations does not try to get. [-]"""
TOGETHER = 1_000_000
"""Unknowns of all right-hand sides that are iterated together: each needs a Krylov space. [-]"""
_ROUNDED = 1e-14
"""Relative residual of a finished solution with a band, which costs it an iteration more. [-]"""
STALLED = 0.5
"""Part of its residual to which a round must bring a solution for another one to follow. [-]"""
_DIRECT_ROUNDS = (3, 0.5, 60)
_ITERATIVE_ROUNDS = (6, 0.3, 40)
"""Rounds of Krylov iterations, the part of the goal that one aims at, its most iterations."""


@final
@dataclass(frozen=True)
class DirectSystem:
    """Band factored in single precision, of a ring that is cut at one row.

    A few Krylov iterations close the ring and give the other digits. They also make up for a
    band that is that of a system nearby.
    """

    stencil: Array
    factored: Array
    band: Single
    rows: int
    lanes: int
    cut: int

    def solve(
        self, rhs: Array, start: Array | None = None, relative_tolerance: float = TIGHT
    ) -> Array:
        """Solution in grid order, one row per right-hand side if there are several."""
        sides = rhs.reshape(-1, rhs.shape[-1])
        known = None if start is None else start.reshape(sides.shape)
        goal = relative_tolerance if relative_tolerance > TIGHT else _ROUNDED
        x, _ = refined(self._product, self._precondition, sides, known, goal, _DIRECT_ROUNDS)
        return x.reshape(rhs.shape)

    def _product(self, x: Array) -> Array:
        return np.asarray(stencil_products(self.stencil, x, self.rows, self.lanes))

    def _precondition(self, x: Array) -> Array:
        shift = self.cut * self.lanes
        return np.asarray(solve_bands(self.band, self.factored, self.stencil, x, shift))


@final
@dataclass(frozen=True)
class IterativeSystem:
    """Krylov iteration; multigrid for potentials, one sweep along the flow for saturations."""

    stencil: Array
    kind: IntArray
    multigrid: MultigridPreconditioner
    first: int
    backward: bool

    def solve(
        self, rhs: Array, start: Array | None = None, relative_tolerance: float = TIGHT
    ) -> Array:
        """Solution in grid order, one row per right-hand side if there are several."""
        sides = rhs.reshape(-1, rhs.shape[-1])
        known = None if start is None else start.reshape(sides.shape)
        together = max(1, TOGETHER // sides.shape[1])
        parts = [
            refined(
                self._product,
                self._precondition,
                sides[k : k + together],
                None if known is None else known[k : k + together],
                relative_tolerance,
                _ITERATIVE_ROUNDS,
            )[0]
            for k in range(0, len(sides), together)
        ]
        return np.concatenate(parts).reshape(rhs.shape)

    def _product(self, x: Array) -> Array:
        rows, lanes = self.kind.shape
        return np.asarray(stencil_products(self.stencil, x, rows, lanes))

    def _precondition(self, rhs: Array) -> Array:
        saturated = (self.kind == SATURATED).ravel()
        x = self.multigrid.apply(np.where(saturated, rhs, 0.0))
        _sweep(self.stencil, self.kind, rhs, x, self.first, self.backward)
        return x


def _lengths(sides: Array) -> Array:
    """Lengths of the rows."""
    return np.array([norm(side) for side in sides])


def refined(
    product: Operator,
    precondition: Operator,
    sides: Array,
    start: Array | None,
    relative_tolerance: float,
    rounds: tuple[int, float, int],
) -> tuple[Array, int]:
    """Correct solutions by Krylov iterations until the residual of every right-hand side is small.

    A start that leaves more than nothing would is not taken, and what rounding keeps from
    falling is left.

    Returns
    -------
    tuple of ndarray and int
        Solutions, and the most iterations of one round. [any, -]
    """
    (most, share, iterations), effort = rounds, 0
    x, remainder, sizes = np.zeros_like(sides), sides, _lengths(sides)
    goals, former = relative_tolerance * sizes, np.full(len(sides), np.inf)
    if start is not None:
        left = sides - product(start)
        better = _lengths(left) < sizes
        x[better], remainder = start[better], np.where(better[:, None], left, sides)
        sizes = _lengths(remainder)
    for _ in range(most):
        poor = np.flatnonzero((sizes > goals) & (sizes < STALLED * former))
        if poor.size == 0:
            break
        within = np.maximum(share * goals[poor], LEAST_CORRECTION * sizes[poor])
        correction, count = gmres(
            product, precondition, remainder[poor], limits=within, max_iterations=iterations
        )
        x[poor] += correction
        effort = max(effort, count)
        remainder = sides - product(x)
        former, sizes = sizes, _lengths(remainder)
    return x, effort


@njit
def _sweep(
    stencil: Array, kind: IntArray, rhs: Array, x: Array, first: int, backward: bool
) -> None:
    """Saturations in the order of the flow, prescribed rows on their own."""
    rows, lanes = kind.shape
    for step in range(rows):
        i = (first - step) % rows if backward else (first + step) % rows
        west, east = (i + rows - 1) % rows, (i + 1) % rows
        for k in range(rhs.shape[0]):
            for j in range(lanes):
                r = i * lanes + j
                if kind[i, j] == 0:
                    continue
                total = rhs[k, r]
                if kind[i, j] == 1:
                    total -= stencil[r, 0] * x[k, west * lanes + j]
                    total -= stencil[r, 4] * x[k, east * lanes + j]
                    if j > 0:
                        total -= stencil[r, 1] * x[k, r - 1]
                    if j < lanes - 1:
                        total -= stencil[r, 3] * x[k, r + 1]
                x[k, r] = total / stencil[r, 2]


class LinearSystem(Protocol):
    """Linear system of one pass."""

    def solve(
        self, rhs: Array, start: Array | None = None, relative_tolerance: float = TIGHT
    ) -> Array:
        """Solution in grid order, residual over right-hand side as asked."""
        ...  # pragma: no cover


def prefers_direct(balance: CellBalance) -> bool:
    """Whether factoring the band is cheaper than iterating."""
    rows, lanes = grid_shape(balance)
    return float(rows) * lanes**3 <= DIRECT_LIMIT


_CHANGED_PER_LANE = 0.125
"""Changed rows per lane up to which iterations with an old band are cheaper than a new one. [-]"""


@final
class PassSystems:
    """Linear systems of one pass after another of an active-set method on one grid.

    Parameters
    ----------
    balance : CellBalance
        Coefficients. [any]
    """

    def __init__(self, balance: CellBalance) -> None:
        self._balance = balance
        self._direct = prefers_direct(balance)
        rows, lanes = grid_shape(balance)
        self._band = empty_band(rows if self._direct else 0, lanes)
        self._factored: tuple[DirectSystem, IntArray] | None = None

    def system(self, stencil: Array, kind: IntArray) -> LinearSystem:
        """System for given kinds of the cells; an earlier band serves on while few changed."""
        if not self._direct:
            return iterative_system(self._balance, stencil, kind)
        if self._factored is not None:
            former, known = self._factored
            if np.count_nonzero(kind != known) <= _CHANGED_PER_LANE * former.lanes:
                return replace(former, stencil=stencil)
        system = self._direct_system(stencil, kind)
        self._factored = system, kind.copy()
        return system

    def _direct_system(self, stencil: Array, kind: IntArray) -> DirectSystem:
        """Factor the matrix of one pass; a ring is cut where it couples least."""
        rows, lanes = grid_shape(self._balance)
        coupled = (kind == SATURATED).sum(axis=1)
        cut = (int(np.argmin(coupled)) + 1) % rows if self._balance.ring else 0
        fill_band(stencil, rows, lanes, cut, self._band)
        factor_band(self._band, lanes)
        return DirectSystem(stencil, stencil, self._band, rows, lanes, cut)


def iterative_system(balance: CellBalance, stencil: Array, kind: IntArray) -> IterativeSystem:
    """Build the hierarchy for the saturated cells of one pass."""
    rows, _ = grid_shape(balance)
    backward = bool(balance.advection_x.sum() < 0.0)
    first = int(np.argmin((kind == UNSATURATED).sum(axis=1))) if balance.ring else 0
    if backward and not balance.ring:
        first = rows - 1
    multigrid = MultigridPreconditioner(balance, kind == SATURATED)
    return IterativeSystem(stencil, kind.copy(), multigrid, first, backward)
