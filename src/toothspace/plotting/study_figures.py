"""Figures of studies, by the kind of the study."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from textwrap import fill
from typing import TYPE_CHECKING

import numpy as np

from toothspace.core.types import Array
from toothspace.plotting.bearing_figures import balance_figures, map_figures
from toothspace.plotting.contact_figures import contact_span_figures
from toothspace.plotting.lateral_figures import StudyFigure, hysteresis_figures, nose_figures
from toothspace.plotting.source_figures import source_figures
from toothspace.plotting.style import (
    BLUE,
    GREEN,
    GREY,
    INK,
    ORANGE,
    PRESSURE_COLOURS,
    contour_lines,
    new_figure,
    styled,
)
from toothspace.studies.tabulate import label_of

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

_EFFICIENCIES = (
    ("overall_efficiency", "Overall efficiency (%)"),
    ("hydromechanical_efficiency", "Hydromechanical efficiency (%)"),
    ("volumetric_efficiency", "Volumetric efficiency (%)"),
)
_CHARACTERISTICS = ("mean_flow_L_per_min", "mean_torque_N_m")
_RPM = 60.0 / (2.0 * np.pi)
_MOST_LINES = 8
_LABEL_WIDTH = 22
_SHOWN_RANGE = 40.0
"""Percent below the best efficiency that contour lines cover."""

_EFFECTS = {
    "rank_correlation": "Rank correlation",
    "first_order_index": "Share of the variance caused alone (first-order index)",
    "total_index": "Share of the variance with interactions (total index)",
}
_UNITS = {"um": "µm", "degC": "°C", "deg": "°", "1": ""}


def study_figures(kind: str, data: xr.Dataset) -> list[StudyFigure]:
    """Return all figures that the dataset of a study can give.

    Parameters
    ----------
    kind : str
        Value of ``study.kind``.
    data : xarray.Dataset
        Its dataset, see :class:`toothspace.studies.StudyResult`.
    """
    draw = _FIGURES.get(kind)
    return draw(data) if draw is not None else []


def _startup(data: xr.Dataset) -> list[StudyFigure]:
    found = []
    if _has(data, "startup_pressure_ratio", "settled_pressure_bar"):
        if data.sizes["plateau_speed"] > 1:
            caption = "Start-up over running pressure; dashed: the ratio that the paper measured."
            figure = ratio_over_plateau_speed(data)
            found.append(StudyFigure("startup_ratio", caption, figure))
        if data.sizes["start_angle"] > 1:
            caption = "Breakaway pressure over the start angle; dashed: its mean."
            found.append(StudyFigure("breakaway_angle", caption, breakaway_over_angle(data)))
    return found


def _efficiency_map(data: xr.Dataset) -> list[StudyFigure]:
    found = []
    if not _has(data, *(name for name, _ in _EFFICIENCIES), *_CHARACTERISTICS):
        return []
    if min(data.sizes["shaft_speed"], data.sizes["pressure_difference"]) > 1:
        caption = (
            "Lines of equal efficiency over shaft speed and pressure difference; "
            "dots are the computed points. White: a motor that must be driven, or no result."
        )
        found.append(StudyFigure("efficiency_map", caption, efficiency_contours(data)))
    caption = "Flow and torque over the pressure difference, one line per shaft speed."
    if "measured_shaft_speed" in data:
        caption += " Crosses: measured."
    found.append(StudyFigure("characteristics", caption, characteristics(data)))
    return found


@styled
def efficiency_contours(data: xr.Dataset) -> Figure:
    """Contours of the three efficiencies over shaft speed and pressure difference."""
    from matplotlib.ticker import MaxNLocator

    figure = new_figure(7.2, 8.6)
    speed = data["shaft_speed"].values * _RPM
    pressure = data["pressure_difference"].values * 1e-5
    panels = figure.subplots(3, 1, sharex=True)
    for axes, (name, title) in zip(panels, _EFFICIENCIES, strict=True):
        # below zero a motor is driven: it has no efficiency there
        values = np.ma.masked_invalid(np.where(data[name] > 0.0, 100.0 * data[name], np.nan).T)
        if values.count() > 3:
            high = float(values.max())
            low = max(float(values.min()), high - _SHOWN_RANGE)
            levels = MaxNLocator(10, steps=[1, 2, 5, 10], min_n_ticks=4).tick_values(low, high)
            contour_lines(axes, (speed, pressure, values), levels, cmap=PRESSURE_COLOURS)
        axes.plot(*map(np.ravel, np.meshgrid(speed, pressure)), ".", color=GREY, ms=3)
        axes.set(title=title, ylabel="Pressure difference (bar)")
    panels[-1].set_xlabel("Shaft speed (rpm)")
    return figure


@styled
def characteristics(data: xr.Dataset) -> Figure:
    """Flow and torque over the pressure difference, one line per shaft speed."""
    figure = new_figure(7.2, 3.6)
    pressure = data["pressure_difference"].values * 1e-5
    panels = figure.subplots(1, 2)
    for axes, name in zip(panels, _CHARACTERISTICS, strict=True):
        for k in _spread(data.sizes["shaft_speed"]):
            speed = float(data["shaft_speed"][k]) * _RPM
            axes.plot(pressure, data[name].values[k], "o-", ms=3, label=f"{speed:.4g} rpm")
        _lay_over(axes, data, name)
        axes.set(xlabel="Pressure difference (bar)", ylabel=_label(name))
    panels[1].legend()
    return figure


def _lay_over(axes: Axes, data: xr.Dataset, name: str) -> None:
    """Measured points in the colour of the nearest shaft speed that is shown."""
    if f"measured_{name}" not in data:
        return
    shown = list(_spread(data.sizes["shaft_speed"]))
    speeds = data["shaft_speed"].values[shown]
    lines = [line.get_color() for line in axes.lines]
    places = data["measured_pressure_difference"].values * 1e-5
    values = data[f"measured_{name}"].values
    for speed, x, y in zip(data["measured_shaft_speed"].values, places, values, strict=True):
        colour = lines[int(np.argmin(np.abs(speeds - speed)))]
        axes.plot(x, y, "x", color=colour, ms=6)


def _sweep(data: xr.Dataset) -> list[StudyFigure]:
    axes = [p for p in data.attrs["varied"].split() if data[p].dtype.kind in "fiu"]
    shape = [int(size) for size in data.attrs["shape"].split()]
    if not axes or not _shown_numbers(data):
        return []
    if len(axes) == len(shape) <= 2:
        caption = f"Results over {axes[0]}" + (f", one line per {axes[1]}." if axes[1:] else ".")
        return [StudyFigure("sweep", caption, sweep_lines(data, axes, shape))]
    return [
        StudyFigure(f"sweep_{path}", f"All points over {path}.", scatter(data, path))
        for path in axes
    ]


@styled
def sweep_lines(data: xr.Dataset, paths: Sequence[str], shape: Sequence[int]) -> Figure:
    """Main numbers over the first varied key, one line per value of the second."""
    sizes = (*shape, 1)[:2]
    x = data[paths[0]].values.reshape(sizes)
    second = data[paths[1]].values.reshape(sizes)[0] if len(paths) > 1 else None
    unit = _unit(data, paths[-1])
    figure, panels = _panels(data)
    for axes, name in panels:
        values = data[name].values.reshape(sizes)
        for k in _spread(sizes[1]):
            label = f"{second[k]:.4g} {unit}" if second is not None else None
            axes.plot(x[:, k], values[:, k], "o-", ms=3, label=label)
        axes.set_xlabel(_axis_label(data, paths[0]))
    if second is not None:
        panels[0][0].legend(title=paths[1].rpartition(".")[2].replace("_", " ").capitalize())
    return figure


@styled
def scatter(data: xr.Dataset, path: str) -> Figure:
    """Main numbers of all points over one varied key."""
    figure, panels = _panels(data)
    for axes, name in panels:
        axes.plot(data[path].values, data[name].values, ".", color=BLUE, ms=4)
        axes.set_xlabel(_axis_label(data, path))
    return figure


def _panels(data: xr.Dataset) -> tuple[Figure, list[tuple[Axes, str]]]:
    figure, panels = _panels_of(_shown_numbers(data), 2, 0.4, 2.4)
    for axes, name in panels:
        axes.set_ylabel(_label(name))
    return figure, panels


def _panels_of(
    names: Sequence[str], columns: int, margin: float, height: float, *, sharex: bool = False
) -> tuple[Figure, list[tuple[Axes, str]]]:
    """Figure with one panel for each name; heights of margin and rows in inches."""
    rows = -(-len(names) // columns)
    figure = new_figure(7.2, margin + height * rows)
    flat = list(figure.subplots(rows, columns, squeeze=False, sharex=sharex).flat)
    for axes in flat[len(names) :]:
        axes.set_visible(False)
    return figure, list(zip(flat, names, strict=False))


def _shown_numbers(data: xr.Dataset) -> list[str]:
    """Main numbers, or else the first of all."""
    numbers = [str(name) for name in data.data_vars if data[name].dtype.kind == "f"]
    results = [name for name in numbers if "." not in name]
    return [name for name in MAIN_NUMBERS if name in results] or results[: len(MAIN_NUMBERS)]


def _has(data: xr.Dataset, *names: str) -> bool:
    return all(name in data and np.isfinite(data[name]).any() for name in names)


def _spread(count: int) -> list[int]:
    """Some of many lines, the first and the last among them."""
    shown = np.linspace(0, count - 1, min(count, _MOST_LINES))
    return [round(k) for k in shown.tolist()]


def _label(name: str) -> str:
    text = label_of(name)
    return text[:1].upper() + text[1:]


def _axis_label(data: xr.Dataset, path: str) -> str:
    unit = _unit(data, path)
    return f"{_short(path)} ({unit})" if unit else _short(path)


def _unit(data: xr.Dataset, path: str) -> str:
    unit = str(data[path].attrs.get("units", "1"))
    return _UNITS.get(unit, unit)


def _tolerance(data: xr.Dataset) -> list[StudyFigure]:
    if not _shown_numbers(data):
        return []
    found = [
        StudyFigure("scatter", "Scatter of results; dashed: 5, 50 and 95 %.", histograms(data))
    ]
    for kind, words in _EFFECTS.items():
        if kind in data and np.isfinite(data[kind]).any():
            found.append(StudyFigure(kind, f"{words} of each varied key.", effect_bars(data, kind)))
    return found


@styled
def histograms(data: xr.Dataset) -> Figure:
    """Histograms of the main numbers with their percentiles."""
    figure, panels = _panels(data)
    for axes, name in panels:
        values = data[name].values[np.isfinite(data[name].values)]
        axes.hist(values, bins=max(5, min(30, round(np.sqrt(values.size)))), color=BLUE)
        for mark in np.percentile(values, (5.0, 50.0, 95.0)) if values.size else ():
            axes.axvline(float(mark), color=INK, ls="--", lw=0.9)
        axes.set(xlabel=axes.get_ylabel(), ylabel="Number of points")
    return figure


@styled
def effect_bars(data: xr.Dataset, kind: str) -> Figure:
    """Sensitivity of the main numbers to each varied key."""
    table = data[kind]
    names = [n for n in _shown_numbers(data) if n in table["result"].values]
    keys = [str(key) for key in table["key"].values]
    margin = 0.9 + 0.5 * len(names)
    figure, panels = _panels_of(names, 2, margin, 0.32 * len(keys), sharex=True)
    for axes, name in panels:
        values = np.nan_to_num(table.sel(result=name).values)
        axes.barh([_short(key) for key in keys], values, color=BLUE, height=0.6)
        axes.axvline(0.0, color=GREY, lw=0.8)
        axes.set_title(_label(name))
        axes.invert_yaxis()
    return figure


def _optimise(data: xr.Dataset) -> list[StudyFigure]:
    if data.sizes["point"] == 0:
        return []
    caption = (
        "Every point tried, in its order; grey: a constraint is broken; line: the best so far."
    )
    return [StudyFigure("search", caption, search_history(data))]


@styled
def search_history(data: xr.Dataset) -> Figure:
    """Objective of all points tried, and the varied keys."""
    paths = [p for p in data.attrs["varied"].split() if data[p].dtype.kind in "fiu"]
    figure = new_figure(7.2, 2.2 + 1.5 * len(paths))
    panels = figure.subplots(1 + len(paths), 1, sharex=True, squeeze=False)[:, 0]
    order, kept = data["point"].values, data["feasible"].values.astype(bool)
    upwards = data.attrs["goal"] == "maximise" and data.attrs["objective"] != "targets"
    merit = np.where(kept, data["merit"].values, np.nan)
    panels[0].plot(order, (np.fmax if upwards else np.fmin).accumulate(merit), color=INK, lw=1.0)
    shown = [("merit", _label(data.attrs["objective"]))]
    shown += [(path, _axis_label(data, path)) for path in paths]
    for axes, (name, label) in zip(panels, shown, strict=True):
        broken = np.logical_not(kept)
        axes.plot(order[broken], data[name].values[broken], ".", color=GREY, ms=3)
        axes.plot(order[kept], data[name].values[kept], ".", color=BLUE, ms=5)
        axes.set_ylabel(fill(label, _LABEL_WIDTH), fontsize=8)
    panels[-1].set_xlabel("Point")
    return figure


def _design_scan(data: xr.Dataset) -> list[StudyFigure]:
    if not data["feasible"].any():
        return []
    caption = "Designs that hold all constraints, over each varied key; orange: the best."
    return [StudyFigure("designs", caption, feasible_designs(data))]


@styled
def feasible_designs(data: xr.Dataset) -> Figure:
    """Objective of the feasible designs over each varied key."""
    name, kept = data.attrs["objective"], data["feasible"].values
    sign = 1.0 if data.attrs["goal"] == "maximise" else -1.0
    merit = data[name].values
    best = int(np.argmax(np.where(kept, sign * merit, -np.inf)))
    figure, panels = _panels_of(data.attrs["varied"].split(), 2, 0.4, 2.4)
    for axes, path in panels:
        axes.plot(data[path].values[kept], merit[kept], ".", color=BLUE, ms=2, rasterized=True)
        axes.plot(data[path].values[best], merit[best], "o", color=ORANGE, ms=6)
        axes.set_xlabel(_axis_label(data, path))
        axes.set_ylabel(_label(name))
    return figure


def _calibrate(data: xr.Dataset) -> list[StudyFigure]:
    names = [str(n).removeprefix("fitted_") for n in data.data_vars if str(n).startswith("fitted_")]
    if not names:
        return []
    caption = "Fitted against measured; open or grey marks were held out of the fit."
    return [StudyFigure("fit", caption, fit_comparison(data, names))]


@styled
def fit_comparison(data: xr.Dataset, names: Sequence[str]) -> Figure:
    """Fitted against measured: over time, or as deviations."""
    figure, panels = _panels_of(names, 1 if "time" in data else 2, 0.5, 2.6)
    used = data["used"].values.astype(bool)
    for axes, name in panels:
        (_over_time if "time" in data else _deviations)(axes, data, name, used)
    panels[0][0].legend()
    return figure


def _over_time(axes: Axes, data: xr.Dataset, name: str, used: Array) -> None:
    time = data["time"].values
    axes.plot(time[used], data[name].values[used], ".", color=INK, ms=3, label="measured")
    held = np.logical_not(used)
    axes.plot(time[held], data[name].values[held], ".", color=GREY, ms=3, label="held out")
    axes.plot(time, data[f"fitted_{name}"].values, color=ORANGE, lw=1.2, label="fitted")
    axes.set(xlabel="Time (s)", ylabel=_label(name))


def _deviations(axes: Axes, data: xr.Dataset, name: str, used: Array) -> None:
    x, held = data[name].values, np.logical_not(used)
    y = 100.0 * (data[f"fitted_{name}"].values - x) / (np.abs(x).mean() or 1.0)
    axes.axhline(0.0, color=GREY, lw=0.9)
    axes.plot(x[used], y[used], "o", color=BLUE, ms=4, label="used")
    axes.plot(x[held], y[held], "o", color=ORANGE, ms=4, mfc="white", label="held out")
    axes.set(xlabel=f"Measured {label_of(name)}", ylabel="Fitted minus measured (% of mean)")


def _short(path: str) -> str:
    return " ".join(path.split(".")[-2:]).replace("_", " ").capitalize()


_FIGURES: Mapping[str, Callable[..., list[StudyFigure]]] = {
    "balance_sweep": balance_figures,
    "bearing_map": map_figures,
    "calibrate": _calibrate,
    "contact_span": contact_span_figures,
    "source_ripple": source_figures,
    "design_scan": _design_scan,
    "efficiency_map": _efficiency_map,
    "hysteresis": hysteresis_figures,
    "nose_pressure": nose_figures,
    "optimise": _optimise,
    "startup": _startup,
    "sweep": _sweep,
    "tolerance": _tolerance,
}


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
