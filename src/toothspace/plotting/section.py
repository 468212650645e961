"""Section through the machine with the fluid coloured by pressure."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import TYPE_CHECKING, Any, NamedTuple, final

import numpy as np

from toothspace.core.types import Array, IntArray
from toothspace.geometry.curve import enclosed
from toothspace.model.description import Body, MachineDescription
from toothspace.plotting.style import (
    BLUE,
    GREY,
    INK,
    LIGHT,
    METAL,
    ORANGE,
    PRESSURE_COLOURS,
    new_figure,
    styled,
)
from toothspace.results.solution import Solution

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

_MM = 1e3
_BAR = 1e5
_PORTS = ("inlet", "outlet")
_DRAWN_ERROR = 4e-6  # what drawn outlines may deviate
HEIGHTS = (-0.5, 0.0, 0.5)
"""Where teeth that wind are shown, over the face width from the middle. [-]"""
_WALL = 0.08  # drawn thickness of the housing over its height


def turned_section(description: MachineDescription, body: Body, shaft_angle: float) -> Any:
    """Section of a body in the frame of the machine at a shaft angle, a ring with its hole. [m]."""
    from shapely.affinity import rotate, translate

    # the two sides of the cut through a ring coincide before it is turned
    (section,) = enclosed([description.outlines[body.name]])
    turn = body.speed_ratio * shaft_angle
    return translate(rotate(section, turn, origin=(0.0, 0.0), use_radians=True), *body.center)


def fluid_cells(description: MachineDescription, shaft_angle: float) -> list[Any]:
    """Fluid of the chambers as polygons in the order of the chambers.

    Parameters
    ----------
    description : MachineDescription
        Machine with outlines of its chambers.
    shaft_angle : float
        Shaft angle. [rad]

    Returns
    -------
    list of shapely geometry
        Areas that they fill. [m]
    """
    assert description.chamber_outlines is not None
    return list(enclosed(description.chamber_outlines(shaft_angle)))


def recess_outlines(description: MachineDescription) -> dict[str, Array]:
    """Outlines of relief grooves and of ports in the covers by name, closed. [m]."""
    return {
        name: np.vstack([outline, outline[:1]])
        for name, outline in description.outlines.items()
        if name.startswith(("groove_", "port_"))
    }


def _tip_radius(description: MachineDescription, body: int) -> float:
    points = description.outlines[description.bodies[body].name]
    return float(np.max(np.hypot(points[:, 0], points[:, 1])))


@styled
def gear_section(
    solution: Solution,
    description: MachineDescription,
    fractions: Sequence[float] = (0.0, 0.25, 0.5, 0.75),
) -> Figure:
    """Section of a machine with the pressures of its chambers as colour.

    Teeth that wind are shown at the first of these angles, in both ends and in the middle.

    Parameters
    ----------
    description : MachineDescription
        The machine that it belongs to.
    fractions : sequence of float
        Where within one tooth pitch to look, from 0 to 1. [-]

    Returns
    -------
    Figure
        One panel per angle.
    """
    import matplotlib as mpl
    from matplotlib.cm import ScalarMappable
    from matplotlib.colors import Normalize

    angle = np.asarray(solution.data["shaft_angle"])
    pitch = description.pitch_angle
    winding = description.winding
    views = [(fraction, 0.0) for fraction in fractions]
    if winding is not None:
        views = [(fractions[0], height) for height in HEIGHTS]
    columns = min(len(views), 2 if winding is None else 3)
    rows = -(-len(views) // columns)
    left, low, right, high = housing_region(description).bounds
    figure = new_figure(3.5 * columns + 0.9, (0.6 + 2.9 * (high - low) / (right - left)) * rows)
    panels = np.ravel(figure.subplots(rows, columns, squeeze=False))
    scale = Normalize(0.0, top_of_scale(solution) / _BAR)
    colours = mpl.colormaps[PRESSURE_COLOURS]
    for axes, (fraction, height) in zip(panels, views, strict=False):
        sample = int(np.argmin(np.abs(angle - angle[0] - fraction * pitch)))
        data = solution.data.isel({solution.data["shaft_speed"].dims[0]: sample})
        ports = {p: colours(scale(float(data[f"{p}_pressure"]) / _BAR)) for p in _PORTS}
        spaces = colours(scale(np.asarray(data["chamber_pressure"]) / _BAR))
        cut = section_at(description, float(data["shaft_angle"]), height)
        title = f"{np.degrees(angle[sample] - angle[0]):.1f}° of shaft angle"
        draw_section(axes, cut.drawn, cut.shaft_angle, ports, spaces[cut.chambers])
        axes.set_title(title if winding is None else cut.title)
    for axes in panels[len(views) :]:
        axes.remove()
    peaks = float(solution.data["chamber_pressure"].max()) > top_of_scale(solution)
    bar = figure.colorbar(
        ScalarMappable(scale, PRESSURE_COLOURS),
        ax=list(panels[: len(views)]),
        shrink=0.6,
        aspect=30,
        pad=0.02,
        extend="max" if peaks else "neither",
    )
    bar.set_label("Absolute pressure (bar)")
    bar.outline.set_visible(False)
    return figure


@final
class SectionAt(NamedTuple):
    """Section of a machine across its axis at one height."""

    drawn: MachineDescription
    """Machine with the outlines of the section."""
    shaft_angle: float
    """Where its own shaft stands. [rad]"""
    chambers: IntArray
    """Chambers that its spaces hold."""
    title: str
    """Height in words."""


def section_at(description: MachineDescription, shaft_angle: float, height: float) -> SectionAt:
    """Section at a height over the face width, from -0.5 to 0.5, and a shaft angle [rad]."""
    winding = description.winding
    if winding is None:
        return SectionAt(description, shaft_angle, np.arange(description.chamber_count), "")
    lead = height * float(np.copysign(winding.twist, winding.turn_per_length))
    chambers = description.chambers_in_section(shaft_angle, lead)
    width = winding.twist / abs(winding.turn_per_length)
    title = f"z = {height * width * _MM:+.1f} mm"
    return SectionAt(winding.section, shaft_angle + lead, chambers, title)


def top_of_scale(solution: Solution) -> float:
    """Pressure of the darkest colour; short peaks beyond 1.5 port pressures share it. [Pa]."""
    ports = max(float(solution.data[f"{port}_pressure"].max()) for port in ("inlet", "outlet"))
    return min(float(solution.data["chamber_pressure"].max()), 1.5 * ports)


@styled
def machine_section(description: MachineDescription, shaft_angle: float = 0.0) -> Figure:
    """Section of a machine before any run: inlet blue, outlet red, between them the chambers.

    Parameters
    ----------
    shaft_angle : float
        Where the shaft stands. [rad]
    """
    from matplotlib.colors import to_rgba

    left, low, right, high = housing_region(description).bounds
    figure = new_figure(4.6, 0.3 + 4.6 * (high - low) / (right - left))
    spaces = np.ones((description.chamber_count, 4))
    ports = {"inlet": to_rgba(BLUE, 0.45), "outlet": to_rgba(ORANGE, 0.6)}
    draw_section(figure.subplots(), description, shaft_angle, ports, spaces)
    return figure


def draw_section(
    axes: Axes,
    description: MachineDescription,
    shaft_angle: float,
    ports: Mapping[str, tuple[float, ...]],
    spaces: Array,
) -> None:
    """Draw ports and chambers, each in its colour, and what stands and turns between them."""
    _fill(axes, housing_region(description), facecolor=LIGHT, edgecolor=GREY, linewidth=0.7)
    for port, colour in ports.items():
        _fill(axes, port_region(description, port), facecolor=colour, linewidth=0.0)
        low, high = sorted(body.center[1] for body in description.bodies)
        casing = description.outlines["casing"]
        wall = _WALL * float(np.ptp(casing[:, 1]))
        far = float(np.max(np.abs(casing[:, 0]))) + 0.85 * wall
        left = port_side(description, port) < 0.0
        within = f"port_{port}" in description.outlines
        light = within or float(np.dot(colour[:3], (0.3, 0.6, 0.1))) > 0.5
        far = far + 0.5 * wall if within else far
        x, y = (-far if left else far) * _MM, 0.5 * (low + high) * _MM
        side, ink = "left" if left != within else "right", INK if light else "white"
        axes.text(x, y, port, ha=side, va="center", fontsize=8, color=ink)
    if description.chamber_outlines is not None:
        for region, space in zip(fluid_cells(description, shaft_angle), spaces, strict=False):
            _fill(axes, region, facecolor=space, edgecolor=space, linewidth=0.4)
    for body in description.bodies:
        solid = turned_section(description, body, shaft_angle)
        _fill(axes, solid, facecolor=METAL, edgecolor=INK, linewidth=0.6)
        journal = next((j for j in description.journals if j.body == body.name), None)
        if journal is not None:
            turn = np.linspace(0.0, 2.0 * np.pi, 181)
            circle = 0.5 * journal.diameter * np.array([np.cos(turn), np.sin(turn)])
            center = np.asarray(body.center)[:, None]
            axes.plot(*((circle + center) * _MM), color=GREY, linewidth=0.7)
        mark = _MM * np.asarray(body.center)
        axes.plot(*mark, "+", color=INK, markersize=5, markeredgewidth=0.7)
        # arc with an arrow head in the sense of rotation
        radius, half = 0.3 * _MM * _tip_radius(description, 0), 70.0
        if solid.interiors:  # in the rim of a ring
            hole = _MM * np.asarray(solid.interiors[0].coords) - mark
            rim = _MM * np.hypot(*description.outlines[body.name].T).max()
            radius, half = 0.5 * float(np.hypot(*hole.T).max() + rim), 20.0
        turn = np.radians(90.0 + np.linspace(-half, half, 40))
        turn = turn if body.speed_ratio > 0.0 else np.pi - turn
        arc = mark[:, None] + radius * np.array([np.cos(turn), np.sin(turn)])
        axes.plot(*arc[:, :-3], color=INK, linewidth=0.9)
        arrow = {"arrowstyle": "-|>", "color": INK, "linewidth": 0.9, "shrinkA": 0, "shrinkB": 0}
        axes.annotate("", tuple(arc[:, -1]), tuple(arc[:, -4]), arrowprops=arrow)
    _fill(axes, fixed_parts(description), facecolor=LIGHT, edgecolor=INK, linewidth=0.6)
    for outline in recess_outlines(description).values():
        axes.plot(*(_MM * outline.T), color=INK, linewidth=0.8, linestyle=(0, (4, 2)))
    axes.set_aspect("equal")
    axes.set_axis_off()


def housing_region(description: MachineDescription) -> Any:
    """Wall of the housing around the bores, for drawing. [m]."""
    import shapely

    (casing,) = enclosed([description.outlines["casing"]])
    bore = casing.union(_discs(description))
    wall = _WALL * float(np.ptp(description.outlines["casing"][:, 1]))
    ducts = [port_region(description, port) for port in ("inlet", "outlet")]
    return bore.buffer(wall).difference(shapely.union_all([bore, *ducts]))


def fixed_parts(description: MachineDescription) -> Any:
    """What is drawn besides bodies, casing, ports and grooves: parts that stand still. [m]."""
    import shapely

    moving = {body.name for body in description.bodies}
    parts = [
        shapely.Polygon(outline)
        for name, outline in description.outlines.items()
        if name not in moving and not name.startswith(("casing", "port_", "groove_"))
    ]
    return shapely.union_all(parts)


def _discs(description: MachineDescription) -> Any:
    import shapely

    discs = [
        shapely.Point(body.center).buffer(_tip_radius(description, k), quad_segs=64)
        for k, body in enumerate(description.bodies)
    ]
    return shapely.union_all(discs)


def port_region(description: MachineDescription, port: str) -> Any:
    """Port as the machine gives it, or a duct from the mesh out through the housing. [m]."""
    import shapely

    if f"port_{port}" in description.outlines:
        return shapely.Polygon(description.outlines[f"port_{port}"])
    low, high = sorted(body.center[1] for body in description.bodies)
    middle, half = 0.5 * (low + high), 0.25 * (high - low)
    casing = description.outlines["casing"]
    far = float(np.max(np.abs(casing[:, 0]))) + _WALL * float(np.ptp(casing[:, 1]))
    limits = (-far, 0.0) if port == "inlet" else (0.0, far)
    duct = shapely.box(limits[0], middle - half, limits[1], middle + half)
    (bore,) = enclosed([casing])
    side = bore.intersection(shapely.box(limits[0], low, limits[1], high))
    return duct.union(side).difference(_discs(description))


def port_side(description: MachineDescription, port: str) -> float:
    """Place of a port along x: negative on the left. [m]."""
    return float(port_region(description, port).centroid.x)


def _fill(axes: Axes, region: Any, **style: Any) -> None:
    """Draw a polygon with holes, or several."""
    from matplotlib.patches import PathPatch
    from matplotlib.path import Path

    region = region.simplify(_DRAWN_ERROR)
    for polygon in getattr(region, "geoms", [region]):
        if polygon.is_empty or polygon.geom_type != "Polygon":
            continue
        rings = [np.asarray(ring.coords) for ring in (polygon.exterior, *polygon.interiors)]
        paths = [Path(_MM * ring[:, :2], closed=True) for ring in rings]
        axes.add_patch(PathPatch(Path.make_compound_path(*paths), **style))
