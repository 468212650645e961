"""Multigrid conjugate gradients and the iterative systems against direct solutions."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.films import Groove, JournalBearing
from toothspace.films.journal.geometry import (
    EndConditions,
    MotionState,
    journal_gap,
    journal_grid,
    journal_mesh,
)
from toothspace.films.reynolds.equation import FluidField, film_balance
from toothspace.numerics import conjugate, linear_system, multigrid, multigrid_cycle
from toothspace.numerics.banded import empty_band, stencil_product
from toothspace.numerics.complementarity import Constraint, assemble, solve_complementarity
from toothspace.numerics.conduction import ConductionSolver
from toothspace.numerics.linear_system import direct_system
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


@pytest.mark.parametrize(("rows", "lanes"), [(64, 32), (61, 23), (240, 16)])
def test_solution_equals_the_direct_one(rows: int, lanes: int) -> None:
    balance = _balance(rows, lanes, 0.9, 1e-4)
    free = np.ones((rows, lanes), dtype=bool)
    free[rows // 3 : rows // 2, 2 : lanes // 2] = False
    kind = np.where(free, 0, 2)
    stencil, rhs = assemble(balance, kind)
    exact = direct_system(balance, stencil, kind, empty_band(rows, lanes)).solve(rhs)
    solver = ConductionSolver(balance, free)
    potential, count = solver.solve(rhs.reshape(rows, lanes), relative_tolerance=1e-11)
    assert count < 25
    scale = np.abs(exact).max()
    assert potential.ravel() == pytest.approx(np.where(free.ravel(), exact, 0.0), abs=1e-8 * scale)


def test_iterations_do_not_grow_with_the_grid() -> None:
    counts = []
    for rows, lanes in ((48, 32), (96, 64), (192, 128)):
        balance = _balance(rows, lanes, 0.9, 0.0)
        free = np.ones((rows, lanes), dtype=bool)
        _, rhs = assemble(balance, np.zeros((rows, lanes), dtype=np.int64))
        solver = ConductionSolver(balance, free)
        counts.append(solver.solve(rhs.reshape(rows, lanes), relative_tolerance=1e-8)[1])
    assert max(counts) <= 12
    assert counts[-1] <= counts[0] + 3


def test_warm_start_saves_iterations() -> None:
    balance = _balance(96, 32, 0.8, 0.0)
    _, rhs = assemble(balance, np.zeros((96, 32), dtype=np.int64))
    solver = ConductionSolver(balance, np.ones((96, 32), dtype=bool))
    cold, count = solver.solve(rhs.reshape(96, 32))
    _, again = solver.solve(1.001 * rhs.reshape(96, 32), cold)
    assert again <= count - 2


@pytest.mark.parametrize(("rows", "error"), [(64, 1e-5), (61, 1e-3)])
def test_cycle_is_symmetric(rows: int, error: float) -> None:
    """Needed for conjugate gradients; exact but for rounding if all rings have even rows."""
    balance = _balance(rows, 25, 0.7, 2e-4)
    solver = ConductionSolver(balance, np.ones((rows, 25), dtype=bool))
    rng = np.random.default_rng(1)
    u, v = rng.normal(size=(2, 25 * rows))
    forward, backward = v @ solver.precondition(u), u @ solver.precondition(v)
    assert forward == pytest.approx(backward, rel=error)


@pytest.mark.parametrize("rows", [125, 128])
def test_odd_rings_need_no_more_iterations(rows: int) -> None:
    """Along the seam of an odd ring cells of one colour are neighbours."""
    balance = _balance(rows, 24, 0.6, 1e-4)
    free = np.ones((rows, 24), dtype=bool)
    free[30:50, 4:20] = False
    rhs = np.random.default_rng(2).normal(size=(rows, 24))
    assert ConductionSolver(balance, free).solve(rhs, relative_tolerance=1e-10)[1] <= 13


@pytest.mark.parametrize("ring", [True, False])
@pytest.mark.parametrize("rows", [1500, 1501])
def test_blocks_and_tiles_do_the_same_as_passes_over_the_whole_level(
    rows: int, ring: bool, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Exactly: the same operations come in another order, whatever the number of threads."""
    balance = _balance(rows, 30, 0.6, 1e-4)._replace(ring=ring)
    free = np.ones((rows, 30), dtype=bool)
    free[30:50, 4:20] = False
    rhs = np.random.default_rng(2).normal(size=(rows, 30))
    cycles = []
    for threads, resident in ((1, 10**9), (1, 0), (2, 0)):
        monkeypatch.setattr(multigrid, "THREADS", threads)
        monkeypatch.setattr(multigrid_cycle, "RESIDENT", resident)
        monkeypatch.setattr(multigrid_cycle, "TILE", 1)
        cycles.append(ConductionSolver(balance, free).precondition(rhs))
    assert np.array_equal(cycles[0], cycles[1])
    assert np.array_equal(cycles[0], cycles[2])


