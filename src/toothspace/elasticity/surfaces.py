r"""Film surfaces of a body: coarse nodes, their hat functions and the interpolation to cells.

A pressure enters as nodal loads :math:`\lambda_i = \int \phi_i p\,\mathrm dA`, displacements
leave as nodal values :math:`u = \sum_i u_i \phi_i`. Loads of a film are gathered with the
transpose of the interpolation that spreads the displacements, so work is conserved.
"""

from __future__ import annotations

from dataclasses import dataclass, field
from functools import cached_property
from typing import Literal, NamedTuple, final

import numpy as np
import scipy
import shapely

from toothspace.core.compiled import njit
from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.elasticity.mesh import SolidMesh, Triangulation, triangulate

Side = Literal["top", "bottom", "lateral"]

_CHORD = 0.06
"""Largest distance of the boundary from the chords between nodes over their spacing. [-]"""

_ON_RADIUS = 0.005
"""Distance over the radius up to which a face belongs to a cylinder. [-]"""

_COVERED = 0.1
"""Part of a plane surface that the faces of a body may leave or have too much. [-]"""

_OFF = 0.01
"""Distance of the faces from their level over the root of their area. [-]"""

_NEAREST = 12
"""Triangles that are tried for a point."""


def looks(mesh: SolidMesh, side: Side) -> BoolArray:
    """Which outer faces look up, down or to the side."""
    _, normal = mesh.face_frames()
    up = normal[:, 2] / np.linalg.norm(normal, axis=1)
    if side == "lateral":
        return np.asarray(np.abs(up) < 0.5)
    return np.asarray(up > 0.5 if side == "top" else up < -0.5)


@final
@dataclass(frozen=True, eq=False)
class PlaneSurface:
    """Film surface across the z axis: all faces that look one way within a region."""

    name: str
    """Name of the surface."""
    side: Side
    """Which way the surface looks."""
    region: shapely.Polygon
    """Outline with holes in the x y plane. [m]"""
    node_spacing: float
    """Distance of the nodes. [m]"""
    level: float | None = None
    """Where most of the surface must stand along z; None: anywhere. [m]"""

    @cached_property
    def _plane(self) -> Triangulation:
        return triangulate([self.region], self.node_spacing, _CHORD)

    @cached_property
    def _finder(self) -> _Finder:
        return _finder(self._plane)

    @property
    def nodes(self) -> Array:
        """Places x, y of the nodes. [m]."""
        return self._plane.points

    def key(self) -> tuple[object, ...]:
        """Everything that defines the surface."""
        return ("plane", self.name, self.side, shapely.to_wkb(self.region), self.node_spacing)

    def select(self, mesh: SolidMesh) -> BoolArray:
        """Faces of a mesh that belong to the surface."""
        centre, _ = mesh.face_frames()
        inside = shapely.contains_xy(self.region, centre[:, 0], centre[:, 1])
        return np.asarray(inside & looks(mesh, self.side))

    def mismatch(self, mesh: SolidMesh) -> str:
        """How the faces of a mesh differ from a surface with a level; empty if they match."""
        if self.level is None:
            return ""
        centre, normal = mesh.face_frames()
        chosen = self.select(mesh)
        if not chosen.any():
            return f"no plane face that looks to the {self.side} under film {self.name!r}"
        area = np.abs(normal[chosen, 2])
        share = float(area.sum() / self.region.area)
        if abs(share - 1.0) > _COVERED:
            return f"faces on {share:.0%} of film {self.name!r}"
        order = np.argsort(centre[chosen, 2])
        middle = int(np.searchsorted(np.cumsum(area[order]), 0.5 * area.sum()))
        level = float(centre[chosen, 2][order][middle])
        if abs(level - self.level) > _OFF * np.sqrt(self.region.area):
            return f"film {self.name!r} at z = {1e3 * level:.4g} mm"
        return ""

    def interpolation(self, points: Array) -> scipy.sparse.csr_matrix:
        """Matrix from nodal values to values at points on the body.

        Parameters
        ----------
        points : ndarray, shape (k, 2) or (k, 3)
            Places in the frame of the body; z is ignored. [m]

        Returns
        -------
        csr_matrix, shape (k, nodes)
            Hat functions; a point outside takes the plane of the nearest triangle.
        """
        at = np.asarray(points, dtype=float)[:, :2]
        tree, origin, inverse = self._finder
        count = len(self._plane.triangles)
        chosen, weight = np.zeros(len(at), dtype=np.int64), np.zeros((len(at), 3))
        left = np.arange(len(at))
        # most points lie in one of the two nearest triangles, which are found faster
        for near in (min(2, count), min(_NEAREST, count)):
            tried = tree.query(at[left], k=near)[1].reshape(left.size, near)
            held = np.zeros(left.size, dtype=np.bool_)
            _place(at, left, tried, origin, inverse, chosen, weight, held)
            left = left[~held]
        return _rows(self._plane.triangles[chosen], weight, len(self._plane.points))


