"""Position of a floating bearing over the pressure on its nose."""

from __future__ import annotations

from dataclasses import replace
from itertools import chain

from toothspace.case import Case
from toothspace.case.study import NoseCondition, NosePressureStudy
from toothspace.core.errors import CaseError
from toothspace.core.progress import tell
from toothspace.studies.lateral_points import LateralStudy, PointCondition, housing_contact, prepare
from toothspace.studies.points import operating_point_of
from toothspace.studies.stored_point import StoredPoint, point_key
from toothspace.studies.study import StudyContext, StudyResult


def run(case: Case, context: StudyContext) -> StudyResult:
    """Position of the bearing over the pressure on its nose at several conditions.

    Returns
    -------
    StudyResult
        Numbers and films over ``point``.

    Raises
    ------
    CaseError
        If the case has no operating point, no floating bearing or one without a nose.
    """
    return solve_conditions(case, context).result({})


def solve_conditions(case: Case, context: StudyContext | None = None) -> LateralStudy:
    """Solve every condition of ``[study]`` at every nose pressure, each from the start gap.

    Parameters
    ----------
    case : Case
        Case with ``kind = "nose_pressure"`` and an operating point.
    context : StudyContext, optional
        Progress, and records of points that are finished.

    Returns
    -------
    LateralStudy
        Conditions one after another, nose pressures rising within each.

    Raises
    ------
    CaseError
        If the case has another study, no operating point, no floating bearing or no nose.

    References
    ----------
    .. [1] D. Thiagarajan, A. Vacca, S. Watkins, On the lubrication performance of external gear
       pumps for aerospace fuel delivery applications, Mech. Syst. Signal Process. 129 (2019)
       659-676, section 4.4.
    """
    study = case.study
    if not isinstance(study, NosePressureStudy):
        raise CaseError('study.kind: found another study, allowed "nose_pressure"')
    friction = housing_contact(study)
    points = prepare(case, friction, "nose_pressure")
    if points.balance.floating.nose.area <= 0.0:
        raise CaseError(
            "study.kind: found 'nose_pressure' for a floating part without nose, allowed one with "
            "a nose (area and center)"
        )
    context, shared = context or StudyContext(), (study.start_gap, friction)
    every = [_conditions(case, one, study.nose_pressure_fractions) for one in study.conditions]
    found: list[StoredPoint] = []
    for k, asked in enumerate(every):
        tell(context.progress, k / len(every), study.conditions[k].name)
        keys = [point_key(case, "nose_pressure", *shared, replace(c, label="")) for c in asked]
        new = points.solve_alike(asked, study.start_gap, context, keys)
        found += new
        if len(new) < len(asked):
            break
    if not found:
        raise KeyboardInterrupt
    return LateralStudy(tuple(chain.from_iterable(every)), tuple(found))


def _conditions(
    case: Case, condition: NoseCondition, fractions: tuple[float, ...]
) -> list[PointCondition]:
    inlet = condition.inlet_pressure or operating_point_of(case).inlet_pressure
    return [
        PointCondition(
            label=f"{condition.name}, {fraction:.4g}",
            outlet_pressure=condition.outlet_pressure,
            inlet_pressure=inlet,
            shaft_speed=condition.shaft_speed,
            # no nose is below the inlet that it is connected to
            nose_pressure=max(fraction * condition.outlet_pressure, inlet),
        )
        for fraction in fractions
    ]
