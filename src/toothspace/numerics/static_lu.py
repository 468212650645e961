r"""LU factors of small sparse matrices :math:`B - \gamma J` whose patterns never change.

J is the Jacobian with respect to unknowns z that determine the states, :math:`y = B z`; they
are the states themselves where B is the identity. The patterns are analysed once (order of
fewest updates, fill-in); the factorisation is then a fixed list of row updates on packed values,
cut into runs that the compiler vectorises.
Rows are not exchanged: if a pivot is small, the matrix is factorised again as a dense
one with partial pivoting. Patterns that fill up are dense from the start.

References
----------
.. [1] I. S. Duff, A. M. Erisman and J. K. Reid, *Direct Methods for Sparse Matrices*,
   2nd ed., Oxford University Press, 2017, chapters 7 and 10.
"""

from __future__ import annotations

from functools import lru_cache
from typing import NamedTuple

import numpy as np
from numpy.typing import NDArray

from toothspace.core.compiled import njit, passed_by_address
from toothspace.core.types import Array, BoolArray, IntArray

SPARSE_FACTORS = 0
DENSE_FACTORS = 1
SINGULAR = 2
"""Return codes of :func:`factorise`."""

_DENSE_SHARE = 0.75
_SMALL_PIVOT = 1e-8

Index = NDArray[np.uint32]

_kernel = njit(error_model="numpy", _nrt=False)

summing_kernel = njit(
    error_model="numpy",
    _nrt=False,
    fastmath={"reassoc", "contract"},
)
"""For sums, whose terms may then be added in any order."""


@passed_by_address
class LuProgram(NamedTuple):
    """List of operations of one pattern, made by :func:`analyse`."""

    order: Index
    """Row and column eliminated at each stage. Shape (n,)."""
    dense: IntArray
    """1 if the factors are so full that dense ones are faster. Shape (1,)."""
    packed_size: IntArray
    """Number of packed values. Shape (1,)."""
    source: Index
    source_place: Index
    """Flat places in the Jacobian that may be nonzero, and their packed places."""
    row_start: Index
    diagonal: Index
    columns: Index
    """Packed rows in elimination order: lower part, diagonal, upper part."""
    pair_start: Index
    pair_lower: Index
    run_start: Index
    """For each stage the rows it updates: place of the multiplier, first run."""
    run_upper: Index
    run_target: Index
    run_length: Index
    """Contiguous pieces of a row update."""
    ledger_start: Index
    ledger_columns: Index
    """Nonzero columns of the rows below the core (compressed rows)."""
    basis_rows: Index
    basis_columns: Index
    """Places of the basis off its diagonal that may be nonzero."""


def analyse(pattern: BoolArray, basis: BoolArray | None = None) -> LuProgram:
    """Analyse the patterns of a Jacobian and of the basis of its unknowns.

    Input of :func:`factorise`, :func:`solve`, :func:`ledger_product` and :func:`states_of`.

    Raises ValueError if the pattern has fewer rows than columns.

    Parameters
    ----------
    pattern : ndarray of bool, shape (n_total, n_core), n_total >= n_core
        True where the Jacobian may be nonzero. The first n_core rows are factorised; the
        others (ledger) are only multiplied with vectors.
    basis : ndarray of bool, shape (n_core, n_core), optional
        True where the basis may differ from the identity.
    """
    n_total, n = pattern.shape
    if n_total < n:
        raise ValueError(f"pattern has {n_total} rows and {n} columns; rows >= columns are needed")
    own = np.eye(n, dtype=bool)
    basis = own if basis is None else basis | own
    return _analysed(pattern.tobytes(), basis.tobytes(), n)


