"""Gear sections of a machine as CAD or text files, and a first case of gears in such files."""

from __future__ import annotations

import json
from collections.abc import Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import combinations
from pathlib import Path
from typing import final

import numpy as np
import shapely

from toothspace.core.errors import GeometryError
from toothspace.core.files import named_beside
from toothspace.core.types import Array
from toothspace.core.units import to_si
from toothspace.gearing.helix import halfway_up
from toothspace.geometry.body_section import AXES, SectionRequest
from toothspace.geometry.cad_export import export_gear
from toothspace.geometry.cad_import import STEP_SUFFIXES, load_body_sections
from toothspace.geometry.continuous_contact import RolledOutline
from toothspace.geometry.gear_data import continuous_contact, gear_data
from toothspace.geometry.gear_finder import (
    FileContents,
    FoundGear,
    PlainBody,
    axis_distance,
    find_in_files,
)
from toothspace.geometry.gear_pair import normal_play
from toothspace.geometry.involute import InvoluteGear, generate_profile
from toothspace.geometry.pump_sections import (
    MachineFrame,
    casing_cavity,
    face_recesses,
    machine_frame,
)
from toothspace.machines.external_gear.spec import ExternalGearSpec
from toothspace.machines.shared_tables import DRAFT, CaseDraft, draft_line
from toothspace.numerics.roots import root_between

_CLEARANCES = (1e-6, 300e-6)
"""Between tip circle and bore. [m]"""
_SHARE_OF_ROOT = 0.6
"""Journal diameter over root diameter, where no bearing is found. [-]"""
_BACKLASH = 0.04
"""Normal backlash of gears without a partner, in modules. [-]"""
_HELIX = np.deg2rad(23.0)
"""Helix angle of gears of continuous contact of which a file holds one section. [rad]"""
_GROOVES_APART = 0.5
"""Offset of the grooves of gears of continuous contact from the centre line, in modules. [-]"""


def export_profiles(spec: ExternalGearSpec, stem: Path, suffix: str) -> list[Path]:
    """Write the sections of both gears, or of one if they are equal; returns their paths.

    Solids of helical gears wind, each to its own hand.

    Raises GeometryError if a tooth cannot be built or the format needs a package that is missing.

    Parameters
    ----------
    stem : Path
        Folder and begin of the file names; ``_drive`` and ``_driven`` follow.
    suffix : str
        ``txt``, ``dxf``, ``stl`` or ``step``.
    """
    gears = {"drive": spec.drive}
    if spec.driven is not spec.drive or spec.helix is not None:
        gears["driven"] = spec.driven
    paths = []
    for name, gear in gears.items():
        path = stem.with_name(f"{stem.name}_{name}.{suffix}")
        tooth = gear.tooth
        profile = generate_profile(tooth) if isinstance(tooth, InvoluteGear) else tooth
        lead = 0.0 if spec.helix is None else spec.helix.turn_per_length
        lead *= (
            1.0
            if name == "drive"
            else -spec.drive.tooth.tooth_count / spec.driven.tooth.tooth_count
        )
        export_gear(profile, path, gear.face_width, twist=lead * gear.face_width)
        paths.append(path)
    return paths


@final
@dataclass(frozen=True)
class _Surroundings:
    """Parts round a pair of gears, None for those that were not found."""

    toward: str | None = None
    """Direction in the files across the centre line, as in ``machine.outlet_toward``."""
    casing: PlainBody | None = None
    """Body with both bores."""
    clearance: float | None = None
    """Its bore radius less the tip radius. [m]"""
    block: PlainBody | None = None
    """Body with a bearing bore on each gear axis beside the teeth."""
    journal: float | None = None
    """Diameter of those bores. [m]"""
    grooved: bool = False
    """Whether recesses in its face reach the teeth."""


