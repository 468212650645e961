"""Polygons of casings, ports and relief grooves, checked."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.frozen import Points
from toothspace.core.types import Array
from toothspace.geometry.curve import counter_clockwise, first_self_crossing, without_repeats

_SMALLEST, _LARGEST = 1e-4, 10.0
"""Size of a curve that can belong to a machine. [m]"""


def checked_polygon(points: Array, key: str) -> Array:
    """Check that a closed curve encloses an area without crossing itself.

    Parameters
    ----------
    points : ndarray
        Points of the closed curve, shape (n, 2); the first may be repeated at the end. [m]
    key : str
        Name for error messages.

    Returns
    -------
    ndarray
        Points, counter-clockwise, no point repeated. [m]

    Raises
    ------
    GeometryError
        For fewer than three points, values that are not finite, a self-crossing or no area.
    """
    if points.ndim != 2 or points.shape[1] != 2 or len(points) == 0:
        raise GeometryError(key, "an empty curve", "a closed curve of 3 points")
    if not np.all(np.isfinite(points)):
        raise GeometryError(key, "a coordinate that is not finite", "numbers")
    size = float(np.ptp(points, axis=0).max())
    if not _SMALLEST <= size <= _LARGEST:
        raise GeometryError(
            key,
            f"a curve {size * 1e3:.3g} mm wide",
            f"{_SMALLEST * 1e3:g} to {_LARGEST * 1e3:g} mm (is the unit of the file right?)",
        )
    clean = without_repeats(points)
    if len(clean) < 3:
        raise GeometryError(key, f"{len(clean)} distinct points", "at least 3")
    crossing = first_self_crossing(clean)
    if crossing is not None:
        raise GeometryError(
            key,
            f"a curve that crosses itself at x = {crossing[0] * 1e3:.4g} mm, y = "
            f"{crossing[1] * 1e3:.4g} mm",
            "a simple closed curve",
        )
    return counter_clockwise(clean)


def enclosed(outlines: Sequence[Array]) -> Any:
    """Areas that outlines enclose, also where they touch or cross themselves by rounding.

    Parameters
    ----------
    outlines : sequence of ndarray, shape (n, 2)
        Closed curves. [m]

    Returns
    -------
    ndarray of shapely geometry
        Polygons, several for an outline that is pinched, without loops of the other sense.
    """
    import shapely

    shapes = np.array([shapely.Polygon(outline) for outline in outlines], dtype=object)
    crossed = np.flatnonzero(~shapely.is_valid(shapes))
    given, shapes[crossed] = shapes[crossed], shapely.buffer(shapes[crossed], 0.0)
    # where points coincide but for rounding, the buffer may leave nothing
    lost = shapely.area(shapes[crossed]) < 0.5 * shapely.area(given)
    shapes[crossed[lost]] = shapely.buffer(shapely.make_valid(given[lost]), 0.0)
    return shapes


def load_polygons(path: Path | Points, unit: float) -> list[Array]:
    """Read the closed curves of a DXF or text file as polygons.

    Parameters
    ----------
    path : Path or Points
        File with suffix ``.dxf``, ``.txt`` or ``.csv``, or points in place of one.
    unit : float
        Length of one unit of the file. [m]

    Returns
    -------
    list of ndarray
        Polygons, counter-clockwise, largest first. [m]

    Raises
    ------
    GeometryError
        As ``checked_polygon`` and ``load_closed_curves``.
    """
    from toothspace.geometry.cad_import import load_closed_curves

    curves = load_closed_curves(path, unit)
    return [checked_polygon(curve, path.name) for curve in curves]
