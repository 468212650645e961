"""Bodies of STL and STEP files and their plane sections."""

from __future__ import annotations

import struct
from functools import partial
from importlib.util import find_spec
from pathlib import Path

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.optional import package_of_extra
from toothspace.core.types import Array
from toothspace.geometry.body_section import BodySection, SectionRequest, SolidBody, cut_bodies
from toothspace.geometry.limited_reading import READ_HERE, read_sections
from toothspace.geometry.mesh_section import SurfaceMesh, merged, section, separated

_MERGE_TOLERANCES = (0.0, 1e-8, 1e-7, 1e-6)
"""Of the size of a file: distance up to which corners of its triangles are one. [-]"""


def solid_sections(path: Path, unit: float, request: SectionRequest) -> list[BodySection]:
    """Cut the bodies of a solid file.

    Parameters
    ----------
    path : Path
        STEP, ASCII or binary STL file.
    unit : float
        Length of one unit of an STL file; STEP files carry their own. [m]

    Returns
    -------
    list of BodySection
        Sections, largest body first.

    Raises
    ------
    GeometryError
        For files that cannot be read within the limits of the reading process, truncated files,
        bodies that are not closed, a plane outside the bodies, or if the optional package for the
        format is missing.
    """
    if path.suffix.lower() == ".stl":
        if path.stat().st_size > READ_HERE:
            return read_sections(path, unit, request)
        return cut_bodies(str(path), stl_bodies(path, unit), request)
    try:
        present = find_spec("OCP.STEPControl") is not None
    except (ImportError, ValueError):
        present = False
    if not present:
        raise GeometryError(
            path,
            "a STEP file but not the package that reads it",
            'after pip install "toothspace[cad]"',
        )
    if not path.read_bytes()[:64].lstrip().startswith(b"ISO-10303-21"):
        raise GeometryError(path, "no STEP header", "a file of ISO-10303-21")
    return read_sections(path, unit, request)


def stl_bodies(path: Path, unit: float) -> list[SolidBody]:
    """Bodies of an STL file in a unit [m], read in this process; see ``solid_sections``."""
    return [SolidBody("", m, partial(_simple_section, m)) for m in _closed_meshes(path, unit)]


def _closed_meshes(path: Path, unit: float) -> list[SurfaceMesh]:
    trimesh = package_of_extra("trimesh", "cad", f"{path}: found an STL file")
    _check_stl(path)
    try:
        with np.errstate(all="ignore"):  # numbers that are none are refused below
            loaded = trimesh.load_mesh(path, file_type="stl", process=False)
            triangles = np.asarray(loaded.triangles, dtype=float) * unit
    except Exception as error:
        raise GeometryError(path, f"no readable STL ({error})", "STL") from error
    if len(triangles) == 0 or not np.all(np.isfinite(triangles)):
        raise GeometryError(path, "no finite triangles", "a closed surface")
    size = float(np.ptp(triangles.reshape(-1, 3), axis=0).max())
    mesh = merged(triangles, _MERGE_TOLERANCES[0] * size)
    for tolerance in _MERGE_TOLERANCES[1:]:
        if mesh.is_closed:
            break
        mesh = merged(triangles, tolerance * size)
    bodies = separated(mesh)
    for number, body in enumerate(bodies):
        if not body.is_closed:
            raise GeometryError(
                path,
                f"an open surface (body {number} of {len(bodies)} is not watertight)",
                "closed bodies",
            )
    return bodies


def _simple_section(mesh: SurfaceMesh, frame: Array, height: float) -> list[Array]:
    import shapely

    # without the points that triangles leave on straight edges
    found = []
    for curve in section(mesh, frame, height):
        size = float(np.ptp(curve, axis=0).max())
        simple = shapely.simplify(shapely.LinearRing(curve), 1e-7 * size)
        found.append(np.asarray(shapely.get_coordinates(simple))[:-1])
    return found


def _check_stl(path: Path) -> None:
    raw = path.read_bytes()
    head = raw[:80].lstrip().lower()
    if head.startswith(b"solid") and b"facet" in raw[:2000].lower():
        if b"endsolid" not in raw[-200:].lower():
            raise GeometryError(path, "a truncated ASCII STL", "one with endsolid")
        return
    if len(raw) < 84:
        raise GeometryError(path, f"{len(raw)} bytes", "a complete STL file")
    facets = struct.unpack("<I", raw[80:84])[0]
    if len(raw) < 84 + 50 * facets or facets == 0:
        raise GeometryError(
            path,
            f"{len(raw)} bytes for {facets} facets (truncated STL)",
            f"{84 + 50 * max(facets, 4)} bytes or more",
        )
