"""Plane sections with holes as text, DXF, STL and STEP files."""

from __future__ import annotations

import io
import math
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.files import write_bytes
from toothspace.core.lazy import package_of_extra
from toothspace.core.types import Array
from toothspace.geometry.curve import turned
from toothspace.geometry.gear_profile import GearProfile

EXPORT_SUFFIXES = (".txt", ".dxf", ".stl", ".step")
_MILLIMETRE = 1e-3
_DXF_UNITS = {1e-3: 4, 1e-2: 5, 1.0: 6, 25.4e-3: 1}
_CORNER = np.deg2rad(12.0)
_CHORD_ANGLE = np.deg2rad(1.0)
"""Turn between two layers of a twisted mesh: chords within 0.8 um of a helix of 20 mm. [rad]"""
_LOFT_ANGLE, _LOFT_LAYERS = np.deg2rad(3.0), 6
"""Turn between two sections that a smooth surface goes through [rad], and fewest layers: four
sections leave 0.2 % of the helix angle.
"""


@final
@dataclass(frozen=True)
class Section:
    """A plane section of a solid."""

    boundary: Array
    """Closed counter-clockwise curve, first point not repeated. Shape (n, 2). [m]"""
    holes: tuple[Array, ...] = ()
    """Closed counter-clockwise curves inside it. [m]"""
    pieces: tuple[Array, ...] = ()
    """Smooth pieces of the boundary; if not given, it is cut at its corners. [m]"""
    title: str = "closed curve"
    """What text files call it."""
    layer: str = "ROTOR"
    """Layer of DXF files."""

    @property
    def curves(self) -> tuple[Array, ...]:
        """Boundary and holes. [m]."""
        return (self.boundary, *self.holes)


def gear_section(profile: GearProfile) -> Section:
    """Section of a whole gear with its centre at the origin and a tooth on the x axis."""
    inner = {*profile.breaks, profile.tip_start, profile.tip_end} - {0, len(profile.points) - 1}
    cuts = [0, *sorted(inner), len(profile.points) - 1]
    pieces = tuple(
        turned(profile.points[a : b + 1], tooth * profile.pitch_angle)
        for tooth in range(profile.tooth_count)
        for a, b in pairwise(cuts)
    )
    title = f"gear section, {profile.tooth_count} teeth"
    return Section(profile.closed_polygon(), pieces=pieces, title=title, layer="GEAR")


def export_gear(
    profile: GearProfile, path: Path, face_width: float, unit: float = 1e-3, twist: float = 0.0
) -> None:
    """Write a whole gear; see :func:`gear_section` and :func:`export_section`.

    Raises GeometryError as :func:`export_section`.

    Parameters
    ----------
    profile : GearProfile
        Gear section.
    path : Path
        File; the format follows its suffix.
    face_width : float
        Tooth length, used by the solids. [m]
    unit : float
        Length of one unit of the file; STEP files are always in mm. [m]
    twist : float
        Turn of solid teeth over their length, positive right-handed. [rad]
    """
    export_section(gear_section(profile), path, face_width, unit, twist)


def export_section(
    section: Section, path: Path, width: float, unit: float = 1e-3, twist: float = 0.0
) -> None:
    """Write a section; the format follows the suffix of the file.

    Raises GeometryError for another suffix, a width that is not positive, or if the optional
    package for the format is missing.

    Parameters
    ----------
    path : Path
        File with suffix ``.txt`` (points of all curves, separated by empty lines), ``.dxf``
        (closed polylines), ``.stl`` or ``.step`` (solid from z = 0 to the width); it is replaced
        in one step when complete.
    width : float
        Height of the solid. [m]
    unit : float
        Length of one unit of the file; STEP files are always in mm. [m]
    twist : float
        Turn of a solid about z over its height. [rad]
    """
    path = Path(path)
    writers: dict[str, Callable[[], bytes]] = {
        ".txt": lambda: _text_bytes(section, unit),
        ".dxf": lambda: _dxf_bytes(section, unit),
        ".stl": lambda: _stl_bytes(section, width, unit, twist),
        ".step": lambda: _step_bytes(section, width, twist),
    }
    suffix = path.suffix.lower()
    if suffix not in writers:
        raise GeometryError(path, f"the suffix {suffix or 'none'!r}", ", ".join(EXPORT_SUFFIXES))
    if not 0.0 < width < np.inf:
        raise GeometryError("face_width", f"{width:g} m", "above 0")
    write_bytes(path, writers[suffix]())


