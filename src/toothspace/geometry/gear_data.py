"""Numbers of gears as a drawing and a gear tester name them, and the data they were made with."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from itertools import combinations, product
from pathlib import Path
from typing import final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array
from toothspace.geometry.continuous_contact import (
    LARGEST_DIFFERENCE,
    RolledOutline,
    outlines_apart,
    rolled_outline,
)
from toothspace.geometry.gear_finder import FileContents, FoundGear, axis_distance
from toothspace.geometry.gear_pair import normal_play
from toothspace.geometry.gear_profile import GearProfile, InvoluteFlank
from toothspace.geometry.involute import involute_function
from toothspace.geometry.involute_fit import ProfileDeviation
from toothspace.numerics.roots import root_between

_ANGLES = np.deg2rad([20.0, 14.5, 25.0, 15.0, 22.5, 17.5, 28.0, 30.0, 24.0, 18.0, 16.0])
"""Usual pressure angles, the commonest first. [rad]"""
_MODULES = 1e-3 * np.array([0.3, 0.4, 0.5, 0.6, 0.7, 0.8, 0.9, 1.0, 1.125, 1.25, 1.375, 1.5, 1.75,
                            2.0, 2.25, 2.5, 2.75, 3.0, 3.25, 3.5, 3.75, 4.0, 4.5, 5.0, 5.5, 6.0,
                            6.5, 7.0, 8.0, 9.0, 10.0, 11.0, 12.0, 14.0, 16.0, 18.0, 20.0, 22.0,
                            25.0])  # fmt: skip
"""ISO 54 with the quarter steps in use. [m]"""
_PITCHES = np.concatenate([np.arange(1.0, 6.0, 0.25), np.arange(6.0, 21.0), np.arange(22.0, 66, 2)])
"""Diametral pitches in use. [1/in]"""
_INCH = 25.4e-3
_ROUNDS = 30
_MATCH, _HELICAL_MATCH = 3e-4, 3e-3
"""How far a module may be from one in use: of spur teeth, and of a helix known to 1 %. [-]"""


@final
@dataclass(frozen=True)
class GearData:
    """What a drawing of a gear gives."""

    tooth_count: int
    """Number of teeth."""
    module: float
    """Transverse module. [m]"""
    pressure_angle: float
    """Transverse pressure angle at the reference circle. [rad]"""
    profile_shift: float
    """Shift that gives the tooth thickness found, thinning included. [module]"""
    tip_rounding: float
    """Radius of an arc between involute and tip circle, 0 for a sharp corner. [m]"""
    standard: bool
    """Whether module or diametral pitch is one in use; else the pressure angle is assumed to be 20
    deg.
    """
    helix_angle: float = 0.0
    """Helix angle on the reference circle, positive for a right-hand helix. [rad]"""

    @property
    def normal_module(self) -> float:
        """Module in the section across the teeth. [m]."""
        return float(self.module * np.cos(self.helix_angle))

    @property
    def normal_pressure_angle(self) -> float:
        """Pressure angle in the section across the teeth. [rad]."""
        return float(np.arctan(np.tan(self.pressure_angle) * np.cos(self.helix_angle)))

    @property
    def diametral_pitch(self) -> float:
        """Teeth per inch of the reference diameter. [1/in]."""
        return _INCH / self.module


def gear_data(profile: GearProfile, helix_angle: float = 0.0) -> GearData | None:
    r"""Data of the gear behind a profile with involute flanks.

    The data; None where the flanks are no involutes.

    Parameters
    ----------
    profile : GearProfile
        One tooth pitch, of the transverse section.
    helix_angle : float
        Helix angle on the circle halfway up the teeth, 0 for spur teeth. [rad]

    Notes
    -----
    An involute profile holds the product :math:`m \cos\alpha = 2 r_b / z` only. Of the usual
    pressure angles the first is taken that gives a module of ISO 54 or a whole diametral pitch
    within 0.03 %; those of helical teeth are in use across the teeth,
    :math:`\tan\alpha_t = \tan\alpha_n / \cos\beta`, :math:`m_t = m_n / \cos\beta`, within 0.3 %.
    The profile shift follows from the tooth thickness,
    :math:`\vartheta_b = \pi/(2z) + 2 x \tan\alpha / z + \mathrm{inv}\,\alpha`.

    References
    ----------
    .. [1] ISO 54:1996, Cylindrical gears for general and heavy engineering: modules.
    .. [2] ISO 21771:2007, Gears: cylindrical involute gears and gear pairs, section 4.
    """
    flank = profile.involute
    if flank is None:
        return None
    middle = 0.5 * (profile.root_radius + profile.tip_radius)
    # turn of the teeth along the axis: the same at every radius
    turn = np.tan(helix_angle) / middle
    angles, helices = _transverse(_ANGLES, turn, flank.base_radius)
    product = 2.0 * flank.base_radius / profile.tooth_count
    known = np.concatenate([_MODULES, _INCH / _PITCHES])
    modules = product / np.cos(angles) * np.cos(helices)
    off = np.abs(known / modules[:, None] - 1.0).min(axis=1)
    fitting = np.flatnonzero(off < (_HELICAL_MATCH if helix_angle else _MATCH))
    chosen = fitting[0] if fitting.size else 0
    angle = float(angles[chosen])
    half = flank.base_half_angle - float(involute_function(angle))
    shift = 0.5 * (half * profile.tooth_count - 0.5 * np.pi) / np.tan(angle)
    return GearData(
        tooth_count=profile.tooth_count,
        module=float(product / np.cos(angle)),
        pressure_angle=angle,
        profile_shift=float(shift),
        tip_rounding=tip_rounding(flank, profile.tip_radius),
        standard=fitting.size > 0,
        helix_angle=float(helices[chosen]),
    )


def _transverse(normal_angles: Array, turn: float, base_radius: float) -> tuple[Array, Array]:
    """Transverse pressure angles [rad] and helix angles [rad] on the reference circle.

    ``turn`` is that of the teeth along the axis. [rad/m]
    """
    helices = np.zeros_like(normal_angles)
    for _ in range(_ROUNDS):
        angles = np.arctan(np.tan(normal_angles) / np.cos(helices))
        helices = np.arctan(turn * base_radius / np.cos(angles))
    return angles, helices


def tip_rounding(flank: InvoluteFlank, tip_radius: float) -> float:
    """Radius of the arc that joins the end of an involute to the tip circle tangentially. [m]."""
    end = flank.roll_length(flank.tip_form_radius)

    def excess(radius: float) -> float:
        return flank.roll_length(tip_radius - radius) + radius - end

    largest = tip_radius - flank.base_radius
    if tip_radius - flank.tip_form_radius < 1e-5 * tip_radius or excess(0.0) <= 0.0:
        return 0.0
    steps = np.linspace(0.0, largest, 200)
    below = next((step for step in steps if excess(step) <= 0.0), None)
    return 0.0 if below is None else root_between(excess, 0.0, below)


CERTAIN_BASE_DIAMETER = 3e-6
"""Uncertainty of a base diameter that needs no word. [m]"""


def file_report(contents: FileContents, center_distance: float | None = None) -> dict[str, object]:
    """Numbers of all gears of a file and of the pairs that they form.

    ``gears``, ``ring_gears``, ``pairs`` and ``other_bodies``; names carry their units.

    Parameters
    ----------
    center_distance : float or None
        Distance at which the backlash is wanted: of the first two gears, or of one gear with its
        equal. [m]
    """
    pairs = [pair_report(*two) for two in combinations(contents.gears, 2)]
    pairs += [inner_pair_report(*two) for two in product(contents.rings, contents.gears)]
    if center_distance is not None and contents.gears:
        first, second = contents.gears[0], contents.gears[min(1, len(contents.gears) - 1)]
        pairs.append(_at_distance(first, second, center_distance))
    return {
        "gears": [gear_report(gear) for gear in contents.gears],
        "ring_gears": [ring_report(ring) for ring in contents.rings],
        "pairs": [pair for pair in pairs if pair],
        "other_bodies": [
            {"file": other.file.name, "body": other.body, "name": other.name}
            for other in contents.others
        ],
    }


def likelier_units(contents: FileContents, scales: Mapping[str, float]) -> list[str]:
    """Units in which the largest gear has a standard module, where it has none as read.

    Names of the units, empty if the gear is a standard one as read.

    Parameters
    ----------
    scales : mapping
        Length of each unit over the one that the file was read in. [-]
    """
    largest = (*contents.gears, *contents.rings)[0]
    profile, helix = largest.detected.profile, largest.helix_angle
    data = gear_data(profile, helix)
    if data is None or data.standard:
        return []
    known = {name: gear_data(profile.scaled(scale), helix) for name, scale in scales.items()}
    return [name for name, found in known.items() if found is not None and found.standard]


def flank_warnings(contents: FileContents) -> list[str]:
    """What the flanks of the gears leave uncertain: taper, base diameters not known to 3 um.

    One line for each such gear, with its taper, or its form error and chords.
    """
    lines = []
    for gear in (*contents.gears, *contents.rings):
        if gear.taper:
            lines.append(
                f"{_called(gear)}: its teeth taper by {np.rad2deg(gear.taper):.2g} deg along the "
                "axis, as drafted, conical or bevel ones; the numbers are those of one section"
            )
        fit, chord = gear.detected.involute, 1e6 * gear.detected.chord_height
        if fit is not None and fit.base_diameter_uncertainty > CERTAIN_BASE_DIAMETER:
            lines.append(
                f"{_called(gear)}: flanks leave the fitted involute by {1e6 * fit.form_error:.2g} "
                f"um (chords of {chord:.2g} um), so the base diameter is known to "
                f"{1e6 * fit.base_diameter_uncertainty:.2g} um; export more points of the flank, "
                f"or STEP"
            )
    return lines


def continuous_contact(
    first: FoundGear, second: FoundGear | None = None
) -> tuple[RolledOutline | None, str]:
    """How a gear rolls on another one or on its equal, and why not in continuous contact.

    The outline on its pitch circle, None where that lies outside the teeth; the reason is empty
    for gears of continuous contact.

    Parameters
    ----------
    second : FoundGear, optional
        Gear in mesh with the first one; an equal one without backlash if not given.
    """
    drawn, distance, apart = first.detected.drawn, None, 0.0
    if second is not None and second is not first:
        distance = axis_distance(first, second)
        apart = outlines_apart(drawn, second.detected.drawn)
    if not np.isfinite(apart):
        return None, "gears with unlike tooth counts"
    try:
        rolled = rolled_outline(drawn, distance)
    except GeometryError as error:
        return None, f"a centre distance of {error.problems[0].found} for these teeth"
    if apart > LARGEST_DIFFERENCE * rolled.module:
        return rolled, f"gears whose outlines are {1e3 * apart:.3g} mm apart"
    return rolled, rolled.refusal


def contact_notes(contents: FileContents) -> list[str]:
    """Which gears are those of continuous contact, and why other flanks than involutes are none."""
    lines = []
    reaching = [two for two in combinations(contents.gears, 2) if pair_report(*two)]
    alone = [(gear, gear) for gear in contents.gears]
    for first, second in reaching or alone:
        rolled, reason = continuous_contact(first, second)
        names = " and ".join(dict.fromkeys(_called(gear) for gear in (first, second)))
        if not reason and rolled is not None:
            lines.append(
                f"{names}: tips roll through the roots of an equal gear (continuous contact, pitch "
                f"diameter {2e3 * rolled.pitch_radius:.5g} mm)"
            )
        elif first.detected.involute is None:
            lines.append(f"{names}: no involutes, and no continuous contact: {reason}")
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
        "taper_deg": float(np.rad2deg(found.taper)),
        "axis": [float(value) for value in found.axis],
        "center_mm": [1e3 * float(value) for value in found.center],
        "chord_height_um": 1e6 * found.detected.chord_height,
        "largest_tooth_deviation_um": 1e6 * float(found.detected.tooth_deviation.max()),
    }
    return numbers | _involute_numbers(found)


def ring_report(found: FoundGear) -> dict[str, object]:
    """Numbers of a ring gear or outer rotor: its tips are the roots of its outline, and so on."""
    numbers = gear_report(found)
    exchanged = {
        "tip_diameter_mm": "root_diameter_mm",
        "form_diameter_mm": "tip_form_diameter_mm",
    }
    exchanged |= {other: name for name, other in exchanged.items()}
    of_spaces = ("tip_rounding_mm", "undercut", "undercut_depth_um")
    return {exchanged.get(k, k): value for k, value in numbers.items() if k not in of_spaces}


def _involute_numbers(found: FoundGear) -> dict[str, object]:
    fit, data = found.detected.involute, gear_data(found.detected.profile, found.helix_angle)
    if fit is None or data is None:
        return {}
    of_pitch = {}
    if len(fit.left_offset) >= found.detected.tooth_count:
        profile = found.detected.profile
        pitch = fit.pitch_deviation(0.5 * (fit.flank.form_radius + profile.tip_radius))
        of_pitch = {
            "single_pitch_deviation_um": 1e6 * pitch.single,
            "cumulative_pitch_deviation_um": 1e6 * pitch.cumulative,
            "run_out_um": 1e6 * pitch.run_out,
        }
    across = {
        "normal_module_mm": 1e3 * data.normal_module,
        "normal_pressure_angle_deg": float(np.rad2deg(data.normal_pressure_angle)),
        "reference_helix_angle_deg": float(np.rad2deg(data.helix_angle)),
    }
    return {
        "module_mm": 1e3 * data.module,
        **(across if data.helix_angle else {}),
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
        **of_pitch,
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


def inner_pair_report(ring: FoundGear, inner: FoundGear) -> dict[str, object]:
    r"""Centre distance of a gear inside a ring gear or outer rotor, and backlash of involutes.

    Notes
    -----
    With half angles :math:`\vartheta_b` of the tooth and of the space on their base circles,
    :math:`j_n = 2 r_{b2} (\vartheta_{b2} - \mathrm{inv}\,\alpha_w) - 2 r_{b1} (\vartheta_{b1} -
    \mathrm{inv}\,\alpha_w)` at the working pressure angle
    :math:`\cos\alpha_w = (r_{b2} - r_{b1})/a`.
    """
    distance = axis_distance(ring, inner)
    outline, profile = ring.detected.profile, inner.detected.profile
    if distance is None or distance + profile.root_radius > outline.tip_radius:
        return {}
    pair: dict[str, object] = {
        "gears": [_called(ring), _called(inner)],
        "center_distance_mm": 1e3 * distance,
    }
    space, tooth = outline.involute, profile.involute
    if space is None or tooth is None:
        return pair
    bases = space.base_radius - tooth.base_radius
    if not 0.0 < bases < distance:
        return pair
    working = involute_function(np.arccos(bases / distance))
    play = 2.0 * space.base_radius * (space.base_half_angle - working)
    play -= 2.0 * tooth.base_radius * (tooth.base_half_angle - working)
    return {**pair, "normal_backlash_mm": 1e3 * float(play)}


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
