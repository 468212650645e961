"""Asks single tests of one process with code of the package replaced, a forked copy at a time.

The tests are collected once, with all that they import, and none is run there. For a spoiled source
file a copy of the process gives every function of the file that differs its spoiled code, so that
whoever imported the function sees it, and runs tests until one fails. What is compiled or executed
as a module is imported cannot be replaced so; tests that start other processes see nothing of it.
"""

from __future__ import annotations

import contextlib
import gc
import importlib
import multiprocessing
import os
import signal
import sys
import tempfile
import time
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field
from multiprocessing.connection import Connection
from pathlib import Path
from types import CodeType, FunctionType
from typing import Any
from xml.etree import ElementTree

import pytest

from toothspace.core.compilation.sources import compiled_folder

REPOSITORY = Path(__file__).resolve().parent.parent
LEAST = 30.0
"""Time that every single test may take, and ten times what it takes otherwise. [s]"""


@dataclass(eq=False)  # pytest keeps its plugins in sets
class WarmTests:
    """Tests that were collected and may be asked.

    Parameters
    ----------
    items : mapping
        Tests by their names.
    seconds : mapping
        How long they take, by their names; one second where that is unknown. [s]
    limit : float
        Time for the tests of one file. [s]
    """

    items: Mapping[str, pytest.Item]
    seconds: Mapping[str, float]
    limit: float
    failed: list[str] = field(default_factory=list)
    """Tests that have failed in this copy of the process."""
    _sound: dict[str, bool] = field(default_factory=dict)

    def pytest_runtest_logreport(self, report: pytest.TestReport) -> None:
        """Keep which test failed."""
        if report.failed:
            self.failed.append(report.nodeid)

    def quickest_first(self, tests: Iterable[str]) -> list[str]:
        """Those of the tests that are here, in the order of their time."""
        return sorted({*tests} & {*self.items}, key=lambda test: (self._seconds(test), test))

    def answer(self, source: Path, spoiled: str, tests: Sequence[str]) -> tuple[str, str]:
        """What tests say of a source file with another text, and the first that fails.

        A test that fails counts where it passes with the text as it is. Without an answer, as where
        no function would change, the outcome is empty; it is ``unfinished`` where the time is over
        before all tests are asked.
        """
        end = time.monotonic() + self.limit
        left = [*tests]
        while left:
            outcome, test = self._copied(left, lambda: _replace(source, spoiled), end)
            if outcome not in {"killed", "timed out"} or self._passes(test):
                return outcome, test
            left = left[left.index(test) + 1 :]
        return "survived", ""

    def _seconds(self, test: str) -> float:
        return self.seconds.get(_key(test), 1.0)

    def _passes(self, test: str) -> bool:
        """Whether a test passes with the package as it is."""
        if test not in self._sound:
            end = time.monotonic() + LEAST + 10.0 * self._seconds(test)
            self._sound[test] = self._copied([test], lambda: True, end)[0] == "survived"
        return self._sound[test]

    def _copied(
        self, tests: Sequence[str], change: Callable[[], bool], end: float
    ) -> tuple[str, str]:
        """Ask tests in a copy of this process after a change."""
        here, there = multiprocessing.Pipe(duplex=False)
        with tempfile.TemporaryDirectory() as folder:
            arguments = (there, tests, change, folder)
            copy = multiprocessing.get_context("fork").Process(target=self._ask, args=arguments)
            copy.start()
            there.close()
            test = ""
            try:
                while here.poll(LEAST + 10.0 * self._seconds(test)):
                    outcome, name = here.recv()
                    if outcome != "asked":
                        return outcome, name
                    if time.monotonic() > end:
                        return "unfinished", ""
                    test = name
            except EOFError:
                return "killed" if test else "", test  # the copy has crashed
            finally:
                _end(copy)
            return "timed out", test

    def _ask(
        self, there: Connection, tests: Sequence[str], change: Callable[[], bool], folder: str
    ) -> None:
        """Change the package of this copy and run tests until one fails."""
        os.setsid()
        sys.stdout.flush()
        nothing = os.open(os.devnull, os.O_WRONLY)
        os.dup2(nothing, 1)
        os.dup2(nothing, 2)
        os.environ["TOOTHSPACE_CACHE"] = str(own_cache(Path(folder)))
        tempfile.tempdir = folder
        if not change():
            there.send(("", ""))
            return
        for test, following in zip(tests, [*tests[1:], ""], strict=True):
            there.send(("asked", test))
            item = self.items[test]
            item.config.hook.pytest_runtest_protocol(item=item, nextitem=self.items.get(following))
            if self.failed:
                there.send(("killed", test))
                return
        there.send(("survived", ""))


