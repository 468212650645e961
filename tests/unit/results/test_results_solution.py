from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import pytest
import xarray as xr

from tests.fake_solution import fake_solution
from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.results.solution import load_solution


def test_round_trip_is_identical(tmp_path: Path) -> None:
    solution = replace(fake_solution(), status=Status.NOT_CYCLIC)
    back = load_solution(solution.save(tmp_path / "result.nc"))
    xr.testing.assert_identical(back.data, solution.data)
    assert replace(back, data=solution.data) == solution
    assert back.summary() == solution.summary()


def test_round_trip_without_events(tmp_path: Path) -> None:
    solution = replace(fake_solution(), events=())
    assert load_solution(solution.save(tmp_path / "result.nc")).events == ()


def test_file_is_self_describing(tmp_path: Path) -> None:
    path = fake_solution().save(tmp_path / "result.nc")
    with xr.open_dataset(path, engine="h5netcdf") as raw:
        assert raw["chamber_pressure"].attrs["units"] == "Pa"
        assert raw.attrs["status"] == "DONE"
        assert raw.attrs["preset"] == "lumped"
        assert "[machine]" in raw.attrs["case_toml"]


def test_failed_write_leaves_the_old_file(tmp_path: Path) -> None:
    path = fake_solution().save(tmp_path / "result.nc")
    before = path.read_bytes()
    broken = replace(fake_solution(), provenance={"preset": object()})  # type: ignore[dict-item]
    with pytest.raises(TypeError):
        broken.save(path)
    assert path.read_bytes() == before
    assert list(tmp_path.iterdir()) == [path]


def test_file_without_a_result_is_refused(tmp_path: Path) -> None:
    xr.Dataset({"a": 1.0}).to_netcdf(tmp_path / "other.nc", engine="h5netcdf")
    with pytest.raises(CaseError, match="not a result"):
        load_solution(tmp_path / "other.nc")


def test_result_of_a_study_is_named_as_one(tmp_path: Path) -> None:
    study = xr.Dataset({"a": 1.0}, attrs={"study": "sweep", "status": "DONE"})
    study.to_netcdf(tmp_path / "study.nc", engine="h5netcdf")
    with pytest.raises(CaseError, match=r"result of a study \(sweep\), allowed that of a run; rep"):
        load_solution(tmp_path / "study.nc")


@pytest.mark.parametrize(
    ("name", "found"),
    [
        ("folder.nc", "a folder"),
        ("text.nc", "a file that cannot be read as one"),
        ("none.nc", "nothing"),
    ],
)
def test_what_is_no_result_is_refused_in_one_line(tmp_path: Path, name: str, found: str) -> None:
    (tmp_path / "folder.nc").mkdir()
    (tmp_path / "text.nc").write_text("pressure", encoding="utf-8")
    with pytest.raises(CaseError) as refused:
        load_solution(tmp_path / name)
    wanted = f"{tmp_path / name}: found {found}, allowed a NetCDF file of a run"
    assert str(refused.value) == wanted


def test_pressure_along_spaces_is_in_bar() -> None:
    told = replace(fake_solution(), statistics={"pressure_along_spaces": 3.5e5}).summary()
    assert told["pressure_along_spaces_bar"] == pytest.approx(3.5)


def test_a_table_of_samples_has_numbers_and_rows_of_numbers() -> None:
    """Places of bodies along two axes have no column."""
    solution = fake_solution(36)
    frame = solution.to_dataframe()
    assert len(frame) == 36
    assert "shaft_torque" in frame
    labels = [str(label) for label in solution.data["chamber"].values]
    assert {f"chamber_pressure[{label}]" for label in labels} <= set(frame)
    assert not [name for name in frame if str(name).startswith("body_position")]
    assert "running_in_depth" not in frame
    assert frame.attrs["units"][f"chamber_pressure[{labels[0]}]"] == "Pa"
