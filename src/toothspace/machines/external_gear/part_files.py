"""Parts that a case gives as files: gears, and casing and relief grooves as solids."""

from __future__ import annotations

from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from toothspace.core.errors import CaseError, GeometryError
from toothspace.core.frozen import Points
from toothspace.core.types import Array
from toothspace.core.units import to_si
from toothspace.geometry.body_section import AXES, BodySection, SectionRequest
from toothspace.geometry.cad_import import load_body_sections
from toothspace.geometry.curve import with_arcs
from toothspace.geometry.gear_data import gear_data
from toothspace.geometry.gear_finder import FoundGear, axis_distance, find_gears
from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.pump_sections import (
    OWN_FRAME,
    MachineFrame,
    casing_cavity,
    face_recesses,
    machine_frame,
)
from toothspace.machines.external_gear.spec import (
    OUTLETS,
    ExternalGearTables,
    Gear,
    GearParameters,
)

_UNITS = ("mm", "m", "um", "in")
_MODULES = (0.1e-3, 50e-3)
_WIDTH_OVER_MODULE = (0.3, 100.0)
_ROOT_OVER_JOURNAL = (1.0, 8.0)


class _Source(NamedTuple):
    file: Path | Points
    modified: int
    unit: float
    request: SectionRequest
    layer: str | None
    tooth_count: int | None


def detected_gear(gear: GearParameters, file: Path | Points, table: str) -> FoundGear:
    """Gear in the profile file of a table.

    The largest gear that the keys leave.

    Raises CaseError if the file holds no gear, or one with another tooth count.
    """
    request = SectionRequest(
        gear.profile_axis, gear.profile_plane, gear.profile_body, gear.profile_part
    )
    unit = to_si(1.0, gear.profile_unit)
    modified = file.stat().st_mtime_ns if isinstance(file, Path) else 0
    source = _Source(file, modified, unit, request, gear.profile_layer, gear.tooth_count)
    found = _found(source, f"{table}.profile")
    count = found.detected.tooth_count
    if gear.tooth_count not in (None, count):
        allowed = f"{count} teeth as in {file.name}, or no tooth_count"
        raise CaseError(f"{table}.tooth_count", str(gear.tooth_count), allowed)
    return found


@lru_cache(maxsize=8)
def _found(source: _Source, key: str) -> FoundGear:
    file = source.file
    try:
        contents = find_gears(file, source.unit, source.request, source.layer, source.tooth_count)
        if not contents.gears:
            raise GeometryError(file, "a ring gear alone", "an external gear")
        return contents.gears[0]
    except GeometryError as error:
        raise error.read_for(key).naming(str(file), file.name) from error


def check_unit(
    machine: ExternalGearTables, gear: GearParameters, drawn: GearProfile, table: str
) -> None:
    """Refuse a profile whose size fits the machine in another unit only.

    Raises
    ------
    CaseError
        With the unit in which the gear fits.
    """
    if _fits(machine, gear, drawn):
        return
    own = to_si(1.0, gear.profile_unit)
    others = [
        unit
        for unit in _UNITS
        if unit != gear.profile_unit and _fits(machine, gear, drawn.scaled(to_si(1.0, unit) / own))
    ]
    if len(others) == 1:
        size = 2e3 * drawn.tip_radius
        raise CaseError(
            f"{table}.profile_unit",
            f"{gear.profile_unit!r}, with which the tip diameter is {size:.5g} mm",
            f"{others[0]!r}, with which it is {size * to_si(1.0, others[0]) / own:.5g} mm and fits "
            f"the machine",
        )


def _fits(machine: ExternalGearTables, gear: GearParameters, profile: GearProfile) -> bool:
    data = gear_data(profile)
    module = 2.0 * profile.tip_radius / (profile.tooth_count + 2.0) if data is None else data.module
    ratios = [
        (module, _MODULES),
        ((gear.face_width or module) / module, _WIDTH_OVER_MODULE),
        (2.0 * profile.root_radius / machine.journal_bearings.diameter, _ROOT_OVER_JOURNAL),
    ]
    if gear.center_distance is not None:
        ratios.append((gear.center_distance / profile.tip_radius, (1.0, 10.0)))
    return all(low <= value <= high for value, (low, high) in ratios)


