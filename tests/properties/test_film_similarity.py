"""Films enlarged: lengths, times and viscosity times a factor leave pressures and angles as before.

Every number of a summary is then that of the first film times the power of the factor that its
unit says, and in that unit it is what the solution holds in SI units.
"""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from typing import Any

import numpy as np
import pytest

from toothspace.films import (
    FilmFluid,
    Groove,
    JournalBearing,
    LateralFilm,
    Pad,
    Pocket,
    RoughSurfaces,
)
from toothspace.films.journal.map import _shear
from toothspace.films.summaries import bearing_summary, pad_summary, ring_summary

UNITS = {
    "N_per_m": (1, 1.0), "N_s_per_m": (2, 1.0), "N_m": (3, 1.0), "N": (2, 1.0), "W": (2, 1.0),
    "L_per_min": (2, 6e4), "bar": (0, 1e-5), "um": (1, 1e6), "mm": (1, 1e3), "kg": (3, 1.0),
    "deg": (0, 180.0 / np.pi),
}  # fmt: skip
"""Power of the factor with which a unit grows, and SI units in one of it."""
UNIT = re.compile(rf"_({'|'.join(UNITS)})$")
MATRICES = {
    "stiffness_4x4": np.array([[1, 1, 2, 2]] * 2 + [[2, 2, 3, 3]] * 2),
    "damping_4x4": np.array([[2, 2, 3, 3]] * 2 + [[3, 3, 4, 4]] * 2),
    "stiffness": np.array([[1, 2, 2], [2, 3, 3], [2, 3, 3]]),
    "damping": np.array([[2, 3, 3], [3, 4, 4], [3, 4, 4]]),
}
NAMES = {"min_film": "min_gap_height", "center_of_pressure_x": "center_of_pressure"}
CHECKS = ("mass_balance_error", "status")
ROUGH = RoughSurfaces(moving_roughness=0.4e-6, resting_roughness=0.3e-6)


def rough(factor: float) -> RoughSurfaces:
    return replace(
        ROUGH,
        moving_roughness=factor * ROUGH.moving_roughness,
        resting_roughness=factor * ROUGH.resting_roughness,
        correlation_length=factor * ROUGH.correlation_length,
    )


def bearing(k: float) -> Any:
    film = JournalBearing(
        diameter=k * 18e-3, length=k * 19e-3, radial_clearance=k * 8e-6,
        dynamic_viscosity=k * 0.026, grid=(48, 9), surfaces=rough(k), end_pressure=3e5,
        cavitation_pressure=1e5, grooves=(Groove(1.0, 0.4, k * 8e-3, 6e5, k * 2e-3),),
    )  # fmt: skip
    return film.solve(
        eccentricity=(0.85, -0.2), shaft_speed=150.0 / k, velocity=(2e-4, 1e-4),
        tilt=(2e-5, -1e-5), tilt_rate=(1e-3 / k, 0.0), bush_speed=20.0 / k,
    )  # fmt: skip


def pad(k: float) -> Any:
    film = Pad(
        length=k * 0.02, width=k * 0.03, inlet_height=k * 3e-6, outlet_height=k * 1.2e-6,
        fluid=FilmFluid(k * 0.003, 1e-9, True), grid=(24, 12), surfaces=rough(k),
        pocket=Pocket(k * 3e-6, k * 4e-3, k * 5e-3, k * 1e-2),
    )  # fmt: skip
    return film.solve(speed=0.3, squeeze_velocity=-2e-7)


def ring(k: float) -> Any:
    film = LateralFilm(
        inner_radius=k * 0.01, outer_radius=k * 0.02, side_gap=k * 2e-6, fluid=FilmFluid(k * 0.03),
        tilt=(3e-5, 2e-5), grid=(32, 8), inner_pressure=2e5, outer_pressure=9e5,
        surfaces=rough(k),
    )  # fmt: skip
    return film.solve(shaft_speed=120.0 / k, squeeze_velocity=1e-5)


FILMS: dict[str, tuple[Callable[[float], Any], Callable[[Any], Mapping[str, Any]]]] = {
    "bearing": (bearing, bearing_summary),
    "pad": (pad, pad_summary),
    "ring": (ring, ring_summary),
}


@cache
def solved(name: str, factor: float) -> tuple[Any, Mapping[str, Any]]:
    made, summary = FILMS[name]
    film = made(factor)
    assert film.status.succeeded
    return film, summary(film)


