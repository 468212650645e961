"""Elimination of whole rows of a ring of cells, in single precision, around which one iterates.

The five-point matrix couples neighbouring rows cell by cell only, so the blocks of the rows are
eliminated one after another with their inverses in store. Prescribed cells at both ends of a row
take no part, which for faces of gears leaves a third of the work.
"""

from __future__ import annotations

from typing import NamedTuple, final

import numpy as np
from numpy.typing import NDArray

from toothspace.core.compiled import inlined, kernel, njit
from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.numerics.banded import stencil_products
from toothspace.numerics.krylov import combine, extend
from toothspace.numerics.linear_system import (
    LEAST_CORRECTION,
    PRESCRIBED,
    STALLED,
    TIGHT,
    LinearSystem,
)
from toothspace.numerics.vectors import add_scaled, norm, put

_OVERLAP = 24
"""Rows that the cut ring is run through twice, so that it hardly notices the cut. [-]"""
_WORN = 10
"""Iterations of one solution from which fresh blocks are cheaper. [-]"""
_OTHER = 100.0
"""Ratio of diagonals from which a cell holds another unknown than before. [-]"""
_ROUGH = 1e-3
"""Residual over right-hand side from which one solution with the blocks is tried first. [-]"""
_ROUNDS, _SHARE, _MOST = 6, 0.5, 40
"""Rounds of Krylov iterations, the part of the goal that one aims at, its most iterations. [-]"""

Single = NDArray[np.float32]


class Blocks(NamedTuple):
    """Eliminated rows of a ring."""

    coupling: Single
    """Coefficients of west, south, north and east over that of the centre. Shape (4, rows, lanes).
    [any]
    """
    inverse: Array
    """Inverse of the coefficients of the centre. Shape (cells,). [any]"""
    known: BoolArray
    """Prescribed cells. Shape (rows, lanes). [-]"""
    span: IntArray
    store: Single
    cut: int
    """Lanes of every block, inverses, and the row before which the ring is cut."""


class _Scratch(NamedTuple):
    """Memory that a solution writes into."""

    swept: Single  # (rows and two overlaps, lanes), zero at first
    lines: Single  # two rows with their padding
    basis: Array
    images: Array
    projected: Array
    found: Array
    product: Array
    rest: Array  # (cells,)


def _scratch(rows: int, lanes: int) -> _Scratch:
    cells = rows * lanes
    return _Scratch(
        np.zeros((rows + 2 * _OVERLAP, lanes), dtype=np.float32),
        np.zeros((2, lanes + 16), dtype=np.float32),
        np.empty((_MOST + 1, cells)),
        np.empty((_MOST, cells)),
        np.zeros((_MOST + 3, _MOST + 1)),
        np.empty(cells),
        np.empty((1, cells)),
        np.empty(cells),
    )


@njit(nogil=True, fastmath=True, error_model="numpy", _nrt=False)
def _invert_pivot(block: Single, k: int, pivot: Single) -> None:
    """Inverse of the four rows and columns from the k-th on."""
    for a in range(4):
        for b in range(4):
            pivot[a, b] = block[k + a, k + b]
    for a in range(4):
        factor = np.float32(1.0) / pivot[a, a]
        pivot[a, a] = 1.0
        for b in range(4):
            pivot[a, b] *= factor
        for c in range(4):
            if c != a:
                factor, pivot[c, a] = pivot[c, a], 0.0
                for b in range(4):
                    pivot[c, b] -= factor * pivot[a, b]


@njit(nogil=True, fastmath=True, error_model="numpy", _nrt=False)
def _replace_pivot(block: Single, k: int, pivot: Single, lead: Single) -> None:
    """Multiply four rows by the inverse of their pivot, in place and into ``lead``."""
    for a in range(4):
        for b in range(4):
            block[k + a, k + b] = 1.0 if a == b else 0.0
    for a in range(4):
        p0, p1, p2, p3 = pivot[a, 0], pivot[a, 1], pivot[a, 2], pivot[a, 3]
        for j in range(block.shape[1]):
            value = p0 * block[k, j] + p1 * block[k + 1, j]
            lead[a, j] = value + p2 * block[k + 2, j] + p3 * block[k + 3, j]
    for a in range(4):
        for j in range(block.shape[1]):
            block[k + a, j] = lead[a, j]


@njit(nogil=True, fastmath=True, error_model="numpy", _nrt=False)
def _clear_two(first: Single, second: Single, lead: Single, k: int) -> None:
    """Take four leading rows out of two rows at once: half the loads of one by one."""
    x0, x1, x2, x3 = first[k], first[k + 1], first[k + 2], first[k + 3]
    y0, y1, y2, y3 = second[k], second[k + 1], second[k + 2], second[k + 3]
    for a in range(4):
        first[k + a], second[k + a] = 0.0, 0.0
    r0, r1, r2, r3 = lead[0], lead[1], lead[2], lead[3]
    for j in range(first.size):
        a, b, c, d = r0[j], r1[j], r2[j], r3[j]
        first[j] -= x0 * a + x1 * b + x2 * c + x3 * d
        second[j] -= y0 * a + y1 * b + y2 * c + y3 * d


