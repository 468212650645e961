"""Bodies, their bearings, their faces and their outlines."""

from __future__ import annotations

from functools import partial

import numpy as np

from toothspace.core.lazy import Lazy
from toothspace.core.types import Array
from toothspace.gearing.flank_contacts import FlankPair, mesh_motions
from toothspace.gearing.gear_face import GearFace, GearSection, tooth_fraction
from toothspace.gearing.materials import library_material
from toothspace.gearing.numbering import Numbering
from toothspace.gearing.space_paths import FACES
from toothspace.geometry.curve import (
    closed_length,
    outline_with_hole,
    polar,
    polar_moment,
    signed_area,
    turned,
)
from toothspace.machines.crescent.assembly import (
    CrescentAssembly,
    cover_recesses,
    filler_outline,
    relief_polygons,
)
from toothspace.machines.shared_bearings import gear_on_shaft, ring_bearing, shaft_bearings
from toothspace.model.description import Body, LumpedJournalBearing, LumpedLateralFilm
from toothspace.model.film_faces import ChamberRing, FaceBody, FilmFace

BODIES = ("pinion", "ring_gear")
MOTIONS = mesh_motions(BODIES)
"""Micro-motions; the pinion's rotation is the shaft angle."""

_CIRCLE = 361


def flank_pair(assembly: CrescentAssembly) -> FlankPair:
    """What touches at the flanks."""
    pinion, ring = assembly.spec.pinion, assembly.spec.ring
    return FlankPair(
        bodies=BODIES,
        materials=assembly.materials,
        roughness=(pinion.roughness, ring.roughness),
        profile_shifts=(pinion.profile_shift, 0.0),
    )


def bodies(assembly: CrescentAssembly) -> tuple[Body, Body]:
    """Pinion with its shaft, and ring."""
    spec, width, (steel, metal) = assembly.spec, assembly.face_width, assembly.materials
    pinion = gear_on_shaft(BODIES[0], assembly.pinion, width, steel, spec.journal_bearings)
    outside = 0.5 * spec.ring.outer_diameter
    area = np.pi * outside**2 - signed_area(assembly.ring_curve)
    ring = Body(
        name=BODIES[1],
        center=(0.0, assembly.mesh.center_distance),
        speed_ratio=assembly.ratio,
        mass=float(metal.density * width * area),
        inertia=float(metal.density * width * _ring_moment(assembly)),
        role="driven",
        wetted_area=width * closed_length(assembly.ring_curve),
    )
    return pinion, ring


def _ring_moment(assembly: CrescentAssembly) -> float:
    """Polar second moment of area of the ring's section. [m4]."""
    outside = 0.5 * assembly.spec.ring.outer_diameter
    return 0.5 * np.pi * outside**4 - polar_moment(assembly.ring_curve)


def journal_bearings(assembly: CrescentAssembly) -> tuple[LumpedJournalBearing, ...]:
    """Bearings of the pinion's shaft, and the film round the ring."""
    journal, ring, (steel, metal) = (
        assembly.spec.journal_bearings, assembly.spec.ring, assembly.materials,
    )  # fmt: skip
    bush = library_material(journal.material, "machine.journal_bearings.material")
    size = ring.outer_diameter, assembly.face_width, ring.radial_clearance
    roughness = ring.roughness, ring.bore_roughness
    return (
        shaft_bearings(BODIES[0], journal, steel, bush),
        ring_bearing(BODIES[1], size, roughness, metal, ring.boundary_friction),
    )


def lateral_films(
    assembly: CrescentAssembly, numbering: Numbering
) -> tuple[LumpedLateralFilm, LumpedLateralFilm]:
    """Films on the faces of both gears; that of the ring drags over its whole section."""
    gap, profile = assembly.spec.lateral.side_gap, assembly.pinion
    return (
        LumpedLateralFilm(
            body=BODIES[0],
            faces=FACES,
            height=gap,
            inner_radius=0.5 * assembly.spec.journal_bearings.diameter,
            root_radius=profile.root_radius,
            outer_radius=profile.tip_radius,
            tooth_area_fraction=tooth_fraction(profile),
            face=Lazy(partial(pinion_face, assembly, numbering)),
        ),
        LumpedLateralFilm(
            body=BODIES[1],
            faces=FACES,
            height=gap,
            inner_radius=assembly.tip_radii[1],
            root_radius=assembly.root_radius,
            outer_radius=0.5 * assembly.spec.ring.outer_diameter,
            tooth_area_fraction=1.0,
            drag=_ring_moment(assembly) / gap,
        ),
    )


def pinion_face(assembly: CrescentAssembly, numbering: Numbering) -> FilmFace:
    """Film face beside the pinion, with the recesses of the covers."""
    ports = {"inlet": numbering.inlet, "outlet": numbering.outlet}
    outlines = [*cover_recesses(assembly).items(), *relief_polygons(assembly).items()]
    recesses = tuple((ports[port], outline) for port, outline in outlines)
    section = GearSection(assembly.pinion, (0.0, 0.0), 0.5 * np.pi + assembly.mesh.half_pitch, 1.0)
    spaces = ChamberRing(numbering.nodes[0], numbering.space_phases[0], zero_angle=-0.5 * np.pi)
    return FilmFace(
        bodies=(FaceBody(BODIES[0], section.center, assembly.pinion.tip_radius),),
        center=section.center,
        inner_radius=0.5 * assembly.spec.journal_bearings.diameter,
        outer_radius=assembly.pinion.tip_radius,
        gap=assembly.spec.lateral.side_gap,
        face_map=GearFace(section, spaces, recesses),
        chambers=spaces,
        recesses=np.array(list(dict(recesses)), dtype=np.int64),
        inner_node=numbering.drain,
    )


def outlines(assembly: CrescentAssembly) -> dict[str, Array]:
    """Polygons for drawing: gears in their own frame at shaft angle zero, filler and recesses."""
    circle = polar(1.0, np.linspace(0.0, 2.0 * np.pi, _CIRCLE)[:-1])
    outside = 0.5 * assembly.spec.ring.outer_diameter
    teeth = turned(assembly.ring_curve, assembly.mesh.turn)
    clearance = assembly.spec.ring.radial_clearance
    return {
        BODIES[1]: outline_with_hole(outside * circle, teeth),
        BODIES[0]: assembly.pinion.closed_polygon(0.5 * np.pi + assembly.mesh.half_pitch),
        "filler": filler_outline(assembly),
        "casing": (outside + clearance) * circle + assembly.ring_center,
        **{f"port_{name}": outline for name, outline in cover_recesses(assembly).items()},
        **{f"groove_{name}": outline for name, outline in relief_polygons(assembly).items()},
    }
