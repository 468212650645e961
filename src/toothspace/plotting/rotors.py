"""Gerotor results: life of a pocket, contacts of the teeth, shaft torque and its parts."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from toothspace.model.description import MachineDescription
from toothspace.plotting.style import (
    BLUE,
    CYCLE,
    GREEN,
    GREY,
    INK,
    ORANGE,
    angle_axis,
    new_figure,
    styled,
)
from toothspace.plotting.windows import one_chamber
from toothspace.results.ripple import high_pass, wave, whole_revolutions
from toothspace.results.solution import Solution
from toothspace.results.tooth_contacts import LOADED_SHARE

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.projections.polar import PolarAxes

_BAR = 1e5
_TURN = 2.0 * np.pi


@styled
def pocket_cycle(solution: Solution, description: MachineDescription) -> Figure:
    """Pressure, volume and open port areas of one pocket over the outer rotor's angle."""
    data = solution.data
    angle, sample, chamber = one_chamber(data, description, description.families[0])
    degrees = np.degrees(angle)
    figure = new_figure(7.2, 5.6)
    pressure, volume, area = figure.subplots(3, 1, sharex=True)
    pressure.plot(degrees, np.asarray(data["chamber_pressure"])[sample, chamber] / _BAR, color=BLUE)
    pressure.set(ylabel="Pressure (bar)", title="One pocket over a turn of the outer rotor")
    volume.plot(degrees, 1e6 * np.asarray(data["chamber_volume"])[sample, chamber], color=INK)
    volume.set_ylabel("Volume (cm³)")
    for port, color in (("inlet", BLUE), ("outlet", ORANGE)):
        opening = np.asarray(data["opening_area"].sel(port=port))[sample, chamber]
        area.plot(degrees, 1e6 * opening, color=color, label=port)
    area.set_ylabel("Port area (mm²)")
    area.legend(loc="upper right", ncols=2)
    angle_axis(area, "Angle of the outer rotor (deg)")
    return figure


@styled
def tooth_contact_forces(solution: Solution) -> Figure:
    """Contact force of every tooth over the shaft angle, and how many teeth are loaded."""
    found = solution.tooth_contacts()
    angle = np.asarray(solution.data["shaft_angle"])
    degrees = np.degrees(angle - angle[0])
    figure = new_figure(7.2, 4.2)
    force, count = figure.subplots(2, 1, sharex=True, height_ratios=(3, 1))
    for k, values in enumerate(found.force.T):
        color = CYCLE[k % len(CYCLE)]
        force.plot(degrees, values, color=color, linewidth=1.2, label=f"tooth {k + 1}")
    force.plot(degrees, found.force.sum(axis=1), color=GREY, linestyle="--", label="sum")
    force.set(ylabel="Contact force (N)", title="Contact force of the outer rotor's teeth")
    force.legend(loc="upper left", bbox_to_anchor=(1.01, 1.0), borderaxespad=0.0, fontsize=7.5)
    loaded = found.loaded
    count.fill_between(degrees, loaded, step="mid", color=BLUE, alpha=0.35, linewidth=0.0)
    count.set_ylabel("Loaded teeth (-)")
    count.set_yticks(range(int(loaded.max()) + 2))
    angle_axis(count, span=float(degrees[-1]))
    return figure


@styled
def contact_span(solution: Solution) -> Figure:
    """Contact force over the place of a tooth, with the pitch of single-contact theory."""
    found = solution.tooth_contacts()
    figure = new_figure(5.6, 4.6)
    axes: PolarAxes = figure.add_subplot(projection="polar")  # type: ignore[assignment]
    axes.set_theta_zero_location("N")
    place, force = found.place.ravel(), found.force.ravel()
    bins = np.linspace(0.0, _TURN, 361)
    count, _ = np.histogram(place, bins)
    total, _ = np.histogram(place, bins, weights=force)
    mean = np.asarray(total / np.maximum(count, 1))
    middle = 0.5 * (bins[:-1] + bins[1:])
    threshold = LOADED_SHARE * found.mean_total
    axes.bar(middle, np.where(mean > threshold, mean, 0.0), width=bins[1], color=BLUE)
    # one pitch about the centre of the load: what one tooth after the other would need
    center, half = float(np.angle(np.sum(mean * np.exp(1j * middle)))), np.pi / found.force.shape[1]
    arc = np.linspace(center - half, center + half, 40)
    radius = np.full(arc.size, 1.1 * float(mean.max()))
    axes.plot(arc, radius, color=ORANGE, linewidth=3.0, label="one pitch")
    axes.plot([], [], color=BLUE, linewidth=5.0, label="contact force (N)")
    axes.set_ylim(0.0, 1.25 * float(mean.max()) or 1.0)
    axes.set_title(f"Loaded over {found.span:.2f} pitches")
    axes.set_rlabel_position(np.degrees(center) + 180.0)
    axes.set_xticks(np.radians(range(0, 360, 45)))
    axes.legend(loc="lower center", bbox_to_anchor=(0.5, -0.18), ncols=2)
    return figure


@styled
def torque_ripple(solution: Solution, description: MachineDescription) -> Figure:
    """Shaft torque over a turn, as it is and high-pass filtered like a measurement."""
    angle, torque = wave(solution.data, "shaft_torque")
    lowest = 0.5 * (description.families[0].count - 1)
    uniform, filtered = high_pass(angle, torque, lowest)
    _, raw, revolutions = whole_revolutions(angle, torque)
    last = slice(-(uniform.size // revolutions), None)
    degrees = np.degrees(uniform[last] - uniform[last][0])
    figure = new_figure(7.2, 4.2)
    upper, lower = figure.subplots(2, 1, sharex=True)
    upper.plot(degrees, raw[last], color=GREEN)
    upper.axhline(float(raw[last].mean()), color=GREY, linewidth=0.8, linestyle="--")
    upper.set_ylabel("Shaft torque (N m)")
    upper.set_title(f"Shaft torque, and without orders below {lowest:g}")
    lower.plot(degrees, filtered[last], color=GREEN)
    lower.set_ylabel("High-passed (N m)")
    angle_axis(lower)
    return figure
