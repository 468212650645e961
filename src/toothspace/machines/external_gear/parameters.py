"""``[machine]`` of external gear pumps and motors: its keys, and the machine that follows."""

from __future__ import annotations

from dataclasses import dataclass, fields, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any, final

import numpy as np

from toothspace.core.errors import CaseError, GeometryError
from toothspace.core.signals import read_grid
from toothspace.core.types import Array
from toothspace.gearing.gear_tables import GROOVE_DEPTH, TOOTH_KEYS, read_contours
from toothspace.gearing.materials import library_material
from toothspace.geometry.cad_import import is_solid
from toothspace.geometry.continuous_contact import (
    LARGEST_DIFFERENCE,
    generate_continuous,
    outlines_apart,
    rolled_outline,
)
from toothspace.geometry.gear_pair import pair_from_backlash, pair_from_center_distance
from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.involute import InvoluteGear, generate_profile
from toothspace.machines.external_gear.floating.floating_parameters import (
    FloatingBearingParameters,
)
from toothspace.machines.external_gear.spec import (
    PROFILE_KEYS,
    ExternalGearSpec,
    ExternalGearTables,
    FloatingBlock,
    Gear,
    GearParameters,
    SealParameters,
)

if TYPE_CHECKING:
    from toothspace.geometry.gear_finder import FoundGear
    from toothspace.geometry.tooth_deviations import ToothDeviations

_COLUMNS = {"temperature": "degC", "penetration": "mm", "friction_force": "N"}


@final
@dataclass(frozen=True, kw_only=True)
class ExternalGearParameters(ExternalGearTables):
    """``[machine]`` with ``type = "external_gear"``."""

    def assemble(self) -> ExternalGearSpec:
        """Build profiles and contours: :class:`ExternalGearSpec`.

        Raises CaseError if a file, a material or the geometry of a tooth is impossible.
        """
        return spec_from(self)


PARAMETERS = ExternalGearParameters
"""Found by the case reader under this name, in the module next to the machine's entry point."""


def spec_from(machine: ExternalGearTables) -> ExternalGearSpec:
    """Build profiles, contours and materials of a machine.

    Everything that the machine type needs.

    Raises
    ------
    CaseError
        With the key relative to ``[machine]``.
    """
    driven_keys = _driven_keys(machine)
    shapes = [[getattr(k, name) for name in TOOTH_KEYS] for k in (machine.gears, driven_keys)]
    generated = machine.gears.is_continuous and not machine.gears.is_drawn
    if generated and (shapes[0] != shapes[1] or driven_keys.profile is not None):
        allowed = "no keys of teeth: a gear of continuous contact meshes with an equal one"
        raise CaseError("driven_gear", "another tooth", allowed)
    if machine.gears.is_continuous and machine.casing.wear_in is not None:
        allowed = "no running-in with gears of continuous contact"
        raise CaseError("casing.wear_in", "a condition", allowed)
    drive = _gear(machine.gears, "gears")
    driven = drive if driven_keys == machine.gears else _gear(driven_keys, "driven_gear")
    for name, given, built in (
        ("gears", machine.gears, drive),
        ("driven_gear", driven_keys, driven),
    ):
        if built.found is not None:
            from toothspace.machines.external_gear.part_files import check_unit

            check_unit(machine, given, built.found.detected.profile, name)
    in_file = None
    if machine.gears.center_distance is None and machine.gears.normal_backlash is None:
        from toothspace.machines.external_gear.part_files import distance_in_file

        in_file = distance_in_file(machine, drive, driven)
    distance = _check_pair(machine, drive, driven, in_file)
    bearing = machine.journal_bearings
    casing = machine.casing
    if is_solid(casing.contour):
        from toothspace.machines.external_gear.part_files import casing_contour

        contour = casing_contour(machine, drive, driven)
    elif casing.contour is None:
        contour = None
    else:
        contour = read_contours(casing.contour, "casing.contour", casing.contour_unit)[0]
    floating = machine.floating_bearing
    fixed = machine.lateral.arrangement == "fixed"
    if fixed and floating is not None:
        _refuse_loads(floating)
    if floating is None or (floating.high_pressure_area is None and not fixed):
        block = None
    else:
        table, nose, area = "floating_bearing", floating.nose, floating.high_pressure_area
        block = FloatingBlock(
            keys=floating,
            material=library_material(floating.material, f"{table}.material"),
            length=floating.length or machine.journal_bearings.length,
            arrangement=machine.lateral.arrangement,
            high_pressure_contour=_only_polygon(
                area and area.contour, f"{table}.high_pressure_area.contour"
            ),
            nose_contour=_only_polygon(nose and nose.contour, f"{table}.nose.contour"),
        )
    grooves = machine.relief_grooves
    if grooves is None:
        relief = None
    elif not is_solid(grooves.contour):
        relief = grooves.grooves(unit=grooves.contour_unit)
    else:
        from toothspace.machines.external_gear.part_files import groove_contours

        polygons, depth = groove_contours(machine, drive, driven, distance)
        relief = grooves.outlined(polygons, depth, "relief_grooves.contour")
    lagging = None
    if grooves is not None and grooves.lagging_face is not None:
        if machine.gears.helix_angle == 0.0:
            allowed = "a helix_angle of the gears: the ends of spur teeth come together"
            raise CaseError("relief_grooves.lagging_face", "a table", allowed)
        own, key = grooves.lagging(), "relief_grooves.lagging_face.contour"
        polygons = read_contours(own.contour, key, own.contour_unit) if own.contour else []
        lagging = own.outlined(polygons, own.depth or GROOVE_DEPTH, key)
    return ExternalGearSpec(
        keys=machine,
        drive=drive,
        driven=driven,
        center_distance=in_file or machine.gears.center_distance or _pitch_diameter(machine.gears),
        bush=library_material(bearing.material, "journal_bearings.material"),
        seal_torque=seal_torque(machine.seals, bearing.diameter),
        casing_contour=contour,
        grooves=relief,
        lagging_grooves=lagging,
        floating_block=block,
    )


