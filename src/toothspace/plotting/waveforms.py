"""Results over the shaft angle: chamber pressure, ripple and spectra, contacts."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

import numpy as np

from toothspace.core.types import Array
from toothspace.model.description import ChamberFamily, MachineDescription
from toothspace.plotting.style import (
    BLUE,
    GREEN,
    GREY,
    LIGHT,
    ORANGE,
    angle_axis,
    new_figure,
    readable,
    styled,
)
from toothspace.plotting.windows import one_chamber, opening_windows, openings_of
from toothspace.results.ripple import (
    AGREEMENT,
    pulsating_side,
    resolved_spectrum,
    ripple_percent,
    wave,
    whole_revolutions,
    working_side,
)
from toothspace.results.solution import Solution

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_BAR = 1e5
_LITRE_PER_MINUTE = 6e4


@styled
def chamber_pressure_over_turn(
    solution: Solution, description: MachineDescription | None = None
) -> Figure:
    """Pressure of one chamber of each family over its own angle, with its openings marked."""
    families = description.families if description is not None else (None,)
    figure = new_figure(7.2, 2.9 * len(families))
    for axes, family in zip(np.ravel(figure.subplots(len(families), 1)), families, strict=True):
        if family is None or description is None:
            degrees = _degrees(solution)
            axes.plot(degrees, np.asarray(solution.data["chamber_pressure"])[:, 0] / _BAR)
            axes.set(title="Pressure of the first chamber", ylabel="Pressure (bar)")
            angle_axis(axes, span=float(degrees[-1]))
            continue
        angle, sample, column = one_chamber(solution.data, description, family)
        pressure = np.asarray(solution.data["chamber_pressure"])[sample, column] / _BAR
        axes.plot(np.degrees(angle), pressure, color=BLUE)
        gas = np.zeros_like(pressure)
        if "chamber_gas_fraction" in solution.data:
            gas = np.asarray(solution.data["chamber_gas_fraction"])[sample, column]
        if float(np.max(gas)) > 0.1:
            twin = axes.twinx()
            twin.fill_between(np.degrees(angle), 100.0 * gas, color=GREEN, alpha=0.2, linewidth=0.0)
            twin.set_ylim(0.0, 100.0)
            twin.set_ylabel("Gas and vapour (vol %)", color=GREEN)
            twin.grid(visible=False)
        _mark_windows(axes, description, family)
        span = float(np.degrees(family.volume.period))
        angle_axis(axes, f"Angle of the {readable(family.name).lower()} chamber (deg)", span)
        axes.set(ylabel="Pressure (bar)", title=readable(family.name))
    return figure


def _mark_windows(axes: Axes, description: MachineDescription, family: ChamberFamily) -> None:
    low, high = axes.get_ylim()
    shown = [c for c in openings_of(description) if opening_windows(description, family, c)]
    step = 0.055 * (high - low)
    for k, category in enumerate(shown):
        level = low - (k + 1) * step
        for start, end in opening_windows(description, family, category):
            place = np.degrees([start, end]), [level, level]
            axes.plot(*place, color=category.colour, linewidth=4.0, solid_capstyle="butt")
        label = readable(category.label)
        axes.plot([], [], color=category.colour, linewidth=4.0, label=label)
    axes.set_yticks([tick for tick in axes.get_yticks() if 0.0 <= tick <= high])
    axes.set_ylim(low - (len(shown) + 1) * step, high)
    if shown:
        axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=4, borderaxespad=0.2)


@styled
def ripple_and_spectrum(
    solution: Solution, description: MachineDescription | None = None
) -> Figure:
    """Flow, pressure and torque over one turn, each with its spectrum in orders and Hz."""
    data = solution.data
    side, port = working_side(data), pulsating_side(data)
    rows = (
        (f"{side}_flow_rate", f"{readable(side)} flow (L/min)", _LITRE_PER_MINUTE, BLUE),
        (f"{port}_pressure", f"{readable(port)} pressure (bar)", 1.0 / _BAR, ORANGE),
        ("shaft_torque", "Shaft torque (N m)", 1.0, GREEN),
    )
    signals = []
    for name, label, factor, color in rows:
        angle, values = wave(data, name)
        signals.append((angle, factor * values, label, color))
    return _waves_and_spectra(solution, description, "Ripple over one turn", signals)


@styled
def bearing_force_spectra(
    solution: Solution, description: MachineDescription | None = None
) -> Figure:
    """Force of the journal bearings on every body that they carry over one turn, its spectrum."""
    data = solution.data
    signals, angle = [], np.asarray(data["shaft_angle"])
    for body, color in zip(data["journal"].values, (BLUE, ORANGE, GREEN), strict=False):
        force = np.linalg.norm(np.asarray(data["journal_force"].sel(body=body)), axis=1)
        signals.append((angle, force / 1e3, f"{readable(str(body))} (kN)", color))
    return _waves_and_spectra(solution, description, "Bearing forces over one turn", signals)


def _waves_and_spectra(
    solution: Solution,
    description: MachineDescription | None,
    title: str,
    signals: Sequence[tuple[Array, Array, str, str]],
) -> Figure:
    """One row for each signal over its angle, with its label and colour."""
    teeth = description.families[0].count if description is not None else None
    figure = new_figure(7.6, 1.0 + 1.9 * len(signals))
    figure.suptitle(title)
    grid = figure.subplots(len(signals), 2, width_ratios=(3, 2), squeeze=False)
    for (left, right), (angle, signal, label, color) in zip(grid, signals, strict=True):
        _waveform(left, angle, signal, label, color)
        _order_bars(right, angle, signal, color, teeth)
        right.set_ylabel(f"Amplitude {label[label.index('(') :]}")
    angle_axis(grid[-1][0])
    grid[-1][1].set_xlabel("Shaft order (-)")
    hertz = float(np.mean(solution.data["shaft_speed"])) / (2.0 * np.pi)
    scales = (lambda order: order * hertz), (lambda frequency: frequency / hertz)
    top = grid[0][1].secondary_xaxis("top", functions=scales)
    top.set_xlabel("Frequency (Hz)")
    return figure


def _waveform(axes: Axes, angle: Array, signal: Array, label: str, color: str) -> None:
    uniform, values, revolutions = whole_revolutions(angle, signal)
    last = slice(-(uniform.size // revolutions), None)
    degrees = np.degrees(uniform[last] - uniform[last][0])
    axes.plot(degrees, values[last], color=color)
    axes.axhline(float(np.mean(values)), color=GREY, linewidth=0.8, linestyle="--")
    axes.set_ylabel(label)
    angle_axis(axes, label="")
    mean = float(np.mean(values))
    if np.ptp(values) < AGREEMENT * max(abs(mean), 1e-30):
        axes.set_ylim(0.0, 1.2 * float(np.max(values)) or 1.0)
        note = f"held at {mean:.4g}"
    else:
        note = f"mean {mean:.4g}, peak to peak {np.ptp(values):.3g}"
        note += f" ({ripple_percent(values):.3g} %)" if "bar" not in label else ""
    axes.text(0.0, 1.02, note, transform=axes.transAxes, ha="left", fontsize=7.5, color=GREY)


def _order_bars(axes: Axes, angle: Array, signal: Array, color: str, teeth: int | None) -> None:
    """Amplitudes above what two revolutions that agree can differ by."""
    result = resolved_spectrum(angle, signal)
    end = 10.5 * teeth if teeth else 100.0
    for k in range(1, 11 if teeth else 1):
        axes.axvline(k * (teeth or 0), color=LIGHT, linewidth=4.0, zorder=0)
    axes.vlines(result.order, 0.0, result.amplitude, color=color, linewidth=1.8)
    if teeth:
        axes.set_xticks([k * teeth for k in range(0, 11, 2)])
    axes.set_xlim(0.0, end)
    top = float(np.max(result.amplitude, initial=0.0))
    axes.set_ylim(0.0, 1.1 * top or 1.0)
    if not top:
        axes.set_yticks([])
        axes.text(0.5, 0.5, "no ripple", transform=axes.transAxes, ha="center", color=GREY)


@styled
def time_history(solution: Solution, description: MachineDescription | None = None) -> Figure:
    """Speed, torque, pressures and flows of a transient run over time."""
    data = solution.data
    time = np.asarray(data["time"])
    figure = new_figure(7.2, 6.4)
    speed, torque, pressure, flow = figure.subplots(4, 1, sharex=True)
    speed.plot(time, np.asarray(data["shaft_speed"]) * 30.0 / np.pi, color=GREEN)
    torque.plot(time, np.asarray(data["shaft_torque"]), color=GREEN)
    torque.set_ylabel("Torque (N m)")
    for port, color in (("inlet", BLUE), ("outlet", ORANGE)):
        label = readable(port)
        pressure.plot(time, np.asarray(data[f"{port}_pressure"]) / _BAR, color=color, label=label)
        flow.plot(time, np.asarray(data[f"{port}_flow_rate"]) * _LITRE_PER_MINUTE, color=color)
    pressure.set_ylabel("Pressure (bar)")
    pressure.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=2, borderaxespad=0.2)
    flow.set(ylabel="Flow (L/min)", xlabel="Time (s)")
    speed.set(ylabel="Speed (rpm)", title="Course of the run")
    return figure


@styled
def contact_forces(solution: Solution, description: MachineDescription | None = None) -> Figure:
    """Normal force of every contact over the shaft angle, and their sum."""
    degrees = _degrees(solution)
    force = np.asarray(solution.data["contact_force"])
    names = sorted({str(c).rsplit("_", 1)[0] for c in solution.data["contact"].values})
    figure = new_figure(7.2, 3.0)
    axes = figure.subplots()
    for name, color in zip(names, (BLUE, ORANGE, GREEN, GREY), strict=False):
        members = [str(c).rsplit("_", 1)[0] == name for c in solution.data["contact"].values]
        axes.plot(degrees, force[:, members] / 1e3, color=color, linewidth=1.0)
        axes.plot([], [], color=color, label=readable(name))
    axes.plot(degrees, force.sum(axis=1) / 1e3, color=GREY, linestyle="--", label="Sum")
    axes.set(ylabel="Contact force (kN)", title="Contact forces between the teeth")
    angle_axis(axes, span=float(degrees[-1]))
    axes.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, borderaxespad=0.2)
    return figure


def _degrees(solution: Solution) -> Array:
    angle = np.asarray(solution.data["shaft_angle"])
    return np.asarray(np.degrees(angle - angle[0]))
