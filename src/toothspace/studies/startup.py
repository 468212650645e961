"""Start-up over the plateau speed of the supply and the shaft angle of the start."""

from __future__ import annotations

import math
from collections.abc import Mapping
from dataclasses import dataclass, replace
from itertools import product
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.case import Case
from toothspace.circuit.pumps import PumpMap
from toothspace.core.errors import CaseError
from toothspace.core.keys import KeyTable, grid, integer
from toothspace.core.units import from_si
from toothspace.plotting.style import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    StudyFigure,
    has_numbers,
    new_figure,
    styled,
)
from toothspace.results.solution import STANDING
from toothspace.studies.points import (
    collected,
    map_dataset,
    numbers_of,
    numbers_table,
    point,
    point_lists,
    status_of,
)
from toothspace.studies.study import Row, Study, StudyContext, StudyResult, StudyTable
from toothspace.studies.variation import SPEED

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure


COLUMNS = (
    ("breakaway_pressure_bar", "breakaway pressure (bar)"),
    ("startup_pressure_bar", "start-up pressure (bar)"),
    ("max_running_pressure_bar", "largest running pressure (bar)"),
    ("startup_pressure_ratio", "start-up over running pressure"),
    ("settled_pressure_bar", "settled pressure (bar)"),
    ("startup_to_settled_ratio", "start-up over settled pressure"),
    ("breakaway_time_s", "breakaway time (s)"),
)
_PRESSURES = (15.0, 20.0, 30.0, 50.0, 75.0, 100.0, 150.0, 200.0, 250.0)


@final
@dataclass(frozen=True, kw_only=True)
class StartupStudy(KeyTable):
    """``kind = "startup"``: start-up over plateau speeds and start angles."""

    plateau_speed: tuple[float, ...] | None = grid(
        SPEED, "Plateau speeds of the supply.", default=None
    )
    start_angle_count: int = integer(
        "Start angles over one tooth pitch.", low=1, high=360, default=1
    )


def run(case: Case, context: StudyContext) -> StudyResult:
    """Run a start over ``study.plateau_speed`` and ``study.start_angle_count`` shaft angles.

    The history of the supply speed keeps its form and takes the plateau speed as its largest
    value; start angles divide one tooth pitch evenly.

    Returns
    -------
    StudyResult
        Summary numbers over ``plateau_speed`` and ``start_angle``, and the starting torque
        efficiency over pressure.

    Raises
    ------
    CaseError
        If the case has no circuit with a supply pump, or no point can be run.

    References
    ----------
    .. [1] ISO 4392-1:2002, Hydraulic fluid power - Determination of characteristics of motors -
       Part 1: At constant low speed and constant pressure.
    """
    from toothspace import api

    study = case.study
    assert isinstance(study, StartupStudy)
    elements = case.circuit.elements if case.circuit else {}
    pumps = {name: pump for name, pump in elements.items() if isinstance(pump, PumpMap)}
    if not pumps:
        found = "no [circuit] with a pump_map"
        raise CaseError("study.kind", found, "a circuit with a supply").in_file(str(case.source))
    name, pump = next(iter(pumps.items()))
    supply = pump.speed_over_time
    speeds = study.plateau_speed or (float(supply[:, 1].max()),)
    pitch = 2.0 * math.pi / api.describe(case).families[0].count
    angles = [k * pitch / study.start_angle_count for k in range(study.start_angle_count)]
    pairs = list(product(speeds, angles))
    times, form = supply.T
    points = [
        point(
            case,
            {
                f"circuit.{name}.speed": [
                    [f"{time:.12g} s", f"{from_si(value, 'rpm'):.12g} rpm"]
                    for time, value in zip(times, form * speed / form.max(), strict=True)
                ],
                "circuit.initial_shaft_angle": f"{math.degrees(angle):.12g} deg",
            },
        )
        for speed, angle in pairs
    ]
    records = collected(points, context, started)
    plateaus = [from_si(speed, "rpm") for speed, _ in pairs]
    degrees = [math.degrees(angle) for _, angle in pairs]
    heads = {"plateau speed (rpm)": plateaus, "start angle (deg)": degrees}
    axes = {"plateau_speed": (speeds, "rad/s"), "start_angle": (angles, "rad")}
    pressures = [record.number("breakaway_pressure_bar") for record in records]
    breakaway = np.array([value for value in pressures if math.isfinite(value)])
    rows: list[Row] = []
    if breakaway.size:
        rows = [
            (p, 1.0 - float(breakaway.max()) / p, 1.0 - float(breakaway.mean()) / p)
            for p in _PRESSURES
            if p > breakaway.max()
        ]
    head = ("pressure difference (bar)", "least starting efficiency", "mean starting efficiency")
    return StudyResult(
        status=status_of(records),
        data=map_dataset(axes, records),
        numbers=point_lists({"plateau_speed_rpm": plateaus, "start_angle_deg": degrees}, records),
        tables=(
            numbers_table("startup", heads, COLUMNS, records),
            StudyTable("iso_4392_starting_torque", head, tuple(rows)),
        ),
    )


