"""Times of thin-film solutions: one command prints the whole table.

    python -m benchmarks films

Every time is the best of several runs after a warm-up. Peers that are not installed are named as
missing.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from importlib.util import find_spec

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spl

from toothspace.core.compiled import njit
from toothspace.films import FilmFluid, Groove, JournalBearing, LateralFilm
from toothspace.films.reynolds.equation import film_balance
from toothspace.numerics.block_elimination import BlockSystem, block_system
from toothspace.numerics.complementarity import assemble
from toothspace.numerics.linear_system import PRESCRIBED, SATURATED
from toothspace.numerics.structured_grid import CellBalance

SIZES = ((480, 64), (960, 128), (1600, 192))
"""Grids of the masked lateral film."""


def best(run: Callable[[], object], repeats: int = 7) -> float:
    """Shortest wall time after one warm-up. [ms]."""
    run()
    times = []
    for _ in range(repeats):
        start = time.perf_counter()
        run()
        times.append(time.perf_counter() - start)
    return 1e3 * min(times)


def bearing(rows: int, lanes: int) -> JournalBearing:
    """Grooved bearing of the published mass-conserving runs."""
    return JournalBearing(
        diameter=0.1,
        length=0.08,
        radial_clearance=150e-6,
        dynamic_viscosity=0.01,
        grid=(rows, lanes),
        grooves=(Groove(np.pi / 2, np.radians(15.0), 0.06, 7e4),),
        end_pressure=0.0,
        cavitation_pressure=0.0,
    )


def journal_table() -> None:
    print("Mass-conserving journal film          ms   target   peer program")
    for (rows, lanes), target, peer in (
        ((100, 27), 5, "17"),
        ((200, 53), 20, "45-65"),
        ((400, 103), 80, "470"),
    ):
        b = bearing(rows, lanes)
        straight = best(lambda b=b: b.solve(eccentricity=(0.5, 0.0), shaft_speed=314.16))
        print(f"  {rows:4d} x {lanes:3d}                      {straight:8.1f} {target:8d}   {peer}")
        tilted = best(
            lambda b=b: b.solve(eccentricity=(0.5, 0.0), tilt=(1e-4, 5e-5), shaft_speed=314.16), 3
        )
        print(f"  {rows:4d} x {lanes:3d} tilted, no mirror    {tilted:8.1f}")
    for rows, lanes in ((100, 27), (200, 53)):
        b = bearing(rows, lanes)

        def study(b: JournalBearing = b) -> None:
            film = b.equilibrium(load=(1000.0, 300.0), shaft_speed=314.16)
            _ = film.stiffness, film.damping

        elapsed = best(study, 5)
        print(f"  {rows:4d} x {lanes:3d} equilibrium, 8 coeff. {elapsed:8.1f}      100   180-280")


def several_table() -> None:
    print("Several right-hand sides, best of 3    ms one by one   together   ratio")
    for rows, lanes in ((100, 27), (200, 53), (400, 103)):
        film = bearing(rows, lanes).solve(
            eccentricity=(0.5, 0.0), tilt=(1e-4, 5e-5), shaft_speed=314.16
        )
        fields = film.solved.fields
        system = fields.system
        sides = np.random.default_rng(0).normal(size=(8, fields.potential.size))
        alone = best(lambda s=system, b=sides: [s.solve(side) for side in b], 3)
        together = best(lambda s=system, b=sides: s.solve(b), 3)
        name = f"{rows} x {lanes} tilted journal, 8 columns"
        print(f"  {name:38s} {alone:11.1f} {together:10.1f} {alone / together:7.2f}")


def toothed_film(rows: int, lanes: int) -> tuple[CellBalance, np.ndarray]:
    """Tilted lateral film of a gear of 12 teeth; tooth spaces stand at given pressures."""
    angle = (np.arange(rows) + 0.5) * 2.0 * np.pi / rows
    radius = 9e-3 + (np.arange(lanes) + 0.5) * 11e-3 / lanes
    pitch = np.mod(angle * 12 / (2.0 * np.pi), 1.0)[:, None]
    space = (radius[None, :] > 14e-3) & (np.abs(pitch - 0.5) < 0.18 + 12.0 * (radius - 14e-3))
    pressure = 1e5 + 199e5 * np.floor(angle * 12 / (2.0 * np.pi))[:, None] / 11.0
    lateral = LateralFilm(
        inner_radius=9e-3,
        outer_radius=20e-3,
        side_gap=12e-6,
        fluid=FilmFluid(0.02),
        tilt=(5e-4, 1e-4),
        grid=(rows, lanes),
        inner_pressure=1e5,
        outer_pressure=1e5,
        given_pressure=np.where(space, pressure + 0.0 * space, np.nan),
    )
    film = lateral.discretise(157.0)
    balance = film_balance(film.grid, film.gap, film.fluid.fields(film.gap.centre), 0.0)
    return balance, ~space


def right_side(balance: CellBalance, free: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    stencil, rhs = assemble(balance, np.where(free, SATURATED, PRESCRIBED))
    return stencil, np.where(free.ravel(), rhs, 0.0)


def eliminated(stencil: np.ndarray, free: np.ndarray) -> BlockSystem:
    """The system that a film on compliant faces sets up."""
    system = block_system(stencil, np.where(free, SATURATED, PRESCRIBED))
    assert system is not None
    return system


def sparse_matrix(stencil: np.ndarray, free: np.ndarray) -> sp.csr_matrix:
    """The free cells' symmetric matrix for the peers."""
    rows, lanes = free.shape
    index = np.arange(rows * lanes).reshape(rows, lanes)
    south, north = np.roll(index, 1, 1), np.roll(index, -1, 1)
    columns = [np.roll(index, 1, 0), south, index, north, np.roll(index, -1, 0)]
    entries = np.concatenate([stencil[:, k] for k in range(5)])
    where = (np.tile(index.ravel(), 5), np.concatenate([c.ravel() for c in columns]))
    whole = sp.coo_matrix((entries, where), shape=(index.size, index.size)).tocsr()
    keep = np.flatnonzero(free.ravel())
    return whole[keep][:, keep].tocsr()


