"""Random machines at random conditions: how many runs finish, how well they balance.

``python -m benchmarks.random_designs --count 1000 --workers 2 -o designs.csv`` draws external
gear machines, gerotors and internal gears with a crescent, pumps and motors, with and without
relief grooves, 1 to 350 bar, 1 to 8 000 rpm, -20 to 120 degC and clearances from 5 to 100 um, runs
each in a process of its own, which is ended at ``--limit`` seconds of processor time, appends one
row per design and prints a table. ``--only SEED`` prints the case of one design instead, to be run
and looked at alone. Designs whose geometry is refused are drawn again. A command that was stopped
goes on where it was: seeds that the file has already are left out.
"""

from __future__ import annotations

import argparse
import csv
import math
import random
import resource
import signal
import time
import tomllib
from collections import Counter
from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from multiprocessing import connection, get_context
from pathlib import Path
from typing import Any

import numpy as np

from toothspace.api import prepare, simulate
from toothspace.case import Case
from toothspace.case.document import document_text
from toothspace.core.errors import CaseError
from toothspace.results.solution import Solution

CASES = Path(__file__).resolve().parent.parent / "cases"
FLUIDS = ("iso_vg_32", "iso_vg_46")
MASS_LIMIT, ENERGY_LIMIT = 1e-7, 1e-5
FAMILIES = ("external_gear", "trochoidal", "cycloidal", "crescent")
_TRIES = 200
_NUMBERS = (
    "status",
    "mass_balance_error",
    "energy_balance_error",
    "volumetric_efficiency",
    "overall_efficiency",
    "max_chamber_pressure_bar",
    "min_chamber_pressure_bar",
    "shaft_speed_rpm",
)
_TEXTS = ("warnings", "not_finite")
_COLUMNS = ("seed", "family", "mode", "run_s", "processor_s", *_NUMBERS, "revolutions", *_TEXTS)
_UNPHYSICAL: dict[str, Callable[[dict[str, Any]], bool]] = {
    "volumetric efficiency above 1": lambda row: row["volumetric_efficiency"] > 1.0 + 1e-3,
    "overall efficiency above 1": lambda row: row["overall_efficiency"] > 1.0,
    "pressure not positive": lambda row: row["min_chamber_pressure_bar"] <= 0.0,
    "pressure above 1000 bar": lambda row: row["max_chamber_pressure_bar"] > 1000.0,
}


def tables_of(name: str) -> dict[str, Any]:
    return tomllib.loads((CASES / f"{name}.toml").read_text(encoding="utf-8"))


def log_uniform(draw: random.Random, low: float, high: float) -> float:
    return math.exp(draw.uniform(math.log(low), math.log(high)))


def clearance(draw: random.Random, low: float = 5.0, high: float = 100.0) -> str:
    return f"{log_uniform(draw, low, high):.3g} um"


def external_gear(draw: random.Random) -> dict[str, Any]:
    """Gears of 8 to 20 teeth with the casing, bearings and grooves of the 12-tooth design."""
    tables = tables_of("egm12_pump")
    machine = tables["machine"]
    module = draw.uniform(1.5, 4.5)
    teeth = draw.randint(8, 20)
    shift = draw.uniform(0.0, 0.5)
    machine["gears"] |= {
        "tooth_count": teeth,
        "module": f"{module:.3f} mm",
        "pressure_angle": f"{draw.uniform(18.0, 28.0):.2f} deg",
        "profile_shift": round(shift, 3),
        "tip_diameter": f"{module * (teeth + 2.0 * (1.0 + shift)):.3f} mm",
        "face_width": f"{module * draw.uniform(2.0, 9.0):.2f} mm",
        "normal_backlash": f"{draw.uniform(0.01, 0.1) * module:.3f} mm",
        "tip_rounding": f"{0.03 * module:.3f} mm",
    }
    machine["casing"]["radial_clearance"] = clearance(draw)
    if draw.random() < 0.5:
        del machine["casing"]["wear_in"]
    machine["journal_bearings"] |= {
        "diameter": f"{module * teeth * draw.uniform(0.4, 0.6):.2f} mm",
        "length": f"{module * teeth * draw.uniform(0.4, 0.7):.2f} mm",
        "radial_clearance": clearance(draw, 5.0, 50.0),
    }
    machine["bearing_blocks"]["radial_clearance"] = clearance(draw)
    machine["lateral"]["side_gap"] = clearance(draw, 5.0, 40.0)
    offset = module * math.pi * math.cos(math.radians(20.0)) ** 2 / 2.0
    groove = f"{offset * draw.uniform(0.95, 1.1):.3f} mm"
    machine["relief_grooves"] |= {"closing_side_offset": groove, "opening_side_offset": groove}
    if draw.random() < 0.3:
        del machine["relief_grooves"]
    return tables


