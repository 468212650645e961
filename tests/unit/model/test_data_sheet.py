"""Fluids from data sheets: viscosity index, what families add, refused sheets, the library."""

from __future__ import annotations

import math
from itertools import pairwise
from pathlib import Path

import pytest

from toothspace.closures.data_sheet import (
    pressure_viscosity,
    viscosity_at_100,
    viscosity_index,
)
from toothspace.core.errors import CaseError
from toothspace.core.units import ZERO_CELSIUS
from toothspace.library import fluids, library_names
from toothspace.model.data_sheet import FAMILIES, read_data_sheet, share_of_density
from toothspace.model.fluid import liquid_at, properties_table, temperature_range

SHEET = """
title = "an oil"
density = "872 kg/m^3"
viscosity_40 = "45.6 mm^2/s"
viscosity_100 = "8.2 mm^2/s"
lowest_temperature = "-35 degC"
highest_temperature = "110 degC"
"""
THIN = '3 mm^2/s"'
WATER = {5: (1.5182, 999.97), 20: (1.0016, 998.21), 40: (0.6527, 992.22), 80: (0.3544, 971.79)}
"""IAPWS: dynamic viscosity [mPa s] and density [kg/m3] over the temperature [degC]."""


def written(folder: Path, text: str) -> Path:
    path = folder / "oil.toml"
    path.write_text(text, encoding="utf-8")
    return path


@pytest.mark.parametrize(
    ("at_40", "at_100", "index"), [(73.30, 8.86, 92.0), (22.83, 5.05, 156.0), (53.47, 7.80, 111.0)]
)
def test_viscosity_index_of_the_examples_of_the_standard(
    at_40: float, at_100: float, index: float
) -> None:
    assert viscosity_index(1e-6 * at_40, 1e-6 * at_100) == pytest.approx(index, abs=0.6)


@pytest.mark.parametrize("index", [20.0, 100.0, 180.0])
@pytest.mark.parametrize("at_40", [12.0, 46.0, 320.0])
def test_viscosity_at_100_gives_the_index_back(at_40: float, index: float) -> None:
    at_100 = viscosity_at_100(1e-6 * at_40, index)
    assert viscosity_index(1e-6 * at_40, at_100) == pytest.approx(index, abs=1e-6)


def test_oils_lose_a_tenth_of_their_viscosity_at_least() -> None:
    """From 40 to 100 degC; an index that asks for less has no viscosity."""
    known, unknown = (viscosity_index(20e-6, part * 20e-6) for part in (0.88, 0.92))
    assert viscosity_at_100(20e-6, known) == pytest.approx(0.88 * 20e-6)
    assert math.isnan(viscosity_at_100(20e-6, unknown))


def test_a_sheet_gives_back_what_it_holds(tmp_path: Path) -> None:
    path = written(tmp_path, SHEET)
    for celsius, viscosity in ((40.0, 45.6e-6), (100.0, 8.2e-6)):
        liquid = liquid_at(path, celsius + ZERO_CELSIUS)
        assert liquid.dynamic_viscosity / liquid.density == pytest.approx(viscosity, rel=1e-9)
    assert liquid_at(path, 15.0 + ZERO_CELSIUS).density == pytest.approx(872.0, rel=1e-9)
    assert temperature_range(path) == pytest.approx((-35.0 + ZERO_CELSIUS, 110.0 + ZERO_CELSIUS))
    rows = properties_table(path)
    assert [row["temperature_degC"] for row in rows][:3] == [-35.0, -20.0, 0.0]
    assert all(
        one["kinematic_viscosity_mm2_per_s"] > two["kinematic_viscosity_mm2_per_s"]
        for one, two in pairwise(rows)
    )


def test_families_differ_where_fluids_do(tmp_path: Path) -> None:
    oil = liquid_at(written(tmp_path, SHEET), 323.15)
    glycol = liquid_at(written(tmp_path, SHEET + 'family = "water_glycol"\n'), 323.15)
    assert glycol.bulk_modulus > 1.5 * oil.bulk_modulus
    assert glycol.pressure_viscosity < 0.3 * oil.pressure_viscosity
    stiff = liquid_at(written(tmp_path, SHEET + 'bulk_modulus = "2 GPa"\n'), 323.15)
    assert stiff.bulk_modulus == pytest.approx(2e9)


