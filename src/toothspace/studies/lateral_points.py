"""Operating points of a floating bearing, one after another."""

from __future__ import annotations

import math
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cache, partial
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace import api
from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.core.progress import Progress, part, tell
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.floating.coupling import (
    CoupledPoint,
    LumpedRun,
    PointRequest,
    couple_point,
)
from toothspace.floating.problem import (
    LateralNumbers,
    LateralSettings,
    balance_of,
)
from toothspace.model.floating_bearing import HousingContact, LateralBalance
from toothspace.results.summary_names import unit_of
from toothspace.results.variables import variable
from toothspace.run.elastic import lateral_settings, require_floating_part
from toothspace.run.run import Run
from toothspace.studies.points import operating_point_of
from toothspace.studies.stored_point import (
    FIELDS,
    StoredPoint,
    record_of,
    recorded_point,
    stored_point,
)
from toothspace.studies.study import StudyContext, StudyResult, StudyTable

if TYPE_CHECKING:
    import xarray as xr

_CREEP_TIME = 0.02
"""Time at each point under the smooth friction law, which holds nothing. [s]"""
_AT_REST = 1e-9
"""Way below which a bearing has not moved. [m]"""
_LUMPED_TOLERANCE = 1e-5
_LUMPED_REVOLUTIONS = 24


@final
@dataclass(frozen=True, kw_only=True)
class PointCondition:
    """One point of a study."""

    label: str
    """Name."""
    outlet_pressure: float
    inlet_pressure: float
    """Absolute pressures. [Pa]"""
    shaft_speed: float
    """Shaft speed. [rad/s]"""
    nose_pressure: float | None = None
    """Absolute pressure on the nose; None: the low pressure. [Pa]"""

    @classmethod
    def of(cls, case: Case, label: str, **given: float) -> PointCondition:
        """Condition of a case with an operating point, but for what is given."""
        point = operating_point_of(case)
        names = ("outlet_pressure", "inlet_pressure", "shaft_speed")
        return cls(label=label, **{name: getattr(point, name) for name in names} | given)


