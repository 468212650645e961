"""Influence matrix of a body: deformation of its film surfaces by films and named loads."""

from __future__ import annotations

import hashlib
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import cache
from pathlib import Path
from typing import NamedTuple, final

import numpy as np
import scipy

from toothspace.core.compiled import cache_root
from toothspace.core.errors import GeometryError
from toothspace.core.files import load_arrays, save_arrays
from toothspace.core.progress import UNKNOWN, report_share
from toothspace.core.types import Array, IntArray
from toothspace.elasticity.body import ElasticBody
from toothspace.elasticity.condensation import flexibility
from toothspace.elasticity.elements import nodal_masses, stiffness_matrix
from toothspace.elasticity.mesh import SolidMesh
from toothspace.elasticity.surface_loads import face_points, load_columns
from toothspace.elasticity.surfaces import PlaneSurface


@final
@dataclass(frozen=True, eq=False)
class InfluenceMatrix:
    r"""Deformation of film surfaces per load.

    Displacements are those of the surface into the body, so they open the film; pressures press
    into the body. Those of a floating body are relative to its motion as a rigid body.

    Notes
    -----
    :math:`u = C \lambda + \sum_k D_k q_k` with nodal loads
    :math:`\lambda_i = \int \phi_i p\,\mathrm dA`. :math:`C` is symmetric and positive
    semidefinite.
    """

    body: ElasticBody = field(repr=False)
    """What was condensed."""
    nodes: Array = field(repr=False)
    """Places of the nodes on their surfaces, shape (n, 2). [m], or [rad] and [m]"""
    surface: IntArray = field(repr=False)
    """Index of the film surface that a node belongs to, shape (n,)."""
    compliance: Array = field(repr=False)
    """C, shape (n, n). [m/N]"""
    load_cases: dict[str, Array] = field(repr=False)
    """D, deformation per unit of each named load, shape (n,). [m/Pa] or [m/N]"""
    resultants: dict[str, Array] = field(repr=False)
    """Force and moment about the centre of mass of each unit load. [N, N m per unit]"""
    rigid_modes: Array = field(repr=False)
    """Displacement by unit translations along and rotations about x, y, z, shape (n, 6). [-, m]"""
    mass: float
    """Mass. [kg]"""
    center_of_mass: Array
    """Centre of mass. [m]"""
    element_count: int
    """Elements of the mesh. [-]"""
    error_estimate: float
    """Largest error of the deformation over its span, from a coarser mesh; NaN if not asked. [-]"""

    def of(self, surface: str) -> slice:
        """Nodes of a film surface, by its name."""
        names = [film.name for film in self.body.films]
        if surface not in names:
            raise GeometryError("elastic body", f"surface {surface!r}", f"are {names}")
        place = np.flatnonzero(self.surface == names.index(surface))
        return slice(int(place[0]), int(place[-1]) + 1)

    def interpolation(self, surface: str, points: Array) -> scipy.sparse.csr_matrix:
        """Matrix from the nodes of a surface to points on it; its transpose gathers loads.

        Parameters
        ----------
        points : ndarray, shape (k, 2) or (k, 3)
            Places in the frame of the body. [m]
        """
        names = [film.name for film in self.body.films]
        self.of(surface)
        return self.body.films[names.index(surface)].interpolation(points)

    def deformation(self, nodal_loads: Array, loads: Mapping[str, float] | None = None) -> Array:
        """Displacement of the nodes into the body. [m].

        Parameters
        ----------
        nodal_loads : ndarray, shape (n,)
            Loads of the films at the nodes. [N]
        loads : mapping of str to float, optional
            Size of named loads. [Pa] or [N]
        """
        out = self.compliance @ nodal_loads
        for name, size in (loads or {}).items():
            out = out + size * self.load_cases[name]
        return np.asarray(out)

    def resultant(self, nodal_loads: Array, loads: Mapping[str, float] | None = None) -> Array:
        """Force and moment about the centre of mass of film loads and named loads. [N, N m]."""
        out = self.rigid_modes.T @ nodal_loads
        for name, size in (loads or {}).items():
            out = out + size * self.resultants[name]
        return np.asarray(out)


COARSER = 1.5
"""Size of the elements of the mesh that the error is estimated with, over that of the body. [-]"""


_FILM_ORDER = 4
"""Quadrature points along the edge of a face of a film surface."""

_WORST_GRAM = 0.12
"""Smallest eigenvalue of the scaled products of hat functions. [-]

Well resolved, it is 0.5 on triangles and 0.25 on quadrilaterals.
"""


class _Columns(NamedTuple):
    # film loads per unit pressure coefficient, named loads, mass matrix of the hat functions
    films: scipy.sparse.csc_matrix
    named: scipy.sparse.csc_matrix
    gram: list[Array]


