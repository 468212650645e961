"""Triangulation of plane regions whose inner and outer boundaries are kept as edges."""

from __future__ import annotations

from itertools import pairwise
from typing import NamedTuple, final

import numpy as np
import shapely
from scipy.spatial import Delaunay, cKDTree

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array, BoolArray, IntArray

_SNAP = 1e-6
"""Distance over the edge length at which boundaries are taken as one. [-]"""

_BORDER = 0.62
"""Smallest distance of inner points from the boundary over the edge length. [-]"""

_SMOOTHING = 6
_MAX_SPLITS = 40


@final
class Triangulation(NamedTuple):
    """Triangles of a plane region."""

    points: Array  # (points, 2) [m]
    triangles: IntArray  # (triangles, 3) counter-clockwise


def triangulate(
    regions: list[shapely.Polygon], edge_length: float, chord: float = 0.02
) -> Triangulation:
    """Triangulate the union of regions; the boundary of each region becomes edges.

    Parameters
    ----------
    regions : list of Polygon
        Plane regions; they may overlap or lie inside one another. [m]
    edge_length : float
        Target length of the edges. [m]
    chord : float
        Largest distance of the boundary from its chords over the edge length. [-]

    Returns
    -------
    Triangulation
        Points and counter-clockwise triangles.

    Raises
    ------
    GeometryError
        If the regions are empty or the edges are too long for them.

    Notes
    -----
    Boundary edges are split until the circle over each of them is empty, so that they are edges
    of the Delaunay triangulation; inner points start on a triangular lattice and are smoothed.
    """
    whole = shapely.union_all(regions)
    if whole.is_empty or not edge_length > 0.0:
        raise GeometryError("elastic body", "an empty section", "are closed outlines")
    boundary, edges = _boundary_points(regions, edge_length, chord)
    border = shapely.linestrings(boundary[edges])
    inner = _lattice(whole, shapely.union_all(border), edge_length)
    boundary, edges, inner = _clear_edges(boundary, edges, inner)
    for _ in range(_SMOOTHING if len(inner) else 0):
        inner = _smoothed(boundary, inner)
        _, _, inner = _clear_edges(boundary, edges, inner, split=False)
    points = np.vstack([boundary, inner])
    # triangles whose centre is in the region, counter-clockwise, without slivers
    simplices = Delaunay(points).simplices
    centre = points[simplices].mean(axis=1)
    kept = simplices[shapely.contains_xy(whole, centre[:, 0], centre[:, 1])]
    a, b, c = (points[kept[:, k]] for k in range(3))
    double = (b[:, 0] - a[:, 0]) * (c[:, 1] - a[:, 1]) - (b[:, 1] - a[:, 1]) * (c[:, 0] - a[:, 0])
    kept = np.where(double[:, None] > 0.0, kept, kept[:, [0, 2, 1]])
    longest = np.maximum(np.hypot(*(b - a).T), np.hypot(*(c - a).T))
    triangles = np.asarray(kept[np.abs(double) > 1e-6 * longest**2], dtype=np.int64)
    used, index = np.unique(triangles, return_inverse=True)
    if used.size < 3:
        raise GeometryError(
            "elastic body",
            f"an element size of {edge_length:.3g} m",
            "are sizes that resolve the section",
        )
    return Triangulation(points[used], index.reshape(-1, 3).astype(np.int64))


def _boundary_points(
    regions: list[shapely.Polygon], edge: float, chord: float
) -> tuple[Array, IntArray]:
    """Points on all boundaries and the edges between them."""
    lines = shapely.union_all([r.boundary for r in regions], grid_size=_SNAP * edge)
    pieces = shapely.get_parts(shapely.line_merge(lines))
    pieces = shapely.simplify(pieces, chord * edge, preserve_topology=True)
    points: list[Array] = []
    edges: list[IntArray] = []
    start = 0
    for piece in pieces:
        chain = _resampled(np.asarray(piece.coords)[:, :2], edge)
        count = len(chain)
        points.append(chain)
        first = np.arange(start, start + count - 1)
        edges.append(np.column_stack([first, first + 1]))
        start += count
    return _merged(np.vstack(points), np.vstack(edges).astype(np.int64), 1e-6 * edge)


