"""Tables of a machine over the angle, and deviations of its flanks."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np
import xarray as xr

from toothspace.core.types import Array, IntArray
from toothspace.geometry.involute_fit import InvoluteFit, ProfileDeviation
from toothspace.model.description import ChamberFamily, MachineDescription
from toothspace.model.path_category import OPENINGS, PathCategory
from toothspace.plotting.style import (
    BLUE,
    CYCLE,
    GREY,
    INK,
    LIGHT,
    angle_axis,
    new_figure,
    readable,
    styled,
)

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LEAST_RANGE = 1.0
"""Of the axis, so that a perfect flank looks like one. [um]"""


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
    upper.set(title="Chamber volume and its derivative", ylabel="Volume (mm³)", ylim=(0.0, None))
    figure.legend(loc="outside upper right", ncols=len(families))
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


@styled
def groove_timing(description: MachineDescription) -> Figure:
    """When every chamber is open to which port over one turn of the shaft, and its volume.

    One row for each chamber of the first family that ports open; a row without a bar at an
    angle is sealed there. Below, openings and volume of the first one about its smallest volume.
    """
    family = next(f for f in description.families if _has_ports(description, f))
    figure = new_figure(7.2, 7.4)
    rows, below = figure.subplots(2, 1, height_ratios=(3, 2))
    shown = [c for c in openings_of(description) if opening_windows(description, family, c)]
    for k, phase in enumerate(family.phases):
        for j, category in enumerate(shown):
            for start, end in opening_windows(description, family, category):
                # shaft angles within one turn at which the chamber's own window is open
                ratio, period = family.angle_ratio, family.volume.period
                found = []
                for turn in range(-2, 3):
                    begin = np.degrees((start - float(phase) + turn * period) / ratio)
                    last = begin + np.degrees((end - start) / ratio)
                    low, high = max(float(begin), 0.0), min(float(last), 360.0)
                    if high > low:
                        found.append((low, high - low))
                for first, width in found:
                    place = (k + 0.22 * (j - 0.5 * (len(shown) - 1)) - 0.1, 0.2)
                    rows.broken_barh([(first, width)], place, color=category.colour)
    rows.set_yticks(range(family.count), [str(k) for k in range(family.count)])
    rows.set_ylabel(f"{readable(family.name)} (number)")
    rows.set_title("Openings of every chamber")
    rows.grid(visible=False, axis="y")
    angle_axis(rows)
    _draw_mesh_window(below, description, family, shown)
    handles = [below.plot([], [], color=c.colour, linewidth=5.0)[0] for c in shown]
    labels = [readable(c.label) for c in shown]
    figure.legend(handles, labels, loc="outside upper right", ncols=4)
    return figure


def _draw_mesh_window(
    axes: Axes,
    description: MachineDescription,
    family: ChamberFamily,
    shown: Sequence[PathCategory],
) -> None:
    """Openings and volume of a chamber about the angle of its smallest volume."""
    period = family.volume.period
    fine = np.linspace(0.0, period, 1441)
    middle = float(fine[np.argmin(family.volume(fine)[:, 0])])
    half = min(0.5 * period, 1.5 * period / family.count)
    angle = np.linspace(-half, half, 721)
    own = np.mod(middle + angle, period)
    degrees = np.degrees(angle / family.angle_ratio)
    sealed = np.ones(angle.size, dtype=bool)
    for category in shown:
        area = opening_area(description, family, category, own) * 1e6
        sealed &= area <= 0.0
        axes.plot(degrees, area, color=category.colour)
    axes.set_ylim(bottom=0.0)
    axes.fill_between(
        degrees, 0.0, 1.0, where=sealed, transform=axes.get_xaxis_transform(), color=LIGHT
    )
    axes.set_ylabel("Open area (mm²)")
    axes.set_xlabel("Shaft angle from the smallest volume (deg); shaded: sealed from both ports")
    twin = axes.twinx()
    twin.plot(degrees, family.volume(own)[:, 0] * 1e9, color=INK, linestyle="--")
    twin.set(ylabel="Volume (mm³), dashed", ylim=(0.0, None))
    twin.grid(visible=False)


def _has_ports(description: MachineDescription, family: ChamberFamily) -> bool:
    angle = np.linspace(0.0, family.volume.period, 61)
    return any(
        float(opening_area(description, family, category, angle).max()) > 0.0
        for category in openings_of(description)
    )


@styled
def flank_deviation(fits: Mapping[str, InvoluteFit]) -> Figure:
    """Deviation of both flanks of every gear over the roll length, excess material to the right.

    One row for each gear, root below, tip above.

    Parameters
    ----------
    fits : mapping
        Fit of each gear by its name.
    """
    figure = new_figure(7.2, 0.8 + 3.2 * len(fits))
    rows = np.reshape(figure.subplots(len(fits), 2, sharey="row", sharex="row"), (-1, 2))
    for (name, fit), row in zip(fits.items(), rows, strict=True):
        _flank(row[0], f"{name}\nleft flank", fit.left)
        _flank(row[1], "right flank", fit.right)
        row[0].set_ylabel("Roll length (mm)")
    return figure


def _flank(axes: Axes, title: str, deviation: ProfileDeviation) -> None:
    axes.axvline(0.0, color=GREY, linewidth=0.8)
    axes.plot(deviation.deviation * 1e6, deviation.roll_length * 1e3, color=BLUE)
    axes.set_title(title)
    low, high = axes.get_xlim()
    axes.set_xlim(min(low, -_LEAST_RANGE), max(high, _LEAST_RANGE))
    axes.locator_params(axis="x", nbins=5)
    axes.set_xlabel(
        f"Deviation (µm)   Fα {1e6 * deviation.total:.2f}, ffα {1e6 * deviation.form:.2f}, "
        f"fHα {1e6 * deviation.slope:.2f}",
        fontsize=8.0,
    )


def openings_of(description: MachineDescription) -> list[PathCategory]:
    """Categories of the paths that open chambers to ports and grooves: inlet, outlet, grooves."""
    found = [c for c in description.path_categories if c.role in OPENINGS]
    return sorted(found, key=lambda category: OPENINGS.index(category.role))


def opening_area(
    description: MachineDescription, family: ChamberFamily, category: PathCategory, angle: Array
) -> Array:
    """Open area between one chamber and all paths of a category.

    Area; zero where nothing is open. [m2]

    Parameters
    ----------
    angle : ndarray
        Table angle of the chamber. [rad]
    """
    names = [other.name for other in description.families]
    first = sum(other.count for other in description.families[: names.index(family.name)])
    area = np.zeros_like(angle)
    for path in description.paths:
        if path.category != category or path.kind != "orifice":
            continue
        for member in np.flatnonzero((path.nodes_a == first) | (path.nodes_b == first)):
            scale = path.angle_ratio / family.angle_ratio
            offset = float(path.phases[member] - scale * family.phases[0])
            area = area + path.multiplicity * path.geometry(scale * angle + offset)[..., 0]
    return area


def opening_windows(
    description: MachineDescription, family: ChamberFamily, category: PathCategory
) -> list[tuple[float, float]]:
    """Intervals of the chamber's table angle in which a category is open. [rad]."""
    angle = np.linspace(0.0, family.volume.period, 721)
    area = opening_area(description, family, category, angle)
    opened = area > 1e-4 * max(float(area.max()), 1e-12)
    edges = np.flatnonzero(np.diff(np.concatenate([[False], opened, [False]]).astype(int)))
    return [
        (float(angle[start]), float(angle[end - 1]))
        for start, end in zip(edges[::2], edges[1::2], strict=True)
    ]


