"""Named loads of a body and their consistent nodal forces."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import NamedTuple, final

import numpy as np
import scipy
import shapely

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.elasticity.mesh import SolidMesh
from toothspace.elasticity.surfaces import Side, looks

_TRI_POINTS = np.array([(1 / 6, 1 / 6), (2 / 3, 1 / 6), (1 / 6, 2 / 3)])


class FacePoints(NamedTuple):
    """Quadrature points on outer faces."""

    place: Array  # (k, 3) [m]
    push: Array  # (k, 3) inward normal times area [m2]
    nodes: IntArray  # (k, a) nodes of the face
    shape: Array  # (k, a) their shape functions

    def forces(self, values: Array, nodes: int) -> Array:
        """Nodal forces of a pressure given at the points. [N]."""
        return self.traction(values[:, None] * self.push, nodes)

    def traction(self, vectors: Array, nodes: int) -> Array:
        """Nodal forces of force vectors [N] at the points. [N]."""
        out = np.zeros((nodes, 3))
        np.add.at(out, self.nodes, self.shape[:, :, None] * vectors[:, None, :])
        return out.ravel()


def _quad(point: Array) -> tuple[Array, Array]:
    """Shape functions and slopes of four corners at places s, t between -1 and 1."""
    s, t = point
    values = [(1 - s) * (1 - t), (1 + s) * (1 - t), (1 + s) * (1 + t), (1 - s) * (1 + t)]
    slopes = [(t - 1, 1 - t, 1 + t, -1 - t), (s - 1, -1 - s, 1 + s, 1 - s)]
    return 0.25 * np.array(values), 0.25 * np.array(slopes)


def _tri(point: Array) -> tuple[Array, Array]:
    s, t = point
    r = 1.0 - s - t
    values = np.array(
        [r * (2 * r - 1), s * (2 * s - 1), t * (2 * t - 1), 4 * r * s, 4 * s * t, 4 * t * r]
    )
    along = np.array([1 - 4 * r, 4 * s - 1, 0.0, 4 * (r - s), 4 * t, -4 * t])
    across = np.array([1 - 4 * r, 0.0, 4 * t - 1, -4 * s, 4 * s, 4 * (r - t)])
    return values, np.array([along, across])


def face_points(mesh: SolidMesh, chosen: BoolArray, order: int = 2) -> FacePoints:
    """Quadrature points on chosen outer faces of a mesh.

    Points, areas and shape functions.

    Parameters
    ----------
    mesh : SolidMesh
        Mesh. [m]
    order : int
        Points along each edge of a quadrilateral; a triangle is cut into order squared parts.
    """
    faces = mesh.faces[chosen]
    corners = mesh.nodes[faces]
    quads = faces.shape[1] == 4
    rule = _quad if quads else _tri
    if quads:
        along, size = np.polynomial.legendre.leggauss(order)
        points = np.array([(s, t) for t in along for s in along])
        weights = np.outer(size, size).ravel()
    else:
        # three points in each of the equal parts of a triangle
        parts = order - 1
        steps = range(parts)
        upward = [(i, j, 1.0) for i in steps for j in steps if i + j < parts]
        downward = [(i + 1, j + 1, -1.0) for i in steps for j in steps if i + j < parts - 1]
        thirds = [
            (np.array([i, j]) + sign * _TRI_POINTS) / parts for i, j, sign in upward + downward
        ]
        points = np.vstack(thirds)
        weights = np.full(len(points), 0.5 / len(points))
    place, push, shape = [], [], []
    for point, weight in zip(points, weights, strict=True):
        values, slopes = rule(point)
        along, across = (np.einsum("a,kai->ki", row, corners) for row in slopes)
        place.append(np.einsum("a,kai->ki", values, corners))
        push.append(-weight * np.cross(along, across))
        shape.append(np.tile(values, (len(faces), 1)))
    return FacePoints(
        np.vstack(place), np.vstack(push), np.tile(faces, (len(points), 1)), np.vstack(shape)
    )


@final
@dataclass(frozen=True, eq=False)
class AreaPressure:
    """Unit pressure on the part of the faces that look up or down inside a region."""

    name: str
    """Name of the load."""
    side: Side
    """Which way the loaded faces look."""
    region: shapely.Geometry
    """Region in the x y plane; it need not follow the mesh. A polygon. [m]"""
    per_area: bool = True
    """False: the pressure is scaled to a total force of one newton, as of a spring."""

    def key(self) -> tuple[object, ...]:
        """Everything that defines the load."""
        return ("area", self.name, self.side, shapely.to_wkb(self.region), self.per_area)

    def forces(self, mesh: SolidMesh) -> Array:
        """Nodal forces. [N/Pa] or [N/N]."""
        chosen = np.flatnonzero(looks(mesh, self.side))
        faces = mesh.faces[chosen]
        corners = mesh.nodes[faces[:, : 4 if faces.shape[1] == 4 else 3]]
        cut = shapely.intersection(shapely.polygons(corners[:, :, :2]), self.region)
        area = shapely.area(cut)
        hit = area > 0.0
        if not hit.any():
            raise _missed(self.name)
        centre = shapely.get_coordinates(shapely.centroid(cut[hit]))
        direction = 1.0 if self.side == "bottom" else -1.0
        push = np.zeros((int(hit.sum()), 3))
        push[:, 2] = direction * area[hit]
        quad = corners[hit][:, :, :2]
        if quad.shape[1] == 3:
            origin = quad[:, 0]
            axes = np.stack([quad[:, 1] - origin, quad[:, 2] - origin], axis=2)
            inside = np.linalg.solve(axes, (centre - origin)[:, :, None])[:, :, 0]
            shape = np.column_stack([1.0 - inside.sum(axis=1), inside])
        else:
            local: Array = np.zeros_like(centre)
            for _ in range(6):
                values, slopes = _quad(local.T)
                error = centre - np.einsum("ak,kai->ki", values, quad)
                axes = np.stack([np.einsum("ak,kai->ki", g, quad) for g in slopes], axis=2)
                local = np.asarray(
                    local + np.linalg.solve(axes, error[:, :, None])[:, :, 0], dtype=float
                )
            shape = np.asarray(_quad(local.T)[0].T)
        points = FacePoints(push, push, faces[hit][:, : shape.shape[1]], shape)
        out = points.traction(push, len(mesh.nodes))
        return out if self.per_area else out / area[hit].sum()


def _missed(name: str) -> GeometryError:
    return GeometryError("elastic body", f"no surface under load {name!r}", "are loads on it")


@final
@dataclass(frozen=True, eq=False)
class LateralFaces:
    """Faces that look to the side inside a region and between two levels."""

    region: shapely.Geometry
    """Region in the x y plane that holds their centres. A polygon. [m]"""
    bottom: float = -np.inf
    top: float = np.inf
    """Levels. [m]"""

    def key(self) -> tuple[object, ...]:
        """Everything that defines them."""
        return (shapely.to_wkb(self.region), self.bottom, self.top)

    def points(self, mesh: SolidMesh, name: str) -> FacePoints:
        """Quadrature points of a load of that name."""
        centre, _ = mesh.face_frames()
        chosen = looks(mesh, "lateral") & (centre[:, 2] > self.bottom) & (centre[:, 2] < self.top)
        chosen &= shapely.contains_xy(self.region, centre[:, 0], centre[:, 1])
        if not chosen.any():
            raise _missed(name)
        return face_points(mesh, chosen)


@final
@dataclass(frozen=True, eq=False)
class LateralPressure:
    """Pressure on faces that look to the side."""

    name: str
    """Name of the load."""
    faces: LateralFaces
    """Where it acts."""
    pattern: Callable[[Array], Array] | None = None
    """Pressure at places x, y, z [m] in place of one pascal."""
    label: str = ""
    """Name of the distribution in the cache."""

    def key(self) -> tuple[object, ...]:
        """Everything that defines the load."""
        return ("lateral", self.name, self.faces.key(), self.label)

    def forces(self, mesh: SolidMesh) -> Array:
        """Nodal forces. [N/Pa]."""
        points = self.faces.points(mesh, self.name)
        values = np.ones(len(points.place)) if self.pattern is None else self.pattern(points.place)
        return points.forces(values, len(mesh.nodes))


@final
@dataclass(frozen=True, eq=False)
class AxialTraction:
    """One newton along z, even over faces that look to the side."""

    name: str
    """Name of the load."""
    faces: LateralFaces
    """Where it acts."""

    def key(self) -> tuple[object, ...]:
        """Everything that defines the load."""
        return ("axial", self.name, self.faces.key())

    def forces(self, mesh: SolidMesh) -> Array:
        """Nodal forces. [N/N]."""
        points = self.faces.points(mesh, self.name)
        area = np.linalg.norm(points.push, axis=1)
        along = np.outer(area / area.sum(), [0.0, 0.0, 1.0])
        return points.traction(along, len(mesh.nodes))


Load = AreaPressure | LateralPressure | AxialTraction


def journal_load(
    name: str,
    radius: float,
    levels: tuple[float, float],
    angle: float,
    *,
    center: tuple[float, float] = (0.0, 0.0),
) -> LateralPressure:
    r"""Force of a journal film on a bore or shaft along z.

    Parameters
    ----------
    radius : float
        Radius of the bore or shaft. [m]
    levels : tuple of float
        Ends of the film along z. [m]
    angle : float
        Direction of the pressure's maximum, from x towards y. [rad]
    center : tuple of float
        Place x, y of the axis. [m]

    Returns
    -------
    LateralPressure
        Pressure :math:`\cos(\varphi - \alpha) / (\pi r l)` of a force of one newton on a bore
        along its maximum (on a shaft against it).
    """
    bottom, top = levels
    axis = shapely.Point(*center)
    ring = axis.buffer(1.02 * radius).difference(axis.buffer(0.98 * radius))

    def pattern(place: Array) -> Array:
        turn = np.arctan2(place[:, 1] - center[1], place[:, 0] - center[0])
        return np.asarray(np.cos(turn - angle) / (np.pi * radius * (top - bottom)))

    label = repr(("journal", radius, levels, angle, center))
    return LateralPressure(name, LateralFaces(ring, bottom, top), pattern, label)


def load_columns(mesh: SolidMesh, loads: tuple[Load, ...]) -> scipy.sparse.csc_matrix:
    """Nodal forces of all loads, one column each."""
    if not loads:
        return scipy.sparse.csc_matrix((mesh.unknowns, 0))
    return scipy.sparse.csc_matrix(np.column_stack([load.forces(mesh) for load in loads]))
