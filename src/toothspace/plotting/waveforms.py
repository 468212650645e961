"""Results over the shaft angle and over time: pressures, ripple and spectra, losses."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from toothspace.core.types import Array
from toothspace.model.description import MachineDescription
from toothspace.plotting.geometry import one_chamber, opening_windows, openings_of
from toothspace.plotting.style import (
    BLUE,
    GREEN,
    GREY,
    INK,
    LIGHT,
    ORANGE,
    PURPLE,
    angle_axis,
    new_figure,
    readable,
    styled,
)
from toothspace.results.ledger import LedgerRow, loss_causes, power_ledger
from toothspace.results.performance import means_by_label
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
_PER_MINUTE = 30.0 / np.pi
_ZOOM = (-0.15, 0.6)
_SLOWEST = 1e-3


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
        span = float(np.degrees(family.volume.period))
        angle_axis(axes, f"Angle of the {readable(family.name).lower()} chamber (deg)", span)
        axes.set(ylabel="Pressure (bar)", title=readable(family.name))
    return figure


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
    force = np.linalg.norm(np.asarray(solution.data["journal_force"]), axis=2) / 1e3
    title = "Bearing forces over one turn"
    return _forces_and_spectra(solution, description, title, "journal", force, "kN")


@styled
def axial_force_spectra(
    solution: Solution, description: MachineDescription | None = None
) -> Figure:
    """Axial force of helical teeth on every body over one turn, its spectrum."""
    force = np.asarray(solution.data["axial_force"])
    title = "Axial forces over one turn"
    return _forces_and_spectra(solution, description, title, "body", force, "N")


def _forces_and_spectra(
    solution: Solution,
    description: MachineDescription | None,
    title: str,
    over: str,
    force: Array,
    unit: str,
) -> Figure:
    """Force on each body of a dimension over the angle, shape (samples, bodies), its spectrum."""
    angle, bodies = np.asarray(solution.data["shaft_angle"]), solution.data[over].values
    signals = [
        (angle, own, f"{readable(str(body))} ({unit})", color)
        for body, own, color in zip(bodies, force.T, (BLUE, ORANGE, GREEN), strict=False)
    ]
    return _waves_and_spectra(solution, description, title, signals)


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
        uniform, values, revolutions = whole_revolutions(angle, signal)
        last = slice(-(uniform.size // revolutions), None)
        degrees = np.degrees(uniform[last] - uniform[last][0])
        left.plot(degrees, values[last], color=color)
        left.axhline(float(np.mean(values)), color=GREY, linewidth=0.8, linestyle="--")
        left.set_ylabel(label)
        angle_axis(left, label="")
        mean = float(np.mean(values))
        if np.ptp(values) < AGREEMENT * max(abs(mean), 1e-30):
            left.set_ylim(0.0, 1.2 * float(np.max(values)) or 1.0)
            note = f"held at {mean:.4g}"
        else:
            note = f"mean {mean:.4g}, peak to peak {np.ptp(values):.3g}"
            note += f" ({ripple_percent(values):.3g} %)" if "bar" not in label else ""
        left.text(0.0, 1.02, note, transform=left.transAxes, ha="left", fontsize=7.5, color=GREY)
        # amplitudes above what two revolutions that agree can differ by
        result = resolved_spectrum(angle, signal)
        end = 10.5 * teeth if teeth else 100.0
        for k in range(1, 11 if teeth else 1):
            right.axvline(k * (teeth or 0), color=LIGHT, linewidth=4.0, zorder=0)
        right.vlines(result.order, 0.0, result.amplitude, color=color, linewidth=1.8)
        if teeth:
            right.set_xticks([k * teeth for k in range(0, 11, 2)])
        right.set_xlim(0.0, end)
        highest = float(np.max(result.amplitude, initial=0.0))
        right.set_ylim(0.0, 1.1 * highest or 1.0)
        if not highest:
            right.set_yticks([])
            right.text(0.5, 0.5, "no ripple", transform=right.transAxes, ha="center", color=GREY)
        right.set_ylabel(f"Amplitude {label[label.index('(') :]}")
    angle_axis(grid[-1][0])
    grid[-1][1].set_xlabel("Shaft order (-)")
    hertz = float(np.mean(solution.data["shaft_speed"])) / (2.0 * np.pi)
    scales = (lambda order: order * hertz), (lambda frequency: frequency / hertz)
    top = grid[0][1].secondary_xaxis("top", functions=scales)
    top.set_xlabel("Frequency (Hz)")
    return figure


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


@styled
def torque_breakdown(solution: Solution, description: MachineDescription | None = None) -> Figure:
    """Friction torque at the shaft by mechanism."""
    torques = means_by_label(solution.data, "torque_loss")
    return _bar_figure(torques, "Friction torque by mechanism", "Torque at the shaft (N m)", ORANGE)


@styled
def leakage_by_path(solution: Solution, description: MachineDescription | None = None) -> Figure:
    """Mean leakage by kind of path."""
    leakages = means_by_label(solution.data, "leakage")
    names = list(leakages)
    labels = _of_paths(solution, "path_label", names)
    flows = {labels[name]: value * _LITRE_PER_MINUTE for name, value in leakages.items()}
    colours = _of_paths(solution, "path_colour", [BLUE] * len(names))
    by_label = {readable(labels[name]): colours[name] for name in names}
    return _bar_figure(flows, "Leakage by path", "Mean leakage (L/min)", by_label)


def _of_paths(solution: Solution, name: str, otherwise: Sequence[str]) -> dict[str, str]:
    """Text that the machine gives each leakage path, by the name of the path."""
    if "path" not in solution.data:
        return {}
    found = solution.data[name].values if name in solution.data else otherwise
    paths = solution.data["path"].values
    return {str(path): str(text) for path, text in zip(paths, found, strict=True)}


@styled
def loss_bars(solution: Solution, description: MachineDescription | None = None) -> Figure:
    """Every loss by cause, largest first."""
    losses = {f"{c.cause}, {c.label}": c.power for c in loss_causes(solution.ledger)}
    return _bar_figure(losses, "Power losses", "Power (W)", PURPLE)


def _bar_figure(
    values: Mapping[str, float], title: str, label: str, color: str | Mapping[str, str]
) -> Figure:
    shown = {readable(name): value for name, value in values.items() if value != 0.0}
    ordered = dict(sorted(shown.items(), key=lambda item: item[1]))
    figure = new_figure(7.2, 1.1 + 0.27 * max(len(ordered), 2))
    axes = figure.subplots()
    colours = [color if isinstance(color, str) else color[name] for name in ordered]
    bars = axes.barh(list(ordered), list(ordered.values()), color=colours, height=0.62)
    axes.bar_label(bars, fmt=_digits, padding=4, fontsize=8, color=INK)
    axes.grid(visible=False, axis="y")
    axes.tick_params(axis="y", length=0)
    axes.margins(x=0.12)
    axes.set(title=title, xlabel=label)
    return figure


def _digits(value: float) -> str:
    return f"{value:.3g}" if abs(value) < 100.0 else f"{value:.0f}"


@styled
def ledger_waterfall(solution: Solution, description: MachineDescription | None = None) -> Figure:
    """From supplied power, loss by loss, to delivered power."""
    rows = power_ledger(solution.ledger)
    supplied = next(row for row in rows if row.kind == "supplied")
    delivered = next(row for row in rows if row.kind == "delivered")
    causes = sorted(loss_causes(solution.ledger), key=lambda entry: -entry.power)
    powers = [(f"{c.cause}, {c.label}", c.power) for c in causes]
    powers += [(row.label, row.power) for row in rows if row.kind == "stored"]
    # steps above 2 % of all, the others in one
    least = 0.02 * sum(abs(power) for _, power in powers)
    steps = [(readable(name), power) for name, power in powers if abs(power) > least]
    rest = sum(power for _, power in powers if abs(power) <= least)
    if rest != 0.0:
        steps.append(("Others", rest))
    figure = new_figure(7.2, 4.2)
    axes = figure.subplots()
    _draw_waterfall(axes, supplied, steps, delivered)
    axes.set(ylabel="Power (W)", title="Power ledger")
    axes.tick_params(axis="x", rotation=40, length=0)
    for label in axes.get_xticklabels():
        label.set_horizontalalignment("right")
        label.set_rotation_mode("anchor")
    axes.grid(visible=False, axis="x")
    return figure


def _draw_waterfall(
    axes: Axes, supplied: LedgerRow, steps: Sequence[tuple[str, float]], delivered: LedgerRow
) -> None:
    ends = f"Supplied ({supplied.label})", f"Delivered ({delivered.label})"
    names = [ends[0], *(name for name, _ in steps), ends[1]]
    drops = np.array([power for _, power in steps])
    level = supplied.power - np.concatenate([[0.0], np.cumsum(drops)])
    bottoms = np.concatenate([[0.0], level[1:], [0.0]])
    heights = np.concatenate([[supplied.power], drops, [delivered.power]])
    colors = [BLUE, *([ORANGE] * len(steps)), GREEN]
    axes.bar(np.arange(len(names)), heights, bottom=bottoms, color=colors, width=0.66)
    for k in range(len(names) - 1):
        axes.plot([k + 0.33, k + 0.67], [level[k], level[k]], color=GREY, linewidth=0.8)
    for k, height in enumerate(heights):
        top = bottoms[k] + max(height, 0.0)
        axes.annotate(
            _digits(height), (k, top), (0, 3), textcoords="offset points", ha="center", fontsize=7.5
        )
    axes.set_xticks(np.arange(len(names)), names)
    losses = supplied.power - min(float(level[-1]), delivered.power)
    if losses < 0.5 * supplied.power:
        axes.set_ylim(max(0.0, delivered.power - 0.6 * losses), supplied.power + 0.15 * losses)
        axes.annotate(
            "axis does not start at zero",
            (0.99, 0.97),
            xycoords="axes fraction",
            ha="right",
            va="top",
            fontsize=8,
            color=GREY,
        )


@styled
def speed_and_pressure(
    solution: Solution,
    description: MachineDescription | None = None,
    measured: Mapping[str, Array] | None = None,
) -> Figure:
    """Shaft speed and pressure difference over time.

    Parameters
    ----------
    solution : Solution
        Run over time.
    description : MachineDescription, optional
        Not needed.
    measured : mapping, optional
        ``time`` [s] with ``shaft_speed`` [rad/s] and ``pressure_difference`` [Pa], drawn over it.
    """
    figure = new_figure(7.2, 4.6)
    speed, pressure = figure.subplots(2, 1, sharex=True)
    _band(speed, solution, "shaft_speed", _PER_MINUTE, GREEN)
    if np.any(solution.data["supply_speed"]):
        time = np.asarray(solution.data["time"])
        supply = np.asarray(solution.data["supply_speed"]) * _PER_MINUTE
        speed.plot(time, supply, color=GREY, linewidth=1.0, linestyle="--", label="Supply pump")
    _band(pressure, solution, "pressure_difference", 1.0 / _BAR, BLUE)
    rows = (speed, "shaft_speed", _PER_MINUTE), (pressure, "pressure_difference", 1.0 / _BAR)
    for axes, name, factor in rows:
        if measured and name in measured:
            axes.plot(measured["time"], factor * measured[name], color=INK, label="Measured")
    pressure.set(ylabel="Pressure difference (bar)", xlabel="Time (s)")
    speed.set(ylabel="Speed (rpm)", title="Speed and pressure over time")
    speed.legend(loc="lower right", bbox_to_anchor=(1.0, 1.0), ncols=3, borderaxespad=0.2)
    return figure


def _band(axes: Axes, solution: Solution, name: str, factor: float, color: str) -> None:
    """Mean of each row as a line, between its lowest and highest value."""
    data = solution.data
    time = np.asarray(data["time"])
    low, high = (factor * np.asarray(data[f"{name}_{end}"]) for end in ("lowest", "highest"))
    axes.fill_between(time, low, high, color=color, alpha=0.25, linewidth=0.0)
    axes.plot(time, factor * np.asarray(data[name]), color=color, linewidth=1.0, label="Simulated")


@styled
def breakaway_zoom(solution: Solution, description: MachineDescription | None = None) -> Figure:
    """Pressure difference, speed and angle about the moment in which the shaft breaks away."""
    data = solution.data
    time = np.asarray(data["time"]) - solution.breakaway_time
    shown = (time > _ZOOM[0]) & (time < _ZOOM[1])
    figure = new_figure(7.2, 4.8)
    rows = figure.subplots(3, 1, sharex=True)
    angle = np.degrees(np.asarray(data["shaft_angle"]))
    signals = (
        (np.asarray(data["pressure_difference"]) / _BAR, "Pressure (bar)", BLUE),
        (np.asarray(data["shaft_speed"]) * _PER_MINUTE, "Speed (rpm)", GREEN),
        (angle - angle[0], "Angle (deg)", ORANGE),
    )
    for axes, (signal, label, color) in zip(rows, signals, strict=True):
        axes.plot(1e3 * time[shown], signal[shown], color=color)
        axes.axvline(0.0, color=GREY, linewidth=0.8, linestyle="--")
        axes.set_ylabel(label)
    rows[0].set_title("Breakaway")
    rows[2].set_xlabel("Time after breakaway (ms)")
    return figure


@styled
def electric_drive(solution: Solution, description: MachineDescription | None = None) -> Figure:
    """Speed, torques and powers of an electric drive and the machine that it turns."""
    data = solution.data
    time = np.asarray(data["time"])
    figure = new_figure(7.2, 6.0)
    speed, torque, power = figure.subplots(3, 1, sharex=True)
    speed.plot(time, np.asarray(data["shaft_speed"]) * _PER_MINUTE, color=GREEN)
    speed.set(ylabel="Speed (rpm)", title="Electric drive over time")
    torque.plot(time, np.asarray(data["shaft_torque"]), color=GREY, label="Machine")
    torque.plot(time, np.asarray(data["drive_torque"]), color=ORANGE, label="Motor")
    torque.set_ylabel("Torque (N m)")
    mechanical = np.asarray(data["drive_torque"] * data["shaft_speed"])
    side = "inlet" if data.attrs.get("mode") == "motor" else "outlet"
    hydraulic = np.asarray(data["pressure_difference"] * data[f"{side}_flow_rate"])
    for values, label, color in (
        (np.asarray(data["electric_power"]), "Electric", BLUE),
        (mechanical, "At the shaft", ORANGE),
        (hydraulic, "Hydraulic", GREEN),
    ):
        power.plot(time, 1e-3 * values, color=color, label=label)
    power.set(xlabel="Time (s)", ylabel="Power (kW)")
    for axes in (torque, power):
        axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)
    return figure


@styled
def torque_shares(solution: Solution, description: MachineDescription | None = None) -> Figure:
    """Torque of the load and of every friction mechanism over time, on top of each other."""
    data = solution.data
    time = np.asarray(data["time"])
    torque = np.asarray(data["torque_loss"])
    shares = {"Load": np.asarray(data["load_torque"])}
    for k, name in enumerate(data["mechanism"].values):
        if np.any(np.abs(torque[:, k]) > 1e-4 * np.abs(torque).max()):
            shares[readable(str(name))] = torque[:, k]
    figure = new_figure(7.2, 3.6)
    axes = figure.subplots()
    axes.stackplot(time, [np.maximum(v, 0.0) for v in shares.values()], labels=list(shares))
    axes.set_xlabel("Time (s)")
    axes.set_ylabel("Torque at the shaft (N m)")
    axes.set_title("What the pressure works against")
    axes.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0)
    return figure


@styled
def stribeck_path(solution: Solution, description: MachineDescription | None = None) -> Figure:
    """Friction torque of the machine over shaft speed, coloured by time."""
    data = solution.data
    speed = np.abs(np.asarray(data["shaft_speed"])) * _PER_MINUTE
    friction = np.asarray(data["torque_loss"]).sum(axis=1)
    moving = speed > _SLOWEST
    figure = new_figure(7.2, 3.4)
    axes = figure.subplots()
    time = np.asarray(data["time"])
    dots = axes.scatter(speed[moving], friction[moving], c=time[moving], s=5.0, cmap="viridis")
    axes.set_xscale("log")
    axes.set_xlabel("Speed (rpm)")
    axes.set_ylabel("Friction torque (N m)")
    axes.set_title("Path in the Stribeck plane")
    figure.colorbar(dots, ax=axes, label="Time (s)")
    return figure
