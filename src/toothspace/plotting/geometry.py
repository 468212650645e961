"""Tables of a machine: volumes, their derivatives and openings over the angle."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from toothspace.model.description import MachineDescription
from toothspace.plotting.style import (
    CYCLE,
    PORT_COLOURS,
    angle_axis,
    new_figure,
    readable,
    styled,
)
from toothspace.plotting.windows import opening_area

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@styled
def volumes(description: MachineDescription) -> Figure:
    """Volume of a chamber and its derivative over the chamber's own angle."""
    figure = new_figure(7.2, 4.4)
    upper, lower = figure.subplots(2, 1, sharex=True)
    for k, (family, color) in enumerate(zip(description.families, CYCLE, strict=False)):
        angle = np.linspace(0.0, family.volume.period, 1441)
        style = "-" if k == 0 else "--"
        label = readable(family.name)
        degrees = np.degrees(angle)
        upper.plot(degrees, family.volume(angle)[:, 0] * 1e9, style, color=color, label=label)
        slope = family.volume.derivative(angle)[:, 0] * family.angle_ratio
        lower.plot(degrees, slope * 1e9, style, color=color)
    upper.set_title("Chamber volume and its derivative")
    upper.set_ylabel("Volume (mm³)")
    upper.set_ylim(bottom=0.0)
    upper.legend(loc="lower right")
    lower.set_ylabel("dV/dφ (mm³/rad)")
    angle_axis(lower, "Chamber angle (deg)", float(degrees[-1]))
    return figure


@styled
def openings(description: MachineDescription) -> Figure:
    """Open areas of one chamber of each family to ports and grooves over its own angle."""
    families = description.families
    figure = new_figure(7.2, 1.2 + 2.0 * len(families))
    all_axes = np.ravel(figure.subplots(len(families), 1))
    for axes, family in zip(all_axes, families, strict=True):
        angle = np.linspace(0.0, family.volume.period, 721)
        for category, color in PORT_COLOURS.items():
            area = opening_area(description, family, category, angle) * 1e6
            if float(area.max()) > 0.0:
                area[area == 0.0] = np.nan
                degrees = np.degrees(angle)
                axes.fill_between(degrees, area, color=color, alpha=0.15, linewidth=0.0)
                axes.plot(degrees, area, color=color, label=readable(category))
        axes.set_ylabel("Open area (mm²)")
        axes.set_ylim(bottom=0.0)
        axes.set_title(f"Openings: {readable(family.name).lower()}")
        angle_axis(axes, "Chamber angle (deg)", float(np.degrees(angle[-1])))
    if all_axes[0].get_legend_handles_labels()[0]:
        figure.legend(*all_axes[0].get_legend_handles_labels(), loc="outside upper right", ncols=4)
    return figure
