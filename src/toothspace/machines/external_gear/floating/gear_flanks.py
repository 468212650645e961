"""What acts on the flanks of an elastic gear: chamber pressures up to the throats, tooth contacts.

The frame is that of the gear: first tooth on the x axis, space k after tooth k.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
import shapely

from toothspace.core.types import Array
from toothspace.elasticity.surface_loads import AxialTraction, LateralFaces, LateralPressure, Load
from toothspace.gearing.meshing import loaded_throats
from toothspace.gearing.numbering import FULL_TURN
from toothspace.gearing.spaces import drive_spaces
from toothspace.geometry.gear_profile import GearProfile
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.gear_bodies import BODIES
from toothspace.machines.external_gear.gear_faces import FaceOfGear
from toothspace.model.floating_bearing import BodyLoad

_PATTERNS = 3
_MIDDLE = 1
_SAMPLES = 24
"""Places along a flank at which the chamber is looked up. [-]"""
_SIDES = ("left", "right")
"""Flanks of a space: the left one of the tooth before it, the right one of the tooth after it."""


def flank_loads(assembly: Assembly, gear: int) -> list[Load]:
    """Unit loads on the flanks of a gear.

    Pressures at root, middle and tip by ``space_k_side_n``; of helical teeth also one newton
    along z by ``thrust_k``, on the loaded flank of every space.
    """
    profile = assembly.profiles[gear]
    loads: list[Load] = []
    for name, space, side, n in _names(profile):

        def pattern(place: Array, n: int = n) -> Array:
            return _shares(profile, np.hypot(place[:, 0], place[:, 1]))[:, n]

        label = repr(("flank", n, profile.root_radius, profile.tip_radius))
        flank = _flank(assembly, gear, space, side)
        loads.append(LateralPressure(name, flank, pattern, label))
    if thrust(assembly, gear) != 0.0:
        for k in range(profile.tooth_count):
            flank = _flank(assembly, gear, k, 0 if assembly.loaded_is_left else 1)
            loads.append(AxialTraction(f"thrust_{k}", flank))
    return loads


def thrust(assembly: Assembly, gear: int) -> float:
    """Axial force of helical teeth on a gear, along z. [N]."""
    block = assembly.spec.floating_block
    return 0.0 if block is None else block.keys.gear_axial_force[gear]


def _width(assembly: Assembly, gear: int) -> float:
    return (assembly.spec.drive, assembly.spec.driven)[gear].face_width


def _flank(assembly: Assembly, gear: int, space: int, side: int) -> LateralFaces:
    """Faces in half of a space, from the middle of the tooth beside it, outside the shaft."""
    profile, half = assembly.profiles[gear], 0.5 * _width(assembly, gear)
    near = 0.5 * (assembly.spec.shaft_radius + profile.root_radius)
    angle = profile.pitch_angle * (space + 0.5 * side + np.linspace(0.0, 0.5, 17))
    rim = np.column_stack([np.cos(angle), np.sin(angle)])
    sector = shapely.Polygon(np.vstack([1.02 * profile.tip_radius * rim, near * rim[::-1]]))
    return LateralFaces(sector, -half, half)


def _names(profile: GearProfile) -> list[tuple[str, int, int, int]]:
    """Names of the loads, with space, side and pattern."""
    return [
        (f"space_{k}_{_SIDES[side]}_{n}", k, side, n)
        for k in range(profile.tooth_count)
        for side in (0, 1)
        for n in range(_PATTERNS)
    ]


def _shares(profile: GearProfile, radius: Array) -> Array:
    """Patterns at radii: linear between root, middle and tip; they sum to one."""
    places = np.linspace(profile.root_radius, profile.tip_radius, _PATTERNS)
    return np.column_stack([np.interp(radius, places, row) for row in np.eye(_PATTERNS)])


@final
@dataclass(frozen=True)
class GearFlanks:
    """Pressures and contacts on the flanks of a gear over the shaft angle."""

    face: FaceOfGear
    """Chambers round the gear."""

    @property
    def _profile(self) -> GearProfile:
        return self.face.own.profile

    def acting(self, shaft_angle: float) -> list[BodyLoad]:
        """Loads at a shaft angle [rad], several for one name where chambers meet on a flank."""
        return self._pressures(shaft_angle) + self._contacts(shaft_angle)

    def _pressures(self, shaft_angle: float) -> list[BodyLoad]:
        profile, body = self._profile, BODIES[self.face.gear]
        steps = (np.arange(_SAMPLES) + 0.5) / _SAMPLES
        radius = profile.root_radius + steps * (profile.tip_radius - profile.root_radius)
        nodes = self.face.flank_nodes(shaft_angle, radius)
        shares = _shares(profile, radius)
        shares /= shares.sum(axis=0)
        found = []
        for name, space, side, n in _names(profile):
            seen = nodes[space, side]
            for node in np.unique(seen):
                part = float(shares[seen == node, n].sum())
                found.append(BodyLoad(body, name, "node", int(node), part))
        return found

    def _contacts(self, shaft_angle: float) -> list[BodyLoad]:
        """Force of every contact on the middle of its flank, and its share of the thrust."""
        face, profile, numbering = self.face, self._profile, self.face.numbering
        assembly, body = face.assembly, BODIES[face.gear]
        # force of one pascal in the middle of a flank along its normal
        radius, angle = face.own.flank(0)
        line = radius[:, None] * np.column_stack([np.cos(angle), np.sin(angle)])
        share = _shares(profile, 0.5 * (radius[1:] + radius[:-1]))[:, _MIDDLE]
        along = np.sum(share[:, None] * np.diff(line, axis=0), axis=0)
        factor = 1.0 / (float(np.hypot(*along)) * _width(assembly, face.gear))
        turned = numbering.space_phases[0] + numbering.ratios[0] * shaft_angle
        place = np.mod(turned, FULL_TURN) - np.pi
        loaded = loaded_throats(assembly, drive_spaces(*assembly.teeth, assembly.mesh, place))
        point = loaded.drive.point if face.gear == 0 else loaded.driven.point
        angles = np.mod(face.own_angle(shaft_angle, *point.T), FULL_TURN)
        side, axial = _SIDES[0 if assembly.loaded_is_left else 1], thrust(assembly, face.gear)
        found = []
        for contact in np.flatnonzero(loaded.weight > 0.0).tolist():
            space = int(angles[contact] // profile.pitch_angle)
            name = f"space_{space}_{side}_{_MIDDLE}"
            found.append(BodyLoad(body, name, "contact", contact, factor))
            if axial != 0.0:
                name = f"thrust_{space}"
                found.append(BodyLoad(body, name, "contact_share", contact, axial))
        return found