def influence_matrix(
    body: ElasticBody, *, estimate_error: bool = True, cache: bool = True, scale: float = 1.0
) -> InfluenceMatrix:
    r"""Condense a body to its film surfaces.

    Parameters
    ----------
    estimate_error : bool
        Whether to condense a coarser mesh as well.
    cache : bool
        Whether to look in the cache folder first and to store the result there.
    scale : float
        Factor on the size of the elements; the film nodes stay. [-]

    Raises
    ------
    GeometryError
        If the body cannot be meshed, is not held, or a load misses it.

    Notes
    -----
    A floating body accelerates under loads out of balance: every load is complemented by the
    inertia of its rigid acceleration (inertia relief), and the displacement is orthogonal to the
    rigid modes in the mass inner product. With rigid modes :math:`R`, nodal masses :math:`M`
    and :math:`\Pi = 1 - M R (R^T M R)^{-1} R^T` the flexibility is
    :math:`\Pi^T K^+ \Pi`; its null space are the loads :math:`M R`.
    """
    name = f"{body.hash()}-{'estimated' if estimate_error else 'plain'}"
    name += f"-{scale:.4f}" if scale != 1.0 else ""
    stored = load_arrays(_path(name)) if cache else None
    if stored is not None:
        names = [entry.name for entry in body.loads]
        return InfluenceMatrix(
            body=body,
            **{key: stored[key] for key in _ARRAYS},
            load_cases=dict(zip(names, stored["load_cases"], strict=True)),
            resultants=dict(zip(names, stored["resultants"], strict=True)),
            mass=float(stored["mass"]),
            element_count=int(stored["element_count"]),
            error_estimate=float(stored["error_estimate"]),
        )
    report_share(
        UNKNOWN, f"elastic body ({', '.join(film.name for film in body.films)}), kept for later"
    )
    try:
        result = _condensed(body, scale)
        if estimate_error:
            coarse = _condensed(body, scale * COARSER)
            # largest change of the deformation by smooth pressures and named loads over its span
            worst = 0.0
            for a, b in zip(_probes(result), _probes(coarse), strict=True):
                span = float(np.ptp(a))
                if span > 0.0:
                    worst = max(worst, float(np.abs(a - b).max()) / span)
            gap = worst / (COARSER**2 - 1.0)
            result = replace(result, error_estimate=gap)
    except GeometryError as error:
        # a body of a file is called by its file
        raise error.changed(lambda one: one._replace(key=body.shape.label)) from error
    if cache:
        content: dict[str, Array] = {key: getattr(result, key) for key in _ARRAYS}
        for key in ("load_cases", "resultants"):
            content[key] = np.array(list(getattr(result, key).values()))
        for key in ("mass", "element_count", "error_estimate"):
            content[key] = np.asarray(getattr(result, key))
        save_arrays(_path(name), content)
    return result


def _condensed(body: ElasticBody, scale: float) -> InfluenceMatrix:
    mesh = body.shape.mesh(scale)
    for film in body.films:
        wrong = film.mismatch(mesh) if isinstance(film, PlaneSurface) else ""
        if wrong:
            raise GeometryError("elastic body", wrong, "the face of the case there")
    films, gram = [], []
    for film in body.films:
        points = face_points(mesh, film.select(mesh), _FILM_ORDER)
        hats = film.interpolation(points.place)
        nodes_of, width = points.nodes.shape
        rows = 3 * points.nodes[:, :, None] + np.arange(3)
        values = points.shape[:, :, None] * points.push[:, None, :]
        index = np.repeat(np.arange(nodes_of), 3 * width)
        spread = scipy.sparse.csr_matrix(
            (values.ravel(), (rows.ravel(), index)), shape=(mesh.unknowns, nodes_of)
        )
        area = scipy.sparse.diags(np.linalg.norm(points.push, axis=1))
        matrix = (hats.T @ area @ hats).toarray()
        size = 1.0 / np.sqrt(np.maximum(np.diag(matrix), 1e-300))
        if np.linalg.eigvalsh(matrix * np.outer(size, size))[0] < _WORST_GRAM:
            raise GeometryError(
                "elastic body",
                f"nodes of film {film.name!r} without elements",
                "are node spacings above the element size",
            )
        forces = (spread @ hats).tocsc()
        films.append(forces)
        gram.append(matrix)
    columns = _Columns(scipy.sparse.hstack(films).tocsc(), load_columns(mesh, body.loads), gram)
    masses = np.repeat(nodal_masses(mesh, body.density), 3)
    mass = float(masses[::3].sum())
    center = np.asarray(masses[::3] @ mesh.nodes / mass)
    # unit translations and rotations, one column each
    x, y, z = (mesh.nodes - center).T
    zero, one = np.zeros_like(x), np.ones_like(x)
    motions = [
        (one, zero, zero),
        (zero, one, zero),
        (zero, zero, one),
        (zero, -z, y),
        (z, zero, -x),
        (-y, x, zero),
    ]
    rigid = np.column_stack([np.column_stack(c).ravel() for c in motions])
    stiffness = stiffness_matrix(mesh, body.elastic_modulus, body.poisson_ratio)
    loads = scipy.sparse.hstack([columns.films, columns.named]).tocsc()
    if body.floating:
        work = _relieved(stiffness, mesh, loads, (masses, rigid))
    else:
        stiffness, held = _supported(body, mesh, stiffness)
        work = flexibility(stiffness, mesh.nodes, loads, held)
    # from work per pressure coefficient to nodal values per nodal load
    totals = (mass, center, len(mesh.elements))
    count = columns.films.shape[1]
    half = _solved(columns.gram, work[:count, :count])
    compliance = _solved(columns.gram, half.T)
    shapes = _solved(columns.gram, work[:count, count:])
    names = [load.name for load in body.loads]
    sizes = [len(matrix) for matrix in columns.gram]
    return InfluenceMatrix(
        body=body,
        nodes=np.vstack([film.nodes for film in body.films]),
        surface=np.repeat(np.arange(len(sizes)), sizes).astype(np.int64),
        compliance=0.5 * (compliance + compliance.T),
        load_cases=dict(zip(names, shapes.T, strict=True)),
        resultants=dict(zip(names, np.asarray(columns.named.T @ rigid), strict=True)),
        rigid_modes=_solved(columns.gram, np.asarray(columns.films.T @ rigid)),
        mass=totals[0],
        center_of_mass=totals[1],
        element_count=totals[2],
        error_estimate=float("nan"),
    )


