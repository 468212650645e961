"""How far the numbers of a film depend on its grid."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from typing import Any

import numpy as np

_CHECKS = frozenset({"mass_balance_error", "wall_time_s"})
"""Numbers that say how a solution went."""

Grid = tuple[int, int]


def grid_report(
    solve: Callable[[Grid], Mapping[str, Any]], grid: Grid, given: Mapping[str, Any] | None = None
) -> dict[str, Any]:
    """Numbers of a film on half, once and twice its cells along each direction.

    Parameters
    ----------
    solve : callable
        Numbers by name for a grid.
    grid : tuple of int
        Grid of the film. [-]
    given : mapping, optional
        Numbers on that grid, if they are known already.

    Returns
    -------
    dict
        ``grids``, then for every number that is not zero on the finest grid its values ``half``,
        ``given`` and ``twice``, the ``order`` of their convergence (None where the differences
        do not fall), and the relative ``error`` of the given grid at the order 2 that films
        converge with, so 4/3 of its difference from the finest. [-]

    References
    ----------
    .. [1] P. J. Roache, Perspective: a method for uniform reporting of grid refinement studies,
       J. Fluids Eng. 116 (1994) 405-413.
    """
    rows, lanes = grid
    grids = (max(rows // 2, 1), max(lanes // 2, 1)), grid, (2 * rows, 2 * lanes)
    found = [solve(grids[0]), solve(grid) if given is None else given, solve(grids[2])]
    report: dict[str, Any] = {"grids": [list(cells) for cells in grids]}
    for name, value in found[2].items():
        if isinstance(value, float) and value != 0.0 and name not in _CHECKS:
            values = [numbers.get(name) for numbers in found]
            if all(isinstance(number, float) for number in values):
                report[name] = _convergence(*values)  # type: ignore[arg-type]
    return report


def _convergence(half: float, given: float, twice: float) -> dict[str, float | None]:
    coarse, fine = abs(given - half), abs(twice - given)
    order = float(np.log2(coarse / fine)) if coarse > fine > 0.0 else None
    error = 4.0 / 3.0 * fine / abs(twice)
    return {"half": half, "given": given, "twice": twice, "order": order, "error": error}
