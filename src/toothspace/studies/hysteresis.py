"""Position of a floating bearing as the outlet pressure goes up and down."""

from __future__ import annotations

from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.core.keys import (
    KeyTable,
    choice,
    file_path,
    forbid,
    integer,
    items,
    number,
    quantity,
)
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.core.units import parse_quantity
from toothspace.floating.housing_friction import BREAKAWAY_RATIO, HousingFriction
from toothspace.model.floating_bearing import HousingContact
from toothspace.plotting.lateral_figures import hysteresis_figures
from toothspace.studies.keys import PRESSURE
from toothspace.studies.lateral_points import (
    LateralStudy,
    PointCondition,
    follow,
    housing_contact,
    prepare,
)
from toothspace.studies.measured import read_measured
from toothspace.studies.stored_point import point_key
from toothspace.studies.study import Study, StudyContext, StudyResult

if TYPE_CHECKING:
    import xarray as xr

_PRESSURE, _POSITION = "operating_point.outlet_pressure", "relative_position_um"
_SAME = 0.02
"""Difference of pressures that count as the same step. [-]"""


@final
@dataclass(frozen=True, kw_only=True)
class HysteresisStudy(KeyTable):
    """``kind = "hysteresis"``: pressures up and down with bearing friction."""

    outlet_pressures: tuple[float, ...] = items(PRESSURE, "Outlet pressures in their order.")
    start_gap: float = quantity("um", "Gap that the first point starts from.", above=0, high=100)
    friction_coefficient: float = number("Friction in the housing.", low=0, high=1)
    breakaway_speed: float = quantity("mm/s", "Speed of the friction peak.", above=0, high=1e4)
    friction_law: str = choice("Set-valued, or smooth.", "stick", "stribeck", default="stick")
    coupling_rounds: int = integer(
        "Most runs of the chambers per point until they agree with the films; 1: as described.",
        low=1,
        high=20,
        default=1,
    )
    measured: Path | None = file_path(
        "Rows of operating_point.outlet_pressure and relative_position_um in the order of the "
        "measurement, to lay over the loop.",
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

    def __post_init__(self) -> None:
        if self.measured is None:
            forbid(self, "or give measured positions", "sensor_deflection")

    def port_pressures(self, inlet: float) -> list[tuple[str, float, float]]:
        """Return keys of pressures with the inlet and outlet pressure that they ask for. [Pa]."""
        asked = self.outlet_pressures
        return [(f"study.outlet_pressures[{k}]", inlet, outlet) for k, outlet in enumerate(asked)]


def run(case: Case, context: StudyContext) -> StudyResult:
    """Position, leakage and torque loss as the outlet pressure goes up and down.

    Returns
    -------
    StudyResult
        Numbers and films over ``point``, and the area of the loop.

    Raises
    ------
    CaseError
        If the case has no operating point or no floating bearing.
    """
    spec = case.study
    assert isinstance(spec, HysteresisStudy)
    # a file that cannot be read should not cost the hours before it is needed
    measured = None if spec.measured is None else read_positions(spec.measured)
    study = follow_pressures(case, context)
    numbers: dict[str, Any] = {}
    if study.status is not Status.INTERRUPTED:
        numbers["loop_area_um_bar"] = loop_area(study) * 1e6 * 1e-5
    highest = max(point.breakaway_force for point in study.points)
    curves = friction_curves(housing_contact(spec), highest)
    if measured is None:
        return study.result(numbers, curves)
    beside = lay_over(measured, spec.sensor_deflection or 0.0)
    numbers |= _deviations(study, beside)
    return study.result(numbers, beside.merge(curves))


def follow_pressures(case: Case, context: StudyContext | None = None) -> LateralStudy:
    """Follow the bearing through the outlet pressures of ``[study]``.

    Parameters
    ----------
    case : Case
        Case with ``kind = "hysteresis"`` and an operating point.
    context : StudyContext, optional
        Progress, and records of points that are finished.

    Returns
    -------
    LateralStudy
        One point per outlet pressure; every point starts from the state before it.

    Raises
    ------
    CaseError
        If the case has another study, no operating point or no floating bearing.

    References
    ----------
    .. [1] D. Thiagarajan, A. Vacca, S. Watkins, On the lubrication performance of external gear
       pumps for aerospace fuel delivery applications, Mech. Syst. Signal Process. 129 (2019)
       659-676, section 4.2 and 4.3.
    """
    study = case.study
    if not isinstance(study, HysteresisStudy):
        raise CaseError("study.kind", "another study", '"hysteresis"')
    friction = housing_contact(study)
    points = replace(prepare(case, friction, "hysteresis"), rounds=study.coupling_rounds)
    conditions = tuple(
        PointCondition.of(case, f"{k + 1}: {pressure * 1e-5:.4g} bar", outlet_pressure=pressure)
        for k, pressure in enumerate(study.outlet_pressures)
    )
    asked = (study.start_gap, friction, study.coupling_rounds)
    keys = [
        point_key(case, "hysteresis", *asked, study.outlet_pressures[: k + 1])
        for k in range(len(conditions))
    ]
    found = follow(points, conditions, study.start_gap, context or StudyContext(), keys)
    return LateralStudy(conditions, found, study.start_gap)


def read_positions(path: Path) -> tuple[Array, Array]:
    """Measured outlet pressures [Pa] and relative positions [m] in the order of their rows.

    Parameters
    ----------
    path : Path
        CSV file with the columns ``operating_point.outlet_pressure`` and
        ``relative_position_um``.

    Raises
    ------
    CaseError
        If the file has other columns.
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


def lay_over(measured: tuple[Array, Array], sensor_deflection: float) -> xr.Dataset:
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


def _deviations(study: LateralStudy, beside: xr.Dataset) -> dict[str, Any]:
    """Computed less measured positions, where the measurement has the same steps."""
    pressure = np.asarray(study.outlet_pressures) * 1e-5
    measured = beside["measured_outlet_pressure_bar"].values
    if measured.shape != pressure.shape or np.any(np.abs(measured - pressure) > _SAME * pressure):
        return {}
    position = np.asarray(study.summary()["relative_position_um"])
    deviation = position - beside["measured_relative_position_um"].values
    return {
        "deviation_um": deviation.tolist(),
        "rms_deviation_um": float(np.sqrt(np.mean(deviation**2))),
    }


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

    Parameters
    ----------
    contact : HousingContact
        Coefficient and breakaway speed of the study.
    breakaway_force : float
        Breakaway force at the point with the largest one. [N]

    Returns
    -------
    xarray.Dataset
        Force [N] over ``friction_curve`` and ``bearing_velocity_mm_per_s``, and what the curves
        stand for; empty for a bearing without friction.

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
    laws = [HousingFriction(coulomb * a, speed * b, holds=False) for a, b in factors]
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


STUDY = Study(HysteresisStudy, run, hysteresis_figures)
