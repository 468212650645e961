"""``export`` on the command line: what other programs read is what the result holds."""

from __future__ import annotations

import re
import sys
from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.io import loadmat

from toothspace.cli import main
from toothspace.core.errors import CaseError
from toothspace.core.netcdf import write_dataset
from toothspace.core.types import Array
from toothspace.results import exchange
from toothspace.results.solution import load_solution


def test_a_run_is_read_back_from_mat_and_csv(tmp_path: Path) -> None:
    result = tmp_path / "run.nc"
    quick = ["--set", "run.samples_per_revolution=90", "--fidelity", "ideal"]
    assert main(["run", "egm12_pump", "-o", str(result), *quick]) == 0
    assert main(["export", str(result), "-o", str(tmp_path / "run.mat")]) == 0
    assert main(["export", str(result), "-o", str(tmp_path / "run.csv")]) == 0
    data = load_solution(result).data
    found = loadmat(tmp_path / "run.mat", simplify_cells=True)
    np.testing.assert_array_equal(found["shaft_torque"], data["shaft_torque"])
    assert found["units"]["shaft_torque"] == "N m"
    assert found["dimensions"]["shaft_torque"] == "shaft_angle"
    assert list(found["chamber"]) == list(data["chamber"].values)
    table = pd.read_csv(tmp_path / "run.csv")
    assert table.columns[0] == "shaft_angle [rad]"
    np.testing.assert_allclose(table["shaft_torque [N m]"], data["shaft_torque"], rtol=1e-12)
    assert main(["export", str(result), "-o", str(tmp_path / "run.mat")]) == 2


SPEED, PRESSURE = [50.0, 100.0, 150.0], [10e5, 20e5]
FLOW = np.array([[1.0, 0.9], [2.0, 1.9], [3.0, 2.85]])
TORQUE = np.array([[1.1, 2.1], [1.2, 2.25], [1.3, 2.5]])
AXES = ("shaft_speed", "pressure_difference")


def saved_map(folder: Path, flow: Array = FLOW, mode: str = "pump") -> str:
    """A map of two coefficients more, as a study keeps it."""
    data = xr.Dataset(
        {
            "displacement_cm3_per_rev": (AXES, np.full(FLOW.shape, 2.0)),
            "mean_flow_L_per_min": (AXES, flow, {"units": "L/min"}),
            "mean_torque_N_m": (AXES, TORQUE, {"units": "N m"}),
            "loss_coefficient_value": ("loss_coefficient", [1.0, 2.0]),
        },
        coords={
            AXES[0]: (AXES[0], SPEED, {"units": "rad/s"}),
            AXES[1]: (AXES[1], PRESSURE, {"units": "Pa"}),
            "loss_coefficient": ["wilson flow slip", "wilson torque constant"],
        },
        attrs={"study": "efficiency_map", "mode": mode, "title": 'Pump "A"'},
    )
    write_dataset(data, folder / "study.nc")
    return str(folder / "study.nc")


@pytest.mark.parametrize("mode", ["pump", "motor"])
def test_simscape_gets_losses_over_pressure_and_speed(tmp_path: Path, mode: str) -> None:
    """With displacement and losses the block gives flow and torque of the map again."""
    assert main(["export", saved_map(tmp_path, mode=mode), "-o", str(tmp_path / "m.mat")]) == 0
    found = loadmat(tmp_path / "m.mat", simplify_cells=True)["simscape"]
    volume, sign = found["displacement"], 1.0 if mode == "pump" else -1.0
    assert volume == pytest.approx(2e-6 / (2.0 * np.pi))
    flow = volume * found["w"] - sign * found["q_loss"]
    torque = (volume * found["dp"])[:, None] + sign * found["torque_loss"]
    np.testing.assert_allclose(6e4 * flow, FLOW.T, rtol=1e-12)
    np.testing.assert_allclose(torque, TORQUE.T, rtol=1e-12)


