"""Operating points of a pressed bearing, one after another."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.api import RunInMachine, condition_of, lateral_settings, run_in_machine
from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.films.lateral_gap.motion import Balance
from toothspace.model.description import MachineDescription
from toothspace.model.lateral_balance import HousingContact, LateralBalance
from toothspace.results.solution import Solution
from toothspace.results.variables import variable
from toothspace.solver.lateral_coupling import CoupledPoint, PointRequest, couple_point
from toothspace.solver.lateral_gap import (
    LateralNumbers,
    LateralSettings,
    balance_of,
    film_fields,
    film_places,
)
from toothspace.studies.study import Progress, StudyResult, StudyTable
from toothspace.studies.tabulate import provenance, unit_of

if TYPE_CHECKING:
    import xarray as xr

_FIELDS = ("film_height", "film_pressure", "film_contact_pressure", "film_wear_power")
_CREEP_TIME = 0.02
"""Time at each point under the smooth friction law, which holds nothing. [s]"""
_LUMPED_TOLERANCE = 1e-5
_LUMPED_REVOLUTIONS = 12


@final
@dataclass(frozen=True)
class LateralStudy:
    """Points of a study in their order.

    Parameters
    ----------
    kind : str
        ``hysteresis`` or ``nose_pressure``.
    labels : tuple of str
        Names of the points.
    points : tuple of CoupledPoint
        What was found.
    outlet_pressures, nose_pressures : tuple of float
        Conditions of the points. [Pa]
    """

    kind: str
    labels: tuple[str, ...]
    points: tuple[CoupledPoint, ...]
    outlet_pressures: tuple[float, ...]
    nose_pressures: tuple[float, ...]

    @property
    def status(self) -> Status:
        """Failure of the first point that failed, else done."""
        failed = [p.status for p in self.points if p.status is Status.NOT_CONVERGED]
        return failed[0] if failed else Status.DONE

    def summary(self) -> dict[str, Any]:
        """Numbers of all points as lists, with unit suffixes."""
        numbers = [p.numbers for p in self.points]
        first, shown = numbers[0].position, [film_numbers(n) for n in numbers]

        def column(*names: str) -> dict[str, list[float]]:
            return {name: [one[name] for one in shown] for name in names}

        return {
            "point": list(self.labels),
            "outlet_pressure_bar": [p * 1e-5 for p in self.outlet_pressures],
            "nose_pressure_bar": [p * 1e-5 for p in self.nose_pressures],
            **column("bearing_position_um"),
            "relative_position_um": [(n.position - first) * 1e6 for n in numbers],
            **column("film_height_um", "smallest_film_um", "leakage_L_per_min", "torque_loss_N_m"),
            **_parts(numbers),
            **self._warmth(),
            **column("contact_force_N", "real_contact_area_mm2", "contact_share"),
            **column("wear_power_W_per_mm2", "friction_force_N"),
            "breakaway_force_N": [p.problem.loads.friction.breakaway_force for p in self.points],
            **column("seat_force_N", "seat_margin_mm"),
            "preload_N": [p.problem.stack.balance.floating.preload for p in self.points],
            "point_status": [p.status.name.lower() for p in self.points],
        }

    def _warmth(self) -> dict[str, list[float]]:
        """Rise of the hottest film above the fluid, where films warm up."""
        found = [p.temperature_rise for p in self.points]
        rises = [rise for rise in found if rise is not None]
        return {"film_temperature_rise_K": rises} if len(rises) == len(found) else {}

    def dataset(self) -> xr.Dataset:
        """Numbers over ``point`` and the fields of all films: at the last angle, wear over all."""
        import xarray as xr

        data: dict[str, Any] = {
            name: ("point", np.asarray(values), {"units": unit_of(name)})
            for name, values in self.summary().items()
            if name not in ("point", "point_status")
        }
        data["point_label"] = ("point", np.asarray(self.labels, dtype=str))
        data["point_status"] = ("point", np.asarray(self.summary()["point_status"], dtype=str))
        fields = [film_fields(p.equilibrium.balance) for p in self.points]
        for name in _FIELDS:
            stacked = np.stack([field[name] for field in fields]).astype(np.float32)
            entry = variable(name)
            data[name] = (("point", *entry.dimensions), stacked, {"units": entry.units})
        stack = self.points[0].problem.stack
        coords: dict[str, Any] = {"film": [grid.interface.name for grid in stack.grids]}
        for name, place in film_places(stack).items():
            entry = variable(name)
            coords[name] = (entry.dimensions, place, {"units": entry.units})
        return xr.Dataset(data, coords=coords)

    def result(
        self, case: Case, numbers: Mapping[str, Any], beside: xr.Dataset | None = None
    ) -> StudyResult:
        """Return the study for files and reports, with numbers and data of its own."""
        lists = self.summary()
        rows = tuple(zip(*lists.values(), strict=True))
        data = self.dataset()
        return StudyResult(
            kind=self.kind,
            title=case.title,
            status=self.status,
            data=data if beside is None else data.merge(beside),
            numbers={**numbers, **lists},
            tables=(StudyTable("points", tuple(lists), rows),),
            provenance=provenance(case),
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


def _parts(numbers: Sequence[LateralNumbers]) -> dict[str, list[float]]:
    """Position of the second bearing or half, if there is one, and the largest tilt."""
    found = {"bearing_tilt_mrad": [n.tilt * 1e3 for n in numbers]}
    if numbers[0].positions.size > 1:
        found["second_position_um"] = [float(n.positions[1]) * 1e6 for n in numbers]
    return found


@final
@dataclass(frozen=True, kw_only=True)
class PointCondition:
    """One point of a study.

    Parameters
    ----------
    label : str
        Name.
    outlet_pressure, inlet_pressure : float
        Absolute pressures. [Pa]
    shaft_speed : float
        Shaft speed. [rad/s]
    nose_pressure : float or None
        Absolute pressure on the nose; None: the low pressure. [Pa]
    """

    label: str
    outlet_pressure: float
    inlet_pressure: float
    shaft_speed: float
    nose_pressure: float | None = None


@final
@dataclass(frozen=True, eq=False)
class LateralPoints:
    """Machine of a case, prepared for points of a pressed bearing.

    Parameters
    ----------
    case : Case
        The case, with an operating point.
    machine : RunInMachine
        The machine after running-in, with the housing friction of the study.
    settings : LateralSettings
        Grids and laws of the films.
    rounds : int
        Most lumped runs at a point.
    """

    case: Case
    machine: RunInMachine
    settings: LateralSettings
    rounds: int = 1

    @property
    def balance(self) -> LateralBalance:
        """Lateral balance of the machine."""
        return balance_of(self.machine.description)

    def solve(
        self, point: PointCondition, start: CoupledPoint | float, progress: Progress | None = None
    ) -> CoupledPoint:
        """Coupled solution of one point, begun from another or from a gap. [m]."""
        begun = start if isinstance(start, float) else start.equilibrium.balance
        return couple_point(
            self.machine.description if isinstance(start, float) else start.description,
            self.machine.fluid,
            lambda changed: self.lumped(point, changed, progress),
            self._request(point, begun),
        )

    def solve_alike(
        self, conditions: Sequence[PointCondition], start_gap: float
    ) -> list[CoupledPoint]:
        """Points that differ in the nose pressure alone, each from one gap. [m].

        They share the chamber pressures of the first.
        """
        solution = self.lumped(conditions[0])
        return [
            couple_point(
                self.machine.description,
                self.machine.fluid,
                lambda _: solution,
                replace(self._request(point, start_gap), rounds=1),
            )
            for point in conditions
        ]

    def lumped(
        self,
        point: PointCondition,
        description: MachineDescription | None = None,
        progress: Progress | None = None,
    ) -> Solution:
        """Chamber pressures of one point, of the machine or of a changed one."""
        base = condition_of(self.case, self.machine.description)
        condition = replace(
            base,
            shaft_speed=point.shaft_speed,
            inlet_pressure=point.inlet_pressure,
            outlet_pressure=point.outlet_pressure,
            relative_tolerance=max(base.relative_tolerance, _LUMPED_TOLERANCE),
        )
        return self.machine.solve(condition, description, progress)

    def _request(self, point: PointCondition, start: Balance | float) -> PointRequest:
        return PointRequest(
            settings=self.settings,
            start=start,
            nose_pressure=point.nose_pressure,
            rounds=self.rounds,
        )


def prepare(case: Case, friction: HousingContact | None, kind: str) -> LateralPoints:
    """Run the machine of a study in and give its bearing the friction of the study, if any.

    Raises
    ------
    CaseError
        If the case has no operating point or the machine no pressed bearing.
    """
    if case.operating_point is None:
        allowed = "an [operating_point] that the study starts from"
        raise CaseError(
            f"operating_point: found none with study.kind = {kind!r}, allowed {allowed}"
        )
    run = replace(case.run, max_revolutions=min(case.run.max_revolutions, _LUMPED_REVOLUTIONS))
    machine = run_in_machine(replace(case, run=run))
    balance = balance_of(machine.description)
    own = balance.floating.housing
    friction = own if friction is None else replace(friction, area=own.area)
    floating = replace(balance.floating, housing=friction)
    description = replace(machine.description, lateral_balance=replace(balance, floating=floating))
    settings = lateral_settings(case)
    if friction.law == "stribeck":
        settings = replace(settings, dwell=_CREEP_TIME)
    return LateralPoints(case, replace(machine, description=description), settings)


def follow(
    points: LateralPoints,
    conditions: Sequence[PointCondition],
    start: CoupledPoint | float,
    progress: Progress | None = None,
) -> tuple[CoupledPoint, ...]:
    """Solve points one after another, each from the state that the one before left."""
    found: list[CoupledPoint] = []
    now: CoupledPoint | float = start
    for k, condition in enumerate(conditions):
        if progress:
            progress(k / len(conditions), condition.label)
        now = points.solve(condition, now)
        found.append(now)
    return tuple(found)
