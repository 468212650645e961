"""Films that cannot be meant: one line with key, what was found and what is allowed."""

from __future__ import annotations

from dataclasses import replace

import pytest

from toothspace.api import load_case, solve_bearing, solve_film
from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.films import (
    FilmFluid,
    Groove,
    JournalBearing,
    LateralFilm,
    Pad,
    Pocket,
    RoughSurfaces,
)

ROUGH = RoughSurfaces(moving_roughness=2e-7, resting_roughness=3e-7)
BEARING = JournalBearing(
    diameter=0.05, length=0.02, radial_clearance=30e-6, dynamic_viscosity=0.02, grid=(48, 9)
)
CASE = """
schema = 1
[bearing]
diameter = "50 mm"
length = "20 mm"
radial_clearance = "30 um"
shaft_speed = "3000 rpm"
dynamic_viscosity = "0.02 Pa s"
eccentricity = [0.5, 0.0]
"""


def test_pocket_beyond_the_pad() -> None:
    with pytest.raises(CaseError, match=r"film\.pocket\.x: found 20 mm.* below 20 mm"):
        Pad(
            length=0.02,
            width=0.01,
            inlet_height=2e-5,
            outlet_height=1e-5,
            fluid=FilmFluid(0.02),
            pocket=Pocket(1e-6, 0.02, 0.004, 0.004),
        )


def test_groove_beyond_the_bearing() -> None:
    with pytest.raises(CaseError, match=r"bearing\.grooves\.position: found 16 mm"):
        replace(BEARING, grooves=(Groove(0.0, 0.3, 0.012, 1e5, 0.016),))


def test_rough_walls_far_inside_each_other() -> None:
    """Beyond three times the roughness no law of contact holds."""
    with pytest.raises(CaseError, match=r"bearing\.eccentricity: .* from -1\.08 um"):
        replace(BEARING, surfaces=ROUGH).solve(eccentricity=(1.05, 0.0), shaft_speed=10.0)
    ring = LateralFilm(
        inner_radius=0.01,
        outer_radius=0.03,
        side_gap=1e-5,
        fluid=FilmFluid(0.02),
        tilt=(1e-3, 0.0),
        grid=(32, 16),
        inner_pressure=1e5,
        surfaces=ROUGH,
    )
    with pytest.raises(CaseError, match=r"film\.side_gap: found a smallest gap of -1"):
        ring.solve()


def test_closed_film_without_supply() -> None:
    closed = replace(BEARING, end_condition="no_flow", supply="none")
    for motion in ({"shaft_speed": 10.0}, {"shaft_speed": 0.0, "velocity": (0.01, 0.0)}):
        with pytest.raises(CaseError, match=r"bearing\.supply: found 'none' between walls"):
            closed.solve(eccentricity=(0.5, 0.0), **motion)  # type: ignore[arg-type]
    still = closed.solve(eccentricity=(0.5, 0.0), shaft_speed=0.0)
    assert still.status.succeeded
    assert still.load == 0.0


@pytest.mark.parametrize(
    ("rest", "key"),
    [
        ('orbit = {mass = "5 kg", duration = "1 s", time_step = "2 s"}', "orbit.time_step"),
        (
            'surfaces = {moving_roughness = "1 um", resting_roughness = "1 um", '
            'contact_law = "table", contact_points = [[1.0, "5 MPa"], [0.5, "9 MPa"]]}',
            "surfaces.contact_points",
        ),
        (
            'surfaces = {moving_roughness = "1 um", resting_roughness = "1 um", '
            'contact_law = "table"}',
            "surfaces.contact_points",
        ),
    ],
)
def test_case_names_the_key(rest: str, key: str) -> None:
    with pytest.raises(CaseError, match=rf"bearing\.{key.replace('.', '[.]')}: found") as told:
        Case.from_toml(CASE + rest)
    assert "\n" not in str(told.value)


@pytest.mark.parametrize("table", ["bearing", "film"])
def test_a_case_without_the_table_is_refused_by_its_name(table: str) -> None:
    case = load_case("egm12_pump")
    with pytest.raises(CaseError, match=rf"{table}: found nothing, allowed a table \[{table}\]"):
        {"bearing": solve_bearing, "film": solve_film}[table](case)
