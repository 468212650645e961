"""Sections of solid bodies: which plane to cut, about which axis, where the teeth are."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array
from toothspace.geometry.curve import signed_area
from toothspace.geometry.mesh_section import (
    SurfaceMesh,
    axis_frame,
    flat_levels,
    likely_axes,
    section,
)
from toothspace.geometry.tooth_count import repeating_teeth

FEWEST_LOBES = 3
AXES = {"x": (1.0, 0.0, 0.0), "y": (0.0, 1.0, 0.0), "z": (0.0, 0.0, 1.0)}
_MOST_LAYERS = 24
_THINNEST = 4e-6
"""Thinner layers are edges, not parts of a body. [m]"""
_QUICK_LOOK = (0.02, 0.5, 0.98)
_SECOND = 0.2
"""Of the toothed length, from its begin: place of the second section. [-]"""


@final
@dataclass(frozen=True)
class SectionRequest:
    """What to cut out of a solid file."""

    axis: str | tuple[float, float, float] | None = None
    """``x``, ``y``, ``z`` or a unit vector; None: the axis of symmetry where teeth are wanted, else
    z.
    """
    plane: float | None = None
    """Height of the section along the axis; None: middle of the teeth or of the body. [m]"""
    body: int | None = None
    """Number of one body, the largest is 0; None for all."""
    part: str | None = None
    """Name of one body; None for all."""
    teeth: bool = False
    """Whether to look for teeth."""
    lobes: bool = False
    """Whether to look for three and more teeth, also on holes, as of gerotor rotors."""
    face_towards: float | None = None
    """Height towards which a body turns its face: in place of one section, one through the layer
    behind that face and one through the layer that follows, between flat faces across the axis. [m]
    """


@final
@dataclass(frozen=True)
class SolidBody:
    """One body of a file."""

    name: str
    """Name in the file, empty without."""
    mesh: SurfaceMesh
    """Its surface, for a STEP body a coarse one."""
    cut: Callable[[Array, float], list[Array]]
    """Section curves for a frame and a height, as in ``mesh_section.section``."""


@final
@dataclass(frozen=True)
class BodySection:
    """Section of one body."""

    body: int
    """Number of the body, the largest is 0."""
    name: str
    """Its name in the file, empty without."""
    axis: Array
    """Unit vector normal to the section. Shape (3,)."""
    height: float
    """Distance of the plane from the origin along the axis. [m]"""
    extent: tuple[float, float]
    """Range of the body along the axis. [m]"""
    teeth_extent: tuple[float, float] | None
    """Range along the axis in which the section has teeth; None if it was not looked for or none
    was found. [m]
    """
    curves: list[Array]
    """Closed curves, shape (n, 2), in the frame of ``axis_frame``, largest first. [m]"""
    second_height: float = 0.0
    """Height of a second section through the teeth. [m]"""
    second: Array | None = None
    """Its largest curve, on the mesh of the body. [m]"""
    layer: tuple[float, float] | None = None
    """Flat faces between which the section was cut. [m]"""


def cut_bodies(file: str, bodies: list[SolidBody], request: SectionRequest) -> list[BodySection]:
    """Cut the bodies of a file.

    Parameters
    ----------
    file : str
        Name of the file for error messages.
    bodies : list of SolidBody
        Bodies in any order.

    Returns
    -------
    list of BodySection
        One for each body that the plane meets, largest volume first.

    Raises
    ------
    GeometryError
        For an unknown body or part, or a plane outside all bodies.
    """
    ordered = sorted(bodies, key=lambda body: -body.mesh.volume)
    numbers = _chosen(file, ordered, request)
    found = [cut for number in numbers for cut in _cuts(number, ordered[number], request)]
    sections = [cut for cut in found if cut.curves]
    if not sections:
        low = min(cut.extent[0] for cut in found) * 1e3
        high = max(cut.extent[1] for cut in found) * 1e3
        plane = "" if request.plane is None else f" = {request.plane * 1e3:.5g} mm"
        raise GeometryError(file, f"plane_z{plane}", f"{low:.5g} to {high:.5g} mm")
    return sections


def _chosen(file: str, bodies: list[SolidBody], request: SectionRequest) -> list[int]:
    if not bodies:
        raise GeometryError(file, "no body", "at least one closed body")
    if request.part is not None:
        names = [body.name for body in bodies]
        if request.part not in names:
            known = ", ".join(repr(name) for name in dict.fromkeys(names) if name) or "no names"
            raise GeometryError(file, f"no body named {request.part!r}", known)
        return [k for k, name in enumerate(names) if name == request.part]
    if request.body is None:
        return list(range(len(bodies)))
    if not 0 <= request.body < len(bodies):
        raise GeometryError(file, f"body = {request.body}", f"0 to {len(bodies) - 1}")
    return [request.body]


def _cuts(number: int, body: SolidBody, request: SectionRequest) -> list[BodySection]:
    given = request.axis
    # a body without teeth is cut across z unless told otherwise
    axis = np.array(AXES[given] if isinstance(given, str) else given or AXES["z"])
    if request.teeth or request.lobes:
        for likely in likely_axes(body.mesh) if given is None else [axis]:
            teeth = _toothed_extent(body.mesh, axis_frame(likely), lobes=request.lobes)
            if teeth is not None:
                return [_section(number, body, likely, teeth, request.plane)]
    if request.face_towards is None:
        return [_section(number, body, axis, None, request.plane)]
    # from the end nearest to the height
    layers, towards = _layers(body.mesh, axis), request.face_towards
    if abs(layers[0][0] - towards) >= abs(layers[-1][1] - towards):
        layers = layers[::-1]
    return [
        replace(_section(number, body, axis, None, 0.5 * sum(layer)), layer=layer)
        for layer in layers[:2]
    ]


def _section(
    number: int,
    body: SolidBody,
    axis: Array,
    teeth: tuple[float, float] | None,
    plane: float | None,
) -> BodySection:
    extent = body.mesh.extent(axis)
    low, high = extent if teeth is None else teeth
    height = 0.5 * (low + high) if plane is None else plane
    frame = axis_frame(axis)
    curves = _sorted(body.cut(frame, height)) if extent[0] < height < extent[1] else []
    second_height, second = 0.0, None
    if teeth is not None:
        second_height = low + _SECOND * (high - low)
        others = _sorted(section(body.mesh, frame, second_height))
        second = others[0] if others else None
    return BodySection(
        number, body.name, axis, height, extent, teeth, curves, second_height, second
    )


def _sorted(curves: list[Array]) -> list[Array]:
    return sorted(curves, key=lambda curve: -abs(signed_area(curve)))


def _toothed_extent(mesh: SurfaceMesh, frame: Array, *, lobes: bool) -> tuple[float, float] | None:
    low, high = mesh.extent(frame[2])
    looks = [_teeth_at(mesh, frame, low + k * (high - low), lobes=lobes) for k in _QUICK_LOOK]
    if looks[0][0] is not None and len({count for count, _ in looks}) == 1:
        return low, high
    # neighbouring layers with one tooth count; the widest such gear is meant, not a spline or nut
    runs: list[tuple[float, float, float, int]] = []
    for start, end in _layers(mesh, frame[2]):
        count, width = _teeth_at(mesh, frame, 0.5 * (start + end), lobes=lobes)
        if count is None:
            continue
        if runs and runs[-1][1] == start and runs[-1][3] == count:
            runs[-1] = (runs[-1][0], end, max(runs[-1][2], width), count)
        else:
            runs.append((start, end, width, count))
    if not runs:
        return None
    widest = max(run[2] for run in runs)
    near = [run for run in runs if run[2] > 0.98 * widest]
    low, high, _, _ = max(near, key=lambda run: run[1] - run[0])
    return low, high


def _teeth_at(
    mesh: SurfaceMesh, frame: Array, height: float, *, lobes: bool
) -> tuple[int | None, float]:
    # tooth count and width of the outermost curve, of lobes that of the outermost toothed one
    for curve in _sorted(section(mesh, frame, height)):
        count = repeating_teeth(curve, FEWEST_LOBES) if lobes else repeating_teeth(curve)
        if count is not None or not lobes:
            return count, float(np.ptp(curve[:, 0]))
    return None, 0.0


def _layers(mesh: SurfaceMesh, axis: Array) -> list[tuple[float, float]]:
    # between flat faces across the axis: end faces, shoulders, bottoms of recesses
    levels = flat_levels(mesh, axis)
    if len(levels) > _MOST_LAYERS:
        levels = [float(level) for level in np.linspace(levels[0], levels[-1], _MOST_LAYERS + 1)]
    return [(low, high) for low, high in pairwise(levels) if high - low > _THINNEST]
