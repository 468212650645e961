"""Smooth basis functions of the gap of one face: waves round it times polynomials of the radius."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import final

import numpy as np
import scipy.sparse as sp

from toothspace.core.types import Array
from toothspace.films.lateral.face_grid import FaceGrid
from toothspace.films.reynolds.equation import GapField


@final
@dataclass(frozen=True, eq=False)
class BasisFunctions:
    """Basis functions of one face.

    Parameters
    ----------
    grid : FaceGrid
        Face.
    waves : int
        Most waves round the circumference, at least one. [-]
    degree : int
        Largest degree of the polynomials, at least one: then planes are among them. [-]
    """

    grid: FaceGrid
    waves: int
    degree: int
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
        turns, powers = self._fits()
        return np.asarray((turns.T @ (values @ powers)).ravel())

    def combine(self, coefficients: Array) -> Array:
        """Field with given coefficients. [as the coefficients]."""
        table = coefficients.reshape(self._round.shape[1], self._along.shape[1])
        return np.asarray(self._round @ table @ self._along.T)

    def fit_rows(self, fields: sp.spmatrix) -> Array:
        """Coefficients of many fields, which are the rows of a sparse matrix, row by row."""
        turns, powers = self._fits()
        cells, count = fields.tocoo(), fields.shape[0]
        row, lane = np.divmod(cells.col, self.grid.lanes)
        found = np.empty((count, turns.shape[1], powers.shape[1]))
        for k, power in enumerate(powers.T):
            values = (cells.data * power[lane], (cells.row, row))
            found[:, :, k] = sp.csr_matrix(values, shape=(count, self.grid.rows)) @ turns
        return found.reshape(count, self.count)

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

    def _fits(self) -> tuple[Array, Array]:
        turns = self._round / (self._round**2).sum(axis=0)
        return turns, np.asarray(np.linalg.pinv(self._along).T, dtype=np.float64)

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
