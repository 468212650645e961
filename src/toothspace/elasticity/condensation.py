"""Condensation of a large stiffness matrix to the flexibility of chosen loads.

Nested dissection orders the nodes; the fronts of the multifrontal method carry the load columns
with them, so that loads, not factors, are what is kept: memory is that of the open fronts.
"""

from __future__ import annotations

from typing import NamedTuple, final

import numpy as np
import scipy.sparse as sp
from scipy.linalg.blas import dsyrk, dtrsm
from scipy.linalg.lapack import dpotrf

from toothspace.core.compiled import njit
from toothspace.core.errors import GeometryError
from toothspace.core.types import Array, BoolArray, IntArray

_LEAF = 96
"""Nodes below which a part is not divided."""


@final
class Separator(NamedTuple):
    """Part of the nodes that is eliminated at once."""

    nodes: IntArray
    children: tuple[int, ...]


def dissect(nodes: Array, graph: sp.csr_matrix) -> list[Separator]:
    """Parts of a nested dissection in the order of elimination.

    Parameters
    ----------
    nodes : ndarray, shape (n, 3)
        Places; parts are cut across their longest extent. [m]
    graph : csr_matrix
        Pattern of the node couplings. [-]

    Returns
    -------
    list of Separator
        Children before parents; the last is the root.
    """
    tree: list[Separator] = []
    side = np.zeros(len(nodes), dtype=np.int8)

    def divide(part: IntArray) -> int:
        if part.size <= _LEAF:
            tree.append(Separator(part, ()))
            return len(tree) - 1
        low, high, cut = _halves(part, nodes, graph, side)
        children = tuple(divide(half) for half in (low, high) if half.size)
        tree.append(Separator(cut, children))
        return len(tree) - 1

    divide(np.arange(len(nodes), dtype=np.int64))
    return tree


def _halves(
    part: IntArray, nodes: Array, graph: sp.csr_matrix, side: np.ndarray
) -> tuple[IntArray, IntArray, IntArray]:
    """Two halves and the nodes of the one that touch the other."""
    place = nodes[part]
    axis = int(np.argmax(np.ptp(place, axis=0)))
    middle = float(np.median(place[:, axis]))
    below = place[:, axis] < middle
    if not below.any():
        below = place[:, axis] <= middle
    low, high = part[below], part[~below]
    side[low], side[high] = 1, 2
    touching_high = _touching(low, graph, side, 2)
    touching_low = _touching(high, graph, side, 1)
    side[part] = 0
    if touching_high.sum() <= touching_low.sum():
        return low[~touching_high], high, low[touching_high]
    return low, high[~touching_low], high[touching_low]


@njit(cache=True)
def _find_touching(
    part: IntArray, start: Array, column: Array, side: Array, other: int
) -> BoolArray:
    out = np.zeros(part.size, dtype=np.bool_)
    for k in range(part.size):
        for j in range(start[part[k]], start[part[k] + 1]):
            if side[column[j]] == other:
                out[k] = True
                break
    return out


def _touching(part: IntArray, graph: sp.csr_matrix, side: np.ndarray, other: int) -> BoolArray:
    return np.asarray(_find_touching(part, graph.indptr, graph.indices, side, other))


class _Front(NamedTuple):
    # what a part leaves to its parent: nodes, load columns, their matrix
    nodes: IntArray
    columns: IntArray
    matrix: Array  # (3 nodes, 3 nodes + columns), lower part of the square


def flexibility(
    stiffness: sp.csr_matrix, nodes: Array, loads: sp.csc_matrix, fixed: IntArray
) -> Array:
    r"""Work of every load on the displacement by every other, :math:`F^T K^{-1} F`.

    Parameters
    ----------
    stiffness : csr_matrix
        Symmetric stiffness, three unknowns per node. [N/m]
    nodes : ndarray, shape (n, 3)
        Places of the nodes. [m]
    loads : csc_matrix, shape (3 n, m)
        One load per column. [N]
    fixed : ndarray of int
        Unknowns that are held. [-]

    Returns
    -------
    ndarray, shape (m, m)
        Flexibility, symmetric positive semidefinite. [N m]

    Raises
    ------
    GeometryError
        If the body is not held or falls apart.

    References
    ----------
    .. [1] A. George, Nested dissection of a regular finite element mesh, SIAM J. Numer. Anal.
       10 (1973) 345-363.
    .. [2] I. S. Duff, J. K. Reid, The multifrontal solution of indefinite sparse symmetric
       linear equations, ACM Trans. Math. Softw. 9 (1983) 302-325.
    """
    stiffness, rows = _held(stiffness, loads.tocsr(), fixed)
    graph = _node_graph(stiffness)
    tree = dissect(nodes, graph)
    total = np.zeros((loads.shape[1], loads.shape[1]))
    done = np.zeros(len(nodes), dtype=bool)
    place = np.empty(len(nodes), dtype=np.int64)
    open_fronts: dict[int, _Front] = {}
    for index, part in enumerate(tree):
        children = [open_fronts.pop(child) for child in part.children]
        front = _eliminated(part.nodes, children, (stiffness, graph, rows), (done, place), total)
        open_fronts[index] = front
    return np.asarray(np.tril(total) + np.tril(total, -1).T)


