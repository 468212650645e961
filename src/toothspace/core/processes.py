"""Processes that compute for another one."""

from __future__ import annotations

import os
import signal
import threading
from collections.abc import Callable, Iterable
from functools import partial
from multiprocessing import parent_process
from typing import Any

from toothspace.core.errors import CaseError
from toothspace.core.interrupts import ENDING

_THREADS = "TOOTHSPACE_THREADS"
_ONE_THREAD = (_THREADS, "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")


def threads() -> int:
    """Threads that compute large fields: two, where there are two cores, or as the user asks."""
    return int(os.environ.get(_THREADS, min(2, os.cpu_count() or 1)))


def start_worker() -> None:
    """Prepare a process that computes for another one.

    What ends the program is the business of the first process; when that is gone, also killed, this
    one ends. Processes share the cores: each computes in one thread.
    """
    for number in ENDING:
        signal.signal(number, signal.SIG_IGN)
    for name in _ONE_THREAD:
        os.environ[name] = "1"
    threading.Thread(target=_end_with_parent, daemon=True).start()


def _end_with_parent() -> None:
    parent = parent_process()
    if parent is not None:
        parent.join()
        os._exit(1)


def outcomes(function: Callable[[Any], Any], items: Iterable[Any], workers: int) -> list[Any]:
    """Call a function of a module on every item, in processes if there is more than one worker.

    An item that fails gives its exception, and the others go on.
    """
    if workers <= 1:
        return [_outcome(function, item) for item in items]
    from concurrent.futures import ProcessPoolExecutor

    with ProcessPoolExecutor(workers, initializer=start_worker) as pool:
        return list(pool.map(partial(_outcome, function), items))


def _outcome(function: Callable[[Any], Any], item: Any) -> Any:
    try:
        return function(item)
    except CaseError as error:
        # its subclasses may not survive the way between processes
        return CaseError(str(error))
    except Exception as error:
        return error
