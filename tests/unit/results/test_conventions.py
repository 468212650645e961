"""Files of results by the rules of the CF conventions."""

from __future__ import annotations

import re
from pathlib import Path

import h5py
import numpy as np
import xarray as xr

from tests.fake_solution import fake_solution
from toothspace.core.netcdf import read_dataset, write_dataset
from toothspace.results.variables import UNITS, VARIABLES

KNOWN = set(
    [
        "rad",
        "s",
        "N",
        "m",
        "m2",
        "m3",
        "Pa",
        "W",
        "kg",
        "J",
        "K",
        "L",
        "min",
        "bar",
        "degC",
        "rpm",
        "degree",
        "cm3",
        "revolution",
        "um",
        "mm",
        "mm2",
        "mm3",
        "h",
        "mrad",
        "kN",
        "MPa",
    ]
)
"""Symbols of UDUNITS that results use; ``%`` and ``1`` too."""
NOT_IN_UDUNITS = {"dB", "dB(A)"}
"""Levels have no unit there."""


def test_a_result_has_conventions_long_names_and_no_fill_values_in_coordinates(
    tmp_path: Path,
) -> None:
    path = fake_solution(36).save(tmp_path / "run.nc")
    with xr.open_dataset(path, engine="h5netcdf", decode_times=False) as data:
        assert data.attrs["Conventions"] == "CF-1.11"
        assert data.attrs["history"].startswith("Written by toothspace")
        assert data.attrs["title"] == "Fake 12-tooth motor"
        assert all(variable.attrs["long_name"] for variable in data.variables.values())
        coordinates = list(data.coords)
    with h5py.File(path) as file:
        assert "shaft_angle" in coordinates
        assert not [name for name in coordinates if "_FillValue" in file[name].attrs]
        assert np.all(np.diff(file["shaft_angle"][:]) > 0.0)


def test_units_are_those_of_udunits(tmp_path: Path) -> None:
    units = {entry.units for entry in VARIABLES.values()} | set(UNITS.values())
    units -= {"", "1", "%"} | NOT_IN_UDUNITS
    data = xr.Dataset({f"v{k}": ((), 1.0, {"units": unit}) for k, unit in enumerate(sorted(units))})
    found = read_dataset(write_dataset(data, tmp_path / "units.nc"))
    for variable in found.variables.values():
        unit = variable.attrs["units"]
        assert set(re.findall(r"[A-Za-z]+\d?", unit)) <= KNOWN, unit
    # what is written does not change what is in memory
    assert {v.attrs["units"] for v in data.variables.values()} == units
    assert "Conventions" not in data.attrs
