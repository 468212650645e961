"""Report of a result: one self-contained HTML page or PDF document."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from html import escape
from pathlib import Path
from textwrap import wrap
from typing import TYPE_CHECKING, Any, NamedTuple

import numpy as np

from toothspace.advice.findings import change_first, findings_of, limits_of, verdict
from toothspace.api import machine_of
from toothspace.case.presets import INTERFACES, MODELS
from toothspace.core.files import draft_of, path_of, require_ending, write_text
from toothspace.core.finding import status_line
from toothspace.core.types import Array
from toothspace.core.units import ZERO_CELSIUS
from toothspace.model.description import MachineDescription
from toothspace.plotting.catalogue import FigureEntry, available_figures
from toothspace.plotting.section import (
    fixed_parts,
    fluid_cells,
    housing_region,
    port_region,
    recess_outlines,
    section_at,
    top_of_scale,
    turned_section,
)
from toothspace.plotting.style import (
    GREY,
    INK,
    LIGHT,
    METAL,
    ORANGE,
    PRESSURE_COLOURS,
    figure_to_svg,
    pdf_pages,
)
from toothspace.plotting.waveforms import speed_and_pressure
from toothspace.report.page import format_value, quantity, render, shown_unit
from toothspace.report.views import views_html, views_of
from toothspace.results.ledger import NOTE_ENTRIES, LossCause, loss_causes, power_ledger
from toothspace.results.performance import DRAG, LABELS, PRESSURE, by_label, parts_of
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
_BAR = 1e5
_MM = 1e3
_FRAMES = 16
"""Positions within one tooth pitch; fewer if the samples are coarser."""
_DRAWN_ERROR = 1.5e-5  # what drawn outlines may deviate [m]
_WIDTH, _HEIGHT, _MARGIN = 8.27, 11.69, 0.75
_LINE = 0.19
_COLUMNS = 96


def write_report(
    solution: Solution,
    path: str | Path,
    description: MachineDescription | None = None,
    measured: Measured | None = None,
) -> Path:
    """Write the report of a result; returns its path.

    Raises CaseError if the file has another ending.

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
    figures = figures_of(solution, description, measured)
    names = {entry.name for entry, _ in figures}
    turning = ""
    if description is not None and "gear_section" in names:
        turning = turning_section(solution, description)
    chapters = []
    for key, title in _CHAPTERS.items():
        shown = [(e.name, e.caption, figure_to_svg(f)) for e, f in figures if e.chapter == key]
        if shown:
            chapters.append({"key": key, "title": title, "figures": shown})
    views = views_html(views_of(solution, description))
    return render("report.html.j2", chapters=chapters, turning=turning, views=views, **contents)


def report_contents(
    solution: Solution, description: MachineDescription | None, note: str = ""
) -> dict[str, Any]:
    """Return the numbers and texts of a report by name, as page and document show them."""
    findings = findings_of(solution, description, note)
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
        "change_first": change_first(solution, findings),
        "status": solution.status,
        "key_numbers": [quantity(n, summary[n]) for n in names if n in summary and n != held],
        "summary": {name: quantity(name, value) for name, value in summary.items()},
        "causes": _causes(solution, summary),
        "lost_flow": _lost_flow(solution),
        "temperatures": temperatures,
        "ledger_rows": rows,
        "ledger_notes": notes,
        **_machine(solution, description),
        **_background(solution),
        "limits": limits_of(solution, description),
        "findings": findings,
        "status_line": status_line(solution.status, findings),
        "trusted": solution.status.succeeded
        and not any(finding.severity == "serious" for finding in findings),
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
    parts = parts_of(solution.data)
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
        for before, how in ((PRESSURE, "by pressure"), (DRAG, "by drag")):
            if name.startswith(before) and flow != 0.0:
                rows.append(row(f"{paths[name.removeprefix(before)]}, {how}", flow))
    rows += [row(label, parts[name]) for name, label in LABELS.items() if name in parts]
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