def draft_case(
    files: Sequence[Path], unit: str, request: SectionRequest, folder: Path
) -> CaseDraft | None:
    """Case file of a pump with the gears of CAD files.

    Arguments are those of :func:`toothspace.api.draft_case`.

    What was measured, and what is assumed because files do not hold it; None without gears.
    """
    scale = to_si(1.0, unit)
    try:
        contents = find_in_files(files, scale, request)
    except GeometryError:
        return None
    if not contents.gears:
        return None
    pair = _pair(contents)
    drive, driven = pair or (contents.gears[0], contents.gears[0])
    around = _surroundings(contents.others, pair, scale) if pair else _Surroundings()
    parts = [gear.file for gear in contents.gears] + [body.file for body in contents.others]
    names = dict.fromkeys(named_beside(file, folder) for file in parts if isinstance(file, Path))
    lines = []
    if around.toward:
        note = "assumed: the outlet may be opposite"
        lines.append(draft_line("outlet_toward", around.toward, note))
    lines += ["", "[machine.gears]", *_part_keys(drive, unit, folder, "profile")]
    rolled, reason = continuous_contact(drive, driven)
    if drive.face_width is None and not reason and rolled is not None:
        # one section tells no helix: as wide as one pitch of overlap at a usual angle
        width = 2.0 * np.pi * halfway_up(drive.detected.profile) / drive.detected.tooth_count
        width = round(1e4 * width / np.tan(_HELIX)) * 1e-4
        lines.append(draft_line("face_width", f"{1e3 * width:.4g} mm", "assumed: overlap 1"))
        drive = replace(drive, helix_angle=_HELIX)
    elif drive.face_width is None:
        lines.append(draft_line("face_width", "10 mm", "assumed: plane files have none"))
    else:
        lines.append(draft_line("face_width", f"{1e3 * drive.face_width:.6g} mm"))
    section = {
        "axis": request.axis,
        "plane": request.plane and f"{1e3 * request.plane:.6g} mm",
        "layer": request.layer,
    }
    lines += [draft_line(f"profile_{k}", value) for k, value in section.items() if value]
    if drive.helix_angle != 0.0:
        angle, hand = abs(np.rad2deg(drive.helix_angle)), "right"
        hand = hand if drive.helix_angle > 0.0 else "left"
        note = "halfway up the teeth" if drive.face_width else "assumed, halfway up the teeth"
        lines.append(draft_line("helix_angle", f"{angle:.5g} deg", note))
        lines.append(draft_line("helix_hand", hand))
    if not reason:
        note = "tips roll through the roots of an equal gear"
        lines.append(draft_line("family", "continuous_contact", note))
    elif drive.detected.involute is None:
        lines.append(f"# ordinary gears, not of continuous contact: {reason}")
    lines += _mesh_keys(drive, driven, paired=pair is not None, rolled=None if reason else rolled)
    if pair:
        own = _part_keys(driven, unit, folder, "profile")
        # the file and its unit are those of the drive gear, if one file holds both
        shared = ("profile =", "profile_unit") if driven.file == drive.file else ()
        lines += ["", "[machine.driven_gear]", *(x for x in own if not x.startswith(shared))]
    text = DRAFT.format(
        files=", ".join(names) or "points", machine="external_gear",
        title=json.dumps(
            f"Pump from {drive.file.name if isinstance(drive.file, Path) else 'points'}"
        ),
        found="\n".join(lines + _body_keys(pair, drive, around, unit, folder)),
        side_gap="10 um", shaft_speed="1500 rpm", outlet_pressure="100 bar",
    )  # fmt: skip
    used = (drive, driven if pair else None, around.casing, around.block)
    return CaseDraft(text, sum(part is not None for part in used))


def _pair(contents: FileContents) -> tuple[FoundGear, FoundGear] | None:
    for first, second in combinations(contents.gears, 2):
        distance = axis_distance(first, second)
        tips = first.detected.profile.tip_radius, second.detected.profile.tip_radius
        if distance is not None and max(tips) < distance < sum(tips):
            # the shaft that is driven from outside is the longer one
            return (second, first) if second.length > first.length else (first, second)
    return None


def _part_keys(part: FoundGear | PlainBody, unit: str, folder: Path, stem: str) -> list[str]:
    if not isinstance(part.file, Path):
        return []
    lines = [draft_line(stem, named_beside(part.file, folder))]
    if part.file.suffix.lower() not in STEP_SUFFIXES:
        lines.append(draft_line(f"{stem}_unit", unit))
    if part.name:
        lines.append(draft_line(f"{stem}_part", part.name))
    elif part.body:
        lines.append(draft_line(f"{stem}_body", part.body))
    return lines


