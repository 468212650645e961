"""Change of the pressure of a solved film with small changes of its gap."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from toothspace.core.types import Array
from toothspace.films.reynolds.equation import (
    FilmGrid,
    FluidField,
    GapField,
    balance_derivative,
    balance_variation,
)
from toothspace.films.reynolds.rough_surfaces import FlowLaw
from toothspace.numerics.complementarity import ComplementaritySolution, residual
from toothspace.numerics.linear_system import PRESCRIBED, SATURATED, TIGHT
from toothspace.numerics.structured_grid import CellBalance


def pressure_responses(
    grid: FilmGrid,
    gap: GapField,
    carrier: FluidField,
    law: FlowLaw,
    balance: CellBalance,
    fields: ComplementaritySolution,
    changes: Sequence[GapField],
    *,
    relative_tolerance: float = TIGHT,
) -> list[Array]:
    """Change of the pressure with each of several changes of the gap, cavity boundary exact.

    Parameters
    ----------
    grid, gap, carrier
        Cells, heights and liquid of the film that was solved.
    law : FlowLaw
        Average flow law of its walls.
    balance : CellBalance
        Balance that was solved. [Pa, m3/s]
    fields : ComplementaritySolution
        Its solution.
    changes : sequence of GapField
        Changes of gap and rate per unit of a motion, ``step`` unused. [m and m/s per unit]
    relative_tolerance : float
        Residual of the linear solution over its right-hand side. [-]

    Returns
    -------
    list of ndarray
        Change of the pressure of every cell per unit. [Pa per unit]
    """
    slope = balance_derivative(grid, gap, carrier, balance, law)
    varied = (balance_variation(grid, gap, carrier, change, slope, law) for change in changes)
    u, s = fields.potential, fields.saturation
    flows = [residual(balance, change, u, s) for change in varied]
    return solved_responses(fields, flows, relative_tolerance)


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