@pytest.mark.parametrize("name", FILMS)
def test_a_film_of_twice_the_size_has_the_numbers_of_its_units(name: str) -> None:
    (_, small), (_, large) = solved(name, 1.0), solved(name, 2.0)
    for label, value in small.items():
        if label in CHECKS or value is None:
            continue
        unit = UNIT.search(label)
        power = MATRICES.get(label, UNITS[unit[1]][0] if unit else 0)
        expected = np.asarray(value) * 2.0 ** np.asarray(power, float)
        size = np.abs(expected).max()
        assert size > 0.0 or label == "cavitated_fraction", label
        np.testing.assert_allclose(large[label], expected, 1e-5, 1e-6 * size, err_msg=label)


@pytest.mark.parametrize("name", FILMS)
def test_numbers_of_a_summary_are_those_of_the_solution_in_their_units(name: str) -> None:
    film, summary = solved(name, 1.0)
    seen = 0
    for label, value in summary.items():
        unit = UNIT.search(label)
        quantity = label.removesuffix(unit[0]) if unit else label
        held = getattr(film, NAMES.get(quantity, quantity), None)
        if isinstance(held, float | np.ndarray):
            scale = UNITS[unit[1]][1] if unit else 1.0
            found = np.ravel(value)  # of a force with its moments the force
            assert found == pytest.approx(
                scale * np.ravel(held)[: found.size], rel=1e-9, abs=0.0
            ), label
            seen += 1
    assert seen > 8


def test_a_ring_that_leans_another_way_is_the_same_film_turned() -> None:
    """A tilt vector a quarter turn on turns gap and moment with it."""
    film = LateralFilm(
        inner_radius=0.01, outer_radius=0.02, side_gap=8e-6, fluid=FilmFluid(0.03),
        tilt=(3e-4, 0.0), grid=(32, 8), inner_pressure=2e5, outer_pressure=9e5,
    )  # fmt: skip
    one = film.solve(shaft_speed=120.0, squeeze_velocity=1e-5)
    other = replace(film, tilt=(0.0, 3e-4)).solve(shaft_speed=120.0, squeeze_velocity=1e-5)
    np.testing.assert_allclose(other.gap_height, np.roll(one.gap_height, 8, axis=0))
    load, about_x, about_y = one.load
    assert np.hypot(about_x, about_y) > 1e-3 * load * film.outer_radius
    assert other.load == pytest.approx([load, -about_y, about_x], rel=1e-6)
    # turned about x by a positive angle, the face rises where y is positive
    quarter = 8
    assert one.gap_height[quarter].mean() > one.gap_height[-quarter].mean()


def test_a_nearly_centred_journal_shears_its_whole_film() -> None:
    """Hardly any cavity: viscous shear is that of a full film, at any size."""
    for k in (1.0, 2.0):
        film = JournalBearing(
            diameter=k * 18e-3, length=k * 19e-3, radial_clearance=k * 8e-6,
            dynamic_viscosity=1.0, grid=(48, 9), end_pressure=2e5, cavitation_pressure=0.0,
        )  # fmt: skip
        assert _shear(film, 1e-3) == pytest.approx(1.0, rel=1e-2)


def test_an_eccentric_journal_without_a_cavity_shears_its_whole_film() -> None:
    """2 pi mu omega L R^3/(c sqrt(1 - e^2)) beside the moment of the film force."""
    film = JournalBearing(
        diameter=18e-3, length=19e-3, radial_clearance=8e-6,
        dynamic_viscosity=1.0, grid=(96, 9), end_pressure=1e8, cavitation_pressure=0.0,
    )  # fmt: skip
    assert _shear(film, 0.5) == pytest.approx(1.0, rel=2e-3)


def test_a_ring_turned_the_other_way_is_its_mirror_image() -> None:
    film = LateralFilm(
        inner_radius=0.01, outer_radius=0.02, side_gap=8e-6, fluid=FilmFluid(0.03),
        tilt=(3e-4, 0.0), grid=(32, 8), inner_pressure=2e5, outer_pressure=9e5,
    )  # fmt: skip
    one, other = (film.solve(shaft_speed=speed) for speed in (120.0, -120.0))
    load, about_x, about_y = one.load
    assert other.load == pytest.approx([load, about_x, -about_y], rel=1e-6)
    assert other.friction_torque == pytest.approx(-one.friction_torque, rel=1e-6)
    assert other.power_loss == pytest.approx(one.power_loss, rel=1e-6)
