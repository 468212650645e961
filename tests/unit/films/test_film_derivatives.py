"""How the storage of a film changes with its motion, and where its heat comes from."""

from __future__ import annotations

from math import pi
from typing import Any

import numpy as np
import pytest

from toothspace.films import Groove, JournalBearing, RoughSurfaces
from toothspace.films.reynolds.active_set import (
    DeformedGap,
    GapMotion,
    flow_change,
    linearised_balance,
)
from toothspace.films.reynolds.equation import (
    FilmGrid,
    FluidField,
    GapField,
    face_values,
    face_variation,
    film_balance,
    ring_grid,
    smooth_values,
    smooth_variation,
    vary_storage,
)
from toothspace.films.reynolds.rough_surfaces import (
    SMOOTH,
    FlowLaw,
    carried_law,
    conductance_law,
    flow_law,
)

ROWS, LANES = 3, 2
ROUGH = RoughSurfaces(
    moving_roughness=0.3e-6, resting_roughness=0.2e-6, moving_pattern=3.0, resting_pattern=1 / 3
)


def grid() -> FilmGrid:
    return FilmGrid(
        shape_x=np.ones((ROWS + 1, LANES)),
        shape_y=np.ones((ROWS, LANES + 1)),
        sweep_x=np.zeros((ROWS + 1, LANES)),
        sweep_y=np.zeros((ROWS, LANES + 1)),
        area=np.linspace(1e-6, 2e-6, ROWS * LANES).reshape(ROWS, LANES),
        mark=np.zeros((ROWS, LANES), dtype=np.int64),
        prescribed=np.zeros((ROWS, LANES)),
        west=np.zeros(LANES),
        east=np.zeros(LANES),
        south=np.zeros(ROWS),
        north=np.zeros(ROWS),
        ring=False,
    )


def gaps(centre: np.ndarray, rate: np.ndarray) -> GapField:
    faces = np.full((ROWS + 1, LANES), 1e-6), np.full((ROWS, LANES + 1), 1e-6)
    return GapField(centre, *faces, rate, np.full((ROWS, LANES), 0.1e-6))


@pytest.mark.parametrize("law", [SMOOTH, flow_law(ROUGH, 1.0)], ids=["smooth", "rough"])
def test_storage_varies_as_the_balance_says(law: FlowLaw) -> None:
    """Central differences along a motion that changes gap and rate together."""
    random = np.random.default_rng(7)
    centre = random.uniform(0.5e-6, 1.2e-6, (ROWS, LANES))
    rate = random.uniform(-1e-3, -1e-4, (ROWS, LANES))
    change = gaps(
        *random.uniform(0.5, 1.0, (2, ROWS, LANES)) * np.array([1.0, 500.0])[:, None, None]
    )
    fluid = FluidField(np.full((ROWS, LANES), 30.0), random.uniform(0.9, 1.0, (ROWS, LANES)))

    def storage(step: float) -> np.ndarray:
        moved = gaps(centre + step * change.centre, rate + step * change.rate)
        return film_balance(grid(), moved, fluid, 0.0, law).storage

    step = 1e-10
    expected = (storage(step) - storage(-step)) / (2.0 * step)
    found = np.empty_like(centre)
    vary_storage(grid(), gaps(centre, rate), fluid, law, change, found)
    np.testing.assert_allclose(found, expected, rtol=1e-5)


@pytest.mark.parametrize("law", [SMOOTH, flow_law(ROUGH, 1.0)], ids=["smooth", "rough"])
def test_flows_of_a_ring_vary_as_the_balance_says(law: FlowLaw) -> None:
    """Central differences of the net flow out of every cell, at pressures that stay."""
    random = np.random.default_rng(11)
    rows, lanes = 5, 2
    sweep = np.array([2e-3, -1e-3])
    ring = ring_grid(
        rows, np.array([0.8, 1.1]), np.array([1.0, 0.7, 0.9]), sweep, np.ones(2) * 1e-6
    )
    cell, x, y = (rows, lanes), (rows + 1, lanes), (rows, lanes + 1)
    potential = random.uniform(1e4, 1e6, cell)
    fluid = FluidField(np.full(cell, 30.0), np.full(cell, 0.97))
    nothing = np.zeros(cell)

    def field(low: float, high: float, rate: float) -> GapField:
        centre, along, across = (random.uniform(low, high, shape) for shape in (cell, x, y))
        along[-1] = along[0]
        return GapField(centre, along, across, random.uniform(0.5, 1.0, cell) * rate, nothing)

    gap, lift = field(0.6e-6, 1.2e-6, -1e-3), field(0.5, 1.0, 500.0)

    def linear(step: float) -> Any:
        moved = GapField(*(a + step * b for a, b in zip(gap, lift, strict=True)))
        open_gap = DeformedGap(moved, nothing, np.zeros((2, rows)))
        return linearised_balance(ring, open_gap, fluid, 0.0, law)

    def out_of_cells(step: float) -> np.ndarray:
        b = linear(step).balance
        before = np.roll(potential, 1, axis=0)
        entering = b.conductance_x[:-1] * (before - potential) + b.advection_x[:-1]
        wide = np.hstack([b.south[:, None], potential, b.north[:, None]])
        passing = b.conductance_y * (wide[:, :-1] - wide[:, 1:])
        across = passing[:, 1:] - passing[:, :-1]
        return b.storage + np.roll(entering, -1, axis=0) - entering + across

    step, found = 1e-10, np.empty(cell)
    motion = GapMotion(lift, np.ones(cell))
    flow_change(linear(0.0), ring.sweep_x, motion, potential, np.ones(cell), lift.centre, found)
    expected = (out_of_cells(step) - out_of_cells(-step)) / (2.0 * step)
    np.testing.assert_allclose(found, expected, rtol=1e-5, atol=1e-6 * np.abs(expected).max())


