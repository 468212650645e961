"""From the keys of a case file to the definition of an external gear machine."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import Any

from toothspace.closures.journal_friction import PUBLISHED
from toothspace.core.errors import GeometryError
from toothspace.core.keys import KeyRuleError, Problem
from toothspace.gearing.gear_tables import read_contours
from toothspace.gearing.materials import library_material
from toothspace.geometry.gear_pair import pair_from_backlash, pair_from_center_distance
from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.involute import InvoluteGear
from toothspace.machines.external_gear import parameter_tables as keys
from toothspace.machines.external_gear import spec
from toothspace.machines.external_gear.floating_from_parameters import floating_block
from toothspace.machines.external_gear.gear_files import detected_gear
from toothspace.machines.external_gear.shaft_seal import seal_torque
from toothspace.model.description import RunningIn, StartupFriction


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
    for table, given, built in (
        ("gears", machine.gears, drive),
        ("driven_gear", driven_keys, driven),
    ):
        if built.found is not None:
            from toothspace.machines.external_gear.gear_files import check_unit

            check_unit(machine, given, built.found.detected.profile, table)
    _check_pair(machine, drive, driven)
    return spec.ExternalGearSpec(
        drive=drive,
        driven=driven,
        casing=_casing(machine.casing),
        journals=_journals(machine),
        lateral=_lateral(machine.lateral),
        grooves=machine.relief_grooves.grooves() if machine.relief_grooves else None,
        floating_block=floating_block(machine),
        body_files=machine.elastic_bodies,
        mode=machine.use,
        center_distance=machine.gears.center_distance,
        normal_backlash=machine.gears.normal_backlash,
        drain=machine.drain_node,
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
    tooth: InvoluteGear | GearProfile
    if found is None:
        tooth = gear.involute_gear(table)
    else:
        drawn = gear.profile_flank == "drawn"
        tooth = found.detected.drawn if drawn else found.detected.profile
    return spec.Gear(
        tooth=tooth,
        face_width=gear.face_width,
        material=library_material(gear.material, f"{table}.material"),
        roughness=gear.roughness,
        tip_rounding=gear.tip_rounding,
        found=found,
    )


def _casing(casing: keys.CasingParameters) -> spec.Casing:
    wear, file = casing.wear_in, casing.contour
    return spec.Casing(
        radial_clearance=casing.radial_clearance,
        inlet_angle=casing.inlet_angle,
        outlet_angle=casing.outlet_angle,
        contour=None if file is None else read_contours(file, "casing.contour")[0],
        wear_in=wear and RunningIn(wear.pressure, wear.shaft_speed, wear.temperature),
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
        material=library_material(bearing.material, "journal_bearings.material"),
        seat_clearance=blocks.radial_clearance if blocks else 0.0,
        friction=PUBLISHED if bearing.friction == "published_curve" else None,
    )


def _lateral(lateral: keys.LateralParameters) -> spec.LateralGaps:
    floating = lateral.side_gap_floating if lateral.side_gap is None else lateral.side_gap
    solid = lateral.side_gap_solid if lateral.side_gap is None else lateral.side_gap
    assert floating is not None
    assert solid is not None
    return spec.LateralGaps(side_gap_floating=floating, side_gap_solid=solid, tilt=lateral.tilt)
