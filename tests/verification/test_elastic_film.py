"""Films between elastic walls: rigid limit, agreement of film and walls, load in balance."""

from __future__ import annotations

from dataclasses import replace

import numpy as np
import pytest
import scipy.sparse as sp

from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.films.elastic_film import ElasticWalls, solve_elastic_film
from toothspace.films.plane.film import PlaneFilm, solve_plane
from toothspace.films.plane.pad import Pad
from toothspace.films.reynolds.equation import GapField
from toothspace.films.reynolds.fluid import FilmFluid

SPEED, ROWS, LANES = 5.0, 24, 9
PAD = Pad(
    length=0.02,
    width=0.01,
    inlet_height=12e-6,
    outlet_height=6e-6,
    fluid=FilmFluid(0.01),
    grid=(ROWS, LANES),
)


def _film() -> PlaneFilm:
    return PAD.solve(speed=SPEED).plane.film


def _columns(film: PlaneFilm, approach: float) -> ElasticWalls:
    """Every cell gives way under its own pressure. [m/Pa]."""
    area = film.grid.area.ravel()
    return ElasticWalls(
        sp.identity(area.size, format="csr"), np.diag(approach / area), np.zeros(area.size)
    )


def _lift(film: PlaneFilm) -> GapField:
    return GapField(
        *(np.ones_like(a) for a in film.gap[:3]), *(np.zeros_like(a) for a in film.gap[3:])
    )


def test_stiff_walls_leave_the_film_as_it_is() -> None:
    film = _film()
    found = solve_elastic_film(film, _columns(film, 1e-25))
    assert found.status is Status.DONE
    assert found.plane.pressure == pytest.approx(solve_plane(film).pressure, rel=1e-9)


@pytest.mark.parametrize("approach", [1e-13, 1e-12, 5e-12])
def test_gap_and_pressure_agree(approach: float) -> None:
    """Columns open by their pressure, and the film with that gap has that pressure."""
    film = _film()
    found = solve_elastic_film(film, _columns(film, approach))
    assert found.status is Status.DONE
    pressure = found.plane.pressure
    opening = found.plane.film.gap.centre - film.gap.centre
    assert opening == pytest.approx(approach * pressure, rel=1e-5, abs=1e-13)
    again = solve_plane(replace(film, gap=found.plane.film.gap))
    assert again.pressure == pytest.approx(pressure, rel=1e-9)
    assert float(pressure.max()) < float(solve_plane(film).pressure.max())


def test_free_lift_carries_its_load() -> None:
    film = _film()
    load = 2.0 * float((solve_plane(film).pressure * film.grid.area).sum())
    found = solve_elastic_film(
        film, _columns(film, 1e-12), shapes=(_lift(film),), external=np.array([-load])
    )
    assert found.status is Status.DONE
    assert found.load[0] == pytest.approx(load, rel=1e-6)
    assert found.motion[0] < 0.0


def test_start_from_the_solution_needs_few_steps() -> None:
    film = _film()
    walls = _columns(film, 2e-12)
    first = solve_elastic_film(film, walls)
    again = solve_elastic_film(film, walls, start=first)
    assert again.steps <= 2 < first.steps


def test_walls_that_touch_at_the_start_are_refused() -> None:
    film = _film()
    closed = replace(film, gap=film.gap._replace(centre=film.gap.centre - 9e-6))
    with pytest.raises(CaseError, match="walls that touch"):
        solve_elastic_film(closed, _columns(film, 1e-13))