def _refuse_loads(bearing: FloatingBearingParameters) -> None:
    """Refuse what presses or moves a bearing that rests."""
    for name in ("high_pressure_area", "nose", "seal_preload", "springs", "housing_contact"):
        if getattr(bearing, name):
            allowed = 'leave this key out with lateral.arrangement = "fixed"'
            raise CaseError(f"floating_bearing.{name}", "a value", allowed)
    if bearing.split:
        allowed = 'false with lateral.arrangement = "fixed"'
        raise CaseError("floating_bearing.split", "true", allowed)


def _check_pair(
    machine: ExternalGearTables, drive: Gear, driven: Gear, in_file: float | None
) -> float:
    # returns the centre distance, of profiles with a given backlash about
    first, second = drive.tooth, driven.tooth
    root = min(gear.root_radius for gear in (first, second))
    if machine.journal_bearings.diameter >= 2.0 * root:
        found = f"{machine.journal_bearings.diameter * 1e3:.5g} mm"
        allowed = f"below the root diameter of the gears, {root * 2e3:.5g} mm"
        raise CaseError("journal_bearings.diameter", found, allowed)
    distance = in_file or machine.gears.center_distance or _pitch_diameter(machine.gears)
    if machine.gears.is_drawn:
        assert isinstance(first, GearProfile)
        assert isinstance(second, GearProfile)
        _check_drawn(first, second, distance)
    if not (isinstance(first, InvoluteGear) and isinstance(second, InvoluteGear)):
        return distance or first.tip_radius + second.root_radius
    try:
        if distance is not None:
            return pair_from_center_distance(first, second, distance).center_distance
        backlash = machine.gears.transverse_backlash
        return pair_from_backlash(first, second, backlash).center_distance
    except GeometryError as error:
        own = error.problems[0].key.startswith("driven_gear")
        raise error.under("" if own else "gears") from error


def _check_drawn(drive: GearProfile, driven: GearProfile, distance: float | None) -> None:
    """Refuse drawn outlines of which the tips of one do not roll through the roots of the other."""
    try:
        rolled = rolled_outline(drive, distance)
    except GeometryError as error:
        raise error.under("gears") from error
    if rolled.refusal:
        allowed = "an outline of continuous contact, or leave this key out"
        raise CaseError("gears.family", f"'continuous_contact' with {rolled.refusal}", allowed)
    apart = outlines_apart(drive, driven)
    if not apart <= LARGEST_DIFFERENCE * rolled.module:
        found = "another outline" if np.isinf(apart) else f"an outline {1e3 * apart:.3g} mm off"
        allowed = "one equal to that of the drive gear, with which it is in continuous contact"
        raise CaseError("driven_gear.profile", found, allowed)


