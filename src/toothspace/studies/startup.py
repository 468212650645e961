"""Start-up over the plateau speed of the supply and the shaft angle of the start."""

from __future__ import annotations

import math
from collections.abc import Sequence
from itertools import product

import numpy as np

from toothspace.case import Case
from toothspace.case.study import StartupStudy
from toothspace.circuit.pumps import PumpMap
from toothspace.core.errors import CaseError
from toothspace.core.units import from_si
from toothspace.studies.points import collected, point, status_of
from toothspace.studies.records import Record, failed_count
from toothspace.studies.study import Row, StudyContext, StudyResult, StudyTable
from toothspace.studies.tabulate import map_dataset, numbers_table

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
        raise CaseError(
            f"{case.source}: study.kind: found {found}, allowed a circuit with a supply"
        )
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
    records = collected(points, context)
    plateaus = [from_si(speed, "rpm") for speed, _ in pairs]
    degrees = [math.degrees(angle) for _, angle in pairs]
    heads = {"plateau speed (rpm)": plateaus, "start angle (deg)": degrees}
    numbers = {
        "points": len(records),
        "points_failed": failed_count(records),
        "plateau_speed_rpm": plateaus,
        "start_angle_deg": degrees,
        **{name: [record.number(name) for record in records] for name, _ in COLUMNS},
        "real_time_factor": [record.number("real_time_factor") for record in records],
        "point_status": [r.status for r in records],
    }
    axes = {"plateau_speed": (speeds, "rad/s"), "start_angle": (angles, "rad")}
    return StudyResult(
        status=status_of(records),
        data=map_dataset(axes, records),
        numbers=numbers,
        tables=(numbers_table("startup", heads, COLUMNS, records), _starting_torque(records)),
    )


def _starting_torque(records: Sequence[Record]) -> StudyTable:
    """Starting torque over ideal torque: what breakaway leaves, least and mean over the angle."""
    found = [record.number("breakaway_pressure_bar") for record in records]
    breakaway = np.array([value for value in found if math.isfinite(value)])
    rows: list[Row] = []
    if breakaway.size:
        rows = [
            (p, 1.0 - float(breakaway.max()) / p, 1.0 - float(breakaway.mean()) / p)
            for p in _PRESSURES
            if p > breakaway.max()
        ]
    head = ("pressure difference (bar)", "least starting efficiency", "mean starting efficiency")
    return StudyTable("iso_4392_starting_torque", head, tuple(rows))
