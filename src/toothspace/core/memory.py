"""Memory that the system would still give."""

from __future__ import annotations

import os

_LIBRARIES, _PER_THREAD = 64 * 2**20, 96 * 2**20
_MARGIN = 64 * 2**20
_MOST_THREADS = 64


def offers(size: int) -> bool:
    """Whether the system would give so many bytes; none are kept. [B]."""
    try:
        bytes(size)  # zeros that nobody reads stay with the system
    except MemoryError:
        return False
    return True


def is_short() -> bool:
    """Whether so little is left that any library may fail, each in its own words."""
    return not offers(_MARGIN)


def require_memory() -> None:
    """Raise :class:`MemoryError` where memory is short, ahead of a library that bears it badly."""
    if is_short():
        raise MemoryError


def load_linear_algebra() -> None:
    """Load NumPy's and SciPy's linear algebra while there is memory for it.

    Each of its threads reserves some 40 MB in either library. Where these are refused, OpenBLAS
    ends the process by itself or asks without end, so nothing is loaded unless they fit. With twice
    as much at hand the libraries are left to those who need them.

    Raises MemoryError if they do not fit.
    """
    cores = os.cpu_count() or 1
    named = (os.environ.get(f"{name}_NUM_THREADS", "") for name in ("OPENBLAS", "OMP"))
    asked = next((int(number) for number in named if number.isdecimal() and int(number)), cores)
    needed = _LIBRARIES + _PER_THREAD * min(asked, cores, _MOST_THREADS)
    if not offers(needed):
        raise MemoryError
    if not offers(2 * needed):
        import scipy.linalg  # noqa: F401