def _mesh_keys(
    drive: FoundGear, driven: FoundGear, *, paired: bool, rolled: RolledOutline | None
) -> list[str]:
    data = gear_data(drive.detected.profile, drive.helix_angle)
    teeth = f"# {drive.detected.tooth_count} teeth"
    if data is not None:
        teeth += (
            f", module {1e3 * data.normal_module:.5g} mm, pressure angle "
            f"{np.rad2deg(data.normal_pressure_angle):.4g} deg, profile shift "
            f"{data.profile_shift / np.cos(data.helix_angle):.4g}"
        )
    distance = axis_distance(drive, driven) if paired else None
    if rolled is not None and distance is None:
        note = f"assumed; centre distance {2e3 * rolled.pitch_radius:.5g} mm"
        return [draft_line("normal_backlash", "0 mm", note), teeth]
    if distance is None:
        profile = drive.detected.profile
        module = 2.0 * profile.tip_radius / (profile.tooth_count + 2)
        backlash = f"{1e3 * _BACKLASH * (module if data is None else data.module):.4g} mm"
        return [draft_line("normal_backlash", backlash, "assumed, or center_distance"), teeth]
    play = normal_play((drive.detected.profile, driven.detected.profile), distance)
    note = f"normal backlash {1e3 * play:.4g} mm"
    return [draft_line("center_distance", f"{1e3 * distance:.7g} mm", note), teeth]


def _usual_grooves(drive: FoundGear, driven: FoundGear, *, paired: bool) -> list[str]:
    """Grooves that never shut a space between two contacts; none for other than involutes.

    Those of a helix lie farther off by a quarter of the twist of the teeth on the base circle: by
    half of it no space would be open to both, but shut for longer than its wide end needs.
    """
    rolled, reason = continuous_contact(drive, driven)
    if rolled is not None and not reason:
        offset = f"{1e3 * _GROOVES_APART * rolled.module:.3g} mm"
        return [
            draft_line("closing_side_offset", offset, "assumed: from the centre line to the edge"),
            draft_line("opening_side_offset", offset, "assumed"),
            draft_line("depth", f"{0.4e3 * rolled.module:.2g} mm", "assumed"),
        ]
    profiles = drive.detected.profile, driven.detected.profile
    flanks = [profile.involute for profile in profiles if profile.involute is not None]
    if len(flanks) < 2:
        return ["# closing_side_offset, opening_side_offset and depth, or a contour: no involutes"]
    bases, counts = sum(f.base_radius for f in flanks), [p.tooth_count for p in profiles]
    pitch = 2.0 * np.pi * flanks[0].base_radius / counts[0]
    distance = axis_distance(drive, driven) if paired else None
    if distance is None:
        backlash = 2.0 * _BACKLASH * profiles[0].tip_radius / counts[0]
        least = sum(profile.involute.base_radius for profile in profiles if profile.involute)
        most = sum(profile.tip_radius for profile in profiles)
        distance = root_between(
            lambda a: normal_play(profiles, a) - backlash, 1.0001 * least, most, 1e-9
        )
    spacing = pitch * min(bases / distance, 1.0)
    middle = halfway_up(profiles[0])
    twist = abs(np.tan(drive.helix_angle)) * (drive.face_width or 0.0) / middle
    spacing += 0.5 * twist * flanks[0].base_radius * min(bases / distance, 1.0)
    offset = f"{0.5e3 * spacing:.3g} mm"
    return [
        draft_line("closing_side_offset", offset, "assumed: from the centre line to the edge"),
        draft_line("opening_side_offset", offset, "assumed"),
        draft_line("depth", f"{0.15e3 * pitch:.2g} mm", "assumed"),
    ]


