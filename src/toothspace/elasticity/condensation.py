"""Condensation of a large stiffness matrix to the flexibility of chosen loads.

Nested dissection orders the nodes; the fronts of the multifrontal method carry the load columns
with them, so that loads, not factors, are what is kept: memory is that of the open fronts.
"""

from __future__ import annotations

from typing import NamedTuple, final

import numpy as np
import scipy

from toothspace.core.compiled import njit
from toothspace.core.errors import GeometryError
from toothspace.core.progress import report_share
from toothspace.core.types import Array, BoolArray, IntArray


def flexibility(
    stiffness: scipy.sparse.csr_matrix,
    nodes: Array,
    loads: scipy.sparse.csc_matrix,
    fixed: IntArray,
) -> Array:
    r"""Work of every load on the displacement by every other, :math:`F^T K^{-1} F`.

    Flexibility, symmetric positive semidefinite, shape (m, m). [N m]

    Raises GeometryError if the body is not held or falls apart.

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

    References
    ----------
    .. [1] I. S. Duff, J. K. Reid, The multifrontal solution of indefinite sparse symmetric
       linear equations, ACM Trans. Math. Softw. 9 (1983) 302-325.
    """
    stiffness, rows = _held(stiffness, loads.tocsr(), fixed)
    blocks = stiffness.tobsr(blocksize=(3, 3))
    blocks.sort_indices()
    joined = np.ones(blocks.indices.size, dtype=np.int8), blocks.indices, blocks.indptr
    graph = scipy.sparse.csr_matrix(joined, shape=(len(nodes), len(nodes)))
    # parts that share no unknown are eliminated apart, so fronts stay small
    parts: list[_EliminationPart] = []
    done = np.zeros(graph.shape[0], dtype=np.bool_)
    for own, children in dissect(nodes, graph):
        below = [parts[child] for child in children]
        near = [graph.indices[graph.indptr[k] : graph.indptr[k + 1]] for k in own]
        done[own] = True
        found = _union([*near, *(part.outer for part in below)])
        loaded = _union([rows[_unknowns(own)].indices, *(part.columns for part in below)])
        parts.append(_EliminationPart(own, found[~done[found]], loaded, children))
    work = _Workspace.sized(parts)
    total = np.zeros((loads.shape[1], loads.shape[1]))
    place = np.full(len(nodes), -1, dtype=np.int64)
    spent = np.cumsum([sum(part.sizes) ** 2 * part.sizes[0] for part in parts], dtype=float)
    for part, cost in zip(parts, spent, strict=True):
        report_share(float(cost / spent[-1]), "condensing an elastic body, kept for later")
        # own entries, then what the children left; their memory is a stack, the last one on top
        front = work.front(part)
        place[part.own] = np.arange(part.own.size)
        place[part.outer] = part.own.size + np.arange(part.outer.size)
        pattern = (stiffness.indptr, stiffness.indices, stiffness.data)
        _gather(part.own, pattern, place, front.inner, front.below)
        mine = rows[_unknowns(part.own)].tocoo()
        front.loads[np.searchsorted(part.columns, mine.col), mine.row] = mine.data
        for child in reversed(part.children):
            matrix, passed = work.pop(parts[child])
            rows_of = _unknowns(place[parts[child].outer])
            _extend(matrix, rows_of, front.inner, front.below, front.rest)
            columns = np.searchsorted(part.columns, parts[child].columns)
            _extend_loads(passed, rows_of, columns, front.loads, front.passed)
        place[part.own], place[part.outer] = -1, -1
        work.push(part, _eliminated(part, front, total))
    return np.asarray(np.tril(total) + np.tril(total, -1).T)


def _held(
    stiffness: scipy.sparse.csr_matrix, loads: scipy.sparse.csr_matrix, fixed: IntArray
) -> tuple[scipy.sparse.csr_matrix, scipy.sparse.csr_matrix]:
    """Decouple held unknowns and drop their loads."""
    if not fixed.size:
        return stiffness, loads
    keep = np.ones(stiffness.shape[0])
    keep[fixed] = 0.0
    held = stiffness.copy()
    rows = np.repeat(np.arange(keep.size), np.diff(held.indptr))
    held.data *= keep[rows] * keep[held.indices]
    # the diagonal stays, and with it the pattern of 3 x 3 blocks
    own = (rows == held.indices) & (keep[rows] == 0.0)
    held.data[own] = stiffness.data[own]
    return held, (scipy.sparse.diags(keep) @ loads).tocsr()


class _EliminationPart(NamedTuple):
    # nodes that are eliminated, nodes left to the parent, load columns met so far
    own: IntArray
    outer: IntArray
    columns: IntArray
    children: tuple[int, ...]

    @property
    def sizes(self) -> tuple[int, int, int]:
        """Unknowns eliminated and left, and load columns. [-]."""
        return 3 * self.own.size, 3 * self.outer.size, self.columns.size


