"""Series for ParaView: what VTK reads is the machine and the numbers of the run."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
import shapely
import xarray as xr

import toothspace as ts
from toothspace.cli import main
from toothspace.core.types import Array
from toothspace.plotting.section import fluid_cells, turned_section
from toothspace.plotting.space_series import write_space_series
from toothspace.results.solution import Solution, load_solution

STATES = 5
FIELDS = ("film_height", "film_pressure", "film_contact_pressure", "film_deformation")


@pytest.fixture(scope="module")
def solution(tmp_path_factory: pytest.TempPathFactory) -> Solution:
    folder = tmp_path_factory.mktemp("series")
    case = ts.load_case("egm12_pump")
    found = ts.simulate(case, **{"run.fidelity": "ideal", "run.samples_per_revolution": 96})
    found.save(folder / "run.nc")
    return load_solution(folder / "run.nc")


def with_films(solution: Solution) -> Solution:
    """The run with made-up films on both faces, a part of each without a gap."""
    names = [f"{side}_{body}" for side in ("floating", "solid") for body in ("drive_gear",)]
    shape = (len(names), 36, 4)
    values = np.arange(np.prod(shape), dtype=float).reshape(shape)
    values[:, :3, 0] = np.nan
    place = ("film", "film_row", "film_column")
    more: dict[str, Any] = {
        name: (place, scale * values)
        for name, scale in zip(FIELDS, (1e-8, 1e4, 1e3, 1e-9), strict=True)
    }
    more["film_angle"] = ("film_row", (np.arange(36) + 0.5) * np.pi / 18)
    more["film_radius"] = (("film", "film_column"), np.tile([11e-3, 13e-3, 15e-3, 17e-3], (2, 1)))
    more["film_center_x"] = more["film_center_y"] = ("film", np.zeros(2))
    data = solution.data.assign(more).assign_coords(film=names)
    return Solution(solution.status, data, solution.ledger, provenance=solution.provenance)


def volumes(points: Array, cells: Array) -> Array:
    """Volumes of wedges whose two triangles are parallel."""
    corner = points[cells]
    side = np.cross(corner[:, 1] - corner[:, 0], corner[:, 2] - corner[:, 0])
    return 0.5 * np.einsum("ij,ij->i", side, corner[:, 3] - corner[:, 0])


def test_each_state_has_volumes_and_pressures_of_the_run(
    solution: Solution, tmp_path: Path
) -> None:
    path = write_space_series(solution, tmp_path / "run.vtkhdf", STATES)
    description, width = solution.description, 7.63e-3
    assert description is not None
    with h5py.File(path) as file:
        root = file["VTKHDF"]
        assert root.attrs["Type"] == b"PartitionedDataSetCollection"
        chambers = root["chambers"]
        steps = chambers["Steps"]
        assert steps.attrs["NSteps"] == STATES
        for k in (0, 3):
            sample = 24 * k
            assert steps["Values"][k] == solution.data["time"].values[sample]
            first, count = steps["CellOffsets"][k, 0], chambers["NumberOfCells"][k]
            begin = steps["PointOffsets"][k]
            points = chambers["Points"][begin : begin + chambers["NumberOfPoints"][k]]
            owner = chambers["CellData/chamber"][first : first + count]
            cells = chambers["Connectivity"][6 * first : 6 * (first + count)].reshape(-1, 6)
            shapes = fluid_cells(description, float(solution.data["shaft_angle"][sample]))
            expected = width * shapely.area(shapes)
            found = np.bincount(owner, volumes(points.astype(float), cells))
            # outlines are drawn to 4 um
            np.testing.assert_allclose(found, expected, rtol=5e-4, atol=1e-10)
            pressure = chambers["CellData/pressure"][first : first + count]
            given = solution.data["chamber_pressure"].values[sample, owner]
            np.testing.assert_allclose(pressure, given, rtol=1e-7)
        gear = root["driven_gear"]
        assert len(gear["NumberOfCells"]) == 1  # the solid only turns
        size = gear["NumberOfPoints"][0]
        cells = gear["Connectivity"][:].reshape(-1, 6)
        for k in range(STATES):
            points = gear["Points"][k * size : (k + 1) * size].astype(float)
            solid = volumes(points, cells)
            assert (solid > 0.0).all()
            section = turned_section(
                description,
                description.bodies[1],
                float(solution.data["shaft_angle"][24 * k]),
            )
            assert solid.sum() == pytest.approx(width * section.area, rel=1e-3)
            np.testing.assert_allclose(points[:, :2].min(axis=0), section.bounds[:2], atol=5e-6)


@pytest.mark.slow
def test_helical_teeth_wind_about_their_axes(tmp_path: Path) -> None:
    """Between the ends a right-handed gear turns by the twist, and its volume stays."""
    case = ts.load_case("helical_pump")
    run = ts.simulate(case, **{"run.fidelity": "ideal", "run.samples_per_revolution": 36})
    path, description = write_space_series(run, tmp_path / "run.vtkhdf", 1), run.description
    assert description is not None
    assert description.winding is not None
    with h5py.File(path) as file:
        gear = file["VTKHDF/drive_gear"]
        points = gear["Points"][:].astype(float)
        low, high = points[points[:, 2] == 0.0], points[points[:, 2] == points[:, 2].max()]
        turn = np.angle((high @ [1.0, 1j, 0.0]) / (low @ [1.0, 1j, 0.0]))
        sign = np.sign(description.winding.turn_per_length)
        np.testing.assert_allclose(turn, sign * description.winding.twist, atol=1e-6)


@pytest.mark.slow
def test_every_slice_of_a_space_is_drawn_where_it_stands(tmp_path: Path) -> None:
    case = ts.load_case("helical_pump").replace({"machine.gears.axial_slices": 3})
    run = ts.simulate(case, **{"run.fidelity": "ideal", "run.samples_per_revolution": 36})
    path, description = write_space_series(run, tmp_path / "run.vtkhdf", 1), run.description
    assert description is not None
    with h5py.File(path) as file:
        chambers = file["VTKHDF/chambers/CellData/chamber"][:]
    np.testing.assert_array_equal(np.unique(chambers), np.arange(description.chamber_count))


def test_a_study_is_refused(tmp_path: Path, capsys: pytest.CaptureFixture[str]) -> None:
    from toothspace.core.netcdf import write_dataset

    path = write_dataset(xr.Dataset(attrs={"study": "sweep"}), tmp_path / "study.nc")
    assert main(["export", str(path), "-o", str(tmp_path / "study.vtkhdf")]) == 2
    assert "found a study for '.vtkhdf', allowed the result of a run" in capsys.readouterr().err


def test_vtk_reads_the_series(solution: Solution, tmp_path: Path) -> None:
    """The reader of ParaView finds all parts, at all times, with the numbers of the run."""
    hdf = pytest.importorskip("vtkmodules.vtkIOHDF")
    from vtkmodules.util.numpy_support import vtk_to_numpy
    from vtkmodules.vtkFiltersVerdict import vtkCellSizeFilter

    run = with_films(solution)
    reader = hdf.vtkHDFReader()
    reader.SetFileName(str(write_space_series(run, tmp_path / "run.vtkhdf", STATES)))
    reader.UpdateInformation()
    assert reader.GetNumberOfSteps() == STATES
    for k in range(STATES):
        reader.SetStep(k)
        reader.Update()
        collection = reader.GetOutputDataObject(0)
        assert reader.GetTimeValue() == run.data["time"].values[24 * k]
        parts = {
            collection.GetMetaData(i).Get(collection.NAME()): collection.GetPartition(i, 0)
            for i in range(collection.GetNumberOfPartitionedDataSets())
        }
        films = {"film_floating_drive_gear": 7.63e-3, "film_solid_drive_gear": 0.0}
        others = {"drive_gear", "driven_gear", "inlet", "outlet", "chambers", "casing"}
        assert set(parts) == others | set(films)
        sized = vtkCellSizeFilter()
        sized.SetInputData(parts["chambers"])
        sized.Update()
        cells = sized.GetOutput().GetCellData()
        owner = vtk_to_numpy(cells.GetArray("chamber"))
        pressure = vtk_to_numpy(cells.GetArray("pressure"))
        given = run.data["chamber_pressure"].values[24 * k]
        np.testing.assert_allclose(pressure, given[owner], rtol=1e-7)
        found = np.bincount(owner, vtk_to_numpy(cells.GetArray("Volume")))
        # the run moves the gears in their bearings, the drawn spaces do not
        np.testing.assert_allclose(found, run.data["chamber_volume"].values[24 * k], rtol=0.02)
        at_outlet = parts["outlet"].GetCellData().GetArray("pressure")
        assert at_outlet.GetValue(0) == pytest.approx(float(run.data["outlet_pressure"][24 * k]))
        for number, (name, level) in enumerate(films.items()):
            film = parts[name]
            assert film.GetBounds()[4:] == pytest.approx((level, level))
            wet = np.isfinite(run.data["film_height"].values[number])
            for field in FIELDS:
                array = film.GetCellData().GetArray(field.removeprefix("film_"))
                expected = run.data[field].values[number][wet]
                np.testing.assert_allclose(vtk_to_numpy(array), expected, rtol=1e-6)
