"""From the keys of a case file to the definition of an external gear machine."""

from __future__ import annotations

from dataclasses import fields, replace
from typing import TYPE_CHECKING, Any

from toothspace.closures.journal_friction import PUBLISHED
from toothspace.core.errors import CaseError, GeometryError
from toothspace.core.keys import KeyRuleError, Problem
from toothspace.gearing.gear_tables import ReliefGrooves, read_contours
from toothspace.gearing.materials import library_material
from toothspace.geometry.cad_import import is_solid
from toothspace.geometry.gear_pair import pair_from_backlash, pair_from_center_distance
from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.involute import InvoluteGear, generate_profile
from toothspace.machines.external_gear import parameter_tables as keys
from toothspace.machines.external_gear import spec
from toothspace.machines.external_gear.floating_from_parameters import floating_block
from toothspace.machines.external_gear.shaft_seal import seal_torque
from toothspace.model.description import RunningIn, StartupFriction

if TYPE_CHECKING:
    from toothspace.geometry.gear_finder import FoundGear
    from toothspace.geometry.tooth_deviations import ToothDeviations


def spec_from(machine: keys.ExternalGearTables) -> spec.ExternalGearSpec:
    """Build profiles, contours and materials of a machine.

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
    for name, given, built in (
        ("gears", machine.gears, drive),
        ("driven_gear", driven_keys, driven),
    ):
        if built.found is not None:
            from toothspace.machines.external_gear.gear_files import check_unit

            check_unit(machine, given, built.found.detected.profile, name)
    in_file = None
    if machine.gears.center_distance is None and machine.gears.normal_backlash is None:
        from toothspace.machines.external_gear.solid_contours import distance_in_file

        in_file = distance_in_file(machine, drive, driven)
    distance = _check_pair(machine, drive, driven, in_file)
    return spec.ExternalGearSpec(
        drive=drive,
        driven=driven,
        casing=_casing(machine, drive, driven),
        journals=_journals(machine),
        lateral=_lateral(machine.lateral),
        grooves=_grooves(machine, drive, driven, distance),
        floating_block=floating_block(machine),
        body_files=machine.elastic_bodies,
        mode=machine.use,
        center_distance=in_file or machine.gears.center_distance,
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


def _check_pair(
    machine: keys.ExternalGearTables, drive: spec.Gear, driven: spec.Gear, in_file: float | None
) -> float:
    # returns the centre distance, of profiles with a given backlash about
    first, second = drive.tooth, driven.tooth
    root = min(gear.root_radius for gear in (first, second))
    if machine.journal_bearings.diameter >= 2.0 * root:
        found = f"{machine.journal_bearings.diameter * 1e3:.5g} mm"
        allowed = f"below the root diameter of the gears, {root * 2e3:.5g} mm"
        raise KeyRuleError("journal_bearings.diameter", found, allowed)
    distance = in_file or machine.gears.center_distance
    if not (isinstance(first, InvoluteGear) and isinstance(second, InvoluteGear)):
        return distance or first.tip_radius + second.root_radius
    try:
        if distance is not None:
            return pair_from_center_distance(first, second, distance).center_distance
        backlash = machine.gears.normal_backlash or 0.0
        return pair_from_backlash(first, second, backlash).center_distance
    except GeometryError as error:
        table = "" if str(error).startswith("driven_gear") else "gears."
        raise GeometryError(f"{table}{error}") from error


def _driven_keys(machine: keys.ExternalGearTables) -> keys.GearParameters:
    # a measured gear is one of its kind: its deviations are not those of the other gear
    base = replace(machine.gears, tooth_deviations=None)
    if machine.driven_gear is None:
        return base
    given = {
        f.name: getattr(machine.driven_gear, f.name)
        for f in fields(machine.driven_gear)
        if getattr(machine.driven_gear, f.name) is not None
    }
    if machine.driven_gear.profile is not None:
        own: dict[str, Any] = {
            f.name: f.default for f in fields(base) if f.name in keys.PROFILE_KEYS
        }
        base = replace(base, profile=machine.driven_gear.profile, **own)
    elif {"profile_part", "profile_body"} & given.keys():
        base = replace(base, profile_part=None, profile_body=None)
    try:
        return replace(base, **given)
    except KeyRuleError as error:
        raise KeyRuleError.of(
            Problem(f"driven_gear.{problem.key}", *problem[1:]) for problem in error.problems
        ) from error


def _gear(gear: keys.GearParameters, table: str) -> spec.Gear:
    found = None
    if gear.profile is not None:
        # with what reads CAD files, half a second that generated gears do not need
        from toothspace.machines.external_gear.gear_files import detected_gear

        found = detected_gear(gear, gear.profile, table)
    tooth: InvoluteGear | GearProfile
    if found is None:
        tooth = gear.involute_gear(table)
    else:
        drawn = gear.profile_flank == "drawn"
        tooth = found.detected.drawn if drawn else found.detected.profile
    return spec.Gear(
        tooth=tooth,
        face_width=_face_width(gear, found, table),
        material=library_material(gear.material, f"{table}.material"),
        roughness=gear.roughness,
        tip_rounding=gear.tip_rounding,
        found=found,
        deviations=_deviations(gear, tooth, found, table),
    )


def _deviations(
    gear: keys.GearParameters,
    tooth: InvoluteGear | GearProfile,
    found: FoundGear | None,
    table: str,
) -> ToothDeviations | None:
    if gear.profile_teeth == "own" and found is not None:
        if found.detected.deviations is None:
            allowed = "involute flanks on a whole gear, or 'equal'"
            raise KeyRuleError(f"{table}.profile_teeth", "'own'", allowed)
        return found.detected.deviations
    if gear.tooth_deviations is None:
        return None
    profile = generate_profile(tooth) if isinstance(tooth, InvoluteGear) else tooth
    if profile.involute is None:
        raise KeyRuleError(f"{table}.tooth_deviations", "a file", "involute flanks only")
    from toothspace.geometry.tooth_deviations import read_tooth_deviations

    file = gear.tooth_deviations
    try:
        return read_tooth_deviations(file, profile.involute, profile.tooth_count)
    except CaseError as error:
        text = f"{table}.tooth_deviations: {error}".replace(str(file), file.name)
        raise GeometryError(text) from error


def _face_width(gear: keys.GearParameters, found: FoundGear | None, table: str) -> float:
    width = gear.face_width or (found and found.face_width)
    if not width:
        raise KeyRuleError(f"{table}.face_width", "nothing", "compulsory: the file has none")
    return width


def _casing(machine: keys.ExternalGearTables, drive: spec.Gear, driven: spec.Gear) -> spec.Casing:
    casing, contour = machine.casing, None
    if is_solid(casing.contour):
        from toothspace.machines.external_gear.solid_contours import casing_contour

        contour = casing_contour(machine, drive, driven)
    elif casing.contour is not None:
        contour = read_contours(casing.contour, "casing.contour", casing.contour_unit)[0]
    wear = casing.wear_in
    return spec.Casing(
        radial_clearance=casing.radial_clearance,
        inlet_angle=casing.inlet_angle or 0.0,
        outlet_angle=casing.outlet_angle or 0.0,
        contour=contour,
        wear_in=wear and RunningIn(wear.pressure, wear.shaft_speed, wear.temperature),
        roughness=casing.roughness,
    )


def _grooves(
    machine: keys.ExternalGearTables, drive: spec.Gear, driven: spec.Gear, distance: float
) -> ReliefGrooves | None:
    grooves = machine.relief_grooves
    if grooves is None:
        return None
    if not is_solid(grooves.contour):
        return grooves.grooves(unit=grooves.contour_unit)
    from toothspace.machines.external_gear.solid_contours import groove_contours

    polygons, depth = groove_contours(machine, drive, driven, distance)
    return grooves.outlined(polygons, depth, "relief_grooves.contour")


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
