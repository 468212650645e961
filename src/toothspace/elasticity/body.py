"""Definition of an elastic body: shape, material, film surfaces, loads, support."""

from __future__ import annotations

import hashlib
from dataclasses import dataclass
from typing import Protocol, final

import numpy as np
import scipy
import shapely

from toothspace.core.types import BoolArray, IntArray
from toothspace.elasticity.mesh import Prism, SolidMesh, sweep
from toothspace.elasticity.surface_loads import Load, face_points
from toothspace.elasticity.surfaces import FilmSurface, Side, looks


class Shape(Protocol):
    """Anything that can be meshed."""

    @property
    def label(self) -> str:
        """What the body is called in messages."""
        ...

    def mesh(self, scale: float) -> SolidMesh:
        """Mesh whose elements are larger by a factor."""
        ...

    def key(self) -> tuple[object, ...]:
        """Everything that defines the shape."""
        ...


@final
@dataclass(frozen=True, eq=False)
class SweptShape:
    """Body of prisms along z."""

    parts: tuple[Prism, ...]
    """Parts; where they touch they are one."""
    edge_length: float
    """Edge of the plane triangles, each cut into three quadrilaterals. [m]"""
    layer_height: float
    """Largest height of a layer of elements. [m]"""

    @property
    def label(self) -> str:
        """What the body is called in messages."""
        return "elastic body"

    def mesh(self, scale: float = 1.0) -> SolidMesh:
        """Hexahedra; elements larger by a factor."""
        return sweep(self.parts, scale * self.edge_length, scale * self.layer_height)

    def key(self) -> tuple[object, ...]:
        """Everything that defines the shape."""
        parts = tuple((shapely.to_wkb(p.section), p.bottom, p.top) for p in self.parts)
        return ("swept", parts, self.edge_length, self.layer_height)


@final
@dataclass(frozen=True, eq=False)
class Support:
    """Faces that rest on a foundation."""

    side: Side
    """Which way the faces look."""
    region: shapely.Geometry
    """Region in the x y plane that holds the centres of the faces. [m]"""
    normal_stiffness: float = np.inf
    """Pressure per displacement along the normal; infinite holds it. [Pa/m]"""
    tangential_stiffness: float = np.inf
    """Shear stress per displacement across the normal; infinite holds it. [Pa/m]"""

    def key(self) -> tuple[object, ...]:
        """Everything that defines the support."""
        stiffness = (self.normal_stiffness, self.tangential_stiffness)
        return ("support", self.side, shapely.to_wkb(self.region), stiffness)

    def faces(self, mesh: SolidMesh) -> BoolArray:
        """Faces of a mesh that rest on the foundation."""
        centre, _ = mesh.face_frames()
        return looks(mesh, self.side) & shapely.contains_xy(self.region, *centre[:, :2].T)

    def springs(self, mesh: SolidMesh) -> scipy.sparse.csr_matrix:
        """Stiffness of the foundation, without held directions. [N/m]."""
        points = face_points(mesh, self.faces(mesh))
        area = np.linalg.norm(points.push, axis=1)
        normal = points.push / area[:, None]
        along = self.normal_stiffness if np.isfinite(self.normal_stiffness) else 0.0
        across = self.tangential_stiffness if np.isfinite(self.tangential_stiffness) else 0.0
        outer = normal[:, :, None] * normal[:, None, :]
        law = area[:, None, None] * (across * np.eye(3) + (along - across) * outer)
        block = np.einsum("ka,kij,kb->kaibj", points.shape, law, points.shape)
        unknown = 3 * points.nodes[:, :, None] + np.arange(3)
        rows = np.broadcast_to(unknown[:, :, :, None, None], block.shape)
        columns = np.broadcast_to(unknown[:, None, None, :, :], block.shape)
        entries = (block.ravel(), (rows.ravel(), columns.ravel()))
        return scipy.sparse.csr_matrix(entries, shape=(mesh.unknowns, mesh.unknowns))

    def held(self, mesh: SolidMesh) -> IntArray:
        """Unknowns that the foundation holds; on inclined faces all directions are held."""
        nodes = np.unique(mesh.faces[self.faces(mesh)])
        normal, across = np.isinf(self.normal_stiffness), np.isinf(self.tangential_stiffness)
        if self.side == "lateral":
            directions = [0, 1, 2] if normal else []
        else:
            directions = [2] * bool(normal) + [0, 1] * bool(across)
        unknowns = 3 * nodes[:, None] + np.asarray(directions, dtype=np.int64)
        return np.asarray(unknowns.ravel(), dtype=np.int64)


@final
@dataclass(frozen=True, eq=False)
class ElasticBody:
    """Linear elastic body with film surfaces."""

    shape: Shape
    """Shape and element size."""
    elastic_modulus: float
    """Young's modulus. [Pa]"""
    poisson_ratio: float
    """Poisson's ratio. [-]"""
    density: float
    """Density. [kg/m3]"""
    films: tuple[FilmSurface, ...]
    """Surfaces on which films press."""
    loads: tuple[Load, ...] = ()
    """Named further loads."""
    supports: tuple[Support, ...] = ()
    """Foundations; none leaves the body floating."""

    @property
    def floating(self) -> bool:
        """Whether nothing supports the body."""
        return not self.supports

    def hash(self) -> str:
        """Short hash of everything that defines the body."""
        material = (self.elastic_modulus, self.poisson_ratio, self.density)
        pieces = (*self.films, *self.loads, *self.supports)
        text = repr((self.shape.key(), material, tuple(piece.key() for piece in pieces)))
        return hashlib.sha256(text.encode()).hexdigest()[:24]
