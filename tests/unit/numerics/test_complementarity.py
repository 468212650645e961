"""Cells that close while liquid flows in: they fill up, whatever they began with."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.numerics.complementarity import Constraint, solve_complementarity
from toothspace.numerics.linear_system import SATURATED, UNSATURATED
from toothspace.numerics.structured_grid import CellBalance

ROWS, LANES, HIGH = 24, 5, 1e5


def ring(storage: float) -> CellBalance:
    """A ring that turns between two given potentials and closes all over at one rate."""
    return CellBalance(
        conductance_x=np.full((ROWS + 1, LANES), 1e-17),
        conductance_y=np.full((ROWS, LANES + 1), 1e-17),
        advection_x=np.full((ROWS + 1, LANES), 2e-10),
        advection_y=np.zeros((ROWS, LANES + 1)),
        storage=np.full((ROWS, LANES), storage),
        source=np.zeros((ROWS, LANES)),
        mark=np.zeros((ROWS, LANES), dtype=np.int64),
        prescribed=np.zeros((ROWS, LANES)),
        west=np.zeros(LANES),
        east=np.zeros(LANES),
        south=np.full(ROWS, HIGH),
        north=np.full(ROWS, 5.0 * HIGH),
        ring=True,
    )


@pytest.mark.parametrize("storage", [0.0, -1e-17, -1e-14])
@pytest.mark.parametrize("begun", [UNSATURATED, SATURATED])
def test_closing_ring_between_pressures_is_full(storage: float, begun: int) -> None:
    """The potential is linear across the ring plus what squeezing adds, a parabola."""
    start = np.full((ROWS, LANES), begun, dtype=np.int64)
    found = solve_complementarity(ring(storage), Constraint.CONSERVING, start)
    assert found.converged
    assert np.all(found.saturation == 1.0)
    lane = np.arange(1, LANES + 1)
    squeezed = 0.5 * -storage / 1e-17 * lane * (LANES + 1 - lane)
    assert found.potential[7] == pytest.approx(
        HIGH * (1.0 + 4.0 * lane / (LANES + 1)) + squeezed, rel=1e-9
    )
