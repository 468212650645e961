"""Path of a floating bearing: pressures up and down, pressures on its nose, maps, balanced areas.

One study follows the bearing from point to point. ``hysteresis``, ``nose_pressure``,
``bearing_map`` and ``balance_sweep`` are names of it with the keys of one question each.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, fields, replace
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.core.keys import (
    KeyTable,
    Number,
    Table,
    again,
    choice,
    file_path,
    forbid,
    grid,
    integer,
    items,
    number,
    quantity,
    require,
    text,
)
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.core.units import from_si, parse_quantity
from toothspace.floating.coupling import CoupledPoint
from toothspace.floating.housing_friction import BREAKAWAY_RATIO, HousingFriction
from toothspace.model.floating_bearing import FRICTION_LAWS, STICK, HousingContact
from toothspace.plotting.film_maps import HEIGHT, WEAR, point_maps
from toothspace.plotting.style import (
    BLUE,
    CYCLE,
    GREY,
    INK,
    ORANGE,
    StudyFigure,
    contour_lines,
    new_figure,
    styled,
)
from toothspace.run.elastic import require_floating_part
from toothspace.studies import balance_sweep
from toothspace.studies.balance_sweep import BalanceSweepStudy
from toothspace.studies.bearing_points import (
    LateralStudy,
    PointCondition,
    film_numbers,
    follow,
    point_key,
    prepare,
)
from toothspace.studies.measured import read_measured
from toothspace.studies.points import (
    collected,
    columns,
    map_dataset,
    operating_point_of,
    operating_values,
    point,
    point_lists,
    status_of,
)
from toothspace.studies.study import Study, StudyContext, StudyResult, StudyTable
from toothspace.studies.variation import PRESSURE, SPEED

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_PRESSURE, _POSITION = "operating_point.outlet_pressure", "relative_position_um"
_SAME = 0.02
"""Difference of pressures that count as the same step. [-]"""


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
class BearingPathStudy(KeyTable):
    """``kind = "bearing_path"``: points of a floating bearing, one after another."""

    outlet_pressures: tuple[float, ...] | None = items(
        PRESSURE, "Outlet pressures in their order; or give conditions.", default=None
    )
    conditions: tuple[NoseCondition, ...] | None = items(
        Table(spec=NoseCondition), "Conditions in their order.", default=None
    )
    nose_pressure_fractions: tuple[float, ...] | None = items(
        Number(low=0, high=1),
        "Nose pressure over outlet pressure at every point; 0 means inlet pressure. Low pressure "
        "without.",
        default=None,
    )
    shaft_speed: tuple[float, ...] | None = grid(
        SPEED, "Shaft speeds, for a map over these and the outlet pressures.", default=None
    )
    balance_ratio: tuple[float, ...] | None = grid(
        Number(above=0, high=2),
        "Balanced area over the reference area, for loops over areas and friction.",
        default=None,
    )
    begin: str = choice(
        "Where a point begins: at the end of the one before it, or at the start gap.",
        "previous",
        "start_gap",
        default="previous",
    )
    start_gap: float = quantity(
        "um", "Gap that the path starts from.", above=0, high=100, default=2e-6
    )
    friction_coefficient: tuple[float, ...] | None = items(
        Number(low=0, high=1),
        "Friction in the housing, several with balance_ratio; default that of the machine.",
        default=None,
    )
    breakaway_speed: float = quantity(
        "mm/s", "Speed of the friction peak.", above=0, high=1e4, default=6.45e-3
    )
    friction_law: str = choice("Set-valued, or smooth.", *FRICTION_LAWS, default=STICK)
    coupling_rounds: int = integer(
        "Most runs of the chambers per point until they agree with the films; 1: as described.",
        low=1,
        high=20,
        default=1,
    )
    measured: Path | None = file_path(
        "Rows of operating_point.outlet_pressure and relative_position_um in the order of the "
        "measurement, to lay over the path.",
        ".csv",
        default=None,
    )
    sensor_deflection: float | None = quantity(
        "um/bar",
        "Travel of the sensor away from the gears over the outlet pressure, added to measured "
        "positions.",
        low=-10,
        high=10,
        default=None,
    )
    reference_area: float | None = quantity(
        "mm^2",
        "Area of the ratio one; default what plane rigid films carry at the highest pressure.",
        above=0,
        high=1e6,
        default=None,
    )
    lifted_gap: float = quantity(
        "um", "Gap from which the bearing counts as lifted off.", above=1, high=20, default=10e-6
    )

    def __post_init__(self) -> None:
        if (self.outlet_pressures is None) == (self.conditions is None):
            found = "neither this nor" if self.conditions is None else "both this and"
            raise CaseError("outlet_pressures", f"{found} conditions", "one of the two")
        names = [one.name for one in self.conditions or ()]
        twice = next((name for k, name in enumerate(names) if name in names[:k]), None)
        if twice is not None:
            raise CaseError("conditions", f"{twice!r} twice", "a name of its own for each")
        if self.measured is None:
            forbid(self, "or give measured positions", "sensor_deflection")
        if self.balance_ratio is None:
            forbid(self, "or give balance_ratio", "reference_area")
            if len(self.friction_coefficient or ()) > 1:
                found = f"{len(self.friction_coefficient or ())} values"
                raise CaseError("friction_coefficient", found, "one, or a balance_ratio")
        points = "conditions", "nose_pressure_fractions", "measured"
        if self.shaft_speed is not None:
            forbid(self, "because shaft_speed asks for a map", *points, "balance_ratio")
        elif self.balance_ratio is not None:
            forbid(self, "because balance_ratio is given", *points)
            require(self, "with balance_ratio", "friction_coefficient")

    @property
    def contact(self) -> HousingContact | None:
        """Friction in the housing, None for that of the machine."""
        if self.friction_coefficient is None:
            return None
        return HousingContact(
            friction_coefficient=self.friction_coefficient[0],
            breakaway_speed=self.breakaway_speed,
            law=self.friction_law,
        )

    def points(self, case: Case) -> tuple[PointCondition, ...]:
        """Points of the path in their order, without those of a map."""
        anew, inlet = self.begin == "start_gap", operating_point_of(case).inlet_pressure
        found = [
            PointCondition.of(case, f"{k + 1}: {p * 1e-5:.4g} bar", outlet_pressure=p)
            for k, p in enumerate(self.outlet_pressures or ())
        ]
        found += [
            PointCondition(
                label=one.name,
                outlet_pressure=one.outlet_pressure,
                inlet_pressure=one.inlet_pressure or inlet,
                shaft_speed=one.shaft_speed,
            )
            for one in self.conditions or ()
        ]
        if self.nose_pressure_fractions:
            found = [
                replace(
                    one,
                    label=f"{one.label}, {fraction:.4g}",
                    # no nose is below the inlet that it is connected to
                    nose_pressure=max(fraction * one.outlet_pressure, one.inlet_pressure),
                    anew=k == 0,
                )
                for one in found
                for k, fraction in enumerate(self.nose_pressure_fractions)
            ]
        return tuple(replace(one, anew=anew or one.anew) for one in found)

    def port_pressures(self, inlet: float) -> list[tuple[str, float, float]]:
        """Return keys of pressures with the inlet and outlet pressure that they ask for. [Pa]."""
        named = [
            (
                f"study.conditions[{k}].outlet_pressure",
                one.inlet_pressure or inlet,
                one.outlet_pressure,
            )
            for k, one in enumerate(self.conditions or ())
            for own in (one.inlet_pressure or inlet,)
        ]
        asked = enumerate(self.outlet_pressures or ())
        return [(f"study.outlet_pressures[{k}]", inlet, outlet) for k, outlet in asked] + named

    @property
    def areas(self) -> BalanceSweepStudy:
        """Loops over balanced areas in the keys of that question."""
        return BalanceSweepStudy(
            balance_ratio=self.balance_ratio or (),
            friction_coefficient=self.friction_coefficient or (),
            outlet_pressures=self.outlet_pressures or (),
            reference_area=self.reference_area,
            start_gap=self.start_gap,
            lifted_gap=self.lifted_gap,
        )


@final
@dataclass(frozen=True, kw_only=True)
class HysteresisStudy(KeyTable):
    """``kind = "hysteresis"``: pressures up and down with bearing friction."""

    outlet_pressures: tuple[float, ...] = items(PRESSURE, "Outlet pressures in their order.")
    start_gap: float = quantity("um", "Gap that the first point starts from.", above=0, high=100)
    friction_coefficient: float = number("Friction in the housing.", low=0, high=1)
    breakaway_speed: float = again(BearingPathStudy, "breakaway_speed")
    friction_law: str = again(BearingPathStudy, "friction_law", STICK)
    coupling_rounds: int = again(BearingPathStudy, "coupling_rounds", 1)
    measured: Path | None = again(BearingPathStudy, "measured", None)
    sensor_deflection: float | None = again(BearingPathStudy, "sensor_deflection", None)

    def __post_init__(self) -> None:
        if self.measured is None:
            forbid(self, "or give measured positions", "sensor_deflection")

    @property
    def path(self) -> BearingPathStudy:
        """The same question in the keys of a path."""
        return path_of(self, friction_coefficient=(self.friction_coefficient,))

    def port_pressures(self, inlet: float) -> list[tuple[str, float, float]]:
        """Return keys of pressures with the inlet and outlet pressure that they ask for. [Pa]."""
        return self.path.port_pressures(inlet)


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
    breakaway_speed: float = again(BearingPathStudy, "breakaway_speed", 1.6e-3)
    friction_law: str = again(BearingPathStudy, "friction_law", STICK)
    start_gap: float = quantity(
        "um", "Gap that every point starts from.", above=0, high=100, default=2e-6
    )

    coupling_rounds: int = again(BearingPathStudy, "coupling_rounds", 1)

    def __post_init__(self) -> None:
        _ = self.path  # which refuses a name that is given twice

    @property
    def path(self) -> BearingPathStudy:
        """The same question in the keys of a path."""
        friction = (self.friction_coefficient,)
        return path_of(self, begin="start_gap", friction_coefficient=friction)

    def port_pressures(self, inlet: float) -> list[tuple[str, float, float]]:
        """Return keys of pressures with the inlet and outlet pressure that they ask for. [Pa]."""
        return self.path.port_pressures(inlet)


@final
@dataclass(frozen=True, kw_only=True)
class BearingMapStudy(KeyTable):
    """``kind = "bearing_map"``: equilibrium of a floating bearing over speed and pressure."""

    shaft_speed: tuple[float, ...] = grid(SPEED, "Shaft speeds.")
    outlet_pressure: tuple[float, ...] = grid(PRESSURE, "Absolute outlet pressures.")
    start_gap: float = quantity(
        "um", "Gap that every point starts from.", above=0, high=100, default=2e-6
    )
    coupling_rounds: int = again(BearingPathStudy, "coupling_rounds", 6)

    @property
    def path(self) -> BearingPathStudy:
        """The same question in the keys of a path."""
        return path_of(self, outlet_pressures=self.outlet_pressure, begin="start_gap")


def path_of(study: KeyTable, **changed: Any) -> BearingPathStudy:
    """Path whose keys are those of a study with fewer of them."""
    given = {**vars(study), **changed}
    known = {key.name for key in fields(BearingPathStudy)}
    return BearingPathStudy(**{name: value for name, value in given.items() if name in known})


def run(case: Case, context: StudyContext) -> StudyResult:
    """Solve the points of a path, a map or loops over balanced areas.

    Returns
    -------
    StudyResult
        Numbers and films over ``point``, where each point begins at the one before also the area
        of the loop; numbers over ``shaft_speed`` and ``outlet_pressure``; or loops over
        ``friction_coefficient``, ``balance_ratio`` and ``point``.

    Raises
    ------
    CaseError
        If the case has no operating point, no floating bearing or one without a nose that the
        study asks for.
    """
    import xarray as xr

    study = asked_path(case)
    if study.balance_ratio is not None:
        return balance_sweep.solve(case, study.areas, context)
    if study.shaft_speed is not None:
        return _map(case, study, context)
    # a file that cannot be read should not cost the hours before it is needed
    measured = None if study.measured is None else read_positions(study.measured)
    found = solve_path(case, context)
    numbers: dict[str, Any] = {}
    if study.begin == "start_gap":
        return found.result(numbers)
    if found.status is not Status.INTERRUPTED:
        numbers["loop_area_um_bar"] = loop_area(found) * 1e6 * 1e-5
    beside = xr.Dataset()
    if measured is not None:
        beside = overlay(measured, study.sensor_deflection or 0.0)
        pressure = np.asarray(found.outlet_pressures) * 1e-5
        at = beside["measured_outlet_pressure_bar"].values
        # where the measurement has the same steps
        if at.shape == pressure.shape and not np.any(np.abs(at - pressure) > _SAME * pressure):
            position = np.asarray(found.summary()["relative_position_um"])
            deviation = position - beside["measured_relative_position_um"].values
            numbers |= {
                "deviation_um": deviation.tolist(),
                "rms_deviation_um": float(np.sqrt(np.mean(deviation**2))),
            }
    if study.contact is not None:
        highest = max(point.breakaway_force for point in found.points)
        beside = beside.merge(friction_curves(study.contact, highest))
    return found.result(numbers, beside)


def asked_path(case: Case) -> BearingPathStudy:
    """Path of the study of a case, under any of its names.

    Raises CaseError if the case has another study.
    """
    asked = getattr(case.study, "path", case.study)
    if not isinstance(asked, BearingPathStudy):
        allowed = "a path of a floating bearing"
        raise CaseError("study.kind", repr(case.study_kind), allowed)
    return asked


def solve_path(case: Case, context: StudyContext | None = None) -> LateralStudy:
    """Solve every point of ``[study]``, from the point before it or from the start gap.

    Points in their order; conditions one after another, nose pressures rising within each.

    Raises CaseError if the case has another study, no operating point, no floating bearing or no
    nose.

    Parameters
    ----------
    case : Case
        Case with a path of a floating bearing and an operating point.
    context : StudyContext, optional
        Progress, and records of points that are finished.

    References
    ----------
    .. [1] D. Thiagarajan, A. Vacca, S. Watkins, On the lubrication performance of external gear
       pumps for aerospace fuel delivery applications, Mech. Syst. Signal Process. 129 (2019)
       659-676, sections 4.2 to 4.4.
    """
    study = asked_path(case)
    friction, rounds = study.contact, study.coupling_rounds
    points = replace(prepare(case, friction), rounds=rounds)
    if study.nose_pressure_fractions and points.balance.floating.nose.area <= 0.0:
        found_one = f"{case.study_kind!r} for a floating part without nose"
        raise CaseError("study.kind", found_one, "one with a nose (area and center)")
    conditions, keys, behind = study.points(case), [], list[PointCondition]()
    for condition in conditions:
        # a point depends on all that were made since the path began anew
        behind = [*([] if condition.anew else behind), replace(condition, label="")]
        keys.append(point_key(case, study.start_gap, friction, rounds, *behind))
    found = follow(points, conditions, study.start_gap, context or StudyContext(), keys)
    return LateralStudy(conditions, found, study.start_gap)


def _map(case: Case, study: BearingPathStudy, context: StudyContext) -> StudyResult:
    """Equilibrium at every shaft speed and outlet pressure, each from the start gap."""
    operating_point_of(case)
    require_floating_part(case)
    speeds, pressures = study.shaft_speed or (), study.outlet_pressures or ()
    pairs = list(product(speeds, pressures))
    points = [
        point(case, operating_values(shaft_speed=speed, outlet_pressure=pressure))
        for speed, pressure in pairs
    ]
    evaluate = BearingNumbers(study.start_gap, study.coupling_rounds, study.contact)
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
        "shaft_speed": (speeds, "rad/s"),
        "outlet_pressure": (pressures, "Pa"),
    }
    return StudyResult(
        status=status_of(records),
        data=map_dataset(axes, records),
        numbers=point_lists(values, records),
        tables=(StudyTable.of("points", lists),),
    )


def read_positions(path: Path) -> tuple[Array, Array]:
    """Measured outlet pressures [Pa] and relative positions [m] in the order of their rows.

    Raises CaseError if the file has other columns.

    Parameters
    ----------
    path : Path
        CSV file with the columns ``operating_point.outlet_pressure`` and
        ``relative_position_um``.
    """
    found = read_measured(path)
    if found.times is not None or set(found.channels) != {_POSITION}:
        allowed = f"{_PRESSURE} and {_POSITION}"
        raise CaseError(f"{path}: columns", sorted(found.channels), allowed)
    if any(set(row) != {_PRESSURE} for row in found.settings):
        keys = sorted(found.settings[0])
        raise CaseError(f"{path}: columns", keys, f"{_PRESSURE} and {_POSITION}")
    pressure = [parse_quantity(str(row[_PRESSURE]), "bar") for row in found.settings]
    return np.array(pressure), found.channels[_POSITION] * 1e-6


def overlay(measured: tuple[Array, Array], sensor_deflection: float) -> xr.Dataset:
    """Measured positions over ``measured_point``, corrected for a sensor that moves.

    Parameters
    ----------
    measured : tuple of ndarray
        Outlet pressures [Pa] and positions [m] in their order.
    sensor_deflection : float
        Travel of the sensor away from the gears over the outlet pressure. [m/Pa]

    Notes
    -----
    Positions are relative to that of the first row, as those of the study are to its first point.
    """
    import xarray as xr

    pressure, position = measured
    moved = position - position[0] + sensor_deflection * (pressure - pressure[0])
    return xr.Dataset(
        {
            "measured_outlet_pressure_bar": ("measured_point", pressure * 1e-5, {"units": "bar"}),
            "measured_relative_position_um": ("measured_point", moved * 1e6, {"units": "um"}),
        }
    )


def loop_area(study: LateralStudy) -> float:
    """Area between the ways down and up, positive if the bearing stays farther away. [m Pa]."""
    pressure = study.outlet_pressures
    position = [p.numbers.position for p in study.points]
    ways = zip(pressure, position, pressure[1:], position[1:], strict=False)
    return -sum(0.5 * (a + b) * (q - p) for p, a, q, b in ways)


COEFFICIENT_FACTORS = (0.5, 1.0, 1.5, 2.0)
BREAKAWAY_SPEED_FACTORS = (0.25, 0.5, 1.0, 2.0)
_SPAN, _SAMPLES = 6.0, 481


def friction_curves(contact: HousingContact, breakaway_force: float) -> xr.Dataset:
    """Smooth friction law over velocity, with other coefficients and other breakaway speeds.

    Force [N] over ``friction_curve`` and ``bearing_velocity_mm_per_s``, and what the curves stand
    for; empty for a bearing without friction.

    Parameters
    ----------
    contact : HousingContact
        Coefficient and breakaway speed of the study.
    breakaway_force : float
        Breakaway force at the point with the largest one. [N]

    References
    ----------
    .. [1] D. Thiagarajan, A. Vacca, S. Watkins, On the lubrication performance of external gear
       pumps for aerospace fuel delivery applications, Mech. Syst. Signal Process. 129 (2019)
       659-676, equation 15 and figure 14.
    """
    import xarray as xr

    if breakaway_force <= 0.0:
        return xr.Dataset()
    coulomb, speed = breakaway_force / BREAKAWAY_RATIO, contact.breakaway_speed
    velocity = np.linspace(-1.0, 1.0, _SAMPLES) * _SPAN * speed
    factors = [(f, 1.0) for f in COEFFICIENT_FACTORS]
    factors += [(1.0, f) for f in BREAKAWAY_SPEED_FACTORS]
    laws = [HousingFriction(coulomb * a, speed * b, law="stribeck") for a, b in factors]
    forces = [[law.force(float(v))[0] for v in velocity] for law in laws]
    varied = ["friction_coefficient"] * len(COEFFICIENT_FACTORS)
    varied += ["breakaway_speed"] * len(BREAKAWAY_SPEED_FACTORS)
    coefficients = [contact.friction_coefficient * a for a, _ in factors]
    speeds = [law.breakaway_speed * 1e3 for law in laws]
    return xr.Dataset(
        {
            "friction_curve_force_N": (
                ("friction_curve", "bearing_velocity_mm_per_s"), forces, {"units": "N"},
            ),
            "friction_curve_varied": ("friction_curve", varied),
            "friction_curve_coefficient": ("friction_curve", coefficients, {"units": "1"}),
            "friction_curve_breakaway_speed_mm_per_s": (
                "friction_curve", speeds, {"units": "mm/s"},
            ),
        },
        coords={
            "bearing_velocity_mm_per_s": (
                "bearing_velocity_mm_per_s", velocity * 1e3, {"units": "mm/s"},
            )
        },
    )  # fmt: skip


@final
@dataclass(frozen=True)
class BearingNumbers:
    """Evaluates a case to numbers of its bearing in equilibrium, for points of a study."""

    start_gap: float
    """Gap that the bearing starts from. [m]"""
    rounds: int = 1
    """Most runs of the chambers. [-]"""
    friction: HousingContact | None = None
    """Friction in the housing, None for that of the machine."""

    @property
    def label(self) -> str:
        """Says what is evaluated, for the records of points."""
        return f"equilibrium from {self.start_gap:.12g} m, {self.rounds} rounds, {self.friction}"

    def __call__(self, case: Case) -> Mapping[str, Any]:
        """Return numbers of the films with the status, names with unit suffix."""
        condition = PointCondition.of(case, case.title)
        points = replace(prepare(case, self.friction), rounds=self.rounds)
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


POSITION_PANELS = (
    ("bearing_position_um", "Bearing position (µm)"),
    ("film_height_um", "Mean film (µm)"),
    ("leakage_L_per_min", "Lateral leakage (L/min)"),
    ("torque_loss_N_m", "Lateral torque loss (N m)"),
)
CONTACT_PANELS = (
    ("smallest_film_um", "Smallest film (µm)"),
    ("contact_force_N", "Load on asperities (N)"),
    ("wear_power_W_per_mm2", "Wear indicator (W/mm²)"),
    ("friction_force_N", "Housing friction (N)"),
)


_MARKS = ("-o", "--s", "-.^", ":v", "-D", "--x")
"""Lines that lie on one another stay distinguishable."""


_RPM = 60.0 / (2.0 * np.pi)
_MAPS = (
    ("smallest_film_um", "Smallest film (µm)", "viridis"),
    ("contact_force_N", "Load on asperities (N)", "magma_r"),
    ("wear_power_W_per_mm2", "Wear indicator p v (W/mm²)", "magma_r"),
    ("bearing_position_um", "Bearing position (µm)", "viridis"),
    ("leakage_L_per_min", "Lateral leakage (L/min)", "magma_r"),
    ("torque_loss_N_m", "Lateral torque loss (N m)", "magma_r"),
)
_LEVELS = 9
_WIDE, _VERY_WIDE = 3.0, 30.0
"""Largest over smallest value from which levels are logarithmic, and wider apart. [-]"""
_NEXT = 2.5
"""Largest ratio of neighbouring logarithmic levels. [-]"""


def figures(data: xr.Dataset) -> list[StudyFigure]:
    """Return loops, lines over the nose pressure, a map, or windows of balanced areas."""
    if "balance_ratio" in data.dims:
        return balance_sweep.figures(data)
    if "shaft_speed" in data.dims:
        found = all(name in data for name, _, _ in _MAPS)
        if not found or min(data.sizes["shaft_speed"], data.sizes["outlet_pressure"]) < 2:
            return []
        caption = (
            "Films of the bearing in equilibrium over shaft speed and outlet pressure; dots are "
            "the computed points, crosses those without equilibrium. Few asperities should touch "
            "where the pump runs."
        )
        return [StudyFigure("bearing_map", caption, film_contours(data))]
    if float(np.ptp(data["nose_pressure_bar"].values)) > 0.0:
        caption = (
            "Position of the bearing over the nose pressure, one line per condition. Crosses: "
            "friction left the bearing where it started."
        )
        return [StudyFigure("nose_pressure", caption, nose_lines(data)), *film_figures(data)]
    return _loop_figures(data)


def _loop_figures(data: xr.Dataset) -> list[StudyFigure]:
    """Return loops of position, film, leakage and torque, and maps of the films."""
    positions = (
        "Position of the bearing, mean film, leakage and torque loss beside the gears over "
        "the outlet pressure: full line up, broken line down. Crosses: friction left the bearing "
        "where it was."
    )
    contact = (
        "Smallest film, load that asperities carry, largest wear indicator and friction in the "
        "housing: full line up, broken line down."
    )
    found = [
        StudyFigure("positions", positions, loops(data)),
        StudyFigure("contact", contact, loops(data, CONTACT_PANELS)),
    ]
    if "friction_curve_force_N" in data:
        caption = (
            "Friction in the housing over the velocity of the bearing at the point with the "
            "largest one: other coefficients (left), other breakaway speeds (right). Dotted: the "
            "set-valued law, which holds the bearing at rest up to the breakaway force."
        )
        found.append(StudyFigure("friction_law", caption, friction_lines(data)))
    return [*found, *film_figures(data)]


def film_figures(data: xr.Dataset) -> list[StudyFigure]:
    """Return maps of height and of the wear indicator at the points of a study."""
    found = [
        StudyFigure(
            "film_height",
            "Height of the films beside both gears at every point, seen from the floating side; "
            "white: tooth spaces and grooves.",
            point_maps(data, HEIGHT),
        )
    ]
    if float(data["film_wear_power"].max()) > 0.0:
        caption = (
            "Wear indicator (asperity pressure times sliding speed), mean over a tooth pitch: "
            "where the bearing will wear first. White: no asperity touches."
        )
        found.append(StudyFigure("wear", caption, point_maps(data, WEAR)))
    return found


@styled
def loops(data: xr.Dataset, panels: tuple[tuple[str, str], ...] = POSITION_PANELS) -> Figure:
    """Four numbers over the outlet pressure, the way down apart from the way up."""
    figure = new_figure(7.2, 5.4)
    pressure = data["outlet_pressure_bar"].values
    top = int(np.argmax(pressure))
    for axes, (name, label) in zip(np.ravel(figure.subplots(2, 2)), panels, strict=True):
        up, down = data[name].values[: top + 1], data[name].values[top:]
        axes.plot(pressure[: top + 1], up, "-o", color=BLUE, ms=4, label="up")
        axes.plot(pressure[top:], down, "--o", color=ORANGE, ms=4, mfc="white", label="down")
        axes.set(ylabel=label, xlabel="Outlet pressure (bar)")
    if panels is POSITION_PANELS:
        _mark_held(figure.axes[0], data, pressure)
    if panels is POSITION_PANELS and "measured_relative_position_um" in data:
        # measured positions are relative: they begin where the computed ones do
        first = float(data["bearing_position_um"][0])
        pressure = data["measured_outlet_pressure_bar"].values
        position = first + data["measured_relative_position_um"].values
        figure.axes[0].plot(pressure, position, ":x", color=INK, ms=5, lw=0.8, label="measured")
    figure.axes[0].legend()
    return figure


def _mark_held(axes: Axes, data: xr.Dataset, places: Array) -> None:
    """Cross the points at which friction leaves the bearing where it starts."""
    held = np.asarray(data["held_by_friction"].values, dtype=bool)
    if held.any():
        position = data["bearing_position_um"].values[held]
        axes.plot(places[held], position, "x", color=INK, ms=7, label="held by friction")


@styled
def friction_lines(data: xr.Dataset) -> Figure:
    """Friction over velocity: smooth law with other parameters, and the set-valued one."""
    figure = new_figure(7.2, 3.2)
    velocity = data["bearing_velocity_mm_per_s"].values
    varied = data["friction_curve_varied"].values
    shown = (
        ("friction_coefficient", "friction_curve_coefficient", "µ = {:.3g}"),
        ("breakaway_speed", "friction_curve_breakaway_speed_mm_per_s", "peak at {:.3g} mm/s"),
    )
    for axes, (name, values, words) in zip(figure.subplots(1, 2, sharey=True), shown, strict=True):
        for color, k in zip(CYCLE, np.flatnonzero(varied == name), strict=False):
            label = words.format(float(data[values][k]))
            force = data["friction_curve_force_N"].values[k]
            axes.plot(velocity, force, color=color, label=label)
        axes.set_xlabel("Velocity of the bearing (mm/s)")
        axes.legend()
    figure.axes[0].set_ylabel("Friction in the housing (N)")
    held = float(data["breakaway_force_N"].max())
    coulomb = held / BREAKAWAY_RATIO
    places = [velocity[0], 0.0, 0.0, 0.0, 0.0, velocity[-1]]
    forces = [-coulomb, -coulomb, -held, held, coulomb, coulomb]
    figure.axes[0].plot(places, forces, ":", color=INK, lw=0.9)
    return figure


@styled
def nose_lines(data: xr.Dataset) -> Figure:
    """Position over the nose pressure over the outlet pressure, one line per condition."""
    figure = new_figure(7.2, 3.2)
    axes = figure.subplots()
    names = [str(label).rpartition(",")[0] for label in data["point_label"].values]
    ratio = data["nose_pressure_bar"].values / data["outlet_pressure_bar"].values
    looks = zip(CYCLE, _MARKS, strict=False)
    for (color, mark), name in zip(looks, dict.fromkeys(names), strict=False):
        own = [k for k, other in enumerate(names) if other == name]
        position = data["bearing_position_um"].values[own]
        axes.plot(ratio[own], position, mark, color=color, ms=5, mfc="none", label=name)
    _mark_held(axes, data, ratio)
    axes.set(xlabel="Nose pressure over outlet pressure", ylabel="Bearing position (µm)")
    axes.legend()
    axes.grid(color=GREY, alpha=0.25)
    axes.tick_params(colors=INK)
    return figure


@styled
def film_contours(data: xr.Dataset) -> Figure:
    """Smallest film, asperity load, wear, position, leakage and torque over speed and pressure."""
    figure = new_figure(7.2, 7.6)
    speed, pressure = data["shaft_speed"].values * _RPM, data["outlet_pressure"].values * 1e-5
    panels = figure.subplots(3, 2, sharex=True, sharey=True)
    done = data["point_status"].values.T == "done"
    x, y = np.meshgrid(speed, pressure)
    for axes, (name, label, colours) in zip(panels.flat, _MAPS, strict=True):
        values = np.ma.masked_invalid(data[name].values.T)
        if values.count() > 3 and float(np.ptp(values.compressed())) > 0.0:
            _filled(axes, (speed, pressure, values), colours)
        axes.plot(x[done], y[done], ".", color=GREY, ms=3)
        axes.plot(x[~done], y[~done], "x", color=INK, ms=5)
        axes.set_title(label)
    for axes in panels[-1]:
        axes.set_xlabel("Shaft speed (rpm)")
    for axes in panels[:, 0]:
        axes.set_ylabel("Outlet pressure (bar)")
    return figure


def _filled(axes: Axes, grid: tuple[Array, Array, Any], colours: str) -> None:
    from matplotlib.colors import LogNorm, Normalize
    from matplotlib.ticker import MaxNLocator

    values = grid[2]
    low, high = float(values.min()), float(values.max())
    scale: Normalize
    if low > 0.0 and high > _WIDE * low:
        # 1, 2 and 5 times powers of ten, closer levels in a narrow range
        steps = (1.0, 2.0, 5.0) if high > _VERY_WIDE * low else (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)
        decades = 10.0 ** np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1.0)
        every = np.outer(decades, steps).ravel()
        levels, scale = every[(every >= low / _NEXT) & (every <= high * _NEXT)], LogNorm(low, high)
    else:
        levels = np.asarray(MaxNLocator(_LEVELS, min_n_ticks=4).tick_values(low, high))
        scale = Normalize(levels[0], levels[-1])
    contour_lines(axes, grid, levels, cmap=colours, norm=scale)


STUDY = Study(BearingPathStudy, run, figures)