def turning_section(solution: Solution, description: MachineDescription) -> str:
    """Section through the machine over one tooth pitch, with a slider for the shaft angle.

    HTML with the picture and its script; pointing at an area shows its pressure.

    Parameters
    ----------
    description : MachineDescription
        Machine that it belongs to, with outlines of its chambers.
    """
    from toothspace.report.page import render

    angle = np.asarray(solution.data["shaft_angle"])
    pitch = description.pitch_angle
    wanted = angle[0] + pitch * np.arange(_FRAMES) / _FRAMES
    samples = sorted({int(np.argmin(np.abs(angle - value))) for value in wanted})
    top = top_of_scale(solution) / _BAR
    housing = housing_region(description)
    left, low, right, high = (_MM * value for value in housing.bounds)
    return render(
        "turning.html.j2",
        box=f"{left:.2f} {-high:.2f} {right - left:.2f} {high - low:.2f}",
        housing=_area(housing, LIGHT, "housing", edge=GREY),
        frames=["\n".join(_section(solution, description, sample, top)) for sample in samples],
        angles=[f"{np.degrees(angle[sample] - angle[0]):.1f}" for sample in samples],
        colours=[_colour(share) for share in np.linspace(0.0, 1.0, 7)],
        top=f"{top:.0f}",
    )


def _colour(share: float) -> str:
    import matplotlib as mpl
    from matplotlib.colors import to_hex

    return to_hex(mpl.colormaps[PRESSURE_COLOURS](share))


def _section(
    solution: Solution, description: MachineDescription, sample: int, top: float
) -> list[str]:
    data = solution.data.isel({solution.data["chamber_pressure"].dims[0]: sample})
    shaft_angle = float(data["shaft_angle"])
    pressure = np.asarray(data["chamber_pressure"]) / _BAR
    # of teeth that wind, the section in the middle of their width
    cut = section_at(description, shaft_angle, 0.0)
    areas = []
    for port in ("inlet", "outlet"):
        value = float(data[f"{port}_pressure"]) / _BAR
        text = f"{port}: {value:.1f} bar"
        areas.append(_area(port_region(description, port), _colour(value / top), text))
    for region, chamber in zip(fluid_cells(cut.drawn, cut.shaft_angle), cut.chambers, strict=False):
        one, label = float(pressure[chamber]), description.chamber_labels[chamber]
        text = f"{label.replace('_', ' ')}: {one:.1f} bar"
        areas.append(_area(region, _colour(one / top), text))
    for body in description.bodies:
        solid = turned_section(description, body, shaft_angle)
        areas.append(_area(solid, METAL, body.name.replace("_", " "), edge=INK))
    areas.append(_area(fixed_parts(description), LIGHT, "part of the housing", edge=INK))
    for outline in recess_outlines(description).values():
        areas.append(f'<path class="recess" d="{_curve(outline[:-1])}"/>')
    return areas


def _area(region: Any, colour: str, text: str, edge: str | None = None) -> str:
    region = region.simplify(_DRAWN_ERROR)
    polygons = [p for p in getattr(region, "geoms", [region]) if p.geom_type == "Polygon"]
    rings = [ring for p in polygons if not p.is_empty for ring in (p.exterior, *p.interiors)]
    outline = "".join(_curve(ring.coords[:-1]) for ring in rings)
    return (
        f'<path d="{outline}" fill="{colour}" fill-rule="evenodd" stroke="{edge or colour}" '
        f'stroke-width="0.1"><title>{escape(text)}</title></path>'
    )


def _curve(points: Any) -> str:
    return f"M{'L'.join(f'{_MM * x:.2f} {-_MM * y:.2f}' for x, y, *_ in points)}Z"


class TextLine(NamedTuple):
    """Cells of a line with their places from the left margin [in]; places below zero end there."""

    cells: tuple[tuple[float, str], ...]
    size: float = 8.5
    weight: str = "normal"
    colour: str = INK
    rule: bool = False


def write_document(
    path: Path, contents: Mapping[str, Any], figures: Sequence[tuple[str, Figure]]
) -> Path:
    """Write a report as PDF.

    Parameters
    ----------
    path : Path
        File to write, complete or not there.
    contents : mapping
        Numbers and texts as :func:`toothspace.report.html.report_contents` gives them.
    figures : sequence of (caption, Figure)
        Figures in their order, one page each.
    """
    with draft_of(path) as draft, pdf_pages(draft, contents["title"]) as keep:
        lines = list(document_lines(contents))
        count = int((_HEIGHT - 2.0 * _MARGIN) / _LINE)
        for first in range(0, len(lines), count):
            keep(_text_page(lines[first : first + count]))
        for caption, figure in figures:
            figure.supxlabel("\n".join(wrap(caption, 100)), fontsize=8, color=GREY)
            keep(figure, bbox_inches="tight", pad_inches=_MARGIN)
    return path