def started(case: Case) -> Mapping[str, Any]:
    """Run a start and return its summary numbers; a shaft that never turns did not start."""
    from toothspace import api

    found = api.simulate(case)
    held = next((x for x in found.warnings if x.quantity == STANDING), None)
    if held is not None and math.isnan(found.breakaway_time):
        found = found.short_of(replace(held, severity="serious"))
    return numbers_of(found)


_RPM = 60.0 / (2.0 * np.pi)
PAPER_RATIO = 4.0
"""Start-up over running pressure in measurements of Pawar, Vacca and Rigosi. [-]"""


def figures(data: xr.Dataset) -> list[StudyFigure]:
    """Start-up pressure over the plateau speed, breakaway over the start angle."""
    found = []
    if has_numbers(data, "startup_pressure_ratio", "settled_pressure_bar"):
        if data.sizes["plateau_speed"] > 1:
            caption = "Start-up over running pressure; dashed: the ratio that the paper measured."
            figure = ratio_over_plateau_speed(data)
            found.append(StudyFigure("startup_ratio", caption, figure))
        if data.sizes["start_angle"] > 1:
            caption = "Breakaway pressure over the start angle; dashed: its mean."
            found.append(StudyFigure("breakaway_angle", caption, breakaway_over_angle(data)))
    return found


@styled
def ratio_over_plateau_speed(data: xr.Dataset) -> Figure:
    """Start-up pressure over running pressure, over the plateau speed of the supply."""
    figure = new_figure(7.2, 5.2)
    ratio, pressure = figure.subplots(2, 1, sharex=True)
    speed = data["plateau_speed"].values * _RPM
    for name, label, color in (
        ("startup_pressure_ratio", "over largest running pressure", BLUE),
        ("startup_to_settled_ratio", "over settled pressure", GREEN),
    ):
        ratio.plot(speed, data[name].mean("start_angle").values, "o-", color=color, label=label)
    ratio.axhline(PAPER_RATIO, color=GREY, linewidth=0.8, linestyle="--")
    ratio.set(ylabel="Start-up pressure ratio (-)", title="Start-up pressure over running pressure")
    ratio.legend(loc="upper right")
    for name, label, color in (
        ("startup_pressure_bar", "Start-up", ORANGE),
        ("max_running_pressure_bar", "Largest running", BLUE),
        ("settled_pressure_bar", "Settled", GREEN),
    ):
        values = data[name].mean("start_angle").values
        pressure.plot(speed, values, "o-", color=color, label=label)
    pressure.set(ylabel="Pressure (bar)", xlabel="Plateau speed (rpm)")
    pressure.legend(loc="upper center", ncols=3)
    return figure


@styled
def breakaway_over_angle(data: xr.Dataset) -> Figure:
    """Pressure at which the shaft breaks away, over the start angle."""
    figure = new_figure(7.2, 3.2)
    axes = figure.subplots()
    angle = np.degrees(data["start_angle"].values)
    mean = data["breakaway_pressure_bar"].mean("plateau_speed").values
    axes.plot(angle, mean, "o-", color=ORANGE)
    axes.axhline(float(np.nanmean(mean)), color=GREY, linewidth=0.8, linestyle="--")
    axes.set_xlabel("Start angle (deg)")
    axes.set_ylabel("Breakaway pressure (bar)")
    axes.set_title("Breakaway over one tooth pitch")
    return figure


STUDY = Study(StartupStudy, run, figures)