def test_oil_that_a_supply_presses_through_a_bearing_at_rest_warms_it() -> None:
    """Nothing turns: all heat is the work of the supply, its flow times its pressure difference."""
    bearing = JournalBearing(
        diameter=20e-3,
        length=20e-3,
        radial_clearance=20e-6,
        dynamic_viscosity=0.03,
        grid=(72, 21),
        end_pressure=1e5,
        cavitation_pressure=0.0,
        grooves=(Groove(angle=0.0, width=0.5, length=8e-3, pressure=21e5),),
    )
    film = bearing.solve(eccentricity=(0.2, 0.0), shaft_speed=0.0)
    assert film.dissipated_power == pytest.approx(film.side_flow * 20e5, rel=1e-9)
    turning = bearing.solve(eccentricity=(0.2, 0.0), shaft_speed=50.0 * pi)
    assert turning.dissipated_power > turning.power_loss


def test_two_half_cells_conduct_and_carry_as_in_series() -> None:
    """Gaps of 1 and 2: the resistances 1 and 1/8 add, and so do 1 and 1/4 of what they carry."""
    assert smooth_values(1.0, 2.0) == pytest.approx((2.0 / 1.125, 1.25 / 1.125), rel=1e-12)
    assert smooth_values(2.0, 1.0) == pytest.approx(smooth_values(1.0, 2.0), rel=1e-12)
    assert smooth_values(3.0, 3.0) == (27.0, 3.0)
    near = smooth_values(3.0, 3.0 * (1.0 + 1e-9))
    assert near == pytest.approx((27.0, 3.0), rel=1e-8)


@pytest.mark.parametrize(("left", "right"), [(1.0, 2.0), (3.0, 1.0), (2.0, 2.0)])
def test_faces_of_smooth_walls_vary_with_both_gaps(left: float, right: float) -> None:
    step = 1e-6
    up, down = (np.array(smooth_values(left + s, right + s)) for s in (step, -step))
    assert smooth_variation(left, right) == pytest.approx((up - down) / (2.0 * step), rel=1e-8)


@pytest.mark.parametrize(("left", "right"), [(0.9, 2.1), (4.0, 1.7), (12.0, 30.0), (25.0, 25.0)])
def test_faces_of_rough_walls_are_half_cells_in_series(left: float, right: float) -> None:
    law = flow_law(ROUGH, 0.6)
    for columns, nodes in ((law.along, law.table.along), (law.across, law.table.across)):
        gaps = np.array([left, right]) * law.roughness
        cubes = np.array([conductance_law(float(gap), law, columns)[0] for gap in gaps])
        carried = np.array([carried_law(float(gap), law)[0] for gap in gaps])
        total = np.sum(1.0 / cubes)
        expected = 2.0 / total, np.sum(carried / cubes) / total
        found = face_values(*gaps, law, columns, nodes)
        assert found == pytest.approx(expected, rel=1e-9, abs=0.0)
        step = 1e-5 * law.roughness
        up, down = (np.array(face_values(*(gaps + s), law, columns, nodes)) for s in (step, -step))
        varied = face_variation(*gaps, law, columns, nodes)
        assert varied == pytest.approx((up - down) / (2.0 * step), rel=1e-5, abs=0.0)


@pytest.mark.parametrize("ratio", [1.03, 2.2, 5.7])
def test_equal_half_cells_of_rough_walls_take_their_law_from_the_table(ratio: float) -> None:
    law = flow_law(ROUGH, 0.6)
    gap = ratio * law.roughness
    for columns, nodes in ((law.along, law.table.along), (law.across, law.table.across)):
        cube, cube_slope = conductance_law(gap, law, columns)
        carried, carried_slope = carried_law(gap, law)
        found = face_values(gap, gap, law, columns, nodes)
        assert found == pytest.approx((cube, carried), rel=1e-4, abs=0.0)
        varied = face_variation(gap, gap, law, columns, nodes)
        assert varied == pytest.approx((cube_slope, carried_slope), rel=3e-3, abs=0.0)
