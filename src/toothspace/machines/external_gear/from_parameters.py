"""From the keys of a case file to the definition of an external gear machine."""

from __future__ import annotations

from dataclasses import fields, replace
from pathlib import Path
from typing import Any, Literal, cast

from toothspace.closures.journal_friction import PUBLISHED
from toothspace.core.errors import GeometryError
from toothspace.core.frozen import Points
from toothspace.core.keys import KeyRuleError, Problem
from toothspace.core.types import Array
from toothspace.geometry.cad_import import load_closed_curves
from toothspace.geometry.gear_pair import pair_from_backlash, pair_from_center_distance
from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.involute import InvoluteGear, tooth_form
from toothspace.geometry.polygon import checked_polygon
from toothspace.geometry.profile_detection import DetectedGear
from toothspace.library import load_material
from toothspace.machines.external_gear import parameter_tables as keys
from toothspace.machines.external_gear import spec
from toothspace.machines.external_gear.floating_from_parameters import body_files, floating_block
from toothspace.machines.external_gear.gear_files import check_unit, detected_gear
from toothspace.machines.external_gear.shaft_seal import seal_torque
from toothspace.model.description import StartupFriction

_TOOTH_KEYS = (
    "tooth_count",
    "module",
    "pressure_angle",
    "profile_shift",
    "dedendum",
    "tool_tip_radius",
    "tip_diameter",
    "tip_rounding",
)


def spec_from(machine: keys.ExternalGearTables) -> spec.ExternalGearSpec:
    """Build profiles, contours and materials of a machine.

    Parameters
    ----------
    machine : ExternalGearParameters
        Keys in SI units.

    Returns
    -------
    ExternalGearSpec
        Everything that the machine type needs.

    Raises
    ------
    CaseError
        With the key relative to ``[machine]``.
    """
    driven_keys = _driven_keys(machine)
    drive = _gear(machine.gears, "gears")
    driven = drive if driven_keys == machine.gears else _gear(driven_keys, "driven_gear")
    check_unit(machine, machine.gears, drive, "gears")
    check_unit(machine, driven_keys, driven, "driven_gear")
    _check_pair(machine, drive, driven)
    return spec.ExternalGearSpec(
        drive=drive,
        driven=driven,
        casing=_casing(machine.casing),
        journals=_journals(machine),
        lateral=_lateral(machine.lateral),
        grooves=_grooves(machine.relief_grooves),
        floating_block=floating_block(machine),
        body_files=body_files(machine),
        mode=cast(Literal["pump", "motor"], machine.mode),
        center_distance=machine.gears.center_distance,
        normal_backlash=machine.gears.normal_backlash,
        drain=cast(Literal["inlet", "outlet", "external"] | None, machine.drain),
        drain_pressure=1e5 if machine.drain_pressure is None else machine.drain_pressure,
        seal_torque=seal_torque(machine.seals, machine.journal_bearings.diameter),
        startup=_startup(machine.startup),
        inlet_volume=machine.inlet.volume,
        outlet_volume=machine.outlet.volume,
    )


def _startup(startup: keys.StartupParameters | None) -> StartupFriction | None:
    if startup is None or startup.breakaway_torque == 0.0:
        return None
    additive = startup.breakaway == "additive"
    return StartupFriction(startup.breakaway_torque, startup.breakaway_speed, additive)


def _check_pair(machine: keys.ExternalGearTables, drive: spec.Gear, driven: spec.Gear) -> None:
    first, second = drive.tooth, driven.tooth
    root = min(gear.root_radius for gear in (first, second))
    if machine.journal_bearings.diameter >= 2.0 * root:
        found = f"{machine.journal_bearings.diameter * 1e3:.5g} mm"
        allowed = f"below the root diameter of the gears, {root * 2e3:.5g} mm"
        raise KeyRuleError("journal_bearings.diameter", found, allowed)
    if not (isinstance(first, InvoluteGear) and isinstance(second, InvoluteGear)):
        return
    try:
        if machine.gears.center_distance is not None:
            pair_from_center_distance(first, second, machine.gears.center_distance)
        else:
            pair_from_backlash(first, second, machine.gears.normal_backlash or 0.0)
    except GeometryError as error:
        table = "" if str(error).startswith("driven_gear") else "gears."
        raise GeometryError(f"{table}{error}") from error


def _driven_keys(machine: keys.ExternalGearTables) -> keys.GearParameters:
    if machine.driven_gear is None:
        return machine.gears
    given = {
        f.name: getattr(machine.driven_gear, f.name)
        for f in fields(machine.driven_gear)
        if getattr(machine.driven_gear, f.name) is not None
    }
    base = machine.gears
    if machine.driven_gear.profile is not None:
        own: dict[str, Any] = {
            f.name: f.default for f in fields(base) if f.name in keys.PROFILE_KEYS
        }
        base = replace(base, profile=machine.driven_gear.profile, **own)
    try:
        return replace(base, **given)
    except KeyRuleError as error:
        raise KeyRuleError.of(
            Problem(f"driven_gear.{problem.key}", *problem[1:]) for problem in error.problems
        ) from error


