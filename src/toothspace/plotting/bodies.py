"""Motion of the bodies, forces on them and what they cut out of the casing."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

from toothspace.core.types import Array
from toothspace.model.description import MachineDescription
from toothspace.plotting.section import port_side
from toothspace.plotting.style import BLUE, CYCLE, GREY, LIGHT, ORANGE, new_figure, readable, styled
from toothspace.results.solution import Solution

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


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
                _clearance_circle(circle, seat, clearance)
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


def _clearance_circle(axes: Axes, seat: Array, clearance: float) -> None:
    turn = np.linspace(0.0, 2.0 * np.pi, 181)
    circle = seat[:, None] + clearance * np.array([np.cos(turn), np.sin(turn)])
    axes.fill(*circle, color=LIGHT, alpha=0.6, linewidth=0.0, zorder=0)
    axes.plot(*circle, color=GREY, linewidth=1.0)
    axes.plot(*seat[:, None], "+", color=GREY, markersize=8)


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
    bodies = [str(body) for body in depth["body"].values if float(depth.sel(body=body).max()) > 0.0]
    figure = new_figure(7.2, 5.6)
    grid = figure.add_gridspec(2, max(len(bodies), 1), height_ratios=(3, 2))
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
