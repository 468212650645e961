"""Random machines behind a load orifice: is the asked pressure reached, or is it said why not.

``python -m benchmarks.random_orifices --count 200 -o orifices.csv`` draws pumps and motors of all
families over a wide range: 0.1 to 250 cm3, 6 to 40 teeth, 5 to 8 000 rpm, 1.06 to 400 bar, -30 to
140 degC, clearances of none to huge, large and small volumes, a tenth with a line. Each runs in a
process of its own, ended at ``--limit`` seconds of processor time. A run that is done must hold its
mean pressure difference to 0.2 %, mass to 1e-7 and energy to 1e-5. A command that was stopped goes
on where it was; ``--only SEED`` prints one case.
"""

from __future__ import annotations

import math
import random
import re
import time
import tomllib
from collections import Counter
from collections.abc import Iterator
from contextlib import suppress
from typing import Any

from benchmarks import random_designs as designs
from benchmarks.random_designs import log_uniform, run_seeds
from toothspace.api import prepare, simulate
from toothspace.case import Case
from toothspace.case.document import document_text
from toothspace.core.errors import CaseError
from toothspace.model.operating_point import OperatingCondition
from toothspace.results.solution import Solution
from toothspace.run.load_orifice import LOAD_MATCH

_BAR = 1e5
_TRIES = 300
_LENGTH = re.compile(r"([-\d.eE+]+) mm")
_FLUIDS = {"iso_vg_32": 100.0, "iso_vg_46": 100.0, "iso_vg_68": 100.0, "jet_a1": 140.0}
"""Fluids with the highest temperature that is drawn. [degC]"""
_NUMBERS = (
    "status",
    "mass_balance_error",
    "energy_balance_error",
    "volumetric_efficiency",
    "max_chamber_pressure_bar",
    "outlet_temperature_degC",
    "drain_temperature_degC",
    "outlet_pressure_bar",
)
COLUMNS = (
    *("seed", "family", "mode", "processor_s", "asked_bar", "miss", *_NUMBERS),
    *("revolutions", "told"),
)


def scaled(value: Any, factor: float) -> Any:
    """Tables with every length in millimetres multiplied."""
    if isinstance(value, dict):
        return {key: scaled(entry, factor) for key, entry in value.items()}
    if isinstance(value, str) and (found := _LENGTH.fullmatch(value)):
        return f"{float(found[1]) * factor:.5f} mm"
    return value


def gap(draw: random.Random) -> str:
    """Clearance from next to none to huge."""
    return f"{log_uniform(draw, 1.0, 400.0):.4g} um"


def drawn(family: str, draw: random.Random) -> dict[str, Any]:
    """Tables of one machine, of its own size, teeth and clearances."""
    tables = designs.drawn(family, draw)
    machine = tables["machine"]
    if family == "external_gear":
        gears, teeth = machine["gears"], draw.randint(6, 40)
        module = float(gears["module"].split()[0])
        gears |= {
            "tooth_count": teeth,
            "tip_diameter": f"{module * (teeth + 2.0 * (1.0 + gears['profile_shift'])):.4f} mm",
        }
        for name in ("diameter", "length"):
            machine["journal_bearings"][name] = f"{module * teeth * draw.uniform(0.4, 0.7):.3f} mm"
        machine["casing"]["radial_clearance"] = gap(draw)
        machine["casing"].pop("wear_in", None)
        if draw.random() < 0.3:
            machine["driven_gear"] = {"tooth_count": max(6, teeth + draw.randint(-4, 4))}
    elif family == "crescent":
        machine["filler"] |= {"pinion_clearance": gap(draw), "ring_clearance": gap(draw)}
    else:
        machine["rotors"]["tip_clearance"] = gap(draw)
        if family == "trochoidal":
            machine["rotors"]["inner_tooth_count"] = draw.randint(4, 12)
    machine["lateral"]["side_gap"] = gap(draw)
    tables["machine"] = scaled(machine, log_uniform(draw, 0.2, 1.8))
    for port in ("inlet", "outlet"):
        tables["machine"][port]["volume"] = f"{log_uniform(draw, 5.0, 1000.0):.4g} cm^3"
    return tables


