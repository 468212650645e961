"""Parts written by hand against libraries that do the same, one table.

    python -m benchmarks libraries

Times are the best of several runs after a warm-up, except those of the solid body, which are
single. Libraries that are not dependencies (pypardiso, scikit-fem, gmsh) are left out where they
are not installed. ``bench_films`` compares finer films, ``bench_lumped`` the integrator.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from importlib.util import find_spec
from typing import Any

import numpy as np
import scipy.sparse as sp
import scipy.sparse.linalg as spl
import shapely
from scipy.linalg.lapack import dgbtrf, dgbtrs

from benchmarks.bench_films import (
    bearing,
    best,
    right_side,
    sparse_matrix,
    toothed_film,
)
from toothspace.core.compiled import njit
from toothspace.elasticity.condensation import flexibility
from toothspace.elasticity.elements import stiffness_matrix
from toothspace.elasticity.mesh import (
    Prism,
    SolidMesh,
    Triangulation,
    annulus,
    disc,
    sweep,
    triangulate,
)
from toothspace.numerics.banded import PANEL, empty_band, factor_band, fill_band, solve_bands
from toothspace.numerics.block_elimination import block_system
from toothspace.numerics.static_lu import analyse, factorise, solve

STEEL = (210e9, 0.3)
EDGE = 1.5e-3


def line(name: str, milliseconds: float, note: str = "") -> None:
    print(f"  {name:44s}{milliseconds:12.4g} ms  {note}")


def once(run: Callable[[], Any]) -> tuple[float, Any]:
    """Wall time of one run and what it returns. [ms]."""
    start = time.perf_counter()
    found = run()
    return 1e3 * (time.perf_counter() - start), found


@njit
def _own_loop(program, jacobian, basis, right, count):  # type: ignore[no-untyped-def]
    n = right.size
    values, pivots = np.zeros(n * n), np.zeros(n, dtype=np.int64)
    scratch, x = np.zeros(n), right.copy()
    for _ in range(count):
        kind = factorise(program, jacobian, basis, 1.0, values, pivots)
        x[:] = right
        solve(program, values, pivots, kind, x, scratch)
    return x


@njit
def _lapack_loop(matrix, right, count):  # type: ignore[no-untyped-def]
    x = right
    for _ in range(count):
        x = np.linalg.solve(matrix, right)
    return x


def small_systems(chambers: int = 26, border: int = 10, count: int = 2000) -> None:
    """Ring of chambers with ports and gear motions that touch all: factor and solve."""
    n = chambers + border
    pattern = np.zeros((n, n), dtype=bool)
    for i in range(chambers):
        pattern[i, [(i - 1) % chambers, i, (i + 1) % chambers]] = True
    pattern[chambers:, :] = pattern[:, chambers:] = True
    rng = np.random.default_rng(1)
    jacobian = np.where(pattern, rng.normal(size=(n, n)), 0.0) - 60.0 * np.eye(n)
    right, program, one = rng.normal(size=n), analyse(pattern), np.eye(n)
    matrix = one - jacobian
    columns = sp.csc_matrix(matrix)
    print(f"Iteration matrix, {n} unknowns, factor and solve once")
    line("own", best(lambda: _own_loop(program, jacobian, one, right, count)) / count)
    lapack = best(lambda: _lapack_loop(matrix, right, count))
    line("LAPACK dgesv from compiled code", lapack / count)
    line("SciPy SuperLU, called from Python", best(lambda: spl.splu(columns).solve(right)))


def banded_systems() -> None:
    """Mass-conserving tilted journal film, band of one row of lanes."""
    for rows, lanes in ((100, 27), (200, 53)):
        film = bearing(rows, lanes).solve(
            eccentricity=(0.5, 0.0), tilt=(1e-4, 5e-5), shaft_speed=314.16
        )
        stencil = film.solved.fields.system.stencil
        size, rhs = rows * lanes, np.random.default_rng(0).normal(size=(1, rows * lanes))
        band = empty_band(rows, lanes)
        fill_band(stencil, rows, lanes, 0, band)
        centre = (band.shape[1] - PANEL) // 2
        lapack = np.zeros((3 * lanes + 1, size), order="F")
        for r in range(size):
            for c in range(max(0, r - lanes), min(size, r + lanes + 1)):
                lapack[2 * lanes + r - c, c] = band[r, centre + c - r]

        def own(s=stencil, n=(rows, lanes), b=band, rhs=rhs) -> None:  # type: ignore[no-untyped-def]
            fill_band(s, *n, 0, b)
            factor_band(b, n[1])
            solve_bands(b, s, s, rhs, 0)

        def peer(ab=lapack, w=lanes, rhs=rhs) -> None:  # type: ignore[no-untyped-def]
            factors, pivots, _ = dgbtrf(ab, w, w)
            dgbtrs(factors, w, w, rhs[0], pivots)

        columns = sparse_matrix(stencil, np.ones((rows, lanes), dtype=bool)).tocsc()
        print(f"Journal film, {rows} x {lanes} cells, factor and solve once")
        line("own band", best(own))
        line("LAPACK dgbtrf, dgbtrs", best(peer))
        line("SciPy SuperLU", best(lambda c=columns, b=rhs[0]: spl.splu(c).solve(b), 3))


def face_film() -> None:
    """Lateral film of a gear with tooth spaces at given pressures, residual 1e-8."""
    balance, free = toothed_film(720, 48)
    stencil, rhs = right_side(balance, free)
    kind = np.where(free, 0, 2)
    columns = sparse_matrix(stencil, free).tocsc()
    inner = rhs[free.ravel()]
    print(f"Lateral film, {free.size} cells, {free.sum()} free, factor and solve; solve again")
    blocks = block_system(stencil, kind)
    again = best(lambda: blocks.solve(rhs, None, 1e-8))
    first = best(lambda: block_system(stencil, kind).solve(rhs, None, 1e-8))
    line("own block elimination", first, f"{again:.3g} ms")
    order: dict[str, Any] = {"permc_spec": "MMD_AT_PLUS_A", "options": {"SymmetricMode": True}}
    factors = spl.splu(columns, **order)
    again = best(lambda: factors.solve(inner))
    first = best(lambda: spl.splu(columns, **order).solve(inner), 3)
    line("SciPy SuperLU, symmetric order", first, f"{again:.3g} ms")
    if find_spec("pypardiso"):
        import pypardiso

        matrix = columns.tocsr()
        matrix.sort_indices()
        solver = pypardiso.PyPardisoSolver(mtype=11)
        first = best(lambda: (solver.factorize(matrix), solver.solve(matrix, inner)), 3)
        line("MKL Pardiso", first, f"{best(lambda: solver.solve(matrix, inner)):.3g} ms")


def bearing_body() -> shapely.Polygon:
    """Section of a floating bearing: two overlapping discs with two bores."""
    centres = ((0.0, 0.0), (34.5e-3, 0.0))
    outside = shapely.union_all([disc(20e-3, centre) for centre in centres])
    return outside.difference(shapely.union_all([disc(9e-3, centre) for centre in centres]))


def smallest_angles(points: np.ndarray, triangles: np.ndarray) -> np.ndarray:
    """Smallest angle of every triangle. [deg]."""
    corners = points[triangles]
    sides = [corners[:, (k + 1) % 3] - corners[:, k] for k in range(3)]
    angles = [
        np.arccos(
            -np.einsum("ij,ij->i", sides[k - 1], sides[k])
            / np.linalg.norm(sides[k - 1], axis=1)
            / np.linalg.norm(sides[k], axis=1)
        )
        for k in range(3)
    ]
    return np.asarray(np.degrees(np.min(angles, axis=0)))


def quality(angles: np.ndarray) -> str:
    """Words on the shapes of triangles."""
    share = 100.0 * np.mean(angles < 20.0)
    return f"{angles.size} triangles, {share:.1f} % with an angle below 20 deg"


def triangles() -> None:
    """Section of a bearing with the border of its balance area kept as edges."""
    section = bearing_body()
    area = section.intersection(annulus(11e-3, 17e-3, (34.5e-3, 0.0)))
    found: Triangulation = triangulate([section, area], EDGE)
    print(f"Triangles of a bearing, edges of {1e3 * EDGE:g} mm")
    note = quality(smallest_angles(found.points, found.triangles))
    line("own on SciPy Delaunay", best(lambda: triangulate([section, area], EDGE), 3), note)
    parts = [section.difference(area), area]
    split = [shapely.segmentize(shapely.simplify(part, 0.02 * EDGE), EDGE) for part in parts]
    run = lambda: shapely.constrained_delaunay_triangles(split)  # noqa: E731
    pieces = shapely.get_parts(shapely.get_parts(run()))
    points = np.concatenate([shapely.get_coordinates(piece)[:3] for piece in pieces])
    note = quality(smallest_angles(points, np.arange(len(points)).reshape(-1, 3)))
    line("shapely, constrained Delaunay", best(run, 3), note)


def _condensed_by(
    factor: Callable[[sp.csr_matrix], Callable[[np.ndarray], np.ndarray]],
    matrix: sp.csr_matrix,
    loads: sp.csc_matrix,
) -> np.ndarray:
    solver = factor(matrix)
    columns = [
        loads.T @ solver(np.asfortranarray(loads[:, k : k + 50].toarray()))
        for k in range(0, loads.shape[1], 50)
    ]
    return np.hstack(columns)


def _pardiso(matrix: sp.csr_matrix) -> Callable[[np.ndarray], np.ndarray]:
    import pypardiso

    upper = sp.triu(matrix, format="csr")
    upper.sort_indices()
    solver = pypardiso.PyPardisoSolver(mtype=2)
    solver.factorize(upper)
    return lambda side: solver.solve(upper, side)


def _superlu(matrix: sp.csr_matrix) -> Callable[[np.ndarray], np.ndarray]:
    options = {"SymmetricMode": True}
    return spl.splu(matrix.tocsc(), permc_spec="MMD_AT_PLUS_A", options=options).solve


def _pressed_face(mesh: SolidMesh, columns: int) -> sp.csc_matrix:
    """Forces along z on nodes of the upper face."""
    top = np.flatnonzero(mesh.nodes[:, 2] > mesh.nodes[:, 2].max() - 1e-9)
    chosen = top[np.linspace(0, top.size - 1, columns).astype(int)]
    where = (3 * chosen + 2, np.arange(columns))
    return sp.csc_matrix((np.ones(columns), where), shape=(3 * len(mesh.nodes), columns))


def solid_body(columns: int = 200) -> None:
    """Stiffness of a swept bearing and its flexibility under loads on one face."""
    mesh = sweep((Prism(bearing_body(), 0.0, 12e-3),), 2.0 * EDGE, 3e-3)
    stiffness_matrix(mesh, *STEEL)
    milliseconds, matrix = once(lambda: stiffness_matrix(mesh, *STEEL))
    count = f"{len(mesh.elements)} hexahedra, {matrix.shape[0]} unknowns"
    print(f"Solid bearing, {count}, {columns} loads")
    line("own stiffness (incompatible modes)", milliseconds)
    if find_spec("skfem"):
        line("scikit-fem stiffness (trilinear)", once(lambda: _by_skfem(mesh))[0])
    bottom = np.flatnonzero(mesh.nodes[:, 2] < 1e-9)
    fixed = (3 * bottom[:, None] + np.arange(3)).ravel()
    loads = _pressed_face(mesh, columns)
    flexibility(matrix, mesh.nodes, loads[:, :2], fixed)
    milliseconds, own = once(lambda: flexibility(matrix, mesh.nodes, loads, fixed))
    line("own nested dissection, condensed", milliseconds)
    keep = np.setdiff1d(np.arange(matrix.shape[0]), fixed)
    reduced, forces = matrix[keep][:, keep].tocsr(), loads[keep].tocsc()
    peers = {"SciPy SuperLU, symmetric order": _superlu}
    if find_spec("pypardiso"):
        peers["MKL Pardiso"] = _pardiso
    for name, factor in peers.items():
        milliseconds, other = once(lambda f=factor: _condensed_by(f, reduced, forces))
        line(name, milliseconds, f"largest difference {np.abs(other / own - 1.0).max():.0e}")


def _by_skfem(mesh: SolidMesh) -> sp.csr_matrix:
    from skfem import Basis, ElementHex1, ElementVector, MeshHex
    from skfem.models.elasticity import lame_parameters, linear_elasticity

    corners = mesh.elements[:, [0, 1, 3, 4, 2, 5, 7, 6]]
    other = MeshHex(np.ascontiguousarray(mesh.nodes.T), np.ascontiguousarray(corners.T))
    basis = Basis(other, ElementVector(ElementHex1()), intorder=2)
    return linear_elasticity(*lame_parameters(*STEEL)).assemble(basis)


def main() -> None:
    """Print all tables."""
    small_systems()
    banded_systems()
    face_film()
    triangles()
    solid_body()
