"""Own times against those of peers in the same run, stored and compared.

    python -m benchmarks.speed            # prints the table
    python -m benchmarks.speed --store    # writes it beside this module and into the speed page
    python -m benchmarks.speed --compare  # fails where a ratio fell by 20 %

Processor times, medians of runs in turn with those of the peer, so that neither the machine nor
its load enters the ratios much. Integrators are compared at equal error of the chamber pressures.
"""

from __future__ import annotations

import argparse
import json
import platform
import re
import statistics
import sys
import time
from collections.abc import Callable, Iterator
from dataclasses import asdict, dataclass
from importlib.metadata import version
from pathlib import Path

import scipy.sparse.linalg as spl

from benchmarks import bench_gerotor, bench_startup
from benchmarks.bench_films import eliminated, right_side, sparse_matrix, toothed_film
from benchmarks.bench_lumped import (
    REFERENCE_TOLERANCE,
    Outcome,
    Problem,
    Run,
    outcome_of,
    run_cvode,
    run_package,
    run_scipy,
    seconds_at_error,
)

STORE = Path(__file__).with_name("speed.json")
PAGE = Path(__file__).resolve().parents[1] / "benchmarks" / "results" / "speed_against_peers.md"
FALLEN = 0.8
"""Ratio over the stored one below which a figure is flagged."""
REPEATS = 3
_PACKAGES = ("numpy", "scipy", "numba", "scikit-sundae")
_TABLE = re.compile(r"(?<=<!-- table -->\n).*?(?=<!-- end of table -->)", re.DOTALL)


@dataclass(frozen=True)
class Figure:
    """A task, own and a peer's processor time [s], and a remark on what was done."""

    task: str
    peer: str
    own_seconds: float
    peer_seconds: float
    remark: str

    @property
    def ratio(self) -> float:
        """Time of the peer over the own one. [-]."""
        return self.peer_seconds / self.own_seconds


def in_turn(*calls: Callable[[], float]) -> list[float]:
    """Medians of the times that calls return, which run in turn after one warm-up each. [s]."""
    times = [[call() for call in calls] for _ in range(REPEATS + 1)][1:]
    return [statistics.median(own) for own in zip(*times, strict=True)]


def timed(call: Callable[[], object]) -> float:
    """Processor time of a call. [s]."""
    began = time.process_time()
    call()
    return time.process_time() - began


