"""Machines of a wide distribution: none may fail without a reason, and no odd number go unsaid.

``python -m benchmarks.random_machines --count 1000 -o machines.csv`` draws external gear machines
of 6 to 40 teeth and 0.1 to 250 cm3, gerotors and internal gears with a crescent, 5 to 8 000 rpm, 1
to 400 bar, -30 to 140 degC, with clearances from next to none to a millimetre. A design may be
refused in words, or end with a status; it may not end with another error, or compute longer than
``--limit``. Of those done it counts balances, and looks at efficiencies outside 0 to 1 and at
pressures outside the fluid: each must be named by a finding. ``--only SEED`` prints the case of one
machine. A command that was stopped goes on where it was.
"""

from __future__ import annotations

import math
import random
import time
from collections import Counter
from typing import Any

from benchmarks.random_designs import (
    CASES,
    ENERGY_LIMIT,
    FAMILIES,
    MASS_LIMIT,
    clearance,
    drawn,
    log_uniform,
    run_seeds,
    warnings_in,
)
from toothspace.api import simulate
from toothspace.case import Case
from toothspace.case.document import document_text
from toothspace.core.errors import CaseError
from toothspace.results.solution import Solution

FLUIDS = ("iso_vg_32", "iso_vg_46", "iso_vg_68", "jet_a1")
_NUMBERS = ("status", "mass_balance_error", "energy_balance_error")
_COLUMNS = ("seed", "family", "run_s", "processor_s", *_NUMBERS, "unsaid", "warnings")
_SHARES = ("volumetric_efficiency", "overall_efficiency")
_LEAST, _MOST = 0.0, 1.0 + 1e-3
_WIDEST = 1000.0


def external_gear(draw: random.Random) -> dict[str, Any]:
    """Gears of 6 to 40 teeth with the parts of the 12-tooth design, or without."""
    tables = drawn("external_gear", draw)
    machine = tables["machine"]
    teeth, volume = draw.randint(6, 40), log_uniform(draw, 0.1, 250.0)
    slender = draw.uniform(2.0, 9.0)
    # displacement of about 2 pi b m2 z, with a face width of so many modules
    module = (1000.0 * volume / (2.0 * math.pi * slender * teeth)) ** (1.0 / 3.0)
    shift = draw.uniform(-0.2, 0.5)
    machine["gears"] |= {
        "tooth_count": teeth,
        "module": f"{module:.4f} mm",
        "profile_shift": round(shift, 3),
        "tip_diameter": f"{module * (teeth + 2.0 * (1.0 + shift)):.4f} mm",
        "face_width": f"{slender * module:.3f} mm",
        "normal_backlash": f"{draw.uniform(0.0, 0.15) * module:.4f} mm",
        "tip_rounding": f"{0.03 * module:.4f} mm",
    }
    machine["gears"].pop("tool_tip_radius", None)
    machine["journal_bearings"] |= {
        "diameter": f"{module * teeth * draw.uniform(0.4, 0.6):.3f} mm",
        "length": f"{module * teeth * draw.uniform(0.4, 0.7):.3f} mm",
        "radial_clearance": clearance(draw, 1.0, 300.0),
    }
    machine["casing"]["radial_clearance"] = clearance(draw, 1.0, _WIDEST)
    machine["lateral"]["side_gap"] = clearance(draw, 0.5, 300.0)
    machine.pop("floating_bearing", None)
    if draw.random() < 0.5:
        machine.pop("relief_grooves", None)
    elif "relief_grooves" in machine:
        offset = f"{module * math.pi * math.cos(math.radians(20.0)) ** 2 / 2.0:.4f} mm"
        machine["relief_grooves"] = {
            "closing_side_offset": offset,
            "opening_side_offset": offset,
            "depth": f"{0.5 * module:.4f} mm",
        }
    return tables


