"""Operating points of a floating bearing, one after another, in memory and on disk."""

from __future__ import annotations

import base64
import hashlib
import math
import zlib
from collections.abc import Callable, Mapping, Sequence
from dataclasses import asdict, dataclass, field, fields, replace
from functools import partial
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace import api
from toothspace.case import Case
from toothspace.core.compilation.sources import digest_of_sources
from toothspace.core.errors import CaseError
from toothspace.core.files import plain
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
    film_fields,
    film_places,
)
from toothspace.model.description import MachineDescription
from toothspace.model.floating_bearing import STICK, HousingContact, LateralBalance
from toothspace.results.solution import Solution
from toothspace.results.variables import unit_of, variable
from toothspace.run.elastic import lateral_settings, require_floating_part
from toothspace.run.run import Marches, Run
from toothspace.studies.points import operating_point_of
from toothspace.studies.study import Record, StudyContext, StudyResult, StudyTable

if TYPE_CHECKING:
    import xarray as xr


FIELDS = ("film_height", "film_pressure", "film_contact_pressure", "film_wear_power")
"""Fields of every film that a study keeps."""
_SCALARS = ("residual", "nose_pressure", "breakaway_force", "preload", "temperature_rise")


@final
@dataclass(frozen=True, eq=False, kw_only=True)
class StoredPoint:
    """What a study keeps of one point."""

    status: Status
    """Outcome."""
    numbers: LateralNumbers
    """Mean numbers of the films."""
    residual: float
    """Largest force out of balance over the force behind the bearing. [-]"""
    nose_pressure: float
    """Absolute pressure on the nose. [Pa]"""
    breakaway_force: float
    """Friction of the housing at which the bearing breaks away. [N]"""
    preload: float
    """Force of springs and seal. [N]"""
    temperature_rise: float | None
    """Hottest film above the fluid; None where none warms up. [K]"""
    coordinates: Array
    """Positions and rotations of all bodies. [m, rad]"""
    films: tuple[str, ...]
    """Names of the films."""
    maps: Mapping[str, Array]
    """Fields of the films and the places of their cells, by the names of results."""


def stored_point(point: CoupledPoint) -> StoredPoint:
    """Take from a coupled solution what a study keeps."""
    stack, balance = point.problem.stack, point.equilibrium.balance
    drawn = film_fields(balance)
    return StoredPoint(
        status=point.status,
        numbers=point.numbers,
        residual=balance.residual,
        nose_pressure=point.problem.loads.back.nose,
        breakaway_force=point.problem.loads.friction.breakaway_force,
        preload=stack.balance.floating.preload.size,
        temperature_rise=point.temperature_rise,
        coordinates=balance.position,
        films=tuple(grid.interface.name for grid in stack.grids),
        maps={**{name: drawn[name].astype(np.float32) for name in FIELDS}, **film_places(stack)},
    )


def record_of(key: str, point: StoredPoint) -> Record:
    """Return the record from which :func:`recorded_point` makes the same point again."""
    numbers = {
        **{name: getattr(point, name) for name in _SCALARS},
        "films": point.films,
        "coordinates": point.coordinates,
        "lateral_numbers": asdict(point.numbers),
        "maps": {
            name: {
                "type": values.dtype.str,
                "shape": values.shape,
                "content": base64.b64encode(zlib.compress(values.tobytes())).decode("ascii"),
            }
            for name, values in point.maps.items()
        },
    }
    return Record(
        key,
        point.status.name.lower(),
        plain(numbers),
        "" if point.status is Status.DONE else point.status.value,
    )


def recorded_point(record: Record) -> StoredPoint:
    """Return the point of a record."""
    kept: Mapping[str, Any] = record.numbers
    values: dict[str, Any] = {
        f.name: kept["lateral_numbers"][f.name] for f in fields(LateralNumbers)
    }
    # JSON knows neither arrays nor numbers that are not
    for name, value in values.items():
        if value is None or isinstance(value, list):
            values[name] = float("nan") if value is None else np.array(value)
    return StoredPoint(
        status=Status[record.status.upper()],
        numbers=LateralNumbers(**values),
        **{name: kept[name] for name in _SCALARS},
        films=tuple(kept["films"]),
        coordinates=np.array(kept["coordinates"]),
        maps={
            name: np.frombuffer(
                zlib.decompress(base64.b64decode(packed["content"])), dtype=packed["type"]
            ).reshape(packed["shape"])
            for name, packed in kept["maps"].items()
        },
    )


