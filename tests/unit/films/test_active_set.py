"""Balance of a film whose gap follows its pressure."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.films.definitions import RoughSurfaces
from toothspace.films.reynolds.active_set import DeformedGap, linearised_balance
from toothspace.films.reynolds.equation import FilmGrid, FluidField, GapField
from toothspace.films.reynolds.rough_surfaces import SMOOTH, FlowLaw, flow_law
from toothspace.numerics.structured_grid import FREE

ROWS, LANES = 6, 4
COMPLIANCE = 4e-13  # m/Pa: 100 bar open the gap by four micrometres
ROUGH = flow_law(
    RoughSurfaces(
        moving_roughness=0.4e-6,
        resting_roughness=0.4e-6,
        correlation_length=20e-6,
        effective_modulus=1e11,
        hardness=2e9,
        boundary_friction=0.1,
    ),
    1.0,
)


def grid(speed: float) -> FilmGrid:
    along, across, cells = np.ones((ROWS + 1, LANES)), np.ones((ROWS, LANES + 1)), (ROWS, LANES)
    return FilmGrid(
        along,
        across,
        speed * along,
        0.0 * across,
        np.full(cells, 1e-8),
        np.full(cells, FREE),
        np.zeros(cells),
        np.zeros(LANES),
        np.zeros(LANES),
        np.zeros(ROWS),
        np.zeros(ROWS),
        True,
    )


def flows(pressure: np.ndarray, law: FlowLaw, speed: float) -> tuple[np.ndarray, np.ndarray]:
    """Pressure flow through the faces of the first index, and its slope with the cell before."""
    cells = pressure.shape
    gap = GapField(
        np.full(cells, 1.5e-6),
        np.full((ROWS + 1, LANES), 1.5e-6),
        np.full((ROWS, LANES + 1), 1.5e-6),
        np.zeros(cells),
        np.zeros(cells),
    )
    fluid = FluidField(np.full(cells, 1e3), np.ones(cells))
    opened = DeformedGap(gap, COMPLIANCE * pressure, np.zeros((2, ROWS)))
    found = linearised_balance(grid(speed), opened, fluid, 0.0, law)
    before = np.vstack([pressure[-1:], pressure])
    drop = before - np.vstack([pressure, pressure[:1]])
    conductance = found.balance.conductance_x
    return conductance * drop, conductance + found.slope.west * drop * COMPLIANCE


@pytest.mark.parametrize("law", [SMOOTH, ROUGH], ids=["smooth", "rough"])
@pytest.mark.parametrize("speed", [2.0, -2.0])
def test_flow_grows_with_the_pressure_that_drives_it(law: FlowLaw, speed: float) -> None:
    """Even across a step of 200 bar from cell to cell, whichever way the face moves."""
    found = []
    for driving in np.linspace(0.0, 2e7, 41):
        pressure = np.zeros((ROWS, LANES))
        pressure[2], pressure[3] = driving, 1e7
        flow, slope = flows(pressure, law, speed)
        found.append(flow[3, 1])
        assert slope[3, 1] > 0.0
    assert np.all(np.diff(found) > 0.0)


@pytest.mark.parametrize("law", [SMOOTH, ROUGH], ids=["smooth", "rough"])
def test_slope_is_the_derivative(law: FlowLaw) -> None:
    pressure = np.random.default_rng(3).uniform(0.0, 2e7, (ROWS, LANES))
    up, down = pressure.copy(), pressure.copy()
    up[2, 1] += 10.0
    down[2, 1] -= 10.0
    change = (flows(up, law, 1.0)[0] - flows(down, law, 1.0)[0])[3, 1] / 20.0
    assert change == pytest.approx(flows(pressure, law, 1.0)[1][3, 1], rel=1e-6, abs=0.0)