def _text_page(lines: Sequence[TextLine]) -> Figure:
    from matplotlib.figure import Figure

    page = Figure(figsize=(_WIDTH, _HEIGHT))
    for k, line in enumerate(lines):
        height = 1.0 - (_MARGIN + k * _LINE) / _HEIGHT
        for place, text in line.cells:
            right = place < 0.0
            page.text(
                (_MARGIN + abs(place)) / _WIDTH,
                height,
                text.replace("$", r"\$"),
                ha="right" if right else "left",
                va="top",
                fontsize=line.size,
                fontweight=line.weight,
                color=line.colour,
            )
        if line.rule:
            from matplotlib.lines import Line2D

            ends = (_MARGIN / _WIDTH, 1.0 - _MARGIN / _WIDTH)
            below = height - 0.9 * _LINE / _HEIGHT
            page.add_artist(Line2D(ends, (below, below), color=LIGHT, linewidth=0.8))
    return page


def document_lines(contents: Mapping[str, Any]) -> Iterator[TextLine]:
    """All text of the document, line by line."""
    yield TextLine(((0.0, contents["title"]),), 14.0, "bold")
    yield TextLine(())
    status = contents["status_line"].replace("_", " ")
    yield from _paragraph(f"{contents['machine']} {contents['mode']}, {status}", GREY, gap=False)
    yield from _paragraph(contents["verdict"])
    for finding in contents["findings"]:
        yield from _paragraph(str(finding), ORANGE)
    key = [(x.label, f"{x.value} {x.unit}") for x in contents["key_numbers"]]
    yield from _table("Key numbers", key)
    yield from _cause_table(contents["causes"])
    lost = [
        (row["label"].capitalize(), f"{row['flow']} L/min", f"{row['share']} %")
        for row in contents["lost_flow"]
    ]
    if lost:
        yield from _table("Lost flow, and its share of the kinematic flow", lost)
    if contents["temperatures"]:
        rows = [(x.label, f"{x.value} {x.unit}") for x in contents["temperatures"]]
        yield from _table("Temperatures", rows)
    if contents["limits"]:
        yield from _heading("Limits")
    for limit in contents["limits"]:
        colour = ORANGE if limit.verdict == "exceeded" else INK
        cells = (0.0, limit.label), (-5.2, limit.value), (5.3, limit.allowed)
        yield TextLine(cells, colour=colour)
        yield TextLine(((0.2, f"{limit.verdict}; {limit.source}"),), 7.0, colour=GREY, rule=True)
    checks = [
        (shown.label, f"{shown.value} {shown.unit}", "met" if check.passed else "not met")
        for check, shown in contents["checks"]
    ]
    yield from _table("Design rules", checks)
    ledger = [(row.label, f"{w} W", f"{share} %") for row, w, share in contents["ledger_rows"]]
    yield from _table("Power ledger", ledger)
    numbers = [(x.label, f"{x.value} {x.unit}") for x in contents["summary"].values()]
    yield from _table("All numbers", numbers)
    yield from _table("Provenance", [])
    for name, value in contents["provenance"]:
        yield from _paragraph(f"{name}: {value}", gap=False)
    for line in contents["case_toml"].splitlines():
        yield TextLine(((0.0, line[:_COLUMNS]),), 7.0)


def _heading(title: str) -> Iterator[TextLine]:
    yield TextLine(())
    yield TextLine(((0.0, title),), 10.5, "bold", rule=True)


def _paragraph(text: str, colour: str = INK, *, gap: bool = True) -> Iterator[TextLine]:
    for line in wrap(text, _COLUMNS):
        yield TextLine(((0.0, line),), colour=colour)
    if gap:
        yield TextLine((), 4.0)


def _table(title: str, rows: Sequence[tuple[str, ...]]) -> Iterator[TextLine]:
    yield from _heading(title)
    for row in rows:
        places = (0.0, -5.4, -6.6)
        yield TextLine(tuple(zip(places, row, strict=False)), rule=True)


def _cause_table(groups: Sequence[Mapping[str, Any]]) -> Iterator[TextLine]:
    yield from _heading("Losses by cause: power, points of efficiency, leakage")
    for group in groups:
        cells = (0.0, group["cause"].capitalize()), (-4.2, f"{group['power']} W")
        yield TextLine((*cells, (-5.4, f"{group['share']} %")), weight="bold", rule=True)
        for row in group["rows"]:
            flow = f"{row['flow']} L/min" if row["flow"] else ""
            parts = (0.2, row["label"]), (-4.2, f"{row['power']} W"), (-5.4, f"{row['share']} %")
            yield TextLine((*parts, (-6.7, flow)), rule=True)
