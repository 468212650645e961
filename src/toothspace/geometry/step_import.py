"""Solids of a STEP file: names, meshes and exact plane sections."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array
from toothspace.geometry.body_section import SolidBody, SurfaceMesh, merged
from toothspace.geometry.cad_import import chain_closed
from toothspace.geometry.ocp import silence_ocp

_UNIT = 1e-3
_NO_NAMES = {"COMPOUND", "COMPSOLID", "SOLID", "SHELL"}
"""What the library calls bodies without a name."""
_ANGULAR_DEFLECTION = 0.02
_CHORD_DEFLECTION = 5e-5  # mm
_MESH_DEFLECTION = 0.05  # mm
_MESH_ANGLE = 0.3
_PARALLEL = 1e-9
_JOIN = 1e-7


def step_bodies(path: Path) -> list[SolidBody]:
    """Solids of a STEP file; a damaged file can end the process.

    Solids in the order of the file, placed as in the assembly.

    Raises GeometryError for a file that cannot be read or holds no solid.

    Parameters
    ----------
    path : Path
        STEP file; its own length unit is used.
    """
    silence_ocp()
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("solids"))
    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    if reader.ReadFile(str(path)) != IFSelect_RetDone or not reader.Transfer(document):
        raise GeometryError(path, "a damaged STEP file", "a complete one")
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    labels, solids = _label_sequence(), list[tuple[str, Any]]()
    shapes.GetFreeShapes(labels)
    for k in range(labels.Length()):
        _collect(shapes, labels.Value(k + 1), None, "", solids)
    if not solids:
        raise GeometryError(path, "no body", "at least one closed body")
    meshes = []
    for name, solid in solids:
        from OCP.BRep import BRep_Tool
        from OCP.BRepMesh import BRepMesh_IncrementalMesh
        from OCP.TopLoc import TopLoc_Location

        BRepMesh_IncrementalMesh(solid, _MESH_DEFLECTION, False, _MESH_ANGLE)
        triangles = []
        for face in _parts(solid, "Face"):
            place = TopLoc_Location()
            mesh = BRep_Tool.Triangulation_s(face, place)
            if mesh is None:
                continue
            move = place.Transformation()
            nodes = [mesh.Node(k + 1).Transformed(move) for k in range(mesh.NbNodes())]
            corners = np.array([[p.X(), p.Y(), p.Z()] for p in nodes])
            numbers = [mesh.Triangle(k + 1).Get() for k in range(mesh.NbTriangles())]
            triangles.append(corners[np.array([tuple(row)[-3:] for row in numbers]) - 1])
        meshes.append(
            SolidBody(
                name,
                (
                    SurfaceMesh(np.zeros((1, 3)), np.zeros((0, 3), dtype=np.int64))
                    if not triangles
                    else merged(np.concatenate(triangles) * _UNIT, _JOIN)
                ),
                partial(_section, str(path), solid),
            )
        )
    return meshes


def _collect(shapes: Any, label: Any, place: Any, name: str, found: list[tuple[str, Any]]) -> None:
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDF import TDF_Label

    attribute = TDataStd_Name()
    if not label.FindAttribute(TDataStd_Name.GetID_s(), attribute):
        named = ""
    else:
        written = str(attribute.Get().ToExtString())
        named = "" if written in _NO_NAMES else written
    own = named or name
    if shapes.IsReference_s(label):
        target = TDF_Label()
        shapes.GetReferredShape_s(label, target)
        at = shapes.GetLocation_s(label)
        _collect(shapes, target, at if place is None else place.Multiplied(at), own, found)
        return
    if shapes.IsAssembly_s(label):
        parts = _label_sequence()
        shapes.GetComponents_s(label, parts, False)
        for k in range(parts.Length()):
            _collect(shapes, parts.Value(k + 1), place, own, found)
        return
    shape = shapes.GetShape_s(label)
    if place is not None:
        shape = shape.Moved(place)
    found += [(own, solid) for solid in _parts(shape, "Solid")]


def _label_sequence() -> Any:
    # the class was renamed in version 8 of the package
    try:
        from OCP.collections import Sequence_TDF_Label
    except ImportError:
        from OCP.TDF import TDF_LabelSequence

        return TDF_LabelSequence()
    return Sequence_TDF_Label()


def _section(file: str, solid: Any, frame: Array, height: float) -> list[Array]:
    pieces, others = [], []
    for face in _parts(solid, "Face"):
        found = _section_of_wall(face, frame[2], height)
        if found is None:
            others.append(face)
        else:
            pieces += found
    if others:
        axis = frame[2]
        # curves in which faces of any kind meet a plane
        from OCP.BRep import BRep_Builder
        from OCP.BRepAlgoAPI import BRepAlgoAPI_Section
        from OCP.gp import gp_Dir, gp_Pln, gp_Pnt
        from OCP.TopoDS import TopoDS_Compound

        compound, builder = TopoDS_Compound(), BRep_Builder()
        builder.MakeCompound(compound)
        for other in others:
            builder.Add(compound, other)
        plane = gp_Pln(gp_Pnt(*map(float, axis * height / _UNIT)), gp_Dir(*map(float, axis)))
        pieces += _edges(BRepAlgoAPI_Section(compound, plane).Shape())
    return chain_closed([piece @ frame[:2].T * _UNIT for piece in pieces], _JOIN, file)


def _section_of_wall(face: Any, axis: Array, height: float) -> list[Array] | None:
    # a wall along the axis between two flat edges has their outline at every height
    # whether the box round a face holds the height
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    box = Bnd_Box()
    BRepBndLib.Add_s(face, box)
    low, high = (np.array([p.X(), p.Y(), p.Z()]) for p in (box.CornerMin(), box.CornerMax()))
    middle, half = 0.5 * (low + high) @ axis, 0.5 * (high - low) @ np.abs(axis)
    if not bool(abs(height / _UNIT - middle) <= half):
        return []
    if not _along_axis(face, axis):
        return None
    edges = _edges(face)
    heights = [edge @ axis * _UNIT for edge in edges]
    bottom = min(float(h.min()) for h in heights)
    top = max(float(h.max()) for h in heights)
    level = [edge for edge, h in zip(edges, heights, strict=True) if np.ptp(h) < _JOIN]
    upright = [h for h in heights if np.ptp(h) > top - bottom - _JOIN]
    at_ends = [min(abs(e[0] @ axis * _UNIT - end) for end in (bottom, top)) for e in level]
    if len(level) + len(upright) < len(edges) or max(at_ends, default=1.0) > _JOIN:
        return None
    if not bottom < height < top:
        return []
    return [edge for edge in level if edge[0] @ axis * _UNIT < height]


def _along_axis(face: Any, axis: Array) -> bool:
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_SurfaceType as Kind

    def along(direction: Any) -> float:
        return abs(float(np.array([direction.X(), direction.Y(), direction.Z()]) @ axis))

    surface = BRepAdaptor_Surface(face)
    kind = surface.GetType()
    if kind == Kind.GeomAbs_Plane:
        return along(surface.Plane().Axis().Direction()) < _PARALLEL
    if kind == Kind.GeomAbs_SurfaceOfExtrusion:
        return along(surface.Direction()) > 1.0 - _PARALLEL
    if kind == Kind.GeomAbs_Cylinder:
        return along(surface.Cylinder().Axis().Direction()) > 1.0 - _PARALLEL
    return False


def _parts(shape: Any, kind: str) -> list[Any]:
    import OCP.TopAbs
    from OCP.TopExp import TopExp_Explorer
    from OCP.TopoDS import TopoDS

    # the name of this cast was changed in version 8 of the package
    cast = getattr(TopoDS, f"{kind}_s", None) or getattr(TopoDS, kind)
    explorer, parts = TopExp_Explorer(shape, getattr(OCP.TopAbs, f"TopAbs_{kind.upper()}")), []
    while explorer.More():
        parts.append(cast(explorer.Current()))
        explorer.Next()
    return parts


def _edges(shape: Any) -> list[Array]:
    from OCP.BRepAdaptor import BRepAdaptor_Curve
    from OCP.GCPnts import GCPnts_TangentialDeflection

    found = []
    for edge in _parts(shape, "Edge"):
        sampler = GCPnts_TangentialDeflection(
            BRepAdaptor_Curve(edge), _ANGULAR_DEFLECTION, _CHORD_DEFLECTION, 2, 1e-9, 1e-9
        )
        points = [sampler.Value(index + 1) for index in range(sampler.NbPoints())]
        found.append(np.array([[point.X(), point.Y(), point.Z()] for point in points]))
    return found
