"""The multigrid cycle and the iterative system around it against direct solutions."""

from __future__ import annotations

import numpy as np
import pytest
import scipy.sparse as sp
import scipy.sparse.linalg as spl

from toothspace.films import Groove, JournalBearing
from toothspace.films.journal.geometry import (
    EndConditions,
    MotionState,
    journal_gap,
    journal_grid,
    journal_mesh,
)
from toothspace.films.reynolds.equation import FluidField, film_balance
from toothspace.numerics import linear_system, multigrid_cycle
from toothspace.numerics.banded import stencil_product, stencil_products
from toothspace.numerics.complementarity import Constraint, assemble, solve_complementarity
from toothspace.numerics.krylov import gmres
from toothspace.numerics.linear_system import PRESCRIBED, SATURATED, PassSystems, iterative_system
from toothspace.numerics.multigrid import MultigridPreconditioner
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


def _iterations(
    balance: CellBalance, free: np.ndarray, rhs: np.ndarray, relative_tolerance: float
) -> int:
    """Iterations with one cycle each to a residual over the right-hand side. [-]."""
    stencil, _ = assemble(balance, np.where(free, SATURATED, PRESCRIBED))
    side = np.where(free, rhs.reshape(free.shape), 0.0).reshape(1, -1)
    return gmres(
        lambda x: stencil_products(stencil, x, *free.shape),
        MultigridPreconditioner(balance, free).apply,
        side,
        limits=np.array([relative_tolerance * np.linalg.norm(side)]),
    )[1]


@pytest.mark.parametrize(("rows", "lanes"), [(64, 32), (61, 23), (240, 16), (8, 6)])
def test_solution_equals_the_direct_one(rows: int, lanes: int) -> None:
    """Of SciPy, on grids down to the coarsest."""
    balance = _balance(rows, lanes, 0.9, 1e-4)
    free = np.ones((rows, lanes), dtype=bool)
    free[rows // 3 : rows // 2, 2 : lanes // 2] = False
    kind = np.where(free, SATURATED, PRESCRIBED)
    stencil, rhs = assemble(balance, kind)
    exact = spl.spsolve(_sparse(stencil, rows, lanes), rhs)
    potential = iterative_system(balance, stencil, kind).solve(rhs)
    assert potential == pytest.approx(exact, abs=1e-9 * np.abs(exact).max())
    assert _iterations(balance, free, rhs, 1e-11) < 25


def test_iterations_do_not_grow_with_the_grid() -> None:
    counts = []
    for rows, lanes in ((48, 32), (96, 64), (192, 128)):
        balance = _balance(rows, lanes, 0.9, 0.0)
        _, rhs = assemble(balance, np.zeros((rows, lanes), dtype=np.int64))
        counts.append(_iterations(balance, np.ones((rows, lanes), dtype=bool), rhs, 1e-8))
    assert max(counts) <= 12
    assert counts[-1] <= counts[0] + 3


@pytest.mark.parametrize(("rows", "error"), [(64, 1e-5), (61, 1e-3)])
def test_cycle_is_symmetric(rows: int, error: float) -> None:
    """As the operator is; exact but for rounding if all rings have even rows."""
    balance = _balance(rows, 25, 0.7, 2e-4)
    cycle = MultigridPreconditioner(balance, np.ones((rows, 25), dtype=bool))
    rng = np.random.default_rng(1)
    u, v = rng.normal(size=(2, 25 * rows))
    forward, backward = v @ cycle.apply(u), u @ cycle.apply(v)
    assert forward == pytest.approx(backward, rel=error)


@pytest.mark.parametrize("rows", [125, 128])
def test_odd_rings_need_no_more_iterations(rows: int) -> None:
    """Along the seam of an odd ring cells of one colour are neighbours."""
    balance = _balance(rows, 24, 0.6, 1e-4)
    free = np.ones((rows, 24), dtype=bool)
    free[30:50, 4:20] = False
    rhs = np.random.default_rng(2).normal(size=(rows, 24))
    assert _iterations(balance, free, rhs, 1e-10) <= 13


@pytest.mark.slow
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
        monkeypatch.setenv("TOOTHSPACE_THREADS", str(threads))
        monkeypatch.setattr(multigrid_cycle, "RESIDENT", resident)
        monkeypatch.setattr(multigrid_cycle, "TILE", 1)
        cycles.append(MultigridPreconditioner(balance, free).apply(rhs))
    assert np.array_equal(cycles[0], cycles[1])
    assert np.array_equal(cycles[0], cycles[2])


def test_right_hand_sides_together_are_those_one_by_one() -> None:
    balance = _balance(96, 32, 0.8, 1e-4)
    free = np.ones((96, 32), dtype=bool)
    free[40:50, 4:20] = False
    kind = np.where(free, SATURATED, PRESCRIBED)
    system = iterative_system(balance, assemble(balance, kind)[0], kind)
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


def test_tooth_spaces_take_hardly_more_iterations_than_a_whole_ring() -> None:
    rows, lanes = 384, 64
    balance, counts = _balance(rows, lanes, 0.5, 0.0), []
    spaces = np.zeros((rows, lanes), dtype=bool)
    for lane in range(lanes // 2, lanes):
        width = 4 + (lane - lanes // 2) // 4
        spaces[:, lane] = np.abs(np.arange(rows) % 32 - 15.5) < width
    for free in (np.ones((rows, lanes), dtype=bool), ~spaces):
        counts.append(_iterations(balance, free, 1.0 * free, 1e-10))
    assert counts[1] <= counts[0] + 2


def test_nothing_leaves_nothing_whatever_it_begins_with() -> None:
    rows, lanes = 40, 9
    balance, kind = _balance(rows, lanes, 0.5, 0.0), np.zeros((rows, lanes), dtype=np.int64)
    stencil, rhs = assemble(balance, kind)
    system = PassSystems(balance).system(stencil, kind)
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
