"""What is said and counted while code is compiled."""
from __future__ import annotations
import contextlib, gc, time, sys
from collections.abc import Callable, Iterator
from typing import Any


class _Notice:
    def __init__(self):
        self.count = 0
        self.depth = 0
        self.seconds = 0.0

    def step(self):
        self.count += 1

    @contextlib.contextmanager
    def making_ready(self, function):
        self.depth += 1
        started = time.perf_counter()
        enabled = gc.isenabled()
        gc.disable()
        try:
            yield
        finally:
            self.depth -= 1
            if enabled:
                gc.enable()
            if not self.depth:
                self.seconds += time.perf_counter() - started
                sys.stderr.write(f"{function.__qualname__} {time.perf_counter()-started:.2f} s, {self.count} parts\n")


NOTICE = _Notice()
