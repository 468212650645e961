"""Report of a result: one self-contained HTML page or PDF document."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from toothspace.advice.findings import findings_of
from toothspace.advice.limits import limits_of
from toothspace.advice.verdict import verdict
from toothspace.api import machine_of
from toothspace.case.presets import INTERFACES, MODELS
from toothspace.core.constants import ZERO_CELSIUS
from toothspace.core.files import path_of, require_ending, write_text
from toothspace.core.finding import status_line
from toothspace.core.types import Array
from toothspace.model.description import MachineDescription
from toothspace.plotting.catalogue import FigureEntry, available_figures
from toothspace.plotting.over_time import speed_and_pressure
from toothspace.plotting.style import figure_to_svg
from toothspace.report.charts import turning_section
from toothspace.report.document import write_document
from toothspace.report.page import render
from toothspace.report.wording import format_value, quantity, shown_unit
from toothspace.results import lost_flow
from toothspace.results.ledger import NOTE_ENTRIES, LossCause, loss_causes, power_ledger
from toothspace.results.performance import by_label
from toothspace.results.solution import Solution

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Measured = Mapping[str, Array]

ENDINGS = (".html", ".htm", ".pdf")
"""Names of a report end on one of these."""

_KEY_NUMBERS = (
    "mean_flow_L_per_min",
    "mean_torque_N_m",
    "overall_efficiency",
    "volumetric_efficiency",
    "hydromechanical_efficiency",
    "flow_ripple_percent",
    "pressure_ripple_bar",
    "max_chamber_pressure_bar",
    "outlet_temperature_degC",
)

_TRANSIENT_NUMBERS = (
    "startup_pressure_bar",
    "max_running_pressure_bar",
    "startup_pressure_ratio",
    "breakaway_time_s",
    "max_shaft_speed_rpm",
    "max_pressure_difference_bar",
    "max_chamber_pressure_bar",
    "real_time_factor",
)

_CHAPTERS: Mapping[str, str] = {
    "time": "Course over time",
    "pressure": "Pressures",
    "ripple": "Ripple and spectra",
    "bodies": "Gears, bearings and casing",
    "losses": "Losses",
    "geometry": "Geometry over the angle",
}

_RENAMED = {"flow_ripple_percent": "kinematic_flow_ripple_percent"}
"""Numbers of the geometry whose name the run uses for its own result."""

_PROVENANCE_TEXTS = ("case_toml", "warnings")


def write_report(
    solution: Solution,
    path: str | Path,
    description: MachineDescription | None = None,
    measured: Measured | None = None,
) -> Path:
    """Write the report of a result; returns its path.

    Parameters
    ----------
    solution : Solution
        Result, complete or not.
    path : str or Path
        File to write: an HTML page, or a PDF document where it ends on ``.pdf``.
    description : MachineDescription, optional
        The machine, for its section, design rules, volumes and openings; rebuilt from the
        case in the result if it is not given.
    measured : mapping, optional
        ``time`` [s] and measured ``shaft_speed`` [rad/s] or ``pressure_difference`` [Pa], laid
        over a run over time.

    Raises
    ------
    CaseError
        If the file has another ending.
    """
    target = path_of(path, "report", "a file to write")
    require_ending(target, "report", ENDINGS)
    target.parent.mkdir(parents=True, exist_ok=True)
    note = ""
    if description is None:
        description, note = machine_of(solution)
    if target.suffix.lower() == ".pdf":
        contents = report_contents(solution, description, note)
        figures = figures_of(solution, description, measured)
        return write_document(target, contents, [(e.caption, figure) for e, figure in figures])
    return write_text(target, report_html(solution, description, note, measured))


def report_html(
    solution: Solution,
    description: MachineDescription | None = None,
    note: str = "",
    measured: Measured | None = None,
) -> str:
    """Return the report of a result as HTML text.

    Parameters
    ----------
    solution : Solution
        Result, complete or not.
    description : MachineDescription, optional
        The machine that it belongs to.
    note : str, optional
        Why there is no machine.
    measured : mapping, optional
        As for :func:`write_report`.
    """
    contents = report_contents(solution, description, note)
    chapters = _chapters(solution, description, measured)
    return render("report.html.j2", chapters=chapters, **contents)


def report_contents(
    solution: Solution, description: MachineDescription | None, note: str = ""
) -> dict[str, Any]:
    """Return the numbers and texts of a report by name, as page and document show them."""
    findings = findings_of(solution, description, note)
    return {
        **_numbers(solution),
        **_machine(solution, description),
        **_background(solution),
        "limits": limits_of(solution, description),
        "findings": findings,
        "status_line": status_line(solution.status, findings),
    }


def _numbers(solution: Solution) -> dict[str, Any]:
    summary = solution.summary()
    names = _TRANSIENT_NUMBERS if "time" in solution.data.sizes else _KEY_NUMBERS
    rows = [
        (r, format_value(r.power), f"{100.0 * r.share:.2f}") for r in power_ledger(solution.ledger)
    ]
    # a port whose pressure is held has no ripple to tell of
    held = "" if summary.get("pressure_ripple_bar") else "pressure_ripple_bar"
    duration = solution.ledger.duration
    notes = [
        (label, format_value(solution.ledger.energy[name] / duration))
        for name, label in NOTE_ENTRIES.items()
        if duration > 0.0 and solution.ledger.energy.get(name)
    ]
    # of oil, films and bodies, with a heat network
    nodes = by_label(solution.data["temperature"]) if "temperature" in solution.data else {}
    temperatures = [
        quantity(f"{name.replace('.', ' of ')}_degC", value - ZERO_CELSIUS)
        for name, value in nodes.items()
    ]
    return {
        "verdict": verdict(solution),
        "status": solution.status,
        "key_numbers": [quantity(n, summary[n]) for n in names if n in summary and n != held],
        "summary": {name: quantity(name, value) for name, value in summary.items()},
        "causes": _causes(solution, summary),
        "lost_flow": _lost_flow(solution),
        "temperatures": temperatures,
        "ledger_rows": rows,
        "ledger_notes": notes,
    }


def _causes(solution: Solution, summary: Mapping[str, object]) -> list[dict[str, Any]]:
    """Losses by cause, each with its places, largest first; flows of the gaps that leak."""

    def flow(account: str) -> str:
        value = summary.get(f"leakage_{account}_L_per_min") if account else None
        return format_value(round(value, 5)) if isinstance(value, float) else ""

    groups: dict[str, list[LossCause]] = {}
    for entry in loss_causes(solution.ledger):
        groups.setdefault(entry.cause, []).append(entry)
    found = []
    for cause, entries in groups.items():
        rows = [
            {
                "label": entry.label,
                "power": format_value(entry.power),
                "share": f"{100.0 * entry.share:.2f}",
                "flow": flow(entry.account),
            }
            for entry in sorted(entries, key=lambda entry: -entry.power)
        ]
        power, share = (sum(getattr(e, name) for e in entries) for name in ("power", "share"))
        total = {"power": format_value(power), "share": f"{100.0 * share:.2f}"}
        found.append({"cause": cause, "rows": rows, "size": power, **total})
    return sorted(found, key=lambda group: -float(group["size"]))


def _lost_flow(solution: Solution) -> list[dict[str, str]]:
    """Parts of the flow that the volumetric efficiency lacks, and their sum; empty without."""
    parts = lost_flow.parts_of(solution.data)
    if not parts:
        return []
    speed = solution.ledger.shaft_angle / solution.ledger.duration
    kinematic = abs(float(solution.data["displacement"]) * speed)
    paths = dict(zip(solution.data["path"].values, solution.data["path_label"].values, strict=True))

    def row(label: str, flow: float, kind: str = "") -> dict[str, str]:
        litres, share = format_value(round(flow * 6e4, 5)), f"{100.0 * flow / kinematic:.3f}"
        return {"label": label, "flow": litres, "share": share, "kind": kind}

    rows = []
    for name, flow in parts.items():
        for before, how in ((lost_flow.PRESSURE, "by pressure"), (lost_flow.DRAG, "by drag")):
            if name.startswith(before) and flow != 0.0:
                rows.append(row(f"{paths[name.removeprefix(before)]}, {how}", flow))
    rows += [row(label, parts[name]) for name, label in lost_flow.LABELS.items() if name in parts]
    return [*rows, row("lost flow", sum(parts.values()), "supplied")]


def _machine(solution: Solution, description: MachineDescription | None) -> dict[str, Any]:
    numbers: Mapping[str, object] = description.geometry_summary if description else {}
    attributes = solution.data.attrs
    return {
        "title": attributes.get("title") or "Simulation of a hydraulic gear machine",
        "machine": str(attributes.get("machine", "")).replace("_", " "),
        "mode": attributes.get("mode", ""),
        "geometry": [
            quantity(_RENAMED.get(k, k), v)
            for k, v in numbers.items()
            if not isinstance(v, list | tuple)
        ],
        "checks": [
            (
                check,
                quantity(check.name, check.value)._replace(
                    unit="" if check.unit in {"1", "-"} else shown_unit(check.unit)
                ),
            )
            for check in (description.checks if description else ())
        ],
    }


def _background(solution: Solution) -> dict[str, Any]:
    provenance = solution.provenance
    rows = {k: v for k, v in provenance.items() if k not in _PROVENANCE_TEXTS}
    models = {name: rows.pop(f"{name}_model", "") for name in INTERFACES}
    return {
        "models": [
            (INTERFACES[name], model, MODELS[model]) for name, model in models.items() if model
        ],
        "provenance": [(k.replace("_", " "), v or "none") for k, v in rows.items()],
        "case_toml": provenance.get("case_toml", ""),
        "statistics": [
            (name.replace("_", " "), format_value(value))
            for name, value in solution.statistics.items()
        ],
        "events": [
            (
                f"{event.shaft_angle * 57.29577951308232 % 360.0:.1f}",
                f"{event.time:.5f}",
                event.kind.replace("_", " "),
                event.label.replace("_", " "),
            )
            for event in solution.events
        ],
    }


def figures_of(
    solution: Solution, description: MachineDescription | None, measured: Measured | None = None
) -> list[tuple[FigureEntry, Figure]]:
    """Return all figures of a result in the order of the chapters."""
    entries = available_figures(solution, description)

    def drawn(entry: FigureEntry) -> Figure:
        if measured and entry.name == "speed_and_pressure":
            return speed_and_pressure(solution, description, measured)
        return entry.draw(solution, description)

    return [(entry, drawn(entry)) for key in _CHAPTERS for entry in entries if entry.chapter == key]


def _chapters(
    solution: Solution, description: MachineDescription | None, measured: Measured | None
) -> list[dict[str, Any]]:
    figures = figures_of(solution, description, measured)
    names = {entry.name for entry, _ in figures}
    turning = ""
    if description is not None and "gear_section" in names:
        turning = turning_section(solution, description)
    chapters = []
    for key, title in _CHAPTERS.items():
        shown = [(e.name, e.caption, figure_to_svg(f)) for e, f in figures if e.chapter == key]
        if shown:
            picture = turning if key == "pressure" else ""
            chapters.append({"key": key, "title": title, "figures": shown, "turning": picture})
    return chapters
