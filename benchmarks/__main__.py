"""Print all benchmarks: ``python -m benchmarks``."""

from __future__ import annotations

import platform

import psutil

from benchmarks import bench_command_line, bench_geometry, bench_lumped


def main() -> None:
    """Run and print every benchmark, then the largest memory of the process."""
    print(f"Python {platform.python_version()}, {platform.machine()}, one thread")
    for benchmark in (bench_command_line, bench_geometry, bench_lumped):
        print()
        benchmark.report()
    print(f"\nmemory of this process: {psutil.Process().memory_info().rss / 2**20:.0f} MiB")


if __name__ == "__main__":
    main()
