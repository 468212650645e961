"""Motion of the bodies, forces on them, what they cut, and what rotors do over a turn."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from toothspace.model.description import MachineDescription
from toothspace.plotting.geometry import one_chamber
from toothspace.plotting.section import port_side
from toothspace.plotting.style import (
    BLUE,
    CYCLE,
    GREEN,
    GREY,
    INK,
    LIGHT,
    ORANGE,
    angle_axis,
    new_figure,
    readable,
    styled,
)
from toothspace.results.ripple import high_pass, wave, whole_revolutions
from toothspace.results.solution import Solution
from toothspace.results.tooth_contacts import LOADED_SHARE

if TYPE_CHECKING:
    from matplotlib.figure import Figure
    from matplotlib.projections.polar import PolarAxes

_BAR = 1e5
_TURN = 2.0 * np.pi


@styled
def journal_orbits(solution: Solution, description: MachineDescription | None = None) -> Figure:
    """Orbit of each body in the clearance circle of its journal bearings, and magnified."""
    bodies = _bodies(solution, "body_position")
    figure = new_figure(3.6 * max(len(bodies), 2), 5.9)
    grid = figure.subplots(2, len(bodies), squeeze=False, height_ratios=(3, 2))
    for (circle, orbit), body in zip(grid.T, bodies, strict=True):
        position = solution.data["body_position"].sel(body=body)
        x, y = (1e6 * np.asarray(position.sel(axis=axis)) for axis in ("x", "y"))
        seat = np.zeros(2)
        if "seat_position" in solution.data:
            seat = 1e6 * np.asarray(solution.data["seat_position"].sel(body=body, axis=["x", "y"]))
        if "block_position" in solution.data:
            moving = np.asarray(solution.data["block_position"].sel(axis=["x", "y"]))
            seat = 1e6 * moving.mean(axis=0)
        title = readable(body)
        for journal in () if description is None else description.journals:
            if journal.body == body:
                clearance = 1e6 * journal.radial_clearance
                turn = np.linspace(0.0, 2.0 * np.pi, 181)
                ring = seat[:, None] + clearance * np.array([np.cos(turn), np.sin(turn)])
                circle.fill(*ring, color=LIGHT, alpha=0.6, linewidth=0.0, zorder=0)
                circle.plot(*ring, color=GREY, linewidth=1.0)
                circle.plot(*seat[:, None], "+", color=GREY, markersize=8)
                title = f"{title}, clearance {clearance:.3g} µm"
        for axes in (circle, orbit):
            axes.plot(x, y, color=BLUE, linewidth=1.2)
            (mean,) = axes.plot(np.mean(x), np.mean(y), "o", color=ORANGE, markersize=4)
            axes.set_ylabel("y (µm)")
        circle.set_aspect("equal", adjustable="datalim")
        circle.set_title(title)
        circle.locator_params(nbins=6)
        orbit.set_title("Magnified", fontweight="normal", fontsize=9)
        orbit.margins(0.15)
        orbit.ticklabel_format(useOffset=False)
        orbit.locator_params(axis="x", nbins=5)
        orbit.set_xlabel(f"x{_towards(description)} (µm)")
    figure.legend([mean], ["Mean position"], loc="outside upper right")
    return figure


def _towards(description: MachineDescription | None) -> str:
    """Where x points to, in words."""
    if description is None or description.chamber_outlines is None:
        return ""
    return f", towards the {'outlet' if port_side(description, 'outlet') > 0.0 else 'inlet'}"


def _bodies(solution: Solution, name: str) -> list[str]:
    """Return the bodies that move, or all of them if none does."""
    array = solution.data[name]
    names = [str(body) for body in array["body"].values]
    moving = [body for body in names if float(np.ptp(np.asarray(array.sel(body=body)))) > 0.0]
    return moving or names


@styled
def casing_wear(solution: Solution, description: MachineDescription | None = None) -> Figure:
    """Running-in depth of the casing: around each gear as it lies, and along the bore."""
    depth = 1e6 * solution.data["running_in_depth"]
    angle = np.asarray(solution.data["casing_angle"])
    bodies = _bodies(solution, "running_in_depth")
    figure = new_figure(7.2, 5.6)
    grid = figure.add_gridspec(2, len(bodies), height_ratios=(3, 2))
    linear = figure.add_subplot(grid[1, :])
    top = 1.1 * max(float(depth.max()), 1e-3)
    for k, (body, color) in enumerate(zip(bodies, CYCLE, strict=False)):
        values = np.asarray(depth.sel(body=body))
        polar = figure.add_subplot(grid[0, k], projection="polar")
        # from x towards y about the gear's axis; the first gear turns from x to y
        first = body == str(solution.data["body"].values[0])
        direction = angle - 0.5 * np.pi if first else 0.5 * np.pi - angle
        closed = np.append(direction, direction[0]), np.append(values, values[0])
        polar.plot(*closed, color=color)
        polar.fill(*closed, color=color, alpha=0.15)
        polar.set_ylim(0.0, top)
        polar.set_rlabel_position(60.0)  # type: ignore[attr-defined]
        polar.set_title(f"Depth (µm): {readable(body).lower()}", pad=14)
        around = np.degrees(np.mod(angle + np.pi, 2.0 * np.pi) - np.pi)
        order = np.argsort(around)
        linear.plot(around[order], values[order], color=color, label=readable(body))
    linear.set_ylabel("Depth (µm)")
    linear.set_ylim(0.0, top)
    linear.set_xlim(-180.0, 180.0)
    linear.set_xticks(np.arange(-180, 181, 45))
    linear.set_xlabel(
        "Inlet side  ←  angle along the bore, 0 opposite to the mesh (deg)  →  outlet side"
    )
    linear.legend(loc="upper right")
    return figure


@styled
def force_polar(solution: Solution, description: MachineDescription | None = None) -> Figure:
    """Direction and size of the pressure force on each body over a turn."""
    force = solution.data["body_force"]
    bodies = _bodies(solution, "body_force")
    figure = new_figure(3.6 * max(len(bodies), 2), 3.7)
    for k, body in enumerate(bodies):
        axes = figure.add_subplot(1, len(bodies), k + 1, projection="polar")
        x, y = (1e-3 * np.asarray(force.sel(body=body, axis=a)) for a in ("x", "y"))
        axes.plot(np.arctan2(y, x), np.hypot(x, y), color=BLUE, linewidth=1.2)
        mean_x, mean_y = float(np.mean(x)), float(np.mean(y))
        direction, size = np.arctan2(mean_y, mean_x), float(np.hypot(mean_x, mean_y))
        arrow = {"arrowstyle": "-|>", "color": ORANGE, "linewidth": 1.6, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", xy=(direction, size), xytext=(0.0, 0.0), arrowprops=arrow)
        axes.set_ylim(0.0, 1.15 * float(np.max(np.hypot(x, y))) or 1.0)
        axes.set_rlabel_position(np.degrees(direction) + 90.0)  # type: ignore[attr-defined]
        note = f"mean {size:.2f} kN at {np.degrees(direction) % 360:.0f}°"
        axes.set_title(f"{readable(body)}: {note}", pad=14)
    note = f"Pressure force (kN), 0° along x{_towards(description)}"
    figure.suptitle(note, x=0.01, ha="left", fontsize=9)
    return figure


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
