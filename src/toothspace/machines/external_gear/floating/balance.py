"""Axial force balance: areas of the floating bearing and the films beside the gears."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from typing import Any, NamedTuple, cast, final

import numpy as np
import shapely
import shapely.affinity

from toothspace.core.errors import GeometryError
from toothspace.elasticity.body import ElasticBody
from toothspace.elasticity.mesh import SolidFile
from toothspace.gearing.numbering import Numbering
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.floating.elastic_bodies import (
    BackLoads,
    BearingSide,
    GearFlanks,
    MeshSize,
    bearing_body,
    bearing_section,
    beside_cut,
    carries_journals,
    gear_body,
    waist,
    wall_direction,
)
from toothspace.machines.external_gear.gear_bodies import BODIES, FaceOfGear, bodies, film_face
from toothspace.machines.external_gear.spec import FloatingBlock
from toothspace.model.floating_bearing import (
    AxialForce,
    BodyLoad,
    FilmInterface,
    FloatingBearing,
    HousingContact,
    LateralBalance,
    LoadSource,
    Patch,
    Side,
)

_HALVINGS = 40
_SHARED = 0.01
"""Part of a nose that may lie in the high-pressure area, as drawn outlines overlap a little. [-]"""
_SIDES: tuple[Side, ...] = ("floating", "solid")
COARSE = MeshSize(0.16, 0.16, 0.13)
"""A few thousand elements for each body."""
_KEYS = dict(zip((*_SIDES, *BODIES), ("floating_bearing", "solid_bearing", *BODIES), strict=True))
_AXES: tuple[tuple[str, LoadSource], ...] = (("x", "journal_x"), ("y", "journal_y"))
_ON_THE_CUT = 1e-6
"""Distance up to which a spring stands on the cut of a split bearing. [m]"""
_ON_OUTLINE = 1e-5
"""Distance up to which an edge of the high-pressure area is the outline of the face. [m]"""
_EDGE = 0.1
"""Edge of the tetrahedra of bodies from files over the tip radius, if not given. [-]"""
_SHARE = 0.5
"""Each of both bearings carries this share of the journal force on a gear. [-]"""


def lateral_balance(
    assembly: Assembly, numbering: Numbering, *, parted: bool = False
) -> LateralBalance:
    """Films beside the gears and the floating bearing.

    Raises GeometryError if high-pressure area and nose are larger than the back face.

    Parameters
    ----------
    parted : bool
        Whether tooth spaces are more than one chamber along a helix, so that each end has
        pressures of its own.
    """
    block = assembly.spec.floating_block
    assert block is not None
    spec, keys = assembly.spec, assembly.spec.keys
    (above, below), (drive, driven) = assembly.mesh.pitch_radii, block.keys.gear_axial_force
    face, journals = bearing_face(assembly), keys.journal_bearings
    high = _high_pressure(assembly, block, face)
    if high is None:
        high = _behind_a_chord(face, block.high_pressure)
    gears, lagging = _gears(assembly, numbering), assembly.at_lagging_end
    # equal faces are one object, whose masks serve both sides
    leads = (0.0, 0.0) if spec.helix is None else spec.helix.leads
    sides = [gears if lagging is None or x > 0.0 else _gears(lagging, numbering) for x in leads]
    ports = {"inlet": numbering.inlet, "outlet": numbering.outlet, "external": numbering.drain}
    return LateralBalance(
        arrangement=cast(Any, block.arrangement),
        motion=cast(Any, block.keys.motion),
        interfaces=tuple(
            _interface(assembly, face, side, (k + 1) * (numbering.drain + 1) if parted else 0)
            for k, side in enumerate(_SIDES)
            for face in sides[k]
        ),
        floating=_floating(assembly, block),
        high_node=ports["outlet" if keys.mode == "pump" else "inlet"],
        low_node=ports[keys.drain_node],
        # helical teeth push at the pitch point, where contacts stand in the mean
        body_forces=(AxialForce(drive, (0.0, above)), AxialForce(driven, (0.0, -below))),
        body_masses=tuple(body.mass for body in bodies(assembly)),
        elastic_bodies=ElasticAssembly(assembly, high, gears),
        halves=_halves(assembly, block) if block.keys.split else (),
        # at which a shaft meets the far ends of both journal bearings
        body_tilts=tuple(
            journals.radial_clearance / (0.5 * gear.face_width + journals.length)
            for gear in (spec.drive, spec.driven)
        ),
        shaft_stiffness=block.keys.shaft_stiffness,
    )


def _gears(assembly: Assembly, numbering: Numbering) -> tuple[FaceOfGear, FaceOfGear]:
    """Faces of both gears."""
    return FaceOfGear(assembly, numbering, 0), FaceOfGear(assembly, numbering, 1)


def _behind_a_chord(face: Any, patch: Patch) -> Any:
    """Part of a face of the area of a patch behind a chord across the way to its centre. [m]."""
    middle = np.array([face.centroid.x, face.centroid.y])
    away = np.array(patch.center) - middle
    turn = np.arctan2(away[1], away[0])
    reach = float(np.hypot(*np.ptp(np.reshape(face.bounds, (2, 2)), axis=0)))

    def part(distance: float) -> Any:
        half = shapely.box(distance, -reach, reach, reach)
        turned = shapely.affinity.rotate(half, turn, origin=(0.0, 0.0), use_radians=True)
        return shapely.intersection(face, shapely.affinity.translate(turned, *middle))

    low, high = -reach, reach
    for _ in range(_HALVINGS):
        place = 0.5 * (low + high)
        low, high = (place, high) if part(place).area > patch.area else (low, place)
    return part(high)


def _interface(assembly: Assembly, face: FaceOfGear, side: Side, first_node: int) -> FilmInterface:
    spec, block, gear = assembly.spec, assembly.spec.floating_block, face.gear
    assert block is not None
    own = (spec.drive, spec.driven)[gear]
    column = block.length / block.material.elastic_modulus
    parts = half_names(block, side)
    gap = spec.keys.lateral.side_gaps[_SIDES.index(side)]
    column += 0.5 * own.face_width / own.material.elastic_modulus
    return FilmInterface(
        name=f"{side}_{BODIES[gear]}",
        body=BODIES[gear],
        side=side,
        face=film_face(face, gap),
        speed_ratio=face.own.speed_ratio,
        winkler_compliance=column,
        body_angle=face.own.first_tooth,
        root_radius=assembly.profiles[gear].root_radius,
        lead=0.0 if spec.helix is None else spec.helix.leads[_SIDES.index(side)],
        first_node=first_node,
        part=parts[gear] if parts else "",
    )


def bearing_face(assembly: Assembly) -> shapely.Polygon:
    """Face of a bearing block: both tip circles less the shaft bores. [m]."""
    bore = assembly.spec.shaft_radius
    centers = [shapely.Point(0.0, 0.0), shapely.Point(0.0, assembly.mesh.center_distance)]
    tips = [profile.tip_radius for profile in assembly.profiles]
    outline = shapely.union_all(
        [c.buffer(r, quad_segs=256) for c, r in zip(centers, tips, strict=True)]
    )
    return shapely.difference(
        outline, shapely.union_all([c.buffer(bore, quad_segs=256) for c in centers])
    )


def _patch(shape: Any) -> Patch:
    return Patch(float(shape.area), (float(shape.centroid.x), float(shape.centroid.y)))


def _floating(assembly: Assembly, block: FloatingBlock) -> FloatingBearing:
    face = bearing_face(assembly)
    shape = _high_pressure(assembly, block, face)
    high, nose = block.high_pressure if shape is None else _patch(shape), block.nose
    if high.area + nose.area > face.area:
        raise GeometryError(
            "machine.floating_bearing.high_pressure_area",
            f"{high.area * 1e6:.5g} mm^2 with a nose of {nose.area * 1e6:.5g} mm^2",
            f"together the back face {face.area * 1e6:.5g} mm^2",
        )
    _check_places(block, face, shape)
    middle = (float(face.centroid.x), float(face.centroid.y))
    loads = [(s.force, s.x, s.y) for s in block.keys.springs]
    loads += [(block.keys.seal_preload, *middle)] if block.keys.seal_preload > 0.0 else []
    mass = block.keys.mass or face.area * block.length * block.material.density
    if block.keys.wall_stiffness is not None:
        held = block.keys.wall_stiffness
    else:
        left, _, right, _ = face.bounds
        area, layer = block.keys.housing.area, 0.5 * float(right - left)
        held = block.material.elastic_modulus * area * block.length**2 / (12.0 * layer)
    return FloatingBearing(
        mass=float(mass),
        face=_patch(face),
        high_pressure=high,
        nose=nose,
        preload=_resultant(loads),
        housing=_housing(block, 1.0),
        gauge_point=(0.0, -assembly.profiles[0].tip_radius),
        axial_play=block.keys.axial_play,
        wall_stiffness=held,
    )


def _check_places(block: FloatingBlock, face: Any, high: Any | None) -> None:
    """Refuse loads beside the bearing, and a nose in the high-pressure area."""
    outline = shapely.convex_hull(face)
    low_x, low_y, high_x, high_y = (1e3 * float(bound) for bound in face.bounds)
    inside = f"within the bearing, x {low_x:.4g} to {high_x:.4g} mm, y {low_y:.4g} to {high_y:.4g}"
    places = [(f"springs[{k}]", (s.x, s.y)) for k, s in enumerate(block.keys.springs)]
    if block.nose.area > 0.0:
        places.append(("nose.center", block.nose.center))
    if high is None:
        places.append(("high_pressure_area.center", block.high_pressure.center))
    for key, (x, y) in places:
        if not shapely.covers(outline, shapely.Point(x, y)):
            raise GeometryError(
                f"machine.floating_bearing.{key}",
                f"x {x * 1e3:.5g} mm, y {y * 1e3:.5g} mm",
                f"{inside} mm",
            )
    if block.nose.area <= 0.0 or high is None:
        return
    # by the outline of the nose, or by the centre of a square
    nose = shapely.Point(*block.nose.center)
    found, key = f"x {nose.x * 1e3:.5g} mm, y {nose.y * 1e3:.5g} mm", "center"
    shut_in = bool(shapely.covers(high, nose))
    if block.nose_contour is not None:
        shared = float(shapely.intersection(high, nose_outline(block)).area)
        found, key = f"{shared * 1e6:.5g} mm^2", "contour"
        shut_in = shared > _SHARED * block.nose.area
    if shut_in:
        raise GeometryError(
            f"machine.floating_bearing.nose.{key}",
            f"{found} in the high-pressure area",
            "beside it",
        )


def _housing(block: FloatingBlock, share: float) -> HousingContact:
    given = block.keys.housing
    return replace(given, area=share * given.area)


def _resultant(loads: Sequence[tuple[float, float, float]]) -> AxialForce:
    """Sum of forces [N] at places [m]."""
    total = sum(load[0] for load in loads)
    share = 1.0 / total if total > 0.0 else 0.0
    x, y = (share * sum(load[0] * load[k] for load in loads) for k in (1, 2))
    return AxialForce(float(total), (float(x), float(y)))


def _halves(assembly: Assembly, block: FloatingBlock) -> tuple[FloatingBearing, FloatingBearing]:
    """Bearing cut along the line through both intersections of the tip circles."""
    whole, face = _floating(assembly, block), bearing_face(assembly)
    high = _high_pressure(assembly, block, face)
    if high is None:
        raise GeometryError(
            "machine.floating_bearing.split",
            "a high_pressure_area without outline",
            "with seal_line_x or contour",
        )
    tips = [profile.tip_radius for profile in assembly.profiles]
    parts = (beside_cut(assembly, 0), beside_cut(assembly, 1))
    outline = nose_outline(block)
    gauges = ((0.0, -tips[0]), (0.0, assembly.mesh.center_distance + tips[1]))
    made = []
    for k, (part, gauge) in enumerate(zip(parts, gauges, strict=True)):
        own = shapely.intersection(face, part)
        share, nose = float(own.area / face.area), shapely.intersection(outline, part)
        loads = [(s.force * spring_share(assembly, s.y, k), s.x, s.y) for s in block.keys.springs]
        loads.append((share * block.keys.seal_preload, own.centroid.x, own.centroid.y))
        half = replace(
            whole,
            mass=share * whole.mass,
            face=_patch(own),
            high_pressure=_patch(shapely.intersection(high, part)),
            nose=_patch(nose) if nose.area > 0.0 else Patch(0.0, (0.0, 0.0)),
            preload=_resultant(loads),
            housing=_housing(block, share),
            gauge_point=gauge,
            wall_stiffness=share * whole.wall_stiffness,
        )
        made.append(half)
    return made[0], made[1]


def _high_pressure(assembly: Assembly, block: FloatingBlock, face: Any) -> Any | None:
    """Outline of the back face at high pressure, None if only its area is known."""
    if block.high_pressure_contour is not None:
        part = shapely.intersection(shapely.Polygon(block.high_pressure_contour), face)
        if part.area <= 0.0:
            raise GeometryError(
                "machine.floating_bearing.high_pressure_area.contour",
                "an area beside the bearing",
                "on its back face",
            )
        return part
    given = block.keys.high_pressure_area
    near = None if given is None else given.seal_line_x
    if near is None:
        return None
    low_x, low_y, high_x, high_y = face.bounds
    if assembly.spec.keys.mode == "pump":
        half = shapely.box(min(near, high_x), low_y, high_x, high_y)
    else:
        half = shapely.box(low_x, low_y, max(-near, low_x), high_y)
    part = shapely.intersection(face, half)
    if part.area <= 0.0:
        limit = float(np.round(high_x * 1e3, 3))
        raise GeometryError(
            "machine.floating_bearing.high_pressure_area.seal_line_x",
            f"{near * 1e3:.5g} mm",
            f"below {limit} mm",
        )
    return part


class _BlockPart(NamedTuple):
    # bearing or half: name of its body, side, gear beside a half, share of the whole face
    name: str
    side: BearingSide
    half: int | None
    share: float


@final
@dataclass(frozen=True)
class ElasticAssembly:
    """Bearings and gears of a machine with a floating bearing."""

    assembly: Assembly
    """Gears in mesh."""
    high_pressure: shapely.Geometry
    """Part of the back face at high pressure. [m]"""
    faces: tuple[FaceOfGear, FaceOfGear]
    """Chambers round both gears."""
    size: MeshSize = COARSE
    """Fineness of all bodies."""

    def __call__(self) -> Mapping[str, ElasticBody]:
        """Bearings ``floating`` and ``solid`` or their halves, and the gears by name.

        Raises GeometryError if a body has a shape that cannot be swept, or a half of a bearing a
        file.
        """
        made = {}
        for p in self._parts():
            own, moves = self._block, self._block.is_floating(p.side)
            back = None
            if moves:
                # high-pressure area with its seal, nose and springs
                high = self._on(p, self.high_pressure)
                nose = self._on(p, nose_outline(own))
                areas = {"high": high} if high.area > 0.0 else {}
                lines = {}
                if own.keys.seal_preload > 0.0:
                    lines["seal"] = seal_line(high, bearing_section(self.assembly, p.half))
                points = {
                    f"spring_{k}": (own.keys.springs[k].x, own.keys.springs[k].y)
                    for k in self._springs_on(p)
                }
                patches = {"nose": nose.difference(self.high_pressure)} if nose.area > 0.0 else {}
                back = BackLoads(areas=areas, points=points, lines=lines, patches=patches)
            body = bearing_body(
                self.assembly, own.material, own.length, p.side, back, self.size, p.half
            )
            made[p.name] = self._from_file(
                p.side, replace(body, supports=()) if moves else body, p.half
            )
        made = made
        for k, name in enumerate(BODIES):
            made[name] = self._from_file(name, gear_body(self.assembly, k, self.size))
        return made

    def loads(self, shaft_angle: float) -> tuple[BodyLoad, ...]:
        """Loads at a shaft angle [rad]: pressures, springs, seal, contacts, journals. [SI]."""
        flanks = [load for f in self.faces for load in GearFlanks(f).acting(shaft_angle)]
        return (*self._steady, *flanks)

    @cached_property
    def _steady(self) -> tuple[BodyLoad, ...]:
        """Loads that follow the same at all shaft angles."""
        found = [load for part in self._parts() for load in self._bearing_loads(part)]
        for gear, name in enumerate(BODIES):
            for side in _SIDES:
                label = f"journal_{side}"
                found.append(BodyLoad(name, f"{label}_x", "journal_x", gear, -_SHARE))
                found.append(BodyLoad(name, f"{label}_y", "journal_y", gear, -_SHARE))
        return tuple(found)

    @property
    def _block(self) -> FloatingBlock:
        block = self.assembly.spec.floating_block
        assert block is not None
        return block

    def _parts(self) -> list[_BlockPart]:
        """Both bearings, halves of the split ones."""
        area = bearing_section(self.assembly).area
        found = []
        for side in _SIDES:
            parts = half_names(self._block, side)
            if not parts:
                found.append(_BlockPart(side, side, None, 1.0))
            for k, name in enumerate(parts):
                own = bearing_section(self.assembly, k).area
                found.append(_BlockPart(name, side, k, float(own / area)))
        return found

    def _on(self, part: _BlockPart, shape: shapely.Geometry) -> shapely.Geometry:
        """Part of a shape that is on a bearing or half."""
        if part.half is None:
            return shape
        return shapely.intersection(shape, beside_cut(self.assembly, part.half))

    def _springs_on(self, part: _BlockPart) -> dict[int, float]:
        """Springs on a bearing or half by number, with the share of them that it carries."""
        shares = {
            k: 1.0 if part.half is None else spring_share(self.assembly, spring.y, part.half)
            for k, spring in enumerate(self._block.keys.springs)
        }
        return {k: share for k, share in shares.items() if share > 0.0}

    def _bearing_loads(self, part: _BlockPart) -> list[BodyLoad]:
        own, name, found = self._block, part.name, list[BodyLoad]()
        if own.is_floating(part.side):
            if self._on(part, self.high_pressure).area > 0.0:
                found.append(BodyLoad(name, "high", "high"))
            nose = float(self._on(part, nose_outline(own)).area)
            if nose > 0.0:
                found.append(BodyLoad(name, "nose", "nose", factor=nose))
            if own.keys.seal_preload > 0.0:
                size = part.share * own.keys.seal_preload
                found.append(BodyLoad(name, "seal", "constant", factor=size))
            for k, share in self._springs_on(part).items():
                size = share * own.keys.springs[k].force
                found.append(BodyLoad(name, f"spring_{k}", "constant", factor=size))
        if not carries_journals(self.assembly, own.length):
            return found
        # journal forces on the bores and what holds against them
        for gear in (0, 1) if part.half is None else (part.half,):
            label = BODIES[gear].removesuffix("_gear")
            for axis, source in _AXES:
                held = -_SHARE * wall_direction(self.assembly, axis, gear)
                found.append(BodyLoad(name, f"journal_{label}_{axis}", source, gear, -_SHARE))
                found.append(BodyLoad(name, f"wall_{label}_{axis}", source, gear, held))
        return found

    def _from_file(self, name: str, body: ElasticBody, half: int | None = None) -> ElasticBody:
        """Body with the shape of its STEP file, where it has one."""
        files = self.assembly.spec.keys.elastic_bodies
        path = None if files is None else getattr(files, _KEYS[name])
        if files is None or path is None:
            return body
        if half is not None:
            raise GeometryError(
                f"machine.elastic_bodies.{_KEYS[name]}",
                "a file of a split bearing",
                "for bearings in one piece",
            )
        edge = files.edge_length or _EDGE * self.assembly.profiles[0].tip_radius
        return replace(body, shape=SolidFile(path, edge, f"machine.elastic_bodies.{_KEYS[name]}"))


def half_names(block: FloatingBlock, side: str) -> tuple[str, ...]:
    """Elastic bodies of the halves beside the gears; empty for a bearing in one piece."""
    split = block.keys.split and block.is_floating(side)
    return tuple(f"{side}_{name}" for name in BODIES) if split else ()


def spring_share(assembly: Assembly, y: float, half: int) -> float:
    """Part of a spring at a height [m] that a half carries: both share one on the cut. [-]."""
    cut = waist(assembly, 0)
    if abs(y - cut) < _ON_THE_CUT:
        return 0.5
    return float((y < cut) == (half == 0))


def nose_outline(block: FloatingBlock) -> shapely.Polygon:
    """Nose; a square about its centre where it has no contour. [m]."""
    if block.nose_contour is not None:
        return shapely.Polygon(block.nose_contour)
    reach = 0.5 * block.nose.area**0.5
    x, y = block.nose.center
    return shapely.box(x - reach, y - reach, x + reach, y + reach)


def seal_line(high_pressure: shapely.Geometry, section: shapely.Polygon) -> shapely.Geometry:
    """Where the seal presses: edge of the high-pressure area within the face.

    Where all of the face is at high pressure the seal stands at the outline of the face.
    """
    outline = section.boundary
    inner = shapely.difference(high_pressure.boundary, outline.buffer(_ON_OUTLINE))
    return inner if inner.length > 0.0 else section.exterior
