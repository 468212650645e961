"""Figures of a floating bearing over speed and pressure, and over its balanced area."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING, Any

import numpy as np

from toothspace.core.types import Array
from toothspace.plotting.panels import StudyFigure
from toothspace.plotting.style import (
    BLUE,
    CYCLE,
    GREEN,
    GREY,
    INK,
    ORANGE,
    contour_lines,
    new_figure,
    styled,
)

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_RPM = 60.0 / (2.0 * np.pi)
_MAPS = (
    ("smallest_film_um", "Smallest film (µm)", "viridis"),
    ("contact_force_N", "Load on asperities (N)", "magma_r"),
    ("wear_power_W_per_mm2", "Wear indicator p v (W/mm²)", "magma_r"),
    ("bearing_position_um", "Bearing position (µm)", "viridis"),
    ("leakage_L_per_min", "Lateral leakage (L/min)", "magma_r"),
    ("torque_loss_N_m", "Lateral torque loss (N m)", "magma_r"),
)
_EFFECTS = (
    ("smallest_film_um", "Smallest film (µm)"),
    ("contact_force_N", "Load on asperities (N)"),
    ("leakage_L_per_min", "Lateral leakage (L/min)"),
    ("torque_loss_N_m", "Lateral torque loss (N m)"),
)
_LEVELS = 9
_WIDE, _VERY_WIDE = 3.0, 30.0
"""Largest over smallest value from which levels are logarithmic, and wider apart. [-]"""
_NEXT = 2.5
"""Largest ratio of neighbouring logarithmic levels. [-]"""
_NAMES_WIDTH = 0.1
"""Room for the names of claims beside the lines, over the range of ratios. [-]"""
_CLAIM_TEXT = ("rises", "stays higher", "on its film")


def map_figures(data: xr.Dataset) -> list[StudyFigure]:
    """Return maps of the films over shaft speed and outlet pressure."""
    found = all(name in data for name, _, _ in _MAPS)
    if not found or min(data.sizes["shaft_speed"], data.sizes["outlet_pressure"]) < 2:
        return []
    caption = (
        "Films of the bearing in equilibrium over shaft speed and outlet pressure; dots are the "
        "computed points, crosses those without equilibrium. Few asperities should touch where the "
        "pump runs."
    )
    return [StudyFigure("bearing_map", caption, film_contours(data))]


@styled
def film_contours(data: xr.Dataset) -> Figure:
    """Smallest film, asperity load, wear, position, leakage and torque over speed and pressure."""
    figure = new_figure(7.2, 7.6)
    speed, pressure = data["shaft_speed"].values * _RPM, data["outlet_pressure"].values * 1e-5
    panels = figure.subplots(3, 2, sharex=True, sharey=True)
    done = data["point_status"].values.T == "done"
    x, y = np.meshgrid(speed, pressure)
    for axes, (name, label, colours) in zip(panels.flat, _MAPS, strict=True):
        values = np.ma.masked_invalid(data[name].values.T)
        if values.count() > 3 and float(np.ptp(values.compressed())) > 0.0:
            _filled(axes, (speed, pressure, values), colours)
        axes.plot(x[done], y[done], ".", color=GREY, ms=3)
        axes.plot(x[~done], y[~done], "x", color=INK, ms=5)
        axes.set_title(label)
    for axes in panels[-1]:
        axes.set_xlabel("Shaft speed (rpm)")
    for axes in panels[:, 0]:
        axes.set_ylabel("Outlet pressure (bar)")
    return figure


def _filled(axes: Axes, grid: tuple[Array, Array, Any], colours: str) -> None:
    from matplotlib.colors import LogNorm, Normalize
    from matplotlib.ticker import MaxNLocator

    values = grid[2]
    low, high = float(values.min()), float(values.max())
    scale: Normalize
    if low > 0.0 and high > _WIDE * low:
        levels, scale = _one_two_five(low, high), LogNorm(low, high)
    else:
        levels = np.asarray(MaxNLocator(_LEVELS, min_n_ticks=4).tick_values(low, high))
        scale = Normalize(levels[0], levels[-1])
    contour_lines(axes, grid, levels, cmap=colours, norm=scale)


def _one_two_five(low: float, high: float) -> Array:
    """Levels 1, 2 and 5 times powers of ten round a range, closer ones in a narrow range."""
    steps = (1.0, 2.0, 5.0) if high > _VERY_WIDE * low else (1.0, 1.5, 2.0, 3.0, 5.0, 7.0)
    decades = 10.0 ** np.arange(np.floor(np.log10(low)), np.ceil(np.log10(high)) + 1.0)
    every = np.outer(decades, steps).ravel()
    return every[(every >= low / _NEXT) & (every <= high * _NEXT)]


def balance_figures(data: xr.Dataset) -> list[StudyFigure]:
    """Return gaps with claims over the balance ratio, and sensitivities to area and friction."""
    found = []
    for k, mu in enumerate(data["friction_coefficient"].values):
        caption = (
            f"Gap at every point over the balance ratio with a housing friction of {mu:g}. Full "
            "lines: up; broken lines: down. Bars: ratios at which each claim of the source holds."
        )
        one = data.isel(friction_coefficient=k)
        found.append(StudyFigure(f"balance_window_{k + 1}", caption, balance_window(one)))
    caption = (
        "Films on the way up over the balanced area, one colour per outlet pressure: the more "
        "area, the closer the bearing runs, until asperities carry."
    )
    found.append(StudyFigure("area_sensitivity", caption, area_sensitivity(data)))
    if data.sizes["friction_coefficient"] > 1:
        caption = (
            "Loop area and gap at the highest pressure over the ratio, by housing friction, as far "
            "as the bearing does not lift off."
        )
        found.append(StudyFigure("friction_sensitivity", caption, friction_sensitivity(data)))
    return found


@styled
def balance_window(data: xr.Dataset) -> Figure:
    """Gaps over the balance ratio, and bars where each claim holds, of one friction."""
    figure = new_figure(7.2, 3.4)
    window_on(figure.subplots(), data)
    return figure


def window_on(axes: Axes, data: xr.Dataset) -> None:
    """Draw the window of one friction coefficient into given axes."""
    ratio, gaps = data["balance_ratio"].values, data["gap_um"].values
    count = gaps.shape[-1]
    top = count // 2
    lifted = float(data.attrs["lifted_gap_um"])
    for k, color in zip(range(top + 1), _cycle(top + 1), strict=True):
        back = count - 1 - k
        label = f"point {k + 1} and {back + 1}" if back != k else f"point {k + 1}"
        axes.plot(ratio, gaps[:, k], color=color, label=label)
        axes.plot(ratio, gaps[:, back], "--", color=color)
    axes.axhline(lifted, color=GREY, lw=0.8, ls=":")
    low = 0.9 * float(np.nanmin(gaps))
    for row, (held, text) in enumerate(zip(data["claim_holds"].values, _CLAIM_TEXT, strict=True)):
        height = low * 0.86 ** (row + 1)
        axes.plot(ratio, np.where(held, height, np.nan), lw=3, color=GREEN, solid_capstyle="butt")
        axes.text(ratio[0], height, f"{text} ", fontsize=6, ha="right", va="center")
    axes.set_xlim(ratio[0] - _NAMES_WIDTH * (ratio[-1] - ratio[0]), ratio[-1])
    axes.set_ylim(low * 0.6, None)
    _decades(axes)
    axes.set_xlabel("Balanced area over the area that plane films carry")
    axes.set_ylabel("Gap of rigid faces (µm)")
    axes.legend(fontsize=7)


def _decades(axes: Axes) -> None:
    """Logarithmic heights with a few plain numbers beside them."""
    axes.set_yscale("log")
    low, high = axes.get_ylim()
    ticks = [t for t in (0.2, 0.5, 1, 2, 3, 5, 10, 20, 50) if low <= t <= high]
    axes.set_yticks(ticks, labels=[f"{t:g}" for t in ticks])
    axes.minorticks_off()


def _cycle(count: int) -> Sequence[str]:
    colours = (BLUE, ORANGE, GREY, INK, *CYCLE)
    return [colours[k % len(colours)] for k in range(count)]


@styled
def area_sensitivity(data: xr.Dataset) -> Figure:
    """Films on the way up over the balance ratio at the first friction coefficient."""
    figure = new_figure(7.2, 5.4)
    one = data.isel(friction_coefficient=0)
    pressure = one["outlet_pressure_bar"].values
    top = int(np.argmax(pressure))
    for axes, (name, label) in zip(figure.subplots(2, 2, sharex=True).flat, _EFFECTS, strict=True):
        for k, color in zip(range(top + 1), _cycle(top + 1), strict=True):
            values = one[name].values[:, k]
            axes.plot(one["balance_ratio"], values, color=color, label=f"{pressure[k]:.4g} bar")
        axes.set_ylabel(label)
    _decades(figure.axes[0])
    figure.axes[0].legend(fontsize=7)
    for axes in figure.axes[2:]:
        axes.set_xlabel("Balance ratio")
    return figure


@styled
def friction_sensitivity(data: xr.Dataset) -> Figure:
    """Loop area and gap at the highest pressure over the ratio, one line per friction."""
    figure = new_figure(7.2, 3.2)
    left, right = figure.subplots(1, 2)
    top = int(np.argmax(data["outlet_pressure_bar"].values))
    for k, mu in enumerate(data["friction_coefficient"].values):
        color = CYCLE[k % len(CYCLE)]
        one = data.isel(friction_coefficient=k)
        left.plot(one["balance_ratio"], one["loop_area_um_bar"], color=color, label=f"{mu:g}")
        on_film = np.isfinite(one["film_height_um"].values[:, top])
        gap = np.where(on_film, one["gap_um"].values[:, top], np.nan)
        right.plot(one["balance_ratio"], gap, color=color, label=f"{mu:g}")
    left.set_ylabel("Loop area (µm bar)")
    right.set_ylabel("Gap at the highest pressure (µm)")
    _decades(right)
    for axes in (left, right):
        axes.set_xlabel("Balance ratio")
    left.legend(title="Housing friction", fontsize=7)
    return figure
