"""Figures of the study of gerotor contacts: torque from ideal to complete, span of contact."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from toothspace.core.types import Array
from toothspace.plotting.lateral_figures import StudyFigure
from toothspace.plotting.style import BLUE, GREEN, GREY, ORANGE, angle_axis, new_figure, styled
from toothspace.results.ripple import high_pass

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

TORQUE_STAGES = (
    ("ideal_torque", "Ideal", GREY),
    ("torque_with_gaps", "With gaps", BLUE),
    ("shaft_torque", "With gaps and contact friction", GREEN),
    ("single_contact_torque", "The same, single contact", ORANGE),
)
"""Torques from ideal to complete with their colours."""


def contact_span_figures(data: xr.Dataset) -> list[StudyFigure]:
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