def test_amesim_tables_are_read_back(tmp_path: Path) -> None:
    """Sizes, breakpoints of both axes, then values with the first axis along each line."""
    assert main(["export", saved_map(tmp_path), "-o", str(tmp_path / "pump.data")]) == 0
    for what, expected, unit in (("flow", FLOW, "L/min"), ("torque", TORQUE, "Nm")):
        lines = (tmp_path / f"pump_{what}.data").read_text().splitlines()
        head = [line for line in lines if line.startswith("#")]
        assert head[0] == "# Table format: 2D"
        assert f"# table_unit = {unit}" in head
        numbers = np.array(" ".join(lines[len(head) :]).split(), dtype=float)
        assert numbers[:2].tolist() == [2.0, 3.0]
        np.testing.assert_allclose(numbers[2:4], [10.0, 20.0])
        np.testing.assert_allclose(numbers[4:7], np.array(SPEED) * 30.0 / np.pi, rtol=1e-9)
        np.testing.assert_allclose(numbers[7:].reshape(3, 2), expected, rtol=1e-9)


def test_the_modelica_record_is_read_back(tmp_path: Path) -> None:
    path = tmp_path / "PumpMap.mo"
    assert main(["export", saved_map(tmp_path), "-o", str(path)]) == 0
    text = path.read_text()
    number, said = r"-?\d+(?:\.\d+)?(?:e[+-]?\d+)?", r'"[^"\n]*"'
    row = rf"{number}(?:, {number})*"
    matrix = rf"  constant Real (\w+)\[4, 3\] = \[\n    ({row}(?:;\n    {row})*)\]\n    {said};\n"
    record = re.compile(
        rf"record PumpMap {said}\n"
        rf'  constant Real displacement\(unit = "m3/rad"\) = ({number}) {said};\n'
        rf"{matrix}{matrix}end PumpMap;\n"
    )
    found = record.fullmatch(text)
    assert found is not None
    assert float(found[1]) == pytest.approx(2e-6 / (2.0 * np.pi))
    for name, values, expected in (
        (found[2], found[3], FLOW / 6e4),
        (found[4], found[5], TORQUE),
    ):
        table = np.array([line.split(", ") for line in values.split(";\n    ")], dtype=float)
        assert name in ("volume_flow", "shaft_torque")
        np.testing.assert_allclose(table[0], [0.0, *PRESSURE])
        np.testing.assert_allclose(table[1:, 0], SPEED)
        np.testing.assert_allclose(table[1:, 1:], expected, rtol=1e-9)


def test_a_parser_of_modelica_takes_the_record(tmp_path: Path) -> None:
    """Keywords, such as flow, stand where the grammar has them."""
    antlr = pytest.importorskip("antlr4")
    lexer = pytest.importorskip("modelica_builder.modelica_parser.modelicaLexer")
    parser = pytest.importorskip("modelica_builder.modelica_parser.modelicaParser")
    path = tmp_path / "PumpMap.mo"
    assert main(["export", saved_map(tmp_path), "-o", str(path)]) == 0
    tokens = antlr.CommonTokenStream(lexer.modelicaLexer(antlr.FileStream(str(path))))
    parsed = parser.modelicaParser(tokens)
    tree = parsed.stored_definition()
    assert parsed.getNumberOfSyntaxErrors() == 0
    assert tree.getText().startswith("recordPumpMap")


@pytest.mark.parametrize(
    ("name", "said"),
    [
        ("pump.data", "study: found a map with 1 failed points"),
        ("pump map.mo", "-o: found 'pump map.mo', allowed letters"),
        ("pump.mo", "study: found a map with 1 failed points"),
    ],
)
def test_what_no_table_can_hold_is_refused(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], name: str, said: str
) -> None:
    flow = FLOW.copy()
    flow[0, 0] = np.nan
    assert main(["export", saved_map(tmp_path, flow), "-o", str(tmp_path / name)]) == 2
    assert said in capsys.readouterr().err


