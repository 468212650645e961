"""How far a long computation is: one interface from the solver to the terminal."""

from __future__ import annotations

import math
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from contextvars import ContextVar

Progress = Callable[[float, str], None]
"""Called with the finished share of a phase, ``UNKNOWN`` where it has none, and its name."""

UNKNOWN = math.nan
"""Share of a phase whose end is not known. [-]"""


_LISTENER: ContextVar[Progress | None] = ContextVar("listener", default=None)


@contextmanager
def reporting_to(progress: Progress | None) -> Iterator[None]:
    """Hand a listener what phases far below report with :func:`report_share`."""
    before = _LISTENER.set(progress)
    try:
        yield
    finally:
        _LISTENER.reset(before)


def report_share(share: float, text: str) -> None:
    """Report a share [-] of a phase that has no listener of its own."""
    tell(_LISTENER.get(), share, text)


def tell(progress: Progress | None, share: float, text: str) -> None:
    """Report a share [-] and what is computed, if anybody listens."""
    if progress is not None:
        progress(share, text)


def part(
    progress: Progress | None, name: str, begin: float = 0.0, end: float = 1.0
) -> Progress | None:
    """Progress of a part of a computation, whose name stands in front of what it reports.

    Parameters
    ----------
    progress : callable or None
        Progress of the whole.
    name : str
        What the part computes.
    begin, end : float
        Shares of the whole between which the part lies. [-]
    """
    if progress is None:
        return None
    whole = progress

    def of_part(share: float, text: str) -> None:
        known = share if math.isfinite(share) or begin == 0.0 == 1.0 - end else 0.0
        whole(begin + known * (end - begin), f"{name}, {text}" if text else name)

    return of_part