class _Finder(NamedTuple):
    """Triangles by their middles, with first corners and the inverse of their edges."""

    middles: scipy.spatial.cKDTree
    origin: Array
    inverse: Array


def _finder(plane: Triangulation) -> _Finder:
    corners = plane.points[plane.triangles]
    origin = np.ascontiguousarray(corners[:, 0])
    edges = np.stack([corners[:, 1] - origin, corners[:, 2] - origin], axis=2)
    inverse: Array = np.asarray(np.linalg.inv(edges), dtype=np.float64)
    return _Finder(scipy.spatial.cKDTree(corners.mean(axis=1)), origin, inverse)


@njit(nogil=True)
def _place(
    points: Array,
    wanted: IntArray,
    tried: IntArray,
    origin: Array,
    inverse: Array,
    chosen: IntArray,
    weight: Array,
    held: BoolArray,
) -> None:
    """Triangle and hat functions of the wanted points; whether a tried triangle holds them."""
    for n in range(wanted.size):
        k, best = wanted[n], -np.inf
        for t in tried[n]:
            x, y = points[k, 0] - origin[t, 0], points[k, 1] - origin[t, 1]
            second = inverse[t, 0, 0] * x + inverse[t, 0, 1] * y
            third = inverse[t, 1, 0] * x + inverse[t, 1, 1] * y
            first = 1.0 - second - third
            inside = min(first, second, third)
            if inside > best:
                best, chosen[k] = inside, t
                weight[k, 0], weight[k, 1], weight[k, 2] = first, second, third
            if best >= 0.0:
                held[n] = True
                break


def _rows(columns: IntArray, weights: Array, count: int) -> scipy.sparse.csr_matrix:
    rows = np.repeat(np.arange(len(columns)), columns.shape[1])
    entries = (weights.ravel(), (rows, columns.ravel()))
    return scipy.sparse.csr_matrix(entries, shape=(len(columns), count))


@final
@dataclass(frozen=True, eq=False)
class CylinderSurface:
    """Film surface round an axis along z: a bore or a shaft."""

    name: str
    """Name of the surface."""
    radius: float
    """Radius. [m]"""
    bottom: float
    top: float
    """Levels between which the surface lies. [m]"""
    grid: tuple[int, int]
    """Nodes round the circumference and along the axis. [-]"""
    center: tuple[float, float] = (0.0, 0.0)
    """Place x, y of the axis. [m]"""
    side: Side = field(default="lateral", init=False)

    @property
    def nodes(self) -> Array:
        """Angle [rad] and level z [m] of the nodes."""
        angle = 2.0 * np.pi * np.arange(self.grid[0]) / self.grid[0]
        level = np.linspace(self.bottom, self.top, self.grid[1])
        return np.column_stack([np.repeat(angle, level.size), np.tile(level, angle.size)])

    def key(self) -> tuple[object, ...]:
        """Everything that defines the surface."""
        return ("cylinder", self.name, self.radius, self.bottom, self.top, self.grid, self.center)

    def select(self, mesh: SolidMesh) -> BoolArray:
        """Faces of a mesh that belong to the surface."""
        centre, normal = mesh.face_frames()
        p = mesh.nodes[mesh.faces]
        radii = np.hypot(p[:, :, 0] - self.center[0], p[:, :, 1] - self.center[1])
        on = np.abs(radii.max(axis=1) / self.radius - 1.0) < _ON_RADIUS
        outward = centre[:, :2] - np.asarray(self.center)
        along = np.abs((outward * normal[:, :2]).sum(axis=1))
        on &= along > 0.7 * np.hypot(*outward.T) * np.hypot(*normal[:, :2].T)
        between = (centre[:, 2] > self.bottom) & (centre[:, 2] < self.top)
        return np.asarray(on & between & looks(mesh, "lateral"))

    def interpolation(self, points: Array) -> scipy.sparse.csr_matrix:
        """Matrix from nodal values to values at points on the body, as for a plane.

        Parameters
        ----------
        points : ndarray, shape (k, 3)
            Places in the frame of the body. [m]
        """
        points = np.asarray(points, dtype=float)
        angle = np.arctan2(points[:, 1] - self.center[1], points[:, 0] - self.center[0])
        level = points[:, 2]
        count, lanes = self.grid
        turn = np.mod(angle / (2.0 * np.pi), 1.0) * count
        rise = (level - self.bottom) / (self.top - self.bottom) * (lanes - 1)
        i = np.minimum(np.floor(turn).astype(int), count - 1)
        j = np.clip(np.floor(rise).astype(int), 0, lanes - 2)
        a, b = turn - i, rise - j
        after = (i + 1) % count
        columns = [i * lanes + j, after * lanes + j, i * lanes + j + 1, after * lanes + j + 1]
        weights = [(1 - a) * (1 - b), a * (1 - b), (1 - a) * b, a * b]
        return _rows(np.column_stack(columns), np.column_stack(weights), count * lanes)


FilmSurface = PlaneSurface | CylinderSurface
