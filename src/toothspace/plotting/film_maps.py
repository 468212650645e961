"""Maps of lateral films beside the gears, seen from the floating side."""

from __future__ import annotations

from dataclasses import dataclass
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.core.types import Array
from toothspace.model.description import MachineDescription
from toothspace.plotting.style import GREY, new_figure, readable, styled
from toothspace.results.solution import Solution

if TYPE_CHECKING:
    import xarray as xr
    from matplotlib.axes import Axes
    from matplotlib.collections import QuadMesh
    from matplotlib.colors import Normalize
    from matplotlib.figure import Figure

_MOST_MAPS = 7
_LEAST_SPAN = 1.0001


@final
@dataclass(frozen=True)
class FilmField:
    """How one field of the films is shown."""

    name: str
    """Result variable."""
    label: str
    """Text beside the colours, with unit."""
    factor: float
    """From SI units to those of the label."""
    colours: str
    """Colour map."""

    def shown(self, data: xr.Dataset) -> Array:
        """Values in the unit of the label; nothing where no film ever is."""
        values = np.asarray(data[self.name].values, dtype=float) * self.factor
        return values if self.name == "film_height" else np.where(values > 0.0, values, np.nan)

    def scale(self, values: Array) -> Normalize:
        """Colours over the values: logarithmic for heights, from zero for others."""
        from matplotlib.colors import LogNorm, Normalize

        found = values[np.isfinite(values)]
        if self.name == "film_height" and found.size:
            low, high = np.percentile(found, [1.0, 99.0])
            return LogNorm(low, max(high, _LEAST_SPAN * low))
        return Normalize(0.0, float(found.max()) if found.size else 1.0)


HEIGHT = FilmField("film_height", "Film height (µm)", 1e6, "viridis")
PRESSURE = FilmField("film_pressure", "Pressure (bar)", 1e-5, "viridis")
CONTACT = FilmField("film_contact_pressure", "Asperity pressure (MPa)", 1e-6, "magma_r")
WEAR = FilmField("film_wear_power", "Wear indicator p v (W/mm²)", 1e-6, "magma_r")


@styled
def point_maps(data: xr.Dataset, field: FilmField) -> Figure:
    """One field at all points of a study, one row per side of the gears."""
    shown = data.isel(point=slice(None, _MOST_MAPS))
    count, sides = shown.sizes["point"], _sides(data)
    figure = new_figure(1.2 + 0.95 * count, 1.75 * len(sides) + 0.5)
    values = field.shown(shown)
    scale = field.scale(values)
    panels = figure.subplots(len(sides), count, squeeze=False)
    for row, (side, films) in enumerate(sides.items()):
        for column in range(count):
            for film in films:
                mesh = _map(panels[row][column], data, film, values[column, film], (field, scale))
            _bare(panels[row][column])
        panels[row][0].set_ylabel(f"{readable(side)} side", fontsize=8)
    for axes, label in zip(panels[0], shown["point_label"].values, strict=True):
        axes.set_title(str(label), fontsize=7.5)
    _colour_bar(figure, mesh, panels, field)
    return figure


@styled
def lateral_films(solution: Solution, description: MachineDescription | None = None) -> Figure:
    """Height, pressure, asperity pressure and wear indicator on both sides of the gears."""
    data, sides = solution.data, _sides(solution.data)
    touching = bool(np.isfinite(CONTACT.shown(data)).any())
    fields = (HEIGHT, PRESSURE, CONTACT, WEAR) if touching else (HEIGHT, PRESSURE)
    figure = new_figure(7.2, 2.6 * len(sides) + 0.6)
    if not touching:
        figure.suptitle("No asperities touch", fontsize=8, color=GREY)
    panels = figure.subplots(len(sides), len(fields), squeeze=False)
    for column, field in enumerate(fields):
        values = field.shown(data)
        scale = field.scale(values)
        for row, (side, films) in enumerate(sides.items()):
            for film in films:
                mesh = _map(panels[row][column], data, film, values[film], (field, scale))
            _bare(panels[row][column])
            panels[row][0].set_ylabel(f"{readable(side)} side", fontsize=8)
        _colour_bar(figure, mesh, panels[:, column], field, below=True)
    return figure


def _sides(data: xr.Dataset) -> dict[str, list[int]]:
    """Films by the side of the gears that they are on."""
    found: dict[str, list[int]] = {}
    for k, name in enumerate(data["film"].values):
        found.setdefault(str(name).partition("_")[0], []).append(k)
    return found


def _map(
    axes: Axes, data: xr.Dataset, film: int, values: Array, look: tuple[FilmField, Normalize]
) -> QuadMesh:
    angle, radius = data["film_angle"].values, data["film_radius"].values[film]
    turn, reach = angle[1] - angle[0], radius[1] - radius[0]
    edges = np.append(angle - 0.5 * turn, angle[-1] + 0.5 * turn)[:, None]
    rims = np.append(radius - 0.5 * reach, radius[-1] + 0.5 * reach)
    x = data["film_center_x"].values[film] + np.cos(edges) * rims
    y = data["film_center_y"].values[film] + np.sin(edges) * rims
    for rim in (0, -1):
        axes.plot(x[:, rim], y[:, rim], color=GREY, lw=0.5)
    field, scale = look
    return axes.pcolormesh(x, y, values, cmap=field.colours, norm=scale, rasterized=True)


def _bare(axes: Axes) -> None:
    axes.set_aspect("equal")
    axes.set_xticks([])
    axes.set_yticks([])
    for side in axes.spines.values():
        side.set_visible(False)


def _colour_bar(
    figure: Figure, mesh: QuadMesh, panels: Any, field: FilmField, below: bool = False
) -> None:
    from matplotlib.ticker import MaxNLocator, NullLocator

    place = "bottom" if below else "right"
    bar = figure.colorbar(mesh, ax=panels, shrink=0.8, location=place)
    bar.set_label(field.label, fontsize=7.5 if below else None)
    axis = bar.ax.xaxis if below else bar.ax.yaxis
    if below:
        # a logarithmic scale over less than a decade has no mark of its own
        low, high = mesh.get_clim()
        bar.set_ticks([t for t in MaxNLocator(4).tick_values(low, high) if low <= t <= high])
        axis.set_minor_locator(NullLocator())
    axis.set_major_formatter("{x:g}")
    axis.set_minor_formatter("{x:g}")
    bar.ax.tick_params(labelsize=7)
