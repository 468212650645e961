"""What is shown and measured while code is compiled: a counter, the time, a sound Ctrl-C."""

from __future__ import annotations

import contextlib
import gc
import sys
import time
from collections.abc import Callable, Iterator
from types import FunctionType
from typing import Any, final

from toothspace.core.compilation.sources import compiled_folder
from toothspace.core.interrupts import interrupts_held
from toothspace.core.memory import require_memory

_SHORTEST = 0.5
"""Compilation is shown if it takes longer than this. [s]"""

_LINE_EVERY = 5.0
"""A line is written at this distance where the counter cannot be written over. [s]"""


@final
class Notice:
    """Counter on standard error, and the seconds that compilation has taken."""

    def __init__(self) -> None:
        self.seconds = 0.0
        self._depth = 0
        self._done = 0
        self._expected = 0
        self._started = 0.0
        self._shown = 0.0
        self._end_here: Callable[[], None] = lambda: None

    @contextlib.contextmanager
    def making_ready(self, function: Callable[..., Any]) -> Iterator[None]:
        """Load or compile a function and what it calls; nested calls are part of the first."""
        if self._depth:
            self._depth += 1
            try:
                yield
            finally:
                self._depth -= 1
            return
        require_memory()  # LLVM ends the process where it gets none
        self._depth, self._done = 1, 0
        self._expected = len(reachable(function))
        self._started = self._shown = time.perf_counter()
        try:
            with _without_collector(), interrupts_held() as self._end_here:
                yield
        finally:
            self._depth = 0
            self.seconds += time.perf_counter() - self._started
            if sys.stderr.isatty() and self._shown > self._started:
                sys.stderr.write("\r\x1b[K")
                sys.stderr.flush()

    def step(self) -> None:
        """Count a function that is about to be compiled."""
        self._end_here()  # not inside the compiler
        require_memory()
        self._done += 1
        self._expected = max(self._expected, self._done)
        now = time.perf_counter()
        over = sys.stderr.isatty()
        first = self._shown == self._started
        if now - self._shown < (0.1 if over else _SHORTEST if first else _LINE_EVERY):
            return
        self._shown = now
        text = f"Compiling {self._done}/{self._expected}, once, kept in {compiled_folder()}"
        sys.stderr.write(f"\r{text}\x1b[K" if over else f"{text}\n")
        sys.stderr.flush()


NOTICE = Notice()
"""The notice of this process."""


def compile_seconds() -> float:
    """Time that this process has spent on compiling and on loading compiled code. [s]."""
    return NOTICE.seconds


@contextlib.contextmanager
def _without_collector() -> Iterator[None]:
    """The compiler makes many objects and few cycles: searching for these takes long."""
    enabled = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if enabled:
            gc.enable()


def reachable(function: Callable[..., Any]) -> set[Callable[..., Any]]:
    """Functions of this package that a function may call, as far as names tell."""
    found: set[Callable[..., Any]] = set()
    ahead: list[Any] = [function]
    while ahead:
        caller = ahead.pop()
        named = [caller.__globals__.get(name) for name in caller.__code__.co_names]
        bound = [cell.cell_contents for cell in caller.__closure__ or ()]
        for item in (*named, *bound):
            called = getattr(item, "py_func", item)
            ours = str(getattr(called, "__module__", "")).startswith("toothspace.")
            if isinstance(called, FunctionType) and ours and called not in found:
                found.add(called)
                ahead.append(called)
    return found
