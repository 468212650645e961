"""Fluids measured at several temperatures, what is extrapolated, and tables of CoolProp."""

from __future__ import annotations

import csv
import io
import json
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest

from toothspace.cli import main
from toothspace.core.errors import CaseError
from toothspace.core.units import ATMOSPHERIC_PRESSURE
from toothspace.library import library_names, load_fluid
from toothspace.model import coolprop
from toothspace.model.coolprop import coolprop_table
from toothspace.model.fluid import fit_table, known_range, liquid_at

SEVERAL = [
    name for name in library_names("fluids") if len(load_fluid(name).get("viscosity", ())) and
    len(load_fluid(name)["viscosity"].get("points_cSt", ())) > 2
]  # fmt: skip


@pytest.mark.parametrize("name", SEVERAL)
def test_viscosities_pass_through_every_measured_point(name: str) -> None:
    curve = load_fluid(name)["viscosity"]
    low, high = load_fluid(name)["temperature_range_degC"]
    for celsius, centistokes in zip(curve["points_degC"], curve["points_cSt"], strict=True):
        if low <= celsius <= high:
            liquid = liquid_at(name, celsius + 273.15)
            kinematic = 1e6 * liquid.dynamic_viscosity / liquid.density
            # the points are at one atmosphere, the constants at zero pressure
            assert kinematic == pytest.approx(centistokes, rel=4e-3)


@pytest.mark.parametrize(
    ("name", "coefficient"), [("spindle_oil", 16e-9), ("heavy_machine_oil", 20.5e-9)]
)
def test_machine_oils_have_their_measured_rise_with_pressure(name: str, coefficient: float) -> None:
    assert liquid_at(name, 333.15).pressure_viscosity == pytest.approx(coefficient, rel=2e-3)


def test_what_is_extrapolated_is_said(capsys: pytest.CaptureFixture[str]) -> None:
    assert "from 40 to 100 degC, extrapolated" in known_range("hvlp_46")["viscosity"]
    assert "to 1000 bar; extrapolated beyond" in known_range("iso_vg_46")["pressure"]
    assert "Melinder" in known_range("ethylene_glycol_50")["source_viscosity"]
    assert main(["fluids", "mil_prf_5606", "--json"]) == 0
    told = json.loads(capsys.readouterr().out)
    assert "from -54 to 100 degC" in told["known"]["viscosity"]
    assert "5606J" in told["known"]["source_viscosity"]


def test_n_dodecane_of_the_library_is_that_of_coolprop(tmp_path: Path) -> None:
    pytest.importorskip("CoolProp")
    path = tmp_path / "dodecane.csv"
    assert main(["fluids", "coolprop:n-Dodecane", "-o", str(path)]) == 0
    for celsius in (10.0, 50.0, 90.0):
        table, law = fit_table(path, celsius + 273.15), liquid_at("n_dodecane", celsius + 273.15)
        assert table.density == pytest.approx(law.density, rel=2e-3)
        assert table.dynamic_viscosity == pytest.approx(law.dynamic_viscosity, rel=0.03)
        # isothermal against isentropic
        assert 1.1 < law.bulk_modulus / table.bulk_modulus < 1.3


def test_water_of_coolprop(tmp_path: Path) -> None:
    pytest.importorskip("CoolProp")
    path = tmp_path / "water.csv"
    path.write_text(coolprop_table("Water"), encoding="utf-8")
    water = fit_table(path, 293.15)
    # IAPWS: 998.2 kg/m3, 1.0016 mPa s and 2.18 GPa at 20 degC
    assert water.density == pytest.approx(998.2, rel=1e-3)
    assert water.dynamic_viscosity == pytest.approx(1.0016e-3, rel=0.03)
    assert water.bulk_modulus == pytest.approx(2.18e9, rel=0.03)
    for name in ("nothing", "INCOMP::MEG[0.5]"):
        with pytest.raises(CaseError, match="a pure liquid of CoolProp"):
            coolprop_table(name)


def _made_up(wanted: str, *state: object) -> float:
    """Liquid between 11.8 and 80 degC that tells the pressure as density; vapour of T - 270 Pa."""
    if wanted == "Ttriple":
        return 273.15 + 11.8
    if wanted == "pmax":
        return 2.5e7
    asked = dict(zip(state[:-1:2], state[1:-1:2], strict=True))
    if wanted == "T":
        assert asked == {"P": ATMOSPHERIC_PRESSURE, "Q": 0}
        return 273.15 + 80.0
    kelvin = float(asked["T"])  # type: ignore[arg-type]
    if wanted == "P":
        return 100.0 * (kelvin - 270.0)
    return {"D": float(asked["P"]), "V": 1e-3 * kelvin, "C": 2.0 * kelvin}[wanted]  # type: ignore[arg-type]


def test_a_table_holds_the_liquid_from_freezing_to_10_kelvin_below_boiling(
    monkeypatch: pytest.MonkeyPatch,
) -> None:
    """Whole 5 K, up to the pressure that is known; at zero pressure the liquid about to boil."""
    package = SimpleNamespace(PropsSI=_made_up)
    monkeypatch.setattr(coolprop, "package_of_extra", lambda *_: package)
    rows = list(csv.reader(io.StringIO(coolprop_table("made up"))))
    values = np.array(rows[1:], dtype=float)
    assert np.unique(values[:, 0]) == pytest.approx(np.arange(15.0, 71.0, 5.0))
    assert values[:3, 1] == pytest.approx([0.0, 100.0, 200.0])
    kelvin = values[:, 0] + 273.15
    vapour = 100.0 * (kelvin - 270.0)
    pressed = values[:, 1] > 0.0
    assert values[pressed, 2] == pytest.approx(1e5 * values[pressed, 1])
    boiling = values[~pressed, 2] / vapour[~pressed]
    assert np.all((boiling > 1.0) & (boiling < 1.01))
    for column, wanted in ((3, 1e-3 * kelvin), (4, 2.0 * kelvin), (5, vapour)):
        assert values[:, column] == pytest.approx(wanted)


@pytest.mark.parametrize(("triple", "first"), [(9.6, 15.0), (9.47, 10.0), (-60.0, -40.0)])
def test_a_table_begins_half_a_kelvin_above_freezing(
    triple: float, first: float, monkeypatch: pytest.MonkeyPatch
) -> None:
    def liquid(wanted: str, *state: object) -> float:
        return 273.15 + triple if wanted == "Ttriple" else _made_up(wanted, *state)

    monkeypatch.setattr(coolprop, "package_of_extra", lambda *_: SimpleNamespace(PropsSI=liquid))
    assert coolprop_table("made up").splitlines()[1].startswith(f"{first:g},0,")


@pytest.mark.parametrize("words", [["coolprop:Water"], ["iso_vg_46", "-o", "x.csv"]])
def test_tables_are_written_of_coolprop_only(words: list[str]) -> None:
    assert main(["fluids", *words]) == 2
    assert not Path("x.csv").exists()


def test_rise_of_the_fluids_over_the_temperature_has_no_jump() -> None:
    """Between the pieces of a measured curve the viscosity is continuous."""
    for name in SEVERAL:
        points = load_fluid(name)["viscosity"]["points_degC"][1:-1]
        for kelvin in np.asarray(points) + 273.15:
            below, above = (liquid_at(name, kelvin + e).dynamic_viscosity for e in (-1e-7, 1e-7))
            assert below == pytest.approx(above, rel=1e-6)
