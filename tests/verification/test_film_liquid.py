"""Viscosity that grows with the pressure: closed forms, runaway, exact derivatives."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest

from toothspace.cli import main
from toothspace.core.status import Status
from toothspace.films import FilmFluid, JournalBearing, LateralFilm, Pad

VISCOSITY = 0.05
ALPHA = 2e-8
PAD = Pad(
    length=0.02,
    width=0.01,
    inlet_height=20e-6,
    outlet_height=10e-6,
    fluid=FilmFluid(VISCOSITY, ALPHA),
    grid=(200, 4),
    side_condition="no_flow",
    ambient_pressure=0.0,
)
BEARING = JournalBearing(
    diameter=0.05,
    length=0.03,
    radial_clearance=30e-6,
    dynamic_viscosity=0.08,
    pressure_viscosity=ALPHA,
    end_pressure=2e5,
    grid=(72, 14),
)


def _reduced(speed: float) -> np.ndarray:
    """Pressure of the isoviscous endless incline (Reynolds 1886) at the centres of the cells."""
    x = (np.arange(200) + 0.5) / 200
    height = 2.0 - x  # over the outlet height; p = 6 mu U L / h0^2 (h - 1)(2 - h) / (3 h^2)
    scale = 6.0 * VISCOSITY * speed * PAD.length / PAD.outlet_height**2
    return np.asarray(scale * (height - 1.0) * (2.0 - height) / (3.0 * height**2))


def test_endless_incline_with_barus_liquid() -> None:
    """p = -ln(1 - alpha q) / alpha of the isoviscous pressure q (Cameron, Basic Lubrication)."""
    q = _reduced(12.0)
    assert 0.5 < ALPHA * q.max() < 0.9
    found = PAD.solve(speed=12.0)
    assert found.status is Status.DONE
    exact = -np.log1p(-ALPHA * q) / ALPHA
    assert found.pressure[:, 1] == pytest.approx(exact, abs=1e-3 * exact.max())


@pytest.mark.parametrize(("share", "status"), [(0.98, Status.DONE), (1.02, Status.RUNAWAY)])
def test_film_runs_away_where_the_reduced_pressure_reaches_its_limit(
    share: float, status: Status
) -> None:
    speed = share / (ALPHA * _reduced(1.0).max())
    assert PAD.solve(speed=speed).status is status


def test_density_is_found_close_to_the_runaway() -> None:
    """Beyond alpha p of 3 the density settles too, and mass is conserved."""
    speed = 0.95 / (ALPHA * _reduced(1.0).max())
    found = replace(PAD, fluid=FilmFluid(VISCOSITY, ALPHA, compressible=True)).solve(speed=speed)
    assert found.status is Status.DONE
    assert ALPHA * found.max_pressure > 2.0
    assert found.mass_balance_error < 1e-10


def test_radial_flow_of_a_barus_liquid() -> None:
    """Flow between rims is that of the reduced pressures, logarithmic in the radius."""
    ring = LateralFilm(
        inner_radius=0.01,
        outer_radius=0.03,
        side_gap=1e-5,
        fluid=FilmFluid(VISCOSITY, ALPHA),
        grid=(16, 32),
        inner_pressure=1e5,
        outer_pressure=500e5,
    )
    q = -np.expm1(-ALPHA * np.array([1e5, 500e5])) / ALPHA
    exact = np.pi * 1e-15 / (6.0 * VISCOSITY * np.log(3.0)) * (q[1] - q[0])
    assert ring.solve().inner_flow == pytest.approx(exact, rel=1e-9)


def test_coefficients_follow_the_viscosity() -> None:
    """Against central differences of the force."""
    place, speed, step = np.array([0.6, 0.2]), 300.0, 1e-5

    def force(shift: np.ndarray) -> np.ndarray:
        return BEARING.solve(eccentricity=tuple(place + shift), shaft_speed=speed).force

    film = BEARING.solve(eccentricity=tuple(place), shaft_speed=speed)
    assert 0.5 < ALPHA * film.max_pressure < 2.0
    for k, shift in enumerate(np.eye(2) * step):
        slope = (force(shift) - force(-shift)) / (2.0 * step * BEARING.radial_clearance)
        assert film.stiffness[:, k] == pytest.approx(-slope, rel=1e-5)


def test_equilibrium_says_that_the_liquid_runs_away() -> None:
    """The load at the runaway is finite; a constant viscosity carries the same."""
    load, found = (1e5, 0.0), []
    for alpha in (0.0, ALPHA):
        bearing = replace(BEARING, pressure_viscosity=alpha)
        found.append(bearing.equilibrium(load=load, shaft_speed=300.0).status)
    assert found == [Status.DONE, Status.RUNAWAY]


def test_runaway_is_told_in_one_line(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    case = tmp_path / "pad.toml"
    case.write_text(
        'schema = 1\n[film]\nkind = "pad"\nlength = "20 mm"\nwidth = "20 mm"\nspeed = "30 m/s"\n'
        'inlet_height = "20 um"\noutlet_height = "10 um"\ndynamic_viscosity = "0.2 Pa s"\n'
        'pressure_viscosity = "20 1/GPa"\ngrid = [32, 16]\n'
    )
    assert main(["film", str(case), "--json"]) == 3
    said = capsys.readouterr()
    assert '"status": "runaway"' in said.out
    assert said.err.count("\n") == 1
    assert "no finite pressure" in said.err


def test_reduced_pressure_belongs_to_the_limited_viscosity() -> None:
    """It is the integral of mu0 / mu, also beyond the limit, and has an inverse everywhere."""
    fluid = FilmFluid(0.01, pressure_viscosity=2e-8, limit_pressure=1e8)
    pressure = np.linspace(0.0, 3e8, 30001)
    ratio = fluid.dynamic_viscosity / fluid.viscosity(pressure)
    steps = 0.5 * (ratio[1:] + ratio[:-1]) * np.diff(pressure)
    integral = np.concatenate([[0.0], np.cumsum(steps)])
    assert fluid.reduced(pressure) == pytest.approx(integral, rel=1e-6)
    assert fluid.pressure(fluid.reduced(pressure)) == pytest.approx(pressure, rel=1e-12)
    assert fluid.highest_reduced == np.inf
    assert fluid.stretch(pressure) == pytest.approx(1.0 / ratio)