def gerotor(kind: str, draw: random.Random) -> dict[str, Any]:
    """Rotors of 4 to 9 inner teeth, their ports and housing in proportion."""
    tables = tables_of(f"gerotor_{kind}")
    machine = tables["machine"]
    size = draw.uniform(0.6, 2.0)
    lengths = {
        "rotors": ("eccentricity", "generating_radius", "lobe_radius", "face_width"),
        "housing": ("outer_rotor_diameter",),
        "ports": ("inner_radius", "outer_radius"),
    }
    for table, names in lengths.items():
        for name in names:
            if name in machine.get(table, {}):
                value = float(machine[table][name].split()[0])
                machine[table][name] = f"{value * size * draw.uniform(0.97, 1.03):.4f} mm"
    if kind == "cycloidal":
        machine["rotors"]["inner_tooth_count"] = draw.randint(4, 9)
    machine["rotors"]["tip_clearance"] = clearance(draw)
    machine["housing"]["radial_clearance"] = clearance(draw, 20.0, 100.0)
    machine["lateral"]["side_gap"] = clearance(draw)
    return tables


def crescent(draw: random.Random) -> dict[str, Any]:
    """Internal gears with the teeth of the reference design and clearances of their own."""
    tables = tables_of(f"crescent_{draw.choice(('pump', 'motor'))}")
    machine = tables["machine"]
    machine["pinion"]["face_width"] = f"{draw.uniform(15.0, 60.0):.2f} mm"
    machine["pinion"]["normal_backlash"] = f"{draw.uniform(0.05, 0.3):.3f} mm"
    machine["ring"]["radial_clearance"] = clearance(draw, 30.0, 100.0)
    machine["filler"]["pinion_clearance"] = clearance(draw)
    machine["filler"]["ring_clearance"] = clearance(draw)
    machine["journal_bearings"]["radial_clearance"] = clearance(draw, 10.0, 60.0)
    machine["lateral"]["side_gap"] = clearance(draw)
    if draw.random() < 0.3:
        del machine["relief_grooves"]
    return tables


def drawn(family: str, draw: random.Random) -> dict[str, Any]:
    """Tables of one draw of a family, without its condition."""
    if family == "external_gear":
        return external_gear(draw)
    return crescent(draw) if family == "crescent" else gerotor(family, draw)


def condition(draw: random.Random, tables: dict[str, Any]) -> None:
    """Mode, fluid and operating point."""
    mode = draw.choice(("pump", "motor"))
    tables["machine"]["mode"] = mode
    tables["fluid"] |= {
        "name": draw.choice(FLUIDS),
        "temperature": f"{draw.uniform(-20.0, 120.0):.1f} degC",
        "free_air_fraction": round(draw.uniform(0.0, 0.02), 4),
    }
    high, low = f"{log_uniform(draw, 5.0, 350.0):.4g} bar", f"{draw.uniform(1.0, 5.0):.3g} bar"
    inlet, outlet = (high, low) if mode == "motor" else (low, high)
    speed = log_uniform(draw, 1.0, 8000.0)
    tables["operating_point"] = {
        "shaft_speed": f"{speed:.4g} rpm",
        "inlet_pressure": inlet,
        "outlet_pressure": outlet,
    }


