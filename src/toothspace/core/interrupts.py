"""Signals that ask the program to end: kept until what is finished is on disk."""

from __future__ import annotations

import _thread
import signal
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from types import FrameType

ENDING = tuple(
    getattr(signal, name) for name in ("SIGINT", "SIGTERM", "SIGHUP") if hasattr(signal, name)
)
"""Ctrl-C, the end of a batch job's time, the end of the terminal."""
_PAUSE = 0.02
"""Time after which a signal inside an import is handled again. [s]"""


def is_interrupt(error: BaseException) -> bool:
    """Whether an error is what became of a signal.

    Where one comes while compiled code takes its arguments, the call gives a result and the
    interrupt as well, and Python makes a SystemError of both.
    """
    found: BaseException | None = error if isinstance(error, SystemError) else None
    while found is not None and not isinstance(found, KeyboardInterrupt):
        found = found.__cause__ or found.__context__
    return found is not None


@contextmanager
def interrupts_held() -> Iterator[Callable[[], None]]:
    """Hold signals that end the program back until the body is done; then they act.

    Yields what the body calls where they may act sooner. Only the first thread of a process
    receives signals; elsewhere this does nothing.
    """
    received: list[int] = []
    if threading.current_thread() is not threading.main_thread():
        yield received.clear
        return

    def remember(number: int, _frame: FrameType | None) -> None:
        received.append(number)

    def act() -> None:
        for number in received[:1]:
            received.clear()
            held[number](number, sys._getframe())

    before = {number: signal.getsignal(number) for number in ENDING}
    held = {number: handler for number, handler in before.items() if callable(handler)}
    for number in held:
        signal.signal(number, remember)
    try:
        yield act
    finally:
        for number, handler in held.items():
            signal.signal(number, handler)
        act()


def end_program(number: int, frame: FrameType | None) -> None:
    """Raise KeyboardInterrupt, inside an import soon after it.

    An exception between Python's import lock and its release would leave the lock taken: the next
    import then waits for ever for a thread that imports too.
    """
    while frame is not None:
        if frame.f_code.co_filename.startswith("<frozen importlib"):
            _thread.start_new_thread(_signal_again, (number,))
            return
        frame = frame.f_back
    raise KeyboardInterrupt


def _signal_again(number: int) -> None:
    time.sleep(_PAUSE)
    first = threading.main_thread().ident
    if hasattr(signal, "pthread_kill") and first is not None:
        signal.pthread_kill(first, number)  # wakes it where it waits
    else:
        signal.raise_signal(number)


@contextmanager
def ending_interrupts() -> Iterator[None]:
    """Let every signal that ends the program act as Ctrl-C does; what is ignored stays so."""
    if threading.current_thread() is not threading.main_thread():
        yield
        return
    before = {number: signal.getsignal(number) for number in ENDING}
    usual = (signal.SIG_DFL, signal.default_int_handler)
    defaults = {number: handler for number, handler in before.items() if handler in usual}
    for number in defaults:
        signal.signal(number, end_program)
    hook = sys.unraisablehook

    def again(ignored: sys.UnraisableHookArgs) -> None:
        # raised in a destructor or the callback of a weak reference, it would be lost
        if ignored.exc_type is KeyboardInterrupt and defaults:
            _thread.start_new_thread(_signal_again, (next(iter(defaults)),))
        else:
            hook(ignored)

    sys.unraisablehook = again
    try:
        yield
    finally:
        sys.unraisablehook = hook
        for number, handler in defaults.items():
            signal.signal(number, handler)
