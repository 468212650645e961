"""Both gears put into mesh: profiles, centre distance, and contact on the loaded flank."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.gearing import meshing
from toothspace.gearing.mesh_split import Mesh
from toothspace.gearing.tooth import Tooth, tooth_curves
from toothspace.geometry.gear_pair import (
    GearPair,
    flank_clearance,
    normal_play,
    pair_from_backlash,
    pair_from_center_distance,
)
from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.involute import InvoluteGear, generate_profile
from toothspace.machines.external_gear.spec import ExternalGearSpec

POINTS_PER_TOOTH = 200
_DEEP_OVERLAP = 2e-5
"""Overlap beyond which the closest points of splines are not searched for. [m]"""

_DRAWN_OVERLAP = 5e-6
"""Overlap of drawn flanks that both touch, by the chords of a file or its last digit. [m]"""


@final
@dataclass(frozen=True, kw_only=True)
class Assembly(meshing.MeshedGears):
    """Two gears in mesh with the loaded flanks in contact."""

    spec: ExternalGearSpec
    """Machine."""
    profiles: tuple[GearProfile, GearProfile]
    """Drive and driven profile."""
    pair: GearPair | None
    """Involute pair where both gears are given by parameters."""

    @property
    def flanks_in_turn(self) -> bool:
        """Whether both flanks of a tooth touch in turn, as in gears of continuous contact."""
        return self.spec.keys.gears.is_continuous

    @property
    def at_lagging_end(self) -> Assembly | None:
        """Same gears with the relief grooves of the end that lags, where these differ."""
        own = self.spec.lagging_grooves
        return None if own is None else replace(self, spec=replace(self.spec, grooves=own))

    @property
    def exact_path(self) -> tuple[float, float] | None:
        r"""Throat angles between which flanks touch; None for those from a file. [rad].

        Notes
        -----
        Of involutes, the roll lengths :math:`\rho_1 + \rho_2 = a \sin\alpha_w` both end at the
        tip form radius, and at the form radius of an undercut gear; the throat turns by
        :math:`\Delta\rho_1 / r_{b1}`.
        """
        if self.flanks_in_turn:
            # each side of a tooth for half a pitch, from the middle of its root to its tip
            ends = 0.0, self.mesh.half_pitch
            return ends if self.loaded_is_left else (-ends[1], -ends[0])
        drive, driven = (profile.involute for profile in self.profiles)
        if drive is None or driven is None:
            return None
        distance, sense = self.mesh.center_distance, 1.0 if self.loaded_is_left else -1.0
        angle = np.arccos(min((drive.base_radius + driven.base_radius) / distance, 1.0))
        length = distance * np.sin(angle)
        low = length - driven.roll_length(driven.tip_form_radius)
        high = drive.roll_length(drive.tip_form_radius)
        if drive.undercut:
            low = max(low, drive.roll_length(drive.form_radius))
        if driven.undercut:
            high = min(high, length - driven.roll_length(driven.form_radius))
        roll = np.array([low, max(high, low)])
        # the line of action leaves the base circle at the operating pressure angle from the centres
        place = np.arctan(roll / drive.base_radius) - angle
        half = np.asarray(drive.half_angle(np.hypot(drive.base_radius, roll)))
        throat = sense * (place - half + self.mesh.half_pitch)
        return float(throat.min()), float(throat.max())


def assemble(spec: ExternalGearSpec) -> Assembly:
    """Put the gears of a machine into mesh.

    Raises GeometryError if the gears do not reach one another or overlap.
    """
    drive, driven = spec.drive.tooth, spec.driven.tooth
    first, second = (
        generate_profile(tooth, POINTS_PER_TOOTH) if isinstance(tooth, InvoluteGear) else tooth
        for tooth in (drive, driven)
    )
    profiles = first, second
    if not isinstance(drive, InvoluteGear) or not isinstance(driven, InvoluteGear):
        pair = None
    elif spec.center_distance is not None:
        pair = pair_from_center_distance(drive, driven, spec.center_distance)
    else:
        pair = pair_from_backlash(drive, driven, spec.keys.gears.transverse_backlash)
    distance = pair.center_distance if pair is not None else _profile_distance(spec, profiles)
    teeth = tooth_curves(profiles[0]), tooth_curves(profiles[1])
    mesh = _centred_mesh(teeth, distance)
    if pair is None:
        # closest points of flanks that overlap deeply are none: involutes or outlines tell before
        tips = [
            (gear, distance - own.root_radius - other.tip_radius)
            for gear, own, other in zip(("drive", "driven"), profiles, profiles[::-1], strict=True)
        ]
        gear, room = min(tips, key=lambda pair: pair[1])
        play = normal_play(profiles, distance)
        if room < -meshing.LARGEST_OVERLAP and room <= play:
            raise GeometryError(
                "machine.gears.center_distance",
                f"{distance * 1e3:.5g} mm: the mating tip reaches {-room * 1e3:.4g} mm into the "
                f"{gear} gear's root",
                "a positive root clearance",
            )
        if play < -_DEEP_OVERLAP:
            raise meshing.overlap_error(distance, -play)
    loaded_is_left = spec.keys.mode == "pump"
    overlap = _DRAWN_OVERLAP if spec.keys.gears.is_drawn else meshing.LARGEST_OVERLAP
    return Assembly(
        teeth=teeth,
        root_radii=(profiles[0].root_radius, profiles[1].root_radius),
        mesh=meshing.in_contact(teeth, mesh, loaded_is_left, overlap),
        face_width=min(spec.drive.face_width, spec.driven.face_width),
        loaded_is_left=loaded_is_left,
        pair=pair,
        spec=spec,
        profiles=profiles,
    )


def _profile_distance(spec: ExternalGearSpec, profiles: tuple[GearProfile, GearProfile]) -> float:
    if spec.center_distance is not None:
        return spec.center_distance
    backlash = spec.keys.gears.normal_backlash or 0.0
    if spec.helix is not None:
        backlash /= np.cos(spec.helix.base_angle)  # of the transverse section
    near = max(
        profiles[0].tip_radius + profiles[1].root_radius,
        profiles[1].tip_radius + profiles[0].root_radius,
    )
    far = profiles[0].tip_radius + profiles[1].tip_radius

    def excess(distance: float) -> float:
        return float(2.0 * flank_clearance(*profiles, distance) - backlash)

    for _ in range(40):
        middle = 0.5 * (near + far)
        near, far = (near, middle) if excess(middle) > 0.0 else (middle, far)
    # the play along the normal is exact only between the splines themselves
    teeth = tooth_curves(profiles[0]), tooth_curves(profiles[1])
    distance, step = 0.5 * (near + far), 0.5e-3 * (near + far)
    for _ in range(12):
        found = []
        for d in (0.0, 1e-3 * step):
            mesh = _centred_mesh(teeth, distance + d)
            left, right = (
                meshing.smallest_gap(teeth, mesh, is_left)[0] for is_left in (True, False)
            )
            found.append(left + right)
        change = (backlash - found[0]) * 1e-3 * step / (found[1] - found[0])
        distance += min(max(change, -step), step)
        if abs(change) < 1e-12:
            break
    return distance


def _centred_mesh(teeth: tuple[Tooth, Tooth], distance: float) -> Mesh:
    drive, driven = teeth
    reach = drive.tip_radius + driven.tip_radius
    if not abs(drive.tip_radius - driven.tip_radius) < distance < reach:
        raise GeometryError(
            "machine.gears.center_distance",
            f"{distance * 1e3:.5g} mm",
            f"below {reach * 1e3:.5g} mm (the tip circles must overlap)",
        )
    return meshing.mesh_at_distance(teeth, distance)
