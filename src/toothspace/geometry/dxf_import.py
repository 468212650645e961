"""Closed curves from DXF drawings."""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.optional import package_of_extra
from toothspace.core.types import Array
from toothspace.geometry.chains import chain_closed

_CURVES = ("LINE", "ARC", "CIRCLE", "ELLIPSE", "SPLINE", "LWPOLYLINE", "POLYLINE")
_RELATIVE_SAGITTA = 1e-6
_RELATIVE_GAP = 1e-5


def read_dxf(path: Path, unit: float, layer: str | None = None) -> list[Array]:
    """Read the closed curves of a drawing's model space.

    Parameters
    ----------
    unit : float
        Length of one unit of the drawing. [m]
    layer : str or None
        Layer to read; None for all.

    Returns
    -------
    list of ndarray
        Curves, shape (n, 2): closed polylines with bulges, splines, circles, ellipses, and chains
        of lines, arcs and open pieces that meet within 1e-5 of the drawing's size. [m]

    Raises
    ------
    GeometryError
        For damaged files, open curves, unknown layers and drawings without curves.
    """
    ezdxf = package_of_extra("ezdxf", "cad", f"{path}: found a DXF file")
    try:
        drawing = ezdxf.readfile(path)
    except (OSError, ezdxf.DXFError) as error:
        reason = " ".join(str(error).split())
        raise GeometryError(path, f"no readable DXF ({reason})", "DXF") from error
    found = [entity for entity in drawing.modelspace() if layer in (None, entity.dxf.layer)]
    entities = [entity for entity in found if entity.dxftype() in _CURVES]
    if not entities:
        kinds = ", ".join(sorted({entity.dxftype() for entity in found})) or "nothing"
        layers = ", ".join(sorted({entity.dxf.layer for entity in drawing.modelspace()}))
        raise GeometryError(
            path,
            f"{kinds} on {('all layers' if layer is None else f'layer {layer!r}')} (layers: "
            f"{layers or 'none'})",
            ", ".join(_CURVES),
        )
    from ezdxf import bbox

    extents = bbox.extents(entities, fast=True)
    size = float(extents.size.magnitude) if extents.has_data else 1.0
    pieces = [_flattened(entity, size * _RELATIVE_SAGITTA, path) for entity in entities]
    pieces = [piece * unit for piece in pieces if len(piece) >= 2]
    return chain_closed(pieces, size * _RELATIVE_GAP * unit, str(path))


def _flattened(entity: Any, sagitta: float, path: Path) -> Array:
    if entity.dxftype() in ("LWPOLYLINE", "POLYLINE"):
        # lines and arcs are flattened one by one, so that bulges stay true arcs
        pieces = [_flattened(part, sagitta, path) for part in entity.virtual_entities()]
        pieces = [piece for piece in pieces if np.ptp(piece, axis=0).max() > 0.0]
        if not pieces:
            return np.zeros((0, 2))
        joined = [pieces[0] if _ends_at(pieces, 0) else pieces[0][::-1]]
        for piece in pieces[1:]:
            ahead = np.hypot(*(piece[0] - joined[-1][-1])) <= np.hypot(
                *(piece[-1] - joined[-1][-1])
            )
            joined.append((piece if ahead else piece[::-1])[1:])
        return np.vstack(joined)
    if entity.dxftype() == "LINE":
        vertices = [entity.dxf.start, entity.dxf.end]
    else:
        vertices = list(entity.flattening(sagitta))
    points = np.array([[vertex.x, vertex.y] for vertex in vertices])
    if not np.all(np.isfinite(points)):
        kind = entity.dxftype()
        raise GeometryError(path, f"a {kind} that is not finite", "numbers")
    return points


def _ends_at(pieces: list[Array], index: int) -> bool:
    # an arc of negative bulge comes out reversed; its neighbour tells
    if len(pieces) == 1:
        return True
    ends = pieces[index + 1][[0, -1]]
    gap_end = np.min(np.hypot(*(ends - pieces[index][-1]).T))
    gap_start = np.min(np.hypot(*(ends - pieces[index][0]).T))
    return bool(gap_end <= gap_start)
