"""What a designer takes hold of: numbers of a case, where they lie in the section, their range."""

from __future__ import annotations

import math
from collections.abc import Iterator
from typing import Any

import numpy as np

from toothspace.advice import gear_rules
from toothspace.app.side_view import SideView
from toothspace.case import Case
from toothspace.core.keys import Bounded, Integer, QuantityKey, Table, keys_of
from toothspace.core.types import Array
from toothspace.core.units import ATMOSPHERIC_PRESSURE, from_si
from toothspace.gearing.materials import library_material, reduced_modulus
from toothspace.model.description import MachineDescription

_MM = 1e3
_REACH = 0.5
"""A slider reaches this share of its value to either side, within what the key allows. [-]"""
TABLES = ("machine", "fluid", "operating_point")
_LANDS = ("land_max_half_angle", "land_min_half_angle")
"""Half lands of gerotor kidneys at the largest and the smallest pocket."""
_MOTION_OF_GROOVES = {"closing_side_offset": "outlet", "opening_side_offset": "inlet"}
"""Port on whose side the edge of a groove lies: the trapped volume shrinks into the outlet."""


def handles_of(
    case: Case, description: MachineDescription, beside: SideView
) -> list[dict[str, Any]]:
    """Numbers of machine, fluid and condition that a case gives, with their place if they have one.

    Values are in the unit of the key; places in mm of the section: ``line`` moves along a
    direction [mm per unit], ``arc`` round a centre [rad per unit]. Those of the side view come
    with it.
    """
    places = beside.places | dict(_places(case, description))
    found = [
        _handle(path, key, value, places.get(path))
        for path, key, value, given in _numbers(case)
        if given or path in places
    ]
    return [*found, *_land_handles(case, description)]


def _handle(path: str, key: Any, value: float, place: Any) -> dict[str, Any]:
    low, high = _range(key, value)
    words = ", ".join(path.removeprefix("machine.").split(".")).replace("_", " ")
    return {
        "path": path,
        "label": words[:1].upper() + words[1:],
        "doc": key.doc,
        "unit": key.unit if isinstance(key, QuantityKey) else "",
        "whole": isinstance(key, Integer),
        "value": _in_unit(key, value),
        "low": low,
        "high": high,
        "place": place,
    }


def _land_handles(case: Case, description: MachineDescription) -> Iterator[dict[str, Any]]:
    """Edges of kidneys that change over at the extreme volumes, which no key gives as yet.

    One that is moved replaces the timing by both lands.
    """
    ports = getattr(case.machine, "ports", None)
    if getattr(ports, "timing", None) is None or getattr(ports, "contour", None) is not None:
        return
    keys, numbers = keys_of(type(ports)), description.geometry_summary
    lands = {name: math.radians(_number(numbers[f"kinematic_{name}_deg"])) for name in _LANDS}
    for name in _LANDS:
        key = keys[name][0]
        handle = _handle(f"machine.ports.{name}", key, lands[name], _land_place(name, description))
        others = {
            f"machine.ports.{other}": f"{_in_unit(key, lands[other])} deg"
            for other in _LANDS
            if other != name
        }
        yield handle | {"with": {"machine.ports.timing": None, **others}}


def _number(value: object) -> float:
    assert isinstance(value, float)
    return value


def _land_place(name: str, description: MachineDescription) -> dict[str, Any]:
    """Edge of a kidney beside a land, counted from the line of centres towards the inlet."""
    contour = description.outlines["port_inlet"]
    at_largest = name == _LANDS[0]
    radius = 0.5 * float(np.hypot(*contour.T).min() + np.hypot(*contour.T).max())
    zero, turn = (0.5 * math.pi, -1.0) if at_largest else (-0.5 * math.pi, 1.0)
    return _arc((0.0, 0.0), radius, turn, zero)


def closed_form_of(case: Case) -> dict[str, Any] | None:
    """What the browser computes a machine's numbers from while a handle moves.

    Kind of its formulas, all numbers of ``[machine]`` by key path in the unit of their key, and the
    limits of the design rules; None where gears or rotors come from files or have no closed form.
    """
    machine = case.machine
    kind, family = case.machine_type, None
    if kind == "gerotor":
        kind = machine.rotors.kind
    else:
        gears = [
            getattr(machine, name, None) for name in ("gears", "driven_gear", "pinion", "ring")
        ]
        if any(getattr(gear, "profile", None) is not None for gear in gears):
            return None
        family = getattr(gears[0], "family", "involute")
        if family != "involute":
            kind = "continuous_contact"
    return {
        "kind": kind,
        "family": family,
        "mode": machine.mode,
        "values": {
            path: _in_unit(key, value)
            for path, key, value, _ in _numbers(case)
            if path.startswith("machine.")
        },
        "limits": _limits(machine),
    }


