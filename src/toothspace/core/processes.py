"""Processes that this one starts: none runs a Python file of the current folder."""

from __future__ import annotations

import os
import shutil
import signal
import subprocess
import sys
import sysconfig
import tempfile
import threading
from collections.abc import Callable, Iterable, Iterator, Sequence
from contextlib import contextmanager, suppress
from functools import partial
from multiprocessing import parent_process
from pathlib import Path
from typing import Any

from toothspace.core.interrupts import ENDING

_THREADS = "TOOTHSPACE_THREADS"
_ONE_THREAD = (_THREADS, "OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS")


_HOME = Path(__file__).parents[2]
"""Folder or archive that holds the package."""
_START = """
import sys
from importlib.machinery import PathFinder

program, home, *arguments = sys.argv[1:]
place = arguments.index("--")
sys.path[:], sys.argv[1:] = arguments[:place], arguments[place + 1 :]


class Package:
    @staticmethod
    def find_spec(name, path=None, target=None):
        return PathFinder.find_spec(name, [home]) if name == "toothspace" else None


sys.meta_path.insert(0, Package)
exec(program)
"""
"""Takes over where modules are found; the package is that of the process which starts this one."""


def run_python(
    program: str, arguments: Sequence[str] = (), given: str = "", longest: float | None = None
) -> subprocess.CompletedProcess[str]:
    """Run a Python program in isolated mode and in an empty folder, and wait for its end.

    Modules are found where this process finds them, but not in the current folder or beside the
    script of the user.

    Parameters
    ----------
    program : str
        Its text, a constant of the package.
    arguments : sequence of str
        What it finds in ``sys.argv[1:]``; paths must be absolute.
    given : str
        Text on its standard input.
    longest : float, optional
        Time after which it is ended. [s]

    Raises
    ------
    subprocess.TimeoutExpired
        If it was ended.
    OSError
        If it cannot be started.
    """
    words = [sys.executable, "-I", "-X", "utf8", *(["-B"] if sys.dont_write_bytecode else [])]
    script = getattr(sys.modules["__main__"], "__file__", None)
    by_name = getattr(sys.modules["__main__"], "__spec__", None) is not None
    beside = [] if script is None or by_name else [Path(script).parent]
    needed = {Path(sysconfig.get_path(name)).resolve() for name in ("stdlib", "purelib", "platlib")}
    left_out = {place.resolve() for place in (*_current_folder(), *beside)} - needed
    here = _current_folder()
    absolute = [p if Path(p).is_absolute() else str(Path(*here, p)) for p in sys.path]
    kept = [place for place in absolute if Path(place).resolve() not in left_out]
    # places of modules that lie in the way of the user only if they are needed
    places = [*kept, str(_HOME)] if _HOME.resolve() in left_out else kept
    words += ["-c", _START, program, str(_HOME), *places, "--", *arguments]
    with tempfile.TemporaryDirectory() as folder:
        return subprocess.run(
            words,
            cwd=folder,
            input=given,
            capture_output=True,
            encoding="utf-8",
            errors="replace",
            timeout=longest,
            check=False,
        )


def _current_folder() -> list[Path]:
    with suppress(OSError):  # it may be gone
        return [Path.cwd()]
    return []


@contextmanager
def safe_start() -> Iterator[None]:
    """Let worker processes that start meanwhile look into the current folder last.

    They keep it, because what they compute may be defined there, and paths are relative to it.
    """
    before, variable = list(sys.path), "PYTHONSAFEPATH"
    setting = os.environ.get(variable)
    current = [str(place) for place in _current_folder()]
    kept = [place for place in before if place not in ("", *current)]
    os.environ[variable] = "1"
    sys.path[:] = kept if len(kept) == len(before) else [*kept, *current]
    try:
        yield
    finally:
        sys.path[:] = before
        if setting is None:
            del os.environ[variable]
        else:
            os.environ[variable] = setting


def program_named(*names: str) -> str | None:
    """Return the path of the first program that is installed, None without; never one found here.

    Windows looks into the current folder first, and so may a search path of the user.
    """
    found = (shutil.which(name) for name in names)
    return next((path for path in found if path is not None and Path(path).is_absolute()), None)


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

    with safe_start():
        pool = ProcessPoolExecutor(workers, initializer=start_worker)
        found = pool.map(partial(_outcome, function), items)
    with pool:
        return list(found)


def _outcome(function: Callable[[Any], Any], item: Any) -> Any:
    try:
        return function(item)
    except Exception as error:
        return error
