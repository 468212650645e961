"""Smooth patterns of the gap of a face."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

from tests.lateral_stack import INNER, OUTER, ring_stack
from toothspace.films.lateral.basis_functions import Patterns
from toothspace.films.lateral.face_grid import FaceGrid


@pytest.fixture(params=[0.0, 0.37])
def patterns(request: pytest.FixtureRequest) -> Patterns:
    """On lanes of one width, and on lanes that meet a root circle."""
    whole = ring_stack(cells=(40, 7)).grids[0]
    root_radius = INNER + request.param * (OUTER - INNER)
    own = replace(whole.interface, root_radius=root_radius)
    return Patterns(FaceGrid(own, 40, 7), 3, 2)


def test_sizes_of_a_sum_of_patterns_come_back(patterns: Patterns) -> None:
    sizes = np.random.default_rng(1).standard_normal(patterns.count)
    field = patterns.total(sizes)
    assert patterns.count == 21
    np.testing.assert_allclose(patterns.sizes(field), sizes, atol=1e-12)
    rows = sp.csr_matrix(field.ravel())
    np.testing.assert_allclose(patterns.all_sizes(rows)[0], sizes, atol=1e-12)


def test_planes_are_patterns(patterns: Patterns) -> None:
    """A lift, and rotations about x and y: 1, y and -x."""
    p = patterns.grid.points
    for sizes, wanted in zip(patterns.planes().T, (np.ones_like(p.x), p.y, -p.x), strict=True):
        np.testing.assert_allclose(patterns.total(sizes), wanted, atol=1e-12)


def test_lifts_are_the_patterns_at_centres_and_edges(patterns: Patterns) -> None:
    """Summed with the sizes of a rotation about x they are y, and grow with the frequency."""
    p, sizes = patterns.grid.points, patterns.planes()[:, 1]
    lifts = list(patterns.lifts(50.0))
    for name, wanted in (("centre", p.y), ("face_x", p.face_x[1]), ("face_y", p.face_y[1])):
        found = sum(size * getattr(lift, name) for size, lift in zip(sizes, lifts, strict=True))
        np.testing.assert_allclose(found, wanted, atol=1e-12)
    rate = sum(size * lift.rate for size, lift in zip(sizes, lifts, strict=True))
    np.testing.assert_allclose(rate, 50.0 * p.y, atol=1e-10)
