"""Figures of a pressed bearing: positions over pressure, losses and maps of its films."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np

from toothspace.core.types import Array
from toothspace.plotting.style import BLUE, CYCLE, GREY, INK, ORANGE, new_figure, readable, styled

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.collections import QuadMesh
    from matplotlib.colors import LogNorm
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
            "Height of the films beside both gears at every point, seen from the floating side; "
            "white: tooth spaces and grooves.",
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
    """Height of all films at all points, one row per side of the gears."""
    from matplotlib.colors import LogNorm

    shown = data.isel(point=slice(None, _MOST_MAPS))
    names = [str(name) for name in data["film"].values]
    sides = list(dict.fromkeys(name.partition("_")[0] for name in names))
    count = shown.sizes["point"]
    figure = new_figure(1.2 + 0.95 * count, 1.75 * len(sides) + 0.5)
    heights = shown["film_height"].values * _UM
    scale = LogNorm(*np.nanpercentile(heights, [1.0, 99.0]))
    panels = figure.subplots(len(sides), count, squeeze=False)
    for row, side in enumerate(sides):
        own = [k for k, name in enumerate(names) if name.startswith(f"{side}_")]
        for column in range(count):
            axes = panels[row][column]
            for film in own:
                mesh = _map(axes, data, film, heights[column, film], scale)
            _bare(axes)
        panels[row][0].set_ylabel(f"{readable(side)} side", fontsize=8)
    for axes, label in zip(panels[0], shown["point_label"].values, strict=True):
        axes.set_title(str(label), fontsize=7.5)
    bar = figure.colorbar(mesh, ax=panels, shrink=0.8)
    bar.set_label("Film height (µm)")
    bar.ax.yaxis.set_major_formatter("{x:g}")
    bar.ax.yaxis.set_minor_formatter("{x:g}")
    return figure


def _map(axes: Axes, data: xr.Dataset, film: int, height: Array, scale: LogNorm) -> QuadMesh:
    angle, radius = data["film_angle"].values, data["film_radius"].values
    center = data["film_center"].values[film]
    turn, reach = angle[1] - angle[0], radius[1] - radius[0]
    edges = np.append(angle - 0.5 * turn, angle[-1] + 0.5 * turn)[:, None]
    rims = np.append(radius - 0.5 * reach, radius[-1] + 0.5 * reach)
    x, y = center[0] + np.cos(edges) * rims, center[1] + np.sin(edges) * rims
    return axes.pcolormesh(x, y, height, cmap="viridis", norm=scale, rasterized=True)


def _bare(axes: Axes) -> None:
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    for side in axes.spines.values():
        side.set_visible(False)


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
