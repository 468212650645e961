"""A result as views that answer to a pointer: page, report and notebook draw the same ones.

A view is a table that JSON holds: ``name``, ``title``, ``caption`` and ``kind``, which says what
else it has. ``views.js`` draws it and knows nothing of machines.

==========  ======================================================================================
``curves``  ``over`` (``shaft_angle`` or ``time``), ``x``, ``unit`` of it, ``lines``
``bars``    ``lines`` of orders and amplitudes
``path``    a curve in a plane with a place on it for each value of ``over``; ``circle`` around it
``films``   ``fields`` over ``pieces``: rings in the plane, or cylinders round an axis
``tree``    a quantity and the ``children`` that it falls into
``map``     ``fields`` over two axes, each cell with the ``values`` of its point
==========  ======================================================================================
"""

from __future__ import annotations

import json
import math
from collections.abc import Iterator, Mapping, Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from toothspace.core.errors import ToothspaceError
from toothspace.core.types import Array
from toothspace.core.units import ZERO_CELSIUS
from toothspace.films.journal.bearing import JournalBearing
from toothspace.model.description import MachineDescription
from toothspace.model.fluid import temperature_range
from toothspace.plotting.style import readable
from toothspace.report.page import TEMPLATES, quantity, render
from toothspace.results.ledger import loss_causes
from toothspace.results.ripple import resolved_spectrum, wave
from toothspace.results.solution import Solution
from toothspace.results.variables import CURVES
from toothspace.run.condition import fluid_keys
from toothspace.run.heating import journal_node, lateral_node, liquid_of
from toothspace.studies.study import StudyResult

if TYPE_CHECKING:
    import xarray as xr

_BAR, _LITRE_PER_MINUTE, _RPM = 1e5, 6e4, 30.0 / math.pi
_MOST_POINTS = 481
_MOST_ORDER = 120.0
_MOST_ROWS, _MOST_COLUMNS = 90, 18
"""Cells of a film that are shown, round and across."""
_JOURNAL_GRID = (72, 13)
_WAVES = (
    "outlet_flow_rate",
    "inlet_flow_rate",
    "outlet_pressure",
    "inlet_pressure",
    "shaft_torque",
)
_COURSE = ("shaft_speed", "pressure_difference")
_FIELDS = (
    ("film_height", "Film height", "µm", 1e6),
    ("film_pressure", "Pressure", "bar", 1.0 / _BAR),
    ("film_contact_pressure", "Asperity pressure", "MPa", 1e-6),
    ("film_wear_power", "Wear indicator", "W/mm²", 1e-6),
    ("film_deformation", "Deformation", "µm", 1e6),
)
_MAPPED = (
    "overall_efficiency",
    "volumetric_efficiency",
    "hydromechanical_efficiency",
    "mean_flow_L_per_min",
    "mean_torque_N_m",
    "max_chamber_pressure_bar",
    "pressure_ripple_bar",
    "film_height_um",
    "smallest_film_um",
    "leakage_L_per_min",
    "torque_loss_N_m",
)
_LOOPS = (
    ("bearing_position_um", "Position of the bearing"),
    ("film_height_um", "Mean film"),
    ("leakage_L_per_min", "Leakage"),
    ("torque_loss_N_m", "Torque loss"),
)


def views_of(
    solution: Solution, description: MachineDescription | None = None
) -> list[dict[str, Any]]:
    """Return the views that a result can give.

    Parameters
    ----------
    solution : Solution
        Result, complete or not.
    description : MachineDescription, optional
        The machine that it belongs to; rebuilt from the case in the result if it is not given.
    """
    description, data = description or solution.description, solution.data
    found: list[dict[str, Any]] = []
    if "time" in data.sizes:
        found += _over_time(data)
    elif data.sizes.get("shaft_angle", 0) > 2:
        found += _over_angle(solution, description)
        found += _orbits(data, description)
        found += _lateral(data)
        found += _journals(solution, description)
    return [*found, *_losses(solution)]


