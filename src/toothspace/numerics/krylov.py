"""Krylov iteration with a preconditioner given as a function."""

from __future__ import annotations

from collections.abc import Callable
from typing import final

import numpy as np

from toothspace.core.types import Array
from toothspace.numerics.vectors import add_scaled, dot, norm

Operator = Callable[[Array], Array]


def gmres(
    product: Operator,
    precondition: Operator,
    rhs: Array,
    *,
    limits: Array,
    max_iterations: int = 60,
) -> tuple[Array, int]:
    """Solve for several right-hand sides in step, each with a Krylov space of its own.

    By the generalised minimal residual method.

    Parameters
    ----------
    product : callable
        Matrix times several vectors, one per row.
    precondition : callable
        Approximate inverse times several vectors, applied from the right and kept fixed.
    rhs : ndarray, shape (sides, unknowns)
        Right-hand sides. [any]
    limits : ndarray, shape (sides,)
        Residual norms at which to stop. [any]
    max_iterations : int
        Largest size of a Krylov space. [-]

    Returns
    -------
    tuple of ndarray and int
        Solutions, NaN where the matrix is singular, and the largest number of iterations.
        [any, -]

    References
    ----------
    .. [1] Y. Saad, M. H. Schultz, GMRES: a generalized minimal residual algorithm for solving
       nonsymmetric linear systems, SIAM J. Sci. Stat. Comput. 7 (1986) 856-869.
    """
    spaces = [_Space(side, float(limit)) for side, limit in zip(rhs, limits, strict=True)]
    for count in range(max_iterations + 1):
        active = [space for space in spaces if not space.finished]
        if not active or count == max_iterations:
            break
        images = precondition(np.array([space.basis[-1] for space in active]))
        products = product(images)
        for space, image, w in zip(active, images, products, strict=True):
            space.extend(image, w)
    return np.array([space.solution() for space in spaces]), count


@final
class _Space:
    """Krylov space of one right-hand side and the projected problem."""

    def __init__(self, rhs: Array, limit: float) -> None:
        size = norm(rhs)
        self.basis = [rhs / size if size > 0.0 else rhs]
        self._images: list[Array] = []
        self._columns: list[Array] = []
        self._rotations: list[tuple[float, float]] = []
        self._g = [size]
        self._limit = limit
        self.finished = size == 0.0

    def extend(self, image: Array, w: Array) -> None:
        """Take the image of the last basis vector and its product with the matrix."""
        self._images.append(image)
        column = self._orthogonalise(w)
        for m, (c, s) in enumerate(self._rotations):
            column[m], column[m + 1] = (
                c * column[m] + s * column[m + 1],
                c * column[m + 1] - s * column[m],
            )
        size = float(np.hypot(column[-2], column[-1]))
        if not 0.0 < size < np.inf:
            size = np.nan  # a singular matrix or one that overflows leaves no solution
        c, s = column[-2] / size, column[-1] / size
        column[-2], column[-1] = size, 0.0
        self._columns.append(column)
        self._rotations.append((c, s))
        self._g[-1:] = [c * self._g[-1], -s * self._g[-1]]
        self.finished = not abs(self._g[-1]) > self._limit

    def _orthogonalise(self, w: Array) -> Array:
        """Modified Gram-Schmidt; appends the new basis vector."""
        column = np.empty(len(self.basis) + 1)
        for m, v in enumerate(self.basis):
            column[m] = dot(v, w)
            add_scaled(w, -column[m], v)
        size = norm(w)
        column[-1] = size
        self.basis.append(w / size if size > 0.0 else w)
        return column

    def solution(self) -> Array:
        """Combination of the images that leaves the smallest residual."""
        count = len(self._columns)
        x = np.zeros_like(self.basis[0])
        if count == 0:
            return x
        upper = np.zeros((count, count))
        for k, column in enumerate(self._columns):
            upper[: k + 1, k] = column[: k + 1]
        y = np.linalg.solve(upper, np.array(self._g[:count]))
        for factor, image in zip(y, self._images, strict=True):
            add_scaled(x, float(factor), image)
        return x