def distance_in_file(machine: ExternalGearTables, drive: Gear, driven: Gear) -> float:
    """Distance of two gears that were drawn in one frame, where the case gives none. [m].

    Raises CaseError if the case names neither a distance nor the second gear.
    """
    other = machine.driven_gear and machine.driven_gear.profile
    one_frame = machine.outlet_toward is not None or other in (None, machine.gears.profile)
    if drive.found is None or driven.found is None or not one_frame:
        raise CaseError(
            "gears.center_distance",
            "nothing",
            "compulsory unless both gears come from one solid, or from files in one frame with "
            "outlet_toward",
        )
    distance = axis_distance(drive.found, driven.found)
    same = (drive.found.file, drive.found.body) == (driven.found.file, driven.found.body)
    if same or distance is None:
        named = f"body {driven.found.body} {driven.found.name!r}"
        raise CaseError(
            "driven_gear.profile_part",
            f"{named}, which is {'the drive gear' if distance == 0.0 else 'not parallel to it'}",
            "the other gear of the file, by profile_part or profile_body; or center_distance",
        )
    return distance


def casing_contour(machine: ExternalGearTables, drive: Gear, driven: Gear) -> Array:
    """Outline of the space round the gears in the casing's solid. [m]."""
    given, key = machine.casing, "casing.contour"
    assert given.contour is not None
    frame, axis = _frame(machine, given.contour, drive, driven)
    plane = given.contour_plane
    if plane is None and frame is not OWN_FRAME:
        plane = float(np.dot(axis, frame.origin))
    request = SectionRequest(axis, plane, given.contour_body, given.contour_part)
    cut = _sections(given.contour, given.contour_unit, request, key)[0]
    curves = frame.curves(cut)
    if given.contour.suffix.lower() == ".stl":
        # a bore seals within the height of the chords that stand for it
        curves = [with_arcs(curve) for curve in curves]
    return casing_cavity(curves, f"{key}: {given.contour.name}")


def groove_contours(
    machine: ExternalGearTables, drive: Gear, driven: Gear, distance: float
) -> tuple[list[Array], float]:
    """Recesses beside the teeth in the bearing block's solid, and their depth. [m], [m]."""
    given, key = machine.relief_grooves, "relief_grooves.contour"
    assert given is not None
    assert given.contour is not None
    frame, axis = _frame(machine, given.contour, drive, driven)
    towards = float(np.dot(axis, frame.origin))
    request = SectionRequest(
        axis, None, given.contour_body, given.contour_part, face_towards=towards
    )
    sections = _sections(given.contour, given.contour_unit, request, key)
    of_block = [cut for cut in sections if cut.body == sections[0].body]
    face, behind = of_block[0], of_block[1:]
    shaft = 0.5 * machine.journal_bearings.diameter
    gears = [
        (np.array([0.0, height]), shaft, gear.tooth.tip_radius)
        for gear, height in ((drive, 0.0), (driven, distance))
    ]
    found = face_recesses(frame.curves(face), frame.curves(behind[0]) if behind else [], gears)
    if not found:
        raise GeometryError(
            f"{key}: {given.contour.name}",
            f"no recess beside the teeth in the face of body {face.body}",
            "a bearing block with relief grooves",
        )
    assert face.layer is not None
    return found, given.depth or face.layer[1] - face.layer[0]


def _frame(
    machine: ExternalGearTables, file: Path, drive: Gear, driven: Gear
) -> tuple[MachineFrame, tuple[float, float, float]]:
    if drive.found is None or driven.found is None:
        return OWN_FRAME, (0.0, 0.0, 1.0)
    if machine.outlet_toward is None:
        if file != machine.gears.profile:
            return OWN_FRAME, (0.0, 0.0, 1.0)
        raise CaseError(
            "outlet_toward", "nothing", f"one of {', '.join(OUTLETS)} with parts of one file"
        )
    toward = machine.outlet_toward
    outlet = (1.0 if toward[0] == "+" else -1.0) * np.array(AXES[toward[1]])
    x, y, z = (float(value) for value in drive.found.axis)
    return machine_frame(drive.found, driven.found, outlet), (x, y, z)


def _sections(file: Path, unit: str, request: SectionRequest, key: str) -> list[BodySection]:
    try:
        return _cut(file, file.stat().st_mtime_ns, to_si(1.0, unit), request)
    except GeometryError as error:
        raise error.read_for(key).naming(str(file), file.name) from error


@lru_cache(maxsize=8)
def _cut(file: Path, _modified: int, unit: float, request: SectionRequest) -> list[BodySection]:
    return load_body_sections(file, unit, request)