def _limits(machine: Any) -> dict[str, Any]:
    """Limits of the design rules that the browser judges, in mm, um and MPa."""
    vented = getattr(machine, "relief_grooves", None) is not None
    limits: dict[str, Any] = {
        "contact_ratio": [gear_rules.MIN_CONTACT_RATIO, gear_rules.MAX_SPUR_CONTACT_RATIO],
        "tip_land": gear_rules.MIN_TIP_LAND,
        "root_clearance": gear_rules.MIN_ROOT_CLEARANCE,
        "backlash": gear_rules.MAX_BACKLASH,
        "trapped": gear_rules.VENTED_SHARE if vented else gear_rules.ENCLOSED_SHARE,
        "continuous_backlash": gear_rules.MAX_CONTINUOUS_BACKLASH,
        "curvature": gear_rules.MIN_CURVATURE,
        "overlap": gear_rules.OVERLAP_TOLERANCE,
        "bearing": gear_rules.RELATIVE_CLEARANCE,
        "cut": 1e6 * gear_rules.DEEPEST_CUT,
        "port_contour": getattr(getattr(machine, "ports", None), "contour", None) is not None,
    }
    gears, casing = getattr(machine, "gears", None), getattr(machine, "casing", None)
    if gears is not None and getattr(casing, "wear_in", None) is not None:
        driven = getattr(getattr(machine, "driven_gear", None), "material", None)
        materials = [
            library_material(name, "machine.gears.material")
            for name in (gears.material, driven or gears.material)
        ]
        limits |= {
            "strength": [1e-6 * limit for limit in gear_rules.STRENGTH_LIMITS],
            "modulus": 1e-6 * reduced_modulus(*materials),
            "radial_load": gear_rules.RADIAL_LOAD_COEFFICIENT,
            "atmosphere": 1e-6 * ATMOSPHERIC_PRESSURE,
        }
    return limits


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
        yield from _rotor_places(case, description)
    housing = getattr(machine, "housing", None)
    if housing is not None and hasattr(housing, "outer_rotor_diameter"):
        point = (0.5 * housing.outer_rotor_diameter, 0.0)
        yield "machine.housing.outer_rotor_diameter", _line(point, (0.5e-3, 0.0))
    if hasattr(machine, "pinion"):
        tip = float(np.hypot(*outlines[first.name].T).max())
        point = (first.center[0] - tip, first.center[1])
        yield "machine.pinion.tip_diameter", _line(point, (-0.5e-3, 0.0))
        yield from _mesh_places("pinion", case, description)
        yield from _filler_places(case, description)
    if len(description.bodies) > 1 and hasattr(machine, "gears"):
        second = description.bodies[1]
        tip = float(np.hypot(*outlines[second.name].T).max())
        point = (second.center[0], second.center[1] + tip)
        yield "machine.gears.tip_diameter", _line(point, (0.0, 0.5e-3))
        yield from _mesh_places("gears", case, description)


def _mesh_places(
    table: str, case: Case, description: MachineDescription
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Profile shift at the root of the first gear, the mesh's play at the centre of the second."""
    gear, (first, second) = getattr(case.machine, table), description.bodies[:2]
    # tips that roll through roots have no shift
    if gear.module is not None and not getattr(gear, "is_continuous", False):
        root = float(np.hypot(*description.outlines[first.name].T).min())
        place = _line((first.center[0], first.center[1] - root), (0.0, -gear.module))
        yield f"machine.{table}.profile_shift", place
    away = math.copysign(1e-3, second.center[1])
    yield f"machine.{table}.center_distance", _line(second.center, (0.0, away))
    angle = description.geometry_summary.get("operating_pressure_angle_deg")
    if isinstance(angle, float):
        # an external pair moves apart for more play, a ring with its pinion together
        share = 0.5e-3 / math.sin(math.radians(angle))
        yield f"machine.{table}.normal_backlash", _line(second.center, (0.0, share))


def _rotor_places(
    case: Case, description: MachineDescription
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Lobe of the outer rotor beside the smallest pocket, and the kidneys."""
    rotors, ports = case.machine.rotors, case.machine.ports
    if rotors.generating_radius is not None and rotors.lobe_radius is not None:
        angle = -0.5 * math.pi + math.pi / (rotors.inner_tooth_count + 1)
        out = np.array([math.cos(angle), math.sin(angle)])
        center = rotors.generating_radius * out
        inner = center - rotors.lobe_radius * out
        yield "machine.rotors.generating_radius", _line(tuple(center), tuple(1e-3 * out))
        yield "machine.rotors.lobe_radius", _line(tuple(inner), tuple(-1e-3 * out))
    for name, angle in (("inner_radius", 0.2), ("outer_radius", -0.2)):
        radius = getattr(ports, name)
        if radius is not None and ports.contour is None:
            out = np.array([math.cos(angle), math.sin(angle)])
            yield f"machine.ports.{name}", _line(tuple(radius * out), tuple(1e-3 * out))
    for name in _LANDS:
        if getattr(ports, name) is not None:
            yield f"machine.ports.{name}", _land_place(name, description)


def _filler_places(
    case: Case, description: MachineDescription
) -> Iterator[tuple[str, dict[str, Any]]]:
    """Ends of the crescent and begins of the recesses, about the centre of the pinion."""
    pinion = description.bodies[0]
    tip = float(np.hypot(*description.outlines[pinion.name].T).max())
    for table, end in (("filler", "angle"), ("ports", "start")):
        for port, turn in (("inlet", 1.0), ("outlet", -1.0)):
            yield f"machine.{table}.{port}_{end}", _arc(pinion.center, tip, turn)


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
        yield f"machine.casing.{port}_angle", _arc(body.center, radius, turn)


def _arc(
    center: tuple[float, float], radius: float, turn: float, zero: float = 0.5 * math.pi
) -> dict[str, Any]:
    """Handle on a circle [m] that turns by so many degrees for each of its key, from an angle."""
    return {
        "kind": "arc",
        "center": [_MM * x for x in center],
        "radius": _MM * radius,
        "zero": zero,
        "turn": turn * math.radians(1.0),
    }


def _line(point: tuple[float, float], direction: tuple[float, float]) -> dict[str, Any]:
    """Handle at a point [m] that moves by a direction for each unit of its key. [m]."""
    return {
        "kind": "line",
        "point": [round(_MM * x, 5) for x in point],
        "direction": [_MM * x for x in direction],
    }
