"""What was asked of speed and what is reached, measured by one command.

    python -m benchmarks.goals                # prints the table
    python -m benchmarks.goals --store        # and writes it into the speed page
    python -m benchmarks.goals --part cycle   # measures one row, the others as stored

Ratios to peers are those that ``benchmarks.speed`` stored. Other rows are processor times of all
threads and processes, so that the load of the machine enters little; what is asked is wall time,
on two cores where that is said. A run is repeated once where its first one compiles.
"""

from __future__ import annotations

import argparse
import json
import re
import time
from collections.abc import Callable
from pathlib import Path

import numpy as np

import toothspace as ts
from benchmarks import bench_films, bench_lateral, bench_startup, scaling, speed
from toothspace.studies import run_study

STORE = Path(__file__).with_name("goals.json")
CASES = Path(__file__).resolve().parents[1] / "cases"
MAP = """
kind = "efficiency_map"
shaft_speed = {from = "300 rpm", to = "3000 rpm", count = 10}
pressure_difference = {from = "20 bar", to = "260 bar", count = 10}
"""
_POINTS = 100
_TABLE = re.compile(r"(?<=<!-- goals -->\n).*?(?=<!-- end of goals -->)", re.DOTALL)

Row = tuple[str, str, str, bool]
"""What, what is asked, what is reached, and whether that is what was asked."""


def spent(run: Callable[[], object]) -> float:
    """Processor time of a run in all threads and processes. [s]."""
    began = scaling.processor_seconds()
    run()
    return float((scaling.processor_seconds() - began).sum())


def motor() -> Row:
    """Revolutions a second, and times of CVODE and LSODA at equal error."""
    return _march("EGM-12 motor", (20.0, 8.0, 6.0))


def gerotor() -> Row:
    """The same of the gerotor."""
    return _march("Gerotor", (60.0, 3.0))


def _march(name: str, asked: tuple[float, ...]) -> Row:
    found = [f for f in speed.load() if f.task.startswith(name)][: len(asked) - 1]
    each = 1.0 / min(f.own_seconds for f in found)
    values = (each, *(f.ratio for f in found))
    peers = ", ".join(f.peer.split()[-1] for f in found)
    words = [" revolutions a second; ".join([f"{v[0]:.3g}", ", ".join(f"{x:.2g}" for x in v[1:])])
             for v in (asked, values)]  # fmt: skip
    met = all(v >= a for v, a in zip(values, asked, strict=True))
    return f"{name}; times {peers} at equal error", words[0], words[1], met


def cycle() -> Row:
    """The whole start-stop cycle."""
    bench_startup.cycle()
    seconds = spent(bench_startup.cycle)
    return "start-stop cycle of 20 s", "5 s", f"{seconds:.1f} s", seconds <= 5.0


def bodies() -> Row:
    """A revolution of films between bending bodies, march only."""
    setting = bench_lateral.prepare()
    problem = setting.problem(bench_lateral.GRIDS[-1], "bodies")
    began = time.perf_counter()
    used = bench_lateral.timed(problem, setting.settled, 0, bench_lateral.STEPS).used
    wall = time.perf_counter() - began
    return (
        "revolution between elastic bodies, 2 x 120 176 cells",
        "60 s on two cores",
        f"{used:.0f} s of processor time, {wall:.0f} s of wall time",
        wall <= 60.0,
    )


def loop() -> Row:
    """The hysteresis loop between bending bodies."""
    case = ts.load_case(CASES / "hysteresis_055.toml").replace({"study.coupling_rounds": 1})
    began = time.perf_counter()
    seconds = spent(lambda: run_study(case))
    wall = time.perf_counter() - began
    return (
        "hysteresis loop between elastic bodies, 7 points, chambers once",
        "60 s on two cores",
        f"{seconds:.0f} s of processor time, {wall:.0f} s of wall time",
        wall <= 60.0,
    )


