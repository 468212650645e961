"""Pinion and ring put into mesh: profiles, centre distance, contact on the loaded flank.

Frame: origin at the pinion's centre, the mesh above it, the ring's centre below it; x towards the
outlet; both gears turn counter-clockwise.
"""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache
from pathlib import Path
from typing import Any, final

import numpy as np
import shapely

from toothspace.core.errors import GeometryError, Problem
from toothspace.core.files import reading
from toothspace.core.frozen import Points
from toothspace.core.types import Array
from toothspace.core.units import to_si
from toothspace.gearing.gear_tables import ReliefGrooves
from toothspace.gearing.helix import Helix
from toothspace.gearing.materials import Material, library_material
from toothspace.gearing.meshing import MeshedGears, in_contact, mesh_at_distance
from toothspace.gearing.ring_gear import (
    InternalPair,
    RingGear,
    RingProfile,
    pair_from_backlash,
    profile_outline,
    profile_tooth,
    ring_outline,
    ring_tooth,
)
from toothspace.gearing.tooth import tooth_curves
from toothspace.geometry.cad_import import is_solid, load_closed_curves
from toothspace.geometry.gear_finder import find_gears
from toothspace.geometry.gear_profile import GearProfile
from toothspace.geometry.involute import InvoluteGear, generate_profile
from toothspace.geometry.profile_detection import gear_profile_from_curve
from toothspace.machines.crescent.parameters import CrescentParameters
from toothspace.machines.shared_bearings import require_rim, require_shaft_below

POINTS_PER_TOOTH = 200
_ARC = 181
_FAR = 10.0


@final
@dataclass(frozen=True, kw_only=True)
class CrescentAssembly(MeshedGears):
    """Pinion and ring in mesh with the loaded flanks in contact."""

    spec: CrescentParameters
    """Machine."""
    pinion: GearProfile
    """Profile of the pinion."""
    ring_curve: Array
    """Teeth of the ring about its centre, a tooth on the y axis. Shape (n, 2). [m]"""
    materials: tuple[Material, Material]
    """Materials of pinion and ring."""
    grooves: ReliefGrooves | None
    """Relief grooves of the covers, None without."""
    pair: InternalPair | None
    """Involute pair where both gears are given by parameters."""

    @property
    def helix(self) -> Helix | None:
        """How the teeth of both gears wind about their axes; None for spur gears."""
        drawn = self.pinion if self.spec.pinion.profile else None
        return self.spec.pinion.helix(self.face_width, drawn)

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
    def root_radius(self) -> float:
        """Root circle of the ring, outside its teeth. [m]."""
        return -self.root_radii[1]


def assemble(spec: CrescentParameters) -> CrescentAssembly:
    """Put the gears of a machine into mesh.

    Raises GeometryError if a gear cannot be built, or the gears do not reach one another or
    overlap.
    """
    if (spec.pinion.profile is None) != (spec.ring.profile is None):
        raise GeometryError(
            "machine.ring.profile", "a profile file of one gear", "files of both gears or of none"
        )
    if spec.pinion.profile is None or spec.ring.profile is None:
        pair = involute_pair(spec)
        pinion = generate_profile(pair.pinion, POINTS_PER_TOOTH)
        teeth = tooth_curves(pinion), ring_tooth(pair.ring, POINTS_PER_TOOTH)
        curve = ring_outline(pair.ring, POINTS_PER_TOOTH, 0.5 * np.pi)
        distance, root = pair.center_distance, pair.ring.root_radius
    else:
        pair, distance = None, spec.pinion.center_distance or 0.0
        pinion = _curve_profile(spec, spec.pinion.profile, spec.pinion.tooth_count, "pinion")
        spaces = _curve_profile(spec, spec.ring.profile, spec.ring.tooth_count, "ring")
        ring = RingProfile(spaces)
        teeth = tooth_curves(pinion), profile_tooth(ring)
        curve, root = profile_outline(ring, 0.5 * np.pi), ring.root_radius
    require_rim("machine.ring.outer_diameter", spec.ring.outer_diameter, root)
    shaft = spec.journal_bearings.diameter
    require_shaft_below("machine.journal_bearings.diameter", shaft, pinion.root_radius)
    notch, width = spec.filler.notch, spec.pinion.face_width
    if notch is not None and notch.width > width:
        raise GeometryError(
            "machine.filler.notch.width",
            f"{notch.width * 1e3:g} mm",
            f"at most the face width of {width * 1e3:g} mm",
        )
    loaded_is_left, grooves = spec.mode == "pump", spec.relief_grooves
    first, second = teeth[0].tip_radius, -teeth[1].tip_radius
    if not second - first < distance < first + second:
        raise GeometryError(
            "machine.pinion.center_distance",
            f"{distance * 1e3:.5g} mm",
            f"above {(second - first) * 1e3:.5g} mm (the tip circles must overlap)",
        )
    try:
        mesh = in_contact(teeth, mesh_at_distance(teeth, -distance), loaded_is_left)
    except GeometryError as error:
        raise error.read_for("machine.pinion") from error
    return CrescentAssembly(
        teeth=teeth,
        root_radii=(pinion.root_radius, -root),
        mesh=mesh,
        face_width=spec.pinion.face_width,
        loaded_is_left=loaded_is_left,
        pair=pair,
        spec=spec,
        pinion=pinion,
        ring_curve=curve,
        materials=(
            library_material(spec.pinion.material, "machine.pinion.material"),
            library_material(spec.ring.material, "machine.ring.material"),
        ),
        grooves=grooves.grooves("machine.") if grooves else None,
    )


