"""Elimination of rows of a ring against a dense solution."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.numerics.banded import stencil_product
from toothspace.numerics.block_elimination import block_system
from toothspace.numerics.linear_system import PRESCRIBED, SATURATED

ROWS = 41


def _ring(lanes: int) -> tuple[np.ndarray, np.ndarray]:
    """Random diagonally dominant matrix in the units of thin films, cells uncoupled at the rim."""
    rng = np.random.default_rng(lanes)
    kind = np.full((ROWS, lanes), SATURATED)
    if lanes > 2:
        kind[5:9, lanes // 2 :] = PRESCRIBED
        kind[20, 0] = PRESCRIBED
        kind[30, 1] = PRESCRIBED
    kind[12] = PRESCRIBED
    free = kind == SATURATED
    stencil = -rng.random((ROWS * lanes, 5))
    stencil[:, 2] = 4.5
    around = (np.roll(free, 1, 0), np.roll(free, 1, 1), np.roll(free, -1, 1), np.roll(free, -1, 0))
    for place, other in zip((0, 1, 3, 4), around, strict=True):
        stencil[~(free & other).ravel(), place] = 0.0
    ends = np.arange(ROWS * lanes).reshape(ROWS, lanes)
    stencil[ends[:, 0], 1] = stencil[ends[:, -1], 3] = 0.0
    return stencil * 1e-17, kind


def _dense(stencil: np.ndarray, lanes: int) -> np.ndarray:
    size = len(stencil)
    columns = [stencil_product(stencil, one, ROWS, lanes) for one in np.eye(size)]
    return np.array(columns).T


@pytest.mark.parametrize("lanes", [1, 2, 7, 18])
def test_solution_is_that_of_the_dense_matrix(lanes: int) -> None:
    """Odd and even blocks, rows without unknowns and rows whose ends are prescribed."""
    stencil, kind = _ring(lanes)
    rhs = np.random.default_rng(1).normal(size=len(stencil)) * 1e-10
    system = block_system(stencil, kind)
    assert system is not None
    assert system.solve(rhs) == pytest.approx(
        np.linalg.solve(_dense(stencil, lanes), rhs), rel=1e-9
    )


def test_blocks_serve_a_matrix_nearby() -> None:
    """Also where some cells hold an unknown of another unit; other prescribed cells end that."""
    stencil, kind = _ring(7)
    first = block_system(stencil, kind)
    assert first is not None
    nearby = stencil.copy()
    nearby[:, [0, 4]] *= 0.7
    unit = np.ones((ROWS, 7))
    unit[1, 3:5] = 1e6
    around = (np.roll(unit, 1, 0), np.roll(unit, 1, 1), unit, np.roll(unit, -1, 1))
    for place, factor in enumerate((*around, np.roll(unit, -1, 0))):
        nearby[:, place] *= factor.ravel()
    second = block_system(nearby, kind, first)
    assert second is not None
    rhs = np.ones(len(stencil))
    assert second.blocks is first.blocks
    assert second.solve(rhs) == pytest.approx(np.linalg.solve(_dense(nearby, 7), rhs), rel=1e-9)
    assert 1 < second.effort <= 30
    other = kind.copy()
    other[0, 0] = PRESCRIBED
    third = block_system(stencil, other, first)
    assert third is not None
    assert third.blocks is not first.blocks


def test_vanishing_pivot_gives_no_system() -> None:
    """A matrix of zeros beside its diagonal of zeros in one block."""
    stencil, kind = _ring(1)
    stencil[3, 2] = 0.0
    with np.errstate(divide="ignore", invalid="ignore"):
        assert block_system(stencil, kind) is None