def study_views(result: StudyResult, case: Any = None) -> list[dict[str, Any]]:
    """Return the views of a study: a map over two axes, or loops over the outlet pressure.

    Parameters
    ----------
    result : StudyResult
        Result, complete or not.
    case : Case, optional
        Its case, whose conditions a click on the map opens.
    """
    data = result.data
    if "shaft_speed" in data.dims:
        other = next((d for d in ("pressure_difference", "outlet_pressure") if d in data.dims), "")
        return [_map(data, other, case)] if other else []
    if "outlet_pressure_bar" in data and data["outlet_pressure_bar"].dims == ("point",):
        pressure = np.asarray(data["outlet_pressure_bar"])
        return [
            {
                "name": f"loop_{name}",
                "title": f"{label} up and down",
                "caption": "The cursor follows the points in their order; the way back lies apart "
                "where friction holds the bearing.",
                "kind": "path",
                "over": "point",
                "at": list(range(pressure.size)),
                "x": _line("Outlet pressure", "bar", pressure),
                "y": _line(label, quantity(name, 0.0).unit, np.asarray(data[name])),
                "marks": True,
            }
            for name, label in _LOOPS
            if name in data and np.isfinite(data[name]).any()
        ]
    return []


def _over_angle(
    solution: Solution, description: MachineDescription | None
) -> Iterator[dict[str, Any]]:
    data = solution.data
    angle = np.degrees(np.asarray(data["shaft_angle"]))
    own = _thinned(angle.size, _MOST_POINTS)
    turn = {"kind": "curves", "over": "shaft_angle", "unit": "°", "x": _few(angle[own] - angle[0])}
    if description is not None and "chamber_pressure" in data:
        lines = []
        for family in description.families:
            chamber = f"{family.name}_0"
            if chamber in data["chamber"] and np.any(family.volume.slopes):
                trace = np.asarray(data["chamber_pressure"].sel(chamber=chamber))[own]
                lines.append(_line(readable(family.name), "bar", trace / _BAR))
        title = "Pressure in one tooth space on its way round"
        yield {"name": "chamber", "title": title, "caption": "", **turn, "lines": lines}
    spectra = []
    for name in _WAVES:
        label, unit, factor = CURVES[name]
        if name not in data or float(np.ptp(data[name].values)) == 0.0:
            continue
        values = factor * np.asarray(data[name])[own]
        title = f"{label} over a turn"
        lines = [_line(label, unit, values)]
        yield {"name": name, "title": title, "caption": "", **turn, "lines": lines}
        found = resolved_spectrum(*wave(data, name))
        kept = (found.order > 0.0) & (found.order <= _MOST_ORDER)
        spectra.append(
            {
                "label": label,
                "unit": unit,
                "x": _few(found.order[kept]),
                "values": _few(factor * found.amplitude[kept]),
            }
        )
    if spectra:
        yield {
            "name": "spectra",
            "title": "Spectra of the ripple",
            "caption": "Peak amplitude of each order, in events per turn of the shaft.",
            "kind": "bars",
            "unit": "",
            "lines": spectra,
        }


def _over_time(data: xr.Dataset) -> Iterator[dict[str, Any]]:
    time = np.asarray(data["time"])
    own = _thinned(time.size, 2 * _MOST_POINTS)
    lines = {
        name: _line(label, unit, factor * np.asarray(data[name])[own])
        for name, (label, unit, factor) in ((name, CURVES[name]) for name in (*_COURSE, *_WAVES))
        if name in data and data[name].dims == ("time",)
    }
    for name, line in lines.items():
        yield {
            "name": f"{name}_over_time",
            "title": f"{line['label']} over time",
            "caption": "",
            "kind": "curves",
            "over": "time",
            "unit": " s",
            "x": _few(time[own]),
            "lines": [line],
        }
    if {"shaft_speed", "pressure_difference"} <= lines.keys():
        yield {
            "name": "cycle",
            "title": "Cycle: pressure difference over speed",
            "caption": "From rest through breakaway to running, and back: the cursor follows time.",
            "kind": "path",
            "over": "time",
            "at": _few(time[own]),
            "x": lines["shaft_speed"],
            "y": lines["pressure_difference"],
        }


def _orbits(data: xr.Dataset, description: MachineDescription | None) -> Iterator[dict[str, Any]]:
    if "body_position" not in data or description is None:
        return
    angle = np.degrees(np.asarray(data["shaft_angle"]))
    own = _thinned(angle.size, _MOST_POINTS)
    for journal in description.journals:
        # about the middle of its bearings
        axes = ["x", "y"]
        place = np.asarray(data["body_position"].sel(body=journal.body, axis=axes), dtype=float)
        if "block_position" in data:
            place = place - np.asarray(data["block_position"].sel(axis=axes))
        elif "seat_position" in data:
            place = place - np.asarray(data["seat_position"].sel(body=journal.body, axis=axes))
        yield {
            "name": f"orbit_{journal.body}",
            "title": f"Orbit of the {readable(journal.body).lower()} in its bearings",
            "caption": "Circle: clearance of the bearing. The dot is the place at the cursor.",
            "kind": "path",
            "over": "shaft_angle",
            "at": _few(angle[own] - angle[0]),
            "x": _line("x", "µm", 1e6 * place[own, 0]),
            "y": _line("y", "µm", 1e6 * place[own, 1]),
            "circle": 1e6 * journal.radial_clearance,
        }


