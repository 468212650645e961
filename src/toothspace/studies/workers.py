"""Calls of one function over many arguments: here, in processes, or on a cluster."""

from __future__ import annotations

import logging
import platform
from collections.abc import Callable, Iterator, Sequence
from concurrent.futures import CancelledError, Executor, ProcessPoolExecutor, as_completed
from concurrent.futures.process import BrokenProcessPool
from functools import partial
from multiprocessing import get_context
from typing import Any, final

from toothspace.core.compilation.sources import digest_of_sources
from toothspace.core.errors import CaseError, ToothspaceError
from toothspace.core.processes import safe_start, start_worker

_LAST_WAIT = 5.0
"""Time that a process gets to end. [s]"""
_ANSWER_TIME = 10.0
"""Time that a scheduler gets to answer, at the start and after a break of the line. [s]"""
_KEPT = "finished points are kept: go on with --resume"


class WorkerLostError(ToothspaceError):
    """The workers that computed one call died, one after another."""


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
        self._client: Any = None

    def each(
        self, function: Callable[[Any], Any], arguments: Sequence[Any]
    ) -> Iterator[tuple[int, Any]]:
        """Yield number and result of every call, in the order in which they end.

        A call whose workers of a cluster die, also when it is alone there, gives a
        :class:`WorkerLostError` as its result.

        Raises ToothspaceError if a process died, the scheduler is lost, or a worker has other
        sources.
        """
        if self.count <= 1 and not self.scheduler:
            yield from ((k, function(argument)) for k, argument in enumerate(arguments))
            return
        call = partial(_checked, digest_of_sources(), function)
        with safe_start():
            if self._executor is None and self.scheduler:
                self._client = _client(self.scheduler)
                self._executor = self._client.get_executor(pure=False)
            elif self._executor is None:
                # fresh processes: a fork would copy the locks of the progress bar's thread
                context = get_context("spawn")
                self._executor = ProcessPoolExecutor(self.count, context, initializer=start_worker)
            waiting = {self._submitted(call, item): k for k, item in enumerate(arguments)}
        blamed = []
        try:
            for future in as_completed(waiting):
                result = self._result(future)
                if isinstance(result, WorkerLostError):
                    blamed.append(waiting[future])
                    continue
                yield waiting[future], result
            # the scheduler blames all calls that a worker had when it died: each again, alone
            for k in blamed:
                yield k, self._result(self._submitted(call, arguments[k]))
        except BrokenProcessPool as error:
            raise ToothspaceError(
                f"study: a worker process died, perhaps for lack of memory; {_KEPT} and fewer "
                "--workers"
            ) from error
        finally:
            for future in waiting:
                future.cancel()

    def _submitted(self, call: Callable[[Any], Any], argument: Any) -> Any:
        assert self._executor is not None
        try:
            return self._executor.submit(call, argument)
        except Exception as error:
            # the line may break at any moment, and then no call is taken any more
            if self._client is None or self._client.status not in ("closing", "closed"):
                raise
            raise self._lost() from error

    def _result(self, future: Any) -> Any:
        if self._client is None:
            return future.result()
        from distributed import KilledWorker

        try:
            return future.result()
        except KilledWorker:
            return WorkerLostError("its workers died one after another, perhaps for lack of memory")
        except ToothspaceError:
            raise
        except CancelledError as error:
            raise self._lost() from error
        except Exception as error:
            reason = f"{type(error).__name__}: {' '.join(str(error).split())}"
            raise ToothspaceError(
                f"study: the cluster failed ({reason}); its scheduler and its workers need this "
                f"version of toothspace; {_KEPT}"
            ) from error

    def _lost(self) -> ToothspaceError:
        return ToothspaceError(
            f"study: the scheduler {self.scheduler} does not answer any more; {_KEPT}"
        )

    def stop(self) -> None:
        """End the processes without waiting for what they compute."""
        executor, self._executor = self._executor, None
        if executor is None:
            return
        if self._client is not None:
            client, self._client = self._client, None
            client.close(timeout=_LAST_WAIT)
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
        if kind is not None or self._client is not None:
            self.stop()
        elif self._executor is not None:
            self._executor.shutdown()
            self._executor = None


def _client(scheduler: str) -> Any:
    try:
        from distributed import Client
    except ImportError as error:
        found = "no package 'distributed'"
        raise CaseError("--scheduler", found, 'after pip install "toothspace[cluster]"') from error
    # what it writes about a lost line is said once, by this program
    logging.getLogger("distributed.client").setLevel(logging.CRITICAL)
    try:
        # not the default one: other libraries would send it what they compute
        return Client(scheduler, timeout=_ANSWER_TIME, set_as_default=False)
    except (OSError, ValueError) as error:
        found = f"{scheduler!r}, where no scheduler answers"
        allowed = "the address of a running Dask scheduler, as tcp://head-node:8786"
        raise CaseError("--scheduler", found, allowed) from error


def _checked(digest: str, function: Callable[[Any], Any], argument: Any) -> Any:
    """Call a function where the sources are those of the process that asks."""
    if digest_of_sources() != digest:
        raise ToothspaceError(
            f"study: found other sources of toothspace on the worker {platform.node()}, allowed "
            f"those of the process that started the study; {_KEPT}"
        )
    return function(argument)
