"""Films between compliant faces: rigid limit, film and faces in agreement, independent solver."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

from tests.lateral_stack import HIGH, LOW, pressures, ring_stack
from tests.reference_formulas.elastic_film import ElasticWalls, solve_elastic_film
from toothspace.core.status import Status
from toothspace.films.plane.film import PlaneFilm, PlaneSolution, solve_plane
from toothspace.floating.face_film import FaceFilm
from toothspace.numerics.linear_system import UNSATURATED

GRIDS = ((36, 10), (72, 20))
"""Cells round and across, the second half as large."""

GAP, TILT = 6e-6, (1.2e-4, -0.8e-4)
"""Level of the ring and its tilts: the film breaks up where the gap widens. [m, rad]"""


def _film(approach: float, cells: tuple[int, int] = (36, 10)) -> FaceFilm:
    """Film of the tilted ring as the force balance of a bearing solves it."""
    stack = ring_stack(rough=False, motion="full", approach=approach, cells=cells)
    q = stack.start(GAP)
    q[1:3] = TILT
    flat = [np.zeros((g.rows, g.lanes)) for g in stack.grids]
    return stack.solve(
        stack.snapshot(0.0, pressures(HIGH)), q, np.zeros(stack.size), None, flat
    ).films[0]


def _undeformed(cells: tuple[int, int] = (36, 10)) -> PlaneFilm:
    return _film(0.0, cells).plane.film


def _independent(film: PlaneFilm, approach: float) -> PlaneSolution:
    """Every cell deforms under its own pressure."""
    area = film.grid.area.ravel()
    walls = ElasticWalls(
        sp.identity(area.size, format="csr"), np.diag(approach / area), np.zeros(area.size), LOW
    )
    found = solve_elastic_film(film, walls)
    assert found.status is Status.DONE
    return found.plane


def _off(found: np.ndarray, expected: np.ndarray) -> float:
    """Largest difference of two pressures over the span of one."""
    return float(np.abs(found - expected).max() / np.ptp(expected))


def test_stiff_faces_leave_the_film_as_it_is() -> None:
    """Up to the gaps between the cells, of which compliant faces have one on either side."""
    errors = [_off(_film(1e-25, c).pressure, _film(0.0, c).pressure) for c in GRIDS]
    assert errors[1] < 0.5 * errors[0]  # better than first order
    assert errors[1] < 3e-3


@pytest.mark.parametrize("closing", [0.0, 1e-11, 1e-6])
def test_ring_that_begins_empty_fills_between_pressures(closing: float) -> None:
    """Also while it closes: cells that hold less than nothing take what flows in."""
    stack = ring_stack(rough=False, approach=1e-13)
    snapshot, rates = stack.snapshot(0.0, pressures(HIGH)), np.zeros(stack.size)
    rates[0] = -closing
    flat = [np.zeros((g.rows, g.lanes)) for g in stack.grids]
    full = stack.solve(snapshot, stack.start(GAP), rates, None, flat)
    films = []
    for film in full.films:
        solution = film.solution
        kind, unknown = solution.kind.copy(), solution.plane.fields
        kind[:, :3] = UNSATURATED
        potential = np.where(kind == UNSATURATED, 0.0, unknown.potential)
        saturation = np.where(kind == UNSATURATED, 0.5, 1.0)
        fields = replace(unknown, kind=kind, potential=potential, saturation=saturation)
        plane = replace(solution.plane, fields=fields)
        films.append(replace(film, solution=replace(solution, kind=kind, plane=plane)))
    again = stack.solve(snapshot, stack.start(GAP), rates, replace(full, films=films), flat)
    for film, wanted in zip(again.films, full.films, strict=True):
        assert film.plane.status is Status.DONE
        assert np.all(film.plane.fields.saturation == 1.0)
        assert film.pressure == pytest.approx(wanted.pressure, rel=1e-6)


@pytest.mark.parametrize("approach", [1e-14, 3e-13, 1e-12])
def test_gap_and_pressure_agree(approach: float) -> None:
    """Faces open by their pressure, and a rigid film with that gap has that pressure."""
    errors = []
    for cells in GRIDS:
        found = _film(approach, cells)
        assert found.plane.status is Status.DONE
        opening = found.gap - _undeformed(cells).gap.centre
        assert opening == pytest.approx(approach * (found.pressure - LOW), rel=1e-5, abs=1e-13)
        errors.append(_off(found.pressure, solve_plane(found.plane.film).pressure))
    assert errors[1] < 0.5 * errors[0]
    assert errors[1] < (3e-3 if approach < 1e-12 else 3e-2)  # the last doubles the gap


def test_compliant_faces_lower_the_highest_pressure() -> None:
    assert _film(1e-12).pressure.max() < 0.99 * _film(0.0).pressure.max()


def test_an_independent_solver_finds_the_same_film() -> None:
    """GMRES over all deformations against elimination cell by cell, each with its own faces."""
    errors = [
        _off(_film(3e-13, c).pressure, _independent(_undeformed(c), 3e-13).pressure) for c in GRIDS
    ]
    assert errors[1] < 0.5 * errors[0]
    assert errors[1] < 5e-3


def test_independent_solver_agrees_with_its_own_gap() -> None:
    film = _undeformed()
    found = _independent(film, 3e-13)
    opening = found.film.gap.centre - film.gap.centre
    assert opening == pytest.approx(3e-13 * (found.pressure - LOW), rel=1e-5, abs=1e-13)
    again = solve_plane(replace(film, gap=found.film.gap))
    assert again.pressure == pytest.approx(found.pressure, rel=1e-9)
