"""Solids of a STEP file: names, meshes and exact plane sections."""

from __future__ import annotations

from functools import partial
from pathlib import Path
from typing import Any

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array
from toothspace.geometry.body_section import SolidBody
from toothspace.geometry.chains import chain_closed
from toothspace.geometry.mesh_section import SurfaceMesh, merged
from toothspace.geometry.ocp import silence_ocp

_UNIT = 1e-3
_ANGULAR_DEFLECTION = 0.02
_CHORD_DEFLECTION = 5e-5  # mm
_MESH_DEFLECTION = 0.05  # mm
_MESH_ANGLE = 0.3
_PARALLEL = 1e-9
_JOIN = 1e-7


def step_bodies(path: Path) -> list[SolidBody]:
    """Solids of a STEP file; a damaged file can end the process.

    Parameters
    ----------
    path : Path
        STEP file; its own length unit is used.

    Returns
    -------
    list of SolidBody
        Solids in the order of the file, placed as in the assembly.

    Raises
    ------
    GeometryError
        For a file that cannot be read or holds no solid.
    """
    silence_ocp()
    solids = _named_solids(path)
    if not solids:
        raise GeometryError(f"{path}: found no body, allowed at least one closed body")
    return [
        SolidBody(name, _mesh(solid), partial(_section, str(path), solid)) for name, solid in solids
    ]


def _named_solids(path: Path) -> list[tuple[str, Any]]:
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    document = TDocStd_Document(TCollection_ExtendedString("solids"))
    reader = STEPCAFControl_Reader()
    reader.SetNameMode(True)
    if reader.ReadFile(str(path)) != IFSelect_RetDone or not reader.Transfer(document):
        raise GeometryError(f"{path}: found a damaged STEP file, allowed a complete one")
    shapes = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
    found: list[tuple[str, Any]] = []
    for label in _free_labels(shapes):
        _collect(shapes, label, None, "", found)
    return found


def _free_labels(shapes: Any) -> list[Any]:
    labels = _label_sequence()
    shapes.GetFreeShapes(labels)
    return [labels.Value(k + 1) for k in range(labels.Length())]


def _collect(shapes: Any, label: Any, place: Any, name: str, found: list[tuple[str, Any]]) -> None:
    from OCP.TDF import TDF_Label

    own = _name(label) or name
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


def _name(label: Any) -> str:
    from OCP.TDataStd import TDataStd_Name

    attribute = TDataStd_Name()
    if not label.FindAttribute(TDataStd_Name.GetID_s(), attribute):
        return ""
    return str(attribute.Get().ToExtString())


def _mesh(solid: Any) -> SurfaceMesh:
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
    if not triangles:
        return SurfaceMesh(np.zeros((1, 3)), np.zeros((0, 3), dtype=np.int64))
    return merged(np.concatenate(triangles) * _UNIT, _JOIN)


def _section(file: str, solid: Any, frame: Array, height: float) -> list[Array]:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Section
    from OCP.gp import gp_Dir, gp_Pln, gp_Pnt

    cap = _cap_of_prism(solid, frame[2])
    if cap is None:
        at = frame[2] * height / _UNIT
        plane = gp_Pln(gp_Pnt(*map(float, at)), gp_Dir(*map(float, frame[2])))
        cap = BRepAlgoAPI_Section(solid, plane).Shape()
    pieces = [piece @ frame[:2].T * _UNIT for piece in _edges(cap)]
    return chain_closed(pieces, _JOIN, file)


def _cap_of_prism(solid: Any, axis: Array) -> Any | None:
    # every section of a prism has the outline of its end face, which costs nothing
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_SurfaceType as Kind

    def along(direction: Any) -> float:
        cosine = np.array([direction.X(), direction.Y(), direction.Z()]) @ axis
        return abs(float(cosine))

    caps = []
    for face in _parts(solid, "Face"):
        surface = BRepAdaptor_Surface(face)
        kind = surface.GetType()
        if kind == Kind.GeomAbs_Plane:
            tilt = along(surface.Plane().Axis().Direction())
            caps += [face] if tilt > 1.0 - _PARALLEL else []
            if _PARALLEL < tilt < 1.0 - _PARALLEL:
                return None
        elif kind == Kind.GeomAbs_SurfaceOfExtrusion:
            if along(surface.Direction()) < 1.0 - _PARALLEL:
                return None
        elif kind == Kind.GeomAbs_Cylinder:
            if along(surface.Cylinder().Axis().Direction()) < 1.0 - _PARALLEL:
                return None
        else:
            return None
    return caps[0] if len(caps) == 2 else None


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

    return [_edge_points(BRepAdaptor_Curve(edge)) for edge in _parts(shape, "Edge")]


def _edge_points(curve: Any) -> Array:
    from OCP.GCPnts import GCPnts_TangentialDeflection

    sampler = GCPnts_TangentialDeflection(
        curve, _ANGULAR_DEFLECTION, _CHORD_DEFLECTION, 2, 1e-9, 1e-9
    )
    points = [sampler.Value(index + 1) for index in range(sampler.NbPoints())]
    return np.array([[point.X(), point.Y(), point.Z()] for point in points])
