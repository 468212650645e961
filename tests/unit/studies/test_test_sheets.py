"""Test sheets with the symbols of ISO 4409, as CSV and as workbook."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest

from tests.study_cases import case_with_study
from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.studies import run_study
from toothspace.studies.measured import at_ports, read_measured

MAP = """
kind = "efficiency_map"
shaft_speed = ["500 rpm", "1000 rpm"]
pressure_difference = ["50 bar", "100 bar", "150 bar"]
"""
SHEET = {
    "speed n (1/min)": [500, 1000],
    "inlet p_1 (bar)": [101.0, 51.0],
    "p_2 (bar)": [1.0, 1.0],
    "theta (°C)": [50.0, 52.0],
    "q_v [l/min]": [2.5, 5.0],
    "torque T (Nm)": [9.5, 5.5],
    "eta_t (%)": [81.0, 83.0],
}


def test_the_table_of_a_map_is_read_as_a_measured_one(calls: list[Case], tmp_path: Path) -> None:
    """What the study writes for ISO 4409 comes back as measured points, row by row."""
    first = run_study(case_with_study(MAP))
    path = tmp_path / "iso_4409.csv"
    path.write_text(first.tables[0].to_csv())
    again = run_study(case_with_study(MAP + f'measured = "{path}"\n')).data
    np.testing.assert_allclose(again["measured_shaft_speed"], np.repeat(again["shaft_speed"], 3))
    np.testing.assert_allclose(
        again["measured_pressure_difference"], np.tile(again["pressure_difference"], 2), rtol=1e-5
    )
    for name in ("mean_flow_L_per_min", "mean_torque_N_m", "volumetric_efficiency"):
        expected = first.data[name].values.ravel()
        np.testing.assert_allclose(again[f"measured_{name}"], expected, rtol=1e-5)


@pytest.mark.parametrize("ending", ["csv", "xlsx"])
def test_symbols_are_keys_and_numbers(tmp_path: Path, ending: str) -> None:
    path = tmp_path / f"sheet.{ending}"
    if ending == "csv":
        pd.DataFrame(SHEET).to_csv(path, index=False)
    else:
        pytest.importorskip("openpyxl")
        pd.DataFrame(SHEET).to_excel(path, index=False)
    found = read_measured(path)
    assert found.times is None
    assert found.settings[0] == {
        "operating_point.shaft_speed": "500 rpm",
        "operating_point.inlet_pressure": "101 bar",
        "operating_point.outlet_pressure": "1 bar",
        "fluid.temperature": "50 degC",
    }
    np.testing.assert_allclose(found.channels["mean_flow_L_per_min"], [2.5, 5.0])
    np.testing.assert_allclose(found.channels["mean_torque_N_m"], [9.5, 5.5])
    np.testing.assert_allclose(found.channels["overall_efficiency"], [0.81, 0.83])


def test_a_pressure_difference_is_above_the_low_port() -> None:
    motor, pump = case_with_study(MAP), case_with_study(MAP, "egm12_pump")
    row = {"pressure_difference": "100 bar"}
    assert at_ports(motor, row) == {"operating_point.inlet_pressure": "101 bar"}
    low = {**row, "operating_point.inlet_pressure": "3 bar"}
    assert at_ports(pump, low)["operating_point.outlet_pressure"] == "103 bar"


def test_failed_rows_are_left_out_and_unknown_columns_named(tmp_path: Path) -> None:
    path = tmp_path / "sheet.csv"
    path.write_text("n (rpm),p_2 (bar),T (N m),status\n500,10,1.5,done\n500,20,,failed\n")
    assert read_measured(path).channels["mean_torque_N_m"].tolist() == [1.5]
    path.write_text("n (rpm),oil colour (1),T (N m)\n500,10,1.5\n")
    with pytest.raises(CaseError, match=r"columns: found 'oil colour \(1\)', allowed 'name \[unit"):
        read_measured(path)
    path = tmp_path / "sheet.xlsx"
    path.write_bytes(b"PK no workbook")
    pytest.importorskip("openpyxl")
    with pytest.raises(CaseError, match=r"sheet.xlsx: found a file that cannot be read as one"):
        read_measured(path)


def test_signals_over_time_may_stand_in_a_workbook(tmp_path: Path) -> None:
    pytest.importorskip("openpyxl")
    path = tmp_path / "signals.xlsx"
    table = {"time [s]": [0.0, 0.1, 0.2], "shaft_speed [rpm]": [0.0, 600.0, 1200.0]}
    pd.DataFrame(table).to_excel(path, index=False)
    found = read_measured(path)
    assert found.times is not None
    np.testing.assert_allclose(found.times, [0.0, 0.1, 0.2])
    np.testing.assert_allclose(found.channels["shaft_speed"], np.array([0, 20, 40]) * np.pi)
