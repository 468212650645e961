"""From the keys of ``[machine.floating_bearing]`` to the definition of the floating bearing."""

from __future__ import annotations

from pathlib import Path
from typing import Any, cast

import shapely

from toothspace.core.keys import KeyRuleError
from toothspace.core.types import Array
from toothspace.gearing.gear_tables import read_contours
from toothspace.gearing.materials import library_material
from toothspace.machines.external_gear import floating_parameters as own
from toothspace.machines.external_gear import parameter_tables as keys
from toothspace.machines.external_gear import spec

_TABLE = "floating_bearing"


def floating_block(machine: keys.ExternalGearTables) -> spec.FloatingBlock | None:
    """Definition of the floating bearing of a machine, None without its table.

    Raises
    ------
    CaseError
        With the key relative to ``[machine]``.
    """
    given = machine.floating_bearing
    if given is None or given.high_pressure_area is None:
        return None
    housing = given.housing_contact or own.HousingContactParameters()
    return spec.FloatingBlock(
        material=library_material(given.material, f"{_TABLE}.material"),
        length=given.length or machine.journal_bearings.length,
        roughness=given.roughness,
        mass=given.mass,
        arrangement=cast(Any, machine.lateral.arrangement),
        motion=cast(Any, given.motion),
        split=given.split,
        springs=tuple(spec.Spring(force=s.force, x=s.x, y=s.y) for s in given.springs),
        seal_preload=given.seal_preload,
        contact_area=housing.area,
        friction_coefficient=housing.friction_coefficient,
        breakaway_speed=housing.breakaway_speed,
        friction_law=housing.law,
        axial_play=given.axial_play,
        wall_stiffness=given.wall_stiffness,
        shaft_stiffness=given.shaft_stiffness,
        gear_forces=given.gear_axial_force,
        **_high_pressure(given.high_pressure_area),
        **_nose(given.nose),
    )


def _high_pressure(area: own.PressureAreaParameters) -> dict[str, Any]:
    if area.contour is not None:
        contour = _contour(area.contour, f"{_TABLE}.high_pressure_area.contour")
        return {"high_pressure_contour": contour}
    if area.seal_line_x is not None:
        return {"seal_line": area.seal_line_x}
    return {"high_pressure_area": area.area, "high_pressure_center": area.center}


def _nose(nose: own.NoseParameters | None) -> dict[str, Any]:
    if nose is None:
        return {}
    if nose.contour is None:
        return {"nose_area": nose.area, "nose_center": nose.center}
    contour = _contour(nose.contour, f"{_TABLE}.nose.contour")
    shape = shapely.Polygon(contour)
    center = (float(shape.centroid.x), float(shape.centroid.y))
    return {"nose_area": float(shape.area), "nose_center": center, "nose_contour": contour}


def _contour(path: Path, key: str) -> Array:
    """Only polygon of a file. [m]."""
    polygons = read_contours(path, key)
    if len(polygons) != 1:
        found = f"{len(polygons)} polygons in {path.name}"
        raise KeyRuleError(key, found, "one polygon")
    return polygons[0]
