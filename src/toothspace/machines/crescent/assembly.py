"""Pinion and ring put into mesh: profiles, centre distance, contact on the loaded flank.

Frame: origin at the pinion's centre, the mesh above it, the ring's centre below it; x towards the
outlet; both gears turn counter-clockwise.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from functools import lru_cache
from pathlib import Path
from typing import final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.frozen import Points
from toothspace.core.types import Array
from toothspace.core.units import to_si
from toothspace.gearing.mesh_split import Mesh
from toothspace.gearing.meshing import in_contact, lens_angle
from toothspace.gearing.ring_gear import (
    InternalPair,
    RingGear,
    pair_from_backlash,
    ring_outline,
    ring_tooth,
)
from toothspace.gearing.ring_profile import RingProfile, profile_outline, profile_tooth
from toothspace.gearing.spaces import Spaces, drive_spaces, driven_spaces
from toothspace.gearing.tooth import Tooth, tooth_curves
from toothspace.geometry.cad_import import load_closed_curves
from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.involute import InvoluteGear, generate_profile, tooth_form
from toothspace.geometry.profile_detection import gear_profile_from_curve
from toothspace.machines.crescent.parameters import CrescentParameters

POINTS_PER_TOOTH = 200


@final
@dataclass(frozen=True)
class CrescentAssembly:
    """Pinion and ring in mesh with the loaded flanks in contact.

    Parameters
    ----------
    spec : CrescentParameters
        Machine.
    pinion : GearProfile
        Profile of the pinion.
    ring_curve : ndarray, shape (n, 2)
        Teeth of the ring about its centre, a tooth on the y axis. [m]
    root_radius : float
        Root circle of the ring, outside its teeth. [m]
    teeth : tuple of Tooth
        Flanks of pinion and ring.
    mesh : Mesh
        Relative position.
    pair : InternalPair or None
        Involute pair where both gears are given by parameters.
    """

    spec: CrescentParameters
    pinion: GearProfile
    ring_curve: Array
    root_radius: float
    teeth: tuple[Tooth, Tooth]
    mesh: Mesh
    pair: InternalPair | None

    @property
    def face_width(self) -> float:
        """Axial width of both gears. [m]."""
        return self.spec.pinion.face_width

    @property
    def counts(self) -> tuple[int, int]:
        """Tooth counts of pinion and ring."""
        return self.teeth[0].tooth_count, -self.teeth[1].tooth_count

    @property
    def ratio(self) -> float:
        """Speed of the ring over that of the pinion. [-]."""
        return -self.mesh.ratio

    @property
    def ring_center(self) -> Array:
        """Centre of the ring. [m]."""
        return np.array([0.0, self.mesh.center_distance])

    @property
    def tip_radii(self) -> tuple[float, float]:
        """Tip circles of pinion and ring. [m]."""
        return self.teeth[0].tip_radius, -self.teeth[1].tip_radius

    @property
    def loaded_is_left(self) -> bool:
        """Whether the loaded flanks are the left ones (pump) or the right ones (motor)."""
        return self.spec.mode == "pump"

    @property
    def involute_path(self) -> None:
        """Path of contact in closed form; here it is found from the gaps."""
        return None

    def table_places(self, gear: int, nodes: int) -> Array:
        """Places of the table nodes of a gear in the sense of rotation, opposite the mesh first.

        Both gears have one even number of nodes on a pitch, so that interpolation errors of
        neighbours cancel. [rad]
        """
        per_pitch = 2 * max(round(0.5 * nodes / self.counts[0]), 2)
        count = per_pitch * self.counts[gear]
        return -np.pi + 2.0 * np.pi * np.arange(count) / count

    def spaces(self, nodes: int) -> tuple[Spaces, Spaces]:
        """Tooth spaces of both gears at their table nodes, about so many on a turn."""
        return self.spaces_at(self.table_places(0, nodes), self.table_places(1, nodes))

    def spaces_at(self, pinion_places: Array, ring_places: Array) -> tuple[Spaces, Spaces]:
        """Tooth spaces at places in the sense of rotation [rad].

        Places of the ring leave out its turn into contact.
        """
        return (
            drive_spaces(*self.teeth, self.mesh, pinion_places),
            driven_spaces(*self.teeth, self.mesh, -ring_places - self.mesh.turn),
        )


def assemble(spec: CrescentParameters) -> CrescentAssembly:
    """Put the gears of a machine into mesh.

    Parameters
    ----------
    spec : CrescentParameters
        Machine.

    Returns
    -------
    Assembly
        Gears with the loaded flank pair in contact.

    Raises
    ------
    GeometryError
        If a gear cannot be built, or the gears do not reach one another or overlap.
    """
    if (spec.pinion.profile is None) != (spec.ring.profile is None):
        raise GeometryError(
            "machine.ring.profile: found a profile file of one gear, allowed files of both gears "
            "or of none"
        )
    if spec.pinion.profile is None or spec.ring.profile is None:
        return _generated(spec)
    pinion = _curve_profile(spec, spec.pinion.profile, spec.pinion.tooth_count, "pinion")
    spaces = _curve_profile(spec, spec.ring.profile, spec.ring.tooth_count, "ring")
    ring = RingProfile(spaces)
    assert spec.pinion.center_distance is not None
    teeth = tooth_curves(pinion), profile_tooth(ring)
    mesh = _mesh(teeth, spec.pinion.center_distance)
    curve = profile_outline(ring, 0.5 * np.pi)
    return _touching(CrescentAssembly(spec, pinion, curve, ring.root_radius, teeth, mesh, None))


def _generated(spec: CrescentParameters) -> CrescentAssembly:
    pair = involute_pair(spec)
    pinion = generate_profile(pair.pinion, POINTS_PER_TOOTH)
    teeth = tooth_curves(pinion), ring_tooth(pair.ring, POINTS_PER_TOOTH)
    mesh = _mesh(teeth, pair.center_distance)
    curve = ring_outline(pair.ring, POINTS_PER_TOOTH, 0.5 * np.pi)
    root = pair.ring.root_radius
    return _touching(CrescentAssembly(spec, pinion, curve, root, teeth, mesh, pair))


def involute_pair(spec: CrescentParameters) -> InternalPair:
    """Involute gears of a machine whose gears are given by parameters.

    Raises
    ------
    GeometryError
        If a tooth or the mesh is impossible.
    """
    pinion, ring = spec.pinion, spec.ring
    assert pinion.tooth_count is not None
    assert ring.tooth_count is not None
    assert pinion.module is not None
    assert pinion.pressure_angle is not None
    assert ring.tip_diameter is not None
    try:
        gear = InvoluteGear(
            tooth_count=pinion.tooth_count,
            module=pinion.module,
            pressure_angle=pinion.pressure_angle,
            profile_shift=pinion.profile_shift,
            tip_diameter=pinion.tip_diameter,
            dedendum=pinion.dedendum,
            tool_tip_radius=pinion.tool_tip_radius,
            tip_rounding=pinion.tip_rounding,
        )
        tooth_form(gear)
    except GeometryError as error:
        raise GeometryError(f"machine.pinion.{error}") from error
    try:
        spaces = InvoluteGear(
            tooth_count=ring.tooth_count,
            module=pinion.module,
            pressure_angle=pinion.pressure_angle,
            profile_shift=ring.profile_shift,
            tip_diameter=ring.root_diameter,
            tip_rounding=ring.root_fillet,
        )
        teeth = RingGear(spaces, 0.5 * ring.tip_diameter)
    except GeometryError as error:
        raise GeometryError(f"machine.ring.{_of_ring(str(error))}") from error
    if pinion.center_distance is not None:
        return _pair_at(gear, teeth, pinion.center_distance)
    assert pinion.normal_backlash is not None
    try:
        return pair_from_backlash(gear, teeth, pinion.normal_backlash)
    except GeometryError as error:
        raise GeometryError(f"machine.{error}") from error


def _of_ring(message: str) -> str:
    """Message on the tooth of the space, in the keys of the ring."""
    if message.startswith("tip_rounding"):
        return message.replace("tip_rounding", "root_fillet", 1)
    if message.startswith("tip_diameter") and "where the tooth is pointed" in message:
        return message.replace("tip_diameter", "root_diameter", 1).replace("tooth", "space")
    return message


def _pair_at(pinion: InvoluteGear, ring: RingGear, distance: float) -> InternalPair:
    tight = pair_from_backlash(pinion, ring, 0.0).center_distance
    least = ring.base_radius - pinion.base_radius
    if not least < distance <= tight:
        raise GeometryError(
            f"machine.pinion.center_distance: found {distance * 1e3:.5g} mm, allowed above "
            f"{least * 1e3:.5g} mm up to {tight * 1e3:.6g} mm (no backlash)"
        )
    return InternalPair(pinion, ring, distance)


def _curve_profile(
    spec: CrescentParameters, file: Path | Points, tooth_count: int | None, table: str
) -> GearProfile:
    unit = to_si(1.0, spec.pinion.profile_unit)
    key = f"machine.{table}.profile"
    modified = file.stat().st_mtime_ns if isinstance(file, Path) else 0
    return _detected(file, modified, unit, tooth_count, key)


@lru_cache(maxsize=8)
def _detected(
    file: Path | Points, _modified: int, unit: float, tooth_count: int | None, key: str
) -> GearProfile:
    try:
        curve = load_closed_curves(file, unit)[0]
        return gear_profile_from_curve(curve, key=key, tooth_count=tooth_count).profile
    except GeometryError as error:
        raise GeometryError(f"{key}: {error}") from error
    except (ArithmeticError, LookupError, ValueError) as error:
        allowed = "the closed outline of a gear with equal teeth"
        raise GeometryError(f"{key}: {file.name} has no teeth, allowed {allowed}") from error


def _mesh(teeth: tuple[Tooth, Tooth], distance: float) -> Mesh:
    pinion, ring = teeth
    first, second = pinion.tip_radius, -ring.tip_radius
    if not second - first < distance < first + second:
        raise GeometryError(
            f"machine.pinion.center_distance: found {distance * 1e3:.5g} mm, allowed above "
            f"{(second - first) * 1e3:.5g} mm (the tip circles must overlap)"
        )
    return Mesh(
        center_distance=-distance,
        ratio=pinion.tooth_count / ring.tooth_count,
        half_pitch=np.pi / pinion.tooth_count,
        turn=0.0,
        lens_drive=lens_angle(pinion.tip_radius, ring.tip_radius, -distance),
        lens_driven=-lens_angle(ring.tip_radius, pinion.tip_radius, -distance),
    )


def _touching(centred: CrescentAssembly) -> CrescentAssembly:
    try:
        mesh = in_contact(centred.teeth, centred.mesh, centred.loaded_is_left)
    except GeometryError as error:
        raise GeometryError(f"machine.pinion: {error}") from error
    return replace(centred, mesh=mesh)
