"""Linear systems of the passes of an active-set method, solved with a band."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Protocol, final

import numpy as np

from toothspace.core.types import Array, IntArray
from toothspace.numerics.banded import (
    Single,
    empty_band,
    factor_band,
    fill_band,
    solve_bands,
    stencil_products,
)
from toothspace.numerics.krylov import gmres
from toothspace.numerics.structured_grid import CellBalance, grid_shape
from toothspace.numerics.vectors import norm

SATURATED = 0
UNSATURATED = 1
PRESCRIBED = 2

TIGHT = 1e-12
"""Relative residual of a finished solution. [-]"""
LOOSE = 1e-5
"""Relative residual that is enough to revise an active set. [-]"""
LEAST_CORRECTION = 1e-13
"""Relative residual below which one round of Krylov iterations does not try to get. [-]"""
_ROUNDED = 1e-14
"""Relative residual of a finished solution with a band, which costs it an iteration more. [-]"""
STALLED = 0.5
"""Part of its residual to which a round must bring a solution for another one to follow. [-]"""
_ROUNDS, _SHARE, _MOST = 3, 0.5, 60
"""Rounds of Krylov iterations, the part of the goal that one aims at, its most iterations. [-]"""


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
        # Krylov iterations correct the solutions: a start that leaves more than nothing would is
        # not taken, and what rounding keeps from falling is left
        x, remainder, sizes = np.zeros_like(sides), sides, _lengths(sides)
        goals, former = goal * sizes, np.full(len(sides), np.inf)
        if known is not None:
            left = sides - self._product(known)
            better = _lengths(left) < sizes
            x[better], remainder = known[better], np.where(better[:, None], left, sides)
            sizes = _lengths(remainder)
        for _ in range(_ROUNDS):
            poor = np.flatnonzero((sizes > goals) & (sizes < STALLED * former))
            if poor.size == 0:
                break
            within = np.maximum(_SHARE * goals[poor], LEAST_CORRECTION * sizes[poor])
            correction, _ = gmres(
                self._product,
                self._precondition,
                remainder[poor],
                limits=within,
                max_iterations=_MOST,
            )
            x[poor] += correction
            remainder = sides - self._product(x)
            former, sizes = sizes, _lengths(remainder)
        return x.reshape(rhs.shape)

    def _product(self, x: Array) -> Array:
        found = np.empty(x.shape)
        stencil_products(self.stencil, x, self.rows, self.lanes, found)
        return found

    def _precondition(self, x: Array) -> Array:
        shift = self.cut * self.lanes
        return solve_bands(self.band, self.factored, self.stencil, x, shift)


def _lengths(sides: Array) -> Array:
    """Lengths of the rows."""
    return np.array([norm(side) for side in sides])


class LinearSystem(Protocol):
    """Linear system of one pass."""

    def solve(
        self, rhs: Array, start: Array | None = None, relative_tolerance: float = TIGHT
    ) -> Array:
        """Solution in grid order, residual over right-hand side as asked."""
        ...  # pragma: no cover


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
        self._ring = balance.ring
        self._band = empty_band(*grid_shape(balance))
        self._factored: tuple[DirectSystem, IntArray] | None = None

    def system(self, stencil: Array, kind: IntArray) -> DirectSystem:
        """System for given kinds of the cells; an earlier band serves on while few changed."""
        if self._factored is not None:
            former, known = self._factored
            if np.count_nonzero(kind != known) <= _CHANGED_PER_LANE * former.lanes:
                return replace(former, stencil=stencil)
        system = direct_system(stencil, kind, self._band, ring=self._ring)
        self._factored = system, kind.copy()
        return system


def direct_system(
    stencil: Array, kind: IntArray, band: Single, *, ring: bool = True
) -> DirectSystem:
    """Factor the matrix of one pass in a band; a ring is cut where it couples least."""
    rows, lanes = kind.shape
    coupled = (kind == SATURATED).sum(axis=1)
    cut = (int(np.argmin(coupled)) + 1) % rows if ring else 0
    fill_band(stencil, rows, lanes, cut, band)
    factor_band(band, lanes)
    return DirectSystem(stencil, stencil, band, rows, lanes, cut)
