"""A machine as the browser draws it: outlines from its tables, handles, numbers and rules."""

from __future__ import annotations

import math
from collections.abc import Iterable, Iterator
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import shapely

from toothspace.app.handles import closed_form_of, handles_of
from toothspace.app.side_view import side_view
from toothspace.case import Case
from toothspace.core.files import plain
from toothspace.core.registry import machine_type
from toothspace.core.types import Array
from toothspace.geometry.curve import enclosed
from toothspace.model.description import ChamberFamily, MachineDescription
from toothspace.plotting.geometry import opening_area, openings_of
from toothspace.plotting.section import (
    SectionAt,
    fixed_parts,
    fluid_cells,
    housing_region,
    port_region,
    recess_outlines,
    section_at,
)

DRAG_NODES = 180
"""Table nodes on a turn while a handle moves; displacement and contact are closed forms."""
if TYPE_CHECKING:
    from toothspace.geometry.body_section import BodySection
    from toothspace.geometry.gear_finder import FileContents, FoundGear

_MM = 1e3
_DRAWN_ERROR = 8e-6
_TURNING_ERROR = 25e-6
"""What outlines may deviate, at rest and while the machine turns. [m]"""
_OPENING_NODES = 181


def look(
    case: Case, nodes: int | None = None, *, numbers_only: bool = False, cells: bool = False
) -> dict[str, Any]:
    """Section, handles, numbers, opening areas and design rules of the machine of a case.

    Parameters
    ----------
    case : Case
        Case with a machine.
    nodes : int, optional
        Table nodes on a turn; default those of a run.
    numbers_only : bool
        Whether to leave out the drawing, which takes as long as the rest.
    cells : bool
        Whether to add outlines of the tooth spaces, from which moved grooves are cut.

    Raises
    ------
    CaseError
        If the machine cannot be built.
    """
    described = machine_type(case.machine_type).describe
    spec = case.machine_spec
    description = described(spec) if nodes is None else described(spec, nodes)
    found = {
        "numbers": plain(description.geometry_summary),
        "openings": openings(description),
        "volume": volume(description),
        "rules": [
            {
                "label": check.label,
                "value": plain(check.value),
                "shown": check.shown_value,
                "allowed": check.allowed,
                "passed": bool(check.passed),
                "reason": check.reason,
            }
            for check in description.checks
        ],
    }
    if numbers_only:
        return found
    beside = side_view(case, description)
    return {
        **found,
        "section": section(description),
        "side": beside.parts,
        "handles": handles_of(case, description, beside),
        "closed": closed_form_of(case),
        "cut": groove_cuts(case, description) or kidney_cuts(case, description) if cells else None,
    }


def section(description: MachineDescription, shaft_angle: float = 0.0) -> dict[str, Any]:
    """Outlines of the transverse section, in mm; bodies in their own frame."""
    cut = section_at(description, shaft_angle, 0.0)
    return {
        "machine": description.name,
        "mode": description.mode,
        "pitch": description.pitch_angle,
        "bodies": [
            {
                "name": body.name,
                "center": _points(np.array([body.center]))[0],
                "ratio": body.speed_ratio,
                "outline": _rings(enclosed([description.outlines[body.name]])[0]),
                "journal": next(
                    (_MM * j.diameter for j in description.journals if j.body == body.name), None
                ),
            }
            for body in description.bodies
        ],
        "housing": _rings(housing_region(description)),
        "ports": {p: _rings(port_region(description, p)) for p in ("inlet", "outlet")},
        "recesses": {name: _points(line) for name, line in recess_outlines(description).items()},
        "fixed": _rings(fixed_parts(description)),
        "cells": [] if cut.drawn.chamber_outlines is None else cells_of(cut, _DRAWN_ERROR),
    }


def cells_of(cut: SectionAt, error: float = _TURNING_ERROR) -> list[Any]:
    """Outlines of the chambers of a section, in mm, within a deviation [m]."""
    return [_rings(cell, error) for cell in fluid_cells(cut.drawn, cut.shaft_angle)]


