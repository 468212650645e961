"""Flow paths of an external gear machine over the angle."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np
import shapely

from toothspace.closures.gap_flow import tilted_gap_height
from toothspace.closures.smooth import smooth_step
from toothspace.core.errors import GeometryError
from toothspace.core.types import Array
from toothspace.gearing.numbering import FULL_TURN, Numbering
from toothspace.gearing.openings import groove_openings, port_lengths
from toothspace.gearing.space_paths import ToothSpaces, flank_paths
from toothspace.gearing.spaces import Spaces
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.gear_bodies import BODIES, groove_polygons
from toothspace.model.description import FlowPath
from toothspace.model.path_category import PathCategory

TOOTH_TIP = PathCategory("tooth_tip", "tooth tips", "#0072B2", "gap")

GEARS = ("drive", "driven")
MOTIONS = 5
_RAYS = 1440
_SEALING_CLEARANCES = 3.0


def flow_paths(
    assembly: Assembly, numbering: Numbering, spaces: tuple[Spaces, Spaces]
) -> tuple[FlowPath, ...]:
    """All flow paths of the machine.

    Flanks, then per gear tips, ports, grooves, lateral and drain gaps.
    """
    spec, lateral = assembly.spec, assembly.spec.keys.lateral
    gears = spec.drive, spec.driven
    rounding = min(gear.tip_rounding for gear in gears)
    peaks = gears[0].roughness, gears[1].roughness
    paths = list(flank_paths(assembly, numbering, spaces[0], rounding, peaks))
    for gear, own in enumerate(tooth_spaces(assembly, numbering, spaces)):
        profile, casing = assembly.profiles[gear], bore(assembly, gear)
        turn = assembly.mesh.turn if gear == 1 else 0.0
        places = assembly.table_places(gear, spaces[0].angles.size) - turn
        clearance = np.interp(places, casing.places, casing.clearance, period=2.0 * np.pi)
        cover = bore_cover(assembly, gear, places)
        motion = np.zeros((places.size, MOTIONS))
        motion[:, 2 * gear] = np.sin(places)
        motion[:, 2 * gear + 1] = np.cos(places) * (-1.0 if gear == 0 else 1.0)
        roughness = spec.keys.casing.roughness
        paths.append(
            own.tips("tooth_tip", TOOTH_TIP, clearance, cover, motion, roughness, BODIES[gear])
        )
        paths.extend(own.port_openings((casing.inlet_angle, casing.outlet_angle)))
        lagging = assembly.at_lagging_end
        if lagging is None:
            paths.extend(own.openings("groove", grooves_by_port(assembly, spaces[gear])))
        else:
            for end, face in ((1.0, assembly), (-1.0, lagging)):
                paths.extend(own.openings("groove", grooves_by_port(face, spaces[gear]), end))
        paths.append(own.lateral(lateral.leakage_height, profile.tooth_space_area))
        # a tilt raises the height of the land between tooth root and shaft
        inner, outer = spec.shaft_radius, profile.root_radius
        tilt = lateral.tilt * 0.5 * (inner + outer) / profile.tip_radius
        height = float(tilted_gap_height(lateral.leakage_height, tilt))
        paths.append(own.drain(height, (inner, outer)))
    return tuple(paths)


def tooth_spaces(
    assembly: Assembly, numbering: Numbering, spaces: tuple[Spaces, Spaces]
) -> tuple[ToothSpaces, ToothSpaces]:
    """Tooth spaces of drive and driven gear as chambers with their paths."""
    drive, driven = assembly.spec.drive.face_width, assembly.spec.driven.face_width
    return (
        ToothSpaces(assembly, numbering, spaces[0], GEARS[0], drive),
        ToothSpaces(assembly, numbering, spaces[1], GEARS[1], driven),
    )


def bore_cover(assembly: Assembly, gear: int, places: Array) -> Array:
    """Part of a tip that seals against the bore at places [rad], 0 in a port or the mesh. [-].

    It is 1 from the moment the leading tip corner leaves the inlet until the trailing corner
    reaches the outlet, and rises and falls outside over the angle of the tip land.
    """
    tooth, casing = assembly.teeth[gear], bore(assembly, gear)
    land = max(tooth.land_angle, np.deg2rad(0.5))
    ahead, behind = tooth.left.corner_angle, -tooth.right.corner_angle
    if gear == 1:
        ahead, behind = behind, ahead
    round_bore = np.mod(places, FULL_TURN)
    entered = (round_bore + ahead - casing.inlet_angle) / land + 1.0
    left = (FULL_TURN - casing.outlet_angle - round_bore + behind) / land + 1.0
    return np.asarray(smooth_step(entered) * smooth_step(left), dtype=float)


def port_opening_lengths(assembly: Assembly, spaces: Spaces) -> dict[str, Array]:
    """Length of the port openings of the tooth spaces of a gear. [m]."""
    casing = bore(assembly, 0 if spaces.is_drive else 1)
    lengths = port_lengths(spaces, (casing.inlet_angle, casing.outlet_angle))
    return dict(zip(("inlet", "outlet"), lengths, strict=True))


def grooves_by_port(assembly: Assembly, spaces: Spaces) -> dict[str, Array]:
    """Openings into the relief groove of each port, as of ``groove_openings``; none without."""
    grooves = assembly.spec.grooves
    if grooves is None:
        return {}
    found = groove_openings(spaces, groove_polygons(assembly), grooves.depth)
    return {name.removeprefix("groove_"): table for name, table in found.items()}


@final
@dataclass(frozen=True)
class Bore:
    """Casing as one gear sees it."""

    inlet_angle: float
    outlet_angle: float
    """From the mesh side of the centre line to the port edge along the bore. [rad]"""
    places: Array
    """Even places round the gear from the centre line in the sense of rotation, 0 to 2 pi. [rad]"""
    clearance: Array
    """Distance from the tip circle to the bore at the places. [m]"""


def bore(assembly: Assembly, gear: int) -> Bore:
    """Bore round the drive gear (0) or the driven gear (1).

    From clearance and angles, or from the contour where one is given: the bore reaches from the
    point opposite to the mesh as far as the contour stays within three clearances of the tip
    circle.

    Raises GeometryError if a contour does not surround the gear or leaves no sealing bore.
    """
    casing = assembly.spec.keys.casing
    places = 2.0 * np.pi * np.arange(_RAYS) / _RAYS
    contour = assembly.spec.casing_contour
    if contour is None:
        assert casing.inlet_angle is not None
        assert casing.outlet_angle is not None
        clearance = np.full(_RAYS, casing.radial_clearance)
        return Bore(casing.inlet_angle, casing.outlet_angle, places, clearance)
    center = _center(assembly, gear)
    rise = np.cos(places) if gear == 0 else -np.cos(places)
    directions = np.column_stack([-np.sin(places), rise])
    reach = 2.0 * float(np.max(np.hypot(*(contour - center).T)))
    ends = np.stack([np.broadcast_to(center, directions.shape), center + reach * directions], 1)
    ring = shapely.LinearRing(contour)
    hits = shapely.intersection(shapely.linestrings(ends), ring)
    # a ray that misses the contour counts as touching
    distance = np.nan_to_num(shapely.distance(hits, shapely.Point(*center)))
    clearance = np.asarray(distance - assembly.teeth[gear].tip_radius, dtype=float)
    limit = _SEALING_CLEARANCES * casing.radial_clearance
    if clearance.min() <= 0.0 or clearance[_RAYS // 2] > limit:
        raise GeometryError(
            "machine.casing.contour",
            f"{clearance.min() * 1e6:.4g} um from the tip circle and "
            f"{clearance[_RAYS // 2] * 1e6:.4g} um opposite to the mesh",
            f"above 0 um and up to {limit * 1e6:.4g} um",
        )
    # where the contour crosses the circle that bounds the sealing bore
    start = contour - _center(assembly, gear)
    beyond = np.sum(start**2, axis=1) - (assembly.teeth[gear].tip_radius + limit) ** 2
    crossing = np.flatnonzero(beyond * np.roll(beyond, -1) < 0.0)
    step = (np.roll(start, -1, axis=0) - start)[crossing]
    start, beyond = start[crossing], beyond[crossing]
    half, square = np.sum(start * step, axis=1), np.sum(step**2, axis=1)
    root = np.sign(beyond) * np.sqrt(half**2 - square * beyond)
    x, y = (start - ((half + root) / square)[:, None] * step).T
    edges = np.mod(np.arctan2(-x, y if gear == 0 else -y), 2.0 * np.pi)
    before = edges[edges < np.pi].max(initial=0.0)
    after = edges[edges > np.pi].min(initial=2.0 * np.pi)
    return Bore(float(before), float(2.0 * np.pi - after), places, np.minimum(clearance, limit))


def _center(assembly: Assembly, gear: int) -> Array:
    return np.array([0.0, 0.0 if gear == 0 else assembly.mesh.center_distance])
