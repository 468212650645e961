"""Smooth basis functions of the gap of a face."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

from tests.lateral_stack import INNER, OUTER, ring_stack
from toothspace.floating.face_grid import BasisFunctions, FaceGrid


@pytest.fixture(params=[0.0, 0.37])
def basis(request: pytest.FixtureRequest) -> BasisFunctions:
    """On lanes of one width, and on lanes that meet a root circle."""
    whole = ring_stack(cells=(40, 7)).grids[0]
    root_radius = INNER + request.param * (OUTER - INNER)
    own = replace(whole.interface, root_radius=root_radius)
    return BasisFunctions(FaceGrid(own, 40, 7), 3, 2)


def test_coefficients_of_a_sum_come_back(basis: BasisFunctions) -> None:
    coefficients = np.random.default_rng(1).standard_normal(basis.count)
    field = basis.combine(coefficients)
    assert basis.count == 21
    np.testing.assert_allclose(basis.fit(field), coefficients, atol=1e-12)
    rows = sp.csr_matrix(field.ravel())
    np.testing.assert_allclose(basis.fit_rows(rows)[0], coefficients, atol=1e-12)


def test_planes_are_among_the_basis_functions(basis: BasisFunctions) -> None:
    """A lift, and rotations about x and y: 1, y and -x."""
    p = basis.grid.points
    for coefficients, wanted in zip(basis.planes().T, (np.ones_like(p.x), p.y, -p.x), strict=True):
        np.testing.assert_allclose(basis.combine(coefficients), wanted, atol=1e-12)


def test_gap_changes_are_the_basis_functions_at_centres_and_edges(basis: BasisFunctions) -> None:
    """With the coefficients of a rotation about x they sum to y, and grow with the frequency."""
    p, coefficients = basis.grid.points, basis.planes()[:, 1]
    gap_changes = list(basis.gap_changes(50.0))
    for name, wanted in (("centre", p.y), ("face_x", p.face_x[1]), ("face_y", p.face_y[1])):
        found = sum(
            size * getattr(lift, name) for size, lift in zip(coefficients, gap_changes, strict=True)
        )
        np.testing.assert_allclose(found, wanted, atol=1e-12)
    rate = sum(size * lift.rate for size, lift in zip(coefficients, gap_changes, strict=True))
    np.testing.assert_allclose(rate, 50.0 * p.y, atol=1e-10)


def test_fields_of_lost_films_have_no_coefficients(basis: BasisFunctions) -> None:
    """A search that loses its films goes on to say so; it ended with a traceback."""
    field = basis.combine(np.ones(basis.count))
    field[0, 0] = np.nan
    assert np.isnan(basis.fit(field)).all()
