"""Summary numbers of short runs of the shipped cases, and where they are kept.

Run ``python -m tests.regression.values`` to store them anew after an intended change.
"""

from __future__ import annotations

import json
import math
import re
from collections.abc import Mapping
from pathlib import Path

from toothspace import api

REPOSITORY = Path(__file__).resolve().parents[2]
STORED = Path(__file__).parent / "values.json"

RUNS: dict[str, tuple[str, tuple[str, ...]]] = {
    "egm12_pump_ideal": ("egm12_pump", ("run.fidelity=ideal",)),
    "egm12_motor": ("egm12_motor", ()),
    "egm12_pump": ("egm12_pump", ()),
    "fuel14_pump": ("fuel14_pump", ("run.relative_tolerance=1e-6",)),
    "gerotor_trochoidal": ("gerotor_trochoidal", ()),
    "unequal_pump": (
        "egm12_pump",
        (
            "machine.driven_gear.tooth_count=15",
            'machine.driven_gear.tip_diameter="48.9 mm"',
            'operating_point.outlet_load="fixed_pressure"',
        ),
    ),
    "crescent_pump": ("crescent_pump", ()),
    "startup": ("startup_fan_drive", ('circuit.duration="1.6 s"', "run.time_samples=400")),
    "startup_complete": (
        "startup_complete",
        ('circuit.duration="1.6 s"', "run.time_samples=400"),
    ),
}
"""Name of each run, its case and overrides."""

UNSTABLE = ("wall_time_s", "real_time_factor", "mass_balance_error", "energy_balance_error",
            "mean_loaded_contacts")  # fmt: skip
"""Numbers that say how a run went, and one that counts samples."""


RELATIVE = 5e-3
"""How far rounding moves a number: step sizes and Newton iterations follow the state, so that
4e-12 K more move losses and smallest pressures of these runs by up to 3.6e-3. [-]"""
SMALL = 3e-5
"""How far it moves a small part against the largest number of the same unit. On a processor
without 512-bit instructions 0.94 W of 1.1 kW move by 6e-3 of themselves, 5e-6 of all. [-]"""
RIPPLE = 0.1
"""How far it moves a ripple, the difference of two extremes: 1e-12 of a dimension move that of the
crescent pump by 0.05 of its 3.9 %, a processor with 512-bit instructions by 0.03. [%]"""
COUNTED = 0.01
"""How far it moves a share of the samples: one sample for every tooth of seven in 720. [-]"""

_UNIT = re.compile(r"_(W|J|bar|rpm|percent|L_per_min|N_m|degC|s)$")


def rounding(name: str, numbers: Mapping[str, float | str]) -> float:
    """How far rounding may move number ``name`` of a run, in its own unit."""
    if name.endswith("ripple_percent"):
        return RIPPLE
    if name.startswith(("loaded_contacts", "contact_span")):
        return COUNTED
    alike = [float(numbers[name])]
    if unit := _UNIT.search(name):
        alike += [float(v) for k, v in numbers.items() if k.endswith(unit.group())]
    return max(RELATIVE * abs(alike[0]), SMALL * max(map(abs, alike)))


def numbers_of(name: str) -> dict[str, float | str]:
    """Run one case and return its stable summary numbers."""
    case, overrides = RUNS[name]
    solution = api.simulate(api.load_case(REPOSITORY / "cases" / f"{case}.toml", overrides))
    kept = {k: v for k, v in solution.summary().items() if k not in UNSTABLE}
    return {k: v for k, v in kept.items() if isinstance(v, str) or math.isfinite(v)}


def main() -> None:
    """Store the numbers of all runs."""
    stored = {name: numbers_of(name) for name in RUNS}
    STORED.write_text(json.dumps(stored, indent=1) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
