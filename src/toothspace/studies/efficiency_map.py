"""Steady efficiencies over shaft speed and pressure difference."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, final

import numpy as np

from toothspace.case import Case
from toothspace.circuit.electric_drive import ElectricMotor
from toothspace.core.errors import CaseError
from toothspace.core.keys import KeyTable, file_path, grid, table
from toothspace.core.units import from_si, parse_quantity
from toothspace.plotting.style import (
    GREY,
    PRESSURE_COLOURS,
    StudyFigure,
    axis_title,
    contour_lines,
    has_numbers,
    new_figure,
    spread,
    styled,
)
from toothspace.results.variables import unit_of
from toothspace.run.heating import liquid_of
from toothspace.studies.loss_models import fit_losses, loss_data, loss_numbers, loss_table
from toothspace.studies.measured import at_ports, read_measured
from toothspace.studies.points import (
    Evaluate,
    collected,
    map_dataset,
    numbers_table,
    operating_point_of,
    operating_values,
    point,
    point_lists,
    status_of,
    summary_numbers,
)
from toothspace.studies.study import Record, Study, StudyContext, StudyResult
from toothspace.studies.variation import PRESSURE, SPEED

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_LEAST_SETTINGS = 2
TABLE_COLUMNS = (
    ("mean_flow_L_per_min", "flow q_v (L/min)"),
    ("mean_torque_N_m", "torque T (N m)"),
    ("hydraulic_power_W", "hydraulic power P_h (W)"),
    ("shaft_power_W", "shaft power P_m (W)"),
    ("volumetric_efficiency", "volumetric efficiency eta_v"),
    ("hydromechanical_efficiency", "hydromechanical efficiency eta_hm"),
    ("overall_efficiency", "overall efficiency eta_t"),
)
"""Columns of the table, with the quantities of ISO 4409:2019, tables of test results."""


@final
@dataclass(frozen=True, kw_only=True)
class EfficiencyMapStudy(KeyTable):
    """``kind = "efficiency_map"``: steady points over speed and pressure difference."""

    shaft_speed: tuple[float, ...] = grid(SPEED, "Shaft speeds.")
    pressure_difference: tuple[float, ...] = grid(PRESSURE, "High minus low pressure.")
    drive: ElectricMotor | None = table(
        ElectricMotor,
        "Electric motor with inverter on the shaft of a pump: power that it draws, and efficiency "
        "with it.",
        default=None,
    )
    measured: Path | None = file_path(
        "Rows of operating_point.shaft_speed, one port pressure of operating_point and "
        "mean_torque_N_m or mean_flow_L_per_min, or a test sheet with the symbols of ISO 4409, to "
        "lay over the results.",
        ".csv",
        ".xlsx",
        default=None,
    )


def run(case: Case, context: StudyContext) -> StudyResult:
    """Run the case over ``study.shaft_speed`` and ``study.pressure_difference``.

    The low-pressure side stays as in ``[operating_point]``: the inlet of a pump, the outlet of
    a motor.

    Returns
    -------
    StudyResult
        Summary numbers over ``shaft_speed`` and ``pressure_difference``; measured ones beside
        them over ``measured_point``; coefficients of loss models for the liquid at the temperature
        of the case and no pressure, see :func:`toothspace.studies.loss_models.fit_losses`.

    Raises
    ------
    CaseError
        If the case has no operating point, or no point can be run.

    References
    ----------
    .. [1] ISO 4409:2019, Hydraulic fluid power - Positive-displacement pumps, motors and
       integral transmissions - Methods of testing and presenting basic steady state performance.
    """
    study = case.study
    assert isinstance(study, EfficiencyMapStudy)
    if study.drive is not None and getattr(case.machine, "mode", "pump") == "motor":
        raise CaseError("study.drive", "an electric motor on a hydraulic motor", "a pump")
    pairs = list(product(study.shaft_speed, study.pressure_difference))
    records = map_records(case, pairs, context)
    speeds = [from_si(speed, "rpm") for speed, _ in pairs]
    differences = [difference * 1e-5 for _, difference in pairs]
    heads = {"speed n (rpm)": speeds, "pressure difference dp (bar)": differences}
    axes = {
        "shaft_speed": (study.shaft_speed, "rad/s"),
        "pressure_difference": (study.pressure_difference, "Pa"),
    }
    data, liquid = map_dataset(axes, records), liquid_of(case)
    mode = getattr(case.machine, "mode", "pump")
    fits = fit_losses(
        data,
        motor=mode == "motor",
        dynamic_viscosity=liquid.dynamic_viscosity,
        density=liquid.density,
    )
    data = _driven(data, study.drive).merge(_measured(case, study)).assign_attrs(mode=mode)
    return StudyResult(
        status=status_of(records),
        data=data.assign(loss_data(fits)) if fits else data,
        numbers={
            **point_lists(
                {"shaft_speed_rpm": speeds, "pressure_difference_bar": differences}, records
            ),
            **loss_numbers(fits),
        },
        tables=(
            numbers_table("iso_4409", heads, TABLE_COLUMNS, records),
            *([loss_table(fits)] if fits else []),
        ),
    )


def _driven(data: xr.Dataset, motor: ElectricMotor | None) -> xr.Dataset:
    """Map with the power that an electric motor draws, where it can give the torque."""
    if motor is None or "mean_torque_N_m" not in data:
        return data
    torque, speed = data["mean_torque_N_m"], data["shaft_speed"]
    given = torque <= motor.torque_limit(speed)
    electric = motor.powers(*np.broadcast_arrays(torque, speed.values[:, None])).electric
    drawn = torque.copy(data=electric).where(given)
    return data.assign(
        electric_power_W=drawn.assign_attrs(units="W"),
        drive_efficiency=(torque * speed / drawn).assign_attrs(units="1"),
        efficiency_with_drive=(data["hydraulic_power_W"] / drawn).assign_attrs(units="1"),
    )


def map_records(
    case: Case,
    pairs: Sequence[tuple[float, float]],
    context: StudyContext,
    evaluate: Evaluate = summary_numbers,
) -> list[Record]:
    """Evaluate a case at pairs of shaft speed [rad/s] and pressure difference [Pa], in their order.

    The low-pressure side stays as in the case. After an interrupt the rest is ``interrupted``.

    Raises CaseError if every point is refused.
    """
    operating, motor = operating_point_of(case), getattr(case.machine, "mode", "pump") == "motor"
    low = operating.outlet_pressure if motor else operating.inlet_pressure
    high = "inlet_pressure" if motor else "outlet_pressure"
    points = [
        point(case, operating_values(**{"shaft_speed": speed, high: low + difference}))
        for speed, difference in pairs
    ]
    # light loads take the most revolutions: the longest points first, so that no worker waits
    order = sorted(range(len(pairs)), key=lambda k: pairs[k][1] / pairs[k][0])
    found = collected([points[k] for k in order], context, evaluate)
    record_of = dict(zip(order, found, strict=True))
    return [record_of[k] for k in range(len(pairs))]


def _measured(case: Case, study: EfficiencyMapStudy) -> xr.Dataset:
    """Measured points over speed and pressure difference; the other port as in the case."""
    import xarray as xr

    if study.measured is None:
        return xr.Dataset()
    found = read_measured(study.measured)
    rows = []
    for row in found.settings:
        operating, own_speed = operating_point_of(case), None
        known = {name: getattr(operating, name) for name in ("inlet_pressure", "outlet_pressure")}
        for key, value in at_ports(case, row).items():
            name = key.removeprefix("operating_point.")
            if name == "shaft_speed":
                own_speed = parse_quantity(str(value), "rpm")
            elif name in known:
                known[name] = parse_quantity(str(value), "bar")
        if own_speed is None or len(row) < _LEAST_SETTINGS:
            needed = "operating_point.shaft_speed and a port pressure of operating_point"
            raise CaseError(f"{study.measured}: columns", sorted(row), needed)
        rows.append((own_speed, abs(known["outlet_pressure"] - known["inlet_pressure"])))
    if found.times is not None or not rows:
        allowed = "allowed rows of operating_point.shaft_speed and a port pressure"
        raise CaseError(f"{study.measured}: columns: found signals over time, {allowed}")
    speed, difference = np.array(rows).T
    return xr.Dataset(
        {
            "measured_shaft_speed": ("measured_point", speed, {"units": "rad/s"}),
            "measured_pressure_difference": ("measured_point", difference, {"units": "Pa"}),
        }
        | {
            f"measured_{name}": ("measured_point", values, {"units": unit_of(name)})
            for name, values in found.channels.items()
        }
    )


_RPM = 60.0 / (2.0 * np.pi)
_EFFICIENCIES = (
    ("overall_efficiency", "Overall efficiency (%)"),
    ("hydromechanical_efficiency", "Hydromechanical efficiency (%)"),
    ("volumetric_efficiency", "Volumetric efficiency (%)"),
)


_WITH_DRIVE = (
    ("efficiency_with_drive", "Hydraulic over electric power (%)"),
    ("drive_efficiency", "Motor and inverter (%)"),
)


_CHARACTERISTICS = ("mean_flow_L_per_min", "mean_torque_N_m")


_SHOWN_RANGE = 40.0
"""Percent below the best efficiency that contour lines cover."""


def figures(data: xr.Dataset) -> list[StudyFigure]:
    """Efficiencies as contours; flow and torque over the pressure difference."""
    found = []
    if not has_numbers(data, *(name for name, _ in _EFFICIENCIES), *_CHARACTERISTICS):
        return []
    if min(data.sizes["shaft_speed"], data.sizes["pressure_difference"]) > 1:
        caption = (
            "Lines of equal efficiency over shaft speed and pressure difference; "
            "dots are the computed points. White: a motor that must be driven, or no result."
        )
        found.append(StudyFigure("efficiency_map", caption, efficiency_contours(data)))
    if "efficiency_with_drive" in data and has_numbers(data, "efficiency_with_drive"):
        caption = (
            "Electric motor with inverter, and pump with both. White: beyond the torque that the "
            "voltage leaves, or no result."
        )
        drawn = efficiency_contours(data, _WITH_DRIVE)
        found.append(StudyFigure("efficiency_with_drive", caption, drawn))
    caption = "Flow and torque over the pressure difference, one line per shaft speed."
    if "measured_shaft_speed" in data:
        caption += " Crosses: measured."
    found.append(StudyFigure("characteristics", caption, characteristics(data)))
    return found


@styled
def efficiency_contours(
    data: xr.Dataset, shown: Sequence[tuple[str, str]] = _EFFICIENCIES
) -> Figure:
    """Contours of efficiencies over shaft speed and pressure difference."""
    from matplotlib.ticker import MaxNLocator

    figure = new_figure(7.2, 0.5 + 2.7 * len(shown))
    speed = data["shaft_speed"].values * _RPM
    pressure = data["pressure_difference"].values * 1e-5
    panels = figure.subplots(len(shown), 1, sharex=True)
    for axes, (name, title) in zip(panels, shown, strict=True):
        # below zero a motor is driven: it has no efficiency there
        values = np.ma.masked_invalid(np.where(data[name] > 0.0, 100.0 * data[name], np.nan).T)
        if values.count() > 3:
            high = float(values.max())
            low = max(float(values.min()), high - _SHOWN_RANGE)
            levels = MaxNLocator(10, steps=[1, 2, 5, 10], min_n_ticks=4).tick_values(low, high)
            contour_lines(axes, (speed, pressure, values), levels, cmap=PRESSURE_COLOURS)
        axes.plot(*map(np.ravel, np.meshgrid(speed, pressure)), ".", color=GREY, ms=3)
        axes.set(title=title, ylabel="Pressure difference (bar)")
    panels[-1].set_xlabel("Shaft speed (rpm)")
    return figure


@styled
def characteristics(data: xr.Dataset) -> Figure:
    """Flow and torque over the pressure difference, one line per shaft speed."""
    figure = new_figure(7.2, 3.6)
    pressure = data["pressure_difference"].values * 1e-5
    panels = figure.subplots(1, 2)
    for axes, name in zip(panels, _CHARACTERISTICS, strict=True):
        for k in spread(data.sizes["shaft_speed"]):
            speed = float(data["shaft_speed"][k]) * _RPM
            axes.plot(pressure, data[name].values[k], "o-", ms=3, label=f"{speed:.4g} rpm")
        if f"measured_{name}" in data:
            shown = list(spread(data.sizes["shaft_speed"]))
            speeds = data["shaft_speed"].values[shown]
            lines = [line.get_color() for line in axes.lines]
            places = data["measured_pressure_difference"].values * 1e-5
            values = data[f"measured_{name}"].values
            for own_speed, x, y in zip(
                data["measured_shaft_speed"].values, places, values, strict=True
            ):
                colour = lines[int(np.argmin(np.abs(speeds - own_speed)))]
                axes.plot(x, y, "x", color=colour, ms=6)
        axes.set(xlabel="Pressure difference (bar)", ylabel=axis_title(name))
    panels[1].legend()
    return figure


STUDY = Study(EfficiencyMapStudy, run, figures)
