"""Krylov iteration with a preconditioner given as a function."""

from __future__ import annotations

from collections.abc import Callable
from typing import final

import numpy as np

from toothspace.core.compiled import kernel
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

    Solutions, NaN where the matrix is singular, and the largest number of iterations. [any, -]

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
        images = precondition(np.array([space.last for space in active]))
        products = product(images)
        for space, image, w in zip(active, images, products, strict=True):
            space.extend(image, w)
    return np.array([space.solution() for space in spaces]), count


@final
class _Space:
    """Krylov space of one right-hand side and the projected problem."""

    def __init__(self, rhs: Array, limit: float) -> None:
        size = norm(rhs)
        self._basis = np.empty((_FIRST + 1, rhs.size))
        self._basis[0] = rhs / size if size > 0.0 else rhs
        self._images = np.empty((_FIRST, rhs.size))
        self._projected = np.zeros((_FIRST + 3, _FIRST + 1))
        self._projected[-1, 0] = size
        self._count = 0
        self._limit = limit
        self.finished = size == 0.0

    @property
    def last(self) -> Array:
        """Newest vector of the basis."""
        return np.asarray(self._basis[self._count])

    def extend(self, image: Array, w: Array) -> None:
        """Take the image of the last basis vector and its product with the matrix."""
        if self._count == len(self._images):
            # room for twice as many vectors
            size, length = self._images.shape
            former, self._projected = self._projected, np.zeros((2 * size + 3, 2 * size + 1))
            self._projected[:size, :size] = former[:size, :size]
            self._projected[-3:, : size + 1] = former[-3:]
            self._basis = np.concatenate([self._basis, np.empty((size, length))])
            self._images = np.concatenate([self._images, np.empty((size, length))])
        self._images[self._count] = image
        left = extend(self._basis, self._projected, self._count, w)
        self._count += 1
        self.finished = not left > self._limit

    def solution(self) -> Array:
        """Combination of the images that leaves the smallest residual."""
        found = np.empty(self._images.shape[1])
        combine(self._images, self._projected, self._count, found)
        return found


_FIRST = 20
"""Iterations that a Krylov space has room for at first; one that grows is copied. [-]"""


@kernel
def extend(basis: Array, projected: Array, count: int, product: Array) -> float:
    """Modified Gram-Schmidt and the rotation of the new column; returns what is left.

    The last three rows of ``projected`` hold the cosines, the sines and the rotated right-hand
    side.
    """
    cosine, sine, right = projected[-3], projected[-2], projected[-1]
    column = projected[:, count]
    for m in range(count + 1):
        column[m] = dot(basis[m], product)
        add_scaled(product, -column[m], basis[m])
    below = norm(product)
    for k in range(product.size):
        basis[count + 1, k] = product[k] / below if below > 0.0 else product[k]
    for m in range(count):
        above = column[m]
        column[m] = cosine[m] * above + sine[m] * column[m + 1]
        column[m + 1] = cosine[m] * column[m + 1] - sine[m] * above
    size = np.hypot(column[count], below)
    if not 0.0 < size < np.inf:
        size = np.nan  # a singular matrix or one that overflows leaves no solution
    cosine[count], sine[count] = column[count] / size, below / size
    column[count] = size
    right[count], right[count + 1] = cosine[count] * right[count], -sine[count] * right[count]
    return abs(right[count + 1])


@kernel
def combine(images: Array, projected: Array, count: int, x: Array) -> None:
    """Solution of the triangular system, as a sum of the images."""
    factors = projected[-1]
    x[:] = 0.0
    for m in range(count - 1, -1, -1):
        for k in range(m + 1, count):
            factors[m] -= projected[m, k] * factors[k]
        factors[m] /= projected[m, m]
        add_scaled(x, factors[m], images[m])
