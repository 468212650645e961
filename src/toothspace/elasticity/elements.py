"""Stiffness and mass of hexahedra with incompatible modes and of ten-node tetrahedra."""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp

from toothspace.core.compiled import inlined, njit
from toothspace.core.types import Array, IntArray
from toothspace.elasticity.mesh import SolidMesh

_G = 1.0 / np.sqrt(3.0)
_HEX_POINTS = np.array([(x, y, z) for z in (-_G, _G) for y in (-_G, _G) for x in (-_G, _G)])
_HEX_SIGNS = np.array(
    [
        (-1, -1, -1),
        (1, -1, -1),
        (1, 1, -1),
        (-1, 1, -1),
        (-1, -1, 1),
        (1, -1, 1),
        (1, 1, 1),
        (-1, 1, 1),
    ],
    dtype=float,
)
_A, _B = 0.5854101966249685, 0.1381966011250105
_TET_POINTS = np.array([(_B, _B, _B), (_A, _B, _B), (_B, _A, _B), (_B, _B, _A)])


_BATCH = 8192
"""Elements whose matrices are held at a time."""


def hooke(elastic_modulus: float, poisson_ratio: float) -> Array:
    """Stresses xx yy zz yz zx xy over strains (shear as angles). [Pa]."""
    shear = 0.5 * elastic_modulus / (1.0 + poisson_ratio)
    lame = 2.0 * shear * poisson_ratio / (1.0 - 2.0 * poisson_ratio)
    out = np.zeros((6, 6))
    out[:3, :3] = lame
    out[[0, 1, 2], [0, 1, 2]] += 2.0 * shear
    out[[3, 4, 5], [3, 4, 5]] = shear
    return out


def _hex_tables() -> tuple[Array, Array, Array]:
    """Shape functions, their gradients and those of the incompatible modes at all points."""
    values = np.empty((8, 8))
    slopes = np.empty((9, 3, 8))
    bubbles = np.empty((9, 3, 3))
    for g, point in enumerate([*_HEX_POINTS, np.zeros(3)]):
        terms = 1.0 + _HEX_SIGNS * point
        if g < 8:
            values[g] = terms.prod(axis=1) / 8.0
        for k in range(3):
            others = [i for i in range(3) if i != k]
            slopes[g, k] = _HEX_SIGNS[:, k] * terms[:, others].prod(axis=1) / 8.0
        bubbles[g] = np.diag(-2.0 * point)
    return values, slopes, bubbles


def _tet_tables() -> tuple[Array, Array]:
    values = np.empty((4, 10))
    slopes = np.empty((4, 3, 10))
    gradient = np.array([(-1.0, -1.0, -1.0), (1, 0, 0), (0, 1, 0), (0, 0, 1)])
    pairs = ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3))
    for g, point in enumerate(_TET_POINTS):
        share = np.array([1.0 - point.sum(), *point])
        values[g] = [
            *(share * (2.0 * share - 1.0)),
            *(4.0 * share[i] * share[j] for i, j in pairs),
        ]
        corner = (4.0 * share - 1.0)[:, None] * gradient
        middle = [4.0 * (share[i] * gradient[j] + share[j] * gradient[i]) for i, j in pairs]
        slopes[g] = np.vstack([corner, middle]).T
    return values, slopes


HEX_VALUES, HEX_SLOPES, HEX_BUBBLES = _hex_tables()
TET_VALUES, TET_SLOPES = _tet_tables()


@inlined
def _jacobian(slopes: Array, corners: Array, inverse: Array) -> float:
    """Inverse of the derivative of place with the local coordinates, and its determinant."""
    j = slopes @ corners
    d0 = j[1, 1] * j[2, 2] - j[1, 2] * j[2, 1]
    d1 = j[1, 2] * j[2, 0] - j[1, 0] * j[2, 2]
    d2 = j[1, 0] * j[2, 1] - j[1, 1] * j[2, 0]
    det = j[0, 0] * d0 + j[0, 1] * d1 + j[0, 2] * d2
    inverse[0, 0], inverse[1, 0], inverse[2, 0] = d0 / det, d1 / det, d2 / det
    inverse[0, 1] = (j[0, 2] * j[2, 1] - j[0, 1] * j[2, 2]) / det
    inverse[1, 1] = (j[0, 0] * j[2, 2] - j[0, 2] * j[2, 0]) / det
    inverse[2, 1] = (j[0, 1] * j[2, 0] - j[0, 0] * j[2, 1]) / det
    inverse[0, 2] = (j[0, 1] * j[1, 2] - j[0, 2] * j[1, 1]) / det
    inverse[1, 2] = (j[0, 2] * j[1, 0] - j[0, 0] * j[1, 2]) / det
    inverse[2, 2] = (j[0, 0] * j[1, 1] - j[0, 1] * j[1, 0]) / det
    return det


