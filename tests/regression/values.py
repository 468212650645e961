"""Numbers of shipped cases, and where they are kept: of short runs, of machines, of films.

Run ``python -m tests.regression.values`` to store them anew after an intended change.
"""

from __future__ import annotations

import json
import math
import re
import tempfile
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np
import xarray as xr

from tests.regression.traits import Traits, traits
from toothspace import api
from toothspace.results.ledger import loss_causes, power_ledger
from toothspace.results.technical_data import pump_quantities

REPOSITORY = Path(__file__).resolve().parents[2]

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
MACHINES = (
    "egm12_motor_profile", "fuel14_pump", "helical_grooves", "continuous_pump", "crescent_motor",
    "crescent_helical", "gerotor_cycloidal", "gerotor_profiles", "gerotor_trochoidal",
)  # fmt: skip
"""Cases whose machines are described."""
FILMS = ("adiabatic_pad", "journal_bearing", "journal_orbit", "slider_pad", "thrust_ring")
"""Cases of stand-alone films."""

UNSTABLE = ("wall_time_s", "real_time_factor", "mass_balance_error", "energy_balance_error",
            "mean_loaded_contacts")  # fmt: skip
"""Numbers that say how a run went, and one that counts samples."""
FOLDED = ("chamber_angle",)
"""Variables that jump by a turn."""
LISTED = 8
"""Columns of a variable that are told one by one."""

EXACT = 2e-4
"""How far rounding moves what no march has made: geometry, tables, converged films. 1e-12 of all
dimensions move an overlap of teeth by 2e-5. [-]"""
RELATIVE = 5e-3
"""How far rounding moves a number of a run: step sizes and Newton iterations follow the state, so
that 4e-12 K more move losses and smallest pressures of these runs by up to 3.6e-3. [-]"""
SAMPLED = 0.02
"""How far it moves the samples of a variable: 1e-11 of a dimension move tooth forces of the gerotor
by up to 0.008. [-]"""
SMALL = 3e-5
"""How far it moves a small part against the largest number of the same unit. On a processor
without 512-bit instructions 0.94 W of 1.1 kW move by 6e-3 of themselves, 5e-6 of all. [-]"""
SLIGHT = 3e-3
"""How far it moves a small column against the largest of its variable. [-]"""
RIPPLE = 0.1
"""How far it moves a ripple, the difference of two extremes: 1e-12 of a dimension move that of the
crescent pump by 0.05 of its 3.9 %, a processor with 512-bit instructions by 0.03. [%]"""
COUNTED = 0.01
"""How far it moves a share of the samples: one sample for every tooth of seven in 720. [-]"""

SAMPLES = "samples."
_UNIT = re.compile(r"_(W|J|bar|rpm|percent|L_per_min|N_m|degC|s)$|^(power|cause)\.")


@dataclass(frozen=True)
class Kind:
    """Things of one kind whose numbers are kept."""

    names: tuple[str, ...]
    """Those that are kept."""
    numbers: Callable[[str], Traits]
    """Numbers of one of them."""
    rounding: Callable[[str, Traits], float]
    """How far rounding may move one of its numbers, in its own unit."""

    @property
    def file(self) -> Path:
        """Where they are kept."""
        return STORED / f"{self.numbers.__name__}.json"


def runs(name: str) -> Traits:
    """Return summary, means of variables, ledger and technical data of a short run."""
    case, overrides = RUNS[name]
    solution = api.simulate(api.load_case(REPOSITORY / "cases" / f"{case}.toml", overrides))
    kept = {k: v for k, v in solution.summary().items() if k not in UNSTABLE}
    stable = {k: v for k, v in kept.items() if isinstance(v, str) or math.isfinite(v)}
    rows = [row for row in power_ledger(solution.ledger) if row.kind != "remainder"]
    powers = {row.name: row.power for row in rows}
    causes = {f"{x.cause} {x.label}": x.power for x in loss_causes(solution.ledger)}
    told = traits({"power": powers, "cause": causes, "pump": pump_quantities(solution)})
    return stable | told | {f"{SAMPLES}{k}": v for k, v in samples(solution.data).items()}


def samples(data: xr.Dataset) -> Traits:
    """Return the means of all variables, of those with few columns one by one."""
    told = dict[str, Any]()
    for name, variable in data.data_vars.items():
        values = np.asarray(variable.values)
        if name in FOLDED or values.dtype.kind not in "fiu":
            continue
        last = values.shape[-1] if values.ndim > 1 else LISTED + 1
        columns = {str(k): np.ravel(values[..., k]) for k in range(last)} if last <= LISTED else {}
        told[str(name)] = columns or np.ravel(values)
    return traits(told, ordered=False)


def machines(name: str) -> Traits:
    """Return tables, bodies, bearings, report and design checks of a machine."""
    machine = api.describe(REPOSITORY / "cases" / f"{name}.toml")
    report = {"report": dict(machine.geometry_summary), "checks": [*machine.checks]}
    tables = traits(machine, without=("chamber_outlines", "outlines", "pocket"))
    return {k: v for k, v in tables.items() if not isinstance(v, str)} | traits(report)


def films(name: str) -> Traits:
    """Return numbers and fields of a stand-alone film."""
    case = api.load_case(REPOSITORY / "cases" / f"{name}.toml")
    with tempfile.TemporaryDirectory() as folder:
        path = Path(folder) / "film.nc"
        numbers = (api.solve_bearing if case.bearing else api.solve_film)(case, path)
        with xr.open_dataset(path) as fields:
            told = {str(name): variable.values for name, variable in fields.variables.items()}
    return traits({k: v for k, v in numbers.items() if k not in UNSTABLE} | {"fields": told})


def rounding_of_run(name: str, numbers: Traits) -> float:
    """How far rounding may move a number of a run, in its own unit."""
    if name.startswith(SAMPLES):
        variable = name.split(".")[:2]
        alike = [v for k, v in numbers.items() if k.split(".")[:2] == variable]
        return max(SAMPLED * abs(float(numbers[name])), SLIGHT * max(abs(float(v)) for v in alike))
    if name.endswith("ripple_percent"):
        return RIPPLE
    if name.startswith(("loaded_contacts", "contact_span")):
        return COUNTED
    alike = [float(numbers[name])]
    if unit := _unit(name):
        alike += [float(value) for other, value in numbers.items() if _unit(other) == unit]
    return max(RELATIVE * abs(alike[0]), SMALL * max(map(abs, alike)))


def _unit(name: str) -> str:
    """Unit of a number by the end of its name, or by its kind; empty without one."""
    found = _UNIT.search(name)
    return found.group() if found else ""


def rounding_without_march(name: str, numbers: Traits) -> float:
    """How far rounding may move a number of what no march has made."""
    return EXACT * abs(float(numbers[name]))


STORED = Path(__file__).parent / "stored"
KINDS = (
    Kind(tuple(RUNS), runs, rounding_of_run),
    Kind(MACHINES, machines, rounding_without_march),
    Kind(FILMS, films, rounding_without_march),
)


def main() -> None:
    """Store the numbers of everything."""
    for kind in KINDS:
        told = {name: kind.numbers(name) for name in kind.names}
        kind.file.write_text(json.dumps(told, indent=0) + "\n", encoding="utf-8")


if __name__ == "__main__":
    main()
