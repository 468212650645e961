import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st

from toothspace.numerics.static_lu import (
    DENSE_FACTORS,
    SINGULAR,
    SPARSE_FACTORS,
    analyse,
    factorise,
    ledger_product,
    solve,
    states_of,
)


def _ring_with_border(chambers, border):
    n = chambers + border
    pattern = np.zeros((n, n), dtype=bool)
    for i in range(chambers):
        pattern[i, [(i - 1) % chambers, i, (i + 1) % chambers]] = True
    pattern[chambers:, :] = pattern[:, chambers:] = True
    return pattern


def _solution(pattern, jacobian, gamma, right):
    program = analyse(pattern)
    n = pattern.shape[1]
    values, pivots = np.zeros(n * n), np.zeros(n, dtype=np.int64)
    kind = factorise(program, jacobian, np.eye(n), gamma, values, pivots)
    x = right.copy()
    if kind != SINGULAR:
        solve(program, values, pivots, kind, x, np.zeros(n))
    return kind, x


@settings(max_examples=60, deadline=None)
@given(n=st.integers(1, 30), density=st.floats(0.0, 1.0), seed=st.integers(0, 2**32 - 1))
def test_random_diagonally_dominant_systems_are_solved_as_numpy_does(n, density, seed):
    rng = np.random.default_rng(seed)
    pattern = rng.random((n, n)) < density
    jacobian = np.where(pattern, rng.normal(size=(n, n)), 0.0)
    jacobian[np.diag_indices(n)] = -np.abs(jacobian).sum(axis=1)
    right = rng.normal(size=n)
    kind, x = _solution(pattern, jacobian, 0.7, right)
    assert kind in (SPARSE_FACTORS, DENSE_FACTORS)
    expected = np.linalg.solve(np.eye(n) - 0.7 * jacobian, right)
    np.testing.assert_allclose(x, expected, rtol=1e-10, atol=1e-12)


def test_ring_with_border_fills_linearly():
    # A ring of n nodes eliminated by minimum degree fills at most n places a triangle;
    # the border is full anyhow.
    chambers, border = 26, 4
    program = analyse(_ring_with_border(chambers, border))
    full_border = border * border + 2 * border * chambers
    assert program.packed_size[0] <= full_border + 5 * chambers
    assert program.dense[0] == 0


def test_ring_with_border_is_solved_as_numpy_does():
    rng = np.random.default_rng(1)
    pattern = _ring_with_border(26, 4)
    jacobian = np.where(pattern, rng.normal(size=pattern.shape), 0.0) - 60.0 * np.eye(30)
    right = rng.normal(size=30)
    kind, x = _solution(pattern, jacobian, 3.0, right)
    assert kind == SPARSE_FACTORS
    np.testing.assert_allclose(
        x, np.linalg.solve(np.eye(30) - 3.0 * jacobian, right), rtol=1e-11, atol=1e-14
    )


def test_full_pattern_is_dense():
    assert analyse(np.ones((8, 8), dtype=bool)).dense[0] == 1


def test_vanishing_pivot_falls_back_to_dense_with_row_exchange():
    # I - J has zeros on its diagonal, yet is regular.
    n = 12
    pattern = np.eye(n, dtype=bool) | np.eye(n, k=1, dtype=bool) | np.eye(n, k=-1, dtype=bool)
    jacobian = np.eye(n)
    for i in range(0, n, 2):
        jacobian[i, i + 1] = jacobian[i + 1, i] = 2.0
    right = np.arange(1.0, n + 1.0)
    kind, x = _solution(pattern, jacobian, 1.0, right)
    assert kind == DENSE_FACTORS
    np.testing.assert_allclose(x, np.linalg.solve(np.eye(n) - jacobian, right), rtol=1e-13)


@pytest.mark.parametrize("entry", [1.0, np.nan, np.inf])
def test_singular_or_undefined_matrix_is_reported(entry):
    jacobian = np.zeros((3, 3))
    jacobian[1, 1] = entry
    kind, _ = _solution(np.eye(3, dtype=bool), jacobian, 1.0, np.ones(3))
    assert kind == SINGULAR


def test_ledger_rows_are_multiplied_by_their_pattern():
    rng = np.random.default_rng(2)
    pattern = rng.random((9, 5)) < 0.4
    jacobian = np.where(pattern, rng.normal(size=(9, 5)), 0.0)
    vector, product = rng.normal(size=5), np.zeros(4)
    ledger_product(analyse(pattern), jacobian, vector, product)
    np.testing.assert_allclose(product, jacobian[5:] @ vector, rtol=1e-14, atol=1e-15)


def test_pattern_with_too_few_rows_is_refused():
    with pytest.raises(ValueError, match="3 rows and 4 columns"):
        analyse(np.ones((3, 4), dtype=bool))


def test_unknowns_in_another_basis_are_solved_as_numpy_does():
    rng = np.random.default_rng(3)
    n = 14
    pattern = np.eye(n, k=1, dtype=bool) | np.eye(n, k=-2, dtype=bool)
    off = np.triu(rng.random((n, n)) < 0.1, 1)
    jacobian = np.where(pattern, rng.normal(size=(n, n)), 0.0)
    basis = np.eye(n) + np.where(off, rng.normal(size=(n, n)), 0.0)
    program = analyse(pattern, off)
    values, pivots, x = np.zeros(n * n), np.zeros(n, dtype=np.int64), rng.normal(size=n)
    right, states = x.copy(), np.zeros(n)
    kind = factorise(program, jacobian, basis, 0.1, values, pivots)
    assert kind == SPARSE_FACTORS
    solve(program, values, pivots, kind, x, np.zeros(n))
    expected = np.linalg.solve(basis - 0.1 * jacobian, right)
    np.testing.assert_allclose(x, expected, rtol=1e-11, atol=1e-13)
    states_of(program, basis, x, states)
    np.testing.assert_allclose(states, basis @ expected, rtol=1e-11, atol=1e-13)


def test_rows_and_columns_of_different_patterns_fill_only_what_they_touch():
    # An arrow whose point is eliminated first would fill all; one-sided it fills nothing.
    n = 20
    pattern = np.eye(n, dtype=bool)
    pattern[:, 0] = True
    program = analyse(pattern)
    assert program.packed_size[0] == 2 * n - 1
    assert program.run_length.sum() == 0