def _pitch_diameter(gears: GearParameters) -> float | None:
    # centre distance of generated gears of continuous contact
    if not gears.is_continuous or gears.is_drawn:
        return None
    return 2.0 * gears.continuous_gear().reference_radius


def _driven_keys(machine: ExternalGearTables) -> GearParameters:
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
        own: dict[str, Any] = {f.name: f.default for f in fields(base) if f.name in PROFILE_KEYS}
        base = replace(base, profile=machine.driven_gear.profile, **own)
    elif {"profile_part", "profile_body"} & given.keys():
        base = replace(base, profile_part=None, profile_body=None)
    try:
        return replace(base, **given)
    except CaseError as error:
        raise error.under("driven_gear") from error


def _gear(gear: GearParameters, table: str) -> Gear:
    found = None
    if gear.profile is not None:
        # with what reads CAD files, half a second that generated gears do not need
        from toothspace.machines.external_gear.part_files import detected_gear

        found = detected_gear(gear, gear.profile, table)
    tooth: InvoluteGear | GearProfile
    if gear.is_continuous and found is None:
        try:
            tooth = generate_continuous(gear.continuous_gear())
        except GeometryError as error:
            raise error.under(table) from error
    elif found is None:
        tooth = gear.involute_gear(table)
    else:
        drawn = gear.is_drawn or gear.profile_flank == "drawn"
        tooth = found.detected.drawn if drawn else found.detected.profile
    width = gear.face_width or (found and found.face_width)
    if not width:
        raise CaseError(f"{table}.face_width", "nothing", "compulsory: the file has none")
    return Gear(
        tooth=tooth,
        face_width=width,
        material=library_material(gear.material, f"{table}.material"),
        roughness=gear.roughness,
        tip_rounding=gear.tip_rounding,
        found=found,
        deviations=_deviations(gear, tooth, found, table),
    )


def _deviations(
    gear: GearParameters,
    tooth: InvoluteGear | GearProfile,
    found: FoundGear | None,
    table: str,
) -> ToothDeviations | None:
    if gear.profile_teeth == "own" and found is not None:
        if found.detected.deviations is None:
            allowed = "involute flanks on a whole gear, or 'equal'"
            raise CaseError(f"{table}.profile_teeth", "'own'", allowed)
        return found.detected.deviations
    if gear.tooth_deviations is None:
        return None
    profile = generate_profile(tooth) if isinstance(tooth, InvoluteGear) else tooth
    if profile.involute is None:
        raise CaseError(f"{table}.tooth_deviations", "a file", "involute flanks only")
    from toothspace.geometry.tooth_deviations import read_tooth_deviations

    file = gear.tooth_deviations
    try:
        return read_tooth_deviations(file, profile.involute, profile.tooth_count)
    except CaseError as error:
        text = f"{table}.tooth_deviations: {error}".replace(str(file), file.name)
        raise GeometryError(text) from error


def _only_polygon(path: Path | None, key: str) -> Array | None:
    if path is None:
        return None
    polygons = read_contours(path, key)
    if len(polygons) != 1:
        raise CaseError(key, f"{len(polygons)} polygons in {path.name}", "one polygon")
    return polygons[0]


def seal_torque(seals: SealParameters | None, shaft_diameter: float) -> float:
    """Torque of the seal; with a table the bilinear force at its condition times the radius. [N m].

    Raises CaseError if the table is no full grid, or the condition lies outside it.

    Parameters
    ----------
    seals : SealParameters or None
        Keys of ``[machine.seals]``.
    shaft_diameter : float
        Diameter under the lip. [m]

    Notes
    -----
    Force over temperature and penetration as Nikas and Sayles (2006) give it for seals.
    """
    if seals is None:
        return 0.0
    if seals.table is None:
        return seals.shaft_seal_torque or 0.0
    from scipy.interpolate import RegularGridInterpolator

    *axes, values = read_grid(seals.table, _COLUMNS)
    for name, axis in zip(("temperature", "penetration"), axes, strict=True):
        asked = getattr(seals, name)
        if not axis[0] <= asked <= axis[-1]:
            allowed = f"{axis[0]:.6g} to {axis[-1]:.6g} in SI units, the range of the table"
            raise CaseError(f"seals.{name}", f"{asked:.6g}", allowed)
    force = RegularGridInterpolator(axes, values)([[seals.temperature, seals.penetration]])
    return float(force[0]) * 0.5 * shaft_diameter
