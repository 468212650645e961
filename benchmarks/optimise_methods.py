"""Searches of the study ``optimise`` at equal numbers of points, over several seeds.

    python -m benchmarks.optimise_methods gears
    python -m benchmarks.optimise_methods pump --seeds 4

``gears`` evaluates kinematics in closed form, so that only the search takes time; ``pump`` runs
the quiet pump in the preset ``lumped``. The table stands in
docs/developer/decisions/several_objectives.md.
"""

from __future__ import annotations

import argparse
import time
from collections.abc import Mapping
from itertools import product
from typing import Any, final

import numpy as np

import toothspace as ts
from toothspace import api
from toothspace.case import Case
from toothspace.core.status import Status
from toothspace.studies import optimise, run_study

GEARS = "machine.gears"
STUDIES: dict[str, dict[str, Any]] = {
    "gears": {
        "objective": "flow_ripple_percent",
        "goal": "minimise",
        "constraints": {"envelope_cm3": {"high": 24.0}, "contact_ratio": {"low": 1.15}},
        "vary": {
            f"{GEARS}.module": {"from": "2.4 mm", "to": "3.0 mm"},
            f"{GEARS}.profile_shift": {"from": 0.1, "to": 0.5},
            f"{GEARS}.pressure_angle": {"from": "18 deg", "to": "24 deg"},
        },
    },
    "pump": {
        "objective": "max_chamber_pressure_bar",
        "goal": "minimise",
        "constraints": {"overall_efficiency": {"low": 0.9285}},
        "vary": {
            "machine.relief_grooves.closing_side_offset": {"from": "2.4 mm", "to": "3.6 mm"},
            "machine.relief_grooves.opening_side_offset": {"from": "3.2 mm", "to": "4.6 mm"},
            "machine.casing.inlet_angle": {"from": "50 deg", "to": "95 deg"},
            "machine.casing.outlet_angle": {"from": "50 deg", "to": "210 deg"},
        },
    },
}
CASES = {"gears": "egm12_pump", "pump": "quiet_pump"}
METHODS = ("differential_evolution", "surrogate")


@final
class _Answer:
    """Stand-in of a solution: kinematics of the gears of a case."""

    status, warnings = Status.DONE, ()

    def __init__(self, case: Case) -> None:
        values = {
            path: np.array([case.value(path)], dtype=float) for path in STUDIES["gears"]["vary"]
        }
        found = ts.evaluate_designs(
            "egm12_pump", values, addendum=1.1, displacement="4.95 cm^3/rev"
        )
        names = ("flow_ripple_percent", "envelope_cm3", "contact_ratio")
        self.numbers = {name: float(found[name][0]) for name in names}
        self.numbers["status"] = "done" if found.valid[0] else "failed"

    def summary(self) -> Mapping[str, Any]:
        return self.numbers


def best_so_far(
    name: str, method: str, points: int, seed: int
) -> tuple[np.ndarray, dict[str, Any]]:
    """Best objective within the limits after each point, infinite before there is one."""
    tables = api.load_case(CASES[name]).to_dict()
    study = {"kind": "optimise", "method": method, "evaluation_count": points, "seed": seed}
    found = run_study(Case.from_dict({**tables, "study": {**study, **STUDIES[name]}}))
    merit = np.where(found.data["feasible"].values, found.data["merit"].values, np.inf)
    return np.minimum.accumulate(merit), dict(found.numbers)


def main() -> None:
    """Print best objectives after so many points, by method and seed."""
    parser = argparse.ArgumentParser()
    parser.add_argument("problem", choices=tuple(STUDIES))
    parser.add_argument("--seeds", type=int, default=8)
    parser.add_argument("--points", type=int, default=60)
    given = parser.parse_args()
    if given.problem == "gears":
        api.simulate = _Answer
        optimise.require_known = lambda *_, **__: None
    counts = [given.points * k // 3 for k in (1, 2, 3)]
    rows: dict[str, list[list[float]]] = {method: [] for method in METHODS}
    spent = dict.fromkeys(METHODS, 0.0)
    for seed, method in product(range(given.seeds), METHODS):
        begin = time.process_time()
        best, numbers = best_so_far(given.problem, method, given.points, seed)
        spent[method] += time.process_time() - begin
        rows[method].append([float(best[min(count, len(best)) - 1]) for count in counts])
        shown = " ".join(f"{x:9.4f}" for x in rows[method][-1])
        told = f"{numbers['points']} points, {numbers['points_failed']} failed"
        print(f"{method} {seed}: {shown}; {told} {numbers.get('hold_out_error', '')}", flush=True)
    for method in METHODS:
        for count, column in zip(counts, np.array(rows[method]).T, strict=True):
            text = f"median {np.median(column):.4f}, best {column.min():.4f}, worst"
            print(f"  {method} after {count}: {text} {column.max():.4f}")
        print(f"  {method}: {spent[method] / given.seeds:.1f} s of a processor for a search")


if __name__ == "__main__":
    main()
