"""How time and memory grow with cells, teeth, tolerance and workers.

    python -m benchmarks.scaling            # prints the tables
    python -m benchmarks.scaling --store    # and writes them into benchmarks/results/scaling.md
    python -m benchmarks.scaling --part teeth

Processor times, the best of three; each film size in a process of its own, whose peak memory above
that of the loaded program, with what describes the film, is reported. Exponents are slopes of a
straight line through logarithms.
"""

from __future__ import annotations

import argparse
import platform
import re
import resource
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ProcessPoolExecutor
from datetime import date
from multiprocessing import get_context
from pathlib import Path

import numpy as np

import toothspace as ts
from benchmarks.bench_films import SIZES, eliminated, right_side, toothed_film
from toothspace.core.processes import start_worker
from toothspace.studies import run_study

PAGE = Path(__file__).resolve().parents[1] / "benchmarks" / "results" / "scaling.md"
GRIDS = ((240, 64), *SIZES)
TEETH = (10, 12, 14, 16, 20)
TOLERANCES = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
WORKERS = (1, 2, 4, 8)
NODES = (2, 4, 16, 64, 256)
PITCH_DIAMETER = 33e-3
SHIFT, ADDENDUM = 0.3, 1.04
MAP = """
kind = "efficiency_map"
shaft_speed = {from = "500 rpm", to = "3000 rpm", count = 4}
pressure_difference = {from = "60 bar", to = "260 bar", count = 4}
"""
_KIBIBYTE, _MEBIBYTE = 2**10, 2**20
_TABLE = re.compile(r"(?<=<!-- tables -->\n).*?(?=<!-- end of tables -->)", re.DOTALL)


def exponent(x: Sequence[float], y: Sequence[float]) -> float:
    """Slope of the logarithms. [-]."""
    return float(np.polyfit(np.log(x), np.log(y), 1)[0])


def cells() -> list[str]:
    """Set-up and solution of the masked lateral film over its cells."""
    rows = []
    for grid in GRIDS:
        with ProcessPoolExecutor(1, get_context("spawn"), initializer=start_worker) as pool:
            rows.append(pool.submit(_film, grid).result())
    size, seconds, memory = (np.array(column) for column in zip(*rows, strict=True))
    return [
        "| cells of a lateral film | set-up and solution | per cell | memory | per cell |",
        "|---|---|---|---|---|",
        *(
            f"| {n} | {1e3 * s:.1f} ms | {1e6 * s / n:.2f} us | {m / _MEBIBYTE:.0f} MiB "
            f"| {m / n:.0f} byte |"
            for n, s, m in rows
        ),
        f"| exponent | {exponent(size, seconds):.2f} | | {exponent(size[2:], memory[2:]):.2f} | |",
    ]


def _film(grid: tuple[int, int]) -> tuple[int, float, float]:
    _film_seconds((48, 16))  # loads the compiled code
    before = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    seconds = _film_seconds(grid)
    after = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss
    return grid[0] * grid[1], seconds, float(_KIBIBYTE * (after - before))


def _film_seconds(grid: tuple[int, int]) -> float:
    balance, free = toothed_film(*grid)
    stencil, rhs = right_side(balance, free)
    return best(lambda: eliminated(stencil, free).solve(rhs, None, 1e-8))


def best(run: Callable[[], object], repeats: int = 3) -> float:
    """Shortest processor time. [s]."""
    times = []
    for _ in range(repeats):
        began = time.process_time()
        run()
        times.append(time.process_time() - began)
    return min(times)


def revolution(case: ts.Case) -> tuple[float, float]:
    """Steps and processor time of one revolution of a lumped run, from four less two of them."""
    long, short = (case.replace({"run.revolutions": count}) for count in (4, 2))
    ts.simulate(short)
    steps = [ts.simulate(one).statistics["steps"] for one in (long, short)]
    seconds = [best(lambda one=one: ts.simulate(one)) for one in (long, short)]
    return 0.5 * (steps[0] - steps[1]), 0.5 * (seconds[0] - seconds[1])