def _unknowns(nodes: IntArray) -> IntArray:
    return (3 * nodes[:, None] + np.arange(3)).ravel()


def _union(pieces: list[IntArray]) -> IntArray:
    return np.unique(np.concatenate([np.asarray(p, dtype=np.int64) for p in pieces]))


class _Front(NamedTuple):
    # lower part of the matrix of a front by blocks, each contiguous along its columns
    inner: Array  # unknowns eliminated
    below: Array  # unknowns left, unknowns eliminated
    rest: Array  # unknowns left
    loads: Array  # load columns, unknowns eliminated
    passed: Array  # load columns, unknowns left


def _blocks(part: _EliminationPart) -> list[tuple[int, int]]:
    count, outer, loads = part.sizes
    return [(count, count), (outer, count), (outer, outer), (loads, count), (loads, outer)]


_KEPT = slice(2, None, 2)
"""Blocks of a front that its parent takes."""


class _Workspace:
    """Memory of the front in work and of the stack of those that wait for their parents."""

    def __init__(self, front: int, stack: int) -> None:
        self._front = np.empty(front)
        self._stack = np.empty(stack)
        self._top = 0

    @classmethod
    def sized(cls, parts: list[_EliminationPart]) -> _Workspace:
        """Workspace that suits the fronts in their order."""
        top, deepest, largest = 0, 0, 0
        for part in parts:
            sizes = [rows * columns for rows, columns in _blocks(part)]
            largest = max(largest, sum(sizes))
            top += sum(sizes[_KEPT]) - sum(_kept(parts[child]) for child in part.children)
            deepest = max(deepest, top)
        return cls(largest, deepest)

    def front(self, part: _EliminationPart) -> _Front:
        """Front of a part, zero everywhere."""
        shapes = _blocks(part)
        self._front[: sum(rows * columns for rows, columns in shapes)] = 0.0
        return _Front(*_views(self._front, 0, shapes))

    def push(self, part: _EliminationPart, front: _Front) -> None:
        """Keep what a part leaves to its parent."""
        for target, block in zip(self._waiting(part), front[_KEPT], strict=True):
            target[...] = block
        self._top += _kept(part)

    def pop(self, part: _EliminationPart) -> list[Array]:
        """What the part that was kept last left; valid until the next push."""
        self._top -= _kept(part)
        return self._waiting(part)

    def _waiting(self, part: _EliminationPart) -> list[Array]:
        return _views(self._stack, self._top, _blocks(part)[_KEPT])


def _kept(part: _EliminationPart) -> int:
    return sum(rows * columns for rows, columns in _blocks(part)[_KEPT])


def _views(memory: Array, start: int, shapes: list[tuple[int, int]]) -> list[Array]:
    out = []
    for rows, columns in shapes:
        stop = start + rows * columns
        out.append(memory[start:stop].reshape((rows, columns), order="F"))
        start = stop
    return out


@njit
def _gather(
    own: IntArray, matrix: tuple[Array, Array, Array], place: IntArray, inner: Array, below: Array
) -> None:
    """Entries of the rows of a part at their places in its front; lower part."""
    start, column, value = matrix
    count = inner.shape[0]
    for k in range(own.size):
        for a in range(3):
            row = 3 * own[k] + a
            for j in range(start[row], start[row + 1]):
                node = column[j] // 3
                if place[node] < 0:
                    continue
                i = 3 * place[node] + column[j] - 3 * node
                if i >= count:
                    below[i - count, 3 * k + a] += value[j]
                elif i >= 3 * k + a:
                    inner[i, 3 * k + a] += value[j]


@njit
def _extend(child: Array, rows: IntArray, inner: Array, below: Array, rest: Array) -> None:
    """Add the lower part of a child's matrix."""
    count = inner.shape[0]
    for j in range(rows.size):
        for i in range(j, rows.size):
            r, c = max(rows[i], rows[j]), min(rows[i], rows[j])
            if r < count:
                inner[r, c] += child[i, j]
            elif c < count:
                below[r - count, c] += child[i, j]
            else:
                rest[r - count, c - count] += child[i, j]


@njit
def _extend_loads(
    child: Array, rows: IntArray, columns: IntArray, loads: Array, passed: Array
) -> None:
    """Add the load columns of a child."""
    count = loads.shape[1]
    for j in range(rows.size):
        c = rows[j]
        for i in range(columns.size):
            if c < count:
                loads[columns[i], c] += child[i, j]
            else:
                passed[columns[i], c - count] += child[i, j]


