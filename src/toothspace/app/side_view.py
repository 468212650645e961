"""The machine from the side, beside its section: widths and gaps along the axis, with handles."""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, field
from typing import Any, final

import numpy as np

from toothspace.case import Case
from toothspace.model.description import MachineDescription
from toothspace.plotting.section import housing_region

_MM, _UM = 1e3, 1e6
_SHOWN_GAP = 2.0
"""A gap is drawn up to so wide. [mm]"""
_TIMES = (500, 200, 100, 50, 20, 10, 5, 2)
"""How many times its size a gap may be drawn."""
_BESIDE = 0.12
"""Room between section and side view over the height of the casing. [-]"""
_COVER = 0.12
"""Thickness of covers over the height of the casing. [-]"""
_GEARS = ("gears", "pinion", "rotors")

Moves = dict[str, list[float]]
"""By key: how far the four edges of a part move for a unit of the key. [mm]"""


@final
@dataclass
class SideView:
    """Rectangles of a cut along the axis, in mm of the section beside which it stands."""

    parts: list[dict[str, Any]] = field(default_factory=list)
    """Kind, edges ``x0, x1, y0, y1`` and what moves them; those behind come first."""
    places: dict[str, dict[str, Any]] = field(default_factory=dict)
    """Handles by key."""

    def part(self, kind: str, edges: list[float], moves: Moves) -> None:
        """Add a rectangle."""
        self.parts.append({"kind": kind, "edges": [round(x, 4) for x in edges], "moves": moves})

    def handle(
        self, path: str, point: tuple[float, float], move: tuple[float, float], times: int = 1
    ) -> None:
        """Add a handle at a point, which moves so far for a unit of its key; ``times`` its size."""
        self.places[path] = {
            "kind": "line",
            "point": [round(x, 4) for x in point],
            "direction": list(move),
            "times": times,
        }


def side_view(case: Case, description: MachineDescription) -> SideView:
    """Return the bodies between their covers or bushings, gaps drawn larger than they are.

    Parameters
    ----------
    case : Case
        Case with a machine.
    description : MachineDescription
        Its tables.
    """
    machine, view = case.machine, SideView()
    own = next(((n, t) for n in _GEARS if (t := getattr(machine, n, None)) is not None), None)
    gaps = list(_gaps(getattr(machine, "lateral", None)))
    width = None if own is None else getattr(own[1], "face_width", None)
    if own is None or width is None or len(gaps) != 2:
        return view
    _, low, right, high = (_MM * x for x in housing_region(description).bounds)
    bearings = getattr(machine, "journal_bearings", None)
    length = getattr(bearings, "length", None)
    face, bush = f"machine.{own[0]}.face_width", "machine.journal_bearings.length"
    block = _COVER * (high - low) if length is None else _MM * length
    times = _times(max(height for _, height in gaps))
    (first, height_a), (second, height_b) = gaps
    shift = times / _UM * _MM
    start = right + _BESIDE * (high - low)
    begin = start + block
    gear = begin + times * _MM * height_a
    end = gear + _MM * width
    far = end + times * _MM * height_b
    # what a unit of a key adds to the places of the two faces of the gear and the block behind it
    at_gear: dict[str, float] = {first: shift} | ({bush: 1.0} if length is not None else {})
    at_end = at_gear | {face: 1.0}
    at_far = at_end | {second: at_end.get(second, 0.0) + shift}
    stop = far + block
    at_stop = {**at_far, **({bush: 2.0} if length is not None else {})}

    def moved(*ends: dict[str, float]) -> Moves:
        keys = {key for one in ends for key in one}
        return {key: [*(one.get(key, 0.0) for one in ends), 0.0, 0.0] for key in keys}

    nothing: dict[str, float] = {}
    at_begin = {bush: 1.0} if length is not None else nothing
    view.part("wall", [start, begin, low, high], moved(nothing, at_begin))
    view.part("wall", [far, stop, low, high], moved(at_far, at_stop))
    reaches = [
        _MM * float(np.hypot(*description.outlines[body.name].T).max())
        for body in description.bodies
    ]
    bodies = list(zip(description.bodies, reaches, strict=True))
    for body, reach in sorted(bodies, key=lambda one: -one[1]):
        middle = _MM * body.center[1]
        view.part("metal", [gear, end, middle - reach, middle + reach], moved(at_gear, at_end))
    drive, reach = bodies[0]
    middle = _MM * drive.center[1]
    top = max(_MM * body.center[1] + reach for body, reach in bodies)
    view.handle(face, (end, middle - 0.85 * reach), (1.0, 0.0))
    view.handle(first, (gear, middle - 0.6 * reach), (shift, 0.0), times)
    if second != first:
        view.handle(second, (far, middle - 0.6 * reach), (shift, 0.0), times)
    if bearings is not None:
        _shafts(view, case, description, (start, stop), moved(nothing, at_stop))
        if length is not None:
            view.handle(bush, (stop, middle - 0.85 * reach), (2.0, 0.0))
    grooves = getattr(machine, "relief_grooves", None)
    if grooves is not None and getattr(grooves, "depth", None) is not None:
        path = "machine.relief_grooves.depth"
        outline = description.outlines.get("groove_outlet")
        if outline is not None:
            y0, y1 = _MM * float(outline[:, 1].min()), _MM * float(outline[:, 1].max())
            depth = _MM * grooves.depth
            moves = moved(at_begin, at_begin)
            view.part("groove", [begin - depth, begin, y0, y1], moves | {path: [-1.0, 0, 0, 0]})
            view.handle(path, (begin - depth, 0.5 * (y0 + y1)), (-1.0, 0.0))
    casing = getattr(machine, "casing", None)
    if casing is not None:
        path, room = "machine.casing.radial_clearance", casing.radial_clearance
        times = _times(room)
        bore = top + times * _MM * room
        step = times / _UM * _MM
        moves = moved(at_gear, at_end) | {path: [0.0, 0.0, step, 0.0]}
        view.part("wall", [gear, end, bore, max(high, bore + 1.0)], moves)
        view.handle(path, (0.5 * (gear + end), bore), (0.0, step), times)
    return view


