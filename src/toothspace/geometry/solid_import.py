"""Plane sections of solids in STL and STEP files."""

from __future__ import annotations

import struct
from pathlib import Path
from typing import Any

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array
from toothspace.geometry.chains import chain_closed

_STEP_UNIT = 1e-3
_ANGULAR_DEFLECTION = 0.02
_CHORD_DEFLECTION = 5e-5  # mm
_PARALLEL = 1e-9


def section_stl(
    path: Path, unit: float, plane_z: float | None = None, body: int | None = None
) -> list[Array]:
    """Cut the bodies of an STL file with a plane of constant z.

    Parameters
    ----------
    path : Path
        ASCII or binary STL file.
    unit : float
        Length of one unit of the file. [m]
    plane_z : float or None
        Height of the plane; None for the middle of all bodies. [m]
    body : int or None
        Number of one body, largest volume first; None for all.

    Returns
    -------
    list of ndarray
        Closed section curves, points on facet diagonals removed. [m]

    Raises
    ------
    GeometryError
        For truncated files, bodies that are not watertight, a plane outside the bodies.
    """
    import trimesh

    _check_stl(path)
    try:
        mesh = trimesh.load_mesh(path, file_type="stl")
    except Exception as error:
        raise GeometryError(f"{path}: found no readable STL ({error}), allowed STL") from error
    bodies = sorted(
        mesh.split(only_watertight=False, repair=False), key=lambda part: -abs(part.volume)
    )
    chosen = _chosen(path, bodies, body)
    for number, part in enumerate(chosen):
        if not part.is_watertight:
            raise GeometryError(
                f"{path}: found an open surface (body {number} of {len(bodies)} is not "
                f"watertight), allowed closed bodies"
            )
    height = _plane_height(path, [part.bounds[:, 2] * unit for part in chosen], plane_z)
    curves = [curve for part in chosen for curve in _mesh_section(part, height / unit)]
    return [_without_collinear(curve) * unit for curve in curves]


def section_step(path: Path, plane_z: float | None = None, body: int | None = None) -> list[Array]:
    """Cut the solids of a STEP file with a plane of constant z.

    Parameters
    ----------
    path : Path
        STEP file; its own length unit is used.
    plane_z : float or None
        Height of the plane; None for the middle of all solids. [m]
    body : int or None
        Number of one solid, in the order of the file; None for all.

    Returns
    -------
    list of ndarray
        Closed section curves, shape (n, 2). [m]

    Raises
    ------
    GeometryError
        For unreadable files, files without solids, a plane outside the solids, or if the optional
        package for STEP files is missing.
    """
    _require_ocp(path)
    solids = _chosen(path, _step_solids(path), body)
    height = _plane_height(path, [_solid_extent(solid) for solid in solids], plane_z)
    curves: list[Array] = []
    for solid in solids:
        pieces = _step_section(solid, height / _STEP_UNIT)
        curves += chain_closed([piece * _STEP_UNIT for piece in pieces], 1e-7, str(path))
    return curves


def silence_ocp() -> None:
    """Keep the STEP library from writing progress and complaints to standard output."""
    from OCP.Message import Message

    messenger = Message.DefaultMessenger_s()
    for printer in list(messenger.Printers()):
        messenger.RemovePrinter(printer)


def _check_stl(path: Path) -> None:
    raw = path.read_bytes()
    head = raw[:80].lstrip().lower()
    if head.startswith(b"solid") and b"facet" in raw[:2000].lower():
        if b"endsolid" not in raw[-200:].lower():
            raise GeometryError(f"{path}: found a truncated ASCII STL, allowed one with endsolid")
        return
    if len(raw) < 84:
        raise GeometryError(f"{path}: found {len(raw)} bytes, allowed a complete STL file")
    facets = struct.unpack("<I", raw[80:84])[0]
    if len(raw) < 84 + 50 * facets or facets == 0:
        raise GeometryError(
            f"{path}: found {len(raw)} bytes for {facets} facets (truncated STL), allowed "
            f"{84 + 50 * max(facets, 4)} bytes or more"
        )


