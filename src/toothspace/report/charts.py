"""Interactive charts: pressures of all chambers, and the machine turning."""

from __future__ import annotations

import json
from typing import TYPE_CHECKING, Any

import numpy as np

from toothspace.core.types import Array
from toothspace.model.description import MachineDescription
from toothspace.plotting.section import (
    fixed_parts,
    fluid_cells,
    housing_region,
    port_region,
    top_of_scale,
    turned_section,
)
from toothspace.plotting.style import BLUE, CYCLE, GREY, INK, LIGHT, METAL, ORANGE, PRESSURE_COLOURS
from toothspace.results.solution import Solution

if TYPE_CHECKING:
    import plotly.graph_objects as go

_BAR = 1e5
_MM = 1e3
_MAX_POINTS = 361
_DRAWN_ERROR = 1.5e-5  # what drawn outlines may deviate [m]


def chamber_pressure_chart(solution: Solution) -> go.Figure:
    """Pressure of every chamber and at both ports over the shaft angle, to hover and zoom."""
    import plotly.graph_objects as go

    data = solution.data
    step = -(-data["shaft_angle"].size // _MAX_POINTS)
    angle = np.degrees(np.asarray(data["shaft_angle"] - data["shaft_angle"][0]))[::step]
    figure = go.Figure()
    for k, name in enumerate(data["chamber"].values):
        pressure = np.asarray(data["chamber_pressure"])[::step, k] / _BAR
        figure.add_scatter(
            x=_rounded(angle, 2),
            y=_rounded(pressure, 3),
            name=str(name).replace("_", " "),
            line={"width": 1.5, "color": CYCLE[(k + 2) % len(CYCLE)]},
            visible=True if str(name).endswith("_0") else "legendonly",
        )
    for port, color in (("inlet", BLUE), ("outlet", ORANGE)):
        pressure = np.asarray(data[f"{port}_pressure"])[::step] / _BAR
        line = {"color": color, "dash": "dash", "width": 2}
        figure.add_scatter(x=_rounded(angle, 2), y=_rounded(pressure, 3), name=port, line=line)
    figure.update_layout(
        **_layout(460),
        xaxis_title="Shaft angle (deg)",
        yaxis_title="Absolute pressure (bar)",
        hovermode="x",
    )
    return figure


def turning_section_chart(
    solution: Solution, description: MachineDescription, frames: int = 16
) -> go.Figure:
    """Section through the machine over one tooth pitch, with a slider for the shaft angle.

    Parameters
    ----------
    solution : Solution
        Result.
    description : MachineDescription
        Machine that it belongs to, with outlines of its chambers.
    frames : int
        Number of positions within one tooth pitch; fewer if the samples are coarser.
    """
    import plotly.graph_objects as go

    angle = np.asarray(solution.data["shaft_angle"])
    pitch = 2.0 * np.pi / description.families[0].count
    wanted = angle[0] + pitch * np.arange(frames) / frames
    samples = sorted({int(np.argmin(np.abs(angle - value))) for value in wanted})
    top = top_of_scale(solution) / _BAR
    shown = [_section_traces(solution, description, sample, top) for sample in samples]
    still = [_area(housing_region(description), LIGHT, "housing", edge=GREY), _colour_scale(top)]
    names = [f"{np.degrees(angle[sample] - angle[0]):.1f}°" for sample in samples]
    figure = go.Figure(
        data=[*still, *shown[0]],
        frames=[
            go.Frame(data=traces, name=name, traces=list(range(2, 2 + len(traces))))
            for traces, name in zip(shown, names, strict=True)
        ],
    )
    figure.update_layout(**_layout(720), showlegend=False, sliders=[_slider(names)])
    figure.update_layout(updatemenus=[_play_button()])
    figure.update_xaxes(visible=False, scaleanchor="y")
    figure.update_yaxes(visible=False)
    return figure


def _section_traces(
    solution: Solution, description: MachineDescription, sample: int, top: float
) -> list[dict[str, Any]]:
    import matplotlib as mpl
    from matplotlib.colors import to_hex

    colours = mpl.colormaps[PRESSURE_COLOURS]
    dimension = solution.data["chamber_pressure"].dims[0]
    data = solution.data.isel({dimension: sample})
    shaft_angle = float(data["shaft_angle"])
    pressure = np.asarray(data["chamber_pressure"]) / _BAR
    labels = description.chamber_labels
    traces = []
    for port in ("inlet", "outlet"):
        value = float(data[f"{port}_pressure"]) / _BAR
        colour = to_hex(colours(value / top))
        traces.append(_area(port_region(description, port), colour, f"{port}: {value:.1f} bar"))
    cells = fluid_cells(description, shaft_angle)
    for region, value, label in zip(cells, pressure, labels, strict=False):
        text = f"{label.replace('_', ' ')}: {value:.1f} bar"
        traces.append(_area(region, to_hex(colours(value / top)), text))
    for body in description.bodies:
        solid = turned_section(description, body, shaft_angle)
        traces.append(_area(solid, METAL, body.name.replace("_", " "), INK))
    traces.append(_area(fixed_parts(description), LIGHT, "part of the housing", INK))
    return traces


def _area(region: Any, colour: str, text: str, edge: str | None = None) -> dict[str, Any]:
    from shapely.geometry.polygon import orient

    region = region.simplify(_DRAWN_ERROR)
    polygons = [p for p in getattr(region, "geoms", [region]) if p.geom_type == "Polygon"]
    rings = [
        np.asarray(ring.coords)
        for polygon in map(orient, (p for p in polygons if not p.is_empty))
        for ring in (polygon.exterior, *polygon.interiors)
    ]
    gap = np.full((1, 2), np.nan)
    points = np.vstack([part for ring in rings for part in (ring, gap)]) if rings else gap
    return _closed(points, colour, text, edge or colour)


def _closed(points: Array, colour: str, text: str, edge: str) -> dict[str, Any]:
    return {
        "type": "scatter",
        "mode": "lines",
        "fill": "toself",
        "x": _rounded(points[:, 0] * _MM, 2),
        "y": _rounded(points[:, 1] * _MM, 2),
        "fillcolor": colour,
        "line": {"color": edge, "width": 0.8},
        "text": text,
        "hoverinfo": "text",
        "hoveron": "fills",
    }


def _colour_scale(top: float) -> dict[str, Any]:
    """Invisible point that carries the colour bar."""
    import matplotlib as mpl
    from matplotlib.colors import to_hex

    colours = mpl.colormaps[PRESSURE_COLOURS]
    scale = [[k / 10.0, to_hex(colours(k / 10.0))] for k in range(11)]
    bar = {"title": {"text": "bar"}, "thickness": 14, "len": 0.6}
    marker = {
        "color": [0.0],
        "cmin": 0.0,
        "cmax": top,
        "colorscale": scale,
        "colorbar": bar,
        "opacity": 0.0,
    }
    return {
        "type": "scatter",
        "mode": "markers",
        "x": [0.0],
        "y": [0.0],
        "marker": marker,
        "hoverinfo": "skip",
    }


def _slider(names: list[str]) -> dict[str, Any]:
    now = {
        "mode": "immediate",
        "frame": {"duration": 0, "redraw": True},
        "transition": {"duration": 0},
    }
    steps = [{"method": "animate", "label": name, "args": [[name], now]} for name in names]
    return {"steps": steps, "currentvalue": {"prefix": "Shaft angle "}, "pad": {"t": 10}}


def _play_button() -> dict[str, Any]:
    running = {
        "frame": {"duration": 90, "redraw": True},
        "transition": {"duration": 0},
        "fromcurrent": True,
        "mode": "immediate",
    }
    button = {"label": "Turn", "method": "animate", "args": [None, running]}
    return {"type": "buttons", "buttons": [button], "x": 0.0, "y": 1.0, "xanchor": "left"}


def _layout(height: int) -> dict[str, Any]:
    return {
        "height": height,
        "margin": {"l": 60, "r": 20, "t": 20, "b": 50},
        "plot_bgcolor": "white",
        "paper_bgcolor": "white",
        "font": {"family": "system-ui, sans-serif", "size": 13, "color": INK},
        "template": {
            "layout": {
                "xaxis": {"gridcolor": LIGHT, "zeroline": False},
                "yaxis": {"gridcolor": LIGHT, "zeroline": False},
            }
        },
    }


def _rounded(values: Array, digits: int) -> list[float | None]:
    return [None if np.isnan(v) else round(float(v), digits) for v in values]


def chart_html(figure: go.Figure, name: str) -> str:
    """Return the element and the call that draws a chart; plotly.js is loaded elsewhere."""
    specification = json.dumps(figure.to_plotly_json(), allow_nan=False).replace("</", "<\\/")
    return (
        f'<div id="{name}" class="chart"></div>\n<script>\n(function () {{\n'
        f"var chart = {specification};\n"
        f'Plotly.newPlot("{name}", chart.data, chart.layout, '
        "{responsive: true, displaylogo: false}).then(function () {\n"
        f'if (chart.frames) {{ Plotly.addFrames("{name}", chart.frames); }}\n}});\n}})();\n'
        "</script>"
    )
