"""Teeth that carry the contact forces of a gerotor, and what makes up its torque."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.case import Case
from toothspace.core.errors import CaseError
from toothspace.core.keys import (
    KeyTable,
    QuantityKey,
    file_path,
    grid,
    number,
)
from toothspace.core.types import Array
from toothspace.plotting.style import (
    BLUE,
    GREEN,
    GREY,
    ORANGE,
    StudyFigure,
    angle_axis,
    new_figure,
    styled,
)
from toothspace.results.ripple import high_pass
from toothspace.results.solution import Solution
from toothspace.studies.measured import read_measured
from toothspace.studies.points import (
    collected,
    numbers_table,
    operating_values,
    point,
    point_lists,
    record_arrays,
    status_of,
)
from toothspace.studies.study import Study, StudyContext, StudyResult
from toothspace.studies.variation import PRESSURE

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_CLEARANCE = "machine.rotors.tip_clearance"
_THEORY = "machine.contact.theory"
_MECHANISM = "contact_friction"

_NUMBERS = (
    ("span_pitches", "span (pitches)"),
    ("least_teeth_loaded", "least teeth loaded"),
    ("most_teeth_loaded", "most teeth loaded"),
    ("mean_contact_force_N", "mean contact force (N)"),
    ("largest_contact_force_N", "largest contact force (N)"),
    ("mean_torque_N_m", "mean torque (N m)"),
    ("contact_friction_torque_N_m", "contact friction (N m)"),
    ("gap_friction_torque_N_m", "gap friction (N m)"),
)


@final
@dataclass(frozen=True, kw_only=True)
class ContactSpanStudy(KeyTable):
    """``kind = "contact_span"``: teeth that carry load over the angle."""

    force_fraction: float = number(
        "Share of the mean total contact force that counts as contact.",
        above=0,
        high=1,
        default=0.01,
    )
    tip_clearance: tuple[float, ...] | None = grid(
        QuantityKey(unit="um", above=0, high=500), "Tip clearances.", default=None
    )
    pressure_difference: tuple[float, ...] | None = grid(
        PRESSURE, "Outlet minus inlet pressure.", default=None
    )
    measured: Path | None = file_path(
        "Columns time [s], shaft_torque and outlet_pressure to lay over the results.",
        ".csv",
        default=None,
    )


def run(case: Case, context: StudyContext) -> StudyResult:
    """Run the case as it stands and over ``study.tip_clearance`` and ``pressure_difference``.

    Returns
    -------
    StudyResult
        Over ``point`` the span of contact (one pitch in single-contact theory), teeth loaded,
        forces and torques; over ``shaft_angle`` torques and tooth forces of the case itself.

    Raises
    ------
    CaseError
        If the case is no steady gerotor, or no point can be run.
    """
    import xarray as xr

    study = case.study
    assert isinstance(study, ContactSpanStudy)
    if case.operating_point is None or not hasattr(case.machine, "rotors"):
        allowed = "allowed a steady case of a gerotor"
        raise CaseError(f"{case.source}: study.kind: found no rotors to turn, {allowed}")
    waveforms = _waveforms(case)
    if study.measured is not None:
        waveforms = waveforms.merge(_measured(study.measured, case.operating_point.shaft_speed))
    rotors, ports = case.machine.rotors, case.operating_point
    clearances = study.tip_clearance or (rotors.tip_clearance,)
    own = ports.outlet_pressure - ports.inlet_pressure
    pairs = list(product(clearances, study.pressure_difference or (own,)))
    points = [
        point(
            case,
            {_CLEARANCE: f"{clearance * 1e6:.12g} um"}
            | operating_values(outlet_pressure=ports.inlet_pressure + difference),
        )
        for clearance, difference in pairs
    ]
    records = collected(points, context, ContactNumbers(study.force_fraction))
    heads = {
        "tip clearance (um)": [1e6 * clearance for clearance, _ in pairs],
        "pressure difference (bar)": [1e-5 * difference for _, difference in pairs],
    }
    clearance, difference = np.array(pairs).T
    varied: dict[str, Any] = {
        "tip_clearance": ("point", clearance, {"units": "m"}),
        "pressure_difference": ("point", difference, {"units": "Pa"}),
    }
    means = {
        f"mean_{name}_N_m": float(waveforms["mean_torque"].sel(stage=name))
        for name in waveforms["stage"].values
    }
    values = {
        "tip_clearance_um": [1e6 * clearance for clearance, _ in pairs],
        "pressure_difference_bar": [1e-5 * difference for _, difference in pairs],
    }
    return StudyResult(
        status=status_of(records),
        data=waveforms.merge(xr.Dataset(varied | record_arrays(records))),
        numbers={**means, **point_lists(values, records)},
        tables=(numbers_table("contact_span", heads, _NUMBERS, records),),
    )


@final
@dataclass(frozen=True)
class ContactNumbers:
    """Runs a case and returns the numbers of its contacts."""

    share: float
    """Share of the mean total contact force that counts as contact. [-]"""

    @property
    def label(self) -> str:
        """What is evaluated."""
        return f"contacts above {self.share!r}"

    def __call__(self, case: Case) -> Mapping[str, Any]:
        """Span, teeth loaded, forces and torques beside the summary numbers."""
        from toothspace import api

        solution = api.simulate(case)
        found = solution.tooth_contacts()
        loaded = found.loaded_above(self.share)
        mechanisms = [str(name) for name in solution.data["mechanism"].values]
        means = np.asarray(solution.data["torque_loss"]).mean(axis=0)
        losses = dict(zip(mechanisms, means, strict=True))
        contact = losses.pop(_MECHANISM)
        return {
            "span_pitches": found.span_above(self.share),
            "least_teeth_loaded": int(loaded.min()),
            "most_teeth_loaded": int(loaded.max()),
            "mean_contact_force_N": found.mean_total,
            "largest_contact_force_N": float(found.force.max()),
            "contact_friction_torque_N_m": float(contact),
            "gap_friction_torque_N_m": float(sum(losses.values())),
            **solution.summary(),
        }


def _waveforms(case: Case) -> xr.Dataset:
    """Torques from ideal to complete and with a single contact, and the forces of the teeth."""
    import xarray as xr

    from toothspace import api

    complete = api.simulate(case.at_point({}))
    ideal = api.simulate(case.at_point({"run.fidelity": "ideal"}))
    single = api.simulate(case.at_point({_THEORY: "single"}))
    angle = _last_turn(complete)
    found = complete.tooth_contacts()
    friction = np.asarray(complete.data["torque_loss"].sel(mechanism=_MECHANISM))
    torque = np.asarray(complete.data["shaft_torque"])
    torques = {
        "ideal_torque": _torque(ideal, angle),
        "torque_with_gaps": torque - friction,
        "shaft_torque": torque,
        "single_contact_torque": _torque(single, angle),
    }
    pascal = {"units": "Pa"}
    means = [_mean_torque(ideal), _mean_torque(complete) - float(friction.mean())]
    means += [_mean_torque(complete), _mean_torque(single)]
    forces = (("shaft_angle", "tooth"), found.force, {"units": "N"})
    places = (("shaft_angle", "tooth"), found.place, {"units": "rad"})
    return xr.Dataset(
        {name: ("shaft_angle", values, {"units": "N m"}) for name, values in torques.items()}
        | {"outlet_pressure": ("shaft_angle", np.asarray(complete.data["outlet_pressure"]), pascal)}
        | {"tooth_force": forces, "tooth_place": places}
        | {"mean_torque": ("stage", means, {"units": "N m"})},
        coords={"shaft_angle": ("shaft_angle", angle, {"units": "rad"}), "stage": list(torques)},
    )


def _measured(path: Path, shaft_speed: float) -> xr.Dataset:
    """Measured columns over the shaft angle; without that column, at constant speed."""
    import xarray as xr

    found = read_measured(path)
    if found.times is None:
        raise CaseError(f"{path}: columns", "no time", "signals over 'time [s]'")
    channels = dict(found.channels)
    angle = channels.pop("shaft_angle", shaft_speed * found.times)
    if angle[-1] - angle[0] < 2.0 * np.pi:
        raise CaseError(f"{path}: time", "less than a turn", "whole revolutions")
    return xr.Dataset(
        {f"measured_{name}": ("measured_sample", values) for name, values in channels.items()}
        | {"measured_angle": ("measured_sample", angle, {"units": "rad"})}
    )


def _last_turn(solution: Solution) -> Array:
    angle = np.asarray(solution.data["shaft_angle"], dtype=float)
    return angle - angle[0]


def _mean_torque(solution: Solution) -> float:
    """Mean of the ledger: it has the short impacts between the samples. [N m]."""
    return float(solution.summary()["mean_torque_N_m"])


def _torque(solution: Solution, angle: Array) -> Array:
    """Shaft torque of another run of the same machine at the same angles within a turn."""
    own = _last_turn(solution)
    return np.asarray(
        np.interp(angle, own, np.asarray(solution.data["shaft_torque"]), period=2.0 * np.pi)
    )


TORQUE_STAGES = (
    ("ideal_torque", "Ideal", GREY),
    ("torque_with_gaps", "With gaps", BLUE),
    ("shaft_torque", "With gaps and contact friction", GREEN),
    ("single_contact_torque", "The same, single contact", ORANGE),
)
"""Torques from ideal to complete with their colours."""


def figures(data: xr.Dataset) -> list[StudyFigure]:
    """Figures of the study ``contact_span``."""
    torques = {name: data[name].values for name, _, _ in TORQUE_STAGES}
    caption = "Shaft torque: without losses, with gaps, with contact friction, single contact."
    means = [float(data["mean_torque"].sel(stage=name)) for name in torques]
    stages = torque_stages(data["shaft_angle"].values, torques, means)
    found = [StudyFigure("torque_stages", caption, stages)]
    caption = "Ripple over one turn: torque, torque without low orders, pressure at the outlet."
    if "measured_angle" in data:
        caption += " Dots: measured."
    found.append(StudyFigure("ripple_over_turn", caption, ripple_over_turn(data)))
    if "span_pitches" in data:
        caption = (
            "Part of a turn over which a tooth carries, in pitches, and shaft torque: one line "
            "per tip clearance. Dashed: one pitch, as single-contact theory has it."
        )
        found.append(StudyFigure("contact_span", caption, span_lines(data)))
    return found


@styled
def torque_stages(shaft_angle: Array, torques: dict[str, Array], means: list[float]) -> Figure:
    """Shaft torque from ideal to complete over one turn.

    Parameters
    ----------
    shaft_angle : ndarray
        Shaft angle over one turn. [rad]
    torques : dict of str to ndarray
        Torques by the names of :data:`TORQUE_STAGES`. [N m]
    means : list of float
        Their means, impacts between the samples included. [N m]
    """
    figure = new_figure(7.2, 3.8)
    waveform, bars = figure.subplots(1, 2, width_ratios=(3, 1))
    degrees = np.degrees(shaft_angle - shaft_angle[0])
    shown = [stage for stage in TORQUE_STAGES if stage[0] in torques]
    for name, label, color in shown:
        waveform.plot(degrees, torques[name], color=color, linewidth=1.2, label=label)
    waveform.set_ylabel("Shaft torque (N m)")
    waveform.legend(loc="lower left", bbox_to_anchor=(0.0, 1.0), ncols=2, fontsize=7.5)
    angle_axis(waveform, span=float(degrees[-1]))
    bars.bar(range(len(means)), means, color=[color for _, _, color in shown])
    for k, value in enumerate(means):
        bars.text(k, value, f"{value:.3g}", ha="center", va="bottom", fontsize=7.5)
    bars.set_ylim(0.9 * min(means), 1.03 * max(means))
    bars.set_xticks([])
    bars.set_title("Mean", fontweight="normal", fontsize=9)
    return figure


@styled
def span_lines(data: xr.Dataset) -> Figure:
    """Contact span and mean torque over the pressure difference, one line per tip clearance."""
    figure = new_figure(7.2, 3.4)
    panels = figure.subplots(1, 2)
    rows = (
        ("span_pitches", "Loaded part of a turn (pitches)"),
        ("mean_torque_N_m", "Mean shaft torque (N m)"),
    )
    clearance = np.asarray(data["tip_clearance"])
    for axes, (name, label) in zip(panels, rows, strict=True):
        for value in np.unique(clearance):
            points = clearance == value
            pressure = 1e-5 * np.asarray(data["pressure_difference"])[points]
            values = np.asarray(data[name])[points]
            axes.plot(pressure, values, "o-", markersize=3, label=f"{1e6 * value:.3g} µm")
        axes.set(xlabel="Pressure difference (bar)", ylabel=label)
    panels[0].axhline(1.0, color=GREY, linestyle="--", linewidth=0.8)
    panels[0].set_ylim(bottom=0.0)
    panels[1].legend(title="Tip clearance")
    return figure


@styled
def ripple_over_turn(data: xr.Dataset) -> Figure:
    """Torque, high-passed torque and outlet pressure over a turn, measured ones as dots."""
    figure = new_figure(7.2, 5.6)
    lowest = 0.5 * (data.sizes["tooth"] - 1)
    rows = [
        ("shaft_torque", "Shaft torque (N m)", 1.0, 0.0),
        ("shaft_torque", "High-passed torque (N m)", 1.0, lowest),
    ]
    if np.ptp(data["outlet_pressure"].values) > 0.0 or "measured_outlet_pressure" in data:
        rows.append(("outlet_pressure", "Outlet pressure, varying (bar)", 1e-5, 0.5))
    panels = figure.subplots(len(rows), 1, sharex=True)
    for axes, (name, label, factor, order) in zip(panels, rows, strict=True):
        angle, values = high_pass(np.asarray(data["shaft_angle"]), np.asarray(data[name]), order)
        degrees = np.degrees(angle - angle[0])
        axes.plot(degrees, factor * values, color=GREEN, label="computed")
        if f"measured_{name}" in data:
            measured = np.asarray(data["measured_angle"]), np.asarray(data[f"measured_{name}"])
            angle, values = high_pass(*measured, order)
            degrees = np.degrees(np.mod(angle, 2.0 * np.pi))
            axes.plot(degrees, factor * values, ".", color=GREY, markersize=3, label="measured")
        axes.set_ylabel(label)
    panels[0].set_title("One turn")
    panels[0].legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2)
    angle_axis(panels[-1])
    return figure


STUDY = Study(ContactSpanStudy, run, figures)
