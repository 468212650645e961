"""Change of the pressure of a solved film with flows added to its balance."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from toothspace.core.types import Array
from toothspace.numerics.complementarity import ComplementaritySolution
from toothspace.numerics.linear_system import PRESCRIBED, SATURATED


def solved_responses(
    fields: ComplementaritySolution, flows: Sequence[Array], relative_tolerance: float
) -> list[Array]:
    """Change of a solved pressure with flows added to its balance: sides of one solution. [Pa].

    Parameters
    ----------
    fields
        Solution of the balance.
    flows : sequence of ndarray
        Net flow out of every cell by each. [m3/s]
    relative_tolerance : float
        Residual of the linear solution over its right-hand side. [-]
    """
    known = fields.kind == PRESCRIBED
    sides = np.empty((len(flows), known.size))
    for side, flow in zip(sides, flows, strict=True):
        side[:] = np.where(known, 0.0, -flow).ravel()
    found = fields.system.solve(sides, relative_tolerance=relative_tolerance)
    held = (fields.kind != SATURATED) | (fields.potential <= 0.0)
    return [np.where(held, 0.0, response.reshape(held.shape)) for response in found]