def journal() -> Row:
    """Mass-conserving journal films."""
    asked, found = (2.5, 7.0, 35.0), []
    for grid in ((100, 27), (200, 53), (400, 103)):
        b = bench_films.bearing(*grid)
        found.append(
            _best(lambda b=b: b.solve(eccentricity=(0.5, 0.0), shaft_speed=314.16))  # type: ignore[misc]
        )
    return (
        "mass-conserving journal, 100 x 27, 200 x 53, 400 x 103 cells",
        "2.5, 7, 35 ms",
        ", ".join(f"{1e3 * t:.1f}" for t in found) + " ms",
        all(1e3 * t <= a for t, a in zip(found, asked, strict=True)),
    )


def equilibrium() -> Row:
    """Equilibrium of a bearing with eight coefficients."""
    b = bench_films.bearing(200, 53)

    def study() -> None:
        found = b.equilibrium(load=(1000.0, 300.0), shaft_speed=314.16)
        _ = found.stiffness, found.damping

    each = 1e3 * _best(study)
    words = "equilibrium of a bearing with eight coefficients, 200 x 53 cells"
    return words, "15 ms", f"{each:.0f} ms", each <= 15.0


def _best(run: Callable[[], object], repeats: int = 9) -> float:
    run()
    return min(spent(run) for _ in range(repeats))


def efficiency_map() -> Row:
    """The map of 100 points on one and on two workers."""
    text = ts.load_case("egm12_motor").replace({"run.samples_per_revolution": 360}).to_toml()
    case = ts.Case.from_toml(f"{text}\n[study]\n{MAP}", label="map")
    alone, _ = scaling.study_seconds(case, 1)
    began = time.perf_counter()
    both, _ = scaling.study_seconds(case, 2)
    wall = time.perf_counter() - began
    return (
        f"efficiency map of {_POINTS} points on two workers; share of the time in points",
        "45 s; 0.95",
        f"{wall:.0f} s of wall time, {both:.0f} s of processor time; {alone / both:.2f}",
        wall <= 45.0 and alone / both >= 0.95,
    )


def design() -> Row:
    """Kinematics of one design without tables."""
    case, gears = ts.load_case("egm12_motor"), {"machine.gears.tooth_count": np.array([12])}
    each = 1e3 * _best(lambda: ts.evaluate_designs(case, gears, addendum=1.1), 50)
    return "kinematics of one design", "1 ms", f"{each:.2f} ms", each <= 1.0


PARTS: dict[str, Callable[[], Row]] = {
    "motor": motor,
    "gerotor": gerotor,
    "cycle": cycle,
    "bodies": bodies,
    "loop": loop,
    "journal": journal,
    "equilibrium": equilibrium,
    "map": efficiency_map,
    "design": design,
}


def as_markdown(rows: list[Row]) -> str:
    """Table of the speed page."""
    lines = ["| | asked | reached | |", "|---|---|---|---|"]
    for what, asked, reached, met in rows:
        lines.append(f"| {what} | {asked} | {reached} | {'met' if met else 'not met'} |")
    return "\n".join(lines) + "\n"


def load() -> dict[str, Row]:
    """Stored rows by the name of their part."""
    return {name: tuple(row) for name, row in json.loads(STORE.read_text()).items()}


def main() -> None:
    """Measure and print the rows, and store them."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.goals", description=__doc__)
    parser.add_argument("--part", choices=PARTS, action="append", help="this row only, repeatable")
    parser.add_argument("--store", action="store_true", help="write the table and the page")
    arguments = parser.parse_args()
    rows = load() if STORE.exists() else {}
    for name in arguments.part or PARTS:
        rows[name] = PARTS[name]()
        print(f"{name}: {rows[name][2]}", flush=True)
    rows = {name: rows[name] for name in PARTS if name in rows}
    text = as_markdown(list(rows.values()))
    print(text)
    if arguments.store:
        STORE.write_text(json.dumps(rows, indent=2) + "\n")
        page = speed.PAGE.read_text(encoding="utf-8")
        speed.PAGE.write_text(_TABLE.sub(lambda _: text, page), encoding="utf-8")


if __name__ == "__main__":
    main()
