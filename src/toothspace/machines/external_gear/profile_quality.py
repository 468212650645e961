"""Data of the gears for the geometry report, and how good profiles from files are."""

from __future__ import annotations

from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.gearing.meshing import contact_range, path_of_contact
from toothspace.gearing.spaces import Spaces, section_areas
from toothspace.geometry.gear_data import gear_data
from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.involute import InvoluteGear
from toothspace.machines.external_gear.assembly import Assembly, assemble
from toothspace.machines.external_gear.spec import Gear
from toothspace.model.description import DesignCheck

if TYPE_CHECKING:
    from toothspace.geometry.gear_finder import FoundGear
    from toothspace.geometry.profile_detection import DetectedGear

_LARGEST_CHORD = 2e-6
_LARGEST_FORM_ERROR = 4e-3
"""Of the module: about the total profile tolerance of ISO 1328-1 class 8 for small gears. [-]"""
_UNEQUAL_PITCH = 1e-3


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

    Returns
    -------
    tuple of float
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

    Returns
    -------
    dict
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
        "helix_angle_deg": float(np.rad2deg(max(abs(gear.helix_angle) for gear in gears))),
    }
    if len(fits) == len(gears):
        numbers |= {
            "involute_deviation_um": 1e6 * max(fit.form_error for fit in fits),
            "profile_form_error_um": 1e6 * max(max(f.left.form, f.right.form) for f in fits),
            "profile_slope_error_um": 1e6
            * max(max(abs(f.left.slope), abs(f.right.slope)) for f in fits),
            "fit_residual_um": 1e6 * max(fit.flank.residual for fit in fits),
        }
    return numbers | _as_drawn(assembly)


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


def profile_checks(assembly: Assembly) -> tuple[DesignCheck, ...]:
    """Whether profiles from files are good enough for what follows from them."""
    checks: list[DesignCheck] = []
    for gear in _from_files(assembly):
        angle = abs(gear.helix_angle)
        checks += [
            _chords(gear.detected),
            _form(gear.detected),
            DesignCheck(
                "helix angle of the profile", float(np.rad2deg(angle)), "deg", "0 deg",
                angle == 0.0,
                "Teeth are taken as spur with this transverse section: overlap, thrust and the "
                "spread of trapping along the face width are missing.",
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
        f"up to {_LARGEST_CHORD * 1e6:g} um: export STEP, or a mesh with a chord tolerance of 1 um",
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