def _text_bytes(section: Section, unit: float) -> bytes:
    stream = io.StringIO()
    for number, curve in enumerate(section.curves):
        stream.write("\n" if number else "")
        closed = np.vstack([curve, curve[:1]]) / unit
        np.savetxt(stream, closed, fmt="%.9f", header=f"{section.title}, unit {unit:g} m\nx y")
    return stream.getvalue().encode()


def _dxf_bytes(section: Section, unit: float) -> bytes:
    ezdxf = package_of_extra("ezdxf", "cad", "export: found the format 'dxf'")
    drawing = ezdxf.new("R2010")
    drawing.header["$INSUNITS"] = _DXF_UNITS.get(unit, 0)
    for curve in section.curves:
        drawing.modelspace().add_lwpolyline(
            [(x, y) for x, y in curve / unit], close=True, dxfattribs={"layer": section.layer}
        )
    stream = io.StringIO()
    drawing.write(stream)
    return stream.getvalue().encode()


def _stl_bytes(section: Section, width: float, unit: float, twist: float) -> bytes:
    import shapely

    trimesh = package_of_extra("trimesh", "cad", "export: found the format 'stl'")
    curves = []
    for c in section.curves:
        outline = c / unit
        # STL stores 32-bit numbers: neighbours that would coincide leave a leaking mesh
        spacing = 8.0 * np.finfo(np.float32).eps * float(np.abs(outline).max())
        kept = [outline[0]]
        for point in outline[1:]:
            if np.hypot(*(point - kept[-1])) > spacing:
                kept.append(point)
        curves.append(np.array(kept))
    vertices = np.vstack(curves)
    number = {point.tobytes(): index for index, point in enumerate(vertices)}
    # one fan per gear would fold at undercut roots; constrained triangles never do
    polygon = shapely.Polygon(curves[0], curves[1:])
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(polygon))
    corners = shapely.get_coordinates(triangles).reshape(len(triangles), 4, 2)[:, :3]
    indices = np.asarray([[number[c.tobytes()] for c in triangle] for triangle in corners])
    height = width / unit
    if twist == 0.0:
        solid = trimesh.creation.extrude_triangulation(vertices, indices, height=height)
    else:
        solid = trimesh.Trimesh(*_twisted(curves, vertices, indices, height, twist))
    return bytes(solid.export(file_type="stl"))


def _twisted(
    curves: list[Array], base: Array, cap: Array, height: float, twist: float
) -> tuple[Array, Array]:
    """Corners and triangles of a solid that turns about z as it rises.

    One layer ends halfway up, where readers cut a gear.
    """
    layers = 2 * max(math.ceil(0.5 * abs(twist) / _CHORD_ANGLE), 1)
    share = np.linspace(0.0, 1.0, layers + 1)
    rings = [np.column_stack([turned(base, twist * s), np.full(len(base), height * s)])
             for s in share]  # fmt: skip
    count, sides, first = len(base), [], 0
    for curve in curves:
        here = first + np.arange(len(curve))
        ahead = first + (np.arange(len(curve)) + 1) % len(curve)
        for layer in range(layers):
            a, b = layer * count + here, layer * count + ahead
            sides += [
                np.column_stack([a, b, b + count]),
                np.column_stack([a, b + count, a + count]),
            ]
        first += len(curve)
    # caps as the triangulation of the section, seen from outside
    a, b, c = (base[cap[:, k]] for k in range(3))
    first, second = (b - a).T, (c - a).T
    upwards = first[0] * second[1] - first[1] * second[0] > 0.0
    top = np.where(upwards[:, None], cap, cap[:, ::-1])
    return np.vstack(rings), np.vstack([*sides, top[:, ::-1], top + layers * count])


def _step_bytes(section: Section, width: float, twist: float) -> bytes:
    package_of_extra("OCP.STEPControl", "cad", "export: found the suffix '.step'")
    from OCP.APIHeaderSection import APIHeaderSection_MakeHeader
    from OCP.BRepPrimAPI import BRepPrimAPI_MakePrism
    from OCP.gp import gp_Vec
    from OCP.Interface import Interface_Static
    from OCP.STEPControl import STEPControl_AsIs, STEPControl_Writer
    from OCP.TCollection import TCollection_HAsciiString

    from toothspace.geometry.ocp import silence_ocp

    silence_ocp()
    if twist == 0.0:
        up = gp_Vec(0.0, 0.0, width / _MILLIMETRE)
        solid = BRepPrimAPI_MakePrism(step_face(section), up).Shape()
    else:
        solid = _lofted(section, width, twist)
    name = section.layer.lower()
    writer = STEPControl_Writer()
    Interface_Static.SetCVal_s("write.step.product.name", name)
    writer.Transfer(solid, STEPControl_AsIs)
    header = APIHeaderSection_MakeHeader(writer.Model())
    header.SetName(TCollection_HAsciiString(name))
    header.SetOriginatingSystem(TCollection_HAsciiString("toothspace"))
    header.SetAuthorValue(1, TCollection_HAsciiString(""))
    with tempfile.TemporaryDirectory() as folder:
        target = Path(folder) / "gear.step"
        writer.Write(str(target))
        return target.read_bytes()


