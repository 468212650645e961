"""Flow paths of an external gear machine over the angle."""

from __future__ import annotations

import numpy as np

from toothspace.closures.gap_flow import tilted_gap_height
from toothspace.closures.smooth import smooth_step
from toothspace.core.types import Array
from toothspace.gearing.numbering import FULL_TURN, Numbering
from toothspace.gearing.openings import groove_openings, port_lengths
from toothspace.gearing.space_paths import ToothSpaces, flank_paths
from toothspace.gearing.spaces import Spaces
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.casing import bore
from toothspace.machines.external_gear.gear_bodies import BODIES, groove_polygons
from toothspace.model.description import FlowPath
from toothspace.model.path_category import PathCategory

TOOTH_TIP = PathCategory("tooth_tip", "tooth tips", "#0072B2", "gap")

GEARS = ("drive", "driven")
MOTIONS = 5


def flow_paths(
    assembly: Assembly, numbering: Numbering, spaces: tuple[Spaces, Spaces]
) -> tuple[FlowPath, ...]:
    """All flow paths of the machine.

    Returns
    -------
    tuple of FlowPath
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
        clearance, cover = casing.clearance_at(places), bore_cover(assembly, gear, places)
        motion = np.zeros((places.size, MOTIONS))
        motion[:, 2 * gear] = np.sin(places)
        motion[:, 2 * gear + 1] = np.cos(places) * (-1.0 if gear == 0 else 1.0)
        roughness = spec.keys.casing.roughness
        paths.append(
            own.tips("tooth_tip", TOOTH_TIP, clearance, cover, motion, roughness, BODIES[gear])
        )
        paths.extend(own.port_openings((casing.inlet_angle, casing.outlet_angle)))
        paths.extend(own.openings("groove", grooves_by_port(assembly, spaces[gear])))
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
