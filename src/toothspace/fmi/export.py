"""From a case to a functional mock-up unit."""

from __future__ import annotations

import time
from collections.abc import Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from toothspace import api
from toothspace.advice.findings import rule_finding
from toothspace.case import Case, load_case
from toothspace.core.errors import CaseError
from toothspace.core.files import path_of, write_bytes
from toothspace.core.progress import Progress
from toothspace.core.status import Status
from toothspace.core.units import Quantity, as_text, from_si, parse_quantity
from toothspace.fmi.archive import fmu_archive, found_compiler, identifier_of
from toothspace.fmi.machine_file import DRIVES
from toothspace.fmi.operating_tables import ShaftSamples, tables_of
from toothspace.run.run import provenance_of
from toothspace.studies.efficiency_map import EfficiencyMapStudy, map_records
from toothspace.studies.points import map_dataset, status_of
from toothspace.studies.study import Record, Records, StudyContext, StudyResult, failed_count
from toothspace.studies.workers import Workers

if TYPE_CHECKING:
    pass

_PRESSURE_SHARES = (0.1, 0.4, 0.7, 1.0)
_SPEED_SHARES = (0.1, 0.2, 0.4, 0.7, 1.0)
"""Default values over those of the operating point; friction is most curved at low speed. [-]"""


def export_fmu(
    case: api.AnyCase,
    path: str | Path,
    *,
    pressure_difference: Sequence[Quantity | str] = (),
    shaft_speed: Sequence[Quantity | str] = (),
    drive: str = "speed",
    binary: bool = True,
    workers: int = 1,
    progress: Progress | None = None,
) -> StudyResult:
    """Tabulate a machine by steady runs and write it as a unit for FMI 2.0 co-simulation.

    Parameters
    ----------
    case : Case, str, Path or mapping
        Case with an operating point; its ports are held at constant pressure.
    path : str or Path
        File to write. Finished runs are kept beside it until it is written, and taken again.
    pressure_difference, shaft_speed : sequence of Quantity or str, optional
        At least two values each, such as ``"50 bar"`` and ``"500 rpm"``; left out, those of an
        efficiency map of the case, or 10, 40, 70 and 100 % of its operating point.
    drive : str
        ``speed``: the shaft speed is an input; ``torque``: it follows from load torque and inertia.
    binary : bool
        Whether the C compiler of this computer, if there is one, adds a binary to the sources.
    workers : int
        Processes that share the runs.
    progress : callable, optional
        Called with the finished share and a short text.

    Returns
    -------
    StudyResult
        The tables in ``data``; the unit is written only if its status is ``DONE``.

    Raises
    ------
    CaseError
        If the case has no operating point, an argument is not allowed, or the compiler fails.
    """
    return write_fmu(
        load_case(case),
        path_of(path, "path", "a file to write"),
        pressures=[parse_quantity(str(as_text(value)), "bar") for value in pressure_difference],
        speeds=[parse_quantity(str(as_text(value)), "rpm") for value in shaft_speed],
        drive=drive,
        binary=binary,
        workers=api.process_count(workers),
        progress=progress,
    )


