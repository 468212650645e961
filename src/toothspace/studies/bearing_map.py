"""Films of a floating bearing in equilibrium over shaft speed and outlet pressure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from itertools import product
from typing import Any, final

from toothspace.case import Case
from toothspace.core.keys import KeyTable, grid, integer, quantity
from toothspace.core.units import from_si
from toothspace.floating.coupling import CoupledPoint
from toothspace.plotting.bearing_figures import map_figures
from toothspace.run.elastic import require_floating_part
from toothspace.studies.keys import PRESSURE, SPEED
from toothspace.studies.lateral_points import PointCondition, film_numbers, prepare
from toothspace.studies.points import (
    collected,
    operating_point_of,
    operating_values,
    point,
    status_of,
)
from toothspace.studies.study import Study, StudyContext, StudyResult, StudyTable
from toothspace.studies.tabulate import columns, map_dataset, point_lists


@final
@dataclass(frozen=True, kw_only=True)
class BearingMapStudy(KeyTable):
    """``kind = "bearing_map"``: equilibrium of a floating bearing over speed and pressure."""

    shaft_speed: tuple[float, ...] = grid(SPEED, "Shaft speeds.")
    outlet_pressure: tuple[float, ...] = grid(PRESSURE, "Absolute outlet pressures.")
    start_gap: float = quantity(
        "um", "Gap that every point starts from.", above=0, high=100, default=2e-6
    )
    coupling_rounds: int = integer(
        "Most runs of the chambers per point until they agree with the films; 1: as described.",
        low=1,
        high=20,
        default=6,
    )


def run(case: Case, context: StudyContext) -> StudyResult:
    """Find the equilibrium at every shaft speed and outlet pressure, each from the start gap.

    Returns
    -------
    StudyResult
        Numbers of the films over ``shaft_speed`` and ``outlet_pressure``.

    Raises
    ------
    CaseError
        If the case has no operating point or no floating bearing.
    """
    study = case.study
    assert isinstance(study, BearingMapStudy)
    operating_point_of(case)
    require_floating_part(case)
    pairs = list(product(study.shaft_speed, study.outlet_pressure))
    points = [
        point(case, operating_values(shaft_speed=speed, outlet_pressure=pressure))
        for speed, pressure in pairs
    ]
    evaluate = BearingNumbers(study.start_gap, study.coupling_rounds)
    records = collected(points, context, evaluate)
    values = {
        "shaft_speed_rpm": [from_si(speed, "rpm") for speed, _ in pairs],
        "outlet_pressure_bar": [pressure * 1e-5 for _, pressure in pairs],
    }
    lists: dict[str, Sequence[Any]] = {
        **values,
        **columns(records),
        "status": [r.status for r in records],
    }
    axes = {
        "shaft_speed": (study.shaft_speed, "rad/s"),
        "outlet_pressure": (study.outlet_pressure, "Pa"),
    }
    return StudyResult(
        status=status_of(records),
        data=map_dataset(axes, records),
        numbers=point_lists(values, records),
        tables=(StudyTable.of("points", lists),),
    )


@final
@dataclass(frozen=True)
class BearingNumbers:
    """Evaluates a case to numbers of its bearing in equilibrium, for points of a study."""

    start_gap: float
    """Gap that the bearing starts from. [m]"""
    rounds: int = 1
    """Most runs of the chambers. [-]"""

    @property
    def label(self) -> str:
        """Says what is evaluated, for the records of points."""
        return f"bearing in equilibrium from {self.start_gap:.12g} m, {self.rounds} rounds"

    def __call__(self, case: Case) -> Mapping[str, Any]:
        """Return numbers of the films with the status, names with unit suffix."""
        condition = PointCondition.of(case, case.title)
        points = replace(prepare(case, None, "bearing_map"), rounds=self.rounds)
        return point_numbers(points.solve(condition, self.start_gap))


def point_numbers(found: CoupledPoint) -> dict[str, Any]:
    """Numbers of one point with its status."""
    rise = found.temperature_rise
    return {
        **({} if rise is None else {"film_temperature_rise_K": rise}),
        **film_numbers(found.numbers),
        "force_balance_error": found.equilibrium.balance.residual,
        "status": found.status.name.lower(),
    }


STUDY = Study(BearingMapStudy, run, map_figures)