def _gear(gear: keys.GearParameters, table: str) -> spec.Gear:
    found = None if gear.profile is None else detected_gear(gear, gear.profile, table)
    return spec.Gear(
        tooth=_generated(gear, table) if found is None else _tooth(gear, found.detected),
        face_width=gear.face_width,
        material=_material(gear.material, f"{table}.material"),
        roughness=gear.roughness,
        tip_rounding=gear.tip_rounding,
        found=found,
    )


def _tooth(gear: keys.GearParameters, detected: DetectedGear) -> GearProfile:
    return detected.drawn if gear.profile_flank == "drawn" else detected.profile


def _generated(gear: keys.GearParameters, table: str) -> InvoluteGear:
    values: dict[str, Any] = {name: getattr(gear, name) for name in _TOOTH_KEYS}
    try:
        tooth = InvoluteGear(**values)
        tooth_form(tooth)
    except GeometryError as error:
        raise GeometryError(f"{table}.{error}") from error
    return tooth


def _material(name: str, key: str) -> spec.Material:
    data = load_material(name, key)
    return spec.Material(
        elastic_modulus=data["elastic_modulus"],
        poisson_ratio=data["poisson_ratio"],
        hardness=data["hardness"],
        density=data["density"],
    )


def _casing(casing: keys.CasingParameters) -> spec.Casing:
    wear = casing.wear_in
    return spec.Casing(
        radial_clearance=casing.radial_clearance,
        inlet_angle=casing.inlet_angle,
        outlet_angle=casing.outlet_angle,
        contour=None if casing.contour is None else _contours(casing.contour, "casing.contour")[0],
        wear_in=wear
        and spec.WearIn(
            pressure=wear.pressure, shaft_speed=wear.shaft_speed, temperature=wear.temperature
        ),
    )


def _journals(machine: keys.ExternalGearTables) -> spec.JournalBearings:
    bearing, blocks = machine.journal_bearings, machine.bearing_blocks
    return spec.JournalBearings(
        diameter=bearing.diameter,
        length=bearing.length,
        radial_clearance=bearing.radial_clearance,
        roughness_shaft=bearing.roughness_shaft,
        roughness_bush=bearing.roughness_bush,
        boundary_friction=bearing.boundary_friction,
        material=_material(bearing.material, "journal_bearings.material"),
        seat_clearance=blocks.radial_clearance if blocks else 0.0,
        friction=PUBLISHED if bearing.friction == "published_curve" else None,
    )


def _lateral(lateral: keys.LateralParameters) -> spec.LateralGaps:
    floating = lateral.side_gap_floating if lateral.side_gap is None else lateral.side_gap
    solid = lateral.side_gap_solid if lateral.side_gap is None else lateral.side_gap
    assert floating is not None
    assert solid is not None
    return spec.LateralGaps(side_gap_floating=floating, side_gap_solid=solid, tilt=lateral.tilt)


def _grooves(grooves: keys.ReliefGrooveParameters | None) -> spec.ReliefGrooves | None:
    if grooves is None:
        return None
    sides = _groove_sides(grooves.contour) if grooves.contour else (None, None)
    return spec.ReliefGrooves(
        closing_side_offset=_offset(grooves.closing_side_offset, sides[0], 1.0),
        opening_side_offset=_offset(grooves.opening_side_offset, sides[1], -1.0),
        width=grooves.width,
        radial_extent=grooves.radial_extent,
        depth=grooves.depth,
        closing_contour=sides[0],
        opening_contour=sides[1],
    )


def _offset(given: float | None, contour: Array | None, side: float) -> float:
    if given is not None:
        return given
    return 0.0 if contour is None else float((side * contour[:, 0]).min())


def _groove_sides(file: Path) -> tuple[Array | None, Array | None]:
    found: dict[bool, Array] = {}
    for polygon in _contours(file, "relief_grooves.contour"):
        closing = bool(polygon[:, 0].mean() > 0.0)
        if closing in found:
            side = "right" if closing else "left"
            raise KeyRuleError(
                "relief_grooves.contour",
                f"two polygons {side} of the centre line in {file.name}",
                "one polygon on each side",
            )
        found[closing] = polygon
    return found.get(True), found.get(False)


def _contours(file: Path | Points, key: str) -> list[Array]:
    try:
        curves = load_closed_curves(file, 1e-3)
        return [checked_polygon(curve, file.name) for curve in curves]
    except GeometryError as error:
        raise GeometryError(f"{key}: {error}") from error
    except Exception as error:
        # readers of damaged CAD files fail in ways of their own
        found = f"{file.name} that cannot be read ({type(error).__name__})"
        raise GeometryError(f"{key}: found {found}, allowed an intact file") from error
