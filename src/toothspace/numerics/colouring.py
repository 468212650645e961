"""Storage of the cells of a structured grid by the two colours of a red-black colouring.

All four neighbours of a cell have the other colour. With rows of an odd length ``stride`` the
colour of a cell is the parity of its place in the flat grid, and its neighbours are found at the
same distances from its own place whatever the cell. So the relaxation of one colour, or a product
with the operator, is one loop over contiguous memory on grids of any shape.

A field holds ``[colour, place]`` with ``(row + 1) stride + lane = 2 place + colour``. One row
before the first and one behind the last repeat the other end of a ring; every row ends with at
least one stored place that is no cell and holds zero.
"""

from __future__ import annotations

from typing import Any, NamedTuple

from numpy.typing import NDArray

from toothspace.core.compiled import inlined, kernel

Field = NDArray[Any]


class ColouredGrid(NamedTuple):
    """Shape of a grid and of its storage."""

    rows: int
    lanes: int
    stride: int
    ring: bool


def coloured_grid(rows: int, lanes: int, *, ring: bool) -> ColouredGrid:
    """Storage of a grid of ``rows x lanes`` cells."""
    return ColouredGrid(rows, lanes, lanes + 1 + lanes % 2, ring)


def stored(grid: ColouredGrid) -> tuple[int, int]:
    """Shape of a stored field: colours and places. [-]."""
    return 2, ((grid.rows + 2) * grid.stride + 1) // 2


@inlined
def span(grid: ColouredGrid, first: int, last: int, colour: int) -> tuple[int, int]:
    """Places of the cells of one colour in the rows from ``first`` to before ``last``."""
    low, high = (first + 1) * grid.stride, (last + 1) * grid.stride
    return (low - colour + 1) // 2, (high - colour + 1) // 2


@inlined
def neighbours(grid: ColouredGrid, colour: int, low: int) -> tuple[int, int, int]:
    """Places west, south and east of a place, among the other colour; north follows south."""
    half = (grid.stride - 1) // 2
    return low - half - 1 + colour, low - 1 + colour, low + half + colour


@inlined
def row_start(grid: ColouredGrid, row: int, colour: int) -> tuple[int, int, int]:
    """First lane of a colour in a row, its place, and the number of cells of that colour."""
    flat = (row + 1) * grid.stride
    lane = (flat + colour) % 2
    return lane, (flat + lane) // 2, (grid.lanes - lane + 1) // 2


@kernel
def close_ring(grid: ColouredGrid, values: Field) -> None:
    """Repeat the last row of a ring before the first and the first behind the last."""
    if not grid.ring:
        return
    last, first = grid.rows * grid.stride, grid.stride
    behind = last + grid.stride
    for j in range(grid.lanes):
        values[j % 2, j // 2] = values[(last + j) % 2, (last + j) // 2]
        values[(behind + j) % 2, (behind + j) // 2] = values[(first + j) % 2, (first + j) // 2]


@kernel
def store(grid: ColouredGrid, rows: Field, values: Field) -> None:
    """Store a field that is given as rows of lanes; rows may hold more lanes than the grid."""
    for i in range(rows.shape[0]):
        row = rows[i]
        for colour in range(2):
            lane, place, count = row_start(grid, i, colour)
            target, source = values[colour, place : place + count], row[lane:]
            for n in range(count):
                target[n] = source[2 * n]


@kernel
def fetch(grid: ColouredGrid, values: Field, rows: Field) -> None:
    """Write a stored field into rows of lanes."""
    for i in range(grid.rows):
        row = rows[i]
        for colour in range(2):
            lane, place, count = row_start(grid, i, colour)
            source, target = values[colour, place : place + count], row[lane:]
            for n in range(count):
                target[2 * n] = source[n]