def _body_keys(
    pair: tuple[FoundGear, FoundGear] | None,
    drive: FoundGear,
    around: _Surroundings,
    unit: str,
    folder: Path,
) -> list[str]:
    lines = ["", "[machine.casing]"]
    if around.casing is None or around.clearance is None:
        lines += [
            draft_line("radial_clearance", "20 um", "assumed"),
            draft_line("inlet_angle", "60 deg", "assumed: from the mesh to the port edge"),
            draft_line("outlet_angle", "60 deg", "assumed"),
        ]
    else:
        lines += _part_keys(around.casing, unit, folder, "contour")
        clearance = f"{1e6 * around.clearance:.4g} um"
        lines.append(draft_line("radial_clearance", clearance, "between tip and bore"))
    lines.append(
        "# [machine.casing.wear_in] with pressure and shaft_speed: tips cut their track first"
    )
    lines += ["", "[machine.relief_grooves]"]
    if around.block is not None and around.grooved:
        lines += _part_keys(around.block, unit, folder, "contour")
    else:
        lines += _usual_grooves(*(pair or (drive, drive)), paired=pair is not None)
    note = "bore of the bearing block" if around.journal is not None else "assumed"
    diameter = around.journal or 2.0 * _SHARE_OF_ROOT * drive.detected.profile.root_radius
    size, play = f"{1e3 * diameter:.4g} mm", max(round(1e6 * 0.5e-3 * diameter), 1)
    return [
        *lines,
        "",
        "[machine.journal_bearings]",
        draft_line("diameter", size, note),
        draft_line("length", size, "assumed"),
        draft_line("radial_clearance", f"{play} um", "assumed: a thousandth of the radius"),
    ]


def _surroundings(
    bodies: Sequence[PlainBody], pair: tuple[FoundGear, FoundGear], scale: float
) -> _Surroundings:
    drive, driven = pair
    between = driven.center - drive.center
    across = np.cross(between, drive.axis)
    main = int(np.argmax(np.abs(across)))
    toward = ("+" if across[main] > 0.0 else "-") + "xyz"[main]
    frame = machine_frame(drive, driven, np.sign(across[main]) * np.array(AXES["xyz"[main]]))
    distance = axis_distance(drive, driven) or 0.0
    gears = [(np.zeros(2), drive.detected.profile.tip_radius),
             (np.array([0.0, distance]), driven.detected.profile.tip_radius)]  # fmt: skip
    x, y, z = (float(value) for value in frame.rows[2])
    axis = (x, y, z)
    at_teeth = _cut(bodies, SectionRequest(axis, frame.height), frame, scale)
    faces = _cut(bodies, SectionRequest(axis, face_towards=frame.height), frame, scale)
    around = _Surroundings()
    for body in bodies:
        # smallest radius of the bore about the drive gear on the side away from the mesh
        clearance = None
        with suppress(GeometryError, IndexError):
            cavity = casing_cavity(at_teeth.get(body, [])[0], "casing")
            radius, wall = np.hypot(*cavity.T), shapely.Polygon(cavity)
            if all(wall.contains(shapely.Point(*center)) for center, _ in gears):
                away = cavity[:, 1] < -0.5 * radius
                left = float(radius[away].min(initial=np.inf)) - gears[0][1]
                clearance = left if _CLEARANCES[0] <= left <= _CLEARANCES[1] else None
        bearing = None if clearance else _bearing(faces.get(body, []), gears)
        if clearance and around.casing is None:
            around = replace(around, toward=toward, casing=body, clearance=clearance)
        if bearing and around.block is None:
            journal, grooved = bearing
            around = replace(around, toward=toward, block=body, journal=journal, grooved=grooved)
    return around


def _cut(
    bodies: Sequence[PlainBody], request: SectionRequest, frame: MachineFrame, scale: float
) -> dict[PlainBody, list[list[Array]]]:
    # curves of each body's sections in the frame of the machine; every file is read once
    found: dict[PlainBody, list[list[Array]]] = {}
    for file in dict.fromkeys(body.file for body in bodies):
        try:
            cuts = load_body_sections(file, scale, request)
        except GeometryError:
            continue
        for body in bodies:
            own = [frame.curves(cut) for cut in cuts if (file, cut.body) == (body.file, body.body)]
            found[body] = own
    return found


def _bearing(
    layers: list[list[Array]], gears: list[tuple[Array, float]]
) -> tuple[float, bool] | None:
    # diameter of the bearing bores in the face beside the teeth, and whether it has grooves
    if not layers:
        return None
    bores = []
    for center, tip in gears:
        rings = [shapely.Polygon(curve) for curve in layers[0]]
        round_axis = [r for r in rings if r.contains(shapely.Point(*center)) and r.area < tip**2]
        if not round_axis:
            return None
        bores.append(2.0 * float(np.sqrt(round_axis[-1].area / np.pi)))
    shafts = [(center, 0.5 * bore, tip) for (center, tip), bore in zip(gears, bores, strict=True)]
    return bores[0], bool(face_recesses(layers[0], layers[1] if layers[1:] else [], shafts))
