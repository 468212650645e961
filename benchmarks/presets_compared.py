"""Same machines, four presets: ``python -m benchmarks.presets_compared --store`` writes the page.

Every shipped base machine runs at its own operating point with each preset; with ``--only`` those
whose name contains one of some texts.
"""

from __future__ import annotations

import argparse
from collections.abc import Mapping, Sequence
from pathlib import Path
from typing import Any

import toothspace as ts
from toothspace.case.presets import PRESETS

ROOT = Path(__file__).resolve().parents[1]
PAGE = ROOT / "docs" / "validation" / "presets.md"
MACHINES = (
    "egm12_motor",
    "egm12_pump",
    "fuel14_pump",
    "crescent_pump",
    "gerotor_trochoidal",
    "gerotor_cycloidal",
)
"""Base machines among the shipped cases."""
COARSE = {
    "run.samples_per_revolution": 180,
    "run.film_grid": [84, 12],
    "run.film_steps_per_revolution": 42,
}
COLUMNS: Mapping[str, str] = {
    "volumetric_efficiency": "volumetric efficiency",
    "hydromechanical_efficiency": "hydromechanical efficiency",
    "mean_torque_N_m": "torque, N m",
    "lateral": "leakage beside the gears, L/min",
    "journal": "torque of the journals, N m",
    "faces": "torque of the faces, N m",
    "max_chamber_pressure_bar": "highest pressure, bar",
}
"""Numbers of the table and their headings."""
_INTRODUCTION = """# Same machine, four presets

Written by `python -m benchmarks.presets_compared --store`: every base machine among the shipped
cases at its own operating point, 180 samples a revolution, lateral films of `elastic` on 84 x 12
cells. Films are as warm as the case says (`[heat]`); `ideal` has none. Where covers rest, `elastic`
has the films of `films`.
"""


def main() -> None:
    """Print the table, or write the page."""
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument(
        "--only", nargs="+", default=[""], help="machines whose name contains one of these texts"
    )
    parser.add_argument("--store", action="store_true", help=f"write {PAGE.relative_to(ROOT)}")
    asked = parser.parse_args()
    chosen = [name for name in MACHINES if any(text in name for text in asked.only)]
    parts = [table(name) for name in chosen]
    text = "\n".join([_INTRODUCTION, *parts])
    if asked.store:
        PAGE.write_text(text, encoding="utf-8")
    print(text)


def table(machine: str) -> str:
    """Markdown table of one machine: a row for each preset."""
    case = ts.load_case(ROOT / "cases" / f"{machine}.toml")
    rows = [("preset", *COLUMNS.values())]
    for preset in PRESETS:
        changes = {"run.fidelity": preset, **COARSE}
        if preset == "ideal":
            changes |= {"heat.model": "network"}
        rows.append((f"`{preset}`", *numbers(case, changes)))
    lines = [f"| {' | '.join(row)} |" for row in rows]
    lines.insert(1, "|---" * len(rows[0]) + "|")
    point = case.operating_point
    assert point is not None
    return "\n".join([f"## {case.title}", "", *lines, ""])


def numbers(case: ts.Case, changes: Mapping[str, Any]) -> Sequence[str]:
    """Entries of one row as text; what a preset does not know is left empty."""
    known = {key: value for key, value in changes.items() if reads(changes["run.fidelity"], key)}
    solution = ts.simulate(case.replace(known))
    found = dict(solution.summary())
    found["lateral"] = added(found, "leakage_lateral_L_per_min", "leakage_drain_L_per_min")
    for name, part in (("journal", "journal"), ("faces", "lateral")):
        kinds = [f"torque_loss_{part}_{kind}_N_m" for kind in ("viscous", "asperity")]
        found[name] = added(found, *kinds)
    if solution.status is not ts.Status.DONE:
        return [solution.status.name.lower().replace("_", " "), *[""] * (len(COLUMNS) - 1)]
    return ["" if found.get(name) is None else f"{found[name]:.4g}" for name in COLUMNS]


def reads(preset: str, key: str) -> bool:
    """Whether a preset reads a key, written with its table."""
    part, _, name = key.partition(".")
    return part != "run" or PRESETS[preset].reads(name)


def added(found: Mapping[str, Any], *names: str) -> float | None:
    """Sum of numbers, None without any of them."""
    given = [float(found[name]) for name in names if name in found]
    return sum(given) if given else None


if __name__ == "__main__":
    main()
