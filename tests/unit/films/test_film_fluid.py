"""Pressures and reduced pressures of a liquid whose viscosity follows the pressure."""

from __future__ import annotations

import numpy as np
import pytest

from toothspace.films.reynolds.equation import FilmGrid
from toothspace.films.reynolds.fluid import FilmFluid, pressure_above

PRESSURES = np.array([0.0, 2e7, 9e7, 1.1e8, 3e8])
LIMITED = FilmFluid(0.02, pressure_viscosity=2e-8, limit_pressure=1e8)
FREE = FilmFluid(0.02, pressure_viscosity=2e-8)
PLAIN = FilmFluid(0.02)


def _integral(fluid: FilmFluid, pressure: float) -> float:
    """Reduced pressure by its definition. [Pa]."""
    places = np.linspace(0.0, pressure, 200_001)
    return float(np.trapezoid(fluid.dynamic_viscosity / fluid.viscosity(places), places))


@pytest.mark.parametrize("fluid", [LIMITED, FREE, PLAIN])
def test_reduced_pressure_is_the_integral_of_the_fluidity(fluid: FilmFluid) -> None:
    found = fluid.reduced(PRESSURES)
    assert found == pytest.approx([_integral(fluid, p) for p in PRESSURES], rel=1e-6)
    assert fluid.pressure(found) == pytest.approx(PRESSURES, rel=1e-9, abs=1e-3)


@pytest.mark.parametrize("fluid", [LIMITED, FREE, PLAIN])
@pytest.mark.parametrize("lowest", [0.0, 3e7])
def test_potentials_are_counted_from_the_lowest_pressure(fluid: FilmFluid, lowest: float) -> None:
    """For whole fields and for compiled code, which also needs the slope."""
    above = np.array([0.0, 1e7, 6e7, 2e8])
    potential = fluid.reduced(above + lowest) - fluid.reduced(np.array(lowest))
    assert fluid.gauge(potential, lowest) == pytest.approx(above, rel=1e-9, abs=1e-3)
    law = fluid.reduced_law(lowest)
    for q, wanted in zip(potential.tolist(), above.tolist(), strict=True):
        found, slope = pressure_above(q, law)
        assert found == pytest.approx(wanted, rel=1e-9, abs=1e-3)
        assert slope == pytest.approx(fluid.stretch(np.array([wanted + lowest]))[0], rel=1e-6)


def test_only_an_unlimited_law_bounds_the_reduced_pressure() -> None:
    assert FREE.highest_reduced == pytest.approx(1.0 / 2e-8, rel=1e-8)
    assert LIMITED.highest_reduced == PLAIN.highest_reduced == np.inf


def test_all_given_pressures_of_a_grid_are_reduced() -> None:
    given = np.array([[4e7]])
    grid = FilmGrid(**dict.fromkeys(FilmGrid._fields, given))  # type: ignore[arg-type]
    found = LIMITED.reduced_grid(grid)
    reduced = [name for name in FilmGrid._fields if getattr(found, name) is not given]
    assert reduced == ["prescribed", "west", "east", "south", "north"]
    for name in reduced:
        assert getattr(found, name) == pytest.approx(_integral(LIMITED, 4e7), rel=1e-6)
