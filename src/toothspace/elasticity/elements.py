"""Stiffness and mass of hexahedra with incompatible modes and of ten-node tetrahedra."""

from __future__ import annotations

import numpy as np
import scipy

from toothspace.core.compiled import njit
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


_BATCH = 1024
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


def _jacobians(slopes: Array, corners: Array) -> tuple[Array, Array]:
    """Inverse of the derivative of place with the local coordinates, and its determinant."""
    derivative = slopes @ corners[:, None]
    return np.asarray(np.linalg.inv(derivative)), np.asarray(np.linalg.det(derivative))


def _strains(gradient: Array) -> Array:
    """Columns of the strain matrix for functions with given gradients; last axis the functions."""
    *batch, _, functions = gradient.shape
    strain = np.zeros((*batch, 6, functions, 3))
    x, y, z = (gradient[..., axis, :] for axis in range(3))
    strain[..., 0, :, 0], strain[..., 1, :, 1], strain[..., 2, :, 2] = x, y, z
    strain[..., 3, :, 1], strain[..., 3, :, 2] = z, y
    strain[..., 4, :, 0], strain[..., 4, :, 2] = z, x
    strain[..., 5, :, 0], strain[..., 5, :, 1] = y, x
    return strain.reshape(*batch, 6, 3 * functions)


def _summed(strain: Array, law: Array, weight: Array) -> Array:
    """Stiffness of elements: strain matrices at all points times stresses and weights."""
    count, points, _, unknowns = strain.shape
    stress = (law @ strain) * weight[..., None, None]
    rows = (count, 6 * points, unknowns)
    return np.asarray(strain.reshape(rows).transpose(0, 2, 1) @ stress.reshape(rows))


def stiffness_matrix(
    mesh: SolidMesh, elastic_modulus: float, poisson_ratio: float
) -> scipy.sparse.csr_matrix:
    """Stiffness of a mesh; three unknowns x, y, z per node. [N/m].

    References
    ----------
    .. [1] R. L. Taylor, P. J. Beresford, E. L. Wilson, A non-conforming element for stress
       analysis, Int. J. Numer. Methods Eng. 10 (1976) 1211-1219.
    """
    law = hooke(elastic_modulus, poisson_ratio)
    count = len(mesh.nodes)
    width = mesh.elements.shape[1]
    rows = np.repeat(mesh.elements, width, axis=1).ravel()
    columns = np.tile(mesh.elements, (1, width)).ravel()
    keys, blocks = np.unique(rows * np.int64(count) + columns, return_inverse=True)
    begin = np.searchsorted(keys, np.arange(count + 1, dtype=np.int64) * count)
    place, start, column = (
        blocks.astype(np.int64),
        begin.astype(np.int64),
        (keys % count).astype(np.int64),
    )
    width = mesh.elements.shape[1]
    place = place.reshape(-1, width, width)
    values = np.zeros((column.size, 3, 3))
    for first in range(0, len(place), _BATCH):
        some = slice(first, first + _BATCH)
        corners = mesh.nodes[mesh.elements[some]]
        if width == 8:
            middle, centre = _jacobians(HEX_SLOPES[8:], corners)
            inverted, volume = _jacobians(HEX_SLOPES[:8], corners)
            # the modes vanish in the mean, so that constant strains are kept exactly
            modes = middle @ HEX_BUBBLES[:8] * (centre / volume)[..., None, None]
            strain = np.concatenate([_strains(inverted @ HEX_SLOPES[:8]), _strains(modes)], axis=3)
            total = _summed(strain, law, volume)
            coupling = total[:, 24:, :24]
            inner = np.linalg.solve(total[:, 24:, 24:], coupling)
            matrices = np.asarray(total[:, :24, :24] - coupling.transpose(0, 2, 1) @ inner)
        else:
            inverse, det = _jacobians(TET_SLOPES, corners)
            matrices = _summed(_strains(inverse @ TET_SLOPES), law, det / 24.0)
        _sum_blocks(matrices, place[some], values)
    out = scipy.sparse.bsr_matrix((values, column, start), shape=(mesh.unknowns, mesh.unknowns))
    return out.tocsr()


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
