"""A pump against a line: its source, its line and its load against closed forms."""

from __future__ import annotations

from functools import cache
from pathlib import Path

import numpy as np
import pytest
from scipy.special import jv

from tests.conftest import REPOSITORY
from toothspace import api
from toothspace.closures.density import liquid_bulk_modulus, mixture_density
from toothspace.closures.viscosity import dynamic_viscosity
from toothspace.core.errors import CaseError
from toothspace.results.ripple import harmonics
from toothspace.results.solution import Solution
from toothspace.studies import run_study
from toothspace.studies.study import StudyResult

CASE = REPOSITORY / "cases" / "egm12_pump_line.toml"
PORT = 'machine.outlet.volume="50 cm^3"', 'machine.casing.outlet_angle="55 deg"'
"""A port volume that the closed forms know; spaces that grooves join to it would be more of it."""
PRESSURE, SPEED = 200e5, 2.0 * np.pi * 25.0


@cache
def pumped() -> Solution:
    return api.simulate(api.load_case(CASE, PORT).replace({"study": None}))


@cache
def held() -> Solution:
    """The pump with both port pressures held."""
    return api.simulate(api.load_case(REPOSITORY / "cases" / "egm12_pump.toml", PORT))


@cache
def source(*lengths: str) -> StudyResult:
    return run_study(api.load_case(CASE, PORT).replace({"study.line_length": [*lengths]}))


@pytest.mark.slow
def test_ripple_is_that_of_a_small_pump_and_all_balances_close() -> None:
    numbers = pumped().summary()
    assert numbers["status"] == "done"
    assert float(numbers["outlet_pressure_bar"]) == pytest.approx(200.0, rel=2e-3)
    assert 1.0 < float(numbers["pressure_ripple_bar"]) < 6.0
    assert float(numbers["mass_balance_error"]) < 1e-9
    assert float(numbers["energy_balance_error"]) < 1e-5


@pytest.mark.slow
def test_line_takes_nothing_from_the_machine() -> None:
    """Efficiencies are those at the port, whatever the line and the load dissipate."""
    for name in ("volumetric_efficiency", "overall_efficiency"):
        assert float(pumped().summary()[name]) == pytest.approx(
            float(held().summary()[name]), abs=2e-4
        )


@pytest.mark.slow
def test_pressure_over_flow_at_the_port_is_the_impedance_of_line_and_orifice() -> None:
    """Transmission line with frequency-dependent friction, ended by 2 dp / q: admittances."""
    case, data = api.load_case(CASE, PORT), pumped().data
    assert case.operating_point is not None
    line, fluid = case.operating_point.line, api.fluid_of(case)
    assert line is not None
    orders = np.array([12.0, 24.0, 36.0])
    angle = np.asarray(data["shaft_angle"])
    found = harmonics(angle, np.asarray(data["outlet_pressure"]), orders)
    found /= harmonics(angle, np.asarray(data["line_flow_rate"]), orders)
    density = float(mixture_density(PRESSURE, fluid.feed_gas_mass_fraction, fluid))
    viscosity = float(dynamic_viscosity(PRESSURE, fluid)) / density
    area, s = 0.25 * np.pi * line.bore**2, 1j * orders * SPEED
    stiffness = 1.0 / float(liquid_bulk_modulus(PRESSURE, fluid)) + line.wall_flexibility(fluid)
    root = 0.5j * line.bore * np.sqrt(s / viscosity)
    series = density / area * s / (1.0 - 2.0 * jv(1, root) / (root * jv(0, root)))
    wave = np.sqrt(series * area * stiffness * s) * line.length
    own = np.sqrt(series / (area * stiffness * s))
    flow = float(np.mean(data["line_flow_rate"]))
    half = 0.5 * area * stiffness * line.length / line.cells * s
    end = 2.0 * (PRESSURE - 1e5) / flow
    total = own * (end + own * np.tanh(wave)) / (own + end * np.tanh(wave))
    expected = 1.0 / (1.0 / total - half)
    # cells shift the resonances a little, so admittances are held over that of the endless line
    assert np.max(np.abs(own * (1.0 / found - 1.0 / expected))) < 0.02


@pytest.mark.slow
def test_source_impedance_is_that_of_the_outlet_volume() -> None:
    """1 / (j w V/K) with half a cell of the line; the misfit of three loads stays small."""
    data = source("0.8 m", "1.1 m", "1.5 m").data
    case = api.load_case(CASE, PORT)
    assert case.operating_point is not None
    line, fluid = case.operating_point.line, api.fluid_of(case)
    assert line is not None
    volume = 50e-6 + 0.125 * np.pi * line.bore**2 * line.length / line.cells
    stiffness = float(liquid_bulk_modulus(PRESSURE, fluid)) / volume
    expected = stiffness / (2.0 * np.pi * np.asarray(data["frequency"]))
    assert np.asarray(data["source_impedance"])[:5] == pytest.approx(expected[:5], rel=0.05)
    phase = np.degrees(np.asarray(data["source_impedance_phase"]))
    assert phase[:5] == pytest.approx(-90.0, abs=2.0)
    assert np.asarray(data["misfit"])[0] < 1e-3


@pytest.mark.slow
def test_source_flow_is_the_flow_out_of_the_chambers() -> None:
    """At constant pressure the machine drives its source flow, port volume and all."""
    data = held().data
    orders = np.array([12.0, 24.0, 36.0])
    flow = harmonics(np.asarray(data["shaft_angle"]), np.asarray(data["outlet_flow_rate"]), orders)
    found = np.asarray(source("0.4 m", "0.8 m").data["source_flow"])[:3]
    # spaces that fill past their tips answer the pressure: 5 % of the third harmonic
    assert found == pytest.approx(np.abs(flow), rel=0.06)


@pytest.mark.parametrize(
    ("key", "value", "message"),
    [
        ("study.line_length", ["1 m"], "two or more"),
        ("operating_point.line.bore", "-1 mm", "operating_point.line.bore"),
    ],
)
def test_bad_input_is_one_message(key: str, value: object, message: str, tmp_path: Path) -> None:
    with pytest.raises(CaseError, match=message):
        api.load_case(CASE, PORT).replace({key: value})


def test_study_without_a_line_is_refused() -> None:
    case = api.load_case(REPOSITORY / "cases" / "egm12_pump.toml", PORT)
    study = {"kind": "source_ripple", "line_length": ["1 m", "2 m"]}
    with pytest.raises(CaseError, match=r"operating_point\.line"):
        run_study(case.replace({"study": study}))


def test_result_of_a_case_on_a_base_is_saved(tmp_path: Path) -> None:
    assert pumped().save(tmp_path / "line.nc").exists()
