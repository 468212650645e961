"""Processes that compute for another one."""

from __future__ import annotations

import os
import signal
import threading
from multiprocessing import parent_process

from toothspace.core.interrupts import ENDING

_ONE_THREAD = ("NUMBA_NUM_THREADS", "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")


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
