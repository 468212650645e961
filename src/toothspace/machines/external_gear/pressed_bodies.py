"""Elastic bodies of a machine with a pressed bearing, and what acts on them in a run."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import final

import shapely

from toothspace.core.types import IntArray
from toothspace.elasticity.body import ElasticBody
from toothspace.elasticity.solid_file import SolidFile
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.elastic_bodies import (
    BackLoads,
    BearingSide,
    MeshSize,
    bearing_body,
    bearing_section,
    carries_journals,
    gear_body,
    wall_direction,
)
from toothspace.machines.external_gear.loads import BODIES
from toothspace.machines.external_gear.spec import PressedBearing
from toothspace.model.lateral_balance import BodyLoad, LoadSource

COARSE = MeshSize(0.16, 0.16, 0.13)
"""A few thousand elements for each body."""
_SIDES: tuple[BearingSide, ...] = ("floating", "solid")
_KEYS = dict(zip((*_SIDES, *BODIES), ("floating_bearing", "solid_bearing", *BODIES), strict=True))
_AXES: tuple[tuple[str, LoadSource], ...] = (("x", "journal_x"), ("y", "journal_y"))
_ON_OUTLINE = 1e-5
"""Distance up to which an edge of the high-pressure area is the outline of the face. [m]"""
_EDGE = 0.1
"""Edge of the tetrahedra of bodies from files over the tip radius, if not given. [-]"""
_SHARE = 0.5
"""Each of both bearings carries this share of the journal force on a gear. [-]"""


@final
@dataclass(frozen=True)
class PressedBodies:
    """Bearings and gears of a machine with a pressed bearing.

    Parameters
    ----------
    assembly : Assembly
        Gears in mesh.
    high_pressure : Geometry
        Part of the back face at high pressure. [m]
    space_nodes : tuple of ndarray
        Nodes of the spaces after each tooth, counter-clockwise in the frame of the gear.
    size : MeshSize
        Fineness of all bodies.
    """

    assembly: Assembly
    high_pressure: shapely.Geometry
    space_nodes: tuple[IntArray, IntArray]
    size: MeshSize = COARSE

    def __call__(self) -> Mapping[str, ElasticBody]:
        """Bearings ``floating`` and ``solid``, and the gears by name.

        Raises
        ------
        GeometryError
            If a body has a shape that cannot be swept.
        """
        made: dict[str, ElasticBody] = {side: self._bearing(side) for side in _SIDES}
        made |= {name: gear_body(self.assembly, k, self.size) for k, name in enumerate(BODIES)}
        return {name: self._from_file(name, body) for name, body in made.items()}

    def loads(self) -> tuple[BodyLoad, ...]:
        """Pressures behind the bearing and in the tooth spaces, springs, seal, journals."""
        found = [load for side in _SIDES for load in self._bearing_loads(side)]
        for gear, name in enumerate(BODIES):
            spaces = enumerate(self.space_nodes[gear])
            found += [BodyLoad(name, f"space_{k}", "node", int(node)) for k, node in spaces]
            for side in _SIDES:
                label = f"journal_{side}"
                found.append(BodyLoad(name, f"{label}_x", "journal_x", gear, -_SHARE))
                found.append(BodyLoad(name, f"{label}_y", "journal_y", gear, -_SHARE))
        return tuple(found)

    @property
    def _pressed(self) -> PressedBearing:
        pressed = self.assembly.spec.pressed
        assert pressed is not None
        return pressed

    def _moves(self, side: BearingSide) -> bool:
        """Whether a bearing is pressed on its back and held by nothing else."""
        return side == "floating" or self._pressed.arrangement != "asymmetric"

    def _bearing(self, side: BearingSide) -> ElasticBody:
        own = self._pressed
        back = self._back() if self._moves(side) else None
        body = bearing_body(self.assembly, own.material, own.length, side, back, self.size)
        return replace(body, supports=()) if self._moves(side) else body

    def _back(self) -> BackLoads:
        """High-pressure area with its seal, nose and springs."""
        own, section = self._pressed, bearing_section(self.assembly)
        areas = {"high": self.high_pressure} if self.high_pressure.area > 0.0 else {}
        lines = {}
        if own.seal_preload > 0.0:
            lines["seal"] = seal_line(self.high_pressure, section)
        points = {f"spring_{k}": (s.x, s.y) for k, s in enumerate(own.springs)}
        patches = {}
        if own.nose_area > 0.0:
            patches["nose"] = nose_outline(own).difference(self.high_pressure)
        return BackLoads(areas=areas, points=points, lines=lines, patches=patches)

    def _bearing_loads(self, side: BearingSide) -> list[BodyLoad]:
        own, found = self._pressed, list[BodyLoad]()
        if self._moves(side):
            if self.high_pressure.area > 0.0:
                found.append(BodyLoad(side, "high", "high"))
            if own.nose_area > 0.0:
                found.append(BodyLoad(side, "nose", "nose", factor=own.nose_area))
            if own.seal_preload > 0.0:
                found.append(BodyLoad(side, "seal", "constant", factor=own.seal_preload))
            for k, spring in enumerate(own.springs):
                found.append(BodyLoad(side, f"spring_{k}", "constant", factor=spring.force))
        if carries_journals(self.assembly, own.length):
            found += self._radial_loads(side)
        return found

    def _radial_loads(self, side: BearingSide) -> list[BodyLoad]:
        """Journal forces on the bores and what holds against them."""
        found = []
        for gear, name in enumerate(BODIES):
            label = name.removesuffix("_gear")
            for axis, source in _AXES:
                held = -_SHARE * wall_direction(self.assembly, axis, gear)
                found.append(BodyLoad(side, f"journal_{label}_{axis}", source, gear, -_SHARE))
                found.append(BodyLoad(side, f"wall_{label}_{axis}", source, gear, held))
        return found

    def _from_file(self, name: str, body: ElasticBody) -> ElasticBody:
        """Body with the shape of its STEP file, where it has one."""
        files = self.assembly.spec.body_files
        path = None if files is None else getattr(files, _KEYS[name])
        if files is None or path is None:
            return body
        edge = files.edge_length or _EDGE * self.assembly.profiles[0].tip_radius
        return replace(body, shape=SolidFile(path, edge, f"machine.elastic_bodies.{_KEYS[name]}"))


def nose_outline(pressed: PressedBearing) -> shapely.Polygon:
    """Nose, taken as a square about its centre. [m]."""
    reach = 0.5 * pressed.nose_area**0.5
    x, y = pressed.nose_center
    return shapely.box(x - reach, y - reach, x + reach, y + reach)


def seal_line(high_pressure: shapely.Geometry, section: shapely.Polygon) -> shapely.Geometry:
    """Where the seal presses: edge of the high-pressure area within the face.

    Where all of the face is at high pressure the seal stands at the outline of the face.
    """
    outline = section.boundary
    inner = shapely.difference(high_pressure.boundary, outline.buffer(_ON_OUTLINE))
    return inner if inner.length > 0.0 else section.exterior
