"""Print all benchmarks: ``python -m benchmarks``."""

from __future__ import annotations

import pkgutil
import platform
from importlib import import_module

import psutil

import benchmarks


def main() -> None:
    """Run the ``main`` of every module ``bench_*``, then print the memory of the process."""
    print(f"Python {platform.python_version()}, {platform.machine()}, one thread")
    for module in pkgutil.iter_modules(benchmarks.__path__):
        if module.name.startswith("bench_"):
            print()
            import_module(f"benchmarks.{module.name}").main()
    print(f"\nmemory of this process: {psutil.Process().memory_info().rss / 2**20:.0f} MiB")


if __name__ == "__main__":
    main()