def test_a_run_is_no_map(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    path = write_dataset(xr.Dataset(attrs={"study": "sweep"}), tmp_path / "study.nc")
    assert main(["export", str(path), "-o", str(tmp_path / "pump.mo")]) == 2
    assert "found no map of flow and torque" in capsys.readouterr().err


def test_a_workbook_has_points_coefficients_and_where_they_come_from(tmp_path: Path) -> None:
    pytest.importorskip("openpyxl")
    assert main(["export", saved_map(tmp_path), "-o", str(tmp_path / "map.xlsx")]) == 0
    found = pd.read_excel(tmp_path / "map.xlsx", sheet_name=None)
    assert list(found) == ["points", "loss coefficients", "about"]
    np.testing.assert_array_equal(found["points"]["mean_flow_L_per_min [L/min]"], FLOW.ravel())
    np.testing.assert_array_equal(found["points"]["shaft_speed [rad/s]"], np.repeat(SPEED, 2))
    assert found["loss coefficients"]["loss_coefficient_value"].tolist() == [1.0, 2.0]
    assert ["title", 'Pump "A"'] in found["about"].to_numpy().tolist()


def test_a_workbook_without_its_package_names_the_extra(
    tmp_path: Path, capsys: pytest.CaptureFixture[str], monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, "openpyxl", None)
    assert main(["export", saved_map(tmp_path), "-o", str(tmp_path / "map.xlsx")]) == 2
    assert 'pip install "toothspace[excel]"' in capsys.readouterr().err


def test_a_map_is_a_table_over_speed_and_pressure(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    speed, pressure = [50.0, 100.0, 150.0], [1e6, 2e6]
    flow = np.array([[1.0, 0.9], [2.0, 1.9], [3.0, np.nan]])
    axes = ("shaft_speed", "pressure_difference")
    study = xr.Dataset(
        {"mean_flow_L_per_min": (axes, flow, {"units": "L/min"}), "a.key": ("a", ["x", "yz"])},
        coords={axes[0]: (axes[0], speed, {"units": "rad/s"}), axes[1]: (axes[1], pressure)},
        attrs={"study": "efficiency_map"},
    )
    write_dataset(study, tmp_path / "study.nc")
    assert main(["export", str(tmp_path / "study.nc"), "-o", str(tmp_path / "map.mat")]) == 0
    found = loadmat(tmp_path / "map.mat", simplify_cells=True)
    np.testing.assert_array_equal(found["mean_flow_L_per_min"], flow)
    np.testing.assert_array_equal(found["shaft_speed"], speed)
    assert list(found["a_key"]) == ["x", "yz"]
    assert main(["export", str(tmp_path / "study.nc"), "-o", str(tmp_path / "map.csv")]) == 0
    table = pd.read_csv(tmp_path / "map.csv")
    assert list(table.columns[:2]) == ["shaft_speed [rad/s]", "pressure_difference [1]"]
    np.testing.assert_array_equal(table["mean_flow_L_per_min [L/min]"], flow.ravel())
    assert main(["export", str(tmp_path / "study.nc"), "-o", str(tmp_path / "map.xyz")]) == 2
    assert ".csv" in capsys.readouterr().err


def test_a_study_is_read_lazily_from_zarr(
    tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    pytest.importorskip("zarr")
    study, store = saved_map(tmp_path), tmp_path / "map.zarr"
    words = ["export", study, "-o", str(store)]
    assert main(words) == 0
    found = xr.open_zarr(store, chunks=None)
    assert not found["mean_flow_L_per_min"].variable._in_memory
    xr.testing.assert_identical(found.load(), xr.open_dataset(study).load())
    assert main(words) == 2
    assert main([*words, "--force"]) == 0
    assert [one.name for one in tmp_path.glob("*zarr*")] == ["map.zarr"]
    (tmp_path / "mine.zarr").mkdir()
    assert main(["export", study, "-o", str(tmp_path / "mine.zarr"), "--force"]) == 2
    assert "a folder that is no Zarr store" in capsys.readouterr().err


def test_zarr_needs_its_extra(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.setitem(sys.modules, "zarr", None)
    assert main(["export", saved_map(tmp_path), "-o", str(tmp_path / "map.zarr")]) == 2
    assert "toothspace[zarr]" in capsys.readouterr().err


def test_a_folder_that_is_no_zarr_store_is_kept(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Whether or not the extra is there."""
    monkeypatch.setattr(exchange, "package_of_extra", lambda *_: None)
    (tmp_path / "mine.zarr").mkdir()
    (tmp_path / "mine.zarr" / "kept").touch()
    with pytest.raises(CaseError, match="a folder that is no Zarr store"):
        exchange.write_zarr(xr.Dataset({"a": 1.0}), tmp_path / "mine.zarr")
    assert (tmp_path / "mine.zarr" / "kept").exists()
