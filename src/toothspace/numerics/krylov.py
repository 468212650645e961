"""Krylov iteration with a preconditioner given as a function."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np

from toothspace.core.types import Array
from toothspace.numerics.vectors import add_scaled, dot, norm

Operator = Callable[[Array], Array]


def gmres(
    product: Operator,
    precondition: Operator,
    rhs: Array,
    *,
    relative_tolerance: float = 1e-12,
    max_iterations: int = 60,
) -> tuple[Array, int]:
    """Solve a linear system by the generalised minimal residual method.

    Parameters
    ----------
    product : callable
        Matrix times vector.
    precondition : callable
        Approximate inverse times vector, applied from the right and kept fixed.
    rhs : ndarray
        Right-hand side. [any]
    relative_tolerance : float
        Residual norm over norm of the right-hand side at which to stop. [-]
    max_iterations : int
        Size of the Krylov space. [-]

    Returns
    -------
    tuple of ndarray and int
        Solution and number of iterations. [any, -]

    References
    ----------
    .. [1] Y. Saad, M. H. Schultz, GMRES: a generalized minimal residual algorithm for solving
       nonsymmetric linear systems, SIAM J. Sci. Stat. Comput. 7 (1986) 856-869.
    """
    size = norm(rhs)
    if size == 0.0:
        return np.zeros_like(rhs), 0
    basis = [rhs / size]
    images: list[Array] = []
    upper = np.zeros((max_iterations + 1, max_iterations))
    rotations = np.zeros((max_iterations, 2))
    g = np.zeros(max_iterations + 1)
    g[0] = size
    for k in range(max_iterations):
        images.append(precondition(basis[k]))
        w = product(images[k])
        _orthogonalise(w, basis, upper[:, k])
        _rotate(upper[:, k], rotations, g, k)
        if abs(g[k + 1]) <= relative_tolerance * size:
            break
    count = len(images)
    y = np.linalg.solve(np.triu(upper[:count, :count]), g[:count])
    x = np.zeros_like(rhs)
    for factor, image in zip(y, images, strict=True):
        add_scaled(x, factor, image)
    return x, count


def _orthogonalise(w: Array, basis: list[Array], column: Array) -> None:
    """Modified Gram-Schmidt; appends the new basis vector."""
    for m, v in enumerate(basis):
        column[m] = dot(v, w)
        add_scaled(w, -column[m], v)
    size = norm(w)
    column[len(basis)] = size
    basis.append(w / size if size > 0.0 else w)


def _rotate(column: Array, rotations: Array, g: Array, k: int) -> None:
    """Givens rotations that keep the projected matrix upper triangular."""
    for m in range(k):
        c, s = rotations[m]
        column[m], column[m + 1] = (
            c * column[m] + s * column[m + 1],
            c * column[m + 1] - s * column[m],
        )
    size = float(np.hypot(column[k], column[k + 1]))
    c, s = column[k] / size, column[k + 1] / size
    rotations[k] = c, s
    column[k], column[k + 1] = size, 0.0
    g[k], g[k + 1] = c * g[k], -s * g[k]
