"""What a designer takes hold of: numbers of a case, where they lie in the section, their range."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from toothspace.case import Case
from toothspace.core.keys import Bounded, Integer, QuantityKey, Table, keys_of
from toothspace.core.types import Array
from toothspace.core.units import from_si
from toothspace.model.description import MachineDescription

_MM = 1e3
_REACH = 0.5
"""A slider reaches this share of its value to either side, within what the key allows. [-]"""
TABLES = ("machine", "fluid", "operating_point")
_MOTION_OF_GROOVES = {"closing_side_offset": "outlet", "opening_side_offset": "inlet"}
"""Port on whose side the edge of a groove lies: the trapped volume shrinks into the outlet."""


def handles_of(case: Case, description: MachineDescription) -> list[dict[str, Any]]:
    """Numbers of machine, fluid and condition that a case gives, with their place if they have one.

    Values are in the unit of the key; places in mm of the section: ``line`` moves along a
    direction [mm per unit], ``arc`` round a centre [rad per unit].
    """
    places = {path: place for path, place in _places(case, description)}
    found = []
    for path, key, value, given in _numbers(case):
        if not given and path not in places:
            continue
        low, high = _range(key, value)
        found.append(
            {
                "path": path,
                "label": _label(path),
                "doc": key.doc,
                "unit": key.unit if isinstance(key, QuantityKey) else "",
                "whole": isinstance(key, Integer),
                "value": _in_unit(key, value),
                "low": low,
                "high": high,
                "place": places.get(path),
            }
        )
    return found


def _numbers(case: Case) -> Iterator[tuple[str, Any, float, bool]]:
    given = case.to_dict()
    for name in TABLES:
        table = getattr(case, name)
        if table is not None:
            yield from _of_table(name, table, given.get(name, {}))


def _of_table(path: str, table: Any, given: Any) -> Iterator[tuple[str, Any, float, bool]]:
    """Numbers of a table, and whether the case gives them itself."""
    for name, (key, _) in keys_of(type(table)).items():
        value = getattr(table, name)
        if value is None:
            continue
        if isinstance(key, Table):
            yield from _of_table(f"{path}.{name}", value, given.get(name, {}))
        elif isinstance(key, QuantityKey | Bounded | Integer) and isinstance(value, int | float):
            yield f"{path}.{name}", key, value, name in given


def _in_unit(key: Any, value: float) -> float:
    found = from_si(value, key.unit) if isinstance(key, QuantityKey) else value
    return float(f"{found:.9g}")


def _range(key: Any, value: float) -> tuple[float, float]:
    """Where a slider ends, in the unit of the key."""
    own = _in_unit(key, value)
    if isinstance(key, Integer):
        return max(key.low, own - 4), min(key.high, own + 4)
    room = _REACH * abs(own) or 0.5
    low, high = own - room, own + room
    least = max(x for x in (key.low, key.above, -math.inf) if x is not None)
    most = min(x for x in (key.high, math.inf) if x is not None)
    if own > 0.0 and least <= 0.0:
        low = max(low, 0.05 * own)
    return max(low, least), min(high, most)


def _label(path: str) -> str:
    """Key path in plain words, without the name of the table of tables."""
    words = path.removeprefix("machine.").split(".")
    text = ", ".join(word.replace("_", " ") for word in words)
    return text[:1].upper() + text[1:]


def _places(case: Case, description: MachineDescription) -> Iterator[tuple[str, dict[str, Any]]]:
    """Places in the section of the numbers that have one."""
    machine, outlines = case.machine, description.outlines
    grooves = getattr(machine, "relief_grooves", None)
    for name, port in _MOTION_OF_GROOVES.items():
        outline = outlines.get(f"groove_{port}")
        if grooves is not None and outline is not None:
            yield from _groove_places(f"machine.relief_grooves.{name}", outline)
    outline = outlines.get("groove_outlet")
    if grooves is not None and outline is not None and outline.shape[0] == 4:
        yield from _groove_size_places(outline)
    yield from _port_places(case, description)
    bearings = getattr(machine, "journal_bearings", None)
    first = description.bodies[0]
    if bearings is not None:
        point = (first.center[0], first.center[1] - 0.5 * bearings.diameter)
        yield "machine.journal_bearings.diameter", _line(point, (0.0, -0.5 * 1e-3))
    if hasattr(machine, "rotors"):
        yield "machine.rotors.eccentricity", _line(first.center, (0.0, -1e-3))
    housing = getattr(machine, "housing", None)
    if housing is not None and hasattr(housing, "outer_rotor_diameter"):
        point = (0.5 * housing.outer_rotor_diameter, 0.0)
        yield "machine.housing.outer_rotor_diameter", _line(point, (0.5e-3, 0.0))
    if hasattr(machine, "pinion"):
        tip = float(np.hypot(*outlines[first.name].T).max())
        point = (first.center[0] - tip, first.center[1])
        yield "machine.pinion.tip_diameter", _line(point, (-0.5e-3, 0.0))
    if len(description.bodies) > 1 and hasattr(machine, "gears"):
        second = description.bodies[1]
        yield "machine.gears.center_distance", _line(second.center, (0.0, 1e-3))
        tip = float(np.hypot(*outlines[second.name].T).max())
        point = (second.center[0], second.center[1] + tip)
        yield "machine.gears.tip_diameter", _line(point, (0.0, 0.5e-3))


def _groove_places(path: str, outline: Array) -> Iterator[tuple[str, dict[str, Any]]]:
    side = math.copysign(1.0, float(outline[:, 0].mean()))
    edge = side * float((side * outline[:, 0]).min())
    near = outline[np.isclose(outline[:, 0], edge, atol=1e-6)]
    yield path, _line((edge, float(near[:, 1].mean())), (side * 1e-3, 0.0))


def _groove_size_places(outline: Array) -> Iterator[tuple[str, dict[str, Any]]]:
    side = math.copysign(1.0, float(outline[:, 0].mean()))
    far = side * float((side * outline[:, 0]).max())
    middle, top = float(outline[:, 1].mean()), float(outline[:, 1].max())
    yield "machine.relief_grooves.width", _line((far, middle), (side * 1e-3, 0.0))
    centre = float(outline[:, 0].mean())
    yield "machine.relief_grooves.radial_extent", _line((centre, top), (0.0, 0.5e-3))


def _port_places(
    case: Case, description: MachineDescription
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Port edges on the bore of the first body, counted from the side of the mesh."""
    casing = getattr(case.machine, "casing", None)
    if casing is None or not hasattr(casing, "inlet_angle"):
        return
    body = description.bodies[0]
    radius = float(np.hypot(*description.outlines[body.name].T).max())
    for port, turn in (("inlet", 1.0), ("outlet", -1.0)):
        yield (
            f"machine.casing.{port}_angle",
            {
                "kind": "arc",
                "center": [_MM * x for x in body.center],
                "radius": _MM * radius,
                "zero": 0.5 * math.pi,
                "turn": turn * math.radians(1.0),
            },
        )


def _line(point: tuple[float, float], direction: tuple[float, float]) -> dict[str, Any]:
    """Handle at a point [m] that moves by a direction for each unit of its key. [m]."""
    return {
        "kind": "line",
        "point": [round(_MM * x, 5) for x in point],
        "direction": [_MM * x for x in direction],
    }
