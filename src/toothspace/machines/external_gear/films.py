"""What stands against the bearing faces: teeth, tooth spaces and grooves at a shaft angle."""

from __future__ import annotations

from dataclasses import dataclass, field
from typing import final

import numpy as np
import shapely

from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.gearing.numbering import Numbering
from toothspace.gearing.outlines import space_outline
from toothspace.gearing.spaces import Spaces, drive_spaces, driven_spaces
from toothspace.geometry.gear_profile import GearProfile
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.loads import groove_polygons
from toothspace.model.lateral_balance import LAND, FaceCells

_FULL_TURN = 2.0 * np.pi
_ON_FLANK = 1e-4
"""Distance up to which the outline of a chamber runs along a flank. [m]"""


@final
@dataclass(frozen=True, eq=False)
class FaceOfGear:
    """Faces of one gear against the bearings, in the machine frame.

    Parameters
    ----------
    assembly : Assembly
        Gears in mesh.
    numbering : Numbering
        Nodes of the tooth spaces.
    gear : int
        0 for the drive gear, 1 for the driven gear.
    """

    assembly: Assembly
    numbering: Numbering
    gear: int
    _edges: tuple[tuple[Array, Array, Array], ...] = field(init=False, repr=False)

    def __post_init__(self) -> None:
        edges = tuple(_flank_angles(profile) for profile in self.assembly.profiles)
        object.__setattr__(self, "_edges", edges)

    def __call__(self, shaft_angle: float, x: Array, y: Array) -> FaceCells:
        """Nodes, own teeth and share of the bearing's face at points; angles in [rad], [m]."""
        own = self._inside(self.gear, shaft_angle, x, y)
        other = self._inside(1 - self.gear, shaft_angle, x, y) & ~own
        in_lens = self._in_lens(x, y)
        node = np.where(own, LAND, self._space(self.gear, shaft_angle, x, y))
        lens = np.flatnonzero((in_lens & ~own).ravel())
        if lens.size:
            flat = node.ravel()
            flat[lens] = self._lens_nodes(shaft_angle, x.ravel()[lens], y.ravel()[lens], flat[lens])
            node = flat.reshape(x.shape)
        groove = self._grooves(x, y)
        node = np.where(own & (groove != LAND), groove, node)
        return FaceCells(node, own, own | (~other & self._own_half(x, y)))

    def _polar(self, gear: int, x: Array, y: Array) -> tuple[Array, Array]:
        rise = y - (self.assembly.mesh.center_distance if gear == 1 else 0.0)
        return np.hypot(x, rise), np.arctan2(rise, x)

    def _inside(self, gear: int, shaft_angle: float, x: Array, y: Array) -> BoolArray:
        """Whether points lie in the section of a gear."""
        profile, (radii, right, left) = self.assembly.profiles[gear], self._edges[gear]
        radius, polar = self._polar(gear, x, y)
        pitch = profile.pitch_angle
        # a middle of a tooth is at this angle, see the outlines of the gears
        tooth = self.tooth_angle(gear, shaft_angle)
        place = np.mod(polar - tooth + 0.5 * pitch, pitch) - 0.5 * pitch
        low, high = np.interp(radius, radii, right), np.interp(radius, radii, left)
        on_tooth = (place >= low) & (place <= high) & (radius <= profile.tip_radius)
        return np.asarray((radius <= profile.root_radius) | on_tooth)

    def tooth_angle(self, gear: int, shaft_angle: float) -> float:
        """Angle of the middle of a tooth at a shaft angle. [rad]."""
        mesh = self.assembly.mesh
        if gear == 0:
            return 0.5 * np.pi + mesh.half_pitch + shaft_angle
        return -0.5 * np.pi + mesh.turn - mesh.ratio * shaft_angle

    def own_angle(self, shaft_angle: float, x: Array, y: Array) -> Array:
        """Angle of points in the frame of the own gear, from its first tooth. [rad]."""
        return self._polar(self.gear, x, y)[1] - self.tooth_angle(self.gear, shaft_angle)

    def flank(self, side: int) -> tuple[Array, Array]:
        """Radii [m] and angles [rad] of a flank from its tooth's middle, side 0 left, 1 right."""
        radii, right, left = self._edges[self.gear]
        return radii, (left, right)[side]

    def flank_nodes(self, shaft_angle: float, radius: Array) -> IntArray:
        """Nodes of the chambers along all flanks, shape (spaces, 2, radii).

        Parameters
        ----------
        shaft_angle : float
            Shaft angle. [rad]
        radius : ndarray
            Places on the flanks. [m]

        Returns
        -------
        ndarray
            For the spaces after each tooth, counter-clockwise in the frame of the own gear, on
            the left flank of the tooth before and the right one of the tooth after.
        """
        profile = self.assembly.profiles[self.gear]
        edges = [np.interp(radius, *self.flank(side)) for side in (0, 1)]
        teeth = profile.pitch_angle * np.arange(profile.tooth_count)[:, None, None]
        own = teeth + np.stack([edges[0], profile.pitch_angle + edges[1]])
        angle = own + self.tooth_angle(self.gear, shaft_angle)
        rise = self.assembly.mesh.center_distance if self.gear == 1 else 0.0
        x, y = radius * np.cos(angle), radius * np.sin(angle) + rise
        node = self._space(self.gear, shaft_angle, x, y)
        meshing = self._in_lens(x, y)
        node[meshing] = self._nearest(shaft_angle, x[meshing], y[meshing], node[meshing])
        return node

    def _nearest(self, shaft_angle: float, x: Array, y: Array, default: IntArray) -> IntArray:
        """Chambers between the teeth in mesh that touch places on a flank."""
        points, node = shapely.points(x, y), default.copy()
        closest = np.full(x.shape, _ON_FLANK)
        for chamber, outline in self._mesh_spaces(shaft_angle):
            away = shapely.distance(shapely.LineString(outline), points)
            node[away < closest] = chamber
            closest = np.minimum(away, closest)
        return node

    def _space(self, gear: int, shaft_angle: float, x: Array, y: Array) -> IntArray:
        """Node of the tooth space whose sector holds a point."""
        _, polar = self._polar(gear, x, y)
        phases, nodes = self.numbering.space_phases[gear], self.numbering.nodes[gear]
        place = polar - 0.5 * np.pi if gear == 0 else -0.5 * np.pi - polar
        table = place + np.pi + (self.assembly.mesh.turn if gear == 1 else 0.0)
        turned = phases[0] + self.numbering.ratios[gear] * shaft_angle - table
        number = np.rint(turned * nodes.size / _FULL_TURN).astype(np.int64)
        return np.asarray(nodes[np.mod(number, nodes.size)])

    def _own_half(self, x: Array, y: Array) -> BoolArray:
        own, _ = self._polar(self.gear, x, y)
        other, _ = self._polar(1 - self.gear, x, y)
        tips = [profile.tip_radius for profile in self.assembly.profiles]
        return np.asarray(own**2 - tips[self.gear] ** 2 <= other**2 - tips[1 - self.gear] ** 2)

    def _in_lens(self, x: Array, y: Array) -> BoolArray:
        other, _ = self._polar(1 - self.gear, x, y)
        return np.asarray(other <= self.assembly.profiles[1 - self.gear].tip_radius)

    def _lens_nodes(self, shaft_angle: float, x: Array, y: Array, default: IntArray) -> IntArray:
        """Chambers between the teeth in mesh, cut where the throats are."""
        node = default.copy()
        for chamber, outline in self._mesh_spaces(shaft_angle):
            shape = shapely.Polygon(outline)
            if not shape.is_valid:
                shape = shape.buffer(0.0)
            shapely.prepare(shape)
            node[shapely.contains_xy(shape, x, y)] = chamber
        return node

    def _mesh_spaces(self, shaft_angle: float) -> list[tuple[int, Array]]:
        assembly, found = self.assembly, []
        for gear in (0, 1):
            phases, nodes = self.numbering.space_phases[gear], self.numbering.nodes[gear]
            turn = assembly.mesh.turn if gear == 1 else 0.0
            table = phases + self.numbering.ratios[gear] * shaft_angle
            place = np.mod(table, _FULL_TURN) - np.pi - turn
            near = np.flatnonzero(np.abs(place) < self._reach(gear))
            make = drive_spaces if gear == 0 else driven_spaces
            spaces: Spaces = make(*assembly.teeth, assembly.mesh, place[near])
            found += [(int(nodes[k]), space_outline(spaces, i)) for i, k in enumerate(near)]
        return found

    def _reach(self, gear: int) -> float:
        mesh = self.assembly.mesh
        lens = mesh.lens_drive if gear == 0 else mesh.lens_driven
        return lens + self.assembly.profiles[gear].pitch_angle

    def _grooves(self, x: Array, y: Array) -> IntArray:
        node = np.full(x.shape, LAND, dtype=np.int64)
        for name, polygon in groove_polygons(self.assembly).items():
            port = self.numbering.outlet if name.endswith("outlet") else self.numbering.inlet
            shape = shapely.Polygon(polygon)
            shapely.prepare(shape)
            node[shapely.contains_xy(shape, x, y)] = port
        return node


def _flank_angles(profile: GearProfile) -> tuple[Array, Array, Array]:
    """Angles of right and left flank about the middle of the tooth, over the radius."""
    radii = np.linspace(profile.root_radius, profile.tip_radius, 400)
    sides = []
    for flank in (profile.right_flank, profile.left_flank[::-1]):
        radius, angle = np.hypot(*flank.T), np.arctan2(flank[:, 1], flank[:, 0])
        rising = np.maximum.accumulate(radius) == radius
        sides.append(np.interp(radii, radius[rising], angle[rising]))
    return radii, sides[0], sides[1]