def _relieved(
    stiffness: scipy.sparse.csr_matrix,
    mesh: SolidMesh,
    loads: scipy.sparse.csc_matrix,
    inertia: tuple[Array, Array],
) -> Array:
    """Flexibility of a floating body; see :func:`influence_matrix`."""
    masses, rigid = inertia
    inert = masses[:, None] * rigid
    extended = scipy.sparse.hstack([loads, scipy.sparse.csc_matrix(inert)]).tocsc()
    # six unknowns that hold a body without straining it
    first = int(np.argmin(mesh.nodes.sum(axis=1)))
    away = mesh.nodes - mesh.nodes[first]
    second = int(np.argmax(np.linalg.norm(away, axis=1)))
    axis = away[second] / np.linalg.norm(away[second])
    third = int(np.argmax(np.linalg.norm(np.cross(away, axis), axis=1)))
    normal = np.cross(axis, away[third])
    # hold the second across the longest part of its offset, the third along the plane's normal
    held = [3 * first, 3 * first + 1, 3 * first + 2]
    along = int(np.argmax(np.abs(axis)))
    held += [3 * second + k for k in range(3) if k != along]
    held.append(3 * third + int(np.argmax(np.abs(normal))))
    work = flexibility(stiffness, mesh.nodes, extended, np.array(held, dtype=np.int64))
    share = -np.linalg.solve(rigid.T @ inert, np.asarray(loads.T @ rigid).T)
    count = loads.shape[1]
    own, mixed, inner = work[:count, :count], work[:count, count:], work[count:, count:]
    out = own + mixed @ share
    out = out + share.T @ (mixed.T + inner @ share)
    return np.asarray(0.5 * (out + out.T))


def _supported(
    body: ElasticBody, mesh: SolidMesh, stiffness: scipy.sparse.csr_matrix
) -> tuple[scipy.sparse.csr_matrix, IntArray]:
    held: list[IntArray] = []
    for support in body.supports:
        if not support.faces(mesh).any():
            raise GeometryError("elastic body", "a support without faces", "are faces")
        stiffness = stiffness + support.springs(mesh)
        held.append(support.held(mesh))
    return stiffness.tocsr(), np.unique(np.concatenate(held)).astype(np.int64)


def _solved(gram: list[Array], values: Array) -> Array:
    """Divide by the block diagonal matrix of the hat functions' products."""
    out, start = np.empty_like(values), 0
    for matrix in gram:
        stop = start + len(matrix)
        out[start:stop] = scipy.linalg.cho_solve(
            scipy.linalg.cho_factor(matrix), values[start:stop]
        )
        start = stop
    return out


def _probes(matrix: InfluenceMatrix) -> list[Array]:
    out = list(matrix.load_cases.values())
    for index in range(len(matrix.body.films)):
        own = np.flatnonzero(matrix.surface == index)
        place = matrix.nodes[own]
        scaled = (place - place.mean(axis=0)) / np.ptp(place, axis=0).max()
        x, y = np.pi * scaled.T
        for pressure in (np.ones_like(x), np.sin(x), np.sin(y), np.cos(2.0 * x) * np.cos(2.0 * y)):
            loads = np.zeros(len(matrix.nodes))
            loads[own] = pressure
            out.append(matrix.compliance @ loads)
    return out


_ARRAYS = ("nodes", "surface", "compliance", "rigid_modes", "center_of_mass")


@cache
def _sources() -> str:
    digest = hashlib.sha256()
    for path in sorted(Path(__file__).resolve().parent.glob("*.py")):
        digest.update(path.read_bytes())
    return digest.hexdigest()[:12]


def matrix_folder() -> Path:
    """Folder of the stored matrices, beside that of the compiled code."""
    return cache_root() / "elasticity"


def _path(name: str) -> Path:
    return matrix_folder() / f"{name}-{_sources()}.npz"
