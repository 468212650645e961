"""Choice of a fluid, its air and its range; user tables and their errors."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest

from toothspace.closures.density import liquid_specific_volume
from toothspace.closures.viscosity import dynamic_viscosity
from toothspace.core.errors import CaseError
from toothspace.core.units import ZERO_CELSIUS
from toothspace.library import library_names, load_fluid, load_material
from toothspace.model.fluid import GasModel, fit_table, fluid_law, liquid_at, temperature_range

HEADER = "temperature [degC],pressure [bar],density [kg/m3],dynamic_viscosity [mPa s]"


def test_the_library_holds_the_promised_fluids() -> None:
    assert {"iso_vg_32", "iso_vg_46", "iso_vg_68", "jet_a1"} <= set(library_names("fluids"))


@pytest.mark.parametrize("name", library_names("fluids"))
def test_every_value_of_a_fluid_has_its_source(name: str) -> None:
    entry = load_fluid(name)
    # a data sheet has one source for all its figures
    tables = [value for value in entry.values() if isinstance(value, dict)]
    sections = [entry] if "viscosity_40" in entry else tables
    assert sections
    assert all(len(section["source"]) > 10 for section in sections)


@pytest.mark.parametrize("name", library_names("materials"))
def test_every_material_is_complete_and_has_its_source(name: str) -> None:
    material = load_material(name)
    assert 1e9 < material["elastic_modulus"] < 1e12
    assert 0.0 < material["poisson_ratio"] < 0.5
    assert 1e8 < material["hardness"] < 2e10
    assert material["source"]


@pytest.mark.parametrize("name", library_names("fluids"))
def test_constants_are_sane_over_the_whole_range(name: str) -> None:
    low, high = (end - ZERO_CELSIUS for end in temperature_range(name))
    laws = [fluid_law(name, t + 273.15) for t in np.linspace(low, high, 9)]
    viscosity = [law.dynamic_viscosity for law in laws]
    assert np.all(np.diff(viscosity) < 0.0)
    assert np.all(np.diff([law.reference_density for law in laws]) < 0.0)
    assert all(0.4e9 < 1.0 / law.compliance < 4e9 for law in laws)
    assert all(law.stiffening > 0.0 for law in laws)


def test_unknown_fluid_lists_the_allowed_names() -> None:
    with pytest.raises(CaseError, match=r"fluid\.name: found 'water', allowed .*iso_vg_32, iso"):
        fluid_law("water", 323.15)


def test_temperature_outside_the_range() -> None:
    with pytest.raises(CaseError, match=r"fluid\.temperature: found 150 degC, allowed -40 to 120"):
        fluid_law("jet_a1", 423.15)


def test_unknown_gas_law() -> None:
    with pytest.raises(CaseError, match=r"gas_law: found 'henry', allowed dynamic, eq"):
        fluid_law("jet_a1", 323.15, GasModel(law="henry"))


def test_saturation_below_the_vapour_pressure() -> None:
    with pytest.raises(CaseError, match=r"fluid\.saturation_pressure"):
        fluid_law("jet_a1", 373.15, GasModel(saturation_pressure=14e3))


def test_default_air_is_that_of_the_fluid() -> None:
    fuel, oil = fluid_law("jet_a1", 323.15), fluid_law("iso_vg_46", 323.15)
    ratio = fuel.dissolved_mass_fraction / oil.dissolved_mass_fraction
    densities = oil.reference_density / fuel.reference_density
    assert ratio == pytest.approx(0.14 / 0.08 * densities, rel=1e-3)


def rows_of(name: str, temperatures: list[float], pressures: list[float]) -> list[str]:
    rows = [HEADER]
    for celsius in temperatures:
        law = fluid_law(name, celsius + 273.15)
        for bar in pressures:
            density = 1.0 / liquid_specific_volume(1e5 * bar, law)
            viscosity = 1e3 * dynamic_viscosity(1e5 * bar, law)
            rows.append(f"{celsius},{bar},{density:.6f},{viscosity:.8f}")
    return rows


def written(folder: Path, rows: list[str]) -> Path:
    path = folder / "oil.csv"
    path.write_text("\n".join(rows), encoding="utf-8")
    return path


@pytest.fixture
def rows() -> list[str]:
    return rows_of("iso_vg_46", [40.0, 50.0, 60.0], [0.0, 50.0, 100.0, 200.0, 300.0])


def test_a_table_reproduces_the_fluid_it_was_made_of(tmp_path: Path, rows: list[str]) -> None:
    law = fluid_law(written(tmp_path, rows), 323.15)
    expected = fluid_law("iso_vg_46", 323.15)
    pressure = np.array([1e5, 100e5, 300e5])
    assert liquid_specific_volume(pressure, law) == pytest.approx(
        liquid_specific_volume(pressure, expected), rel=1e-6
    )
    assert dynamic_viscosity(pressure, law) == pytest.approx(
        dynamic_viscosity(pressure, expected), rel=1e-5
    )
    assert law.compliance == pytest.approx(expected.compliance, rel=1e-3)


def test_semicolons_separate_and_decimal_commas_are_refused(
    tmp_path: Path, rows: list[str]
) -> None:
    law = fluid_law(written(tmp_path, rows), 323.15)
    semicolons = [row.replace(",", ";") for row in rows]
    assert fluid_law(written(tmp_path, semicolons), 323.15) == law
    commas = [semicolons[0], *(row.replace(".", ",") for row in semicolons[1:])]
    with pytest.raises(CaseError, match="found '40,0', allowed a number with a decimal point"):
        fluid_law(written(tmp_path, commas), 323.15)


def test_a_table_is_interpolated_over_temperature(tmp_path: Path, rows: list[str]) -> None:
    fit = fit_table(written(tmp_path, rows), 318.15)
    expected = fluid_law("iso_vg_46", 318.15)
    assert fit.density == pytest.approx(expected.reference_density, rel=1e-6)
    assert fit.dynamic_viscosity == pytest.approx(expected.dynamic_viscosity, rel=0.02)


def test_the_error_of_the_fit_is_stated(tmp_path: Path, rows: list[str]) -> None:
    cells = rows[7].split(",")
    cells[3] = str(1.1 * float(cells[3]))
    rows[7] = ",".join(cells)
    fit = fit_table(written(tmp_path, rows), 323.15)
    assert 0.03 < fit.viscosity_error < 0.1
    assert fit.density_error < 1e-6


def test_vapour_pressure_and_heat_capacity_are_read(tmp_path: Path, rows: list[str]) -> None:
    extra = [",vapour_pressure [kPa],specific_heat_capacity [kJ/(kg K)]"] + [",5,2.1"] * 15
    table = [row + more for row, more in zip(rows, extra, strict=True)]
    law = fluid_law(written(tmp_path, table), 323.15)
    assert law.vapour_pressure == pytest.approx(5e3)
    assert law.specific_heat_capacity == pytest.approx(2100.0)


def replaced(rows: list[str], row: int, column: int, text: str) -> list[str]:
    cells = rows[row].split(",")
    cells[column] = text
    return [*rows[:row], ",".join(cells), *rows[row + 1 :]]


@pytest.mark.parametrize(
    ("row", "column", "text", "message"),
    [
        (3, 2, "nan", r"oil\.csv, column density, row 4: found nan, allowed a finite"),
        (3, 2, "heavy", r"column density, row 4: found 'heavy', allowed a number"),
        (3, 3, "-1", r"column dynamic_viscosity, row 4: found -1, allowed a positive"),
        (3, 3, "0", r"column dynamic_viscosity, row 4: found 0, allowed a positive"),
        (4, 2, "840", r"column density, row 5: .*density rising with pressure"),
        (4, 1, "50", r"column pressure, row 5: .*each pressure once"),
        (3, 0, "41", r"column pressure, row 4: found 1 pressures at 41 degC, allowed three"),
        (0, 2, "density", r"column 3, row 1: found 'density', allowed a name with its"),
        (0, 2, "density [bar]", r"column density, row 1: found 'bar', allowed a unit such as"),
        (0, 2, "mass [kg]", r"column mass, row 1: found 'mass', allowed each once"),
        (0, 2, "pressure [bar]", r"column pressure, row 1: found 'pressure'"),
    ],
)
def test_bad_tables_are_refused(
    tmp_path: Path, rows: list[str], row: int, column: int, text: str, message: str
) -> None:
    with pytest.raises(CaseError, match=message):
        fluid_law(written(tmp_path, replaced(rows, row, column, text)), 323.15)


def test_missing_column_short_row_and_empty_table(tmp_path: Path, rows: list[str]) -> None:
    without = [row.rsplit(",", 1)[0] for row in rows]
    with pytest.raises(CaseError, match="column dynamic_viscosity, row 1: found none"):
        fluid_law(written(tmp_path, without), 323.15)
    short = [*rows[:5], rows[5].rsplit(",", 1)[0], *rows[6:]]
    with pytest.raises(CaseError, match="row 6: found 3 entries, allowed 4 entries"):
        fluid_law(written(tmp_path, short), 323.15)
    with pytest.raises(CaseError, match="found 1 rows, allowed a header and rows"):
        fluid_law(written(tmp_path, rows[:1]), 323.15)


def test_table_missing_or_not_text(tmp_path: Path) -> None:
    with pytest.raises(CaseError, match=r"fluid\.table: found .*unreadable"):
        fluid_law(tmp_path / "none.csv", 323.15)
    binary = tmp_path / "binary.csv"
    binary.write_bytes(b"\xff\xfe\x00\x80")
    with pytest.raises(CaseError, match="unreadable"):
        fluid_law(binary, 323.15)


def test_temperature_outside_the_table(tmp_path: Path, rows: list[str]) -> None:
    with pytest.raises(CaseError, match=r"found 70 degC, allowed 40 to 60 degC.*oil\.csv"):
        fluid_law(written(tmp_path, rows), 343.15)


def test_a_fluid_is_known_just_where_it_says(tmp_path: Path, rows: list[str]) -> None:
    """Rounding of a kelvin apart, which a sum of temperatures leaves."""
    for source in (written(tmp_path, rows), "iso_vg_46"):
        low, high = temperature_range(source)
        for inside, outside in ((low - 1e-9, low - 1e-3), (high + 1e-9, high + 1e-3)):
            assert liquid_at(source, inside).density > 800.0
            with pytest.raises(CaseError, match=r"fluid\.temperature: found"):
                liquid_at(source, outside)
