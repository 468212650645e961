"""Numbers of the gears found in a file, as a drawing and a gear tester name them."""

from __future__ import annotations

from collections.abc import Mapping
from itertools import combinations
from pathlib import Path

import numpy as np

from toothspace.geometry.flank_deviation import ProfileDeviation
from toothspace.geometry.gear_data import gear_data
from toothspace.geometry.gear_finder import FileContents, FoundGear, axis_distance
from toothspace.geometry.mesh_clearance import normal_play

CERTAIN_BASE_DIAMETER = 3e-6
"""Uncertainty of a base diameter that needs no word. [m]"""


def file_report(contents: FileContents, center_distance: float | None = None) -> dict[str, object]:
    """Numbers of all gears of a file and of the pairs that they form.

    Parameters
    ----------
    center_distance : float or None
        Distance at which the backlash is wanted: of the first two gears, or of one gear with its
        equal. [m]

    Returns
    -------
    dict
        ``gears``, ``pairs`` and ``other_bodies``; names carry their units.
    """
    pairs = [pair_report(*two) for two in combinations(contents.gears, 2)]
    if center_distance is not None:
        first, second = contents.gears[0], contents.gears[min(1, len(contents.gears) - 1)]
        pairs.append(_at_distance(first, second, center_distance))
    return {
        "gears": [gear_report(gear) for gear in contents.gears],
        "pairs": [pair for pair in pairs if pair],
        "other_bodies": [
            {"file": other.file.name, "body": other.body, "name": other.name}
            for other in contents.others
        ],
    }


def likelier_units(contents: FileContents, scales: Mapping[str, float]) -> list[str]:
    """Units in which the largest gear has a standard module, where it has none as read.

    Parameters
    ----------
    scales : mapping
        Length of each unit over the one that the file was read in. [-]

    Returns
    -------
    list of str
        Names of the units, empty if the gear is a standard one as read.
    """
    profile = contents.gears[0].detected.profile
    data = gear_data(profile)
    if data is None or data.standard:
        return []
    known = {name: gear_data(profile.scaled(scale)) for name, scale in scales.items()}
    return [name for name, found in known.items() if found is not None and found.standard]


def flank_warnings(contents: FileContents) -> list[str]:
    """What the flanks of the gears leave uncertain: base diameters not known to 3 um.

    Returns
    -------
    list of str
        One line for each such gear, with its form error and chords.
    """
    lines = []
    for gear in contents.gears:
        fit, chord = gear.detected.involute, 1e6 * gear.detected.chord_height
        if fit is not None and fit.base_diameter_uncertainty > CERTAIN_BASE_DIAMETER:
            lines.append(
                f"{_called(gear)}: flanks leave the fitted involute by {1e6 * fit.form_error:.2g} "
                f"um (chords of {chord:.2g} um), so the base diameter is known to "
                f"{1e6 * fit.base_diameter_uncertainty:.2g} um; export more points of the flank, "
                f"or STEP"
            )
    return lines


def gear_report(found: FoundGear) -> dict[str, object]:
    """Numbers of one gear; those of the involute are absent where the flanks are none."""
    profile = found.detected.profile
    numbers: dict[str, object] = {
        "file": found.file.name if isinstance(found.file, Path) else "",
        "name": found.name,
        "body": found.body,
        "tooth_count": profile.tooth_count,
        "tip_diameter_mm": 2e3 * profile.tip_radius,
        "root_diameter_mm": 2e3 * profile.root_radius,
        "face_width_mm": None if found.face_width is None else 1e3 * found.face_width,
        "helix_angle_deg": float(np.rad2deg(found.helix_angle)),
        "axis": [float(value) for value in found.axis],
        "center_mm": [1e3 * float(value) for value in found.center],
        "chord_height_um": 1e6 * found.detected.chord_height,
        "largest_tooth_deviation_um": 1e6 * float(found.detected.tooth_deviation.max()),
    }
    return numbers | _involute_numbers(found)


def _involute_numbers(found: FoundGear) -> dict[str, object]:
    fit, data = found.detected.involute, gear_data(found.detected.profile)
    if fit is None or data is None:
        return {}
    return {
        "module_mm": 1e3 * data.module,
        "diametral_pitch_1_per_in": data.diametral_pitch,
        "pressure_angle_deg": float(np.rad2deg(data.pressure_angle)),
        "pressure_angle_from": "standard module or pitch" if data.standard else "assumed",
        "profile_shift": data.profile_shift,
        "base_diameter_mm": 2e3 * fit.flank.base_radius,
        "base_diameter_uncertainty_um": 1e6 * fit.base_diameter_uncertainty,
        "form_diameter_mm": 2e3 * fit.flank.form_radius,
        "tip_form_diameter_mm": 2e3 * fit.flank.tip_form_radius,
        "tip_rounding_mm": 1e3 * data.tip_rounding,
        "undercut": fit.flank.undercut,
        "undercut_depth_um": 1e6 * fit.cut,
        "fit_residual_um": 1e6 * fit.flank.residual,
        **_deviation_numbers("left", fit.left),
        **_deviation_numbers("right", fit.right),
        **_pitch_numbers(found),
    }


def _pitch_numbers(found: FoundGear) -> dict[str, object]:
    fit = found.detected.involute
    if fit is None or len(fit.left_offset) < found.detected.tooth_count:
        return {}
    profile = found.detected.profile
    pitch = fit.pitch_deviation(0.5 * (fit.flank.form_radius + profile.tip_radius))
    return {
        "single_pitch_deviation_um": 1e6 * pitch.single,
        "cumulative_pitch_deviation_um": 1e6 * pitch.cumulative,
        "run_out_um": 1e6 * pitch.run_out,
    }


def _deviation_numbers(side: str, deviation: ProfileDeviation) -> dict[str, object]:
    return {
        f"{side}_total_profile_deviation_um": 1e6 * deviation.total,
        f"{side}_profile_form_deviation_um": 1e6 * deviation.form,
        f"{side}_profile_slope_deviation_um": 1e6 * deviation.slope,
    }


def pair_report(first: FoundGear, second: FoundGear) -> dict[str, object]:
    """Centre distance and backlash of two gears on parallel axes that reach one another."""
    distance = axis_distance(first, second)
    tips = first.detected.profile.tip_radius, second.detected.profile.tip_radius
    if distance is None or not max(tips) < distance < sum(tips):
        return {}
    return _at_distance(first, second, distance)


def _at_distance(first: FoundGear, second: FoundGear, distance: float) -> dict[str, object]:
    profiles = first.detected.profile, second.detected.profile
    return {
        "gears": [_called(first), _called(second)],
        "center_distance_mm": 1e3 * distance,
        "normal_backlash_mm": 1e3 * normal_play(profiles, distance),
    }


def _called(gear: FoundGear) -> str:
    place = gear.file.name if isinstance(gear.file, Path) else "points"
    return gear.name or (place if gear.body is None else f"{place} body {gear.body}")