def involute_pair(spec: CrescentParameters) -> InternalPair:
    """Involute gears of a machine whose gears are given by parameters.

    Raises GeometryError if a tooth or the mesh is impossible.
    """
    pinion, ring = spec.pinion, spec.ring
    gear = pinion.involute_gear("machine.pinion")
    assert ring.tooth_count is not None
    assert ring.tip_diameter is not None
    try:
        spaces = InvoluteGear(
            tooth_count=ring.tooth_count,
            module=gear.module,
            pressure_angle=gear.pressure_angle,
            profile_shift=ring.profile_shift * pinion.slope,
            tip_diameter=ring.root_diameter,
            tip_rounding=ring.root_fillet,
        )
        teeth = RingGear(spaces, 0.5 * ring.tip_diameter)
    except GeometryError as error:
        raise error.changed(_in_keys_of_ring).under("machine.ring") from error
    try:
        pair = pair_from_backlash(gear, teeth, pinion.transverse_backlash)
    except GeometryError as error:
        raise error.under("machine") from error
    distance, least = pinion.center_distance, pair.base_difference
    if distance is None:
        return pair
    if not least < distance <= pair.center_distance:
        raise GeometryError(
            "machine.pinion.center_distance",
            f"{distance * 1e3:.5g} mm",
            f"above {least * 1e3:.5g} mm up to {pair.center_distance * 1e3:.6g} mm (no backlash)",
        )
    return InternalPair(gear, teeth, distance)


def _in_keys_of_ring(problem: Problem) -> Problem:
    """Problem of the tooth that fills a space, in the keys of the ring."""
    if problem.key == "tip_rounding":
        return problem._replace(key="root_fillet")
    if problem.key != "tip_diameter" or "end of the involute" in problem.allowed:
        return problem
    found, allowed = (text.replace("tooth", "space") for text in (problem.found, problem.allowed))
    return problem._replace(key="root_diameter", found=found, allowed=allowed)


def _curve_profile(
    spec: CrescentParameters, file: Path | Points, tooth_count: int | None, table: str
) -> GearProfile:
    unit = to_si(1.0, spec.pinion.profile_unit)
    key = f"machine.{table}.profile"
    modified = file.stat().st_mtime_ns if isinstance(file, Path) else 0
    return _detected(file, modified, unit, tooth_count, key, is_ring=table == "ring")


@lru_cache(maxsize=8)
def _detected(
    file: Path | Points,
    _modified: int,
    unit: float,
    tooth_count: int | None,
    key: str,
    *,
    is_ring: bool,
) -> GearProfile:
    try:
        if is_solid(file):
            contents = find_gears(file, unit)
            found = contents.rings if is_ring else contents.gears
            if not found:
                wanted = "a ring with teeth in its bore" if is_ring else "an external gear"
                raise GeometryError(file, "none", wanted)
            return found[0].detected.profile
        with reading(file.name, "the closed outline of a gear with equal teeth"):
            curve = load_closed_curves(file, unit)[0]
            return gear_profile_from_curve(curve, key=key, tooth_count=tooth_count).profile
    except GeometryError as error:
        raise error.read_for(key) from error