def _lateral(data: xr.Dataset) -> Iterator[dict[str, Any]]:
    """Films beside the gears, one view for each side, at the last shaft angle."""
    if "film_height" not in data or "film_radius" not in data:
        return
    angle, radius = np.asarray(data["film_angle"]), np.asarray(data["film_radius"])
    rows, columns = _thinned(angle.size, _MOST_ROWS), _thinned(radius.shape[1], _MOST_COLUMNS)
    sides: dict[str, list[int]] = {}
    for k, name in enumerate(data["film"].values):
        sides.setdefault(str(name).partition("_")[0], []).append(k)
    # fields with a value other than zero
    given = [f for f in _FIELDS if f[0] in data]
    shown = [f for f in given if np.nan_to_num(np.asarray(data[f[0]], dtype=float)).any()]
    on_film, warm = np.isfinite(np.asarray(data["film_height"])), _temperatures(data)
    for side, films in sides.items():
        pieces = []
        for k in films:
            center = 1e3 * float(data["film_center_x"][k]), 1e3 * float(data["film_center_y"][k])
            values = []
            for name, _, _, factor in shown:
                field = factor * np.asarray(data[name])[k]
                values.append(_few(np.where(on_film[k], field, np.nan)[rows, columns], 4))
            name = str(data["film"].values[k])
            kelvin = warm.get(lateral_node(name.partition("_")[2]))
            at = "" if kelvin is None else f", {kelvin - ZERO_CELSIUS:.3g} °C"
            pieces.append(
                {
                    "label": f"{readable(name)}{at}",
                    "shape": "ring",
                    "u": _few(angle[rows]),
                    "v": _few(1e3 * radius[k][columns]),
                    "center": center,
                    "values": values,
                }
            )
        yield {
            "name": f"films_{side}",
            "title": f"Films on the {readable(side).lower()} side",
            "caption": "Seen from the floating side, at the last shaft angle. In space: height of "
            "the film, exaggerated, with deformation in it.",
            "kind": "films",
            "fields": [{"label": label, "unit": unit} for _, label, unit, _ in shown],
            "height": 0,
            "pieces": pieces,
        }


def _temperatures(data: xr.Dataset) -> dict[str, float]:
    """Temperatures of films and bodies by the names of their nodes. [K]."""
    if "temperature" not in data:
        return {}
    nodes = (str(node) for node in data["heat_node"].values)
    return dict(zip(nodes, map(float, data["temperature"].values), strict=True))


def _journals(
    solution: Solution, description: MachineDescription | None
) -> Iterator[dict[str, Any]]:
    """Films of the bearings, solved under the mean load of the turn."""
    data = solution.data
    if description is None or "journal_force" not in data:
        return
    try:
        case = solution.case
    except ToothspaceError:
        return  # a file of it is gone
    # other films of a run keep the temperature of the fluid
    speed, warm = float(np.mean(data["shaft_speed"])), {}
    if case.heat.model == "coupled":
        hottest = temperature_range(fluid_keys(case).source)[1]
        warm = {node: min(kelvin, hottest) for node, kelvin in _temperatures(data).items()}
    for journal in description.journals:
        load = np.asarray(data["journal_force"].sel(body=journal.body, axis=["x", "y"]))
        mean = load.mean(axis=0) / journal.count
        ratio = next(body.speed_ratio for body in description.bodies if body.name == journal.body)
        kelvin = warm.get(journal_node(journal.body), float(data["fluid_temperature"]))
        film = JournalBearing(
            diameter=journal.diameter,
            length=journal.length,
            radial_clearance=journal.radial_clearance,
            dynamic_viscosity=liquid_of(case, kelvin).dynamic_viscosity,
            grid=_JOURNAL_GRID,
            end_pressure=1e5,
            cavitation_pressure=0.0,
            end_condition=journal.end_condition,
        ).equilibrium(load=(-float(mean[0]), -float(mean[1])), shaft_speed=ratio * speed)
        if not film.status.succeeded:
            continue
        fields = [("Film height", "µm", 1e6 * film.gap_height)]
        fields += [("Pressure", "bar", film.pressure / _BAR), ("Filled", "1", film.film_fraction)]
        yield {
            "name": f"journal_{journal.body}",
            "title": f"Film in a bearing of the {readable(journal.body).lower()}",
            "caption": f"Smooth film solved under the mean load of the turn, "
            f"{float(np.hypot(*mean)):.4g} N on each bearing, at {kelvin - ZERO_CELSIUS:.3g} °C. "
            "In space: the oil round the shaft, exaggerated.",
            "kind": "films",
            "fields": [{"label": label, "unit": unit} for label, unit, _ in fields],
            "height": 0,
            "pieces": [
                {
                    "label": "Bearing",
                    "shape": "cylinder",
                    "u": _few(film.angle),
                    "v": _few(1e3 * film.axial_position),
                    "radius": 0.5e3 * journal.diameter,
                    "center": (0.0, 0.0),
                    "values": [_few(values, 4) for _, _, values in fields],
                }
            ],
        }


