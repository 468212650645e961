"""Smooth basis functions of the gap of one face: waves round it times polynomials of the radius."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from functools import cached_property
from typing import final

import numpy as np
import scipy.sparse as sp
from scipy.linalg import cho_factor, cho_solve

from toothspace.core.types import Array, BoolArray
from toothspace.films.reynolds.equation import GapField
from toothspace.floating.face_grid import FaceGrid

_ASIDE = 0.01
"""Weight of cells beside the film, which determine waves shorter than a tooth space. [-]"""


@final
@dataclass(frozen=True, eq=False)
class BasisFunctions:
    """Basis functions of one face."""

    grid: FaceGrid
    """Face."""
    waves: int
    """Most waves round the circumference, at least one. [-]"""
    degree: int
    """Largest degree of the polynomials, at least one: then planes are among them. [-]"""
    film: BoolArray | None = None
    """Cells that fields are fitted on, in place of all. What such a fit leaves has no mean there,
    so that it hardly squeezes the film.
    """
    _round: Array = field(init=False, repr=False)
    _along: Array = field(init=False, repr=False)

    def __post_init__(self) -> None:
        object.__setattr__(self, "_round", self._turns(self.grid.angle))
        object.__setattr__(self, "_along", self._powers(self.grid.radius))

    @property
    def count(self) -> int:
        """Number of basis functions. [-]."""
        return self._round.shape[1] * self._along.shape[1]

    def fit(self, values: Array) -> Array:
        """Coefficients of the least-squares fit of a field. [as the field]."""
        moments = self._round.T @ ((self._weight * values) @ self._along)
        return np.asarray(cho_solve(self._gram, moments.ravel()))

    def combine(self, coefficients: Array) -> Array:
        """Field with given coefficients. [as the coefficients]."""
        table = coefficients.reshape(self._round.shape[1], self._along.shape[1])
        return np.asarray(self._round @ table @ self._along.T)

    def fit_rows(self, fields: sp.spmatrix) -> Array:
        """Coefficients of many fields, which are the rows of a sparse matrix, row by row."""
        turns, powers = self._round, self._along
        cells, count = fields.tocoo(), fields.shape[0]
        row, lane = np.divmod(cells.col, self.grid.lanes)
        data = cells.data * self._weight[row, lane]
        found = np.empty((count, turns.shape[1], powers.shape[1]))
        for k, power in enumerate(powers.T):
            values = (data * power[lane], (cells.row, row))
            found[:, :, k] = sp.csr_matrix(values, shape=(count, self.grid.rows)) @ turns
        return np.asarray(cho_solve(self._gram, found.reshape(count, self.count).T).T)

    @cached_property
    def _weight(self) -> Array:
        if self.film is None:
            return np.ones(self.grid.area.shape)
        return np.where(self.film, 1.0, _ASIDE)

    @cached_property
    def _gram(self) -> tuple[Array, bool]:
        """Factors of the sums of products of all basis functions."""
        turns, powers, size = self._round, self._along, self._along.shape[1]
        found = np.empty((turns.shape[1], size, turns.shape[1], size))
        for k in range(size):
            for m in range(k + 1):
                weight = self._weight @ (powers[:, k] * powers[:, m])
                found[:, k, :, m] = found[:, m, :, k] = turns.T @ (weight[:, None] * turns)
        return cho_factor(found.reshape(self.count, self.count))

    def planes(self) -> Array:
        """Coefficients of unit lift and rotations about x and y, shape (count, 3). [-, m]."""
        middle, half = self._radii()
        found = np.zeros((self._round.shape[1], self._along.shape[1], 3))
        found[0, 0, 0] = 1.0
        found[2, :2, 1] = middle, half
        found[1, :2, 2] = -middle, -half
        return found.reshape(self.count, 3)

    def gap_changes(self, frequency: float) -> Iterator[GapField]:
        """Change of the gap by every basis function that grows at a given frequency. [1/s]."""
        rows = self.grid.rows
        edges = self._turns(np.arange(rows + 1) * 2.0 * np.pi / rows)
        rims = self._powers(self.grid.rims)
        still = np.zeros((rows, self.grid.lanes))
        for turn, edge in zip(self._round.T, edges.T, strict=True):
            for power, rim in zip(self._along.T, rims.T, strict=True):
                centre = np.outer(turn, power)
                sides = np.outer(edge, power), np.outer(turn, rim)
                yield GapField(centre, *sides, frequency * centre, still)

    def _radii(self) -> tuple[float, float]:
        own = self.grid.interface.face
        return 0.5 * (own.outer_radius + own.inner_radius), 0.5 * (
            own.outer_radius - own.inner_radius
        )

    def _turns(self, angle: Array) -> Array:
        waves = np.arange(1, self.waves + 1) * angle[:, None]
        pairs = np.stack([np.cos(waves), np.sin(waves)], axis=2).reshape(angle.size, -1)
        return np.hstack([np.ones((angle.size, 1)), pairs])

    def _powers(self, radius: Array) -> Array:
        middle, half = self._radii()
        return np.asarray(np.polynomial.legendre.legvander((radius - middle) / half, self.degree))