def _eliminated(part: _EliminationPart, front: _Front, total: Array) -> _Front:
    """Eliminate the own unknowns in place; the work of the loads on them joins the total."""
    count, outer, loads = part.sizes
    if not count:
        return front
    lower, info = scipy.linalg.lapack.dpotrf(front.inner, lower=1, clean=0, overwrite_a=1)
    if info != 0:
        raise GeometryError(
            "elastic body",
            "a body that is not held or not in one piece",
            "are bodies with a support or one that floats as a whole",
        )
    below, rest, own, passed = front[1:]
    if outer:
        below = scipy.linalg.blas.dtrsm(
            1.0, lower, below, side=1, lower=1, trans_a=1, overwrite_b=1
        )
        rest = scipy.linalg.blas.dsyrk(-1.0, below, beta=1.0, c=rest, lower=1, overwrite_c=1)
    if loads:
        own = scipy.linalg.blas.dtrsm(1.0, lower, own, side=1, lower=1, trans_a=1, overwrite_b=1)
        total[np.ix_(part.columns, part.columns)] += scipy.linalg.blas.dsyrk(1.0, own, lower=1)
    if outer and loads:
        passed = scipy.linalg.blas.dgemm(
            -1.0, own, below, beta=1.0, c=passed, trans_b=1, overwrite_c=1
        )
    return _Front(lower, below, rest, own, passed)


_LEAF = 96
"""Nodes below which a part is not divided."""

_SMALLEST = 0.2
"""Share of the nodes that the smaller half has at least."""


@final
class Separator(NamedTuple):
    """Part of the nodes that is eliminated at once."""

    nodes: IntArray
    children: tuple[int, ...]


def dissect(nodes: Array, graph: scipy.sparse.csr_matrix) -> list[Separator]:
    """Parts of a nested dissection in the order of elimination.

    Children before parents, all parts of a child next to each other; the last is the root.

    Parameters
    ----------
    nodes : ndarray, shape (n, 3)
        Places; parts are cut across x, y or z, wherever fewest nodes are in the way. [m]
    graph : csr_matrix
        Pattern of the node couplings. [-]

    References
    ----------
    .. [1] A. George, Nested dissection of a regular finite element mesh, SIAM J. Numer. Anal.
       10 (1973) 345-363.
    """
    tree: list[Separator] = []
    mark = np.zeros(len(nodes), dtype=np.bool_)

    def divide(part: IntArray) -> int:
        if part.size > _LEAF:
            place, reach = nodes[part], (np.empty((part.size, 3)), np.empty((part.size, 3)))
            mark[part] = True
            _reach(part, (graph.indptr, graph.indices), nodes, mark, reach)
            mark[part] = False
            found = [
                _best_cut(axis, place[:, axis], *(end[:, axis] for end in reach))
                for axis in range(3)
            ]
            best = min((cut for cut in found if cut is not None), default=None)
            if best is None:
                halves = None
            else:
                below = place[:, best.axis] < best.level
                lowest, highest = (end[:, best.axis] for end in reach)
                between = (
                    below & (highest >= best.level)
                    if best.from_below
                    else ~below & (lowest < best.level)
                )
                halves = part[below & ~between], part[~below & ~between], part[between]
        else:
            halves = None
        if halves is None:
            tree.append(Separator(part, ()))
            return len(tree) - 1
        low, high, cut = halves
        children = tuple(divide(half) for half in (low, high) if half.size)
        tree.append(Separator(cut, children))
        return len(tree) - 1

    divide(np.arange(len(nodes), dtype=np.int64))
    return tree


class _Cut(NamedTuple):
    # plane that cuts a part; whether its nodes below or above the plane are taken
    cost: float
    axis: int
    level: float
    from_below: bool


@njit
def _reach(
    part: IntArray,
    graph: tuple[Array, Array],
    nodes: Array,
    mark: BoolArray,
    reach: tuple[Array, Array],
) -> None:
    """Lowest and highest place of every node and its neighbours in the part, along all axes."""
    start, column = graph
    lowest, highest = reach
    for k in range(part.size):
        for axis in range(3):
            lowest[k, axis] = highest[k, axis] = nodes[part[k], axis]
        for j in range(start[part[k]], start[part[k] + 1]):
            if mark[column[j]]:
                for axis in range(3):
                    x = nodes[column[j], axis]
                    lowest[k, axis] = min(lowest[k, axis], x)
                    highest[k, axis] = max(highest[k, axis], x)


def _best_cut(axis: int, place: Array, lowest: Array, highest: Array) -> _Cut | None:
    """Plane across an axis with few nodes in the way for the entropy of the halves."""
    ranked, count = np.sort(place), place.size
    first, last = int(_SMALLEST * count), int((1.0 - _SMALLEST) * count)
    levels = np.unique(ranked[first : last + 1])
    levels = levels[levels > ranked[0]]
    if not levels.size:
        return None
    below = np.searchsorted(ranked, levels)
    crossing = (
        below - np.searchsorted(np.sort(highest), levels),
        np.searchsorted(np.sort(lowest), levels) - below,
    )
    share = below / count
    order = -share * np.log(share) - (1.0 - share) * np.log(1.0 - share)
    cost = np.minimum(*crossing) / order
    k = int(np.argmin(cost))
    return _Cut(float(cost[k]), axis, float(levels[k]), bool(crossing[0][k] <= crossing[1][k]))
