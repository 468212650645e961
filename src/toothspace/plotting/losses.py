"""Where the power goes: torque and power losses, leakage, ledger."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING

import numpy as np

from toothspace.model.description import MachineDescription
from toothspace.plotting.style import (
    BLUE,
    GREEN,
    GREY,
    INK,
    ORANGE,
    PURPLE,
    new_figure,
    readable,
    styled,
)
from toothspace.results.ledger import LedgerRow, loss_causes, power_ledger
from toothspace.results.performance import means_by_label
from toothspace.results.solution import Solution

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_LITRE_PER_MINUTE = 6e4


@styled
def torque_breakdown(solution: Solution, description: MachineDescription | None = None) -> Figure:
    """Friction torque at the shaft by mechanism."""
    torques = means_by_label(solution.data, "torque_loss")
    return _bar_figure(torques, "Friction torque by mechanism", "Torque at the shaft (N m)", ORANGE)


@styled
def leakage_by_path(solution: Solution, description: MachineDescription | None = None) -> Figure:
    """Mean leakage by kind of path."""
    leakages = means_by_label(solution.data, "leakage")
    names = list(leakages)
    labels = _of_paths(solution, "path_label", names)
    flows = {labels[name]: value * _LITRE_PER_MINUTE for name, value in leakages.items()}
    colours = _of_paths(solution, "path_colour", [BLUE] * len(names))
    by_label = {readable(labels[name]): colours[name] for name in names}
    return _bar_figure(flows, "Leakage by path", "Mean leakage (L/min)", by_label)


def _of_paths(solution: Solution, name: str, otherwise: Sequence[str]) -> dict[str, str]:
    """Text that the machine gives each leakage path, by the name of the path."""
    if "path" not in solution.data:
        return {}
    found = solution.data[name].values if name in solution.data else otherwise
    paths = solution.data["path"].values
    return {str(path): str(text) for path, text in zip(paths, found, strict=True)}


@styled
def loss_bars(solution: Solution, description: MachineDescription | None = None) -> Figure:
    """Every loss by cause, largest first."""
    losses = {f"{c.cause}, {c.label}": c.power for c in loss_causes(solution.ledger)}
    return _bar_figure(losses, "Power losses", "Power (W)", PURPLE)


def _bar_figure(
    values: Mapping[str, float], title: str, label: str, color: str | Mapping[str, str]
) -> Figure:
    shown = {readable(name): value for name, value in values.items() if value != 0.0}
    ordered = dict(sorted(shown.items(), key=lambda item: item[1]))
    figure = new_figure(7.2, 1.1 + 0.27 * max(len(ordered), 2))
    axes = figure.subplots()
    colours = [color if isinstance(color, str) else color[name] for name in ordered]
    bars = axes.barh(list(ordered), list(ordered.values()), color=colours, height=0.62)
    axes.bar_label(bars, fmt=_digits, padding=4, fontsize=8, color=INK)
    axes.grid(visible=False, axis="y")
    axes.tick_params(axis="y", length=0)
    axes.margins(x=0.12)
    axes.set(title=title, xlabel=label)
    return figure


def _digits(value: float) -> str:
    return f"{value:.3g}" if abs(value) < 100.0 else f"{value:.0f}"


@styled
def ledger_waterfall(solution: Solution, description: MachineDescription | None = None) -> Figure:
    """From supplied power, loss by loss, to delivered power."""
    rows = power_ledger(solution.ledger)
    supplied = next(row for row in rows if row.kind == "supplied")
    delivered = next(row for row in rows if row.kind == "delivered")
    causes = sorted(loss_causes(solution.ledger), key=lambda entry: -entry.power)
    powers = [(f"{c.cause}, {c.label}", c.power) for c in causes]
    powers += [(row.label, row.power) for row in rows if row.kind == "stored"]
    # steps above 2 % of all, the others in one
    least = 0.02 * sum(abs(power) for _, power in powers)
    steps = [(readable(name), power) for name, power in powers if abs(power) > least]
    rest = sum(power for _, power in powers if abs(power) <= least)
    if rest != 0.0:
        steps.append(("Others", rest))
    figure = new_figure(7.2, 4.2)
    axes = figure.subplots()
    _draw_waterfall(axes, supplied, steps, delivered)
    axes.set(ylabel="Power (W)", title="Power ledger")
    axes.tick_params(axis="x", rotation=40, length=0)
    for label in axes.get_xticklabels():
        label.set_horizontalalignment("right")
        label.set_rotation_mode("anchor")
    axes.grid(visible=False, axis="x")
    return figure


def _draw_waterfall(
    axes: Axes, supplied: LedgerRow, steps: Sequence[tuple[str, float]], delivered: LedgerRow
) -> None:
    ends = f"Supplied ({supplied.label})", f"Delivered ({delivered.label})"
    names = [ends[0], *(name for name, _ in steps), ends[1]]
    drops = np.array([power for _, power in steps])
    level = supplied.power - np.concatenate([[0.0], np.cumsum(drops)])
    bottoms = np.concatenate([[0.0], level[1:], [0.0]])
    heights = np.concatenate([[supplied.power], drops, [delivered.power]])
    colors = [BLUE, *([ORANGE] * len(steps)), GREEN]
    axes.bar(np.arange(len(names)), heights, bottom=bottoms, color=colors, width=0.66)
    for k in range(len(names) - 1):
        axes.plot([k + 0.33, k + 0.67], [level[k], level[k]], color=GREY, linewidth=0.8)
    for k, height in enumerate(heights):
        top = bottoms[k] + max(height, 0.0)
        axes.annotate(
            _digits(height), (k, top), (0, 3), textcoords="offset points", ha="center", fontsize=7.5
        )
    axes.set_xticks(np.arange(len(names)), names)
    losses = supplied.power - min(float(level[-1]), delivered.power)
    if losses < 0.5 * supplied.power:
        axes.set_ylim(max(0.0, delivered.power - 0.6 * losses), supplied.power + 0.15 * losses)
        axes.annotate(
            "axis does not start at zero",
            (0.99, 0.97),
            xycoords="axes fraction",
            ha="right",
            va="top",
            fontsize=8,
            color=GREY,
        )
