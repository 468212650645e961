"""Print benchmarks: ``python -m benchmarks`` all of them, or those that are named."""

from __future__ import annotations

import argparse
import pkgutil
import platform
import time
from importlib import import_module

import psutil

import benchmarks

_PREFIX = "bench_"


def names() -> list[str]:
    """Names of the modules ``bench_*`` without their prefix."""
    modules = [module.name for module in pkgutil.iter_modules(benchmarks.__path__)]
    return [name.removeprefix(_PREFIX) for name in modules if name.startswith(_PREFIX)]


def main() -> None:
    """Run the ``main`` of the chosen modules, each followed by the memory of the process."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks", description=__doc__)
    parser.add_argument("name", nargs="*", help=f"benchmarks to run: {', '.join(names())}")
    parser.add_argument(
        "--processor", action="store_true", help="processor time in place of wall time"
    )
    arguments = parser.parse_args()
    if arguments.processor:
        time.perf_counter = time.process_time  # type: ignore[assignment]
    chosen = arguments.name or names()
    unknown = [name for name in chosen if name not in names()]
    if unknown:
        parser.error(f"no benchmark {', '.join(unknown)}; there are {', '.join(names())}")
    print(f"Python {platform.python_version()}, {platform.machine()}, one thread")
    for name in chosen:
        print()
        try:
            benchmark = import_module(f"benchmarks.{_PREFIX}{name}")
        except ModuleNotFoundError as error:
            if str(error.name).startswith("benchmarks"):
                raise
            print(f"{name} is left out: it needs {error.name}, which is not installed")
            continue
        benchmark.main()
        print(f"memory of this process: {psutil.Process().memory_info().rss / 2**20:.0f} MiB")


if __name__ == "__main__":
    main()