@final
@dataclass(frozen=True)
class FillerEdges:
    """Ends of the filler as one gear sees them, from the mesh side of the centre line."""

    inlet: float
    outlet: float
    """Angles about the centre of the gear. [rad]"""

    @property
    def span(self) -> float:
        """Angle over which the filler seals. [rad]."""
        return 2.0 * np.pi - self.inlet - self.outlet


def filler_edges(assembly: CrescentAssembly, gear: int) -> FillerEdges:
    """Ends of the filler at the tip circle of the pinion (0) or of the ring (1).

    Its end faces point to the centre of the pinion.
    """
    given = assembly.spec.filler.inlet_angle, assembly.spec.filler.outlet_angle
    if gear == 0:
        return FillerEdges(*given)
    return FillerEdges(*(_about_ring(assembly, angle) for angle in given))


def _about_ring(assembly: CrescentAssembly, angle: float) -> float:
    """Angle about the ring's centre of the point where a ray from the pinion meets its tips."""
    distance, radius = -assembly.mesh.center_distance, assembly.tip_radii[1]
    along = -distance * np.cos(angle)
    reach = along + np.sqrt(along**2 + radius**2 - distance**2)
    return float(np.arctan2(reach * np.sin(angle), reach * np.cos(angle) + distance))


def filler_outline(assembly: CrescentAssembly) -> Array:
    """Outline of the filler in the machine frame, counter-clockwise. [m]."""
    filler = assembly.spec.filler
    pinion, ring = (filler_edges(assembly, gear) for gear in (0, 1))
    inner = assembly.tip_radii[0] + filler.pinion_clearance
    outer = assembly.tip_radii[1] - filler.ring_clearance
    turns = np.linspace(ring.inlet, 2.0 * np.pi - ring.outlet, _ARC)
    back = np.linspace(2.0 * np.pi - pinion.outlet, pinion.inlet, _ARC)
    return np.vstack([outer * _direction(turns) + assembly.ring_center, inner * _direction(back)])


def filler_thickness(assembly: CrescentAssembly) -> float:
    """Smallest radial thickness of the filler, at one of its ends. [m]."""
    filler = assembly.spec.filler
    play = filler.pinion_clearance + filler.ring_clearance
    center, found = assembly.ring_center, []
    for angle in (filler.inlet_angle, filler.outlet_angle):
        about = _about_ring(assembly, angle)
        point = assembly.tip_radii[1] * _direction(np.array([about]))[0] + center
        found.append(float(np.hypot(*point)) - assembly.tip_radii[0] - play)
    return min(found)


def _direction(places: Array) -> Array:
    """Unit vectors at places from the mesh side of the centre line along the rotation."""
    return np.column_stack([-np.sin(places), np.cos(places)])


def cover_recesses(assembly: CrescentAssembly) -> dict[str, Array]:
    """Outlines of the recesses at inlet and outlet, named by their port. [m].

    Each lies between the root circles of both gears, from its start near the mesh to the filler.
    """
    ports, filler = assembly.spec.ports, assembly.spec.filler
    spans = {
        "inlet": (ports.inlet_start, filler.inlet_angle),
        "outlet": (-filler.outlet_angle, -ports.outlet_start),
    }
    center = shapely.Point(*assembly.ring_center)
    gears: Any = center.buffer(assembly.root_radius, quad_segs=90).difference(
        shapely.Point(0.0, 0.0).buffer(assembly.pinion.root_radius, quad_segs=90)
    )
    found = {}
    for port, (start, end) in spans.items():
        rays = _FAR * assembly.root_radius * _direction(np.linspace(start, end, 91))
        wedge = shapely.Polygon(np.vstack([np.zeros((1, 2)), rays]))
        found[port] = np.asarray(gears.intersection(wedge).exterior.coords)[:-1]
    return found


def relief_polygons(assembly: CrescentAssembly) -> dict[str, Array]:
    """Outlines of the relief grooves, named by the port that they join. [m]."""
    grooves = assembly.grooves
    return {} if grooves is None else grooves.outlines(assembly.mesh.pitch_radii[0])
