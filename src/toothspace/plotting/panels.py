"""What figures of studies share: panels for numbers, and labels of keys and numbers."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np

from toothspace.plotting.style import new_figure
from toothspace.results.summary_names import label_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

MAIN_NUMBERS = (
    "volumetric_efficiency",
    "hydromechanical_efficiency",
    "mean_flow_L_per_min",
    "mean_torque_N_m",
    "flow_ripple_percent",
    "max_chamber_pressure_bar",
)
"""Numbers that a sweep shows."""
_MOST_LINES = 8
_UNITS = {"um": "µm", "degC": "°C", "deg": "°", "1": ""}


@final
@dataclass(frozen=True)
class StudyFigure:
    """A figure of a study with its caption."""

    name: str
    caption: str
    figure: Figure


def number_panels(data: xr.Dataset) -> tuple[Figure, list[tuple[Axes, str]]]:
    """Figure with one panel for each main number."""
    figure, panels = panels_of(shown_numbers(data), 2, 0.4, 2.4)
    for axes, name in panels:
        axes.set_ylabel(axis_title(name))
    return figure, panels


def panels_of(
    names: Sequence[str], columns: int, margin: float, height: float, *, sharex: bool = False
) -> tuple[Figure, list[tuple[Axes, str]]]:
    """Figure with one panel for each name; heights of margin and rows in inches."""
    rows = -(-len(names) // columns)
    figure = new_figure(7.2, margin + height * rows)
    flat = list(figure.subplots(rows, columns, squeeze=False, sharex=sharex).flat)
    for axes in flat[len(names) :]:
        axes.set_visible(False)
    return figure, list(zip(flat, names, strict=False))


def shown_numbers(data: xr.Dataset) -> list[str]:
    """Main numbers, or else the first of all."""
    numbers = [str(name) for name in data.data_vars if data[name].dtype.kind == "f"]
    results = [name for name in numbers if "." not in name]
    return [name for name in MAIN_NUMBERS if name in results] or results[: len(MAIN_NUMBERS)]


def has_numbers(data: xr.Dataset, *names: str) -> bool:
    """Whether a study has numbers of all names."""
    return all(name in data and np.isfinite(data[name]).any() for name in names)


def spread(count: int) -> list[int]:
    """Some of many lines, the first and the last among them."""
    shown = np.linspace(0, count - 1, min(count, _MOST_LINES))
    return [round(k) for k in shown.tolist()]


def axis_title(name: str) -> str:
    """Name of a number with its unit, as the title of an axis."""
    text = label_of(name)
    return text[:1].upper() + text[1:]


def key_title(data: xr.Dataset, path: str) -> str:
    """Last words of a key path with its unit, as the title of an axis."""
    unit = shown_unit(data, path)
    return f"{short_name(path)} ({unit})" if unit else short_name(path)


def shown_unit(data: xr.Dataset, path: str) -> str:
    """Unit of a varied key as it is shown."""
    unit = str(data[path].attrs.get("units", "1"))
    return _UNITS.get(unit, unit)


def short_name(path: str) -> str:
    """Last words of a key path."""
    return " ".join(path.split(".")[-2:]).replace("_", " ").capitalize()