def own_cache(folder: Path) -> Path:
    """Make a cache of its own in a folder, but for compiled code. Returns where it is."""
    cache = folder / "cache"
    (cache / "toothspace").mkdir(parents=True)
    compiled_folder().mkdir(parents=True, exist_ok=True)
    (cache / "toothspace" / "compiled").symlink_to(compiled_folder(), target_is_directory=True)
    return cache


def _end(copy: Any) -> None:
    """End a copy with all that it has started."""
    with contextlib.suppress(ProcessLookupError):
        os.killpg(copy.pid, signal.SIGKILL)
    copy.kill()
    copy.join()
    copy.close()


def _replace(source: Path, spoiled: str) -> bool:
    """Give functions of a source file the code of another text; whether any changed."""
    module = source.relative_to(REPOSITORY / "src").with_suffix("")
    importlib.import_module(".".join(module.parts).removesuffix(".__init__"))
    codes = {_place(code): code for code in _codes(compile(spoiled, str(source), "exec"))}
    changed = False
    for function in gc.get_objects():
        if isinstance(function, FunctionType) and function.__code__.co_filename == str(source):
            code = codes.get(_place(function.__code__), function.__code__)
            if code != function.__code__:
                function.__code__ = code
                changed = True
    return changed


def _codes(code: CodeType) -> Iterator[CodeType]:
    """Code with all code in it."""
    yield code
    for inner in code.co_consts:
        if isinstance(inner, CodeType):
            yield from _codes(inner)


def _place(code: CodeType) -> tuple[str, int]:
    return code.co_qualname, code.co_firstlineno


def _key(test: str) -> str:
    """Name of a test as a table of JUnit has it."""
    file, _, name = test.partition("::")
    return f"{file.removesuffix('.py').replace('/', '.')}::{name}"


def with_warm_tests(
    work: Callable[[WarmTests], None], limit: float, durations: Path | None = None
) -> None:
    """Collect the fast tests and do something with them.

    Parameters
    ----------
    work : callable
        What is done.
    limit : float
        Time for the tests of one file. [s]
    durations : Path or None
        Report of ``pytest --junitxml``, for the time of each test.
    """
    cases = ElementTree.parse(durations).iter("testcase") if durations else ()
    seconds = {f"{x.get('classname')}::{x.get('name')}": float(x.get("time", 1.0)) for x in cases}
    collected = _Collected(work, limit, seconds)
    options = [
        "-q",
        "-s",
        "-p",
        "no:cacheprovider",
        "-p",
        "no:faulthandler",
        "--rootdir",
        str(REPOSITORY),
    ]
    if pytest.main([*options, str(REPOSITORY / "tests")], plugins=[collected]):
        raise RuntimeError("the tests could not be collected, or the work with them failed")


@dataclass
class _Collected:
    """Does the work where pytest would run the tests."""

    work: Callable[[WarmTests], None]
    limit: float
    seconds: Mapping[str, float]

    def pytest_runtestloop(self, session: pytest.Session) -> bool:
        """Work with the tests instead of running them."""
        tests = WarmTests({item.nodeid: item for item in session.items}, self.seconds, self.limit)
        session.config.pluginmanager.register(tests)
        self.work(tests)
        return True
