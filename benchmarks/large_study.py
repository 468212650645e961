"""Memory and time that a study of many points takes beside its runs.

``python -m benchmarks.large_study COUNT``: a sweep of ``egm12_pump`` with the preset ``ideal``,
of which one point is run; the others have its numbers. The result stands in the tutorial on
clusters.
"""

from __future__ import annotations

import argparse
import resource
import tempfile
import time
from pathlib import Path

from toothspace import api
from toothspace.case import Case
from toothspace.studies import run_study


def large_case(count: int) -> Case:
    """Sweep of so many speeds."""
    tables = api.load_case("egm12_pump").to_dict()
    tables.pop("heat", None)
    del tables["machine"]["casing"]["wear_in"]
    tables["run"] = {"fidelity": "ideal"}
    speeds = {"from": "500 rpm", "to": "3000 rpm", "count": count}
    tables["study"] = {"kind": "sweep", "vary": {"operating_point.shaft_speed": speeds}}
    return Case.from_dict(tables)


def main() -> None:
    """Run it once and print time, highest memory of this process and sizes of the files."""
    parser = argparse.ArgumentParser()
    parser.add_argument("count", type=int)
    given = parser.parse_args()
    solution = api.simulate(large_case(2).at_point({}))
    api.simulate = lambda case: solution
    with tempfile.TemporaryDirectory() as name:
        folder, begin = Path(name) / "study", time.perf_counter()
        result = run_study(large_case(given.count), folder)
        took = time.perf_counter() - begin
        begin = time.perf_counter()
        run_study(large_case(given.count), folder, resume=True)
        again = time.perf_counter() - begin
        memory = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024.0
        sizes = {path.name: path.stat().st_size >> 10 for path in sorted(folder.iterdir())}
    print(f"{given.count} points: {result.status.name}, {took:.1f} s, resumed in {again:.1f} s")
    print(f"highest memory {memory:.0f} MiB; files in KiB: {sizes}")


if __name__ == "__main__":
    main()