def _losses(solution: Solution) -> Iterator[dict[str, Any]]:
    groups: dict[str, list[dict[str, Any]]] = {}
    for one in loss_causes(solution.ledger):
        if one.power > 0.0:
            groups.setdefault(one.cause, []).append({"label": one.label, "value": one.power})
    if not groups:
        return
    causes = [
        {
            "label": cause.capitalize(),
            "value": sum(child["value"] for child in children),
            "children": sorted(children, key=lambda child: -float(child["value"])),
        }
        for cause, children in groups.items()
    ]
    yield {
        "name": "loss_tree",
        "title": "Where the power goes",
        "caption": "Lost power by cause, and by place within each cause.",
        "kind": "tree",
        "unit": "W",
        "tree": {
            "label": "Lost",
            "value": sum(float(cause["value"]) for cause in causes),
            "children": sorted(causes, key=lambda cause: -float(cause["value"])),
        },
    }


def _map(data: xr.Dataset, other: str, case: Any) -> dict[str, Any]:
    speed, pressure = np.asarray(data["shaft_speed"]), np.asarray(data[other])
    fields = []
    for name in _MAPPED:
        if name in data and data[name].dims == ("shaft_speed", other):
            label, _, unit = quantity(name, 0.0)
            scale = 100.0 if name.endswith("_efficiency") else 1.0
            values = _few(scale * np.asarray(data[name]), 5)
            fields.append({"label": label, "unit": unit, "values": values})
    points = []
    motor = getattr(getattr(case, "machine", None), "mode", "pump") == "motor"
    operating = getattr(case, "operating_point", None)
    if operating is not None:
        high = "inlet_pressure" if motor else "outlet_pressure"
        low = operating.outlet_pressure if motor else operating.inlet_pressure
        above = 0.0 if other == "outlet_pressure" else low
        points = [
            {
                "operating_point.shaft_speed": f"{n * _RPM:.8g} rpm",
                f"operating_point.{high}": f"{(p + above) / _BAR:.8g} bar",
            }
            for n in speed
            for p in pressure
        ]
    return {
        "name": "map",
        "title": f"Map over speed and {readable(other).lower()}",
        "caption": "Every cell is a computed point: a click tells its numbers; the bench opens it.",
        "kind": "map",
        "x": {"label": "Shaft speed", "unit": "rpm", "values": _few(_RPM * speed)},
        "y": {"label": readable(other), "unit": "bar", "values": _few(pressure / _BAR)},
        "fields": fields,
        "points": points,
    }


def _thinned(size: int, most: int) -> slice:
    """Every so many of values that at most so many are left."""
    return slice(None, None, max(1, -(-size // most)))


def _line(label: str, unit: str, values: Array) -> dict[str, Any]:
    return {"label": label, "unit": unit, "values": _few(values, 5)}


def _few(values: Any, digits: int = 6) -> list[float | None]:
    """Flat list of numbers with so many significant digits, None where there is none."""
    return [float(f"{x:.{digits}g}") if math.isfinite(x) else None for x in np.ravel(values)]


def views_html(views: Sequence[Mapping[str, Any]]) -> str:
    """Return views as a piece of a page that holds its own data and script; empty without any."""
    if not views:
        return ""
    # nothing in a text may end the script
    held = json.dumps(views, separators=(",", ":"), ensure_ascii=False).replace("<", "\\u003c")
    style, script = (
        (TEMPLATES / name).read_text(encoding="utf-8") for name in ("views.css", "views.js")
    )
    return render("views_part.html.j2", held=held, views_style=style, views_script=script)