def point_key(case: Case, *what: object) -> str:
    """Key of the record of a point: the case without its study, and what else decides.

    Parameters
    ----------
    *what : object
        Numbers and texts that the point depends on besides the case.
    """
    text = "\n".join((case.at_point({}).hash, repr(what), digest_of_sources()))
    return hashlib.sha256(text.encode()).hexdigest()[:32]


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
    anew: bool = False
    """Whether it begins from the start gap, not from where the point before ended."""

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
    """Gap that the first point starts from, and every one that begins anew. [m]"""

    @property
    def held_by_friction(self) -> tuple[bool, ...]:
        """Whether friction leaves the bearing where each point starts."""
        places = [point.numbers.position for point in self.points]
        solid = any(name.startswith("solid") for name in self.points[0].films)
        # gears float with the bearing: its way is both films where one side is solid
        first = self.start_gap * (2.0 if solid else 1.0)
        starts = [
            first if k == 0 or self.conditions[k].anew else places[k - 1]
            for k in range(len(places))
        ]
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
            **column("hold_down_force_N", "tipping_margin_mm"),
            # former names of these two
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
        "hold_down_force_N": numbers.hold_down_force,
        "tipping_margin_mm": numbers.tipping_margin * 1e3,
        "seat_force_N": numbers.hold_down_force,
        "seat_margin_mm": numbers.tipping_margin * 1e3,
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
    known: dict[tuple[float, ...], Solution] = field(default_factory=dict, repr=False)
    """Lumped runs of points that get one each: what stands on the nose does not change them."""

    @property
    def balance(self) -> LateralBalance:
        """Lateral balance of the machine."""
        return balance_of(self.run.machine)

    def solve(
        self, point: PointCondition, start: Array | float, progress: Progress | None = None
    ) -> CoupledPoint:
        """Coupled solution of one point, begun from positions or from a gap. [m, rad]."""
        lumped = self.lumped(point, progress)
        if self.rounds == 1:
            lumped = partial(self._once, lumped, point)
        request = PointRequest(
            settings=self.settings,
            start=start,
            nose_pressure=point.nose_pressure,
            rounds=self.rounds,
        )
        return couple_point(self.run.machine, self.run.fluid, lumped, request)

    def _once(
        self, lumped: LumpedRun, point: PointCondition, machine: MachineDescription
    ) -> Solution:
        place = point.shaft_speed, point.inlet_pressure, point.outlet_pressure
        if place not in self.known:
            self.known[place] = lumped(machine)
        return self.known[place]

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
        return Marches(replace(self.run, condition=condition), progress)


def prepare(case: Case, friction: HousingContact | None) -> LateralPoints:
    """Run the machine of a study in and give its bearing the friction of the study, if any.

    Raises
    ------
    CaseError
        If the case has no operating point or the machine no floating bearing.
    """
    if case.operating_point is None:
        allowed = "an [operating_point] that the study starts from"
        found = f"none with study.kind = {case.study_kind!r}"
        raise CaseError("operating_point", found, allowed)
    require_floating_part(case)
    few = replace(case.run, max_revolutions=min(case.run.max_revolutions, _LUMPED_REVOLUTIONS))
    run = api.prepare(replace(case, run=few)).worn().with_films()
    balance = balance_of(run.machine)
    own = balance.floating.housing
    friction = own if friction is None else replace(friction, area=own.area)
    floating = replace(balance.floating, housing=friction)
    machine = run.machine.with_balance(replace(balance, floating=floating))
    settings = lateral_settings(case)
    if friction.law != STICK:
        settings = replace(settings, dwell=_CREEP_TIME)
    return LateralPoints(case, replace(run, machine=machine), settings)


def follow(
    points: LateralPoints,
    conditions: Sequence[PointCondition],
    start_gap: float,
    context: StudyContext,
    keys: Sequence[str],
) -> tuple[StoredPoint, ...]:
    """Solve points one after another, each from the equilibrium of the one before or anew.

    After an interrupt by the user those that are finished.

    Parameters
    ----------
    start_gap : float
        Gap that the first one starts from, and every one that begins anew. [m]
    """
    found: list[StoredPoint] = []
    now: Array | float = start_gap
    for k, (condition, key) in enumerate(zip(conditions, keys, strict=True)):
        share, now = k / len(conditions), start_gap if condition.anew else now
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