def case_text(seed: int) -> str:
    """Case of a seed, whatever becomes of it."""
    draw = random.Random(seed)
    family = FAMILIES[seed % len(FAMILIES)]
    tables = external_gear(draw) if family == "external_gear" else drawn(family, draw)
    mode = draw.choice(("pump", "motor"))
    tables["machine"]["mode"] = mode
    tables["fluid"] |= {
        "name": draw.choice(FLUIDS),
        "temperature": f"{draw.uniform(-30.0, 140.0):.1f} degC",
    }
    low = draw.uniform(0.3, 5.0)
    high = low + log_uniform(draw, 0.5, 400.0)
    inlet, outlet = (high, low) if mode == "motor" else (low, high)
    tables["operating_point"] = {
        "shaft_speed": f"{log_uniform(draw, 5.0, 8000.0):.4g} rpm",
        "inlet_pressure": f"{inlet:.4g} bar",
        "outlet_pressure": f"{outlet:.4g} bar",
    }
    tables.pop("heat", None)
    tables["run"] = {"fidelity": "lumped", "until": "cyclic", "samples_per_revolution": 180}
    tables["title"] = f"random machine {seed}, {family}"
    return document_text(tables)


def row_of(seed: int) -> dict[str, Any]:
    """Run one machine; what came out as one row."""
    row: dict[str, Any] = {"seed": seed, "family": FAMILIES[seed % len(FAMILIES)]}
    started = time.perf_counter(), time.process_time()
    try:
        found: Solution | Exception = simulate(Case.from_toml(case_text(seed), CASES))
    except CaseError as error:
        return row | {"status": "refused", "warnings": str(error)[:300]}
    except Exception as error:  # what a machine may never do is a row of its own
        return row | {"status": f"{type(error).__name__}: {error}"}
    row["run_s"] = time.perf_counter() - started[0]
    row["processor_s"] = time.process_time() - started[1]
    numbers = found.summary()
    row |= {name: numbers[name] for name in _NUMBERS}
    return row | {"unsaid": " ".join(unsaid(found)), "warnings": warnings_in(found)}


def unsaid(solution: Solution) -> list[str]:
    """Numbers of a run that is done which are outside their range, and which no finding names."""
    if not solution.status.succeeded:
        return []
    told = " ".join(f"{x.quantity} {x.text}".lower() for x in solution.findings)
    numbers, found = solution.summary(), []
    for name in _SHARES:
        value = float(numbers[name])
        words = name.replace("_", " ") in told or "the shaft is driven from outside" in told
        words = words or "runs backwards" in told
        if math.isfinite(value) and not _LEAST <= value <= _MOST and not words:
            found.append(f"{name}={value:.4g}")
    if float(numbers["max_chamber_pressure_bar"]) > 1000.0 and "highest pressure" not in told:
        found.append("pressure")
    return found


def report(rows: list[dict[str, Any]]) -> None:
    """Print the table of all rows, and the seeds of those to look at."""
    ran = [row for row in rows if "mass_balance_error" in row]
    done = [row for row in ran if row["status"] == "done"]
    print(f"{len(rows)} machines; {dict(Counter(str(row['status'])[:40] for row in rows))}")
    for name, limit in (("mass", MASS_LIMIT), ("energy", ENERGY_LIMIT)):
        errors = [row[f"{name}_balance_error"] for row in done]
        above = [row["seed"] for row in done if row[f"{name}_balance_error"] > limit]
        print(f"{name} error of those done: worst {max(errors, default=0.0):.1e}, above {above}")
    print(f"longest: {max((row['processor_s'] for row in ran), default=0.0):.0f} s")
    said = [(row["seed"], row["unsaid"]) for row in done if row.get("unsaid")]
    print(f"odd numbers that no finding names: {said}")
    odd = [row["seed"] for row in rows if row not in ran and row["status"] != "refused"]
    print(f"to look at: {odd}")


def main() -> None:
    run_seeds("random_machines", __doc__, row_of, report, case_text, _COLUMNS, 40)


if __name__ == "__main__":
    main()
