"""Numbers and verdicts of the geometry report."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import partial
from typing import TYPE_CHECKING

import numpy as np

from toothspace.advice.gear_rules import (
    DEEPEST_CUT,
    MAX_CONTINUOUS_BACKLASH,
    MIN_CURVATURE,
    OVERLAP_TOLERANCE,
    backlash_check,
    bearing_checks,
    contact_ratio_check,
    overlap_from_whole,
    pair_checks,
    strength_checks,
)
from toothspace.advice.trapping import (
    TYPICAL,
    DesignCondition,
    EnclosedMesh,
    opening_checks,
    sealing_edge,
    trapping_checks,
)
from toothspace.core.errors import GeometryError
from toothspace.core.finding import DesignCheck, warnings_of
from toothspace.core.types import Array
from toothspace.gearing.gear_tables import ReliefGrooves
from toothspace.gearing.meshing import (
    contact_range,
    contact_ratio,
    displacement,
    flow_over_pitch,
    flow_ripple,
    path_of_contact,
)
from toothspace.gearing.spaces import Spaces, drive_spaces, section_areas
from toothspace.geometry.continuous_contact import (
    ContinuousGear,
    RolledOutline,
    rolled_outline,
)
from toothspace.geometry.gear_data import gear_data
from toothspace.geometry.gear_pair import normal_play
from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.involute import InvoluteGear
from toothspace.machines.external_gear.assembly import Assembly, assemble
from toothspace.machines.external_gear.flow_paths import (
    bore,
    grooves_by_port,
    port_opening_lengths,
)
from toothspace.machines.external_gear.spec import Gear
from toothspace.model.description import ChamberFamily, FlowPath, LumpedJournalBearing

if TYPE_CHECKING:
    from toothspace.geometry.gear_finder import FoundGear
    from toothspace.geometry.profile_detection import DetectedGear

_LARGEST_CHORD = 2e-6
_LARGEST_FORM_ERROR = 4e-3
"""Of the module: about the total profile tolerance of ISO 1328-1 class 8 for small gears. [-]"""
_UNEQUAL_PITCH = 1e-3
_SAME_HELIX = 0.02
"""Difference of the helix angle of a file, which is known to 1 %, from that of the case. [-]"""
_ROUND_OFF = 1e-9
_LARGEST_REST = 0.01


def geometry_summary(
    assembly: Assembly, spaces: tuple[Spaces, Spaces], checks: Sequence[DesignCheck]
) -> dict[str, object]:
    """Numbers of the geometry report.

    Values by name; names carry their unit.

    Parameters
    ----------
    checks : sequence of DesignCheck
        Design-rule report, whose failures are named.
    """
    pair, distance = assembly.pair, assembly.mesh.center_distance
    if pair is None:
        gear = assembly.spec.continuous
        backlash = normal_play(assembly.profiles, distance) if gear is None else gear.backlash
        undercut = any(undercut_of(gear) for gear in (assembly.spec.drive, assembly.spec.driven))
    else:
        backlash, undercut = pair.normal_backlash, any(form.undercut for form in pair.forms)
    first, second = (profile.base_radius for profile in assembly.profiles)
    angle = np.arccos((first + second) / distance) if first and second else None
    helix = assembly.spec.helix
    if helix is not None:
        backlash *= float(np.cos(helix.base_angle))
    ripple = flow_ripple(assembly) if helix is None else helix.ripple(flow_over_pitch(assembly))
    volumes: Mapping[str, object]
    if helix is None:
        trapped, dead = trapped_volumes(assembly, spaces)
        volumes = {"trapped_volume_mm3": trapped * 1e9, "dead_volume_mm3": dead * 1e9}
    else:
        volumes = helix.numbers(contact_ratio(assembly))
    return {
        **tooth_data(assembly),
        "displacement_cm3_per_rev": displacement(assembly) * 2e6 * np.pi,
        "face_width_mm": assembly.face_width * 1e3,
        "contact_ratio": contact_ratio(assembly),
        "tip_land_mm": min(assembly.tip_lands) * 1e3,
        "undercut": undercut,
        "root_clearance_mm": min(assembly.root_clearances) * 1e3,
        "center_distance_mm": distance * 1e3,
        "normal_backlash_mm": backlash * 1e3,
        "base_diameter_mm": None if first is None else 2e3 * first,
        "operating_pressure_angle_deg": None if angle is None else float(np.rad2deg(angle)),
        "flow_ripple_percent": 100.0 * ripple,
        **volumes,
        **(
            {"encapsulated_volume_mm3": enclosed_area(assembly) * assembly.face_width * 1e9}
            if assembly.flanks_in_turn
            else {}
        ),
        **profile_quality(assembly),
        "warnings": warnings_of(checks),
    }


def tooth_data(assembly: Assembly) -> dict[str, object]:
    """Tooth count, module and what else a drawing names; of both gears where they differ."""
    spec = assembly.spec
    found = _gear_numbers(spec.drive, assembly.profiles[0])
    if spec.driven is not spec.drive:
        driven = _gear_numbers(spec.driven, assembly.profiles[1])
        found |= {f"driven_{name}": value for name, value in driven.items()}
    return found


def _gear_numbers(gear: Gear, profile: GearProfile) -> dict[str, object]:
    numbers: dict[str, object] = {"tooth_count": profile.tooth_count}
    data = gear.tooth if isinstance(gear.tooth, InvoluteGear) else gear_data(profile)
    if data is not None:
        numbers |= {
            "module_mm": 1e3 * data.module,
            "pressure_angle_deg": float(np.rad2deg(data.pressure_angle)),
            "profile_shift": data.profile_shift,
        }
    return numbers | {
        "tip_diameter_mm": 2e3 * profile.tip_radius,
        "root_diameter_mm": 2e3 * profile.root_radius,
    }


def undercut_of(gear: Gear) -> bool:
    """Whether the root of a gear from file cuts away involute."""
    fit = None if gear.found is None else gear.found.detected.involute
    return fit is not None and fit.flank.undercut


def trapped_volumes(assembly: Assembly, spaces: tuple[Spaces, Spaces]) -> tuple[float, float]:
    """Volume between two consecutive loaded contacts when the second one begins, and its minimum.

    Trapped volume and dead volume, which the mesh carries back. [m3]
    """
    drive, driven = spaces
    mesh, width = assembly.mesh, assembly.face_width
    pitch = 2.0 * mesh.half_pitch
    start, end = contact_range(assembly)
    # throat angle of the contact that lies behind
    behind = np.linspace(start, max(end - pitch, start), 61)
    left = assembly.loaded_is_left
    lag = mesh.turn + 0.5 * assembly.teeth[1].pitch_angle
    place_1 = behind if left else behind + pitch
    place_2 = mesh.ratio * (behind + pitch) - lag
    area = np.interp(place_1, drive.angles, section_areas(drive))
    area += np.interp(place_2, driven.angles, section_areas(driven))
    return float(area[0] * width), float(area.min() * width)


def profile_quality(assembly: Assembly) -> dict[str, object]:
    """Form error of profiles from files and its effect; nothing for generated gears.

    Form error, chord height and residual of the worse gear; contact ratio with rigid flanks as
    drawn, which form error shortens, and the change of the trapped volume that belongs to it.
    """
    gears = _from_files(assembly)
    if not gears:
        return {}
    detected = [gear.detected for gear in gears]
    fits = [found.involute for found in detected if found.involute is not None]
    numbers: dict[str, object] = {
        "chord_height_um": 1e6 * max(found.chord_height for found in detected),
    }
    solids = [abs(gear.helix_angle) for gear in gears if gear.body is not None]
    if solids:  # one section tells no helix
        numbers["helix_angle_deg"] = float(np.rad2deg(max(solids)))
    if len(fits) == len(gears):
        numbers |= {
            "involute_deviation_um": 1e6 * max(fit.form_error for fit in fits),
            "profile_form_error_um": 1e6 * max(max(f.left.form, f.right.form) for f in fits),
            "profile_slope_error_um": 1e6
            * max(max(abs(f.left.slope), abs(f.right.slope)) for f in fits),
            "fit_residual_um": 1e6 * max(fit.flank.residual for fit in fits),
        }
    return numbers if assembly.flanks_in_turn else numbers | _as_drawn(assembly)


def _as_drawn(assembly: Assembly) -> dict[str, object]:
    # the same machine with rigid flanks as in the outline: the other end of the interval
    spec = assembly.spec
    drawn = replace(spec, drive=_drawn(spec.drive), driven=_drawn(spec.driven))
    if spec.driven is spec.drive:
        drawn = replace(drawn, driven=drawn.drive)
    try:
        rigid = assemble(replace(drawn, center_distance=assembly.mesh.center_distance))
    except GeometryError:
        return {}
    start, end = path_of_contact(rigid)
    found = trapped_volumes(rigid, rigid.spaces(360))[0]
    return {
        "contact_ratio_as_drawn": (end - start) / (2.0 * rigid.mesh.half_pitch),
        "trapped_volume_as_drawn_mm3": 1e9 * found,
    }


def _drawn(gear: Gear) -> Gear:
    if gear.found is None:
        return gear
    return replace(gear, tooth=gear.found.detected.drawn)


def _from_files(assembly: Assembly) -> list[FoundGear]:
    spec = assembly.spec
    gears = [spec.drive] if spec.driven is spec.drive else [spec.drive, spec.driven]
    return [gear.found for gear in gears if gear.found is not None]


def _winding(assembly: Assembly, gear: FoundGear) -> DesignCheck:
    """Whether the teeth of a file wind as the case says."""
    spec = assembly.spec
    taken = 0.0 if spec.helix is None else spec.helix.angle
    taken *= 1.0 if gear is spec.drive.found else -1.0
    found, angles = gear.helix_angle, np.rad2deg([taken, gear.helix_angle])
    plane = gear.body is None  # one section tells no helix
    hand = "right" if found > 0.0 else "left"
    return DesignCheck(
        "helix angle of the profile", float(angles[1]), "deg", f"{angles[0]:.4g} deg",
        plane or abs(found - taken) <= _SAME_HELIX * abs(taken),
        f"Teeth that wind by {abs(angles[1]):.4g} deg halfway up, {hand}-handed, count with "
        f"{angles[0]:.4g} deg: set helix_angle and helix_hand of the drive gear. Overlap, thrust "
        "and the spread of trapping along the face width follow; the mate has the other hand."
        if found != 0.0
        else "The teeth do not wind: leave out helix_angle.",
    )  # fmt: skip


def profile_checks(assembly: Assembly) -> tuple[DesignCheck, ...]:
    """Whether profiles from files are good enough for what follows from them."""
    checks: list[DesignCheck] = []
    for gear in _from_files(assembly):
        checks += [
            _chords(gear.detected),
            *([] if assembly.flanks_in_turn else [_form(gear.detected)]),
            _winding(assembly, gear),
            DesignCheck(
                "taper of the profile", float(np.rad2deg(gear.taper)), "deg", "0 deg",
                gear.taper == 0.0,
                "Teeth are taken as wide as in this section along the whole face: drafted, conical "
                "and bevel teeth touch and seal at one end only.",
            ),
        ]  # fmt: skip
    flanks = [(p.involute, p.tooth_count) for p in assembly.profiles]
    pitches = [2.0 * np.pi * flank.base_radius / n for flank, n in flanks if flank is not None]
    if len(pitches) == 2:
        ratio = abs(pitches[1] / pitches[0] - 1.0)
        checks.append(
            DesignCheck(
                "difference of the base pitches", 100.0 * ratio, "%", "up to 0.1 %",
                ratio <= _UNEQUAL_PITCH,
                "Gears of unequal base pitch hand the load over with a shock.",
            )
        )  # fmt: skip
    return tuple(checks)


def as_drawn(assembly: Assembly) -> dict[str, str]:
    """Key for the flanks of the file, where chords or form error are larger than allowed."""
    fitted = [gear for gear in _from_files(assembly) if gear.detected.involute is not None]
    checks = [check for gear in fitted for check in (_chords(gear.detected), _form(gear.detected))]
    if all(check.passed for check in checks) or not any(p.involute for p in assembly.profiles):
        return {}
    return {"machine.gears.profile_flank": "drawn"}


def _chords(detected: DetectedGear) -> DesignCheck:
    height = detected.chord_height
    return DesignCheck(
        "chord height of the profile", height * 1e6, "um",
        f"up to {_LARGEST_CHORD * 1e6:g} um: export curves, not facets, as STEP, or a mesh with a "
        "chord tolerance of 1 um",
        height <= _LARGEST_CHORD,
        "Flanks are fitted through the corners of a mesh; root, tip and volumes keep its chords.",
    )  # fmt: skip


def _form(detected: DetectedGear) -> DesignCheck:
    fit, data = detected.involute, gear_data(detected.profile)
    if fit is None or data is None:
        return DesignCheck(
            "involute in the profile", 0.0, "1", "1: flanks that are involutes within 1 % of the "
            "tooth height", False,
            "Without one, contact ratio and trapped volume hang on a contact tolerance of 1 um.",
        )  # fmt: skip
    allowed = _LARGEST_FORM_ERROR * data.module
    return DesignCheck(
        "form error of the profile", fit.form_error * 1e6, "um", f"up to {allowed * 1e6:.3g} um",
        fit.form_error <= allowed,
        "Contact and trapped volume are those of the involute that fits; profile_flank = \"drawn\" "
        "computes with the flanks of the file, with mesh = \"elastic\" under load.",
    )  # fmt: skip


def design_checks(
    assembly: Assembly,
    spaces: tuple[Spaces, Spaces],
    families: Sequence[ChamberFamily],
    paths: Sequence[FlowPath],
    journals: Sequence[LumpedJournalBearing],
) -> tuple[DesignCheck, ...]:
    """Design-rule report: geometry, trapping, strength, cross-port leakage and bearings.

    Parameters
    ----------
    spaces, families, paths : sequences
        Tooth spaces of both gears, as chambers, and all flow paths, of equal teeth.
    journals : sequence of LumpedJournalBearing
        Bearings of both gears.
    """
    mesh = enclosed_mesh(assembly, spaces)
    short, *opened = opening_checks(families, paths, displacement(assembly), 0.0, mesh.condition)
    if not short.passed and assembly.spec.helix is None:
        short = replace(short, reason=short.reason + sealing_edge(mesh))
    spec = assembly.spec
    running_in: tuple[DesignCheck, ...] = ()
    # trapping and strength, where the machine has a condition to judge them at
    if spec.keys.casing.wear_in is not None:
        bearing = spec.keys.journal_bearings
        running_in = (
            *(trapping_checks(mesh) if spec.helix is None else ()),
            *strength_checks(
                assembly,
                assembly.profiles,
                (spec.drive.material, spec.driven.material),
                (bearing.diameter, bearing.length),
                mesh.condition,
            ),
        )
    helix = assembly.spec.helix
    winding: list[DesignCheck] = []
    if helix is not None:
        for gear, name in enumerate(("drive", "driven")):
            casing, ratio = bore(assembly, gear), 1.0 if gear == 0 else assembly.mesh.ratio
            sealed = 2.0 * np.pi - casing.inlet_angle - casing.outlet_angle - helix.twist * ratio
            teeth = float(sealed / assembly.teeth[gear].pitch_angle)
            winding.append(
                DesignCheck(
                    f"teeth that seal along the helix, {name} gear", teeth, "1", "at least 1",
                    teeth >= 1.0,
                    "A tooth space that still meets the inlet at one end while the other end is "
                    "open to the outlet joins both ports: less helix, a narrower gear or a longer "
                    "bore.",
                )
            )  # fmt: skip
    return (
        *_tooth_checks(assembly),
        *winding,
        casing_cut_check(assembly),
        *running_in,
        short,
        *opened,
        *bearing_checks(journals, min(assembly.root_clearances)),
    )


def enclosed_mesh(assembly: Assembly, spaces: tuple[Spaces, Spaces]) -> EnclosedMesh:
    """What the mesh encloses, at the pressure and speed of running-in or else typical ones."""
    spec, wear = assembly.spec, assembly.spec.keys.casing.wear_in
    return EnclosedMesh(
        gears=assembly,
        spaces=spaces,
        port_openings=(
            port_opening_lengths(assembly, spaces[0]),
            port_opening_lengths(assembly, spaces[1]),
        ),
        groove_openings=partial(_groove_openings, assembly),
        grooves=spec.grooves,
        tip_rounding=min(spec.drive.tip_rounding, spec.driven.tip_rounding),
        is_pump=spec.keys.mode == "pump",
        condition=TYPICAL if wear is None else DesignCondition(wear.pressure, wear.shaft_speed),
        groove_spacing=None if assembly.pair is None else assembly.pair.relief_groove_spacing,
    )


def _groove_openings(
    assembly: Assembly, grooves: ReliefGrooves, spaces: Spaces
) -> Mapping[str, Array]:
    moved = replace(assembly, spec=replace(assembly.spec, grooves=grooves))
    return grooves_by_port(moved, spaces)


def _tooth_checks(assembly: Assembly) -> tuple[DesignCheck, ...]:
    """Geometry of the teeth, given by parameters or in files."""
    if assembly.flanks_in_turn:
        return *_continuous_checks(assembly), *profile_checks(assembly)
    if assembly.pair is not None:
        vented = assembly.spec.grooves is not None
        return pair_checks(assembly.pair, assembly.face_width, vented=vented)
    clearance = min(assembly.root_clearances)
    data, distance = gear_data(assembly.profiles[0]), assembly.mesh.center_distance
    of_mesh: tuple[DesignCheck, ...] = ()
    if data is not None:
        play = normal_play(assembly.profiles, distance)
        grooved = assembly.spec.grooves is not None
        of_mesh = (
            backlash_check(play, data.module, distance),
            DesignCheck(
                "relief grooves",
                float(grooved),
                "1",
                "grooves on both sides of the mesh",
                grooved,
                "Fluid enclosed between two contacts is squeezed and stretched; unless grooves "
                "vent it, pressure peaks load the bearings and then cavitation erodes the flanks.",
            ),
        )
    return (
        contact_ratio_check(contact_ratio(assembly)),
        DesignCheck(
            "root clearance", clearance * 1e3, "mm", "above 0 mm", clearance > 0.0,
            "Bearing play moves the gears together, so the mating tip needs room in the root.",
        ),
        *of_mesh,
        *profile_checks(assembly),
    )  # fmt: skip


def enclosed_area(assembly: Assembly) -> float:
    """Section of a tooth space that the mating tooth in its middle leaves open. [m2]."""
    spaces = drive_spaces(*assembly.teeth, assembly.mesh, np.zeros(1))
    return float(section_areas(spaces)[0])


def _continuous_checks(assembly: Assembly) -> tuple[DesignCheck, ...]:
    """Geometry of teeth whose flanks touch in turn."""
    gear: ContinuousGear | RolledOutline | None = assembly.spec.continuous
    if gear is None:
        gear = rolled_outline(assembly.profiles[0], assembly.mesh.center_distance)
    helix = assembly.spec.helix
    overlap = 0.0 if helix is None else helix.overlap_ratio
    total = overlap + contact_ratio(assembly)
    away, play = overlap_from_whole(overlap), MAX_CONTINUOUS_BACKLASH * gear.module
    radius, enclosed = gear.smallest_radius, enclosed_area(assembly) * assembly.face_width
    space = assembly.profiles[0].tooth_space_area * assembly.face_width
    clearance, bend = min(assembly.root_clearances), MIN_CURVATURE * gear.module
    return (
        DesignCheck(
            "total contact ratio", total, "1", "at least 1", total >= 1.0 - _ROUND_OFF,
            "Loaded flanks of a section touch for half a pitch; the helix must hand the load over "
            "from section to section.",
        ),
        DesignCheck(
            "overlap ratio", overlap, "1",
            f"within {OVERLAP_TOLERANCE:g} of 0.5 or a multiple of it",
            away <= OVERLAP_TOLERANCE,
            "Flow of a section repeats every half pitch, so that sections over a multiple of it "
            "deliver without kinematic ripple.",
        ),
        DesignCheck(
            "normal backlash", gear.backlash * 1e3, "mm",
            f"up to {play * 1e3:.3g} mm ({MAX_CONTINUOUS_BACKLASH:g} modules)",
            gear.backlash <= play,
            "Both flanks seal in turn: play between them joins inlet and outlet in the mesh.",
        ),
        DesignCheck(
            "smallest radius of curvature", radius * 1e3, "mm",
            f"at least {bend * 1e3:.3g} mm ({MIN_CURVATURE:g} modules)",
            radius >= bend,
            "Contact pressure grows without bound where a flank bends about a point.",
        ),
        DesignCheck(
            "encapsulated volume", enclosed * 1e9, "mm3",
            f"up to {_LARGEST_REST * space * 1e9:.3g} mm3 (1 % of a tooth space)",
            enclosed <= _LARGEST_REST * space,
            "What the mating tip leaves of a space leaks from the outlet to the inlet along the "
            "helix.",
        ),
        DesignCheck(
            "root clearance", clearance * 1e3, "mm", "at least 0 mm", clearance > -1e-9,
            "A tip that reaches below the root jams the gears.",
        ),
    )  # fmt: skip


def casing_cut_check(assembly: Assembly) -> DesignCheck:
    """Check of how deep the gears can cut into the casing as far as bearings and blocks let them.

    References
    ----------
    .. [1] Parker Hannifin, Gear Pump Division, service manual of series PGP030 and PGP031,
       guidelines for acceptable wear: replace housings with a cut-out above 0.005 inch.
    """
    keys = assembly.spec.keys
    blocks = 0.0 if keys.bearing_blocks is None else keys.bearing_blocks.radial_clearance
    reach = keys.journal_bearings.radial_clearance + blocks
    cut = max(reach - keys.casing.radial_clearance, 0.0)
    return DesignCheck(
        "cut into the casing", cut * 1e6, "um", f"up to {DEEPEST_CUT * 1e6:g} um",
        cut <= DEEPEST_CUT,
        "Pressure moves the gears through the clearance of bearings and blocks; a deep track "
        "weakens the casing, fills the oil with chips and opens the gap on the other side.",
    )  # fmt: skip
