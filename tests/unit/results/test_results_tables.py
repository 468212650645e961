from __future__ import annotations

from pathlib import Path

import numpy as np
import pytest
import xarray as xr

from tests.fake_solution import fake_description
from toothspace.results.file_layout import save_tables, save_tables_txt


def test_netcdf_holds_volumes_with_slopes_and_units(tmp_path: Path) -> None:
    description = fake_description()
    with xr.open_dataset(save_tables(description, tmp_path / "tables.nc"), engine="h5netcdf") as d:
        family = description.families[0]
        np.testing.assert_array_equal(d["drive_gear_volume"], family.volume.values[:, 0])
        np.testing.assert_array_equal(d["drive_gear_volume_slope"], family.volume.slopes[:, 0])
        np.testing.assert_array_equal(d["drive_gear_phase"], family.phases)
        assert d["drive_gear_volume"].attrs["units"] == "m3"
        assert d["inlet_port_drive_gear_area"].attrs["units"] == "m2"
        assert d["casing_outline"].shape == description.outlines["casing"].shape
        assert d.attrs["contact_ratio"] == pytest.approx(1.31)


def test_one_text_file_per_table_with_units_in_the_header(tmp_path: Path) -> None:
    description = fake_description()
    files = save_tables_txt(description, tmp_path / "txt")
    expected = len(description.families) + len(description.paths) + len(description.outlines)
    assert len(files) == expected
    path = tmp_path / "txt" / "driven_gear.txt"
    header = [line for line in path.read_text().splitlines() if line.startswith("#")]
    assert "angle [rad]  volume [m3]  volume_slope [m3/rad]" in header[-1]
    values = np.loadtxt(path)
    np.testing.assert_allclose(values[:, 1], description.families[1].volume.values[:, 0], rtol=1e-8)
    step = values[1, 0] - values[0, 0]
    assert step * len(values) == pytest.approx(2.0 * np.pi, rel=1e-8)


def test_description_gives_the_same_dataset(tmp_path: Path) -> None:
    description = fake_description()
    saved = save_tables(description, tmp_path / "tables.nc")
    with xr.open_dataset(saved, engine="h5netcdf") as read:
        assert set(read.data_vars) == set(description.to_dataset().data_vars)
