"""``export`` on the command line: what other programs read is what the result holds."""

from __future__ import annotations

from pathlib import Path

import numpy as np
import pandas as pd
import pytest
import xarray as xr
from scipy.io import loadmat

from toothspace.cli import main
from toothspace.core.netcdf import write_dataset
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
    np.testing.assert_allclose(table["shaft_torque [N m]"], data["shaft_torque"], rtol=1e-12)
    assert main(["export", str(result), "-o", str(tmp_path / "run.mat")]) == 2


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
