"""Vector operations on one thread; library routines start threads that cost more than they give."""

from __future__ import annotations

from typing import Any

from numpy.typing import NDArray

from toothspace.core.compiled import inlined, njit
from toothspace.core.types import Array


@inlined
def put(target: Any, values: Any) -> None:
    """Copy a vector into one of the same length; a slice would check lengths at run time."""
    for k in range(target.size):
        target[k] = values[k]


@njit(nogil=True, fastmath={"contract", "reassoc"}, _nrt=False)
def dot(a: Array, b: NDArray[Any]) -> float:
    """Inner product of two vectors; the second may be in single precision."""
    total = 0.0
    for k in range(a.size):
        total += a[k] * b[k]
    return total


@njit(nogil=True, _nrt=False)
def norm(a: Array) -> float:
    """Euclidean length of a vector."""
    return float(dot(a, a) ** 0.5)


@njit(nogil=True, fastmath={"contract"}, _nrt=False)
def add_scaled(a: Array, factor: float, b: Array) -> None:
    """Add a multiple of the second vector to the first, in place."""
    for k in range(a.size):
        a[k] += factor * b[k]