def test_long_vectors_in_parts_give_the_same_potential(monkeypatch: pytest.MonkeyPatch) -> None:
    balance = _balance(1500, 30, 0.6, 1e-4)
    solver = ConductionSolver(balance, np.ones((1500, 30), dtype=bool))
    rhs = np.random.default_rng(2).normal(size=(2, 1500, 30))
    whole, count = solver.solve(rhs)
    monkeypatch.setattr(conjugate, "LONG", 1)
    parts, needed = solver.solve(rhs)
    assert needed == count
    assert parts == pytest.approx(whole, rel=1e-10, abs=1e-12 * np.abs(whole).max())


def test_potential_of_a_grid_as_small_as_the_coarsest() -> None:
    balance = _balance(8, 6, 0.5, 0.0)
    rhs = np.random.default_rng(5).normal(size=(8, 6))
    assert ConductionSolver(balance, np.ones((8, 6), dtype=bool)).solve(rhs)[1] <= 3


def test_right_hand_sides_together_are_those_one_by_one() -> None:
    balance = _balance(96, 32, 0.8, 1e-4)
    free = np.ones((96, 32), dtype=bool)
    free[40:50, 4:20] = False
    solver = ConductionSolver(balance, free)
    rhs = np.random.default_rng(3).normal(size=(3, 96, 32))
    rhs[1] *= 1e-9
    together, count = solver.solve(rhs)
    for one, side in zip(together, rhs, strict=True):
        alone, needed = solver.solve(side)
        assert needed <= count
        assert one == pytest.approx(alone, abs=1e-8 * np.abs(alone).max())
    again, none = solver.solve(rhs, together)
    assert none <= 1
    assert again.shape == rhs.shape


def test_direct_system_closes_the_ring() -> None:
    rows, lanes = 40, 9
    balance = _balance(rows, lanes, 0.5, 1e-4)
    kind = np.zeros((rows, lanes), dtype=np.int64)
    stencil, rhs = assemble(balance, kind)
    x = direct_system(balance, stencil, kind, empty_band(rows, lanes)).solve(rhs)
    error = stencil_product(stencil, x, rows, lanes) - rhs
    assert np.linalg.norm(error) < 1e-11 * np.linalg.norm(rhs)


def test_tooth_spaces_take_hardly_more_iterations_than_a_whole_ring() -> None:
    rows, lanes = 384, 64
    balance, counts = _balance(rows, lanes, 0.5, 0.0), []
    spaces = np.zeros((rows, lanes), dtype=bool)
    for lane in range(lanes // 2, lanes):
        width = 4 + (lane - lanes // 2) // 4
        spaces[:, lane] = np.abs(np.arange(rows) % 32 - 15.5) < width
    for free in (np.ones((rows, lanes), dtype=bool), ~spaces):
        solver = ConductionSolver(balance, free)
        counts.append(solver.solve(1.0 * free, relative_tolerance=1e-10)[1])
    assert counts[1] <= counts[0] + 2


def test_nothing_leaves_nothing_whatever_it_begins_with() -> None:
    rows, lanes = 40, 9
    balance, kind = _balance(rows, lanes, 0.5, 0.0), np.zeros((rows, lanes), dtype=np.int64)
    stencil, rhs = assemble(balance, kind)
    system = direct_system(balance, stencil, kind, empty_band(rows, lanes))
    assert not system.solve(np.zeros_like(rhs), np.ones_like(rhs)).any()


def test_cavitated_film_is_the_same_with_both_systems(monkeypatch: pytest.MonkeyPatch) -> None:
    bearing = JournalBearing(
        diameter=0.1,
        length=0.08,
        radial_clearance=CLEARANCE,
        dynamic_viscosity=0.01,
        grid=(80, 25),
        grooves=(Groove(np.pi / 2, 0.3, 0.05, 7e4),),
        end_pressure=0.0,
        cavitation_pressure=0.0,
    )
    position = {"eccentricity": (0.5, 0.1), "tilt": (3e-4, 0.0), "shaft_speed": 300.0}
    direct = bearing.solve(**position)  # type: ignore[arg-type]
    monkeypatch.setattr(linear_system, "prefers_direct", lambda balance: False)
    iterative = bearing.solve(**position)  # type: ignore[arg-type]
    assert iterative.status.succeeded
    assert iterative.force == pytest.approx(direct.force, rel=1e-8)
    assert iterative.stiffness == pytest.approx(direct.stiffness, rel=1e-6)
    assert iterative.mass_balance_error < 1e-10


def test_obstacle_is_the_same_with_both_systems(monkeypatch: pytest.MonkeyPatch) -> None:
    balance = _balance(72, 24, 0.8, 1e-4)
    direct = solve_complementarity(balance, Constraint.OBSTACLE)
    monkeypatch.setattr(linear_system, "prefers_direct", lambda balance: False)
    iterative = solve_complementarity(balance, Constraint.OBSTACLE)
    assert iterative.converged
    scale = direct.potential.max()
    assert iterative.potential == pytest.approx(direct.potential, abs=1e-8 * scale)
