"""Plane strain finite elements of one lobe pressed into a groove: an oracle for contact laws.

Bilinear elements on bodies between a curved surface and a clamped base; the contact is a
linear complementarity problem on surface flexibilities. Shares no code with the package.
"""

from __future__ import annotations

import numpy as np
import scipy.sparse as sp
from scipy.sparse.linalg import splu

Array = np.ndarray
GAUSS = 1.0 / np.sqrt(3.0)


def graded(length: float, finest: float, count: int) -> Array:
    """Positions from 0 to a length, finest at 0, steps growing geometrically."""
    low, high = 1.0 + 1e-9, 1.5
    for _ in range(80):
        ratio = 0.5 * (low + high)
        reach = finest * (ratio**count - 1.0) / (ratio - 1.0)
        low, high = (ratio, high) if reach < length else (low, ratio)
    place = np.concatenate([[0.0], np.cumsum(finest * low ** np.arange(count))])
    return place * (length / place[-1])


def elasticity(modulus: float, poisson: float) -> Array:
    factor = modulus / ((1.0 + poisson) * (1.0 - 2.0 * poisson))
    shear = 0.5 * (1.0 - 2.0 * poisson)
    return factor * np.array(
        [[1.0 - poisson, poisson, 0.0], [poisson, 1.0 - poisson, 0.0], [0.0, 0.0, shear]]
    )


def stiffness_of(corners: Array, material: Array) -> Array:
    """Stiffness of one bilinear element, corners counter-clockwise."""
    total = np.zeros((8, 8))
    for xi in (-GAUSS, GAUSS):
        for eta in (-GAUSS, GAUSS):
            slopes = 0.25 * np.array(
                [
                    [-(1 - eta), 1 - eta, 1 + eta, -(1 + eta)],
                    [-(1 - xi), -(1 + xi), 1 + xi, 1 - xi],
                ]
            )
            jacobian = slopes @ corners
            by_place = np.linalg.solve(jacobian, slopes)
            strain = np.zeros((3, 8))
            strain[0, 0::2] = by_place[0]
            strain[1, 1::2] = by_place[1]
            strain[2, 0::2], strain[2, 1::2] = by_place[1], by_place[0]
            total += strain.T @ material @ strain * np.linalg.det(jacobian)
    return total


def surface_flexibility(
    x: Array, surface: Array, base: float, loaded: Array, steel: Array
) -> Array:
    """Normal displacement into the body per force per length at the loaded surface nodes."""
    depth = graded(1.0, 1.5e-3, 45)
    rows, columns = depth.size, x.size
    y = surface[None, :] + (base - surface[None, :]) * depth[:, None]
    nodes = np.arange(rows * columns).reshape(rows, columns)
    place = np.column_stack([np.tile(x, rows), y.ravel()])
    quads = np.stack(
        [nodes[:-1, :-1], nodes[:-1, 1:], nodes[1:, 1:], nodes[1:, :-1]], axis=-1
    ).reshape(-1, 4)
    if base < surface.max():
        quads = quads[:, ::-1]
    blocks = np.array([stiffness_of(place[quad], steel) for quad in quads])
    dofs = np.stack([2 * quads, 2 * quads + 1], axis=-1).reshape(-1, 8)
    i = np.repeat(dofs, 8, axis=1).ravel()
    j = np.tile(dofs, (1, 8)).ravel()
    matrix = sp.csc_matrix((blocks.ravel(), (i, j)))
    free = np.arange(2 * (rows - 1) * columns)
    factor = splu(matrix[free][:, free])
    sign = 1.0 if base > surface.max() else -1.0
    result = np.zeros((loaded.size, loaded.size))
    for k, node in enumerate(loaded):
        force = np.zeros(free.size)
        force[2 * node + 1] = sign
        result[:, k] = sign * factor.solve(force)[2 * loaded + 1]
    return result


def lobe_in_groove(
    lobe_radius: float, groove_radius: float, depths: tuple[float, float], approach: Array
) -> Array:
    """Force per length over the approach of the clamped bases, steel on steel. [N/m].

    ``groove_radius`` is negative for a concave groove, positive for a second lobe.
    """
    steel = elasticity(206e9, 0.3)
    right = graded(0.85 * min(lobe_radius, abs(groove_radius)), 12e-6, 60)
    x = np.concatenate([-right[:0:-1], right])
    loaded = np.flatnonzero(np.abs(x) < 1.2e-3)
    upper = lobe_radius - np.sqrt(lobe_radius**2 - x**2)
    lower = np.sign(-groove_radius) * (abs(groove_radius) - np.sqrt(groove_radius**2 - x**2))
    flexibility = surface_flexibility(x, upper, depths[0], loaded, steel)
    flexibility = flexibility + surface_flexibility(x, lower, -depths[1], loaded, steel)
    gap = (upper - lower)[loaded]
    return np.array([_pressed(flexibility, gap - delta).sum() for delta in approach])


def _pressed(flexibility: Array, distance: Array) -> Array:
    """Forces that keep the surfaces apart: none pulls, none overlaps (active set)."""
    active = distance < 0.0
    force = np.zeros(distance.size)
    for _ in range(200):
        force[:] = 0.0
        force[active] = np.linalg.solve(flexibility[np.ix_(active, active)], -distance[active])
        overlap = distance + flexibility @ force
        changed = (active & (force > 0.0)) | (~active & (overlap < -1e-15))
        if np.array_equal(changed, active):
            return force
        active = changed
    raise AssertionError("contact not found")
