"""Elastic bodies of an external gear machine: gears, bearing blocks and plates.

Gears stand in their own frame (centre of the gear, first tooth on the x axis, z = 0 in the
middle of the face width), bearings and plates in the machine frame with z = 0 on their film face.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import Literal, final

import numpy as np
import shapely
import shapely.affinity

from toothspace.core.types import Array
from toothspace.elasticity.body import ElasticBody, Support, SweptShape
from toothspace.elasticity.mesh import Prism, disc
from toothspace.elasticity.surface_loads import (
    AreaPressure,
    AxialTraction,
    LateralFaces,
    LateralPressure,
    Load,
    journal_load,
)
from toothspace.elasticity.surfaces import PlaneSurface
from toothspace.gearing.materials import Material
from toothspace.gearing.meshing import loaded_throats
from toothspace.gearing.numbering import FULL_TURN
from toothspace.gearing.spaces import drive_spaces
from toothspace.geometry.gear_profile import GearProfile
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.gear_bodies import BODIES, FaceOfGear, groove_polygons
from toothspace.model.floating_bearing import BodyLoad

_PATTERNS = 3
_MIDDLE = 1
_SAMPLES = 24
"""Places along a flank at which the chamber is looked up. [-]"""
_SIDES = ("left", "right")
"""Flanks of a space: the left one of the tooth before it, the right one of the tooth after it."""
_NAMES = ("drive", "driven")
_SPRING_RADIUS = 0.05
"""Radius of the patch that carries a spring over the tip radius. [-]"""
_OUTSIDE = 0.9
"""Radius from which a face counts as the outside of a bearing over the tip radius. [-]"""
_INSIDE = 1.0 - 1e-6


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
    if thrust(assembly, gear) != 0.0 or assembly.spec.helix is not None:
        for k in range(profile.tooth_count):
            flank = _flank(assembly, gear, k, 0 if assembly.loaded_is_left else 1)
            loads.append(AxialTraction(f"thrust_{k}", flank))
    return loads


def thrust(assembly: Assembly, gear: int) -> float:
    """Axial force on a gear, along z, that is given. [N]."""
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
        return found + self._contacts(shaft_angle)

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
            if assembly.spec.helix is not None:
                found.append(BodyLoad(body, f"thrust_{space}", "thrust", contact))
        return found


BearingSide = Literal["floating", "solid"]


@final
@dataclass(frozen=True)
class MeshSize:
    """Fineness of an elastic body, over the tip radius of the drive gear."""

    edge_length: float = 0.085
    """Edge of the plane triangles; quadrilaterals are about 0.4 of it. [-]"""
    layer_height: float = 0.08
    """Largest height of a layer. [-]"""
    node_spacing: float = 0.085
    """Distance of the nodes of the film surface. [-]"""


@final
@dataclass(frozen=True, eq=False)
class BackLoads:
    """What presses on the back of a bearing or plate."""

    areas: Mapping[str, shapely.Geometry] = field(default_factory=dict)
    """Regions of the back face in the machine frame, by the name of their pressure. Polygons by
    name. [m]
    """
    points: Mapping[str, tuple[float, float]] = field(default_factory=dict)
    """Places x, y of springs by name; one over a bore rests on its rim. [m]"""
    lines: Mapping[str, shapely.Geometry] = field(default_factory=dict)
    """Lines on which seals press, by name; the load is one newton in all. Line strings by name. [m]
    """
    patches: Mapping[str, shapely.Geometry] = field(default_factory=dict)
    """Regions that carry one newton in all, by name. Polygons by name. [m]"""


def gear_body(assembly: Assembly, gear: int, size: MeshSize | None = None) -> ElasticBody:
    """Gear with its shaft stubs, floating.

    Films ``floating`` (z > 0) and ``solid``; loads of
    :func:`~toothspace.machines.external_gear.floating.elastic_bodies.flank_loads` and
    ``journal_floating_x``... (force of a journal film).

    Parameters
    ----------
    gear : int
        0 for the drive gear, 1 for the driven gear.
    """
    size = size or MeshSize()
    spec, profile = assembly.spec, assembly.profiles[gear]
    own = (spec.drive, spec.driven)[gear]
    unit, half = assembly.profiles[0].tip_radius, 0.5 * own.face_width
    radius, reach = spec.shaft_radius, half + spec.keys.journal_bearings.length
    section = shapely.Polygon(profile.closed_polygon())
    face = section.difference(disc(radius))
    parts = (Prism(section, -half, half), Prism(disc(radius), -reach, reach))
    loads: list[Load] = [*flank_loads(assembly, gear)]
    for side, levels in (("floating", (half, reach)), ("solid", (-reach, -half))):
        loads += [
            journal_load(f"journal_{side}_{axis}", radius, levels, angle)
            for axis, angle in (("x", 0.0), ("y", 0.5 * np.pi))
        ]
    return ElasticBody(
        shape=SweptShape(parts, size.edge_length * unit, size.layer_height * unit),
        elastic_modulus=own.material.elastic_modulus,
        poisson_ratio=own.material.poisson_ratio,
        density=own.material.density,
        films=(
            PlaneSurface("floating", "top", face, size.node_spacing * unit, half),
            PlaneSurface("solid", "bottom", face, size.node_spacing * unit, -half),
        ),
        loads=tuple(loads),
    )


def bearing_section(assembly: Assembly, half: int | None = None) -> shapely.Polygon:
    """Section of a bearing block or plate: both tip circles less the shaft bores. [m].

    With the number of a gear that of the half beside it.
    """
    centers = _centers(assembly)
    tips = [profile.tip_radius for profile in assembly.profiles]
    outline = shapely.union_all([disc(r, c) for r, c in zip(tips, centers, strict=True)])
    bore = assembly.spec.shaft_radius
    whole = shapely.difference(outline, shapely.union_all([disc(bore, c) for c in centers]))
    return whole if half is None else shapely.intersection(whole, beside_cut(assembly, half))


def beside_cut(assembly: Assembly, gear: int) -> shapely.Polygon:
    """Side of a gear of the line that cuts a split bearing, as a box round the machine. [m]."""
    cut, reach = waist(assembly, 0), 10.0 * max(p.tip_radius for p in assembly.profiles)
    low, high = (cut - reach, cut) if gear == 0 else (cut, cut + reach)
    return shapely.box(-reach, low, reach, high)


def _centers(assembly: Assembly) -> tuple[tuple[float, float], tuple[float, float]]:
    return (0.0, 0.0), (0.0, assembly.mesh.center_distance)


def bearing_body(
    assembly: Assembly,
    material: Material,
    length: float,
    side: BearingSide = "floating",
    back: BackLoads | None = None,
    size: MeshSize | None = None,
    half: int | None = None,
) -> ElasticBody:
    """Bearing block, bushing pair in one piece, pressure plate, or a half of one of them.

    Film ``face``; loads of the back by their names; ``journal_drive_x``, ``journal_driven_y`` and
    so on for the forces of the journal films on bodies longer than half a bearing, and
    ``wall_drive_x``... for those of the housing that hold against them.

    Parameters
    ----------
    length : float
        Axial length. [m]
    side : {"floating", "solid"}
        A floating body is free and stands above the gears (z from 0 up); a solid bearing stands
        below and rests with its back on the cover.
    back : BackLoads, optional
        Pressure regions, springs and seals of the back face.
    half : int, optional
        Gear beside the half of a split bearing; the whole bearing if not given.
    """
    size, back = size or MeshSize(), back or BackLoads()
    unit, section = assembly.profiles[0].tip_radius, bearing_section(assembly, half)
    up = 1.0 if side == "floating" else -1.0
    radius = _SPRING_RADIUS * unit
    back_side: Literal["top", "bottom"] = "top" if up > 0.0 else "bottom"
    loads: list[Load] = [AreaPressure(name, back_side, area) for name, area in back.areas.items()]
    room = section.buffer(-radius)
    for name, place in back.points.items():
        # a spring over a bore rests on its rim
        way = shapely.shortest_line(room, shapely.Point(*place))
        patch = shapely.line_interpolate_point(way, 0.0).buffer(radius)
        loads.append(AreaPressure(name, back_side, patch, per_area=False))
    for name, line in back.lines.items():
        band = shapely.buffer(line, 0.5 * radius, cap_style="flat")
        loads.append(AreaPressure(name, back_side, band, per_area=False))
    for name, region in back.patches.items():
        loads.append(AreaPressure(name, back_side, region, per_area=False))
    film_side: Literal["top", "bottom"] = "bottom" if up > 0.0 else "top"
    if carries_journals(assembly, length):
        gears = (0, 1) if half is None else (half,)
        loads += radial_loads(assembly, sorted((0.0, up * length)), gears)
    height = up * length
    grooves = assembly.spec.grooves
    parts: tuple[Prism, ...] = (Prism(section, *sorted((0.0, height))),)
    if grooves is not None and grooves.depth < abs(height):
        # section less grooves before, whole section behind them
        cut = [shapely.Polygon(p) for p in groove_polygons(assembly).values()]
        floor = np.copysign(grooves.depth, height)
        face = section.difference(shapely.union_all(cut))
        parts = (Prism(face, *sorted((0.0, floor))), Prism(section, *sorted((floor, height))))
    return ElasticBody(
        shape=SweptShape(parts, size.edge_length * unit, size.layer_height * unit),
        elastic_modulus=material.elastic_modulus,
        poisson_ratio=material.poisson_ratio,
        density=material.density,
        films=(PlaneSurface("face", film_side, section, size.node_spacing * unit, 0.0),),
        loads=tuple(loads),
        supports=() if side == "floating" else (Support("bottom", section),),
    )


def carries_journals(assembly: Assembly, length: float) -> bool:
    """Whether a body of some length [m] holds the journal bearings: a block, not a plate."""
    return length > 0.5 * assembly.spec.keys.journal_bearings.length


def radial_loads(
    assembly: Assembly, levels: list[float], gears: tuple[int, ...] = (0, 1)
) -> list[Load]:
    """Forces of journals on the bores and of the housing outside between levels [m], each 1 [N]."""
    radius, ends = assembly.spec.shaft_radius, (levels[0], levels[1])
    loads: list[Load] = []
    for gear in gears:
        name, center = _NAMES[gear], _centers(assembly)[gear]
        for axis, angle in (("x", 0.0), ("y", 0.5 * np.pi)):
            label = f"{name}_{axis}"
            loads += [
                journal_load(f"journal_{label}", radius, ends, angle, center=center),
                _wall(assembly, gear, f"wall_{label}", ends),
            ]
    return loads


def wall_direction(assembly: Assembly, axis: str, gear: int) -> float:
    """Sign of the side along an axis on which the housing holds a bearing. [-]."""
    if axis == "y":
        return -1.0 if gear == 0 else 1.0
    return -1.0 if assembly.spec.keys.mode == "pump" else 1.0


def _wall(assembly: Assembly, gear: int, name: str, levels: tuple[float, float]) -> LateralPressure:
    """One newton away from the housing, as an even pressure on the outer face beside a gear.

    Both sides of the arc are alike, so that nothing pushes across.
    """
    axis = name[-1]
    radius = assembly.profiles[gear].tip_radius
    x, y = _centers(assembly)[gear]
    sign = wall_direction(assembly, axis, gear)
    # the face of a cut is no part of the outer face
    half = radius if axis == "y" else _INSIDE * waist(assembly, gear)
    reach = sign * 4.0 * radius
    low, high = sorted((0.0, reach))
    wide = (
        shapely.box(low, -half, high, half) if axis == "x" else shapely.box(-half, low, half, high)
    )
    beside = shapely.affinity.translate(wide, x, y)
    outer = LateralFaces(beside.difference(disc(_OUTSIDE * radius, (x, y))), *levels)
    pressure = 1.0 / (2.0 * half * (levels[1] - levels[0]))
    label = repr(("wall", pressure))
    return LateralPressure(name, outer, lambda place: np.full(len(place), pressure), label)


def waist(assembly: Assembly, gear: int) -> float:
    """Distance of the line through both intersections of the tip circles from an axis. [m]."""
    a = assembly.mesh.center_distance
    own, other = (assembly.profiles[k].tip_radius for k in (gear, 1 - gear))
    return float((a**2 + own**2 - other**2) / (2.0 * a))
