"""Tables of a machine: volumes, their derivatives and openings over the angle."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from toothspace.model.description import ChamberFamily, MachineDescription
from toothspace.plotting.style import (
    CYCLE,
    angle_axis,
    new_figure,
    readable,
    styled,
)
from toothspace.plotting.windows import opening_area, openings_of

if TYPE_CHECKING:
    from matplotlib.figure import Figure


@styled
def volumes(description: MachineDescription) -> Figure:
    """Volume of a chamber and its derivative over the chamber's own angle."""
    figure = new_figure(7.2, 4.4)
    upper, lower = figure.subplots(2, 1, sharex=True)
    families = [f for f in description.families if np.any(f.volume.slopes)]
    for k, (family, color) in enumerate(zip(families, CYCLE, strict=False)):
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
    families = [f for f in description.families if _has_ports(description, f)]
    figure = new_figure(7.2, 1.2 + 2.0 * len(families))
    all_axes = np.ravel(figure.subplots(len(families), 1))
    for axes, family in zip(all_axes, families, strict=True):
        angle = np.linspace(0.0, family.volume.period, 721)
        for category in openings_of(description):
            area = opening_area(description, family, category, angle) * 1e6
            if float(area.max()) > 0.0:
                area[area == 0.0] = np.nan
                degrees = np.degrees(angle)
                axes.fill_between(degrees, area, color=category.colour, alpha=0.15, linewidth=0.0)
                axes.plot(degrees, area, color=category.colour, label=readable(category.label))
        axes.set_ylabel("Open area (mm²)")
        axes.set_ylim(bottom=0.0)
        axes.set_title(f"Openings: {readable(family.name).lower()}")
        angle_axis(axes, "Chamber angle (deg)", float(np.degrees(angle[-1])))
    if all_axes[0].get_legend_handles_labels()[0]:
        figure.legend(*all_axes[0].get_legend_handles_labels(), loc="outside upper right", ncols=4)
    return figure


def _has_ports(description: MachineDescription, family: ChamberFamily) -> bool:
    angle = np.linspace(0.0, family.volume.period, 61)
    return any(
        float(opening_area(description, family, category, angle).max()) > 0.0
        for category in openings_of(description)
    )
