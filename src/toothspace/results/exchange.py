"""Results for other programs: MAT files, workbooks, Zarr, and maps as tables of simulators."""

from __future__ import annotations

import re
import shutil
from collections.abc import Mapping
from dataclasses import dataclass
from io import BytesIO
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.files import write_bytes, write_text
from toothspace.core.lazy import package_of_extra
from toothspace.core.types import Array

if TYPE_CHECKING:
    import pandas as pd
    import xarray as xr

_LONGEST_NAME = 63
"""Characters of a name in MATLAB."""
_LONGEST_SHEET = 31
"""Characters of the name of a sheet."""
_MODELICA_NAME = re.compile(r"[A-Za-z][A-Za-z0-9_]*")
_MAP = ("displacement_cm3_per_rev", "mean_flow_L_per_min", "mean_torque_N_m")
"""Variables that make a map."""
_LITRE_PER_MINUTE, _TURN = 6e4, 2.0 * np.pi


def write_mat(data: xr.Dataset, path: Path) -> Path:
    """Write all variables of a result under their names as a MAT file (version 5).

    ``units`` and ``dimensions`` are structures with a text for each variable; text variables are
    cell arrays. Characters that MATLAB allows in no name become underscores. An efficiency map
    also has the structure ``simscape`` with what pump and motor blocks of Simscape Fluids ask for
    where they are described by tables of losses: ``dp`` [Pa], ``w`` [rad/s], ``q_loss`` [m3/s] and
    ``torque_loss`` [N m] over both, ``displacement`` [m3/rad].

    Parameters
    ----------
    data : xarray.Dataset
        Data of a solution or study.
    path : Path
        File to write.
    """
    from scipy.io import savemat

    content: dict[str, Any] = {}
    units: dict[str, str] = {}
    dimensions: dict[str, str] = {}
    for given, variable in data.variables.items():
        name = re.sub(r"\W", "_", str(given))[:_LONGEST_NAME]
        values = np.asarray(variable.values)
        content[name] = values if values.dtype.kind in "fiub" else values.astype(object)
        units[name] = str(variable.attrs.get("units", "1"))
        dimensions[name] = " ".join(map(str, variable.dims))
    if is_map(data):
        table = machine_map(data)
        content["simscape"] = {
            "dp": table.pressure_difference,
            "w": table.shaft_speed,
            "q_loss": table.flow_loss.T,
            "torque_loss": table.torque_loss.T,
            "displacement": table.displacement,
        }
    savemat(
        path,
        {**content, "units": units, "dimensions": dimensions},
        appendmat=False,
        long_field_names=True,
        do_compression=True,
        oned_as="column",
    )
    return path


def write_zarr(data: xr.Dataset, path: Path) -> Path:
    """Write a result as a Zarr store (version 2), a folder of compressed parts of its arrays.

    Other programs read of it what they ask for, from many processes at once or from object
    storage. The store is complete or not there.

    Raises GeometryError if the package of the extra ``zarr`` is missing, CaseError if a folder
    that is no Zarr store stands there.

    Parameters
    ----------
    data : xarray.Dataset
        Data of a solution or study.
    path : Path
        Folder to write; a store of that name is replaced.
    """
    package_of_extra("zarr", "zarr", f"-o: found {path.name!r}")
    if path.exists() and not (path / ".zgroup").is_file():
        raise CaseError(f"{path}: -o", "a folder that is no Zarr store", "a new one")
    draft = path.with_name(f"{path.name}.part")
    try:
        data.drop_encoding().to_zarr(draft, mode="w", zarr_format=2, consolidated=True)
        shutil.rmtree(path, ignore_errors=True)
        draft.rename(path)
    finally:
        shutil.rmtree(draft, ignore_errors=True)
    return path


@final
@dataclass(frozen=True)
class MachineMap:
    """Steady behaviour of a machine over speed and pressure difference."""

    shaft_speed: Array
    """Shape (speeds,). [rad/s]"""
    pressure_difference: Array
    """High minus low pressure, shape (pressures,). [Pa]"""
    flow: Array
    """Volume flow that a pump delivers or a motor takes, shape (speeds, pressures). [m3/s]"""
    torque: Array
    """Torque that a pump takes or a motor gives. [N m]"""
    displacement: float
    """Geometric volume per shaft radian. [m3/rad]"""
    is_motor: bool
    """Whether losses raise the flow and lower the torque."""

    @property
    def flow_loss(self) -> Array:
        """Flow that a pump lacks or a motor takes beyond its displacement. [m3/s]."""
        lost = self.displacement * self.shaft_speed[:, None] - self.flow
        return -lost if self.is_motor else lost

    @property
    def torque_loss(self) -> Array:
        """Torque that a pump takes beyond its displacement, or a motor lacks. [N m]."""
        lost = self.torque - self.displacement * self.pressure_difference
        return -lost if self.is_motor else lost


def is_map(data: xr.Dataset) -> bool:
    """Whether the data of a study are a map with flow and torque."""
    over = ("shaft_speed", "pressure_difference")
    return all(name in data and data[name].dims == over for name in _MAP)


def machine_map(data: xr.Dataset) -> MachineMap:
    """Flow and torque of an efficiency map in SI units.

    Raises CaseError if the data are no such map.

    Parameters
    ----------
    data : xarray.Dataset
        Data of a study ``efficiency_map``.
    """
    if not is_map(data):
        raise CaseError("study", "no map of flow and torque", "the study.nc of an efficiency_map")
    displacement, flow, torque = (np.asarray(data[name], dtype=float) for name in _MAP)
    known = displacement[np.isfinite(displacement)]
    return MachineMap(
        np.asarray(data["shaft_speed"], dtype=float),
        np.asarray(data["pressure_difference"], dtype=float),
        flow / _LITRE_PER_MINUTE,
        torque,
        float(known[0]) * 1e-6 / _TURN if known.size else np.nan,
        data.attrs.get("mode") == "motor",
    )


