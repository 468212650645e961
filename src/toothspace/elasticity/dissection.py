"""Order of elimination of the nodes of a solid mesh: nested dissection by plane cuts."""

from __future__ import annotations

from typing import NamedTuple, final

import numpy as np
import scipy.sparse as sp

from toothspace.core.compiled import njit
from toothspace.core.types import Array, BoolArray, IntArray

_LEAF = 96
"""Nodes below which a part is not divided."""

_SMALLEST = 0.2
"""Share of the nodes that the smaller half has at least."""


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
        Places; parts are cut across x, y or z, wherever fewest nodes are in the way. [m]
    graph : csr_matrix
        Pattern of the node couplings. [-]

    Returns
    -------
    list of Separator
        Children before parents, all parts of a child next to each other; the last is the root.

    References
    ----------
    .. [1] A. George, Nested dissection of a regular finite element mesh, SIAM J. Numer. Anal.
       10 (1973) 345-363.
    """
    tree: list[Separator] = []
    mark = np.zeros(len(nodes), dtype=np.bool_)

    def divide(part: IntArray) -> int:
        halves = _halves(part, nodes, graph, mark) if part.size > _LEAF else None
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


def _halves(
    part: IntArray, nodes: Array, graph: sp.csr_matrix, mark: BoolArray
) -> tuple[IntArray, IntArray, IntArray] | None:
    """Two halves and the nodes of the one that touch the other; None if nothing cuts them."""
    place, reach = nodes[part], (np.empty((part.size, 3)), np.empty((part.size, 3)))
    mark[part] = True
    _reach(part, (graph.indptr, graph.indices), nodes, mark, reach)
    mark[part] = False
    found = [_best_cut(axis, place[:, axis], *(end[:, axis] for end in reach)) for axis in range(3)]
    best = min((cut for cut in found if cut is not None), default=None)
    if best is None:
        return None
    below = place[:, best.axis] < best.level
    lowest, highest = (end[:, best.axis] for end in reach)
    between = below & (highest >= best.level) if best.from_below else ~below & (lowest < best.level)
    return part[below & ~between], part[~below & ~between], part[between]


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
