"""What a run passes on its way: functions, files, and frames before the integrator.

``python -m benchmarks.run_trace [CASE] [--list]`` runs a case with everything compiled and counts
the Python functions of the package that were called, by room. A newcomer who follows a run in a
debugger meets as many, but for those that modules call while they are imported: declarations of
keys, decorators of compiled code.
"""

from __future__ import annotations

import argparse
import inspect
import subprocess
import sys
from collections import Counter
from pathlib import Path
from types import FrameType
from typing import Any

import toothspace

PACKAGE = Path(toothspace.__file__).parent
INTEGRATOR = ("solver/integrator.py", "advance")


class Trace:
    """Functions of the package that were called, and the deepest way to the integrator."""

    def __init__(self) -> None:
        self.functions: Counter[tuple[str, str, int]] = Counter()
        """How often each was called."""
        self.met: set[tuple[str, str, int]] = set()
        """Those that are called outside imports, too."""
        self.way: list[str] = []

    def __call__(self, frame: FrameType, event: str, _: Any) -> None:
        if event != "call":
            return
        code = frame.f_code
        own = code.co_filename.startswith(str(PACKAGE))
        # bodies of classes and modules are no functions
        if not own or not code.co_flags & inspect.CO_OPTIMIZED or code.co_name.startswith("<"):
            return
        file = Path(code.co_filename).relative_to(PACKAGE).as_posix()
        function = file, code.co_qualname, code.co_firstlineno
        self.functions[function] += 1
        if function not in self.met and not self._imported(frame):
            self.met.add(function)
        if (file, code.co_name) == INTEGRATOR:
            way = self._above(frame.f_back)
            self.way = way if len(way) > len(self.way) else self.way

    @staticmethod
    def _imported(frame: FrameType | None) -> bool:
        while frame is not None:
            if frame.f_code.co_name == "<module>":
                return frame.f_code.co_filename.startswith(str(PACKAGE))
            frame = frame.f_back
        return False

    def _above(self, frame: FrameType | None) -> list[str]:
        way: list[str] = []
        while frame is not None:
            if frame.f_code.co_filename.startswith(str(PACKAGE)):
                way.append(frame.f_code.co_qualname)
            frame = frame.f_back
        return way[::-1]


def traced(case: str) -> Trace:
    """Trace of the first run of a case in a process; another one has filled the caches on disk."""
    program = f"import toothspace; toothspace.simulate({case!r})"
    subprocess.run([sys.executable, "-c", program], check=True)
    trace = Trace()
    sys.setprofile(trace)
    try:
        toothspace.simulate(case)
    finally:
        sys.setprofile(None)
    return trace


def main() -> None:
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("case", nargs="?", default="egm12_pump")
    parser.add_argument("--list", action="store_true", help="print every function and its calls")
    given = parser.parse_args()
    trace = traced(given.case)
    rooms = Counter(file.split("/")[0] for file, *_ in trace.functions)
    files = {file for file, *_ in trace.functions}
    declared = len(trace.functions) - len(trace.met)
    print(f"{given.case}: {len(trace.functions)} functions in {len(files)} files;")
    print(f"{declared} of them are called only while modules are imported")
    print(", ".join(f"{room} {count}" for room, count in rooms.most_common()))
    print(f"{len(trace.way)} frames before the integrator: {' > '.join(trace.way)}")
    if given.list:
        for (file, name, line), calls in sorted(trace.functions.items()):
            print(f"{calls:6d}  {file}:{line} {name}")


if __name__ == "__main__":
    main()
