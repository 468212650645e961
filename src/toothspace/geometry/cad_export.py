"""Gear sections as text, DXF, STL and STEP files."""

from __future__ import annotations

import io
import tempfile
from collections.abc import Callable
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.files import write_bytes
from toothspace.core.optional import package_of_extra
from toothspace.core.types import Array
from toothspace.geometry.gear_profile import GearProfile

EXPORT_SUFFIXES = (".txt", ".dxf", ".stl", ".step")
_STEP_UNIT = 1e-3
_DXF_UNITS = {1e-3: 4, 1e-2: 5, 1.0: 6, 25.4e-3: 1}


def export_gear(profile: GearProfile, path: Path, face_width: float, unit: float = 1e-3) -> None:
    """Write a whole gear; the format follows the suffix of the file.

    Parameters
    ----------
    profile : GearProfile
        Gear section, written with its centre at the origin and a tooth on the x axis.
    path : Path
        File with suffix ``.txt`` (points), ``.dxf`` (closed polyline), ``.stl`` or ``.step``
        (solid from z = 0 to the face width); it is replaced in one step when complete.
    face_width : float
        Tooth length, used by the solids. [m]
    unit : float
        Length of one unit of the file; STEP files are always in mm. [m]

    Raises
    ------
    GeometryError
        For another suffix, a face width that is not positive, or if the optional package for STEP
        files is missing.
    """
    path = Path(path)
    writers: dict[str, Callable[[], bytes]] = {
        ".txt": lambda: _text_bytes(profile, unit),
        ".dxf": lambda: _dxf_bytes(profile, unit),
        ".stl": lambda: _stl_bytes(profile, face_width, unit),
        ".step": lambda: _step_bytes(profile, face_width),
    }
    suffix = path.suffix.lower()
    if suffix not in writers:
        raise GeometryError(
            f"{path}: found the suffix {suffix or 'none'!r}, allowed {', '.join(EXPORT_SUFFIXES)}"
        )
    if not 0.0 < face_width < np.inf:
        raise GeometryError(f"face_width: found {face_width:g} m, allowed above 0")
    write_bytes(path, writers[suffix]())


def _text_bytes(profile: GearProfile, unit: float) -> bytes:
    stream = io.StringIO()
    header = f"gear section, {profile.tooth_count} teeth, unit {unit:g} m\nx y"
    np.savetxt(stream, profile.closed_polygon() / unit, fmt="%.9f", header=header)
    return stream.getvalue().encode()


def _dxf_bytes(profile: GearProfile, unit: float) -> bytes:
    ezdxf = package_of_extra("ezdxf", "cad", "export: found the format 'dxf'")
    drawing = ezdxf.new("R2010")
    drawing.header["$INSUNITS"] = _DXF_UNITS.get(unit, 0)
    outline = profile.closed_polygon() / unit
    drawing.modelspace().add_lwpolyline(
        [(x, y) for x, y in outline], close=True, dxfattribs={"layer": "GEAR"}
    )
    stream = io.StringIO()
    drawing.write(stream)
    return stream.getvalue().encode()


def _stl_bytes(profile: GearProfile, face_width: float, unit: float) -> bytes:
    import shapely

    trimesh = package_of_extra("trimesh", "cad", "export: found the format 'stl'")
    outline = distinct_in_single_precision(profile.closed_polygon() / unit)
    vertices, triangles = _cap_triangles(shapely.Polygon(outline))
    solid = trimesh.creation.extrude_triangulation(vertices, triangles, height=face_width / unit)
    return bytes(solid.export(file_type="stl"))


def distinct_in_single_precision(outline: Array) -> Array:
    """Drop points that 32-bit numbers cannot tell from their neighbour."""
    # STL stores 32-bit numbers: neighbours that would coincide leave a leaking mesh
    spacing = 8.0 * np.finfo(np.float32).eps * float(np.abs(outline).max())
    kept = [outline[0]]
    for point in outline[1:]:
        if np.hypot(*(point - kept[-1])) > spacing:
            kept.append(point)
    return np.array(kept)


def _cap_triangles(polygon: Any) -> tuple[Array, Any]:
    # one fan per gear would fold at undercut roots; constrained triangles never do
    import shapely

    outline = np.asarray(polygon.exterior.coords)[:-1]
    number = {point.tobytes(): index for index, point in enumerate(outline)}
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(polygon))
    corners = shapely.get_coordinates(triangles).reshape(len(triangles), 4, 2)[:, :3]
    indices = [[number[corner.tobytes()] for corner in triangle] for triangle in corners]
    return outline, np.asarray(indices)


def _step_bytes(profile: GearProfile, face_width: float) -> bytes:
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "gear.step"
        return face_prism_bytes(lambda: _step_face(profile), face_width, target)


def face_prism_bytes(face: Callable[[], Any], width: float, target: Path) -> bytes:
    """Return the STEP file of a plane face drawn out along z.

    Parameters
    ----------
    face : callable
        Builds the face, in millimetres.
    width : float
        Height of the solid. [m]
    target : Path
        Scratch file; its name is written into the header.

    Raises
    ------
    GeometryError
        If the optional package for STEP files is missing.
    """
    package_of_extra("OCP.STEPControl", "cad", "export: found the suffix '.step'")
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.gp import gp_Vec
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer

    from toothspace.geometry.ocp import silence_ocp

    silence_ocp()
    solid = BRepPrimAPI_MakePrism(face(), gp_Vec(0.0, 0.0, width / _STEP_UNIT)).Shape()
    writer = STEPControl_Writer()
    writer.Transfer(solid, STEPControl_AsIs)
    writer.Write(str(target))
    return target.read_bytes()


def _step_face(profile: GearProfile) -> Any:
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire

    wire = BRepBuilderAPI_MakeWire()
    for tooth in range(profile.tooth_count):
        for piece in _smooth_pieces(profile):
            wire.Add(spline_edge(piece, tooth * profile.pitch_angle))
    return BRepBuilderAPI_MakeFace(wire.Wire(), True).Face()


def _smooth_pieces(profile: GearProfile) -> list[Array]:
    inner = {*profile.breaks, profile.tip_start, profile.tip_end} - {0, len(profile.points) - 1}
    cuts = [0, *sorted(inner), len(profile.points) - 1]
    return [profile.points[a : b + 1] for a, b in pairwise(cuts)]


def spline_edge(points: Array, rotation: float) -> Any:
    """Return the edge through points [m], turned by an angle [rad], in millimetres."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
    from OCP.GeomAPI import GeomAPI_Interpolate
    from OCP.gp import gp_Pnt

    cosine, sine = np.cos(rotation), np.sin(rotation)
    turned = points @ np.array([[cosine, sine], [-sine, cosine]]) / _STEP_UNIT
    step = np.hypot(*np.diff(turned, axis=0).T)
    kept = turned[np.concatenate([step > 2e-6, [True]])]
    kept[0] = turned[0]
    array = _point_array_type()(1, len(kept))
    for index, (x, y) in enumerate(kept):
        array.SetValue(index + 1, gp_Pnt(float(x), float(y), 0.0))
    builder = GeomAPI_Interpolate(array, False, 1e-7)
    builder.Perform()
    return BRepBuilderAPI_MakeEdge(builder.Curve()).Edge()


def _point_array_type() -> Any:
    # the class was renamed in version 8 of the package
    try:
        from OCP.collections import HArray1_gp_Pnt
    except ImportError:
        from OCP.TColgp import TColgp_HArray1OfPnt

        return TColgp_HArray1OfPnt
    return HArray1_gp_Pnt
