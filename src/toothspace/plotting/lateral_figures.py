"""Figures of a pressed bearing: positions over pressure, losses and maps of its films."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np

from toothspace.plotting.style import BLUE, CYCLE, GREY, INK, ORANGE, new_figure, readable, styled

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.collections import QuadMesh
    from matplotlib.figure import Figure

_MOST_MAPS = 7
_UM = 1e6


@final
@dataclass(frozen=True)
class StudyFigure:
    """A figure of a study with its caption."""

    name: str
    caption: str
    figure: Figure


def hysteresis_figures(data: xr.Dataset) -> list[StudyFigure]:
    """Return loops of position, film, leakage and torque, and maps of the films."""
    return [
        StudyFigure(
            "positions",
            "Position of the bearing, mean film, leakage and torque loss beside the gears over "
            "the outlet pressure: full line up, broken line down.",
            loops(data),
        ),
        StudyFigure(
            "film_height",
            "Height of both films of the drive gear at every point; white: no film.",
            film_maps(data),
        ),
    ]


def nose_figures(data: xr.Dataset) -> list[StudyFigure]:
    """Return positions over the nose pressure, one line per condition."""
    caption = "Position of the bearing over the nose pressure, one line per condition."
    return [StudyFigure("nose_pressure", caption, nose_lines(data))]


@styled
def loops(data: xr.Dataset) -> Figure:
    """Four numbers over the outlet pressure, the way down apart from the way up."""
    figure = new_figure(7.2, 5.4)
    panels = (
        ("bearing_position_um", "Bearing position (µm)"),
        ("film_height_um", "Mean film (µm)"),
        ("leakage_L_per_min", "Lateral leakage (L/min)"),
        ("torque_loss_N_m", "Lateral torque loss (N m)"),
    )
    for axes, (name, label) in zip(np.ravel(figure.subplots(2, 2)), panels, strict=True):
        _loop(axes, data, name)
        axes.set_ylabel(label)
        axes.set_xlabel("Outlet pressure (bar)")
    figure.axes[0].legend()
    return figure


def _loop(axes: Axes, data: xr.Dataset, name: str) -> None:
    pressure, value = data["outlet_pressure_bar"].values, data[name].values
    top = int(np.argmax(pressure))
    axes.plot(pressure[: top + 1], value[: top + 1], "-o", color=BLUE, ms=4, label="up")
    axes.plot(pressure[top:], value[top:], "--o", color=ORANGE, ms=4, mfc="white", label="down")


@styled
def film_maps(data: xr.Dataset) -> Figure:
    """Height of the films of the first body at all points, floating side above solid side."""
    shown = data.isel(point=slice(None, _MOST_MAPS))
    sides = [k for k, name in enumerate(data["film"].values) if "drive" in str(name)] or [0]
    count = shown.sizes["point"]
    figure = new_figure(1.25 + 1.2 * count, 1.55 * len(sides) + 0.7)
    heights = shown["film_height"].values[:, sides] * _UM
    low, high = np.nanpercentile(heights, [1.0, 99.0])
    panels = figure.subplots(len(sides), count, squeeze=False)
    for row, side in enumerate(sides):
        for column in range(count):
            axes = panels[row][column]
            mesh = _map(axes, data, heights[column, row], (float(low), float(high)))
            if row == 0:
                axes.set_title(str(shown["point_label"].values[column]), fontsize=8)
        label = str(data["film"].values[side]).replace("_", " ")
        panels[row][0].set_ylabel(readable(label), fontsize=8)
    bar = figure.colorbar(mesh, ax=panels, shrink=0.8)
    bar.set_label("Film height (µm)")
    return figure


def _map(axes: Axes, data: xr.Dataset, height: np.ndarray, limits: tuple[float, float]) -> QuadMesh:
    angle, radius = data["film_angle"].values, data["film_radius"].values
    turn, reach = angle[1] - angle[0], radius[1] - radius[0]
    edges = np.append(angle - 0.5 * turn, angle[-1] + 0.5 * turn)
    rims = np.append(radius - 0.5 * reach, radius[-1] + 0.5 * reach) * 1e3
    x, y = np.cos(edges)[:, None] * rims, np.sin(edges)[:, None] * rims
    low, high = limits
    mesh = axes.pcolormesh(x, y, height, cmap="viridis", vmin=low, vmax=high, rasterized=True)
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    for side in axes.spines.values():
        side.set_visible(False)
    return mesh


@styled
def nose_lines(data: xr.Dataset) -> Figure:
    """Position over the nose pressure over the outlet pressure, one line per condition."""
    figure = new_figure(7.2, 3.2)
    axes = figure.subplots()
    names = [str(label).rpartition(",")[0] for label in data["point_label"].values]
    ratio = data["nose_pressure_bar"].values / data["outlet_pressure_bar"].values
    for color, name in zip(CYCLE, dict.fromkeys(names), strict=False):
        own = [k for k, other in enumerate(names) if other == name]
        position = data["bearing_position_um"].values[own]
        axes.plot(ratio[own], position, "-o", color=color, ms=4, label=name)
    axes.set_xlabel("Nose pressure over outlet pressure")
    axes.set_ylabel("Bearing position (µm)")
    axes.legend()
    axes.grid(color=GREY, alpha=0.25)
    axes.tick_params(colors=INK)
    return figure
