"""Closed curves from pieces that meet end to end."""

from __future__ import annotations

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array


def chain_closed(pieces: list[Array], tolerance: float, name: str) -> list[Array]:
    """Join open pieces end to end into closed curves.

    Parameters
    ----------
    pieces : list of ndarray
        Polylines in any order and direction, each shape (n, 2). [m]
    tolerance : float
        Largest distance between ends that belong together. [m]
    name : str
        File name for error messages.

    Returns
    -------
    list of ndarray
        Closed curves, the first point not repeated. [m]

    Raises
    ------
    GeometryError
        If an end has no partner.
    """
    remaining, closed = list(pieces), []
    while remaining:
        chain = remaining.pop(0)
        while np.hypot(*(chain[-1] - chain[0])) > tolerance or len(chain) < 3:
            chain = np.vstack([chain, _next_piece(chain[-1], remaining, tolerance, name)[1:]])
        closed.append(chain[:-1])
    return closed


def _next_piece(end: Array, remaining: list[Array], tolerance: float, name: str) -> Array:
    gaps = [
        min((float(np.hypot(*(piece[side] - end))), index, side) for side in (0, -1))
        for index, piece in enumerate(remaining)
    ]
    nearest = min(gaps, default=(np.inf, 0, 0))
    if nearest[0] > tolerance:
        gap = f"{nearest[0] * 1e3:.3g} mm" if gaps else "no further curve"
        raise GeometryError(
            name,
            f"an open curve ending at x = {end[0] * 1e3:.5g} mm, y = {end[1] * 1e3:.5g} mm (next "
            f"end: {gap})",
            "closed curves",
        )
    piece = remaining.pop(nearest[1])
    return piece if nearest[2] == 0 else piece[::-1]
