"""Plane sections with holes as text, DXF, STL and STEP files."""

from __future__ import annotations

import io
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path
from typing import Any, final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.files import write_bytes
from toothspace.core.optional import package_of_extra
from toothspace.core.types import Array
from toothspace.geometry.cad_export import (
    EXPORT_SUFFIXES,
    distinct_in_single_precision,
    face_prism_bytes,
    spline_edge,
)

_MILLIMETRE = 1e-3
_DXF_MILLIMETRES = 4
_CORNER = np.deg2rad(12.0)


@final
@dataclass(frozen=True)
class Section:
    """A plane section of a solid.

    Parameters
    ----------
    boundary : ndarray, shape (n, 2)
        Closed counter-clockwise curve, first point not repeated. [m]
    holes : tuple of ndarray
        Closed counter-clockwise curves inside it. [m]
    """

    boundary: Array
    holes: tuple[Array, ...] = ()

    @property
    def curves(self) -> tuple[Array, ...]:
        """Boundary and holes. [m]."""
        return (self.boundary, *self.holes)


def export_section(section: Section, path: Path, width: float) -> None:
    """Write a section; the format follows the suffix of the file, the unit is the millimetre.

    Parameters
    ----------
    path : Path
        File with suffix ``.txt`` (points of all curves, separated by empty lines), ``.dxf``
        (closed polylines), ``.stl`` or ``.step`` (solid from z = 0 to the width); it is replaced
        in one step when complete.
    width : float
        Height of the solid. [m]

    Raises
    ------
    GeometryError
        For another suffix, or if the optional package for STEP files is missing.
    """
    writers: dict[str, Callable[[], bytes]] = {
        ".txt": lambda: _text_bytes(section),
        ".dxf": lambda: _dxf_bytes(section),
        ".stl": lambda: _stl_bytes(section, width),
        ".step": lambda: _step_bytes(section, width),
    }
    suffix = path.suffix.lower()
    if suffix not in writers:
        raise GeometryError(
            f"{path}: found the suffix {suffix or 'none'!r}, allowed {', '.join(EXPORT_SUFFIXES)}"
        )
    write_bytes(path, writers[suffix]())


def _text_bytes(section: Section) -> bytes:
    stream = io.StringIO()
    for number, curve in enumerate(section.curves):
        closed = np.vstack([curve, curve[:1]]) / _MILLIMETRE
        stream.write("\n" if number else "")
        np.savetxt(stream, closed, fmt="%.9f", header="closed curve, mm\nx y")
    return stream.getvalue().encode()


def _dxf_bytes(section: Section) -> bytes:
    ezdxf = package_of_extra("ezdxf", "cad", "export: found the format 'dxf'")
    drawing = ezdxf.new("R2010")
    drawing.header["$INSUNITS"] = _DXF_MILLIMETRES
    for curve in section.curves:
        drawing.modelspace().add_lwpolyline(
            [(x, y) for x, y in curve / _MILLIMETRE], close=True, dxfattribs={"layer": "ROTOR"}
        )
    stream = io.StringIO()
    drawing.write(stream)
    return stream.getvalue().encode()


def _stl_bytes(section: Section, width: float) -> bytes:
    import shapely

    trimesh = package_of_extra("trimesh", "cad", "export: found the format 'stl'")
    curves = [distinct_in_single_precision(c / _MILLIMETRE) for c in section.curves]
    polygon = shapely.Polygon(curves[0], curves[1:])
    vertices = np.vstack(curves)
    number = {point.tobytes(): index for index, point in enumerate(vertices)}
    triangles = shapely.get_parts(shapely.constrained_delaunay_triangles(polygon))
    corners = shapely.get_coordinates(triangles).reshape(len(triangles), 4, 2)[:, :3]
    indices = np.asarray([[number[c.tobytes()] for c in triangle] for triangle in corners])
    solid = trimesh.creation.extrude_triangulation(vertices, indices, height=width / _MILLIMETRE)
    return bytes(solid.export(file_type="stl"))


def _step_bytes(section: Section, width: float) -> bytes:
    def face() -> Any:
        from OCP.BRepBuilderAPI import BRepBuilderAPI_MakeFace, BRepBuilderAPI_MakeWire

        wires = []
        for number, curve in enumerate(section.curves):
            wire = BRepBuilderAPI_MakeWire()
            for piece in smooth_pieces(curve if number == 0 else curve[::-1]):
                wire.Add(spline_edge(piece, 0.0))
            wires.append(wire.Wire())
        made = BRepBuilderAPI_MakeFace(wires[0], True)
        for hole in wires[1:]:
            made.Add(hole)
        return made.Face()

    with tempfile.TemporaryDirectory() as folder:
        return face_prism_bytes(face, width, Path(folder) / "rotor.step")


def smooth_pieces(curve: Array) -> list[Array]:
    """Cut a closed curve at its corners, or into two halves where it has fewer than two.

    Parameters
    ----------
    curve : ndarray, shape (n, 2)
        Closed curve, first point not repeated. [m]

    Returns
    -------
    list of ndarray
        Pieces; each starts where the previous one ends, the last one ends at the first. [m]
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
