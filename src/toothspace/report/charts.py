"""The machine turning: sections over one tooth pitch as one SVG, with a slider."""

from __future__ import annotations

from html import escape
from typing import Any

import numpy as np

from toothspace.model.description import MachineDescription
from toothspace.plotting.section import (
    fixed_parts,
    fluid_cells,
    housing_region,
    pitch_angle,
    port_region,
    recess_outlines,
    top_of_scale,
    turned_section,
)
from toothspace.plotting.style import GREY, INK, LIGHT, METAL, PRESSURE_COLOURS
from toothspace.results.solution import Solution

_BAR = 1e5
_MM = 1e3
_FRAMES = 16
"""Positions within one tooth pitch; fewer if the samples are coarser."""
_DRAWN_ERROR = 1.5e-5  # what drawn outlines may deviate [m]


def turning_section(solution: Solution, description: MachineDescription) -> str:
    """Section through the machine over one tooth pitch, with a slider for the shaft angle.

    Parameters
    ----------
    description : MachineDescription
        Machine that it belongs to, with outlines of its chambers.

    Returns
    -------
    str
        HTML with the picture and its script; pointing at an area shows its pressure.
    """
    from toothspace.report.page import render

    angle = np.asarray(solution.data["shaft_angle"])
    pitch = pitch_angle(description)
    wanted = angle[0] + pitch * np.arange(_FRAMES) / _FRAMES
    samples = sorted({int(np.argmin(np.abs(angle - value))) for value in wanted})
    top = top_of_scale(solution) / _BAR
    housing = housing_region(description)
    left, low, right, high = (_MM * value for value in housing.bounds)
    return render(
        "turning.html.j2",
        box=f"{left:.2f} {-high:.2f} {right - left:.2f} {high - low:.2f}",
        housing=_area(housing, LIGHT, "housing", edge=GREY),
        frames=["\n".join(_section(solution, description, sample, top)) for sample in samples],
        angles=[f"{np.degrees(angle[sample] - angle[0]):.1f}" for sample in samples],
        colours=[_colour(share) for share in np.linspace(0.0, 1.0, 7)],
        top=f"{top:.0f}",
    )


def _colour(share: float) -> str:
    import matplotlib as mpl
    from matplotlib.colors import to_hex

    return to_hex(mpl.colormaps[PRESSURE_COLOURS](share))


def _section(
    solution: Solution, description: MachineDescription, sample: int, top: float
) -> list[str]:
    data = solution.data.isel({solution.data["chamber_pressure"].dims[0]: sample})
    shaft_angle = float(data["shaft_angle"])
    pressure = np.asarray(data["chamber_pressure"]) / _BAR
    labels = description.chamber_labels
    areas = []
    for port in ("inlet", "outlet"):
        value = float(data[f"{port}_pressure"]) / _BAR
        text = f"{port}: {value:.1f} bar"
        areas.append(_area(port_region(description, port), _colour(value / top), text))
    cells = fluid_cells(description, shaft_angle)
    for region, one, label in zip(cells, pressure, labels, strict=False):
        text = f"{label.replace('_', ' ')}: {one:.1f} bar"
        areas.append(_area(region, _colour(float(one) / top), text))
    for body in description.bodies:
        solid = turned_section(description, body, shaft_angle)
        areas.append(_area(solid, METAL, body.name.replace("_", " "), edge=INK))
    areas.append(_area(fixed_parts(description), LIGHT, "part of the housing", edge=INK))
    for outline in recess_outlines(description).values():
        areas.append(f'<path class="recess" d="{_curve(outline[:-1])}"/>')
    return areas


def _area(region: Any, colour: str, text: str, edge: str | None = None) -> str:
    region = region.simplify(_DRAWN_ERROR)
    polygons = [p for p in getattr(region, "geoms", [region]) if p.geom_type == "Polygon"]
    rings = [ring for p in polygons if not p.is_empty for ring in (p.exterior, *p.interiors)]
    outline = "".join(_curve(ring.coords[:-1]) for ring in rings)
    return (
        f'<path d="{outline}" fill="{colour}" fill-rule="evenodd" stroke="{edge or colour}" '
        f'stroke-width="0.1"><title>{escape(text)}</title></path>'
    )


def _curve(points: Any) -> str:
    return f"M{'L'.join(f'{_MM * x:.2f} {-_MM * y:.2f}' for x, y, *_ in points)}Z"
