"""Work on several large fields at the same time, on threads that are kept."""

from __future__ import annotations

from collections.abc import Callable, Iterable, Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from contextvars import ContextVar
from functools import lru_cache
from typing import TypeVar

from threadpoolctl import ThreadpoolController

from toothspace.core.processes import threads

_INSIDE: ContextVar[bool] = ContextVar("inside", default=False)
"""Whether this is one of the threads, which do not wait for each other."""

S = TypeVar("S")
T = TypeVar("T")
_LARGE = 8_000
"""Cells of a case from which a thread of its own pays. [-]"""


def in_parallel(one: Callable[[S], T], cases: Iterable[S], size: int) -> tuple[T, ...]:
    """Outcome of a function for every case; cases of large fields at the same time.

    A call inside of such a case computes on the thread of that case.

    Parameters
    ----------
    one : callable
        Function of a case that leaves the other cases alone.
    cases : iterable
        What it is called with.
    size : int
        Cells of the fields of one case. [-]
    """
    several = tuple(cases)
    if len(several) < 2 or threads() < 2 or size < _LARGE or _INSIDE.get():
        return tuple(map(one, several))
    return tuple(_threads(threads()).map(one, several))


@lru_cache(maxsize=2)
def _threads(count: int) -> ThreadPoolExecutor:
    """Threads to work on; to start them takes as long as a tenth of a pass of a film."""
    return ThreadPoolExecutor(count, initializer=lambda: _INSIDE.set(True))


@contextmanager
def cores_for_fields() -> Iterator[None]:
    """Keep linear algebra to one thread: its others wait busily on the cores of the fields."""
    with _libraries().limit(limits=1, user_api="blas"):
        yield


@lru_cache(maxsize=1)
def _libraries() -> ThreadpoolController:
    return ThreadpoolController()
