"""Position of a pressed bearing as the outlet pressure goes up and down."""

from __future__ import annotations

from toothspace.case import Case
from toothspace.case.study import HysteresisStudy
from toothspace.core.errors import CaseError
from toothspace.model.lateral_balance import HousingContact
from toothspace.studies.lateral_points import (
    LateralStudy,
    PointCondition,
    follow,
    prepare,
)
from toothspace.studies.study import Progress, StudyContext, StudyResult


def run(case: Case, context: StudyContext) -> StudyResult:
    """Position, leakage and torque loss as the outlet pressure goes up and down.

    Parameters
    ----------
    case : Case
        Case with ``kind = "hysteresis"``, an operating point and a pressed bearing.
    context : StudyContext
        Progress; points follow from one another, so one process computes them.

    Returns
    -------
    StudyResult
        Numbers and films over ``point``, and the area of the loop.

    Raises
    ------
    CaseError
        If the case has no operating point or no pressed bearing.
    """
    study = follow_pressures(case, context.progress)
    return study.result(case, {"loop_area_um_bar": loop_area(study) * 1e6 * 1e-5})


def follow_pressures(case: Case, progress: Progress | None = None) -> LateralStudy:
    """Follow the bearing through the outlet pressures of ``[study]``.

    Parameters
    ----------
    case : Case
        Case with ``kind = "hysteresis"`` and an operating point.
    progress : callable, optional
        Called with the finished share and a short text.

    Returns
    -------
    LateralStudy
        One point per outlet pressure; every point starts from the state before it.

    Raises
    ------
    CaseError
        If the case has another study, no operating point or no pressed bearing.

    References
    ----------
    .. [1] D. Thiagarajan, A. Vacca, S. Watkins, On the lubrication performance of external gear
       pumps for aerospace fuel delivery applications, Mech. Syst. Signal Process. 129 (2019)
       659-676, section 4.2 and 4.3.
    """
    study = case.study
    if not isinstance(study, HysteresisStudy):
        raise CaseError('study.kind: found another study, allowed "hysteresis"')
    friction = HousingContact(
        friction_coefficient=study.friction_coefficient,
        breakaway_speed=study.breakaway_speed,
        law=study.friction_law,
    )
    points = prepare(case, friction, "hysteresis")
    base = case.operating_point
    assert base is not None
    conditions = [
        PointCondition(
            label=f"{k + 1}: {pressure * 1e-5:.4g} bar",
            outlet_pressure=pressure,
            inlet_pressure=base.inlet_pressure,
            shaft_speed=base.shaft_speed,
        )
        for k, pressure in enumerate(study.outlet_pressures)
    ]
    found = follow(points, conditions, study.start_gap, progress)
    return LateralStudy(
        "hysteresis",
        tuple(c.label for c in conditions),
        found,
        study.outlet_pressures,
        tuple(p.problem.loads.back.nose for p in found),
    )


def loop_area(study: LateralStudy) -> float:
    """Area between the ways down and up, positive if the bearing stays farther away. [m Pa]."""
    pressure = study.outlet_pressures
    position = [p.numbers.position for p in study.points]
    ways = zip(pressure, position, pressure[1:], position[1:], strict=False)
    return -sum(0.5 * (a + b) * (q - p) for p, a, q, b in ways)