def write_fmu(
    case: Case,
    target: Path,
    *,
    pressures: Sequence[float] = (),
    speeds: Sequence[float] = (),
    drive: str = "speed",
    binary: bool = True,
    workers: int = 1,
    progress: Progress | None = None,
) -> StudyResult:
    """Tabulate a machine by steady runs and write it as a unit for FMI 2.0 co-simulation.

    As :func:`export_fmu` with a case, and with pressure differences [Pa] and
    shaft speeds [rad/s] as numbers; ``drive`` is one of :data:`DRIVES`.
    """
    started = time.perf_counter()
    if drive not in DRIVES:
        raise CaseError("drive", f"{drive!r}", " or ".join(map(repr, DRIVES)))
    operating = case.operating_point
    if operating is None or not case.run.preset.has_losses:
        found = "no [operating_point]" if operating is None else "the fidelity 'ideal'"
        raise CaseError(case.label, found, "a steady case with losses")
    # the circuit round the unit sets the pressures, so what the ports see is the machine alone
    held = replace(operating, outlet_load="fixed_pressure", line=None)
    steady = replace(case, operating_point=held, study=None)
    low, high = held.inlet_pressure, held.outlet_pressure
    if getattr(case.machine, "mode", "pump") == "motor":
        low, high = high, low
    if isinstance(case.study, EfficiencyMapStudy):
        pressures = pressures or case.study.pressure_difference
        speeds = speeds or case.study.shaft_speed
    pressures = _axis(
        "pressure_difference", "bar", pressures or [k * (high - low) for k in _PRESSURE_SHARES]
    )
    speeds = _axis("shaft_speed", "rpm", speeds or [k * held.shaft_speed for k in _SPEED_SHARES])
    pairs = list(product(speeds, pressures))
    kept = target.with_name(f"{target.name}.points.jsonl")
    with Workers(workers) as pool:
        context = StudyContext(progress, pool, Records(kept, resume=True))
        records = map_records(steady, pairs, context, ShaftSamples())
    status, description = status_of(records), api.describe(steady)
    broken = [rule_finding(check).sentence for check in description.checks if not check.passed]
    numbers: dict[str, Any] = {
        "pressure_difference_bar": [from_si(value, "bar") for value in pressures],
        "shaft_speed_rpm": [from_si(value, "rpm") for value in speeds],
        "points": len(records),
        "points_failed": failed_count(records),
        "warnings": [*_warnings(pairs, records), *broken],
    }
    if status is Status.DONE:
        family = description.families[0]
        data = tables_of(records, pressures, speeds, round(family.count * abs(family.angle_ratio)))
        data["low_pressure"] = low
        data.attrs = {
            "mode": description.mode,
            "drain": description.drain,
            "title": case.title or case.name,
        }
        archive, platform = fmu_archive(
            data,
            identifier_of(case.name),
            provenance_of(steady)["case_toml"],
            found_compiler() if binary else None,
            free_shaft=drive == "torque",
        )
        write_bytes(target, archive)
        kept.unlink(missing_ok=True)
        errors = [record.number("energy_balance_error") for record in records]
        numbers |= {
            "displacement_cm3_per_rev": from_si(float(data["displacement"]), "cm^3/rev"),
            "ripple_period_deg": from_si(float(data["period"]), "deg"),
            "ripple_samples": data.sizes["shaft_angle"],
            "ripple_left_out_percent": 100.0 * float(data["ripple_left_out"]),
            "energy_balance_error": float(np.max(errors)),
            "binary": platform,
            "size_kB": len(archive) / 1e3,
        }
    else:
        axes = {"shaft_speed": (speeds, "rad/s"), "pressure_difference": (pressures, "Pa")}
        data = map_dataset(axes, records)
    return StudyResult(
        status=status,
        data=data,
        numbers=numbers,
        kind="fmu",
        title=case.title,
        provenance=provenance_of(steady),
        wall_time=time.perf_counter() - started,
    )


def _axis(name: str, unit: str, given: Sequence[float]) -> list[float]:
    values = sorted(set(given))
    if len(values) < 2 or not values[0] > 0.0:
        found = ", ".join(f"{from_si(value, unit):g} {unit}" for value in given)
        raise CaseError(name, found, "at least two values above zero")
    return values


def _warnings(pairs: Sequence[tuple[float, float]], records: Sequence[Record]) -> list[str]:
    """What failed at which point, and each warning of the runs with the first point that has it."""
    found: dict[str, str] = {}
    for (speed, difference), record in zip(pairs, records, strict=True):
        at = f"{from_si(speed, 'rpm'):g} rpm and {from_si(difference, 'bar'):g} bar"
        for text in filter(None, (record.message, *record.numbers.get("warnings", ()))):
            found.setdefault(text, at)
    return [f"At {at}: {text}" for text, at in found.items()]