@final
@dataclass(frozen=True)
class LateralStudy:
    """Points of a study in their order."""

    conditions: tuple[PointCondition, ...]
    """What is asked for."""
    points: tuple[StoredPoint, ...]
    """What was found; after an interrupt the points at the end are missing."""
    start_gap: float = math.nan
    """Gap that the first point starts from. [m]"""
    follow: bool = True
    """Whether every other point starts where the one before ended, or from the same gap."""

    @property
    def held_by_friction(self) -> tuple[bool, ...]:
        """Whether friction leaves the bearing where each point starts."""
        places = [point.numbers.position for point in self.points]
        solid = any(name.startswith("solid") for name in self.points[0].films)
        # gears float with the bearing: its way is both films where one side is solid
        first = self.start_gap * (2.0 if solid else 1.0)
        starts = [first, *places[:-1]] if self.follow else [first] * len(places)
        return tuple(abs(x - start) < _AT_REST for x, start in zip(places, starts, strict=True))

    @property
    def status(self) -> Status:
        """Interrupted, else failure of the first point that failed, else done."""
        if len(self.points) < len(self.conditions):
            return Status.INTERRUPTED
        return next((p.status for p in self.points if p.status is not Status.DONE), Status.DONE)

    @property
    def outlet_pressures(self) -> tuple[float, ...]:
        """Outlet pressures of the points found. [Pa]."""
        return tuple(c.outlet_pressure for c in self.conditions[: len(self.points)])

    def summary(self) -> dict[str, Any]:
        """Numbers of all points as lists, with unit suffixes."""
        numbers = [p.numbers for p in self.points]
        first, shown = numbers[0].position, [film_numbers(n) for n in numbers]
        rises = [p.temperature_rise for p in self.points]
        second = {}
        if numbers[0].positions.size > 1:
            second["second_position_um"] = [float(n.positions[1]) * 1e6 for n in numbers]

        def column(*names: str) -> dict[str, list[float]]:
            return {name: [one[name] for one in shown] for name in names}

        return {
            "point": [c.label for c in self.conditions[: len(self.points)]],
            "outlet_pressure_bar": [p * 1e-5 for p in self.outlet_pressures],
            "nose_pressure_bar": [p.nose_pressure * 1e-5 for p in self.points],
            **column("bearing_position_um"),
            "relative_position_um": [(n.position - first) * 1e6 for n in numbers],
            **column("film_height_um", "smallest_film_um", "leakage_L_per_min", "torque_loss_N_m"),
            "bearing_tilt_mrad": [n.tilt * 1e3 for n in numbers],
            **second,
            **({"film_temperature_rise_K": rises} if all(r is not None for r in rises) else {}),
            **column("contact_force_N", "real_contact_area_mm2", "contact_share"),
            **column("wear_power_W_per_mm2", "friction_force_N"),
            "breakaway_force_N": [p.breakaway_force for p in self.points],
            "held_by_friction": list(self.held_by_friction),
            **column("seat_force_N", "seat_margin_mm"),
            "preload_N": [p.preload for p in self.points],
            "force_balance_error": [p.residual for p in self.points],
            "point_status": [p.status.name.lower() for p in self.points],
        }

    def dataset(self) -> xr.Dataset:
        """Numbers over ``point`` and the fields of all films: at the last angle, wear over all."""
        import xarray as xr

        lists = self.summary()
        data: dict[str, Any] = {
            name: ("point", np.asarray(values), {"units": unit_of(name)})
            for name, values in lists.items()
            if name not in ("point", "point_status")
        }
        for name, key in (("point_label", "point"), ("point_status", "point_status")):
            data[name] = ("point", np.asarray(lists[key], dtype=str))
        maps = [p.maps for p in self.points]
        for name in FIELDS:
            entry = variable(name)
            stacked = np.stack([own[name] for own in maps])
            data[name] = (("point", *entry.dimensions), stacked, {"units": entry.units})
        coords: dict[str, Any] = {"film": list(self.points[0].films)}
        for name in maps[0].keys() - set(FIELDS):
            entry = variable(name)
            coords[name] = (entry.dimensions, maps[0][name], {"units": entry.units})
        return xr.Dataset(data, coords=coords)

    def result(self, numbers: Mapping[str, Any], beside: xr.Dataset | None = None) -> StudyResult:
        """Return the study for files and reports, with numbers and data of its own."""
        lists = self.summary()
        data = self.dataset()
        return StudyResult(
            status=self.status,
            data=data if beside is None else data.merge(beside),
            numbers={**numbers, **lists},
            tables=(StudyTable.of("points", lists),),
        )


def film_numbers(numbers: LateralNumbers) -> dict[str, float]:
    """Numbers of the films at one point, names with unit suffix."""
    return {
        "bearing_position_um": numbers.position * 1e6,
        "film_height_um": float(numbers.gaps.mean()) * 1e6,
        "smallest_film_um": numbers.smallest_gap * 1e6,
        "contact_force_N": numbers.contact_force,
        "real_contact_area_mm2": numbers.real_contact_area * 1e6,
        "contact_share": numbers.contact_share,
        "wear_power_W_per_mm2": numbers.wear_power * 1e-6,
        "leakage_L_per_min": numbers.leakage * 6e4,
        "torque_loss_N_m": numbers.viscous_torque + numbers.asperity_torque,
        "friction_force_N": numbers.friction_force,
        "seat_force_N": numbers.seat_force,
        "seat_margin_mm": numbers.seat_margin * 1e3,
    }