def _lofted(section: Section, width: float, twist: float) -> Any:
    """Return the solid through sections that turn about z as they rise; it has no holes. [mm]."""
    from OCP.BRepOffsetAPI import BRepOffsetAPI_ThruSections
    from OCP.BRepTools import BRepTools
    from OCP.gp import gp_Ax1, gp_Dir, gp_Pnt, gp_Trsf, gp_Vec
    from OCP.TopLoc import TopLoc_Location

    if section.holes:
        raise GeometryError("export", "a twisted section with holes", "one without")
    loft = BRepOffsetAPI_ThruSections(True, False, 1e-6)
    for share in np.linspace(0.0, 1.0, max(math.ceil(abs(twist) / _LOFT_ANGLE), _LOFT_LAYERS) + 1):
        turn, rise = gp_Trsf(), gp_Trsf()
        axis = gp_Ax1(gp_Pnt(0.0, 0.0, 0.0), gp_Dir(0.0, 0.0, 1.0))
        turn.SetRotation(axis, float(twist * share))
        rise.SetTranslation(gp_Vec(0.0, 0.0, float(share * width / _MILLIMETRE)))
        wire = BRepTools.OuterWire_s(step_face(section))
        wire.Move(TopLoc_Location(rise.Multiplied(turn)))
        loft.AddWire(wire)
    loft.CheckCompatibility(False)
    loft.Build()
    return loft.Shape()


def step_face(section: Section) -> Any:
    """Return the plane face of a section. [mm]."""
    from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire

    # the class of arrays was renamed in version 8 of the package
    try:
        from OCP.collections import HArray1_gp_Pnt as PointArray
    except ImportError:
        from OCP.TColgp import TColgp_HArray1OfPnt as PointArray

    boundary = section.pieces or smooth_pieces(section.boundary)
    wires = []
    for pieces in (boundary, *(smooth_pieces(hole[::-1]) for hole in section.holes)):
        wire = BRepBuilderAPI_MakeWire()
        for piece in pieces:
            points = piece
            from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeEdge
            from OCP.GeomAPI import GeomAPI_Interpolate
            from OCP.gp import gp_Pnt

            points = points / _MILLIMETRE
            step = np.hypot(*np.diff(points, axis=0).T)
            kept = points[np.concatenate([step > 2e-6, [True]])]
            kept[0] = points[0]
            array = PointArray(1, len(kept))
            for index, (x, y) in enumerate(kept):
                array.SetValue(index + 1, gp_Pnt(float(x), float(y), 0.0))
            builder = GeomAPI_Interpolate(array, False, 1e-7)
            builder.Perform()
            wire.Add(BRepBuilderAPI_MakeEdge(builder.Curve()).Edge())
        wires.append(wire.Wire())
    made = BRepBuilderAPI_MakeFace(wires[0], True)
    for hole in wires[1:]:
        made.Add(hole)
    return made.Face()


def smooth_pieces(curve: Array) -> list[Array]:
    """Cut a closed curve at its corners, or into two halves where it has fewer than two.

    Pieces; each starts where the previous one ends, the last one ends at the first. [m]

    Parameters
    ----------
    curve : ndarray, shape (n, 2)
        Closed curve, first point not repeated. [m]
    """
    edge = np.roll(curve, -1, axis=0) - curve
    before = np.roll(edge, 1, axis=0)
    turn = np.arctan2(
        before[:, 0] * edge[:, 1] - before[:, 1] * edge[:, 0], np.sum(before * edge, axis=1)
    )
    cuts = np.flatnonzero(np.abs(turn) > _CORNER)
    if cuts.size < 2:
        cuts = np.array([0, len(curve) // 2])
    closed = np.vstack([np.roll(curve, -cuts[0], axis=0), curve[cuts[0]]])
    ends = [*(cuts - cuts[0]), len(curve)]
    return [closed[a : b + 1] for a, b in pairwise(ends)]