@pytest.mark.parametrize("family", FAMILIES)
def test_a_family_has_its_values_at_their_temperatures(family: str, tmp_path: Path) -> None:
    """Vapour at 50 degC, but a floor of 1000 Pa; heat capacity at 20 degC; density at 15 degC."""
    path, kind = written(tmp_path, f'{SHEET}family = "{family}"\n'), FAMILIES[family]
    warm = liquid_at(path, 50.0 + ZERO_CELSIUS)
    assert warm.vapour_pressure == pytest.approx(max(kind.vapour_pressure, 1000.0))
    assert warm.density == pytest.approx(872.0 - 35.0 * kind.expansion)
    assert warm.bulk_modulus == pytest.approx(kind.bulk_modulus)
    capacity = kind.heat_capacity + 30.0 * kind.heat_capacity_rise
    assert warm.specific_heat_capacity == pytest.approx(capacity)


def test_an_oil_grows_as_viscous_with_pressure_as_at_40_degrees(tmp_path: Path) -> None:
    """Barus coefficient of its dynamic viscosity at 40 degC, in which density has its share."""
    liquid = liquid_at(written(tmp_path, SHEET), 40.0 + ZERO_CELSIUS)
    dynamic = 45.6e-6 * (872.0 - 25.0 * FAMILIES["mineral_oil"].expansion)
    assert liquid.pressure_viscosity == pytest.approx(pressure_viscosity(dynamic), rel=1e-6)


@pytest.mark.parametrize("slope", [1.0, 5.0, 10.0])
def test_share_of_the_density_is_that_of_a_linear_bulk_modulus(slope: float) -> None:
    """Murnaghan: density grows with (1 + n p/K)^(1/n); mean up to 200 bar."""
    modulus, pressure = 1.6e9, 2e7
    mean = math.log1p(slope * pressure / modulus) / slope / pressure
    assert share_of_density(modulus, slope) == pytest.approx(mean, rel=3e-4)


@pytest.mark.parametrize(
    ("change", "said"),
    [
        (("viscosity_100 =", "viscosity_70 ="), "viscosity_70"),
        (('"872 kg/m^3"', "872"), "density: found 872 without a unit"),
        (('"8.2 mm^2/s"', '"60 mm^2/s"'), "less than at 40 degC"),
        (('viscosity_100 = "8.2 mm^2/s"', ""), "found neither, allowed one of viscosity_100"),
        (
            ('45.6 mm^2/s"\nviscosity_100 = "8.2 mm^2/s"', '3 mm^2/s"\nviscosity_index = 90'),
            "2 to 70 mm2",
        ),
        (('"-35 degC"', '"35 degC"'), "above lowest_temperature"),
        (("title = ", "title "), "a data sheet in TOML"),
    ],
)
def test_a_wrong_sheet_is_refused_in_words(
    tmp_path: Path, change: tuple[str, str], said: str
) -> None:
    text = SHEET.replace(*change).replace(
        '"110 degC"', '"20 degC"' if "35" in change[1] else '"110 degC"'
    )
    with pytest.raises(CaseError, match=said.replace("(", r"\(")):
        read_data_sheet(written(tmp_path, text))


def test_every_fluid_of_the_library_is_known_over_its_range() -> None:
    names = library_names("fluids")
    assert len(names) >= 25
    assert fluids().keys() == set(names)
    for name in names:
        for row in properties_table(name):
            assert 600.0 < row["density_kg_per_m3"] < 1200.0, name
            assert 0.2 < row["kinematic_viscosity_mm2_per_s"] < 3e5, name


@pytest.mark.parametrize("grade", [10, 15, 22, 32, 46, 68, 100, 150])
def test_grades_are_within_a_tenth_of_their_middle(grade: int) -> None:
    """ISO 3448: at 40 degC."""
    liquid = liquid_at(f"iso_vg_{grade}", 40.0 + ZERO_CELSIUS)
    assert 1e6 * liquid.dynamic_viscosity / liquid.density == pytest.approx(grade, rel=0.1)


@pytest.mark.parametrize("celsius", list(WATER))
def test_water_is_that_of_the_tables(celsius: int) -> None:
    liquid = liquid_at("pure_water", celsius + ZERO_CELSIUS)
    viscosity, density = WATER[celsius]
    assert 1e3 * liquid.dynamic_viscosity == pytest.approx(viscosity, rel=0.01)
    assert liquid.density == pytest.approx(density, rel=0.005)


@pytest.mark.parametrize(("viscosity", "coefficient"), [(1e-3, 6.0), (1e-2, 15.65), (0.1, 25.3)])
def test_pressure_viscosity_grows_with_each_decade_of_viscosity(
    viscosity: float, coefficient: float
) -> None:
    """0.6 and 0.965 a decade above 1 mPa s, by hand. [1/GPa]."""
    assert 1e9 * pressure_viscosity(viscosity) == pytest.approx(coefficient)