def _whole(table: MachineMap) -> MachineMap:
    missing = int((~np.isfinite(table.flow + table.torque)).sum())
    if missing:
        raise CaseError(
            "study", f"a map with {missing} failed points", "a map without failed points"
        )
    return table


def write_amesim(data: xr.Dataset, path: Path) -> list[Path]:
    """Write a map as tables for Simcenter Amesim: one file for the flow, one for the torque.

    Axis 1 is the pressure difference [bar], axis 2 the speed [rev/min]; flows are in L/min and
    torques in N m. ``pump.data`` becomes ``pump_flow.data`` and ``pump_torque.data``.

    Raises CaseError if the data are no map without failed points.

    Parameters
    ----------
    data : xarray.Dataset
        Data of a study ``efficiency_map``.
    path : Path
        Name of the files, without their last words.

    Returns
    -------
    list of Path
        The files.
    """
    table, written = _whole(machine_map(data)), []
    pressures, speeds = table.pressure_difference * 1e-5, table.shaft_speed * 60.0 / _TURN
    for target, values, unit in zip(
        amesim_files(path),
        (table.flow * _LITRE_PER_MINUTE, table.torque),
        ("L/min", "Nm"),
        strict=True,
    ):
        lines = [
            "# Table format: 2D",
            f"# {' '.join(str(data.attrs.get('title', '')).split())}",
            f"# table_unit = {unit}",
            "# axis1_unit = bar",
            "# axis2_unit = rev/min",
            f"{pressures.size}",
            f"{speeds.size}",
            *(_row(line, " ") for line in (pressures, speeds)),
            *(_row(line, " ") for line in values),
        ]
        written.append(write_text(target, "\n".join(lines) + "\n"))
    return written


def amesim_files(path: Path) -> list[Path]:
    """Files that a map becomes for Amesim."""
    return [path.with_name(f"{path.stem}_{what}{path.suffix}") for what in ("flow", "torque")]


def write_modelica(data: xr.Dataset, path: Path) -> Path:
    """Write a map as a Modelica record, with matrices as ``CombiTable2Ds`` takes them.

    The first column of ``volume_flow`` [m3/s] and ``shaft_torque`` [N.m] holds speeds [rad/s],
    their first row pressure differences [Pa]. The record is named after the file.

    Raises CaseError if the data are no map without failed points, or the file has no such name.

    Parameters
    ----------
    data : xarray.Dataset
        Data of a study ``efficiency_map``.
    path : Path
        File to write, ``NAME.mo``.
    """
    if not _MODELICA_NAME.fullmatch(path.stem):
        allowed = "letters, digits and _, a letter first: a name of Modelica"
        raise CaseError("-o", repr(path.name), allowed)
    table = _whole(machine_map(data))
    title = " ".join(str(data.attrs.get("title", "")).replace('"', "'").split())
    text = [f'record {path.stem} "{title}"']
    text.append(
        f'  constant Real displacement(unit = "m3/rad") = {table.displacement!r} '
        '"Geometric volume per shaft radian";'
    )
    said = "first column shaft speeds in rad/s, first row pressure differences in Pa"
    for name, values, unit in (
        # flow alone is a keyword
        ("volume_flow", table.flow, "m3/s"),
        ("shaft_torque", table.torque, "N.m"),
    ):
        rows = [_row(np.append(0.0, table.pressure_difference))]
        rows += [_row(np.append(w, v)) for w, v in zip(table.shaft_speed, values, strict=True)]
        size = f"{table.shaft_speed.size + 1}, {table.pressure_difference.size + 1}"
        matrix = ";\n    ".join(rows)
        text.append(
            f"  constant Real {name}[{size}] = [\n    {matrix}]\n"
            f'    "{name.replace("_", " ").capitalize()} in {unit}: {said}";'
        )
    text.append(f"end {path.stem};")
    return write_text(path, "\n".join(text) + "\n")


def _row(values: Array, between: str = ", ") -> str:
    return between.join(f"{value:.10g}" for value in values)


def headed(frame: pd.DataFrame, index_units: Mapping[str, str]) -> pd.DataFrame:
    """Rows of a table with ``name [unit]`` on top, those of the index first.

    Parameters
    ----------
    frame : pandas.DataFrame
        Table with the units of its columns in ``attrs["units"]``.
    index_units : mapping of str to str
        Units of the index by the names of its levels.
    """
    units, rows = frame.attrs["units"] | index_units, frame.reset_index()
    return rows.set_axis([f"{name} [{units.get(str(name), '1')}]" for name in rows.columns], axis=1)


def write_workbook(sheets: Mapping[str, pd.DataFrame], path: Path) -> Path:
    """Write tables as sheets of a workbook for Excel and others, heads as they stand.

    Raises GeometryError if the package of the extra ``excel`` is missing.

    Parameters
    ----------
    sheets : mapping of str to pandas.DataFrame
        Tables by the names of their sheets.
    path : Path
        File to write, ``NAME.xlsx``.
    """
    import pandas as pd

    package_of_extra("openpyxl", "excel", f"-o: found {path.name!r}")
    buffer = BytesIO()
    with pd.ExcelWriter(buffer, engine="openpyxl") as writer:
        for name, frame in sheets.items():
            frame.to_excel(
                writer, sheet_name=name[:_LONGEST_SHEET], index=False, freeze_panes=(1, 0)
            )
    return write_bytes(path, buffer.getvalue())