def film_times(
    stencil: np.ndarray, free: np.ndarray, rhs: np.ndarray
) -> tuple[float, float, float, int]:
    """Set-up, solution and solution from a former one [ms], and iterations [-]."""
    system = eliminated(stencil, free)
    field = system.solve(rhs, None, 1e-8)
    count = system.effort
    setup = best(lambda: eliminated(stencil, free), 3)
    solve = best(lambda: system.solve(rhs, None, 1e-8), 5)
    warm = best(lambda: system.solve(1.01 * rhs, field, 1e-8), 5)
    return setup, solve, warm, count


def peers(matrix: sp.csr_matrix, b: np.ndarray, own: float) -> None:
    print(f"  own blocks, setup and solution     {own:8.0f}    times own")
    columns = matrix.tocsc()
    for name, order, options in (
        ("SciPy SuperLU as it stands", "COLAMD", {}),
        ("SciPy SuperLU, symmetric order", "MMD_AT_PLUS_A", {"SymmetricMode": True}),
    ):
        superlu = best(
            lambda p=order, o=options: spl.splu(columns, permc_spec=p, options=o).solve(b), 3
        )
        print(f"  {name:34s} {superlu:8.0f} {superlu / own:8.1f}")
    for name in ("pyamg", "pypardiso"):
        if not find_spec(name):
            print(f"  {name} is not installed: no comparison")
    if find_spec("pyamg"):
        import pyamg

        levels = pyamg.ruge_stuben_solver(matrix)
        setup = best(lambda: pyamg.ruge_stuben_solver(matrix), 2)
        solve = best(lambda: levels.solve(b, tol=1e-8, accel="cg"), 2)
        whole = setup + solve
        print(f"  PyAMG Ruge-Stueben, setup {setup:.0f}     {whole:8.0f} {whole / own:8.1f}")
    if find_spec("pypardiso"):
        try:
            import pypardiso
        except ImportError as error:
            print(f"  MKL Pardiso cannot be loaded: {error}")
            return
        upper = sp.triu(matrix, format="csr")
        solver = pypardiso.PyPardisoSolver(mtype=2)
        pardiso = best(lambda: (solver.factorize(upper), solver.solve(upper, b)), 2)
        print(f"  MKL Pardiso                        {pardiso:8.0f} {pardiso / own:8.1f}")


def lateral_table(sizes: tuple[tuple[int, int], ...]) -> None:
    print("Masked lateral film, residual 1e-8")
    print("      cells   setup   solve    warm  iterations  us/cell")
    for rows, lanes in sizes:
        balance, free = toothed_film(rows, lanes)
        stencil, rhs = right_side(balance, free)
        setup, solve, warm, count = film_times(stencil, free, rhs)
        print(
            f"  {free.size:9d} {setup:7.1f} {solve:7.1f} {warm:7.1f} {count:11d} "
            f"{1e3 * (setup + solve) / free.size:8.2f}"
        )
        if free.size == 122880:
            peers(sparse_matrix(stencil, free), rhs[free.ravel()], setup + solve)


@njit
def _triad(a: np.ndarray, b: np.ndarray, c: np.ndarray) -> None:
    for k in range(a.size):
        a[k] = b[k] + 3.0 * c[k]


def bandwidth(size: int) -> float:
    """What a triad moves on one thread, with a working set as large as a solution's. [GB/s]."""
    a, b, c = np.zeros(size), np.ones(size), np.ones(size)
    return 24e-6 * size / best(lambda: _triad(a, b, c), 5)


def bandwidth_table() -> None:
    print("Memory bandwidth of a triad, one thread")
    for size in (200_000, 20_000_000):
        print(f"  {24 * size / 1e6:8.1f} MB {bandwidth(size):8.1f} GB/s")


def main() -> None:
    """Print all tables."""
    journal_table()
    several_table()
    lateral_table(SIZES)
    bandwidth_table()
