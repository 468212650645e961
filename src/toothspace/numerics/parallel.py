"""Work on several large fields at the same time, on threads that are kept."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from functools import lru_cache
from typing import TypeVar

from threadpoolctl import ThreadpoolController

from toothspace.core.processes import threads

S = TypeVar("S")
T = TypeVar("T")
_LARGE = 10_000
"""Cells of a field from which a thread of its own pays. [-]"""


def in_parallel(one: Callable[[S], T], cases: Iterable[S], size: int) -> tuple[T, ...]:
    """Outcome of a function for every case; cases of large fields at the same time.

    Parameters
    ----------
    one : callable
        Function of a case that leaves the other cases alone.
    cases : iterable
        What it is called with.
    size : int
        Cells of the field of one case. [-]
    """
    if threads() < 2 or size < _LARGE:
        return tuple(map(one, cases))
    return tuple(_threads(threads()).map(one, cases))


@lru_cache(maxsize=2)
def _threads(count: int) -> ThreadPoolExecutor:
    """Threads to work on; to start them takes as long as a tenth of a pass of a film."""
    return ThreadPoolExecutor(count)


@contextmanager
def cores_for_fields() -> Iterator[None]:
    """Keep linear algebra to one thread: its others wait busily on the cores of the fields."""
    with _libraries().limit(limits=1, user_api="blas"):
        yield


@lru_cache(maxsize=1)
def _libraries() -> ThreadpoolController:
    return ThreadpoolController()