def _gaps(lateral: Any) -> Iterator[tuple[str, float]]:
    """Keys and heights of the film at both faces."""
    if lateral is None:
        return
    for name in getattr(lateral, "each", ("side_gap", "side_gap")):
        own = getattr(lateral, name, None)
        given = name if own is not None else "side_gap"
        height = getattr(lateral, given, None)
        if height is not None:
            yield f"machine.lateral.{given}", height


def _times(height: float) -> int:
    return next((times for times in _TIMES if times * _MM * height <= _SHOWN_GAP), 1)


def _shafts(
    view: SideView,
    case: Case,
    description: MachineDescription,
    ends: tuple[float, float],
    moves: Moves,
) -> None:
    """Journals in their bores, the clearance drawn larger than it is."""
    room = case.machine.journal_bearings.radial_clearance
    path, times = "machine.journal_bearings.radial_clearance", _times(room)
    diameter, wide, step = (
        "machine.journal_bearings.diameter",
        times * _MM * room,
        times / _UM * _MM,
    )
    metal = [part for part in view.parts if part["kind"] == "metal"]
    for k, journal in enumerate(description.journals):
        body = next((one for one in description.bodies if one.name == journal.body), None)
        if body is None or journal.diameter != case.machine.journal_bearings.diameter:
            continue
        middle, radius = _MM * body.center[1], 0.5 * _MM * journal.diameter
        grown = {diameter: [0.0, 0.0, -0.5, 0.5]}
        hole = moves | grown | {path: [0.0, 0.0, -step, step]}
        edges = [*ends, middle - radius - wide, middle + radius + wide]
        at = view.parts.index(metal[0])
        view.parts.insert(at, {"kind": "gap", "edges": edges, "moves": hole})
        view.part("metal", [*ends, middle - radius, middle + radius], moves | grown)
        if k == 0:
            point = 0.9 * ends[0] + 0.1 * ends[1], middle - radius - wide
            view.handle(path, point, (0.0, -step), times)