@inlined
def _strains(gradient: Array, strain: Array, first: int) -> None:
    """Columns of the strain matrix for functions with given gradients."""
    for a in range(gradient.shape[1]):
        x, y, z = gradient[0, a], gradient[1, a], gradient[2, a]
        k = first + 3 * a
        strain[0, k], strain[1, k + 1], strain[2, k + 2] = x, y, z
        strain[3, k + 1], strain[3, k + 2] = z, y
        strain[4, k], strain[4, k + 2] = z, x
        strain[5, k], strain[5, k + 1] = y, x


@njit(nogil=True)
def _hexahedra(
    nodes: Array, elements: IntArray, law: Array, slopes: Array, bubbles: Array
) -> Array:
    count = elements.shape[0]
    out = np.empty((count, 24, 24))
    for e in range(count):
        corners = np.empty((8, 3))
        for a in range(8):
            corners[a] = nodes[elements[e, a]]
        middle, inverse = np.empty((3, 3)), np.empty((3, 3))
        centre = _jacobian(slopes[8], corners, middle)
        total = np.zeros((33, 33))
        strain = np.zeros((6, 33))
        for g in range(8):
            det = _jacobian(slopes[g], corners, inverse)
            _strains(inverse @ slopes[g], strain, 0)
            # the modes vanish in the mean, so that constant strains are kept exactly
            _strains(middle @ bubbles[g] * (centre / det), strain, 24)
            total += strain.T @ (law @ strain) * det
        coupling = np.ascontiguousarray(total[24:, :24])
        inner = np.linalg.solve(np.ascontiguousarray(total[24:, 24:]), coupling)
        out[e] = total[:24, :24] - coupling.T @ inner
    return out


@njit(nogil=True)
def _tetrahedra(nodes: Array, elements: IntArray, law: Array, slopes: Array) -> Array:
    count = elements.shape[0]
    out = np.empty((count, 30, 30))
    for e in range(count):
        corners = np.empty((10, 3))
        for a in range(10):
            corners[a] = nodes[elements[e, a]]
        inverse = np.empty((3, 3))
        total = np.zeros((30, 30))
        strain = np.zeros((6, 30))
        for g in range(4):
            det = _jacobian(slopes[g], corners, inverse)
            _strains(inverse @ slopes[g], strain, 0)
            total += strain.T @ (law @ strain) * (det / 24.0)
        out[e] = total
    return out


def stiffness_matrix(
    mesh: SolidMesh, elastic_modulus: float, poisson_ratio: float
) -> sp.csr_matrix:
    """Stiffness of a mesh; three unknowns x, y, z per node. [N/m].

    References
    ----------
    .. [1] R. L. Taylor, P. J. Beresford, E. L. Wilson, A non-conforming element for stress
       analysis, Int. J. Numer. Methods Eng. 10 (1976) 1211-1219.
    """
    law = hooke(elastic_modulus, poisson_ratio)
    place, start, column = _pattern(mesh.elements, len(mesh.nodes))
    width = mesh.elements.shape[1]
    place = place.reshape(-1, width, width)
    values = np.zeros((column.size, 3, 3))
    for first in range(0, len(place), _BATCH):
        some = slice(first, first + _BATCH)
        own = mesh.nodes, mesh.elements[some], law
        hexahedra = width == 8
        matrices = (
            _hexahedra(*own, HEX_SLOPES, HEX_BUBBLES)
            if hexahedra
            else _tetrahedra(*own, TET_SLOPES)
        )
        _sum_blocks(matrices, place[some], values)
    out = sp.bsr_matrix((values, column, start), shape=(mesh.unknowns, mesh.unknowns))
    return out.tocsr()


def _pattern(elements: IntArray, count: int) -> tuple[IntArray, IntArray, IntArray]:
    """Place of every element block among the blocks of the matrix, rows and columns."""
    width = elements.shape[1]
    rows = np.repeat(elements, width, axis=1).ravel()
    columns = np.tile(elements, (1, width)).ravel()
    keys, place = np.unique(rows * np.int64(count) + columns, return_inverse=True)
    start = np.searchsorted(keys, np.arange(count + 1, dtype=np.int64) * count)
    return place.astype(np.int64), start.astype(np.int64), (keys % count).astype(np.int64)


@njit
def _sum_blocks(matrices: Array, place: IntArray, values: Array) -> None:
    """Add blocks of 3 x 3 of element matrices at their places."""
    count, width, _ = place.shape
    for e in range(count):
        for a in range(width):
            for b in range(width):
                target = values[place[e, a, b]]
                for i in range(3):
                    for j in range(3):
                        target[i, j] += matrices[e, 3 * a + i, 3 * b + j]


def nodal_masses(mesh: SolidMesh, density: float) -> Array:
    """Mass of every node: the integral of its shape function times the density. [kg]."""
    slopes, values = HEX_SLOPES, HEX_VALUES
    weight = 1.0
    if mesh.elements.shape[1] == 10:
        slopes, values, weight = TET_SLOPES, TET_VALUES, 1.0 / 24.0
    corners = mesh.nodes[mesh.elements]
    masses = np.zeros(len(mesh.nodes))
    for value, slope in zip(values, slopes, strict=False):
        volume = weight * density * np.linalg.det(slope @ corners)
        np.add.at(masses, mesh.elements, volume[:, None] * value)
    return masses