@final
@dataclass(frozen=True, eq=False)
class LateralPoints:
    """Machine of a case, prepared for points of a floating bearing."""

    case: Case
    """The case, with an operating point."""
    run: Run
    """The machine after running-in, with the housing friction of the study."""
    settings: LateralSettings
    """Grids and laws of the films."""
    rounds: int = 1
    """Most lumped runs at a point."""

    @property
    def balance(self) -> LateralBalance:
        """Lateral balance of the machine."""
        return balance_of(self.run.machine)

    def solve(
        self, point: PointCondition, start: Array | float, progress: Progress | None = None
    ) -> CoupledPoint:
        """Coupled solution of one point, begun from positions or from a gap. [m, rad]."""
        return couple_point(
            self.run.machine,
            self.run.fluid,
            self.lumped(point, progress),
            self._request(point, start),
        )

    def solve_alike(
        self,
        conditions: Sequence[PointCondition],
        start_gap: float,
        context: StudyContext,
        keys: Sequence[str],
    ) -> tuple[StoredPoint, ...]:
        """Points that differ in the nose pressure alone, each from one gap. [m].

        They share the chamber pressures of the first, unless chambers and films are to agree. After
        an interrupt by the user those that are finished; records are kept as by :func:`follow`.
        """
        run, shared = self.run, cache(self.lumped(conditions[0]))

        def solved(condition: PointCondition) -> CoupledPoint:
            if self.rounds > 1:
                return self.solve(condition, start_gap)
            request = replace(self._request(condition, start_gap), rounds=1)
            return couple_point(run.machine, run.fluid, lambda _: shared(run.machine), request)

        found = []
        for condition, key in zip(conditions, keys, strict=True):
            point = _kept_or_solved(context, key, partial(solved, condition))
            if point is None:
                break
            found.append(point)
        return tuple(found)

    def lumped(self, point: PointCondition, progress: Progress | None = None) -> LumpedRun:
        """Lumped runs of one point, of the machine and of changed ones."""
        base = self.run.condition
        condition = replace(
            base,
            shaft_speed=point.shaft_speed,
            inlet_pressure=point.inlet_pressure,
            outlet_pressure=point.outlet_pressure,
            relative_tolerance=max(base.relative_tolerance, _LUMPED_TOLERANCE),
        )
        return replace(self.run, condition=condition).repeated(progress)

    def _request(self, point: PointCondition, start: Array | float) -> PointRequest:
        return PointRequest(
            settings=self.settings,
            start=start,
            nose_pressure=point.nose_pressure,
            rounds=self.rounds,
        )


def housing_contact(study: Any) -> HousingContact:
    """Friction in the housing by the three keys of a study for it."""
    return HousingContact(
        friction_coefficient=study.friction_coefficient,
        breakaway_speed=study.breakaway_speed,
        law=study.friction_law,
    )


def prepare(case: Case, friction: HousingContact | None, kind: str) -> LateralPoints:
    """Run the machine of a study in and give its bearing the friction of the study, if any.

    Raises
    ------
    CaseError
        If the case has no operating point or the machine no floating bearing.
    """
    if case.operating_point is None:
        allowed = "an [operating_point] that the study starts from"
        raise CaseError("operating_point", f"none with study.kind = {kind!r}", allowed)
    require_floating_part(case)
    few = replace(case.run, max_revolutions=min(case.run.max_revolutions, _LUMPED_REVOLUTIONS))
    run = api.prepare(replace(case, run=few)).worn().with_films()
    balance = balance_of(run.machine)
    own = balance.floating.housing
    friction = own if friction is None else replace(friction, area=own.area)
    floating = replace(balance.floating, housing=friction)
    machine = replace(run.machine, lateral_balance=replace(balance, floating=floating))
    settings = lateral_settings(case)
    if friction.law == "stribeck":
        settings = replace(settings, dwell=_CREEP_TIME)
    return LateralPoints(case, replace(run, machine=machine), settings)


def follow(
    points: LateralPoints,
    conditions: Sequence[PointCondition],
    start_gap: float,
    context: StudyContext,
    keys: Sequence[str],
) -> tuple[StoredPoint, ...]:
    """Solve points one after another, each from the equilibrium of the one before.

    Parameters
    ----------
    start_gap : float
        Gap that the first one starts from. [m]

    Returns
    -------
    tuple of StoredPoint
        After an interrupt by the user those that are finished.
    """
    found: list[StoredPoint] = []
    now: Array | float = start_gap
    for k, (condition, key) in enumerate(zip(conditions, keys, strict=True)):
        share = k / len(conditions)
        tell(context.progress, share, condition.label)
        own = part(context.progress, condition.label, share, share)
        point = _kept_or_solved(context, key, partial(points.solve, condition, now, own))
        if point is None:
            break
        found.append(point)
        now = point.coordinates
    if not found:
        raise KeyboardInterrupt
    return tuple(found)


def _kept_or_solved(
    context: StudyContext, key: str, solve: Callable[[], CoupledPoint]
) -> StoredPoint | None:
    """Point of a record, or a new one with its record; None after an interrupt by the user."""
    kept = context.records.get(key)
    if kept is not None:
        return recorded_point(kept)
    try:
        point = stored_point(solve())
    except KeyboardInterrupt:
        return None
    context.records.add(record_of(key, point))
    return point