def _held(
    stiffness: sp.csr_matrix, loads: sp.csr_matrix, fixed: IntArray
) -> tuple[sp.csr_matrix, sp.csr_matrix]:
    """Decouple held unknowns and drop their loads."""
    if not fixed.size:
        return stiffness, loads
    keep = np.ones(stiffness.shape[0])
    keep[fixed] = 0.0
    mask = sp.diags(keep)
    held = np.zeros_like(keep)
    held[fixed] = stiffness.diagonal()[fixed]
    # adding the diagonal keeps the pattern of 3 x 3 blocks
    return (mask @ stiffness @ mask + sp.diags(held)).tocsr(), (mask @ loads).tocsr()


def _node_graph(stiffness: sp.csr_matrix) -> sp.csr_matrix:
    blocks = stiffness.tobsr(blocksize=(3, 3))
    blocks.sort_indices()
    count = len(blocks.indptr) - 1
    return sp.csr_matrix(
        (np.ones(blocks.indices.size, dtype=np.int8), blocks.indices, blocks.indptr),
        shape=(count, count),
    )


def _unknowns(nodes: IntArray) -> IntArray:
    return (3 * nodes[:, None] + np.arange(3)).ravel()


@njit(cache=True)
def _gather(
    own: IntArray, start: Array, column: Array, value: Array, place: IntArray, out: Array
) -> None:
    """Entries of the rows of a part at their places in its front; lower part."""
    for k in range(own.size):
        for a in range(3):
            row = 3 * own[k] + a
            for j in range(start[row], start[row + 1]):
                node = column[j] // 3
                target = place[node]
                if target < 0:
                    continue
                i = 3 * target + column[j] - 3 * node
                if i >= 3 * k + a:
                    out[i, 3 * k + a] += value[j]


@njit(cache=True)
def _extend(child: Array, rows: IntArray, columns: IntArray, out: Array) -> None:
    """Add the lower part of a child's matrix, node rows and load columns."""
    size = rows.size
    for j in range(size):
        for i in range(j, size):
            r, c = rows[i], rows[j]
            if r < c:
                r, c = c, r
            out[r, c] += child[i, j]
        for i in range(columns.size):
            out[columns[i], rows[j]] += child[size + i, j]


def _eliminated(
    own: IntArray,
    children: list[_Front],
    system: tuple[sp.csr_matrix, sp.csr_matrix, sp.csr_matrix],
    marks: tuple[np.ndarray, IntArray],
    total: Array,
) -> _Front:
    stiffness, graph, loads = system
    done, place = marks
    outer = _outer_nodes(own, children, graph, done)
    mine = loads[_unknowns(own)].tocoo()
    columns = _union([mine.col, *(child.columns for child in children)])
    count, size = 3 * own.size, 3 * (own.size + outer.size)
    front = np.zeros((size + columns.size, size), order="F")
    place[:] = -1
    place[own] = np.arange(own.size)
    place[outer] = own.size + np.arange(outer.size)
    _gather(own, stiffness.indptr, stiffness.indices, stiffness.data, place, front)
    front[size + np.searchsorted(columns, mine.col), mine.row] = mine.data
    for child in children:
        rows = (3 * place[child.nodes][:, None] + np.arange(3)).ravel()
        _extend(child.matrix, rows, size + np.searchsorted(columns, child.columns), front)
    done[own] = True
    return _Front(outer, columns, _reduced(front, count, size, columns, total))


def _outer_nodes(
    own: IntArray, children: list[_Front], graph: sp.csr_matrix, done: np.ndarray
) -> IntArray:
    """Nodes that stay and are coupled to a part."""
    near = [graph.indices[graph.indptr[k] : graph.indptr[k + 1]] for k in own]
    found = _union([*near, *(child.nodes for child in children)])
    mask = ~done[found]
    return np.setdiff1d(found[mask], own, assume_unique=True)


def _union(pieces: list[IntArray]) -> IntArray:
    return np.unique(np.concatenate([np.asarray(p, dtype=np.int64) for p in pieces]))


def _reduced(front: Array, count: int, size: int, columns: IntArray, total: Array) -> Array:
    """Eliminate the first unknowns; the work of the loads on them is added to the total."""
    if count == 0:
        return front
    lower, info = dpotrf(front[:count, :count], lower=1)
    if info != 0:
        raise GeometryError(
            "elastic body: found a body that is not held or not in one piece, allowed are bodies "
            "with a support or one that floats as a whole"
        )
    below = dtrsm(1.0, lower, front[count:, :count], side=1, lower=1, trans_a=1)
    outer = size - count
    loads = below[outer:]
    if columns.size:
        work = dsyrk(1.0, loads, lower=1)
        total[np.ix_(columns, columns)] += work
    rest = np.asfortranarray(front[count:, count:])
    if outer:
        rest[:outer] = dsyrk(-1.0, below[:outer], beta=1.0, c=rest[:outer], lower=1)
        rest[outer:] -= loads @ below[:outer].T
    return rest