@lru_cache(maxsize=16)
def _analysed(pattern_bytes: bytes, basis_bytes: bytes, n: int) -> LuProgram:
    """Program of patterns as bytes: the machines of one case have the same."""
    pattern = np.frombuffer(pattern_bytes, dtype=bool).reshape(-1, n)
    basis = np.frombuffer(basis_bytes, dtype=bool).reshape(-1, n)
    n_total = len(pattern)
    core = pattern[:n] | basis
    graph = core.copy()
    np.fill_diagonal(graph, False)
    size = core.shape[0]
    left = np.ones(size, dtype=bool)
    order = np.zeros(size, dtype=np.int64)
    for stage in range(size):
        updates = np.where(left, graph.sum(axis=0) * graph.sum(axis=1), size * size)
        node = int(np.argmin(updates))
        order[stage] = node
        graph[np.ix_(graph[:, node], graph[node])] = True
        graph[node, :] = graph[:, node] = False
        np.fill_diagonal(graph, False)
        left[node] = False
    # every elimination fills the product of its column and its row
    filled = core[np.ix_(order, order)].copy()
    for k in range(filled.shape[0]):
        below = k + 1 + np.nonzero(filled[k + 1 :, k])[0]
        right = k + 1 + np.nonzero(filled[k, k + 1 :])[0]
        filled[np.ix_(below, right)] = True
    packed = np.full((n, n), -1, dtype=np.int64)
    packed[filled] = np.arange(int(filled.sum()))
    pairs = _row_updates(filled, packed)
    rows, columns = np.nonzero(core)
    rank = np.argsort(order)
    ledger_rows, ledger_columns = np.nonzero(pattern[n:])
    basis_rows, basis_columns = np.nonzero(basis & ~np.eye(n, dtype=bool))
    counts = np.bincount(ledger_rows, minlength=n_total - n)
    return LuProgram(
        order=_index(order),
        dense=np.array([int(filled.mean() > _DENSE_SHARE)]),
        packed_size=np.array([int(filled.sum())]),
        source=_index(rows * n + columns),
        source_place=_index(packed[rank[rows], rank[columns]]),
        row_start=_index(np.append(0, np.cumsum(filled.sum(axis=1)))),
        diagonal=_index(np.diagonal(packed)),
        columns=_index(np.nonzero(filled)[1]),
        **pairs,
        ledger_start=_index(np.append(0, np.cumsum(counts))),
        ledger_columns=_index(ledger_columns),
        basis_rows=_index(basis_rows),
        basis_columns=_index(basis_columns),
    )


def _index(values: IntArray) -> Index:
    return np.ascontiguousarray(values, dtype=np.uint32)


def _row_updates(filled: BoolArray, packed: IntArray) -> dict[str, Index]:
    """List for every stage the rows it changes and the contiguous pieces of the change."""
    pair_start, pair_lower, run_start = [0], [], [0]
    runs: list[tuple[int, int, int]] = []
    for k in range(filled.shape[0]):
        right = k + 1 + np.nonzero(filled[k, k + 1 :])[0]
        for i in k + 1 + np.nonzero(filled[k + 1 :, k])[0]:
            pair_lower.append(int(packed[i, k]))
            upper = packed[k, right]
            target = packed[i, right]
            if target.size == 0:
                found = []
            else:
                breaks = np.nonzero(np.diff(target) != 1)[0] + 1
                pieces = np.split(np.arange(target.size), breaks)
                found = [(int(upper[p[0]]), int(target[p[0]]), int(p.size)) for p in pieces]
            runs += found
            run_start.append(len(runs))
        pair_start.append(len(pair_lower))
    table = np.array(runs, dtype=np.int64).reshape(-1, 3)
    return {
        "pair_start": _index(np.array(pair_start)),
        "pair_lower": _index(np.array(pair_lower, dtype=np.int64)),
        "run_start": _index(np.array(run_start)),
        "run_upper": _index(table[:, 0]),
        "run_target": _index(table[:, 1]),
        "run_length": _index(table[:, 2]),
    }


@njit(error_model="numpy", _nrt=False)
def factorise(
    program: LuProgram, jacobian: Array, basis: Array, gamma: float, values: Array, pivots: IntArray
) -> int:
    r"""Factorise :math:`B - \gamma J`.

    SPARSE_FACTORS, DENSE_FACTORS or SINGULAR (also if an entry is not finite).

    Parameters
    ----------
    program : LuProgram
        Analysed pattern.
    jacobian : ndarray, shape (n_total, n)
        Jacobian with respect to the unknowns; rows from n on are not read.
    basis : ndarray, shape (n, n)
        States from unknowns, with ones on its diagonal.
    gamma : float
        Factor of the Jacobian. [s]
    values : ndarray, shape (max(packed size, n * n),)
        Receives the factors.
    pivots : ndarray of int, shape (n,)
        Receives the row exchanges of dense factors.
    """
    if program.dense[0] == 0:
        flat, own = jacobian.reshape(-1), basis.reshape(-1)
        values[: program.packed_size[0]] = 0.0
        source, place = program.source, program.source_place
        for entry in range(source.size):
            values[place[entry]] = own[source[entry]] - gamma * flat[source[entry]]
        if _eliminate(program, values):
            return SPARSE_FACTORS
    n = pivots.size
    a = values[: n * n].reshape((n, n))
    for i in range(n):
        for j in range(n):
            a[i, j] = basis[i, j] - gamma * jacobian[i, j]
    for k in range(n):
        best = k
        for i in range(k + 1, n):
            if abs(a[i, k]) > abs(a[best, k]):
                best = i
        pivots[k] = best
        if not (abs(a[best, k]) > 0.0 and np.isfinite(a[best, k])):
            return SINGULAR
        _eliminate_dense_column(a, k, best)
    return DENSE_FACTORS


