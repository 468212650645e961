"""Bodies, their bearings and their faces."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from toothspace.closures.journal_friction import PUBLISHED
from toothspace.core.types import Array
from toothspace.gearing.flank_contacts import FlankPair, mesh_motions
from toothspace.gearing.materials import library_material, reduced_modulus
from toothspace.gearing.meshing import lens_angle
from toothspace.geometry.curve import polar, signed_area
from toothspace.geometry.involute import InvoluteGear
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.shared_bearings import (
    BEARINGS,
    CORRELATION_LENGTH,
    gear_on_shaft,
    shaft_bearings,
)
from toothspace.model.description import Body, FreeBlocks, LumpedJournalBearing

BODIES = ("drive_gear", "driven_gear")
BLOCKS = "bearing_blocks"
MOTIONS = mesh_motions(BODIES)
"""Micro-motions; the drive gear's rotation is the shaft angle."""


def flank_pair(assembly: Assembly) -> FlankPair:
    """What touches at the flanks; profiles from file count with a profile shift of zero."""
    gears = (assembly.spec.drive, assembly.spec.driven)
    shifts = [g.tooth.profile_shift if isinstance(g.tooth, InvoluteGear) else 0.0 for g in gears]
    return FlankPair(
        bodies=BODIES,
        materials=(gears[0].material, gears[1].material),
        roughness=(gears[0].roughness, gears[1].roughness),
        profile_shifts=(shifts[0], shifts[1]),
    )


def bodies(assembly: Assembly) -> tuple[Body, Body]:
    """Both gears with their shafts: section times face width, plus the journals."""
    spec = assembly.spec
    gears = zip(BODIES, assembly.profiles, (spec.drive, spec.driven), strict=True)
    first, second = (
        gear_on_shaft(name, profile, gear.face_width, gear.material, spec.keys.journal_bearings)
        for name, profile, gear in gears
    )
    center = (0.0, assembly.mesh.center_distance)
    return first, replace(second, center=center, speed_ratio=-assembly.mesh.ratio, role="driven")


def journal_bearings(assembly: Assembly) -> tuple[LumpedJournalBearing, ...]:
    """Journal bearings of both gears."""
    spec = assembly.spec
    bearing, blocks = spec.keys.journal_bearings, spec.keys.bearing_blocks
    seat = 0.0 if blocks is None or blocks.motion == "free" else blocks.radial_clearance
    return tuple(
        replace(
            shaft_bearings(name, bearing, gear.material, spec.bush, seat),
            friction=PUBLISHED if bearing.friction == "published_curve" else None,
        )
        for name, gear in zip(BODIES, (spec.drive, spec.driven), strict=True)
    )


def free_blocks(assembly: Assembly) -> FreeBlocks | None:
    """Bearing blocks that follow their load, one piece of both bearings on each side."""
    keys, tip_radius = assembly.spec.keys, max(tooth.tip_radius for tooth in assembly.teeth)
    blocks, bearing = keys.bearing_blocks, keys.journal_bearings
    if blocks is None or blocks.motion == "seated":
        return None
    material = library_material(blocks.material, "bearing_blocks.material")
    section = abs(signed_area(_figure_eight(assembly))) - 0.5 * np.pi * bearing.diameter**2
    film = LumpedJournalBearing(
        body=BLOCKS,
        count=len(BODIES) * BEARINGS,
        diameter=2.0 * (tip_radius + keys.casing.radial_clearance),
        length=bearing.length,
        radial_clearance=blocks.radial_clearance,
        roughness=blocks.roughness,
        correlation_length=CORRELATION_LENGTH,
        effective_modulus=reduced_modulus(material, material),
        hardness=material.hardness,
        boundary_friction=0.0,
    )
    mass = BEARINGS * section * bearing.length * material.density
    return FreeBlocks(mass, film, blocks.port_area or 0.0)


def outlines(assembly: Assembly) -> dict[str, Array]:
    """Polygons for drawing: gears in their own frame at shaft angle zero, casing and grooves."""
    drive, driven = assembly.profiles
    mesh, contour = assembly.mesh, assembly.spec.casing_contour
    found = {
        # the drive space 0 and the driven tooth 0 lie on the centre line
        "drive_gear": drive.closed_polygon(0.5 * np.pi + mesh.half_pitch),
        "driven_gear": driven.closed_polygon(-0.5 * np.pi + mesh.turn),
        "casing": _figure_eight(assembly) if contour is None else contour,
    }
    found.update(groove_polygons(assembly))
    return found


def groove_polygons(assembly: Assembly) -> dict[str, Array]:
    """Outlines of the relief grooves, named by the port that they join. [m]."""
    grooves = assembly.spec.grooves
    found = {} if grooves is None else grooves.outlines(assembly.mesh.pitch_radii[0])
    return {f"groove_{port}": outline for port, outline in found.items()}


def _figure_eight(assembly: Assembly) -> Array:
    mesh, clearance = assembly.mesh, assembly.spec.keys.casing.radial_clearance
    lower = assembly.teeth[0].tip_radius + clearance
    upper = assembly.teeth[1].tip_radius + clearance
    distance = mesh.center_distance
    low, high = lens_angle(lower, upper, distance), lens_angle(upper, lower, distance)
    below = np.linspace(low, 2.0 * np.pi - low, 180) + 0.5 * np.pi
    above = np.linspace(high, 2.0 * np.pi - high, 180) - 0.5 * np.pi
    center = np.array([0.0, distance])
    return np.vstack([polar(lower, below)[:-1], polar(upper, above)[:-1] + center])
