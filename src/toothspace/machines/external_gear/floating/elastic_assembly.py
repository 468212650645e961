"""Elastic bodies of a machine with a floating bearing, and what acts on them in a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import cached_property
from typing import NamedTuple, final

import shapely

from toothspace.core.errors import GeometryError
from toothspace.elasticity.body import ElasticBody
from toothspace.elasticity.mesh import SolidFile
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.floating.elastic_bodies import (
    BackLoads,
    BearingSide,
    MeshSize,
    bearing_body,
    bearing_section,
    beside_cut,
    carries_journals,
    gear_body,
    waist,
    wall_direction,
)
from toothspace.machines.external_gear.floating.gear_flanks import GearFlanks
from toothspace.machines.external_gear.gear_bodies import BODIES
from toothspace.machines.external_gear.gear_faces import FaceOfGear
from toothspace.machines.external_gear.spec import FloatingBlock
from toothspace.model.floating_bearing import BodyLoad, LoadSource

COARSE = MeshSize(0.16, 0.16, 0.13)
"""A few thousand elements for each body."""
_SIDES: tuple[BearingSide, ...] = ("floating", "solid")
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

        Raises
        ------
        GeometryError
            If a body has a shape that cannot be swept, or a half of a bearing a file.
        """
        made = {p.name: self._from_file(p.side, self._bearing(p), p.half) for p in self._parts()}
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

    def _bearing(self, part: _BlockPart) -> ElasticBody:
        own, moves = self._block, self._block.is_floating(part.side)
        body = bearing_body(
            self.assembly,
            own.material,
            own.length,
            part.side,
            self._back(part) if moves else None,
            self.size,
            part.half,
        )
        return replace(body, supports=()) if moves else body

    def _back(self, part: _BlockPart) -> BackLoads:
        """High-pressure area with its seal, nose and springs."""
        own, high = self._block, self._on(part, self.high_pressure)
        nose = self._on(part, nose_outline(own))
        areas = {"high": high} if high.area > 0.0 else {}
        lines = {}
        if own.keys.seal_preload > 0.0:
            lines["seal"] = seal_line(high, bearing_section(self.assembly, part.half))
        points = {
            f"spring_{k}": (own.keys.springs[k].x, own.keys.springs[k].y)
            for k in self._springs_on(part)
        }
        patches = {"nose": nose.difference(self.high_pressure)} if nose.area > 0.0 else {}
        return BackLoads(areas=areas, points=points, lines=lines, patches=patches)

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
