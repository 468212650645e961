"""Figures of a floating bearing: positions over pressure, losses and maps of its films."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from toothspace.floating.housing_friction import BREAKAWAY_RATIO
from toothspace.plotting.film_maps import HEIGHT, WEAR, point_maps
from toothspace.plotting.panels import StudyFigure
from toothspace.plotting.style import BLUE, CYCLE, GREY, INK, ORANGE, new_figure, styled

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

    from toothspace.core.types import Array


_MARKS = ("-o", "--s", "-.^", ":v", "-D", "--x")
"""Lines that lie on one another stay distinguishable."""


def hysteresis_figures(data: xr.Dataset) -> list[StudyFigure]:
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


def nose_figures(data: xr.Dataset) -> list[StudyFigure]:
    """Return positions over the nose pressure, one line per condition."""
    caption = (
        "Position of the bearing over the nose pressure, one line per condition. Crosses: friction "
        "left the bearing at the gap that it starts from."
    )
    return [StudyFigure("nose_pressure", caption, nose_lines(data)), *film_figures(data)]


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
    for axes, (name, values, text) in zip(figure.subplots(1, 2, sharey=True), shown, strict=True):
        for color, k in zip(CYCLE, np.flatnonzero(varied == name), strict=False):
            label = text.format(float(data[values][k]))
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
