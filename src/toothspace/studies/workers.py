"""Calls of one function over many arguments: here, in processes, or on a cluster."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import Executor, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from multiprocessing import get_context
from typing import Any, final

from toothspace.core.errors import CaseError, ToothspaceError
from toothspace.core.processes import start_worker

_LAST_WAIT = 5.0
"""Time that a process gets to end. [s]"""


@final
class Workers:
    """Calls a function over arguments; a context manager that ends its processes.

    Parameters
    ----------
    count : int
        Processes; 1 computes in this one.
    scheduler : str
        Address of a Dask scheduler, empty for processes of this machine.
    """

    def __init__(self, count: int = 1, scheduler: str = "") -> None:
        self.count, self.scheduler = count, scheduler
        self._executor: Executor | None = None

    def each(
        self, function: Callable[[Any], Any], arguments: Sequence[Any]
    ) -> Iterator[tuple[int, Any]]:
        """Yield number and result of every call, in the order in which they end.

        Raises
        ------
        ToothspaceError
            If a process died.
        """
        if self.count <= 1 and not self.scheduler:
            yield from ((k, function(argument)) for k, argument in enumerate(arguments))
            return
        if self._executor is None:
            self._executor = _executor(self.count, self.scheduler)
        waiting = {self._executor.submit(function, item): k for k, item in enumerate(arguments)}
        try:
            for future in as_completed(waiting):
                yield waiting[future], future.result()
        except BrokenProcessPool as error:
            raise ToothspaceError(
                "study: a worker process died, perhaps for lack of memory; finished points are "
                "kept: go on with --resume and fewer --workers"
            ) from error
        finally:
            for future in waiting:
                future.cancel()

    def stop(self) -> None:
        """End the processes without waiting for what they compute."""
        executor, self._executor = self._executor, None
        if executor is None:
            return
        running = list((getattr(executor, "_processes", None) or {}).values())
        executor.shutdown(wait=False, cancel_futures=True)
        for process in running:
            process.kill()
        for process in running:
            process.join(_LAST_WAIT)

    def __enter__(self) -> Workers:
        """Return itself; processes start when they are first needed."""
        return self

    def __exit__(self, kind: type[BaseException] | None, *_: object) -> None:
        """End the processes, after an error without waiting for what they compute."""
        if kind is not None:
            self.stop()
        elif self._executor is not None:
            self._executor.shutdown()
            self._executor = None


def _executor(count: int, scheduler: str) -> Executor:
    if not scheduler:
        # fresh processes: a fork would copy the locks of the progress bar's thread
        return ProcessPoolExecutor(count, get_context("spawn"), initializer=start_worker)
    try:
        from distributed import Client  # type: ignore[import-not-found, unused-ignore]
    except ImportError as error:
        found = "no package 'distributed'"
        raise CaseError(
            f'--scheduler: found {found}, allowed after pip install "toothspace[cluster]"'
        ) from error
    executor: Executor = Client(scheduler).get_executor()
    return executor
