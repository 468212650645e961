"""Runs over time: speed and pressure, breakaway, torque shares, path in the Stribeck plane."""

from __future__ import annotations

from collections.abc import Mapping
from typing import TYPE_CHECKING

import numpy as np

from toothspace.core.types import Array
from toothspace.model.description import MachineDescription
from toothspace.plotting.style import BLUE, GREEN, GREY, INK, ORANGE, new_figure, readable, styled
from toothspace.results.solution import Solution

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_BAR = 1e5
_PER_MINUTE = 30.0 / np.pi
_ZOOM = (-0.15, 0.6)
_SLOWEST = 1e-3


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