def _chosen(path: Path, bodies: list[Any], body: int | None) -> list[Any]:
    if not bodies:
        raise GeometryError(f"{path}: found no body, allowed at least one closed body")
    if body is None:
        return bodies
    if not 0 <= body < len(bodies):
        raise GeometryError(f"{path}: found body = {body}, allowed 0 to {len(bodies) - 1}")
    return [bodies[body]]


def _plane_height(path: Path, extents: list[Any], plane_z: float | None) -> float:
    low = float(min(extent[0] for extent in extents))
    high = float(max(extent[1] for extent in extents))
    if plane_z is None:
        return 0.5 * (low + high)
    if not low < plane_z < high:
        raise GeometryError(
            f"{path}: found plane_z = {plane_z * 1e3:.5g} mm, allowed {low * 1e3:.5g} to "
            f"{high * 1e3:.5g} mm"
        )
    return plane_z


def _mesh_section(mesh: Any, height: float) -> list[Array]:
    section = mesh.section(plane_origin=(0.0, 0.0, height), plane_normal=(0.0, 0.0, 1.0))
    if section is None:
        return []
    return [np.asarray(curve)[:, :2] for curve in section.discrete]


def _without_collinear(curve: Array) -> Array:
    import shapely

    tolerance = 1e-7 * float(np.ptp(curve, axis=0).max())
    simple = shapely.simplify(shapely.LinearRing(curve), tolerance)
    return np.asarray(shapely.get_coordinates(simple))[:-1]


def _require_ocp(path: Path) -> None:
    try:
        import OCP.STEPControl  # noqa: F401
    except ImportError as error:
        raise GeometryError(
            f"{path}: found a STEP file but not the package that reads it, allowed after "
            f"pip install 'toothspace[step]'"
        ) from error


def _step_solids(path: Path) -> list[Any]:
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.STEPControl import STEPControl_Reader

    if not path.read_bytes()[:64].lstrip().startswith(b"ISO-10303-21"):
        raise GeometryError(f"{path}: found no STEP header, allowed a file of ISO-10303-21")
    silence_ocp()
    reader = STEPControl_Reader()
    if reader.ReadFile(str(path)) != IFSelect_RetDone or reader.TransferRoots() == 0:
        raise GeometryError(f"{path}: found a damaged STEP file, allowed a complete one")
    return _parts(reader.OneShape(), "Solid")


def _solid_extent(solid: Any) -> tuple[float, float]:
    from OCP.Bnd import Bnd_Box
    from OCP.BRepBndLib import BRepBndLib

    box = Bnd_Box()
    box.SetGap(0.0)
    BRepBndLib.AddOptimal_s(solid, box, False, False)
    return box.CornerMin().Z() * _STEP_UNIT, box.CornerMax().Z() * _STEP_UNIT


def _step_section(solid: Any, height: float) -> list[Array]:
    from OCP.BRepAlgoAPI import BRepAlgoAPI_Section
    from OCP.gp import gp_Dir, gp_Pln, gp_Pnt

    cap = _cap_of_prism(solid)
    if cap is None:
        plane = gp_Pln(gp_Pnt(0.0, 0.0, height), gp_Dir(0.0, 0.0, 1.0))
        cap = BRepAlgoAPI_Section(solid, plane).Shape()
    return _edges(cap)


def _cap_of_prism(solid: Any) -> Any | None:
    # every section of a prism along z has the outline of its end face, which costs nothing
    from OCP.BRepAdaptor import BRepAdaptor_Surface
    from OCP.GeomAbs import GeomAbs_SurfaceType as Kind

    caps = []
    for face in _parts(solid, "Face"):
        surface = BRepAdaptor_Surface(face)
        kind = surface.GetType()
        if kind == Kind.GeomAbs_Plane:
            along = abs(surface.Plane().Axis().Direction().Z())
            caps += [face] if along > 1.0 - _PARALLEL else []
        elif kind == Kind.GeomAbs_SurfaceOfExtrusion:
            along = 1.0 - abs(surface.Direction().Z())
        elif kind == Kind.GeomAbs_Cylinder:
            along = 1.0 - abs(surface.Cylinder().Axis().Direction().Z())
        else:
            return None
        if _PARALLEL < along < 1.0 - _PARALLEL or (kind != Kind.GeomAbs_Plane and along > 0.5):
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
    return np.array([[point.X(), point.Y()] for point in points])
