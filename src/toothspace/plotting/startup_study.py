"""Figures of the start-up study: ratio over plateau speed, breakaway over the start angle."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from toothspace.plotting.style import BLUE, GREEN, GREY, ORANGE, new_figure, styled

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.figure import Figure

_RPM = 30.0 / np.pi
PAPER_RATIO = 4.0
"""Start-up over running pressure in measurements of Pawar, Vacca and Rigosi. [-]"""


@styled
def ratio_over_plateau_speed(data: xr.Dataset) -> Figure:
    """Start-up pressure over running pressure, over the plateau speed of the supply."""
    figure = new_figure(7.2, 5.2)
    ratio, pressure = figure.subplots(2, 1, sharex=True)
    speed = data["plateau_speed"].values * _RPM
    for name, label, color in (
        ("startup_pressure_ratio", "over largest running pressure", BLUE),
        ("startup_to_settled_ratio", "over settled pressure", GREEN),
    ):
        ratio.plot(speed, data[name].mean("start_angle").values, "o-", color=color, label=label)
    ratio.axhline(PAPER_RATIO, color=GREY, linewidth=0.8, linestyle="--")
    ratio.set(ylabel="Start-up pressure ratio (-)", title="Start-up pressure over running pressure")
    ratio.legend(loc="upper right")
    for name, label, color in (
        ("startup_pressure_bar", "Start-up", ORANGE),
        ("max_running_pressure_bar", "Largest running", BLUE),
        ("settled_pressure_bar", "Settled", GREEN),
    ):
        values = data[name].mean("start_angle").values
        pressure.plot(speed, values, "o-", color=color, label=label)
    pressure.set(ylabel="Pressure (bar)", xlabel="Plateau speed (rpm)")
    pressure.legend(loc="upper center", ncols=3)
    return figure


@styled
def breakaway_over_angle(data: xr.Dataset) -> Figure:
    """Pressure at which the shaft breaks away, over the start angle."""
    figure = new_figure(7.2, 3.2)
    axes = figure.subplots()
    angle = np.degrees(data["start_angle"].values)
    mean = data["breakaway_pressure_bar"].mean("plateau_speed").values
    axes.plot(angle, mean, "o-", color=ORANGE)
    axes.axhline(float(np.nanmean(mean)), color=GREY, linewidth=0.8, linestyle="--")
    axes.set_xlabel("Start angle (deg)")
    axes.set_ylabel("Breakaway pressure (bar)")
    axes.set_title("Breakaway over one tooth pitch")
    return figure
