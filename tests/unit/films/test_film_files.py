"""NetCDF and VTK files of film fields, and the tables of the command line."""

from __future__ import annotations

import base64
import re
from dataclasses import replace
from functools import cache
from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from toothspace.api import solve_bearing, solve_film
from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.films import (
    FilmFluid,
    JournalBearing,
    LateralFilm,
    Pad,
    save_film,
    save_film_vtk,
)
from toothspace.films.field_files import FilmSolution

BEARING = JournalBearing(
    diameter=0.05, length=0.02, radial_clearance=40e-6, dynamic_viscosity=0.02, grid=(24, 7)
)
NAMES = ("journal", "lateral", "pad")


@cache
def _films() -> dict[str, FilmSolution]:
    return {
        "journal": BEARING.solve(eccentricity=(0.5, 0.0), shaft_speed=100.0),
        "lateral": LateralFilm(
            inner_radius=9e-3,
            outer_radius=20e-3,
            side_gap=1e-5,
            fluid=FilmFluid(0.02),
            grid=(24, 6),
            inner_pressure=1e5,
            outer_pressure=5e5,
        ).solve(shaft_speed=100.0),
        "pad": Pad(
            length=0.02,
            width=0.01,
            inlet_height=2e-5,
            outlet_height=1e-5,
            fluid=FilmFluid(0.02),
            grid=(12, 5),
        ).solve(speed=1.0),
    }


@pytest.mark.parametrize("name", NAMES)
def test_netcdf_holds_fields_with_units(name: str, tmp_path: Path) -> None:
    film = _films()[name]
    save_film(film, tmp_path / "film.nc")
    with xr.open_dataset(tmp_path / "film.nc", engine="h5netcdf") as data:
        assert data["pressure"].attrs["units"] == "Pa"
        assert data["pressure"].to_numpy() == pytest.approx(film.pressure)
        assert data["gap_height"].to_numpy().min() > 0.0
        assert data.attrs["status"] == "done"


def _decoded(text: str, name: str) -> np.ndarray:
    found = re.search(rf'Name="{name}"[^>]*>([^<]*)<', text)
    assert found is not None
    return np.frombuffer(base64.b64decode(found.group(1))[4:], dtype="<f8")


@pytest.mark.parametrize("name", NAMES)
def test_vtk_surface_has_the_area_of_the_film(name: str, tmp_path: Path) -> None:
    """Decode points and cells again; the quadrilaterals add up to the film area."""
    film = _films()[name]
    save_film_vtk(film, tmp_path / "film.vts")
    text = (tmp_path / "film.vts").read_text()
    rows, lanes = film.pressure.shape
    assert _decoded(text, "pressure") == pytest.approx(film.pressure.ravel())
    points = _decoded(text, "points").reshape(rows + 1, lanes + 1, 3)
    along, across = points[1:, 1:] - points[:-1, :-1], points[1:, :-1] - points[:-1, 1:]
    assert text.count(f'Extent="0 {lanes} 0 {rows} 0 0"') == 2
    if name == "pad":
        np.testing.assert_allclose(points[:, 0, 0], 0.02 * np.arange(rows + 1) / rows, atol=1e-12)
        across_pad = np.diff(points[0, :, 1])
        np.testing.assert_allclose(across_pad, 0.01 / lanes, atol=1e-12)
    area = 0.5 * np.linalg.norm(np.cross(along, across), axis=-1).sum()
    exact = {
        "journal": np.pi * 0.05 * 0.02,
        "lateral": np.pi * (0.02**2 - 0.009**2),
        "pad": 0.02 * 0.01,
    }
    assert area == pytest.approx(exact[name], rel=0.015)


def _bearing_case(place: str = "eccentricity = [0.5, 0.0]") -> Case:
    return Case.from_toml(
        'schema = 1\n[bearing]\ndiameter = "100 mm"\nlength = "80 mm"\n'
        'radial_clearance = "150 um"\nshaft_speed = "3000 rpm"\ndynamic_viscosity = "0.01 Pa s"\n'
        f"grid = [60, 15]\n{place}\n"
        '[[bearing.grooves]]\nangle = "90 deg"\nwidth = "15 deg"\nlength = "60 mm"\n'
        'pressure = "1.7 bar"\n'
    )


def test_bearing_table_gives_the_promised_names() -> None:
    numbers = solve_bearing(_bearing_case())
    names = (
        "force_x_N force_y_N moment_x_N_m moment_y_N_m friction_torque_N_m eccentricity_ratio "
        "attitude_angle_deg sommerfeld_number sommerfeld_number_din side_flow_L_per_min "
        "max_pressure_bar min_film_um cavitated_fraction mass_balance_error stiffness_N_per_m "
        "damping_N_s_per_m status wall_time_s"
    )
    assert set(names.split()) <= set(numbers)
    assert numbers["min_film_um"] == pytest.approx(75.0)
    product = numbers["sommerfeld_number"] * numbers["sommerfeld_number_din"]
    assert product == pytest.approx(1.0 / (2.0 * np.pi))


def test_bearing_table_with_a_load() -> None:
    numbers = solve_bearing(_bearing_case('load = ["1000 N", "0 N"]'))
    assert numbers["force_x_N"] == pytest.approx(-1000.0, rel=1e-6)
    assert numbers["status"] == "done"


def test_missing_viscosity_is_refused() -> None:
    case = _bearing_case()
    assert case.bearing is not None
    with pytest.raises(CaseError, match="dynamic_viscosity"):
        solve_bearing(replace(case, bearing=replace(case.bearing, dynamic_viscosity=None)))


def test_film_table_gives_the_promised_names() -> None:
    numbers = solve_film(
        Case.from_toml(
            'schema = 1\n[film]\nkind = "pad"\nlength = "20 mm"\nwidth = "10 mm"\n'
            'speed = "1 m/s"\ninlet_height = "20 um"\noutlet_height = "10 um"\n'
            'pocket = {depth = "0.4 um", x = "4 mm", length = "6 mm", width = "7 mm"}\n'
            'dynamic_viscosity = "0.01 Pa s"\ngrid = [32, 16]\n'
        )
    )
    names = (
        "load_N center_of_pressure_x_mm friction_N max_pressure_bar inlet_flow_L_per_min "
        "side_flow_L_per_min cavitated_fraction mass_balance_error pressure_centerline_bar "
        "status wall_time_s"
    )
    assert set(names.split()) <= set(numbers)
    assert len(numbers["pressure_centerline_bar"]) == 32
    assert numbers["inlet_flow_L_per_min"] == pytest.approx(
        numbers["outlet_flow_L_per_min"] + numbers["side_flow_L_per_min"], rel=1e-9
    )