def openings(description: MachineDescription) -> list[dict[str, Any]]:
    """Open areas of one chamber of each family over its own angle. [deg], [mm2]."""
    found = []
    for family in description.families:
        angle = np.linspace(0.0, family.volume.period, family.count * _steps(family) + 1)
        curves = []
        for category in openings_of(description):
            area = opening_area(description, family, category, angle) * 1e6
            if float(area.max()) > 0.0:
                curves.append(
                    {
                        "label": category.label,
                        "role": category.role,
                        "colour": category.colour,
                        "values": rounded(area),
                    }
                )
        if curves:
            found.append(
                {"family": family.name, "angle": rounded(np.degrees(angle)), "curves": curves}
            )
    return found


def _steps(family: ChamberFamily) -> int:
    """Steps from one chamber of a family to the next in a diagram of its openings."""
    return -(-(_OPENING_NODES - 1) // family.count)


def groove_cuts(case: Case, description: MachineDescription) -> dict[str, Any] | None:
    """Tooth spaces near the relief grooves at the angles of :func:`openings`, in mm.

    The browser cuts them with grooves that move; the area that it finds is that of the tables. None
    where grooves are no rectangles, or teeth turn along the axis.
    """
    recesses = {n: o for n, o in recess_outlines(description).items() if n.startswith("groove_")}
    corners = {np.unique(outline, axis=0).shape[0] for outline in recesses.values()}
    outlines = description.chamber_outlines
    if outlines is None or description.winding is not None or corners != {4}:
        return None
    spaces: dict[str, dict[int, list[list[float]]]] = {}
    grooves, first = [], 0
    for family in description.families:
        steps, chambers = _steps(family), slice(first, first + family.count)
        first += family.count
        own = [
            path
            for path in description.paths
            if path.category.role in ("inlet_groove", "outlet_groove")
            and path.kind == "orifice"
            and chambers.start in path.nodes_a
        ]
        if not own:
            continue
        nodes = family.count * steps
        spaces[family.name] = {
            place: _corners(outline)
            for place, outline in _by_place(family, outlines, chambers, steps)
            if any(_near(outline, recess) for recess in recesses.values())
        }
        grooves += [
            {
                "family": family.name,
                "role": path.category.role,
                "recess": "groove_" + path.category.role.removesuffix("_groove"),
                "faces": path.multiplicity,
                "nodes": nodes,
            }
            for path in own
        ]
    return {"spaces": spaces, "grooves": grooves}


def kidney_cuts(case: Case, description: MachineDescription) -> dict[str, Any] | None:
    """Pockets of rotors at the angles of :func:`openings`, and the kidneys that they pass, in mm.

    The browser cuts them with kidneys whose edges move. None for other machines, kidneys from
    files and slots in the outer rotor.
    """
    ports: Any = getattr(case.machine, "ports", None)
    outlines = description.chamber_outlines
    if outlines is None or not hasattr(ports, "land_max_half_angle"):
        return None
    if ports.contour is not None or ports.radial_slot_width:
        return None
    kidney = description.outlines["port_inlet"]
    radii, angles = np.hypot(*kidney.T), np.arctan2(kidney[:, 1], kidney[:, 0])
    family = description.families[0]
    nodes = family.count * _steps(family)
    chambers = slice(0, family.count)
    return {
        "kidneys": {
            "land_max_half_angle": 90.0 - float(np.degrees(angles.max())),
            "land_min_half_angle": 90.0 + float(np.degrees(angles.min())),
            "inner_radius": _MM * float(radii.min()),
            "outer_radius": _MM * float(radii.max()),
        },
        "family": family.name,
        "nodes": nodes,
        "spaces": {
            place: _corners(outline)
            for place, outline in _by_place(family, outlines, chambers, _steps(family))
        },
    }


def _by_place(
    family: ChamberFamily, outlines: Any, chambers: slice, steps: int
) -> Iterator[tuple[int, Array]]:
    """Outlines of the chambers of a family by the node of the diagram at which they are."""
    nodes = family.count * steps
    step = family.volume.period / nodes
    for k in range(steps):
        shaft = (k * step - float(family.phases[0])) / family.angle_ratio
        places = np.rint((family.phases + family.angle_ratio * shaft) / step).astype(int)
        for place, outline in zip(places, outlines(shaft)[chambers], strict=True):
            yield int(place) % nodes, outline


def _corners(outline: Array) -> list[list[float]]:
    """Corners of an outline as the browser cuts it. [mm]."""
    line = shapely.LinearRing(outline).simplify(_DRAWN_ERROR)
    corners: list[list[float]] = np.round(_MM * shapely.get_coordinates(line), 4)[:-1].tolist()
    return corners


def _near(outline: Array, recess: Array) -> bool:
    """Whether an outline comes as near to a recess as a handle may move its edges."""
    room = np.ptp(recess, axis=0).max()
    low, high = recess.min(axis=0) - room, recess.max(axis=0) + room
    return bool(np.all(outline.max(axis=0) > low) and np.all(outline.min(axis=0) < high))


def volume(description: MachineDescription) -> dict[str, Any]:
    """Volume of a chamber of the first family over its own angle. [deg], [mm3]."""
    family = description.families[0]
    angle = np.linspace(0.0, family.volume.period, _OPENING_NODES)
    return {
        "angle": rounded(np.degrees(angle)),
        "values": rounded(family.volume(angle)[:, 0] * 1e9),
    }


def drawn_bodies(
    contents: FileContents, files: Iterable[Path], unit: float
) -> list[dict[str, Any]]:
    """Section of every body in solid files, across the axis of the largest gear. [mm].

    Parameters
    ----------
    contents : FileContents
        What was found in the files.
    files : iterable of Path
        The files.
    unit : float
        Length of one unit of files that have none of their own. [m]
    """
    from toothspace.core.errors import GeometryError
    from toothspace.geometry.body_section import SectionRequest
    from toothspace.geometry.cad_import import is_solid, load_body_sections

    teeth = {
        (gear.file, gear.body): (kind, gear)
        for kind, gears in (("gear", contents.gears), ("ring gear", contents.rings))
        for gear in gears
    }
    solid = [gear for _, gear in teeth.values() if gear.body is not None]
    if not solid:
        return []
    x, y, z = (float(v) for v in solid[0].axis)
    plane = float(solid[0].axis @ solid[0].center)
    request = SectionRequest((x, y, z), plane, missed=True)
    found: list[dict[str, Any]] = []
    for file in filter(is_solid, files):
        with suppress(GeometryError):
            found += [
                _drawn(file, cut, *teeth.get((file, cut.body), ("body", None)))
                for cut in load_body_sections(file, unit, request)
            ]
    return found


def _drawn(file: Path, cut: BodySection, kind: str, gear: FoundGear | None) -> dict[str, Any]:
    return {
        "file": file.name,
        "body": cut.body,
        "name": cut.name,
        "kind": kind,
        "teeth": None if gear is None else gear.detected.profile.tooth_count,
        "outlines": [
            _points(np.asarray(shapely.LinearRing(curve).simplify(_TURNING_ERROR).coords))
            for curve in cut.curves
        ],
    }


def rounded(values: Any, digits: int = 6) -> list[float | None]:
    """Return numbers with so many significant digits, None where there is none."""
    return [float(f"{x:.{digits}g}") if math.isfinite(x) else None for x in np.ravel(values)]


def _rings(region: Any, error: float = _DRAWN_ERROR) -> list[list[list[float]]]:
    """Outer and inner rings of an area, one after the other, simplified for a screen. [mm]."""
    rings = []
    simple = region.simplify(error)
    for polygon in getattr(simple, "geoms", [simple]):
        if polygon.geom_type == "Polygon" and not polygon.is_empty:
            for ring in (polygon.exterior, *polygon.interiors):
                rings.append(_points(np.asarray(ring.coords)[:, :2]))
    return rings


def _points(points: Array) -> list[list[float]]:
    """Points in mm, to a micrometre."""
    return np.round(_MM * points, 3).tolist()
