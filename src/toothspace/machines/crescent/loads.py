"""Bodies, their bearings, their faces and their outlines."""

from __future__ import annotations

import numpy as np

from toothspace.core.types import Array
from toothspace.gearing.gear_face import GearFace, GearSection
from toothspace.gearing.materials import reduced_modulus, solid
from toothspace.gearing.numbering import Numbering
from toothspace.geometry.curve import signed_area
from toothspace.machines.crescent.assembly import CrescentAssembly
from toothspace.machines.crescent.filler import cover_recesses, filler_outline, relief_polygons
from toothspace.model.description import Body, LumpedJournalBearing, LumpedLateralFilm, Motion
from toothspace.model.film_faces import ChamberRing, FaceBody, FilmFace

BODIES = ("pinion", "ring_gear")
MOTIONS = (
    Motion("pinion", "x"),
    Motion("pinion", "y"),
    Motion("ring_gear", "x"),
    Motion("ring_gear", "y"),
    Motion("ring_gear", "rotation"),
)
"""Micro-motions; the pinion's rotation is the shaft angle."""

HOUSING_MATERIAL = "cast_iron"
"""Material of the bore round the ring."""

FACES = 2
_PINION_BEARINGS = 2
_CORRELATION_LENGTH = 10e-6
_CIRCLE = 361


def bodies(assembly: CrescentAssembly) -> tuple[Body, Body]:
    """Pinion with its shaft, and ring."""
    spec, width = assembly.spec, assembly.face_width
    steel = solid(spec.pinion.material, "machine.pinion.material")
    journal = spec.journal_bearings
    radius = 0.5 * journal.diameter
    shaft = steel.density * np.pi * radius**2 * _PINION_BEARINGS * journal.length
    outline = assembly.pinion.closed_polygon()
    pinion = Body(
        name=BODIES[0],
        center=(0.0, 0.0),
        speed_ratio=1.0,
        mass=float(steel.density * width * assembly.pinion.area + shaft),
        inertia=float(steel.density * width * polar_moment(outline) + 0.5 * shaft * radius**2),
        role="shaft",
    )
    metal = solid(spec.ring.material, "machine.ring.material")
    outside = 0.5 * spec.ring.outer_diameter
    area = np.pi * outside**2 - signed_area(assembly.ring_curve)
    polar = 0.5 * np.pi * outside**4 - polar_moment(assembly.ring_curve)
    ring = Body(
        name=BODIES[1],
        center=(0.0, assembly.mesh.center_distance),
        speed_ratio=assembly.ratio,
        mass=float(metal.density * width * area),
        inertia=float(metal.density * width * polar),
        role="driven",
    )
    return pinion, ring


def polar_moment(outline: Array) -> float:
    """Polar second moment of area of a closed outline about its origin. [m4]."""
    p, q = outline, np.roll(outline, -1, axis=0)
    cross = p[:, 0] * q[:, 1] - p[:, 1] * q[:, 0]
    return float(np.sum(cross * np.sum(p * p + p * q + q * q, axis=1)) / 12.0)


def journal_bearings(
    assembly: CrescentAssembly,
) -> tuple[LumpedJournalBearing, LumpedJournalBearing]:
    """Bearings of the pinion's shaft, and the film round the ring."""
    spec = assembly.spec
    journal, ring = spec.journal_bearings, spec.ring
    bush = solid(journal.material, "machine.journal_bearings.material")
    steel = solid(spec.pinion.material, "machine.pinion.material")
    metal, bore = solid(ring.material, "machine.ring.material"), solid(HOUSING_MATERIAL, "")
    return (
        LumpedJournalBearing(
            body=BODIES[0],
            count=_PINION_BEARINGS,
            diameter=journal.diameter,
            length=journal.length,
            radial_clearance=journal.radial_clearance,
            roughness=float(np.hypot(journal.roughness_shaft, journal.roughness_bush)),
            correlation_length=_CORRELATION_LENGTH,
            effective_modulus=reduced_modulus(steel, bush),
            hardness=min(steel.hardness, bush.hardness),
            boundary_friction=journal.boundary_friction,
        ),
        LumpedJournalBearing(
            body=BODIES[1],
            count=1,
            diameter=ring.outer_diameter,
            length=assembly.face_width,
            radial_clearance=ring.radial_clearance,
            roughness=float(np.hypot(ring.roughness, ring.bore_roughness)),
            correlation_length=_CORRELATION_LENGTH,
            effective_modulus=reduced_modulus(metal, bore),
            hardness=min(metal.hardness, bore.hardness),
            boundary_friction=ring.boundary_friction,
        ),
    )


def lateral_films(
    assembly: CrescentAssembly, numbering: Numbering
) -> tuple[LumpedLateralFilm, LumpedLateralFilm]:
    """Films on the faces of both gears; that of the ring drags over its whole section."""
    gap, profile = assembly.spec.lateral.side_gap, assembly.pinion
    ring = 0.5 * np.pi * (profile.tip_radius**4 - profile.root_radius**4)
    outline = profile.closed_polygon()
    teeth = polar_moment(outline) - 0.5 * np.pi * profile.root_radius**4
    outside = 0.5 * assembly.spec.ring.outer_diameter
    section = 0.5 * np.pi * outside**4 - polar_moment(assembly.ring_curve)
    return (
        LumpedLateralFilm(
            body=BODIES[0],
            faces=FACES,
            height=gap,
            inner_radius=0.5 * assembly.spec.journal_bearings.diameter,
            root_radius=profile.root_radius,
            outer_radius=profile.tip_radius,
            tooth_area_fraction=float(teeth / ring),
            face=pinion_face(assembly, numbering),
        ),
        LumpedLateralFilm(
            body=BODIES[1],
            faces=FACES,
            height=gap,
            inner_radius=assembly.tip_radii[1],
            root_radius=assembly.root_radius,
            outer_radius=outside,
            tooth_area_fraction=1.0,
            drag=float(section / gap),
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
    """Polygons for drawing: gears in their own frame at shaft angle zero, filler and recesses.

    The ring is one curve round its outside and back along its teeth.
    """
    turns = np.linspace(0.0, 2.0 * np.pi, _CIRCLE)
    circle = np.column_stack([np.cos(turns), np.sin(turns)])
    outside = 0.5 * assembly.spec.ring.outer_diameter
    teeth = _turned(assembly.ring_curve, assembly.mesh.turn)
    first = int(np.argmin(np.abs(np.arctan2(teeth[:, 1], teeth[:, 0]))))
    inside = np.roll(teeth, -first, axis=0)
    clearance = assembly.spec.ring.radial_clearance
    return {
        BODIES[1]: np.vstack([outside * circle, inside[:1], inside[::-1]]),
        BODIES[0]: assembly.pinion.closed_polygon(0.5 * np.pi + assembly.mesh.half_pitch),
        "filler": filler_outline(assembly),
        "casing": (outside + clearance) * circle[:-1] + assembly.ring_center,
        **{f"port_{name}": outline for name, outline in cover_recesses(assembly).items()},
        **{f"groove_{name}": outline for name, outline in relief_polygons(assembly).items()},
    }


def _turned(points: Array, angle: float) -> Array:
    c, s = np.cos(angle), np.sin(angle)
    return np.asarray(points @ np.array([[c, s], [-s, c]]), dtype=float)