@njit(nogil=True, fastmath=True, error_model="numpy", _nrt=False)
def _invert(block: Single, lead: Single, pivot: Single) -> None:
    """Inverse in place by Gauss and Jordan, four columns at a time, without exchange of rows.

    Columns beyond the rows are padding; ``lead`` has five rows of scratch, ``pivot`` four by four.
    """
    size = block.shape[0]
    whole = size - size % 4
    # no exchange of rows: the matrix of a film has dominant columns
    for k in range(0, whole, 4):
        _invert_pivot(block, k, pivot)
        _replace_pivot(block, k, pivot, lead)
        for i in range(0, size - 1, 2):
            if i // 4 != k // 4:
                _clear_two(block[i], block[i + 1], lead, k)
        if size % 2 == 1:
            _clear_two(block[size - 1], lead[4], lead, k)
    for k in range(whole, size):
        last, factor = block[k], np.float32(1.0) / block[k, k]
        last[k] = 1.0
        for j in range(last.size):
            last[j] *= factor
        for i in range(size):
            if i != k:
                row = block[i]
                factor, row[k] = row[k], 0.0
                for j in range(row.size):
                    row[j] -= factor * last[j]


@kernel
def _scale(stencil: Array, coupling: Single, inverse: Array) -> None:
    """Coefficients of the neighbours over that of the centre, and the inverse of the latter."""
    _, rows, lanes = coupling.shape
    for i in range(rows):
        for j in range(lanes):
            r = i * lanes + j
            inverse[r] = 1.0 / stencil[r, 2]
            for k in range(4):
                coupling[k, i, j] = stencil[r, k + k // 2] * inverse[r]


@kernel
def _fill_units(inverse: Array, stencil: Array, unit: Array) -> bool:
    """Scales of cells that hold another unknown than in the blocks; whether there are such."""
    other = False
    for r in range(unit.size):
        ratio = inverse[r] * stencil[r, 2]
        differs = ratio > _OTHER or ratio < 1.0 / _OTHER
        unit[r] = 1.0 / ratio if differs else 1.0
        other = other or differs
    return other


@kernel
def _spans(kind: IntArray, out: IntArray) -> None:
    """First lane, number of lanes, padded width and place in store of the block of every row."""
    rows, lanes = kind.shape
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


@njit(nogil=True, fastmath=True, error_model="numpy", _nrt=False)
def _eliminate(
    coupling: Single, span: IntArray, cut: int, store: Single, lead: Single, pivot: Single
) -> None:
    """Inverses of the blocks of all rows, each less what the rows before it took over."""
    rows = coupling.shape[1]
    # begun some rows before the cut: by the time it reaches the first row that counts, the error of
    # having begun from nothing has decayed
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
            # the row before is eliminated: it answers to this one through its inverse
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
        _invert(block, lead, pivot)


@njit(nogil=True, fastmath=True, error_model="numpy", _nrt=False)
def _apply(block: Single, x: Single, out: Single) -> None:
    for i in range(block.shape[0]):
        row = block[i]
        total = np.float32(0.0)
        for j in range(row.size):
            total += row[j] * x[j]
        out[i] = total


@njit(nogil=True, fastmath=True, error_model="numpy", _nrt=False)
def _substitute(blocks: Blocks, unit: Array, rhs: Array, scratch: _Scratch, x: Array) -> None:
    """Approximate solution: forward through the ring and back. ``unit`` scales the unknowns."""
    coupling, span, store = blocks.coupling, blocks.span, blocks.store
    _, rows, lanes = coupling.shape
    total = rows + 2 * _OVERLAP
    # single precision spans 38 decades: sides are solved as parts of their largest value
    # right-hand side over the coefficients of the centre, and its largest value
    size = 0.0
    for r in range(x.size):
        x[r] = rhs[r] * blocks.inverse[r]
        size = max(size, abs(x[r]))
    if size == 0.0:
        return
    z, v, moved = scratch.swept, scratch.lines[0], scratch.lines[1]
    for n in range(total):
        i = (blocks.cut - _OVERLAP + n) % rows
        low, count, width, place = span[i]
        v[count:width] = 0.0
        for k in range(count):
            v[k] = x[i * lanes + low + k] / size
        if n > 0:
            for k in range(count):
                v[k] -= coupling[0, i, low + k] * z[n - 1, low + k]
        block = store[place : place + count * width].reshape(count, width)
        _apply(block, v[:width], moved)
        for k in range(count):
            z[n, low + k] = moved[k]
    for n in range(total - 2, -1, -1):
        i = (blocks.cut - _OVERLAP + n) % rows
        low, count, width, place = span[i]
        v[count:width] = 0.0
        for k in range(count):
            v[k] = coupling[3, i, low + k] * z[n + 1, low + k]
        block = store[place : place + count * width].reshape(count, width)
        _apply(block, v[:width], moved)
        for k in range(count):
            z[n, low + k] -= moved[k]
    for n in range(rows):
        i = (blocks.cut + n) % rows
        low, count = span[i, 0], span[i, 1]
        for k in range(count):
            x[i * lanes + low + k] = z[n + _OVERLAP, low + k] * size
    for r in range(unit.size):
        x[r] *= unit[r]


@inlined
def _difference(a: Array, b: Array, out: Array) -> None:
    for k in range(out.size):
        out[k] = a[k] - b[k]


@kernel
def _refine(
    stencil: Array,
    blocks: Blocks,
    unit: Array,
    sides: Array,
    scratch: _Scratch,
    x: Array,
    relative_tolerance: float,
) -> int:
    """Correct solutions in place until the residual of each is small; most iterations."""
    rows, lanes = blocks.known.shape
    basis, images, projected = scratch.basis, scratch.images, scratch.projected
    product, rest, effort = scratch.product, scratch.rest, 0
    for k in range(len(sides)):
        left, former = norm(sides[k]), np.inf
        goal = relative_tolerance * left
        stencil_products(stencil, x[k : k + 1], rows, lanes, product)
        _difference(sides[k], product[0], rest)
        # a start of another operating point may be worse than none
        if norm(rest) < left:
            left = norm(rest)
        else:
            x[k] = 0.0
            put(rest, sides[k])
        for _ in range(_ROUNDS):
            # what rounding keeps from falling is left: another round would add noise
            if not (left > goal and left < STALLED * former):
                break
            limit = max(_SHARE * goal, LEAST_CORRECTION * left)
            projected[:] = 0.0
            projected[-1, 0] = left
            for j in range(rest.size):
                basis[0, j] = rest[j] / left
            count, missing = 0, left
            while count < _MOST and missing > limit:
                _substitute(blocks, unit, basis[count], scratch, images[count])
                stencil_products(stencil, images[count : count + 1], rows, lanes, product)
                missing = extend(basis, projected, count, product[0])
                count += 1
            combine(images, projected, count, scratch.found)
            add_scaled(x[k], 1.0, scratch.found)
            effort = max(effort, count)
            stencil_products(stencil, x[k : k + 1], rows, lanes, product)
            _difference(sides[k], product[0], rest)
            former, left = left, norm(rest)
    return effort


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
        unit = np.empty(blocks.inverse.size)
        self._unit = unit if _fill_units(blocks.inverse, stencil, unit) else unit[:0]
        self.effort = 0
        """Iterations of the last solution. [-]"""

    def serves(self, known: BoolArray) -> bool:
        """Whether the rows did well and the same cells are prescribed."""
        return self.effort <= _WORN and np.array_equal(self.blocks.known, known)

    def solve(
        self, rhs: Array, start: Array | None = None, relative_tolerance: float = TIGHT
    ) -> Array:
        """Solution in grid order, one row per right-hand side if there are several."""
        sides = np.ascontiguousarray(rhs.reshape(-1, rhs.shape[-1]))
        x, goal, tried = np.zeros(sides.shape), relative_tolerance, 0
        scratch = _scratch(*self.blocks.known.shape)
        if start is not None:
            x[:] = start.reshape(sides.shape)
        elif goal >= _ROUGH:
            # blocks of a matrix nearby are often enough by themselves
            for side, one in zip(sides, x, strict=True):
                _substitute(self.blocks, self._unit, side, scratch, one)
            tried = 1
        more = _refine(self._stencil, self.blocks, self._unit, sides, scratch, x, goal)
        self.effort = max(tried, more)
        return x.reshape(rhs.shape)


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
    span = np.zeros((len(kind) + 1, 4), dtype=np.int64)
    _spans(kind, span)
    store = np.empty(int(span[-1, 3]), dtype=np.float32)
    cut = (int(np.argmax(known.sum(axis=1))) + 1) % kind.shape[0]
    coupling, inverse = np.empty((4, *kind.shape), dtype=np.float32), np.empty(kind.size)
    _scale(stencil, coupling, inverse)
    lead, pivot = np.zeros((5, kind.shape[1] + 16), np.float32), np.empty((4, 4), np.float32)
    _eliminate(coupling, span, cut, store, lead, pivot)
    if not np.isfinite(store).all():
        return None
    return BlockSystem(stencil, Blocks(coupling, inverse, known, span, store, cut))
