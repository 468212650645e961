"""Command line ``toothspace``.

=========== ==========================================================
module      responsibility
=========== ==========================================================
application the commands in their order; shipped cases and fluids, schema, compiling ahead
runs        runs, studies, films and their reduction
machines    geometry of a machine, gears in CAD files
pages       reports, comparison, validation book, form
output      what commands share: options, exit codes, summaries as text or JSON, progress
=========== ==========================================================
"""

from __future__ import annotations

import atexit
import errno
import gc
import os
import sys
from collections.abc import Sequence

from toothspace.core.errors import ToothspaceError
from toothspace.core.interrupts import ending_interrupts, is_interrupt
from toothspace.core.memory import is_short, load_linear_algebra

EXIT_DONE = 0
EXIT_BAD_INPUT = 2
EXIT_NUMERICAL_FAILURE = 3
EXIT_UNEXPECTED = 70
EXIT_INTERRUPTED = 130
_OBJECTS_BETWEEN_COLLECTIONS = 100_000
_STACK_WORDS = 2**16 + 1
"""Asked for by the first call; rounding up to a power of two leaves as many to all below it."""


def main(arguments: Sequence[str] | None = None) -> int:
    """Run the command line.

    0 done, 2 bad input, 3 numerical failure, 130 interrupted, 70 unexpected error. [-]

    Parameters
    ----------
    arguments : sequence of str or None
        Arguments without the program's name; None takes those of the process.
    """
    # what imports leave behind stays to the end: looking through it again and again is in vain
    gc.set_threshold(_OBJECTS_BETWEEN_COLLECTIONS)
    if arguments is None:
        # the process ends with this: its memory need not be searched for cycles before
        atexit.register(gc.freeze)
    _open_closed_streams()
    try:
        load_linear_algebra()
        from toothspace.cli.application import application

        given = list(sys.argv[1:] if arguments is None else arguments) or ["--help"]
        with ending_interrupts():
            code = application(args=given, prog_name="toothspace", standalone_mode=False)
        sys.stdout.flush()
    except ToothspaceError as error:
        return _complain(str(error), EXIT_BAD_INPUT)
    except KeyboardInterrupt:
        return _complain("Interrupted.", EXIT_INTERRUPTED)
    except BrokenPipeError:
        # the reader of a pipe has gone: nothing left to say
        _say_no_more()
        return EXIT_DONE
    except OSError as error:
        if error.errno == errno.ENOMEM:
            return _out_of_memory()
        _say_no_more()
        name = f"{error.filename}: " if error.filename else ""
        return _complain(f"{name}found {error.strerror or error}", EXIT_BAD_INPUT)
    except MemoryError:
        return _out_of_memory()
    except Exception as error:
        if is_interrupt(error):
            return _complain("Interrupted.", EXIT_INTERRUPTED)
        # without memory libraries fail in words of their own
        return _out_of_memory() if is_short() else _unexpected(error)
    return int(code or EXIT_DONE)


# CPython takes its stack in pieces of 16 KiB and gives an empty one back at once: a loop that
# calls across their border, deep in an import, would ask the system for memory in every round
main.__code__ = main.__code__.replace(co_stacksize=_STACK_WORDS)


def _say_no_more() -> None:
    # what waits for a full disk or a closed pipe would fail again at the end of the process
    sys.stdout = open(os.devnull, "w", encoding="utf-8")  # noqa: PTH123, SIM115


def _out_of_memory() -> int:
    allowed = "coarser grids, fewer samples, fewer --workers or OPENBLAS_NUM_THREADS=1"
    return _complain(f"memory: found no more, allowed {allowed}", EXIT_NUMERICAL_FAILURE)


def _unexpected(error: Exception) -> int:
    # errors of the option parser know their own message and code
    message = getattr(error, "format_message", None)
    if message is not None:
        command = getattr(getattr(error, "ctx", None), "command_path", "toothspace")
        return _complain(f"{message()} Try '{command} --help'.", EXIT_BAD_INPUT)
    if type(error).__name__ == "Abort":
        return _complain("Interrupted.", EXIT_INTERRUPTED)
    if os.environ.get("TOOTHSPACE_DEBUG") == "1":
        raise error
    reason = " ".join(str(error).split())
    return _complain(
        f"Unexpected {type(error).__name__}: {reason}. Please report it with the case file; "
        "TOOTHSPACE_DEBUG=1 shows where it happened.",
        EXIT_UNEXPECTED,
    )


def _open_closed_streams() -> None:
    """Let what is written to a stream that the caller closed vanish, not end up in our files."""
    while (handle := os.open(os.devnull, os.O_RDWR)) <= 2:
        pass
    os.close(handle)
    for name, number in (("stdout", 1), ("stderr", 2)):
        if getattr(sys, name) is None:
            setattr(sys, name, os.fdopen(os.dup(number), "w", encoding="utf-8"))


def _complain(message: str, code: int) -> int:
    lines = [" ".join(line.split()) for line in message.splitlines()]
    sys.stderr.write("\n".join(lines) + "\n")
    return code


__all__ = ["main"]
