"""Band factorisation against a dense solution, for every width around the panel."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.numerics.banded import (
    empty_band,
    factor_band,
    fill_band,
    solve_bands,
    stencil_product,
)
from toothspace.numerics.krylov import gmres


@pytest.mark.parametrize("lanes", [1, 2, 3, 4, 5, 7, 8, 9, 12, 16])
@pytest.mark.parametrize("cut", [0, 3])
def test_factors_solve_the_cut_system(lanes: int, cut: int) -> None:
    """Random diagonally dominant five-point matrix, dense reference without the cut couplings."""
    rows = 11
    n = rows * lanes
    rng = np.random.default_rng(lanes)
    stencil = -rng.random((n, 5))
    stencil[:, 2] = 4.5
    index = np.arange(n).reshape(rows, lanes)
    dense = np.zeros((n, n))
    for i in range(rows):
        for j in range(lanes):
            r = index[i, j]
            dense[r, r] = stencil[r, 2]
            if i != cut:
                dense[r, index[i - 1, j]] += stencil[r, 0]
            if (i + 1) % rows != cut:
                dense[r, index[(i + 1) % rows, j]] += stencil[r, 4]
            if j > 0:
                dense[r, index[i, j - 1]] += stencil[r, 1]
            if j < lanes - 1:
                dense[r, index[i, j + 1]] += stencil[r, 3]
    band = empty_band(rows, lanes)
    fill_band(stencil, rows, lanes, cut, band)
    factor_band(band, lanes)
    rhs = rng.normal(size=(3, n))
    found = solve_bands(band, stencil, stencil, rhs, cut * lanes)
    exact = np.linalg.solve(dense, rhs.T).T
    assert found == pytest.approx(exact, abs=1e-5 * np.abs(exact).max())


def test_gmres_needs_as_many_iterations_as_distinct_eigenvalues() -> None:
    values = np.repeat([1.0, 2.0, 5.0], 10)
    rhs = np.random.default_rng(0).normal(size=(1, 30))
    limits = 1e-12 * np.linalg.norm(rhs, axis=1)
    x, count = gmres(lambda v: values * v, lambda v: v.copy(), rhs, limits=limits)
    assert count == 3
    assert x == pytest.approx(rhs / values, rel=1e-10)


def test_gmres_has_room_for_long_spaces() -> None:
    values = np.linspace(1.0, 2.0, 20)
    rhs = np.random.default_rng(0).normal(size=(1, 20))
    limits = 1e-13 * np.linalg.norm(rhs, axis=1)
    x, count = gmres(lambda v: values * v, lambda v: v.copy(), rhs, limits=limits)
    assert 8 < count <= 20
    assert x == pytest.approx(rhs / values, rel=1e-11)


def test_right_hand_sides_in_step_need_what_each_needs_alone() -> None:
    """Sides of one, of two and of three eigenvectors, and one of nothing."""
    values = np.repeat([1.0, 2.0, 5.0], 10)
    rhs = np.random.default_rng(0).normal(size=(4, 30))
    rhs[0, 10:], rhs[1, 20:], rhs[3] = 0.0, 0.0, 0.0
    asked: list[int] = []

    def product(v: np.ndarray) -> np.ndarray:
        asked.append(len(v))
        return np.asarray(values * v)

    limits = 1e-12 * np.linalg.norm(rhs, axis=1)
    x, count = gmres(product, lambda v: v.copy(), rhs, limits=limits)
    assert (count, asked) == (3, [3, 2, 1])
    assert x == pytest.approx(rhs / values, rel=1e-10)


def test_gmres_of_nothing_is_nothing() -> None:
    x, count = gmres(lambda v: v, lambda v: v, np.zeros((1, 4)), limits=np.zeros(1))
    assert count == 0
    assert not x.any()


@pytest.mark.parametrize("factor", [0.0, np.inf])
@pytest.mark.filterwarnings("error")
def test_gmres_reports_that_a_singular_or_lost_matrix_has_no_solution(factor: float) -> None:
    ones, limits = np.ones((1, 4)), np.array([1e-12])
    x, _ = gmres(lambda v: factor * ones, lambda v: v.copy(), ones, limits=limits)
    assert np.isnan(x).all()


def test_stencil_product_closes_the_ring() -> None:
    rows, lanes = 5, 3
    stencil = np.zeros((15, 5))
    stencil[:, 0] = 1.0
    x = np.arange(15.0)
    y = stencil_product(stencil, x, rows, lanes)
    assert y.reshape(5, 3) == pytest.approx(np.roll(x.reshape(5, 3), 1, axis=0))