def condition(draw: random.Random, tables: dict[str, Any]) -> None:
    """Mode, fluid and operating point with a load orifice."""
    mode, fluid = draw.choice(("pump", "pump", "motor")), draw.choice(tuple(_FLUIDS))
    tables["machine"]["mode"] = mode
    tables["fluid"] = {
        "name": fluid,
        "temperature": f"{draw.uniform(-30.0, _FLUIDS[fluid]):.1f} degC",
        "free_air_fraction": draw.choice((0.0005, 0.002, 0.02)),
        "dissolved_air_fraction": draw.choice((0.0, 0.08, 0.12)),
        "gas_law": draw.choice(("dynamic", "equilibrium", "none")),
    }
    outlet = log_uniform(draw, 1.06, 400.0)
    inlet = outlet * log_uniform(draw, 1.2, 10.0)
    if mode == "pump":
        inlet = min(draw.uniform(0.7, 5.0), outlet)
    point: dict[str, Any] = {
        "shaft_speed": f"{log_uniform(draw, 5.0, 8000.0):.5g} rpm",
        "inlet_pressure": f"{min(inlet, 500.0):.5g} bar",
        "outlet_pressure": f"{outlet:.5g} bar",
        "outlet_load": "orifice",
    }
    if mode == "pump" and draw.random() < 0.1:
        point["line"] = {
            "length": f"{draw.uniform(0.2, 3.0):.2f} m",
            "bore": f"{draw.uniform(4.0, 20.0):.1f} mm",
        }
    tables["operating_point"] = point
    tables["run"] = {"fidelity": "lumped", "until": "cyclic", "samples_per_revolution": 360}


def texts(seed: int) -> Iterator[str]:
    """Case texts of a seed: each is another draw, for where the one before is refused."""
    draw = random.Random(f"orifice {seed}")
    family = designs.FAMILIES[seed % len(designs.FAMILIES)]
    for _ in range(_TRIES):
        tables = drawn(family, draw)
        condition(draw, tables)
        tables.pop("heat", None)
        tables["title"] = f"random orifice {seed}, {family}"
        yield document_text(tables)


def first_case(seed: int) -> tuple[str, Case]:
    """Text and case of the first draw that can be built."""
    for text in texts(seed):
        with suppress(CaseError):
            case = Case.from_toml(text, designs.CASES)
            prepare(case)
            return text, case
    raise CaseError(f"design {seed}: found none that can be built in {_TRIES} draws")


def row_of(seed: int) -> dict[str, Any]:
    """Run one machine; what came out as one row."""
    text, case = first_case(seed)
    tables, started = tomllib.loads(text), time.process_time()
    asked = float(tables["operating_point"]["outlet_pressure"].split()[0])
    row: dict[str, Any] = {
        "seed": seed,
        "family": tables["title"].split(", ")[1],
        "mode": tables["machine"]["mode"],
        "asked_bar": asked,
    }
    try:
        found: Solution | Exception = simulate(case)
    except Exception as error:  # what a design may never do is a row of its own
        found = error
    row["processor_s"] = time.process_time() - started
    if isinstance(found, Exception):
        return row | {"status": f"{type(found).__name__}: {found}"}
    numbers = found.summary()
    reached = float(numbers["outlet_pressure_bar"])
    row |= {name: numbers[name] for name in _NUMBERS}
    row["miss"] = abs(reached - asked) / (asked - OperatingCondition.load_pressure / _BAR)
    row["revolutions"] = found.statistics.get("revolutions", math.nan)
    row["told"] = designs.warnings_in(found)
    return row


def report(rows: list[dict[str, Any]]) -> None:
    """Print what came out, and the seeds to look at."""
    done = [row for row in rows if row["status"] == "done"]
    print(f"{len(rows)} runs; statuses {dict(Counter(str(row['status'])[:60] for row in rows))}")
    limits = {
        "miss": LOAD_MATCH,
        "mass_balance_error": designs.MASS_LIMIT,
        "energy_balance_error": designs.ENERGY_LIMIT,
    }
    for name, limit in limits.items():
        if done:
            worst = max(done, key=lambda row: row[name])
            beyond = [int(row["seed"]) for row in done if not row[name] <= limit]
            print(f"{name}, done: worst {worst[name]:.2e}, above {limit:g}: {beyond}")
    hot = [row for row in rows if row.get("drain_temperature_degC", 0.0) > 150.0]
    silent = [int(row["seed"]) for row in hot if "emperature" not in str(row.get("told", ""))]
    print(f"above 150 degC: {len(hot)}, of them without a word {silent}")
    print(f"not done: {[int(row['seed']) for row in rows if row not in done]}")


def main() -> None:
    run_seeds(
        "random_orifices", __doc__, row_of, report, lambda seed: first_case(seed)[0], COLUMNS, 200
    )


if __name__ == "__main__":
    main()
