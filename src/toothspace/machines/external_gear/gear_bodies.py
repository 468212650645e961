"""Bodies, their bearings, their faces with the films beside them."""

from __future__ import annotations

from dataclasses import dataclass, field, replace
from functools import partial
from typing import final

import numpy as np
import shapely

from toothspace.closures.journal_friction import PUBLISHED
from toothspace.core.lazy import Lazy
from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.gearing.flank_contacts import FlankPair, mesh_motions
from toothspace.gearing.gear_face import GearFace, GearSection, tooth_fraction
from toothspace.gearing.materials import library_material, reduced_modulus
from toothspace.gearing.meshing import lens_angle
from toothspace.gearing.numbering import Numbering
from toothspace.gearing.openings import space_outlines
from toothspace.gearing.spaces import Spaces, drive_spaces, driven_spaces
from toothspace.geometry.curve import enclosed, polar, signed_area
from toothspace.geometry.involute import InvoluteGear
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.shared_bearings import (
    BEARINGS,
    CORRELATION_LENGTH,
    gear_on_shaft,
    shaft_bearings,
)
from toothspace.model.description import Body, FreeBlocks, LumpedJournalBearing, LumpedLateralFilm
from toothspace.model.film_faces import (
    NO_BODY,
    ChamberRing,
    FaceBody,
    FaceCells,
    FaceSurfaces,
    FilmFace,
)

BODIES = ("drive_gear", "driven_gear")
BLOCKS = "bearing_blocks"
MOTIONS = mesh_motions(BODIES)
"""Micro-motions; the drive gear's rotation is the shaft angle."""
_FULL_TURN = 2.0 * np.pi
_ON_FLANK = 1e-4
"""Distance up to which the outline of a chamber runs along a flank. [m]"""


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


def lateral_films(assembly: Assembly, numbering: Numbering) -> tuple[LumpedLateralFilm, ...]:
    """Films on the faces of both gears; the height shears like both gaps together."""
    lateral = assembly.spec.keys.lateral
    height = lateral.shear_height

    def face(end: Assembly | None, gear: int) -> Lazy[FilmFace] | None:
        return end and Lazy(partial(film_face, FaceOfGear(end, numbering, gear), height))

    return tuple(
        LumpedLateralFilm(
            body=name,
            faces=2,
            height=height,
            inner_radius=assembly.spec.shaft_radius,
            root_radius=profile.root_radius,
            outer_radius=profile.tip_radius,
            tooth_area_fraction=tooth_fraction(profile),
            tilt=lateral.tilt,
            face=face(assembly, gear),
            lagging_face=face(assembly.at_lagging_end, gear),
        )
        for gear, (name, profile) in enumerate(zip(BODIES, assembly.profiles, strict=True))
    )


def film_face(face: FaceOfGear, gap: float) -> FilmFace:
    """Film face beside a gear, with the gear itself and its mate.

    Parameters
    ----------
    face : FaceOfGear
        What stands against the bearing.
    gap : float
        Film height as designed. [m]
    """
    spec, numbering, mate = face.assembly.spec, face.numbering, 1 - face.gear
    surfaces, block = None, spec.floating_block
    if block is not None:
        own = (spec.drive, spec.driven)[face.gear]
        surfaces = FaceSurfaces(
            moving_roughness=own.roughness,
            resting_roughness=block.keys.roughness,
            effective_modulus=reduced_modulus(own.material, block.material),
            hardness=min(own.material.hardness, block.material.hardness),
        )
    return FilmFace(
        bodies=tuple(
            FaceBody(BODIES[k], face.sections[k].center, face.sections[k].profile.tip_radius)
            for k in (face.gear, mate)
        ),
        center=face.own.center,
        inner_radius=spec.shaft_radius,
        outer_radius=face.own.profile.tip_radius,
        gap=gap,
        face_map=face,
        chambers=face.spaces,
        recesses=np.array(list(dict(face.recesses)), dtype=np.int64),
        inner_node=numbering.drain,
        surfaces=surfaces,
    )


