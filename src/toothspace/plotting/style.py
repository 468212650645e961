"""One look for all figures: colours that colour-blind readers can tell apart, panels."""

from __future__ import annotations

import functools
import io
import math
import re
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec, TypeVar, final

import numpy as np

from toothspace.core.files import draft_of
from toothspace.core.types import Array
from toothspace.results.variables import label_of

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure


P = ParamSpec("P")
R = TypeVar("R")

BLUE = "#0072B2"
ORANGE = "#D55E00"
GREEN = "#009E73"
PURPLE = "#9467A8"
YELLOW = "#E69F00"
SKY = "#56B4E9"
BROWN = "#8C6D46"
INK = "#22303C"
GREY = "#8A949E"
LIGHT = "#E6EAED"
METAL = "#C9CFD4"

CYCLE = (BLUE, ORANGE, GREEN, PURPLE, YELLOW, SKY, BROWN, GREY)
"""Order of line colours (after Okabe and Ito, *Color Universal Design*, 2008)."""

PRESSURE_COLOURS = "YlGnBu"
"""Name of the colour map of pressures: light is low, dark is high."""

_RC: Mapping[str, object] = {
    "font.family": "sans-serif",
    "font.size": 9.0,
    "text.color": INK,
    "axes.edgecolor": GREY,
    "axes.labelcolor": INK,
    "axes.titlesize": 10.0,
    "axes.titleweight": "bold",
    "axes.titlelocation": "left",
    "axes.titlepad": 8.0,
    "axes.linewidth": 0.8,
    "axes.spines.top": False,
    "axes.spines.right": False,
    "axes.grid": True,
    "axes.axisbelow": True,
    "grid.color": LIGHT,
    "grid.linewidth": 0.7,
    "lines.linewidth": 1.5,
    "xtick.color": GREY,
    "ytick.color": GREY,
    "xtick.labelcolor": INK,
    "ytick.labelcolor": INK,
    "xtick.direction": "out",
    "legend.frameon": False,
    "legend.fontsize": 8.0,
    "figure.facecolor": "white",
    "savefig.facecolor": "white",
    "svg.fonttype": "path",
    "svg.hashsalt": "toothspace",
}
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


def styled(draw: Callable[P, R]) -> Callable[P, R]:
    """Make a drawing function use the style without touching global settings."""

    @functools.wraps(draw)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> R:
        import matplotlib as mpl
        from cycler import cycler

        with mpl.rc_context({**_RC, "axes.prop_cycle": cycler(color=CYCLE)}):  # type: ignore[dict-item]
            return draw(*args, **kwargs)

    return wrapper


def new_figure(width: float = 7.2, height: float = 3.4) -> Figure:
    """Make an empty figure that no window shows; size in inches."""
    from matplotlib.figure import Figure

    return Figure(figsize=(width, height), layout="constrained")


def contour_lines(axes: Axes, grid: tuple[Array, Array, Any], levels: Any, **fill: Any) -> None:
    """Filled contours with labelled lines of x, y and values."""
    from matplotlib.patheffects import withStroke

    axes.contourf(*grid, levels=levels, extend="both", **fill)
    lines = axes.contour(*grid, levels=levels, colors=INK, linewidths=0.6)
    for text in axes.clabel(lines, fmt="%g", fontsize=7):
        text.set_path_effects([withStroke(linewidth=2.0, foreground="white")])


def angle_axis(axes: Axes, label: str = "Shaft angle (deg)", span: float = 360.0) -> None:
    """Label an axis in degrees with ticks at round angles, for ``span`` degrees."""
    from matplotlib.ticker import MultipleLocator

    turns = math.ceil(span / 720.0)
    step = 90.0 * turns if turns > 1 else 60.0 if span > 200.0 else 10.0 if span > 40.0 else 5.0
    axes.set(xlabel=label, xlim=(0.0, span))
    axes.xaxis.set_major_locator(MultipleLocator(step))


def readable(name: str) -> str:
    """Turn a label such as ``journal_viscous`` into text for a reader."""
    return name.replace("_", " ").capitalize()


def html_table(rows: Mapping[str, Any]) -> str:
    """Return names and values as a table for notebooks."""
    lines = [
        f"<tr><th style='text-align:left'>{escape(name)}</th>"
        f"<td>{f'{value:.5g}' if isinstance(value, float) else escape(str(value))}</td></tr>"
        for name, value in rows.items()
    ]
    return f"<table>{''.join(lines)}</table>"


def figure_to_svg(figure: Figure) -> str:
    """Render a figure as an SVG element without XML prolog, outlines to a hundredth of a point."""
    import matplotlib as mpl
    from matplotlib.backends.backend_svg import FigureCanvasSVG

    buffer = io.StringIO()
    with mpl.rc_context(_RC):  # type: ignore[arg-type]
        # arranged beforehand: a figure that is saved with its layout open is drawn twice
        FigureCanvasSVG(figure)
        if layout := figure.get_layout_engine():
            layout.execute(figure)
            figure.set_layout_engine("none")
        figure.savefig(buffer, format="svg", metadata={"Date": None})
    text = buffer.getvalue()

    def shortened(outline: re.Match[str]) -> str:
        return re.sub(r"(\.\d\d)\d+", r"\1", outline.group())

    return re.sub(r' d="[^"]*"', shortened, text[text.index("<svg") :])


@contextmanager
def pdf_pages(path: str | Path, title: str) -> Iterator[Callable[..., None]]:
    """Open a PDF file; the function that it gives adds a figure as a page, saved as asked for."""
    import matplotlib as mpl
    from matplotlib.backends.backend_pdf import PdfPages

    rc = {**_RC, "pdf.fonttype": 42}
    facts = {"Title": title, "CreationDate": None}
    with mpl.rc_context(rc), PdfPages(path, metadata=facts) as pages:  # type: ignore[arg-type]
        yield pages.savefig


def save_figure(figure: Figure, path: str | Path) -> Path:
    """Write a figure to a file; the suffix says the format (png, svg, pdf)."""
    import matplotlib as mpl

    kind = Path(path).suffix.lstrip(".")
    with draft_of(path) as draft, mpl.rc_context(_RC):  # type: ignore[arg-type]
        figure.savefig(draft, format=kind, dpi=160.0)
    return Path(path)


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