def _lumped(label: str, cases: Sequence[tuple[float, str, ts.Case]], first: int = 0) -> list[str]:
    found = [(value, text, *revolution(case)) for value, text, case in cases]
    values, texts, steps, seconds = zip(*found, strict=True)
    slopes = [exponent(values[first:], column[first:]) for column in (steps, seconds)]
    begin = f" from {texts[first]}" if first else ""
    return [
        f"| {label} | steps a revolution | processor time | per step |",
        "|---|---|---|---|",
        *(f"| {t} | {n:.0f} | {1e3 * s:.0f} ms | {1e6 * s / n:.1f} us |" for _, t, n, s in found),
        f"| exponent{begin} | {slopes[0]:.2f} | {slopes[1]:.2f} | |",
    ]


def teeth() -> list[str]:
    """A revolution of the motor at equal pitch diameter and face width over its teeth."""
    case, cases = ts.load_case("egm12_motor"), []
    for count in TEETH:
        module = PITCH_DIAMETER / count
        tip = module * (count + 2.0 * (SHIFT + ADDENDUM))
        values = {
            "machine.gears.tooth_count": count,
            "machine.gears.module": ts.Quantity(module, "m"),
            "machine.gears.tip_diameter": ts.Quantity(tip, "m"),
            "run.relative_tolerance": 1e-6,
        }
        cases.append((float(count), str(count), case.replace(values)))
    return _lumped("teeth", cases)


def tolerance() -> list[str]:
    """A revolution of the motor over the relative tolerance."""
    case = ts.load_case("egm12_motor")
    return _lumped(
        "relative tolerance",
        [(x, f"{x:.0e}", case.replace({"run.relative_tolerance": x})) for x in TOLERANCES],
        first=1,
    )


def workers() -> list[str]:
    """An efficiency map of 16 points on one to eight workers, and what more cores would do."""
    text = ts.load_case("egm12_motor").replace({"run.samples_per_revolution": 360}).to_toml()
    case = ts.Case.from_toml(f"{text}\n[study]\n{MAP}", label="map")
    points = 16
    run_study(ts.Case.from_toml(f"{text}\n[study]\n{MAP.replace('4}', '2}')}", label="map"))
    found = {count: study_seconds(case, count) for count in WORKERS}
    alone, two = found[1][0], found[2]
    own, inside = two[0] - two[1], two[1]
    start = max(inside - alone, 0.0) / 2.0
    lines = [
        "| workers | processor time, all processes | share spent on the points |",
        "|---|---|---|",
        *(f"| {n} | {a:.2f} s | {alone / a:.2f} |" for n, (a, _) in found.items()),
        "",
        f"A worker spends {start:.2f} s on its start, the first process {own:.2f} s, a point "
        f"{alone / points:.2f} s. With these a map of 100 points takes:",
        "",
        "| cores | time | efficiency |",
        "|---|---|---|",
    ]
    whole = 100.0 * alone / points
    for cores in (1, *NODES):
        rounds = -(-100 // cores)
        wall = whole if cores == 1 else own + start + rounds * alone / points
        lines.append(f"| {cores} | {wall:.1f} s | {whole / wall / cores:.2f} |")
    return lines


def processor_seconds() -> np.ndarray:
    """Processor time of this process, and of its children that ended. [s]."""
    used = [resource.getrusage(who) for who in (resource.RUSAGE_SELF, resource.RUSAGE_CHILDREN)]
    return np.array([one.ru_utime + one.ru_stime for one in used])


def study_seconds(case: ts.Case, count: int) -> tuple[float, float]:
    """Processor time of a study in all processes, and in its workers."""
    before = processor_seconds()
    run_study(case, workers=count)
    spent = processor_seconds() - before
    return float(spent.sum()), float(spent[1])


PARTS = {"cells": cells, "teeth": teeth, "tolerance": tolerance, "workers": workers}


def main() -> None:
    """Print the tables, and write them into the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.scaling", description=__doc__)
    parser.add_argument("--part", choices=PARTS, help="one table only")
    parser.add_argument("--store", action="store_true", help="write the tables into the page")
    arguments = parser.parse_args()
    chosen = [arguments.part] if arguments.part else list(PARTS)
    state = f"{date.today():%d %B %Y}, Python {platform.python_version()}, NumPy {np.__version__}"
    text = f"{state}, one thread.\n\n"
    for part in chosen:
        table = "\n".join(PARTS[part]())
        print(table, end="\n\n", flush=True)
        text += f"{table}\n\n"
    if arguments.store and not arguments.part:
        page = PAGE.read_text(encoding="utf-8")
        PAGE.write_text(_TABLE.sub(lambda _: text, page), encoding="utf-8")


if __name__ == "__main__":
    main()
