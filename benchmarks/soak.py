"""Many runs in one process: do memory, open files, threads and caches stay bounded.

``python -m benchmarks.soak --count 10000 -o soak.csv`` runs machines of all families one after
another, each with a speed and a temperature of its own and every tenth with a design of its own,
so that what is kept by its values grows. Every fiftieth run is lumped, the others ideal; every
hundredth is saved and read again. Memory, open files, threads, objects and the entries of all
caches of functions are written down on the way. The second half must need no more of each than the
first half at its peak, memory by 5 % and 20 MB at most: else the exit code is 1.
"""

from __future__ import annotations

import argparse
import csv
import functools
import gc
import os
import random
import sys
import tempfile
import time
from pathlib import Path
from typing import Any

import psutil

from benchmarks.random_designs import CASES
from toothspace import api
from toothspace.case import Case
from toothspace.results.solution import load_solution

FAMILIES = {
    "gerotor_trochoidal": (9, "machine.rotors.face_width", 8.0, 30.0),
    "gerotor_cycloidal": (9, "machine.rotors.face_width", 8.0, 30.0),
    "egm12_pump": (1, "machine.gears.face_width", 10.0, 40.0),
    "crescent_pump": (1, "machine.pinion.face_width", 15.0, 60.0),
}
"""Cases, how often each is drawn, and a length of each that varies. [mm]"""
QUICK: dict[str, dict[str, Any]] = {"egm12_pump": {"machine.casing.wear_in": None}}
"""What is left out because it takes long."""
LUMPED, SAVED, OWN = 50, 100, 10
"""Every so many runs: one that is lumped, saved, of a design of its own."""
COLUMNS = ("run", "minutes", "rss_MB", "files", "threads", "objects", "cached", "drafts")
SLACK, SLACK_MB = 1.05, 20.0
"""How much more memory the second half may need. [-], [MB]"""


def case_of(number: int, bases: dict[str, Case]) -> Case:
    """Case of a run: one of the families, changed so that no other run has the same."""
    draw = random.Random(number)
    [name] = draw.choices([*FAMILIES], [often for often, *_ in FAMILIES.values()])
    _, key, low, high = FAMILIES[name]
    lumped = number % LUMPED == LUMPED - 1
    design = {key: f"{draw.uniform(low, high):.6f} mm"} if number % OWN == 0 else {}
    return bases[name].replace(
        {
            "fluid.temperature": f"{draw.uniform(20.0, 80.0):.5f} degC",
            "operating_point.shaft_speed": f"{draw.uniform(500.0, 3000.0):.5f} rpm",
            "operating_point.outlet_load": "fixed_pressure",
            "run.fidelity": "lumped" if lumped else "ideal",
            "run.samples_per_revolution": 90 if lumped else 36,
            "heat.model": "network" if lumped else None,
            **QUICK.get(name, {}),
            **design,
        }
    )


def caches() -> int:
    """Entries of the caches of all functions of the package."""
    found = [each for each in gc.get_objects() if isinstance(each, functools._lru_cache_wrapper)]
    return sum(
        each.cache_info().currsize
        for each in found
        if getattr(each, "__module__", "").startswith("toothspace")
    )


def state(run: int, started: float) -> dict[str, float]:
    """What this process holds after a run."""
    gc.collect()
    me = psutil.Process()
    return {
        "run": run,
        "minutes": round((time.perf_counter() - started) / 60.0, 2),
        "rss_MB": round(me.memory_info().rss / 1e6, 1),
        "files": me.num_fds() if os.name == "posix" else me.num_handles(),
        "threads": me.num_threads(),
        "objects": len(gc.get_objects()),
        "cached": caches(),
        "drafts": len(list(Path(tempfile.gettempdir()).iterdir())),
    }


def grown(rows: list[dict[str, float]]) -> list[str]:
    """What the second half holds more of than the first, the start left out."""
    middle = len(rows) // 2
    first, second = rows[middle // 4 : middle], rows[middle:]
    found = []
    for name in COLUMNS[2:]:
        before, after = (max(row[name] for row in part) for part in (first, second))
        slack = SLACK * before + (SLACK_MB if name == "rss_MB" else 0.0)
        if after > (slack if name in {"rss_MB", "objects", "cached"} else before + 1):
            found.append(f"{name}: {before:g} before, {after:g} after")
    return found


def main() -> int:
    """Run so many cases; 1 if something grows or a run is not done."""
    parser = argparse.ArgumentParser("python -m benchmarks.soak", description=__doc__)
    parser.add_argument("--count", type=int, default=10_000)
    parser.add_argument("--every", type=int, default=250, help="runs from one row to the next")
    parser.add_argument("-o", "--output", type=Path, default=Path("soak.csv"))
    given = parser.parse_args()
    bases = {name: api.load_case(CASES / f"{name}.toml") for name in FAMILIES}
    rows: list[dict[str, float]] = []
    statuses: dict[str, int] = {}
    started = time.perf_counter()
    with (
        given.output.open("w", encoding="utf-8", newline="") as file,
        tempfile.TemporaryDirectory() as folder,
    ):
        tempfile.tempdir = folder
        writer = csv.DictWriter(file, COLUMNS)
        writer.writeheader()
        for number in range(given.count):
            solution = api.simulate(case_of(number, bases))
            solution.summary()
            list(solution.findings)
            if number % SAVED == SAVED - 1:
                load_solution(solution.save(Path(folder) / "run.nc")).summary()
            name = solution.status.name
            statuses[name] = statuses.get(name, 0) + 1
            if number % given.every == given.every - 1:
                rows.append(state(number + 1, started))
                writer.writerow(rows[-1])
                file.flush()
    print(statuses)
    more = grown(rows)
    print("\n".join(more) or "nothing grows")
    return int(bool(more) or set(statuses) != {"DONE"})


if __name__ == "__main__":
    sys.exit(main())
