"""Position of a floating bearing over the pressure on its nose."""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import chain
from typing import final

from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.core.keys import (
    KeyTable,
    Number,
    Table,
    choice,
    integer,
    items,
    number,
    quantity,
    text,
)
from toothspace.core.progress import tell
from toothspace.plotting.lateral_figures import nose_figures
from toothspace.studies.lateral_points import LateralStudy, PointCondition, housing_contact, prepare
from toothspace.studies.points import operating_point_of
from toothspace.studies.stored_point import StoredPoint, point_key
from toothspace.studies.study import Study, StudyContext, StudyResult


@final
@dataclass(frozen=True, kw_only=True)
class NoseCondition(KeyTable):
    """One of ``conditions``."""

    name: str = text("Label.")
    outlet_pressure: float = quantity("bar", "Absolute pressure.", above=0, high=1000)
    shaft_speed: float = quantity("rpm", "Shaft speed.", above=0, high=50000)
    inlet_pressure: float | None = quantity(
        "bar", "Absolute pressure; default that of the operating point.", above=0, high=1000,
        default=None,
    )  # fmt: skip


@final
@dataclass(frozen=True, kw_only=True)
class NosePressureStudy(KeyTable):
    """``kind = "nose_pressure"``: pressure on the nose patch of the floating bearing."""

    nose_pressure_fractions: tuple[float, ...] = items(
        Number(low=0, high=1), "Nose pressure over outlet pressure; 0 means inlet pressure."
    )
    conditions: tuple[NoseCondition, ...] = items(
        Table(spec=NoseCondition), "Operating conditions."
    )
    friction_coefficient: float = number("Friction in the housing.", low=0, high=1, default=0.02)
    breakaway_speed: float = quantity(
        "mm/s", "Speed of the friction peak.", above=0, high=1e4, default=1.6e-3
    )
    friction_law: str = choice("Set-valued, or smooth.", "stick", "stribeck", default="stick")
    coupling_rounds: int = integer(
        "Most runs of the chambers per point until they agree with the films; 1: one run for all "
        "nose pressures of a condition.",
        low=1,
        high=20,
        default=1,
    )
    start_gap: float = quantity(
        "um", "Gap that every point starts from.", above=0, high=100, default=2e-6
    )

    def __post_init__(self) -> None:
        names = [one.name for one in self.conditions]
        twice = next((name for k, name in enumerate(names) if name in names[:k]), None)
        if twice is not None:
            raise CaseError("conditions", f"{twice!r} twice", "a name of its own for each")

    def port_pressures(self, inlet: float) -> list[tuple[str, float, float]]:
        """Return keys of pressures with the inlet and outlet pressure that they ask for. [Pa]."""
        return [
            (
                f"study.conditions[{k}].outlet_pressure",
                one.inlet_pressure or inlet,
                one.outlet_pressure,
            )
            for k, one in enumerate(self.conditions)
        ]


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
        raise CaseError("study.kind", "another study", '"nose_pressure"')
    friction = housing_contact(study)
    points = replace(prepare(case, friction, "nose_pressure"), rounds=study.coupling_rounds)
    if points.balance.floating.nose.area <= 0.0:
        raise CaseError(
            "study.kind",
            "'nose_pressure' for a floating part without nose",
            "one with a nose (area and center)",
        )
    context, shared = context or StudyContext(), (study.start_gap, friction, study.coupling_rounds)
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
    conditions = tuple(chain.from_iterable(every))
    return LateralStudy(conditions, tuple(found), study.start_gap, follow=False)


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


STUDY = Study(NosePressureStudy, run, nose_figures)
