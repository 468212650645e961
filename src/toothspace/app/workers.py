"""Processes that compute for the page: warm ones that answer at once, and one for each run.

Each can be ended at once, whatever it does, and takes no more memory than it is given.
"""

from __future__ import annotations

import ctypes
import sys
import threading
from collections.abc import Callable, Mapping
from contextlib import suppress
from multiprocessing import get_context
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

from toothspace.core.errors import CaseError, ToothspaceError
from toothspace.core.processes import safe_start, start_worker

if TYPE_CHECKING:
    from multiprocessing.connection import Connection
    from multiprocessing.synchronize import Event

MOST_MEMORY = 6 * 2**30
"""Data that one process may hold. [byte]"""
_WAIT = 0.1
"""Time between two looks whether a call is to be given up. [s]"""

_STARTING = threading.Lock()
"""Where modules are found is set for the whole program while a process starts."""

Told = Callable[[float, str], None]


class StoppedError(ToothspaceError):
    """A call was given up because somebody asked for it."""


@final
class Worker:
    """One process that computes what it is asked for, one thing at a time.

    Parameters
    ----------
    folder : Path
        Folder that file paths in cases are relative to.
    """

    def __init__(self, folder: Path) -> None:
        self._folder = folder
        self._busy, self._lock = threading.Lock(), threading.Lock()
        self._process: Any = None
        self._connection: Connection | None = None
        context = get_context("spawn")
        self._stop: Event = context.Event()

    def call(
        self,
        name: str,
        *arguments: Any,
        named: Mapping[str, Any] | None = None,
        told: Told | None = None,
        longest: float | None = None,
    ) -> Any:
        """Return what a method of :class:`~toothspace.app.computations.Computations` returns.

        Parameters
        ----------
        name : str
            Method.
        *arguments : object
            Its arguments.
        named : mapping, optional
            Its arguments by name.
        told : callable, optional
            Called with the finished share and a short text.
        longest : float, optional
            Time after which the process is ended. [s]

        Raises
        ------
        CaseError
            What is wrong with a case, or that it took too long or too much memory.
        StoppedError
            If :meth:`stop` or :meth:`end` was called meanwhile.
        """
        with self._busy:
            connection = self._started()
            self._stop.clear()
            try:
                connection.send((name, arguments, dict(named or {})))
                return self._answer(connection, told, longest)
            except (EOFError, OSError) as error:
                code = None if self._process is None else self._process.exitcode
                self.end()
                if code is None or code < 0:
                    raise StoppedError("Stopped.") from error
                raise CaseError("The process that computes has ended unexpectedly.") from error

    def stop(self) -> None:
        """Let the present call end where it reports next."""
        self._stop.set()

    def end(self) -> None:
        """End the process now; the next call starts another one."""
        with self._lock:
            process, self._process = self._process, None
            connection, self._connection = self._connection, None
        if process is not None:
            process.kill()
            process.join()
        if connection is not None:
            with suppress(OSError):
                connection.close()

    def _started(self) -> Connection:
        with self._lock:
            if self._process is None or not self._process.is_alive():
                context = get_context("spawn")
                self._connection, other = context.Pipe()
                self._process = context.Process(
                    target=_serve, args=(other, self._stop, self._folder), daemon=True
                )
                with _STARTING, safe_start():
                    self._process.start()
                other.close()
            assert self._connection is not None
            return self._connection

    def _answer(self, connection: Connection, told: Told | None, longest: float | None) -> Any:
        waited = 0.0
        while True:
            if not connection.poll(_WAIT):
                waited += _WAIT
                if longest is not None and waited > longest:
                    self.end()
                    raise CaseError(f"This took longer than {longest:g} s and was given up.")
                if self._process is None:
                    raise StoppedError("Stopped.")
                continue
            kind, value = connection.recv()
            if kind == "told":
                if told is not None:
                    told(*value)
            elif kind == "done":
                return value
            elif kind == "stopped":
                raise StoppedError("Stopped.")
            else:
                raise value


def _serve(connection: Connection, stop: Event, folder: Path) -> None:
    """Compute what is asked for until the other end is closed."""
    start_worker()
    _limit_memory()
    from toothspace.app.computations import Computations

    def told(share: float, text: str) -> None:
        if stop.is_set():
            raise KeyboardInterrupt
        connection.send(("told", (share, text)))

    rooms = Computations(folder, told)
    while True:
        try:
            name, arguments, named = connection.recv()
        except (EOFError, OSError):
            return
        try:
            answer = "done", getattr(rooms, name)(*arguments, **named)
        except KeyboardInterrupt:
            answer = "stopped", None
        except MemoryError:
            answer = "wrong", CaseError("This needs more memory than a run of the page may take.")
        except RecursionError:
            answer = "wrong", CaseError("Tables are nested too deeply.")
        except ToothspaceError as error:
            answer = "wrong", error
        except Exception as error:
            answer = "wrong", CaseError(f"Unexpected {type(error).__name__}: {error}")
        connection.send(answer)
        del answer, arguments, named
        _give_memory_back()


def _give_memory_back() -> None:
    """Give the system what is free; the allocator would keep the largest need of all answers."""
    if sys.platform == "linux":
        with suppress(OSError, AttributeError):  # another C library
            ctypes.CDLL(None).malloc_trim(0)


def _limit_memory() -> None:
    if sys.platform != "linux":
        return
    import resource

    _, most = resource.getrlimit(resource.RLIMIT_DATA)
    wanted = MOST_MEMORY if most == resource.RLIM_INFINITY else min(MOST_MEMORY, most)
    resource.setrlimit(resource.RLIMIT_DATA, (wanted, most))
