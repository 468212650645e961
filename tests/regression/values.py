"""Summary numbers of short runs of the shipped cases, and where they are kept.

Run ``python -m tests.regression.values`` to store them anew after an intended change.
"""

from __future__ import annotations

import json
import math
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
    "startup": ("startup_fan_drive", ('circuit.duration="1.6 s"', "run.time_samples=400")),
}
"""Name of each run, its case and overrides."""

UNSTABLE = ("wall_time_s", "real_time_factor", "mass_balance_error", "energy_balance_error")
"""Numbers that say how a run went, not what the machine does."""


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