def one_chamber(
    data: xr.Dataset, description: MachineDescription, family: ChamberFamily
) -> tuple[Array, IntArray, IntArray]:
    """Angles of a chamber over its turn with the sample and the chamber that show them.

    In one turn of the shaft a chamber may not come round; the ones behind it, which are alike,
    show the rest.

    Returns
    -------
    ndarray
        Table angle of the chamber, ascending. [rad]
    ndarray
        Samples along the shaft angle.
    ndarray
        Columns of the chambers.
    """
    shaft_angle = np.asarray(data["shaft_angle"])
    last = np.flatnonzero(shaft_angle >= shaft_angle[-1] - 2.0 * np.pi)
    first = description.chamber_labels.index(f"{family.name}_0")
    step = abs(family.angle_ratio) * float(np.median(np.diff(shaft_angle)))
    own = family.phases + family.angle_ratio * shaft_angle[last, None]
    own = np.mod(own, family.volume.period)
    found: list[tuple[float, int, int]] = []
    shown = np.zeros(round(family.volume.period / step) + 1, dtype=bool)
    for chamber in range(family.count):
        places = np.round(own[:, chamber] / step).astype(int)
        new = np.flatnonzero(~shown[places])
        found += [(own[k, chamber], int(last[k]), first + chamber) for k in new]
        shown[places] = True
    found.sort()
    angle, sample, column = zip(*found, strict=True)
    return np.array(angle), np.array(sample), np.array(column)
