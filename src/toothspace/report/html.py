"""One self-contained HTML file per result, that opens without a network."""

from __future__ import annotations

from collections.abc import Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any

from toothspace.core.files import write_text
from toothspace.core.types import Array
from toothspace.model.description import MachineDescription
from toothspace.plotting.catalogue import FigureEntry, available_figures
from toothspace.plotting.startup import speed_and_pressure
from toothspace.plotting.style import figure_to_svg
from toothspace.report import charts
from toothspace.report.machine import machine_of
from toothspace.report.verdict import verdict, warnings_of
from toothspace.report.wording import LabelledNumber, format_value, quantity
from toothspace.results.ledger import NOTE_ENTRIES, power_ledger
from toothspace.results.solution import Solution
from toothspace.simulation.presets import INTERFACES, MODELS, models_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure

Measured = Mapping[str, Array]
_TEMPLATES = Path(__file__).parent / "templates"

_KEY_NUMBERS = (
    "mean_flow_L_per_min",
    "mean_torque_N_m",
    "overall_efficiency",
    "volumetric_efficiency",
    "hydromechanical_efficiency",
    "flow_ripple_percent",
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
    "ripple": "Ripple",
    "bodies": "Gears, bearings and casing",
    "losses": "Losses",
    "geometry": "Geometry over the angle",
}

_PROVENANCE_TEXTS = ("case_toml", "warnings")


def write_report(
    solution: Solution,
    path: str | Path,
    description: MachineDescription | None = None,
    measured: Measured | None = None,
) -> Path:
    """Write the report of a result.

    Parameters
    ----------
    solution : Solution
        Result, complete or not.
    path : str or Path
        HTML file to write.
    description : MachineDescription, optional
        The machine, for its section, design rules, volumes and openings; rebuilt from the
        case in the result if it is not given.
    measured : mapping, optional
        ``time`` [s] and measured ``shaft_speed`` [rad/s] or ``pressure_difference`` [Pa], laid
        over a run over time.

    Returns
    -------
    Path
        The file written.
    """
    target = Path(path)
    target.parent.mkdir(parents=True, exist_ok=True)
    note = ""
    if description is None:
        description, note = machine_of(solution)
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
        A further warning.
    measured : mapping, optional
        As for :func:`write_report`.
    """
    from jinja2 import Environment, FileSystemLoader, StrictUndefined
    from plotly.offline import get_plotlyjs

    environment = Environment(
        loader=FileSystemLoader(_TEMPLATES),
        autoescape=True,
        undefined=StrictUndefined,
        trim_blocks=True,
        lstrip_blocks=True,
    )
    template = environment.get_template("report.html.j2")
    chapters = _chapters(solution, description, measured)
    interactive = any(chapter["charts"] for chapter in chapters)
    return template.render(
        plotly_script=get_plotlyjs() if interactive else "",
        style=(_TEMPLATES / "report.css").read_text(encoding="utf-8"),
        chapters=chapters,
        **_numbers(solution),
        **_machine(solution, description),
        **_background(solution),
        warnings=[*warnings_of(solution, description), *([note] if note else [])],
    )


def _numbers(solution: Solution) -> dict[str, Any]:
    summary = solution.summary()
    key_numbers = _TRANSIENT_NUMBERS if "time" in solution.data.sizes else _KEY_NUMBERS
    rows = [
        (r, format_value(r.power), f"{100.0 * r.share:.2f}") for r in power_ledger(solution.ledger)
    ]
    duration = solution.ledger.duration
    notes = [
        (label, format_value(solution.ledger.energy[name] / duration))
        for name, label in NOTE_ENTRIES.items()
        if duration > 0.0 and solution.ledger.energy.get(name)
    ]
    return {
        "verdict": verdict(solution),
        "status": solution.status,
        "key_numbers": [quantity(n, summary[n]) for n in key_numbers if n in summary],
        "summary": {name: quantity(name, value) for name, value in summary.items()},
        "ledger_rows": rows,
        "ledger_notes": notes,
    }


def _machine(solution: Solution, description: MachineDescription | None) -> dict[str, Any]:
    numbers: Mapping[str, object] = description.geometry_summary if description else {}
    attributes = solution.data.attrs
    return {
        "title": attributes.get("title") or "Simulation of a hydraulic gear machine",
        "machine": str(attributes.get("machine", "")).replace("_", " "),
        "mode": attributes.get("mode", ""),
        "geometry": [quantity(k, v) for k, v in numbers.items() if not isinstance(v, list | tuple)],
        "checks": [
            (check, _check_value(check.name, check.value, check.unit))
            for check in (description.checks if description else ())
        ],
    }


def _check_value(name: str, value: float, unit: str) -> LabelledNumber:
    label = name.replace("_", " ")
    shown = "" if unit in {"1", "-"} else unit.replace("mm3", "mm³").replace("mm2", "mm²")
    return LabelledNumber(label[:1].upper() + label[1:], format_value(value), shown)


def _background(solution: Solution) -> dict[str, Any]:
    provenance = solution.provenance
    rows = {k: v for k, v in provenance.items() if k not in _PROVENANCE_TEXTS}
    models = models_of(provenance.get("interfaces", ""))
    return {
        "models": [(INTERFACES[name], model, MODELS[model]) for name, model in models.items()],
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


def _chapters(
    solution: Solution, description: MachineDescription | None, measured: Measured | None
) -> list[dict[str, Any]]:
    entries = available_figures(solution, description)
    interactive = _interactive(solution, description)
    chapters = []
    for key, title in _CHAPTERS.items():
        figures = [
            (
                entry.name,
                entry.caption,
                figure_to_svg(_drawn(entry, solution, description, measured)),
            )
            for entry in entries
            if entry.chapter == key
        ]
        shown = interactive if key == "pressure" else []
        if figures or shown:
            chapters.append({"key": key, "title": title, "figures": figures, "charts": shown})
    return chapters


def _drawn(
    entry: FigureEntry,
    solution: Solution,
    description: MachineDescription | None,
    measured: Measured | None,
) -> Figure:
    if measured and entry.name == "speed_and_pressure":
        return speed_and_pressure(solution, description, measured)
    return entry.draw(solution, description)


def _interactive(
    solution: Solution, description: MachineDescription | None
) -> list[tuple[str, str]]:
    """Charts to play with, as HTML and caption."""
    if "chamber_pressure" not in solution.data or "shaft_angle" not in solution.data.sizes:
        return []
    names = {entry.name for entry in available_figures(solution, description)}
    shown = []
    if description is not None and "gear_section" in names:
        chart = charts.turning_section_chart(solution, description)
        caption = (
            "The machine over one tooth pitch: press Turn or move the slider; hover for values."
        )
        shown.append((charts.chart_html(chart, "turning_section"), caption))
    chart = charts.chamber_pressure_chart(solution)
    caption = "Pressure in the chambers over the shaft angle: click in the legend, drag to zoom."
    shown.append((charts.chart_html(chart, "chamber_pressures"), caption))
    return shown
