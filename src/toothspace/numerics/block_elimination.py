"""Elimination of whole rows of a ring of cells, in single precision, around which one iterates.

The five-point matrix couples neighbouring rows cell by cell only, so the blocks of the rows are
eliminated one after another with their inverses in store. Prescribed cells at both ends of a row
take no part, which for faces of gears leaves a third of the work.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
from numpy.typing import NDArray

from toothspace.core.compiled import njit
from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.numerics.banded import stencil_product
from toothspace.numerics.krylov import gmres
from toothspace.numerics.linear_system import PRESCRIBED, TIGHT, LinearSystem
from toothspace.numerics.vectors import norm

_OVERLAP = 24
"""Rows that the cut ring is run through twice, so that it hardly notices the cut. [-]"""
_WORN = 10
"""Iterations of one solution from which fresh blocks are cheaper. [-]"""
_OTHER = 100.0
"""Ratio of diagonals from which a cell holds another unknown than before. [-]"""
_ROUNDS = 6
_KRYLOV = 40

Single = NDArray[np.float32]


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def _invert(block: Single, size: int) -> None:
    """Inverse in place by Gauss and Jordan, two columns at a time, without exchange of rows."""
    width = block.shape[1]
    for k in range(0, size - 1, 2):
        r0, r1 = block[k], block[k + 1]
        a, b, c, d = r0[k], r0[k + 1], r1[k], r1[k + 1]
        s = np.float32(1.0) / (a * d - b * c)
        a, b, c, d = d * s, -b * s, -c * s, a * s
        r0[k], r0[k + 1], r1[k], r1[k + 1] = 1.0, 0.0, 0.0, 1.0
        for j in range(width):
            x, y = r0[j], r1[j]
            r0[j] = a * x + b * y
            r1[j] = c * x + d * y
        for i in range(size):
            if i == k or i == k + 1:
                continue
            row = block[i]
            x, y = row[k], row[k + 1]
            row[k], row[k + 1] = 0.0, 0.0
            for j in range(width):
                row[j] -= x * r0[j] + y * r1[j]
    if size % 2 == 1:
        last = block[size - 1]
        x = np.float32(1.0) / last[size - 1]
        last[size - 1] = 1.0
        for j in range(width):
            last[j] *= x
        for i in range(size - 1):
            row = block[i]
            x, row[size - 1] = row[size - 1], 0.0
            for j in range(width):
                row[j] -= x * last[j]


@njit(cache=True, nogil=True)
def _spans(kind: IntArray) -> IntArray:
    """First lane, number of lanes, padded width and place in store of the block of every row."""
    rows, lanes = kind.shape
    out = np.zeros((rows + 1, 4), dtype=np.int64)
    for i in range(rows):
        low, high = 0, lanes
        while low < lanes and kind[i, low] == 2:
            low += 1
        while high > low and kind[i, high - 1] == 2:
            high -= 1
        size = high - low
        width = (size + 15) // 16 * 16
        out[i, 0], out[i, 1], out[i, 2] = low, size, width
        out[i + 1, 3] = out[i, 3] + size * width
    return out


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def _eliminate(coupling: Single, span: IntArray, cut: int, store: Single) -> None:
    """Inverses of the blocks of all rows, each less what the rows before it took over."""
    rows = coupling.shape[1]
    for n in range(rows + _OVERLAP):
        i = (cut - _OVERLAP + n) % rows
        low, size, width, place = span[i]
        block = store[place : place + size * width].reshape(size, width)
        block[:] = 0.0
        for j in range(size):
            block[j, j] = 1.0
            if j > 0:
                block[j, j - 1] = coupling[1, i, low + j]
            if j < size - 1:
                block[j, j + 1] = coupling[2, i, low + j]
        if n > 0:
            w = (i - 1) % rows
            low_w, size_w, width_w, place_w = span[w]
            former = store[place_w : place_w + size_w * width_w].reshape(size_w, width_w)
            first, last = max(low, low_w), min(low + size, low_w + size_w)
            across = coupling[3, w, first:last]
            for j in range(first, last):
                west = coupling[0, i, j]
                target = block[j - low, first - low : last - low]
                source = former[j - low_w, first - low_w : last - low_w]
                for k in range(target.size):
                    target[k] -= west * source[k] * across[k]
        _invert(block, size)


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def _apply(block: Single, x: Single, out: Single) -> None:
    for i in range(block.shape[0]):
        row = block[i]
        total = np.float32(0.0)
        for j in range(row.size):
            total += row[j] * x[j]
        out[i] = total


@njit(cache=True, nogil=True, fastmath=True, error_model="numpy")
def _substitute(coupling: Single, span: IntArray, cut: int, store: Single, rhs: Array) -> Array:
    """Approximate solution for rows over their centre: forward through the ring and back."""
    _, rows, lanes = coupling.shape
    total = rows + 2 * _OVERLAP
    z = np.zeros((total, lanes), dtype=np.float32)
    v, moved = np.zeros(lanes + 16, dtype=np.float32), np.zeros(lanes + 16, dtype=np.float32)
    for n in range(total):
        i = (cut - _OVERLAP + n) % rows
        low, size, width, place = span[i]
        v[:] = 0.0
        for k in range(size):
            v[k] = rhs[i * lanes + low + k]
        if n > 0:
            for k in range(size):
                v[k] -= coupling[0, i, low + k] * z[n - 1, low + k]
        block = store[place : place + size * width].reshape(size, width)
        _apply(block, v[:width], moved)
        z[n, low : low + size] = moved[:size]
    for n in range(total - 2, -1, -1):
        i = (cut - _OVERLAP + n) % rows
        low, size, width, place = span[i]
        v[:] = 0.0
        for k in range(size):
            v[k] = coupling[3, i, low + k] * z[n + 1, low + k]
        block = store[place : place + size * width].reshape(size, width)
        _apply(block, v[:width], moved)
        z[n, low : low + size] -= moved[:size]
    x = np.empty(rows * lanes)
    for n in range(rows):
        i = (cut + n) % rows
        low, size = span[i, 0], span[i, 1]
        for j in range(lanes):
            r = i * lanes + j
            inside = low <= j < low + size
            x[r] = z[n + _OVERLAP, j] if inside else rhs[r]
    return x


@final
@dataclass(frozen=True, eq=False)
class Blocks:
    """Eliminated rows of a ring.

    Parameters
    ----------
    coupling : ndarray, shape (4, rows, lanes)
        Coefficients of west, south, north and east over that of the centre. [any]
    inverse : ndarray, shape (cells,)
        Inverse of the coefficients of the centre. [any]
    known : ndarray of bool, shape (rows, lanes)
        Prescribed cells. [-]
    span, store, cut
        Lanes of every block, inverses, and the row before which the ring is cut.
    """

    coupling: Single
    inverse: Array
    known: BoolArray
    span: IntArray
    store: Single
    cut: int

    def apply(self, rhs: Array) -> Array:
        """Approximate solution in grid order."""
        scaled = rhs * self.inverse
        size = float(np.abs(scaled).max())
        if size == 0.0:
            return scaled
        scaled /= size
        found = _substitute(self.coupling, self.span, self.cut, self.store, scaled)
        return np.asarray(found * size)


@final
class BlockSystem:
    """Five-point matrix of a ring of cells with the eliminated rows of itself or of one nearby.

    Parameters
    ----------
    stencil : ndarray, shape (cells, 5)
        Coefficients of west, south, centre, north and east. [any]
    blocks : Blocks
        Eliminated rows.
    """

    def __init__(self, stencil: Array, blocks: Blocks) -> None:
        self._stencil, self.blocks = stencil, blocks
        # cells that hold another unknown than in the blocks have another unit
        scale = 1.0 / (blocks.inverse * stencil[:, 2])
        other = (scale > _OTHER) | (scale < 1.0 / _OTHER)
        self._scale = np.where(other, scale, 1.0) if other.any() else None
        self.effort = 0
        """Iterations of the last solution. [-]"""

    def serves(self, known: BoolArray) -> bool:
        """Whether the rows did well and the same cells are prescribed."""
        return self.effort <= _WORN and np.array_equal(self.blocks.known, known)

    def solve(
        self, rhs: Array, start: Array | None = None, relative_tolerance: float = TIGHT
    ) -> Array:
        """Solution in grid order, one row per right-hand side if there are several."""
        if rhs.ndim == 2:
            starts = [None] * len(rhs) if start is None else start
            pairs = zip(rhs, starts, strict=True)
            return np.array([self.solve(one, x, relative_tolerance) for one, x in pairs])
        x = np.zeros_like(rhs) if start is None else start
        limit = relative_tolerance * norm(rhs)
        remainder = rhs if start is None else rhs - self._product(x)
        self.effort = 0
        for _ in range(_ROUNDS):
            size = norm(remainder)
            if size <= limit:
                break
            correction, count = gmres(
                self._product,
                self._precondition,
                remainder,
                relative_tolerance=max(0.5 * limit / size, 1e-13),
                max_iterations=_KRYLOV,
            )
            self.effort = max(self.effort, count)
            x = x + correction
            remainder = rhs - self._product(x)
        return x

    def _precondition(self, rhs: Array) -> Array:
        x = self.blocks.apply(rhs)
        return x if self._scale is None else x * self._scale

    def _product(self, x: Array) -> Array:
        rows, lanes = self.blocks.known.shape
        return stencil_product(self._stencil, x, rows, lanes)


def block_system(
    stencil: Array, kind: IntArray, former: LinearSystem | None = None
) -> BlockSystem | None:
    """Eliminate the rows of a ring, cut where it couples least, or use those of a former matrix.

    None if a pivot vanishes, as in a film that is lost.

    Parameters
    ----------
    stencil : ndarray, shape (cells, 5)
        Coefficients of west, south, centre, north and east. [any]
    kind : ndarray of int, shape (rows, lanes)
        Kinds of the cells; prescribed ones are coupled to nothing. [-]
    former : LinearSystem, optional
        System of a matrix nearby; its rows serve on if they did with few iterations.
    """
    known = kind == PRESCRIBED
    if isinstance(former, BlockSystem) and former.serves(known):
        return BlockSystem(stencil, former.blocks)
    span = _spans(kind)
    store = np.empty(int(span[-1, 3]), dtype=np.float32)
    cut = (int(np.argmax(known.sum(axis=1))) + 1) % kind.shape[0]
    inverse = 1.0 / stencil[:, 2]
    scaled = stencil[:, [0, 1, 3, 4]] * inverse[:, None]
    coupling = np.ascontiguousarray(scaled.T.reshape(4, *kind.shape), dtype=np.float32)
    _eliminate(coupling, span, cut, store)
    if not np.isfinite(store).all():
        return None
    return BlockSystem(stencil, Blocks(coupling, inverse, known, span, store, cut))