def integrators(
    name: str,
    problem: Problem,
    tolerance: float,
    names: tuple[str, ...] = ("SUNDIALS CVODE", "SciPy LSODA"),
    factors: tuple[float, ...] = (10.0, 1.0, 0.1),
) -> Iterator[Figure]:
    """A march at a tolerance, and peers at the error that it reaches, from several tolerances."""
    reference = problem.pressures(run_package(problem, REFERENCE_TOLERANCE)[1])
    runs: dict[str, Callable[[float], Run]] = {
        "SUNDIALS CVODE": lambda t: run_cvode(problem, t),
        "SciPy LSODA": lambda t: run_scipy(problem, t, "LSODA", analytic=True),
    }
    peers = {peer: runs[peer] for peer in names}
    own = outcome_of("toothspace", problem, tolerance, run_package(problem, tolerance), reference)
    found: dict[str, list[Outcome]] = {peer: [] for peer in peers}
    for run in peers.values():
        run(tolerance)  # compiles
    for factor in factors:
        for peer, run in peers.items():
            finished = run(factor * tolerance)
            outcome = outcome_of(peer, problem, factor * tolerance, finished, reference)
            found[peer].append(outcome)
    middle = factors[len(factors) // 2]
    for peer, run in peers.items():
        own_seconds, in_the_middle = in_turn(
            lambda: run_package(problem, tolerance)[0], lambda r=run: r(middle * tolerance)[0]
        )
        then = found[peer][len(factors) // 2].seconds
        equal = seconds_at_error(found[peer], peer, own.root_mean_square_error)
        remark = f"{own.rhs_calls} right-hand sides, error {own.root_mean_square_error:.1e} bar"
        yield Figure(name, peer, own_seconds, in_the_middle * equal / then, remark)


def running_motor() -> Iterator[Figure]:
    """A motor in its circuit with a free shaft.

    CVODE's iteration fails at random there, at 1e-5 a million times; its time means something
    at closer tolerances only.
    """
    task = f"Motor in its circuit, {bench_startup.RUNNING} s at 300 rpm"
    tolerance = bench_startup.TOLERANCE
    yield from integrators(
        task, bench_startup.RunningMotor(), tolerance, ("SUNDIALS CVODE",), (1.0, 0.1, 0.01)
    )


def lateral_film() -> Iterator[Figure]:
    """Film of a gear face, set up and solved, against a direct solver."""
    balance, free = toothed_film(960, 128)
    stencil, right = right_side(balance, free)
    matrix, b = sparse_matrix(stencil, free).tocsc(), right[free.ravel()]

    def blocks() -> None:
        eliminated(stencil, free).solve(right, None, 1e-8)

    def direct() -> None:
        spl.splu(matrix, permc_spec="MMD_AT_PLUS_A", options={"SymmetricMode": True}).solve(b)

    own, peer = in_turn(lambda: timed(blocks), lambda: timed(direct))
    yield Figure("Face film of 122 880 cells", "SciPy SuperLU", own, peer, "set-up and solution")


def figures() -> Iterator[Figure]:
    """All figures, one after another."""
    yield from integrators("EGM-12 motor, one revolution", Problem(), 1e-6)
    gerotor = Problem(bench_gerotor.CASE, bench_gerotor.OVERRIDES)
    yield from integrators("Gerotor, one revolution", gerotor, 1e-6)
    yield from running_motor()
    yield from lateral_film()


def machine() -> str:
    """Processor, Python and packages in words."""
    packages = ", ".join(f"{name} {version(name)}" for name in _PACKAGES)
    cpu = Path("/proc/cpuinfo")
    names = re.findall(r"model name\s*: (.*)", cpu.read_text()) if cpu.exists() else []
    name = names[0] if names else platform.machine()
    return f"{name}; Python {platform.python_version()}, {packages}"


def as_markdown(found: list[Figure]) -> str:
    """Table of the speed page."""
    lines = [
        f"{machine()}; one thread.",
        "",
        "| task | own time | per second | peer | its time over ours | |",
        "|---|---|---|---|---|---|",
    ]
    for f in found:
        own = f"{1e3 * f.own_seconds:.3g} ms | {1.0 / f.own_seconds:.3g}"
        lines.append(f"| {f.task} | {own} | {f.peer} | {f.ratio:.2f} | {f.remark} |")
    return "\n".join(lines) + "\n"


def fallen(found: list[Figure], stored: list[Figure]) -> list[str]:
    """Messages for ratios that fell by a fifth of the stored ones."""
    before = {(f.task, f.peer): f.ratio for f in stored}
    return [
        f"{f.task}, {f.peer}: {f.ratio:.2f}, stored {before[f.task, f.peer]:.2f}"
        for f in found
        if f.ratio < FALLEN * before.get((f.task, f.peer), 0.0)
    ]


def load(path: Path = STORE) -> list[Figure]:
    """Stored figures."""
    return [Figure(**row) for row in json.loads(path.read_text())]


def main() -> int:
    """Measure; print, store or compare."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.speed", description=__doc__)
    parser.add_argument("--store", action="store_true", help="write table and speed page")
    parser.add_argument("--compare", action="store_true", help="fail where a ratio fell by 20 %%")
    arguments = parser.parse_args()
    time.perf_counter = time.process_time  # type: ignore[assignment]
    found = list(figures())
    print(as_markdown(found))
    if arguments.compare:
        messages = fallen(found, load())
        print("\n".join(messages) or "No ratio fell by 20 %.")
        return 1 if messages else 0
    if arguments.store:
        STORE.write_text(json.dumps([asdict(f) for f in found], indent=2) + "\n")
        PAGE.write_text(_TABLE.sub(lambda _: as_markdown(found), PAGE.read_text()))
    return 0


if __name__ == "__main__":
    sys.exit(main())
