"""One look for all figures: colours that colour-blind readers can tell apart, plain axes."""

from __future__ import annotations

import functools
import io
import re
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING, Any, ParamSpec

from toothspace.core.files import draft_of
from toothspace.core.types import Array

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

P = ParamSpec("P")

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


def styled(draw: Callable[P, Figure]) -> Callable[P, Figure]:
    """Make a drawing function use the style without touching global settings."""

    @functools.wraps(draw)
    def wrapper(*args: P.args, **kwargs: P.kwargs) -> Figure:
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

    step = 60.0 if span > 200.0 else 10.0 if span > 40.0 else 5.0
    axes.set(xlabel=label, xlim=(0.0, span))
    axes.xaxis.set_major_locator(MultipleLocator(step))


def readable(name: str) -> str:
    """Turn a label such as ``journal_viscous`` into text for a reader."""
    return name.replace("_", " ").capitalize()


def figure_to_svg(figure: Figure) -> str:
    """Render a figure as an SVG element without XML prolog, outlines to a hundredth of a point."""
    import matplotlib as mpl

    buffer = io.StringIO()
    with mpl.rc_context(_RC):  # type: ignore[arg-type]
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
