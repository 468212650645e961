"""Film fields as labelled arrays (NetCDF) and as a surface for ParaView (VTK)."""

from __future__ import annotations

import base64
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from toothspace.core.files import write_text
from toothspace.core.netcdf import write_dataset
from toothspace.core.types import Array
from toothspace.films.journal.solution import JournalBearingSolution
from toothspace.films.plane.pad import PadSolution
from toothspace.films.plane.ring import LateralSolution

if TYPE_CHECKING:
    import xarray as xr

FilmSolution = JournalBearingSolution | LateralSolution | PadSolution

_FIELDS = {
    "pressure": ("Pa", "absolute pressure"),
    "film_fraction": ("1", "film fraction"),
    "gap_height": ("m", "nominal gap height"),
    "contact_pressure": ("Pa", "asperity pressure over the nominal area"),
}


def film_dataset(film: FilmSolution) -> xr.Dataset:
    """Fields of a film with coordinates, units and long names.

    Returns
    -------
    xarray.Dataset
        ``pressure``, ``film_fraction``, ``gap_height`` and, but for pads, ``contact_pressure``
        over two coordinates in SI units; attribute ``status``.
    """
    import xarray as xr

    names, lines = _coordinates(film)
    units = {"angle": "rad", "axial_position": "m", "radius": "m", "x": "m", "y": "m"}
    coordinates = {
        name: (name, line, {"units": units[name], "long_name": name.replace("_", " ")})
        for name, line in zip(names, lines, strict=True)
    }
    data = {
        name: (names, values, {"units": _FIELDS[name][0], "long_name": _FIELDS[name][1]})
        for name, values in _fields(film).items()
    }
    return xr.Dataset(data, coordinates, {"status": film.status.name.lower()})


def save_film(film: FilmSolution, path: Path) -> None:
    """Write the fields of a film to a NetCDF file."""
    write_dataset(film_dataset(film), path)


def save_film_vtk(film: FilmSolution, path: Path) -> None:
    """Write the fields of a film on its surface as a VTK structured grid (.vts).

    Cell data; journal films stand on the cylinder of the bush, others in their plane.
    """
    _, (first, second) = _coordinates(film)
    u, v = np.meshgrid(_edges(first), _edges(second), indexing="ij")
    if isinstance(film, JournalBearingSolution):
        radius = 0.5 * film.bearing.diameter
        points = np.stack([radius * np.cos(u), radius * np.sin(u), v], axis=-1)
    elif isinstance(film, LateralSolution):
        points = np.stack([v * np.cos(u), v * np.sin(u), np.zeros_like(u)], axis=-1)
    else:
        points = np.stack([u, v, np.zeros_like(u)], axis=-1)
    rows, lanes = points.shape[0] - 1, points.shape[1] - 1
    extent = f"0 {lanes} 0 {rows} 0 0"
    arrays = "".join(
        _array(np.ascontiguousarray(values).ravel(), name, 1)
        for name, values in _fields(film).items()
    )
    write_text(
        path,
        '<?xml version="1.0"?>\n'
        '<VTKFile type="StructuredGrid" version="0.1" byte_order="LittleEndian">\n'
        f'<StructuredGrid WholeExtent="{extent}">\n<Piece Extent="{extent}">\n'
        f"<CellData>\n{arrays}</CellData>\n"
        f"<Points>\n{_array(points.ravel(), 'points', 3)}</Points>\n"
        "</Piece>\n</StructuredGrid>\n</VTKFile>\n",
    )


def _array(values: Array, name: str, components: int) -> str:
    data = values.astype("<f8").tobytes()
    text = base64.b64encode(np.array([len(data)], dtype="<u4").tobytes() + data).decode()
    return (
        f'<DataArray type="Float64" Name="{name}" NumberOfComponents="{components}" '
        f'format="binary">{text}</DataArray>\n'
    )


def _coordinates(film: FilmSolution) -> tuple[tuple[str, str], tuple[Array, Array]]:
    if isinstance(film, JournalBearingSolution):
        return ("angle", "axial_position"), (film.angle, film.axial_position)
    if isinstance(film, LateralSolution):
        return ("angle", "radius"), (film.lateral.angle, film.lateral.radius)
    return ("x", "y"), (film.x, film.y)


def _fields(film: FilmSolution) -> dict[str, Array]:
    pressure = film.pressure
    fields = {
        "pressure": pressure,
        "film_fraction": film.film_fraction,
        "gap_height": film.gap_height,
    }
    if not isinstance(film, PadSolution):
        fields["contact_pressure"] = film.contact_pressure
    return fields


def _edges(centres: Array) -> Array:
    """Edges of uniform cells."""
    step = centres[1] - centres[0]
    return np.asarray(np.concatenate([centres - 0.5 * step, centres[-1:] + 0.5 * step]))
