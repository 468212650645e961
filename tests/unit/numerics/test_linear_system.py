"""Linear systems of a pass of an active-set method, and the grids that they are refused for."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spl

from toothspace.core.errors import CaseError
from toothspace.films import FilmFluid, JournalBearing, LateralFilm
from toothspace.films.journal.geometry import (
    EndConditions,
    MotionState,
    journal_gap,
    journal_grid,
    journal_mesh,
)
from toothspace.films.reynolds.equation import FluidField, film_balance
from toothspace.numerics.banded import MOST_MEMORY, check_grid, empty_band, stencil_product
from toothspace.numerics.complementarity import assemble
from toothspace.numerics.linear_system import PRESCRIBED, SATURATED, PassSystems
from toothspace.numerics.structured_grid import CellBalance

CLEARANCE = 150e-6


def _balance(rows: int, lanes: int, ratio: float, tilt: float) -> CellBalance:
    """Journal film whose cubes of the gap span up to four decades."""
    mesh = journal_mesh(0.08, (rows, lanes), 0.0, half=False)
    grid = journal_grid(mesh, 0.05, (), EndConditions(0.0, 0.0, False))
    place = np.array([ratio * CLEARANCE, 0.0, tilt, 0.0])
    gap = journal_gap(mesh, CLEARANCE, MotionState(place, np.zeros(4)))
    fluid = FluidField(np.full((rows, lanes), 100.0), np.ones((rows, lanes)))
    return film_balance(grid._replace(sweep_x=7.8 * grid.sweep_x), gap, fluid, 0.0)


def _sparse(stencil: np.ndarray, rows: int, lanes: int) -> sp.csc_matrix:
    """Matrix of a ring; columns of the stencil: west, south, centre, north, east."""
    here = np.arange(rows * lanes).reshape(rows, lanes)
    beside = [np.roll(here, shift, axis) for shift, axis in ((1, 0), (1, 1), (-1, 1), (-1, 0))]
    columns = [beside[0], beside[1], here, beside[2], beside[3]]
    entries = [
        sp.coo_matrix((value, (here.ravel(), column.ravel())), shape=2 * (here.size,))
        for value, column in zip(stencil.T, columns, strict=True)
    ]
    return sum(entries[1:], entries[0]).tocsc()


@pytest.mark.parametrize(("rows", "lanes"), [(64, 32), (61, 23), (240, 16), (8, 6)])
def test_solution_equals_the_direct_one(rows: int, lanes: int) -> None:
    """Of SciPy, with a patch of given potentials."""
    balance = _balance(rows, lanes, 0.9, 1e-4)
    free = np.ones((rows, lanes), dtype=bool)
    free[rows // 3 : rows // 2, 2 : lanes // 2] = False
    kind = np.where(free, SATURATED, PRESCRIBED)
    stencil, rhs = assemble(balance, kind)
    exact = spl.spsolve(_sparse(stencil, rows, lanes), rhs)
    potential = PassSystems(balance).system(stencil, kind).solve(rhs)
    assert potential == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())


def test_right_hand_sides_together_are_those_one_by_one() -> None:
    balance = _balance(96, 32, 0.8, 1e-4)
    free = np.ones((96, 32), dtype=bool)
    free[40:50, 4:20] = False
    kind = np.where(free, SATURATED, PRESCRIBED)
    system = PassSystems(balance).system(assemble(balance, kind)[0], kind)
    sides = np.where(free.ravel(), np.random.default_rng(3).normal(size=(3, free.size)), 0.0)
    sides[1] *= 1e-9
    for one, side in zip(system.solve(sides), sides, strict=True):
        alone = system.solve(side)
        assert one == pytest.approx(alone, abs=1e-10 * np.abs(alone).max())


def test_direct_system_closes_the_ring() -> None:
    rows, lanes = 40, 9
    balance = _balance(rows, lanes, 0.5, 1e-4)
    kind = np.zeros((rows, lanes), dtype=np.int64)
    stencil, rhs = assemble(balance, kind)
    x = PassSystems(balance).system(stencil, kind).solve(rhs)
    error = stencil_product(stencil, x, rows, lanes) - rhs
    assert np.linalg.norm(error) < 1e-11 * np.linalg.norm(rhs)


def test_nothing_leaves_nothing_whatever_it_begins_with() -> None:
    rows, lanes = 40, 9
    balance, kind = _balance(rows, lanes, 0.5, 0.0), np.zeros((rows, lanes), dtype=np.int64)
    stencil, rhs = assemble(balance, kind)
    system = PassSystems(balance).system(stencil, kind)
    assert not system.solve(np.zeros_like(rhs), np.ones_like(rhs)).any()


@pytest.mark.parametrize("grid", [(2000, 362), (800, 203), (5000, 4)])
def test_grids_whose_equations_fit_are_taken(grid: tuple[int, int]) -> None:
    check_grid("film.grid", grid)


def test_the_grid_that_a_refusal_names_fits_and_the_next_one_does_not() -> None:
    with pytest.raises(CaseError) as refused:
        check_grid("film.grid", (2000, 500))
    assert str(refused.value) == (
        "film.grid: found 2000 x 500 cells, whose equations take 3.8 GiB of memory, "
        "allowed are 2 GiB: 2000 x 362 cells fit"
    )
    check_grid("film.grid", (2000, 362))
    with pytest.raises(CaseError, match="2000 x 362 cells fit"):
        check_grid("film.grid", (2000, 363))
    band = empty_band(20, 362)
    assert 100 * band.nbytes < MOST_MEMORY < 1.01 * 100 * band.nbytes


def test_bearings_and_faces_too_fine_for_the_memory_are_refused() -> None:
    with pytest.raises(CaseError, match=r"^bearing.grid: found 5000 x 5000 cells"):
        JournalBearing(
            diameter=0.1,
            length=0.08,
            radial_clearance=CLEARANCE,
            dynamic_viscosity=0.01,
            grid=(5000, 5000),
        )
    with pytest.raises(CaseError, match=r"^film.grid: found 5000 x 5000 cells"):
        LateralFilm(
            inner_radius=9e-3,
            outer_radius=20e-3,
            side_gap=12e-6,
            fluid=FilmFluid(0.02),
            grid=(5000, 5000),
            inner_pressure=1e5,
            outer_pressure=1e5,
        )