def designs(seed: int) -> Iterator[str]:
    """Case texts of a seed: each is another draw, for where the one before is refused."""
    draw = random.Random(seed)
    family = FAMILIES[seed % len(FAMILIES)]
    for _ in range(_TRIES):
        tables = drawn(family, draw)
        condition(draw, tables)
        tables["title"] = f"random design {seed}, {family}"
        yield document_text(tables)


def first_case(seed: int) -> tuple[str, Case]:
    """Text and case of the first draw whose machine can be built."""
    for text in designs(seed):
        with suppress(CaseError):
            case = Case.from_toml(text, CASES)
            prepare(case)
            return text, case
    raise CaseError(f"design {seed}: found none that can be built in {_TRIES} draws")


def row_of(seed: int) -> dict[str, Any]:
    """Run one design; what came out as one row."""
    text, case = first_case(seed)
    tables = tomllib.loads(text)
    started = time.perf_counter(), time.process_time()
    try:
        found: Solution | Exception = simulate(case)
    except Exception as error:  # what a design may never do is a row of its own
        found = error
    row: dict[str, Any] = {
        "seed": seed,
        "family": tables["title"].split(", ")[1],
        "mode": tables["machine"]["mode"],
        "run_s": time.perf_counter() - started[0],
        "processor_s": time.process_time() - started[1],
    }
    if isinstance(found, Exception):
        return row | {"status": f"{type(found).__name__}: {found}"}
    numbers = found.summary()
    row |= {name: numbers[name] for name in _NUMBERS}
    row["revolutions"] = found.statistics.get("revolutions", math.nan)
    row["warnings"] = warnings_in(found)
    row["not_finite"] = " ".join(not_finite(found))
    return row


def warnings_in(solution: Solution) -> str:
    return solution.provenance.get("warnings", "").replace("\n", " | ")


def not_finite(solution: Solution) -> Iterator[str]:
    """Names of variables that hold a number that is none."""
    for name, values in solution.data.data_vars.items():
        if values.dtype.kind == "f" and not np.isfinite(values.values).all():
            yield str(name)


def good(row: dict[str, Any]) -> bool:
    """Whether a design did all that is asked."""
    return (
        row["status"] == "done"
        and row["mass_balance_error"] <= MASS_LIMIT
        and row["energy_balance_error"] <= ENERGY_LIMIT
    )


def report(rows: list[dict[str, Any]]) -> None:
    """Print the table of all rows, and the seeds of those to look at."""
    finished = [row for row in rows if "mass_balance_error" in row]
    if not finished:
        print("no design finished")
        return
    times = np.sort([row["processor_s"] for row in finished])
    energy = np.array([row["energy_balance_error"] for row in finished])
    print(f"{len(rows)} designs; statuses {dict(Counter(row['status'] for row in rows))}")
    print(f"all that is asked: {100.0 * np.mean([good(row) for row in finished]):.1f} %")
    print(f"mass error, worst:   {max(row['mass_balance_error'] for row in finished):.1e}")
    print(
        f"energy error: worst {energy.max():.1e}, above 1e-5 {100 * np.mean(energy > 1e-5):.1f} %"
    )
    print(f"revolutions: most {max(row['revolutions'] for row in finished):.0f}")
    slowest = np.quantile(times, 0.99) / np.median(times)
    print(
        f"processor: median {np.median(times):.2f} s, 99th percentile {slowest:.1f} times as long"
    )
    for name, wrong in _UNPHYSICAL.items():
        found = [row for row in finished if wrong(row)]
        unsaid = [row["seed"] for row in found if not row["warnings"]]
        print(f"{name}: {len(found)}, of them without a warning {unsaid}")
    print(f"variables not finite: {dict(Counter(row['not_finite'] for row in finished))}")
    print(f"to look at: {[row['seed'] for row in rows if row not in finished or not good(row)]}")