def _resampled(chain: Array, edge: float) -> Array:
    """Split long segments of a chain into equal parts."""
    out = [chain[:1]]
    for first, last in pairwise(chain):
        count = max(1, int(np.ceil(np.hypot(*(last - first)) / edge - 1e-9)))
        parts = np.linspace(0.0, 1.0, count + 1)[1:, None]
        out.append(first + parts * (last - first))
    return np.vstack(out)


def _merged(points: Array, edges: IntArray, tolerance: float) -> tuple[Array, IntArray]:
    """Join points that coincide."""
    _, first, index = np.unique(
        np.round(points / tolerance).astype(np.int64),
        axis=0,
        return_index=True,
        return_inverse=True,
    )
    joined = np.sort(index.ravel()[edges], axis=1)
    joined = np.unique(joined[joined[:, 0] != joined[:, 1]], axis=0)
    return points[first], joined.astype(np.int64)


def _lattice(whole: shapely.Polygon, border: shapely.Geometry, edge: float) -> Array:
    left, low, right, high = whole.bounds
    rise = edge * np.sqrt(0.75)
    rows = np.arange(low + 0.37 * rise, high, rise)
    x = np.arange(left - edge, right + edge, edge)
    grid = np.array([(u + 0.5 * edge * (k % 2), v) for k, v in enumerate(rows) for u in x])
    if grid.size == 0:
        return np.empty((0, 2))
    grid = grid[shapely.contains_xy(whole, grid[:, 0], grid[:, 1])]
    far = shapely.distance(shapely.points(grid), border) > _BORDER * edge
    return np.asarray(grid[far], dtype=float)


def _clear_edges(
    boundary: Array, edges: IntArray, inner: Array, *, split: bool = True
) -> tuple[Array, IntArray, Array]:
    """Drop inner points from the circles over the edges; split edges near other boundaries."""
    for _ in range(_MAX_SPLITS):
        middle = boundary[edges].mean(axis=1)
        radius = 0.5 * np.hypot(*(boundary[edges[:, 0]] - boundary[edges[:, 1]]).T)
        if len(inner):
            hits = cKDTree(inner).query_ball_point(middle, 1.001 * radius)
            dropped = np.unique(np.concatenate([np.asarray(h, dtype=int) for h in hits]))
            inner = np.delete(inner, dropped, axis=0)
        if not split:
            break
        counts = cKDTree(boundary).query_ball_point(middle, (1.0 - 1e-9) * radius)
        crowded = np.array(
            [bool(set(near) - set(edge)) for near, edge in zip(counts, edges.tolist(), strict=True)]
        )
        if not crowded.any():
            break
        boundary, edges = _split(boundary, edges, crowded)
    return boundary, edges, inner


def _split(boundary: Array, edges: IntArray, chosen: BoolArray) -> tuple[Array, IntArray]:
    middle = boundary[edges[chosen]].mean(axis=1)
    index = len(boundary) + np.arange(len(middle))
    first = np.column_stack([edges[chosen, 0], index])
    second = np.column_stack([index, edges[chosen, 1]])
    return np.vstack([boundary, middle]), np.vstack([edges[~chosen], first, second])


def _smoothed(boundary: Array, inner: Array) -> Array:
    """Move inner points to the mean of their neighbours."""
    points = np.vstack([boundary, inner])
    start, neighbours = Delaunay(points).vertex_neighbor_vertices
    sums = np.add.reduceat(points[neighbours], start[:-1], axis=0)
    mean = sums / np.diff(start)[:, None]
    return np.asarray(mean[len(boundary) :], dtype=float)