@_kernel
def _eliminate(program: LuProgram, values: Array) -> bool:
    """Eliminate without row exchanges; the diagonal is left inverted."""
    pair_start, pair_lower, run_start = program.pair_start, program.pair_lower, program.run_start
    run_upper, run_target, run_length = program.run_upper, program.run_target, program.run_length
    sound = True
    for k in range(program.diagonal.size):
        pivot = values[program.diagonal[k]]
        sound = sound and abs(pivot) > _SMALL_PIVOT and np.isfinite(pivot)
        inverse = 1.0 / pivot
        values[program.diagonal[k]] = inverse
        for pair in range(pair_start[k], pair_start[k + 1]):
            factor = values[pair_lower[pair]] * inverse
            if factor == 0.0:
                continue
            values[pair_lower[pair]] = factor
            for run in range(run_start[pair], run_start[pair + 1]):
                upper, target = run_upper[run], run_target[run]
                for j in range(run_length[run]):
                    values[target + j] -= factor * values[upper + j]
    return sound


@_kernel
def _eliminate_dense_column(a: Array, k: int, best: int) -> None:
    n = a.shape[0]
    if best != k:
        for j in range(n):
            a[k, j], a[best, j] = a[best, j], a[k, j]
    inverse = 1.0 / a[k, k]
    a[k, k] = inverse
    for i in range(k + 1, n):
        factor = a[i, k] * inverse
        if factor != 0.0:
            a[i, k] = factor
            for j in range(k + 1, n):
                a[i, j] -= factor * a[k, j]


@njit(error_model="numpy", _nrt=False)
def solve(
    program: LuProgram, values: Array, pivots: IntArray, kind: int, right: Array, scratch: Array
) -> None:
    """Solve with the factors; the solution replaces the right-hand side.

    Parameters
    ----------
    program : LuProgram
        Analysed pattern.
    values, pivots : ndarray
        Factors from :func:`factorise`.
    kind : int
        What :func:`factorise` returned: SPARSE_FACTORS or DENSE_FACTORS.
    right : ndarray, shape (n,)
        Right-hand side, overwritten by the solution.
    scratch : ndarray, shape (>= n,)
        Work space.
    """
    if kind == SPARSE_FACTORS:
        _solve_sparse(program, values, right, scratch)
    else:
        _solve_dense(values, pivots, right)


@summing_kernel
def _solve_sparse(program: LuProgram, values: Array, right: Array, x: Array) -> None:
    order, diagonal, columns = program.order, program.diagonal, program.columns
    row_start = program.row_start
    n = order.size
    for i in range(n):
        total = right[order[i]]
        for entry in range(row_start[i], diagonal[i]):
            total -= values[entry] * x[columns[entry]]
        x[i] = total
    for back in range(n):
        i = n - 1 - back
        total = x[i]
        for entry in range(diagonal[i] + 1, row_start[i + 1]):
            total -= values[entry] * x[columns[entry]]
        x[i] = total * values[diagonal[i]]
        right[order[i]] = x[i]


@summing_kernel
def _solve_dense(values: Array, pivots: IntArray, right: Array) -> None:
    n = pivots.size
    a = values[: n * n].reshape((n, n))
    for k in range(n):
        right[k], right[pivots[k]] = right[pivots[k]], right[k]
        for j in range(k):
            right[k] -= a[k, j] * right[j]
    for back in range(n):
        i = n - 1 - back
        for j in range(i + 1, n):
            right[i] -= a[i, j] * right[j]
        right[i] *= a[i, i]


@njit(error_model="numpy", _nrt=False)
def ledger_product(program: LuProgram, jacobian: Array, vector: Array, product: Array) -> None:
    """Multiply the ledger rows of the Jacobian with a core vector.

    Parameters
    ----------
    program : LuProgram
        Analysed pattern.
    jacobian : ndarray, shape (n_total, n)
        Jacobian.
    vector : ndarray, shape (n,)
        Factor.
    product : ndarray, shape (n_total - n,)
        Receives the product.
    """
    n = program.order.size
    start, columns = program.ledger_start, program.ledger_columns
    for row in range(start.size - 1):
        total = 0.0
        for entry in range(start[row], start[row + 1]):
            column = columns[entry]
            total += jacobian[n + row, column] * vector[column]
        product[row] = total


@njit(error_model="numpy", _nrt=False)
def states_of(program: LuProgram, basis: Array, unknowns: Array, states: Array) -> None:
    """Compute states from unknowns.

    Parameters
    ----------
    program : LuProgram
        Analysed patterns.
    basis : ndarray, shape (n, n)
        States from unknowns, with ones on its diagonal.
    unknowns : ndarray, shape (n,)
        Unknowns.
    states : ndarray, shape (>= n,)
        Receives the states.
    """
    for i in range(unknowns.size):
        states[i] = unknowns[i]
    rows, columns = program.basis_rows, program.basis_columns
    for entry in range(rows.size):
        states[rows[entry]] += basis[rows[entry], columns[entry]] * unknowns[columns[entry]]