def finished_rows(
    seeds: list[int], workers: int, limit: int, row: Callable[[int], dict[str, Any]]
) -> Iterator[dict[str, Any]]:
    """Rows in the order in which designs end, each in a process that may compute so long. [s]."""
    fork = get_context("fork")
    waiting, running = seeds[::-1], dict[Any, Any]()
    while waiting or running:
        while waiting and len(running) < workers:
            ours, theirs = fork.Pipe(duplex=False)
            seed = waiting.pop()
            process = fork.Process(target=send_row, args=(theirs, seed, limit, row))
            process.start()
            theirs.close()
            running[ours] = seed, process
        for ours in connection.wait(list(running)):
            seed, process = running.pop(ours)
            try:
                yield ours.recv()
            except EOFError:
                process.join()
                ended = signal.Signals(-process.exitcode).name
                yield {"seed": seed, "status": f"ended by {ended} within {limit} s"}
            process.join()


def send_row(pipe: Any, seed: int, limit: int, row: Callable[[int], dict[str, Any]]) -> None:
    resource.setrlimit(resource.RLIMIT_CPU, (limit, limit + 1))
    pipe.send(row(seed))


def append(row: dict[str, Any], path: Path, columns: Sequence[str]) -> None:
    begins = not path.exists()
    with path.open("a", encoding="utf-8", newline="") as file:
        writer = csv.DictWriter(file, columns)
        if begins:
            writer.writeheader()
        writer.writerow(row)


def read(path: Path) -> list[dict[str, Any]]:
    """Rows of a file that was written before; none where there is no file."""
    if not path.exists():
        return []
    with path.open(encoding="utf-8", newline="") as file:
        return [
            {name: number(text) for name, text in row.items() if text or name in _TEXTS}
            for row in csv.DictReader(file)
        ]


def number(text: str) -> float | str:
    try:
        return float(text)
    except ValueError:
        return text


def run_seeds(
    name: str,
    about: str | None,
    row_of: Callable[[int], dict[str, Any]],
    report: Callable[[list[dict[str, Any]]], None],
    case_text: Callable[[int], str],
    columns: Sequence[str],
    count: int,
    limit: int = 120,
) -> None:
    """Run the seeds that the table of a program does not hold yet, and report on all of it.

    Parameters
    ----------
    name, about : str
        Program in ``benchmarks``, and what it says of itself.
    row_of, report, case_text : callable
        Row of a seed, what is printed of all rows, and the case of a seed.
    columns : sequence of str
        Columns of the table.
    count, limit : int
        How many seeds, and the processor time of one, if not given. [-], [s]
    """
    parser = argparse.ArgumentParser(f"python -m benchmarks.{name}", description=about)
    parser.add_argument("--count", type=int, default=count)
    parser.add_argument("--first", type=int, default=0, help="first seed")
    parser.add_argument("--workers", type=int, default=1)
    parser.add_argument("--limit", type=int, default=limit, help="processor time of a seed [s]")
    parser.add_argument("--only", type=int, metavar="SEED", help="print the case of this seed")
    parser.add_argument("-o", "--output", type=Path, default=Path(f"{name}.csv"))
    given = parser.parse_args()
    if given.only is not None:
        print(case_text(given.only))
        return
    rows = read(given.output)
    known = {row["seed"] for row in rows}
    seeds = [seed for seed in range(given.first, given.first + given.count) if seed not in known]
    for row in finished_rows(seeds, given.workers, given.limit, row_of):
        rows.append(row)
        append(row, given.output, columns)
    report(rows)


def main() -> None:
    run_seeds(
        "random_designs", __doc__, row_of, report, lambda s: first_case(s)[0], _COLUMNS, 30, 300
    )


if __name__ == "__main__":
    main()