@final
@dataclass(frozen=True, eq=False)
class FaceOfGear:
    """Faces of one gear against the bearings, in the machine frame."""

    assembly: Assembly
    """Gears in mesh."""
    numbering: Numbering
    """Nodes of the tooth spaces."""
    gear: int
    """0 for the drive gear, 1 for the driven gear."""
    sections: tuple[GearSection, GearSection] = field(init=False, repr=False)
    spaces: ChamberRing = field(init=False, repr=False)
    recesses: tuple[tuple[int, Array], ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        mesh, ports = self.assembly.mesh, (self.numbering.inlet, self.numbering.outlet)
        drive, driven = self.assembly.profiles
        sections = (
            GearSection(drive, (0.0, 0.0), 0.5 * np.pi + mesh.half_pitch, 1.0),
            GearSection(driven, (0.0, mesh.center_distance), -0.5 * np.pi + mesh.turn, -mesh.ratio),
        )
        spaces = ChamberRing(
            nodes=self.numbering.nodes[self.gear],
            phases=self.numbering.space_phases[self.gear],
            angle_ratio=self.numbering.ratios[self.gear],
            zero_angle=-0.5 * np.pi if self.gear == 0 else 0.5 * np.pi + mesh.turn,
            direction=1.0 if self.gear == 0 else -1.0,
            center=sections[self.gear].center,
        )
        grooves = groove_polygons(self.assembly).items()
        recesses = tuple((ports[name.endswith("outlet")], outline) for name, outline in grooves)
        object.__setattr__(self, "sections", sections)
        object.__setattr__(self, "spaces", spaces)
        object.__setattr__(self, "recesses", recesses)

    @property
    def own(self) -> GearSection:
        """The gear."""
        return self.sections[self.gear]

    def __call__(self, shaft_angle: float, x: Array, y: Array) -> FaceCells:
        """Nodes and gears at points, the own one first; angles in [rad], places in [m]."""
        node, body = GearFace(self.own, self.spaces, self.recesses)(shaft_angle, x, y)
        mate = self.sections[1 - self.gear].contains(shaft_angle, x, y) & (body == NO_BODY)
        lens = np.flatnonzero((self._in_lens(x, y) & (body == NO_BODY)).ravel())
        if lens.size:
            # chambers between the teeth in mesh, cut where the throats are
            places, within = (x.ravel()[lens], y.ravel()[lens]), node.ravel()[lens]
            for chamber, outline in self._mesh_spaces(shaft_angle):
                (shape,) = enclosed([outline])
                shapely.prepare(shape)
                within[shapely.contains_xy(shape, *places)] = chamber
            node.flat[lens] = within
        return FaceCells(node, np.where(mate, 1, body))

    def own_angle(self, shaft_angle: float, x: Array, y: Array) -> Array:
        """Angle of points in the frame of the own gear, from its first tooth. [rad]."""
        return self.own.polar(x, y)[1] - self.own.tooth_angle(shaft_angle)

    def flank_nodes(self, shaft_angle: float, radius: Array) -> IntArray:
        """Nodes of the chambers along all flanks, shape (spaces, 2, radii).

        For the spaces after each tooth, counter-clockwise in the frame of the own gear, on the left
        flank of the tooth before and the right one of the tooth after.

        Parameters
        ----------
        shaft_angle : float
            Shaft angle. [rad]
        radius : ndarray
            Places on the flanks. [m]
        """
        profile = self.own.profile
        edges = [np.interp(radius, *self.own.flank(side)) for side in (0, 1)]
        teeth = profile.pitch_angle * np.arange(profile.tooth_count)[:, None, None]
        own = teeth + np.stack([edges[0], profile.pitch_angle + edges[1]])
        angle = own + self.own.tooth_angle(shaft_angle)
        x, y = radius * np.cos(angle), radius * np.sin(angle) + self.own.center[1]
        node = self.spaces.nodes[self.spaces.nearest(shaft_angle, x, y)]
        # chambers between the teeth in mesh that touch the flank there
        meshing = self._in_lens(x, y)
        points, touched = shapely.points(x[meshing], y[meshing]), node[meshing]
        closest = np.full(touched.shape, _ON_FLANK)
        for chamber, outline in self._mesh_spaces(shaft_angle):
            away = shapely.distance(shapely.LineString(outline), points)
            touched[away < closest] = chamber
            closest = np.minimum(away, closest)
        node[meshing] = touched
        return node

    def _in_lens(self, x: Array, y: Array) -> BoolArray:
        mate = self.sections[1 - self.gear]
        return np.asarray(mate.polar(x, y)[0] <= mate.profile.tip_radius)

    def _mesh_spaces(self, shaft_angle: float) -> list[tuple[int, Array]]:
        assembly, found = self.assembly, list[tuple[int, Array]]()
        for gear in (0, 1):
            phases, nodes = self.numbering.space_phases[gear], self.numbering.nodes[gear]
            turn = assembly.mesh.turn if gear == 1 else 0.0
            table = phases + self.numbering.ratios[gear] * shaft_angle
            place = np.mod(table, _FULL_TURN) - np.pi - turn
            lens = assembly.mesh.lens_drive if gear == 0 else assembly.mesh.lens_driven
            reach = lens + assembly.profiles[gear].pitch_angle
            near = np.flatnonzero(np.abs(place) < reach)
            make = drive_spaces if gear == 0 else driven_spaces
            spaces: Spaces = make(*assembly.teeth, assembly.mesh, place[near])
            found += zip(nodes[near].tolist(), space_outlines(spaces), strict=True)
        return found
