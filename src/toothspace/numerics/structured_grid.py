"""Cell balances on structured grids: conduction, advection, storage and source per cell.

A grid has ``rows x lanes`` cells; the first index may be closed to a ring. The arrays hold
geometry and coefficients of the faces, so curvilinear and stretched grids need no other code.

::

              north  face (i, j + 1)
            +------------------------+
      west  |                        |  east
    face i  |      cell (i, j)       |  face i + 1      first index: west -> east
            |                        |                  second index: south -> north
            +------------------------+
              south  face (i, j)
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from toothspace.core.compiled import njit
from toothspace.core.types import Array, IntArray

FREE = 0
"""Cell mark: the balance of the cell is solved."""
PRESCRIBED = 2
"""Cell mark: the potential of the cell is prescribed."""


class CellBalance(NamedTuple):
    r"""Coefficients of one balance per cell.

    Notes
    -----
    With potential :math:`u`, saturation :math:`s` and the neighbour :math:`k` of cell :math:`i`

    .. math::

        \sum_k g_{ik} (u_i - u_k) + \sum_k \left[\max(c_{ik}, 0) s_i
            + \min(c_{ik}, 0) s_k\right] + a_i s_i = q_i ,

    where :math:`c_{ik}` is the advected flow out of the cell at full saturation. Faces of the
    first index are positive towards east, of the second towards north. In a ring the last
    face of the first index repeats the first.
    """

    conductance_x: Array  # (rows + 1, lanes)
    conductance_y: Array  # (rows, lanes + 1)
    advection_x: Array  # (rows + 1, lanes)
    advection_y: Array  # (rows, lanes + 1)
    storage: Array  # (rows, lanes)
    source: Array  # (rows, lanes)
    mark: IntArray  # (rows, lanes), FREE or PRESCRIBED
    prescribed: Array  # (rows, lanes), potential of prescribed cells
    west: Array  # (lanes,), potential beyond the first row
    east: Array  # (lanes,)
    south: Array  # (rows,)
    north: Array  # (rows,)
    ring: bool  # the last row is followed by the first


def grid_shape(balance: CellBalance) -> tuple[int, int]:
    """Number of rows and lanes. [-]."""
    rows, lanes = balance.storage.shape
    return int(rows), int(lanes)


def empty_balance(rows: int, lanes: int, *, ring: bool) -> CellBalance:
    """Return a balance of free cells with all coefficients zero."""
    return CellBalance(
        np.zeros((rows + 1, lanes)),
        np.zeros((rows, lanes + 1)),
        np.zeros((rows + 1, lanes)),
        np.zeros((rows, lanes + 1)),
        np.zeros((rows, lanes)),
        np.zeros((rows, lanes)),
        np.zeros((rows, lanes), dtype=np.int64),
        np.zeros((rows, lanes)),
        np.zeros(lanes),
        np.zeros(lanes),
        np.zeros(rows),
        np.zeros(rows),
        ring,
    )


@njit
def _coarsen_faces(fine: CellBalance, coarse: CellBalance) -> None:
    """Merge cells two by two: series along, parallel across each face."""
    rows, lanes = fine.storage.shape
    for i in range(coarse.conductance_x.shape[0]):
        k = min(2 * i, rows)
        for j in range(lanes):
            # a face between merged cells is twice as far from both centres
            coarse.conductance_x[i, j // 2] += 0.5 * fine.conductance_x[k, j]
            coarse.advection_x[i, j // 2] += fine.advection_x[k, j]
    for i in range(rows):
        for j in range(coarse.conductance_y.shape[1]):
            k = min(2 * j, lanes)
            coarse.conductance_y[i // 2, j] += 0.5 * fine.conductance_y[i, k]
            coarse.advection_y[i // 2, j] += fine.advection_y[i, k]


@njit
def _coarsen_cells(fine: CellBalance, coarse: CellBalance, count: Array) -> None:
    rows, lanes = fine.storage.shape
    merged_rows, merged_lanes = coarse.storage.shape
    for i in range(rows):
        for j in range(lanes):
            p, q = i // 2, j // 2
            coarse.storage[p, q] += fine.storage[i, j]
            coarse.source[p, q] += fine.source[i, j]
            if fine.mark[i, j] == 2:
                count[p, q] += 1.0
                coarse.prescribed[p, q] += fine.prescribed[i, j]
                coarse.mark[p, q] = 2
    for p in range(merged_rows):
        for q in range(merged_lanes):
            if count[p, q] > 0.0:
                coarse.prescribed[p, q] /= count[p, q]


def coarsened(fine: CellBalance) -> CellBalance:
    """Return the balance on a grid of half as many rows and lanes.

    Sums of storage and source and the flows through coinciding faces are kept; the
    conductances are those of the merged cells for smooth coefficients.
    """
    rows, lanes = grid_shape(fine)
    coarse = empty_balance((rows + 1) // 2, (lanes + 1) // 2, ring=fine.ring)
    _coarsen_faces(fine, coarse)
    # how many prescribed cells fall into one
    _coarsen_cells(fine, coarse, np.zeros(grid_shape(coarse)))
    coarse.west[:] = fine.west[::2]
    coarse.east[:] = fine.east[::2]
    coarse.south[:] = fine.south[::2]
    coarse.north[:] = fine.north[::2]
    return coarse
