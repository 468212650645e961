r"""Gears whose teeth differ: chambers, flank gaps, contacts and tips of each tooth.

A deviation :math:`\delta` of a flank along its normal takes :math:`\delta\,ds` from the section of
the chamber before it and narrows the throats on it by :math:`\delta`, both to first order. The
driven gear turns by what the highest pair of loaded flanks asks for, which repeats with
every revolution where both gears have as many teeth.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.core.errors import GeometryError
from toothspace.core.types import Array
from toothspace.gearing.mesh_split import Throats
from toothspace.gearing.meshing import LARGEST_OVERLAP, driven_lever, overlap_error
from toothspace.gearing.numbering import FULL_TURN, Numbering
from toothspace.gearing.spaces import Spaces, area_by_motion
from toothspace.geometry.gear_profile import GearProfile
from toothspace.machines.external_gear.assembly import Assembly
from toothspace.machines.external_gear.spec import Gear
from toothspace.model.description import ChamberFamily, ContactPair, FlowPath
from toothspace.numerics.periodic_table import PeriodicTable, smooth_table, sum_of_tables

_ROTATION = 4


@final
@dataclass(frozen=True)
class _Flanks:
    """Deviations of a gear's teeth over the radius."""

    radius: Array
    """From root to tip. Shape (n,). [m]"""
    height: Array
    """Deviation of the left and the right flanks. Shape (2, tooth_count, n). [m]"""
    section: Array
    """Section of the deviation between root and radius. Shape (2, tooth_count, n). [m2]"""

    def at(self, side: int, tooth: int, radius: Array) -> Array:
        """Deviation at radii. [m]."""
        return np.asarray(np.interp(radius, self.radius, self.height[side, tooth]))

    def below(self, side: int, tooth: int, radius: Array) -> Array:
        """Section of the deviation from the root up to radii. [m2]."""
        return np.asarray(np.interp(radius, self.radius, self.section[side, tooth]))

    def beyond(self, side: int, tooth: int, radius: Array) -> Array:
        """Section of the deviation from radii up to the tip. [m2]."""
        return np.asarray(self.section[side, tooth, -1] - self.below(side, tooth, radius))


@final
@dataclass(frozen=True)
class OwnTeeth:
    """What differs from tooth to tooth, over the table angles of spaces and throats."""

    turn: Array
    """Turn of the driven gear ahead of its even motion, over the shaft angle. Shape (nodes,). [rad]
    """
    gaps: tuple[Array, Array]
    """Gap of every left and every right throat. Shape (tooth_count, nodes). [m]"""
    areas: tuple[Array, Array]
    """Section of every drive and every driven space less that of even teeth. Shape (tooth_count,
    nodes). [m2]
    """
    tips: tuple[Array, Array]
    """Height of the tip behind every space above the tip circle, of both gears. Shape
    (tooth_count,). [m]
    """

    def family(self, family: ChamberFamily, gear: int, width: float) -> ChamberFamily:
        """Chambers of a gear of a width [m], each with its own volume."""
        parts = [smooth_table(FULL_TURN, width * area) for area in self.areas[gear]]
        return replace(family, own=tuple(sum_of_tables(family.volume, part) for part in parts))

    def path(self, path: FlowPath) -> FlowPath:
        """Flank or tip path with its own gaps, other paths as they are."""
        if path.name.startswith("flank"):
            gaps = self.gaps[1 if path.name == "flank_leading" else 0]
            tables = (_with_first(path.geometry, gap) for gap in gaps)
        elif path.name.startswith("tooth_tip"):
            clearance = path.geometry.values[:, 0]
            tips = self.tips[0 if path.name.endswith("drive") else 1]
            tables = (_with_first(path.geometry, clearance - tip) for tip in tips)
        else:
            return path
        return replace(path, own=tuple(tables))

    def contact(self, contact: ContactPair, *, is_left: bool) -> ContactPair:
        """Contacts of the flanks of one side, each with its own gap."""
        gaps = self.gaps[0 if is_left else 1]
        return replace(contact, own=tuple(_with_first(contact.geometry, gap) for gap in gaps))


def own_teeth(assembly: Assembly, numbering: Numbering, spaces: tuple[Spaces, Spaces]) -> OwnTeeth:
    """Deviations of both gears in mesh, of which one or both have some.

    Gaps, sections and tips of every tooth.

    Raises GeometryError if the gears have unlike tooth counts, or flanks overlap.
    """
    gears = assembly.spec.drive, assembly.spec.driven
    first, second = assembly.counts
    if first != second:
        raise GeometryError(
            "machine.gears.tooth_deviations",
            f"gears of {first} and {second} teeth, of which the same meet after "
            f"{math.lcm(first, second) // first} revolutions",
            "equal tooth counts: tables hold one revolution",
        )
    flanks = _flanks(gears[0], assembly.profiles[0]), _flanks(gears[1], assembly.profiles[1])
    throats = spaces[0].left, spaces[0].right
    # sum of both deviations in the throat of every drive space
    lost = []
    for flank in (0, 1):
        near, far = _radii(assembly, throats[flank])
        count, rows = assembly.counts[0], []
        for k in range(count):
            own = flanks[0].at(flank, _measured(0, k + (1 if flank == 0 else 0), count), near)
            rows.append(np.asarray(own + flanks[1].at(flank, _measured(1, k, count), far)))
        lost.append(np.array(rows))
    levers = [
        np.where(side.weight > 0.0, driven_lever(side, assembly.mesh), 0.0) for side in throats
    ]
    # nodes by which the table of each space runs ahead of the shaft angle
    ahead = (phases * spaces[0].angles.size / FULL_TURN for phases in numbering.space_phases)
    shifts = [np.rint(nodes).astype(np.int64) for nodes in ahead]
    loaded = 0 if assembly.loaded_is_left else 1
    side, lever = throats[loaded], levers[loaded]
    touching = side.weight >= 1.0
    sign = float(np.sign(lever[touching][0]))
    safe = np.where(touching, lever, 1.0)
    needed = np.where(touching, (lost[loaded] - side.gap) / safe, -sign * np.inf)
    over_shaft = [np.roll(row, -shift) for row, shift in zip(needed, shifts[0], strict=True)]
    turn = sign * np.max(sign * np.array(over_shaft), axis=0)
    at_nodes = [np.array([np.roll(turn, shift) for shift in own]) for own in shifts]
    left, right = (
        side.gap + np.where(side.weight > 0.0, lever * at_nodes[0] - narrowed, 0.0)
        for side, lever, narrowed in zip(throats, levers, lost, strict=True)
    )
    gaps = left, right
    complete = throats[1 - loaded].weight >= 1.0
    play = float(gaps[1 - loaded][:, complete].min())
    if play < -LARGEST_OVERLAP:
        raise overlap_error(assembly.mesh.center_distance, -play)
    rotations = [area_by_motion(spaces[gear])[:, _ROTATION] for gear in (0, 1)]
    drive, driven = (
        rotations[gear] * at_nodes[gear] - _sections(assembly, flanks, spaces[gear], gear)
        for gear in (0, 1)
    )
    measured = [np.zeros(first) if g.deviations is None else g.deviations.tip for g in gears]
    drive_tips, driven_tips = (
        tip[[_measured(gear, k + 1, first) for k in range(first)]]
        for gear, tip in enumerate(measured)
    )
    return OwnTeeth(turn, gaps, (drive, driven), (drive_tips, driven_tips))


def _measured(gear: int, tooth: int, count: int) -> int:
    # numbers grow against the rotation: clockwise on the drive gear
    return (-tooth if gear == 0 else tooth) % count


def _flanks(gear: Gear, profile: GearProfile) -> _Flanks:
    outline = profile.left_flank[::-1]
    radius = np.maximum.accumulate(np.hypot(*outline.T))
    count, given = profile.tooth_count, gear.deviations
    height = np.zeros((2, count, len(radius)))
    if given is not None and profile.involute is not None:
        roll = profile.involute.roll_length(radius)
        for side, rows in enumerate((given.left, given.right)):
            height[side] = [np.interp(roll, given.roll_length, row) for row in rows]
    step = np.hypot(*np.diff(outline, axis=0).T)
    slices = 0.5 * (height[..., 1:] + height[..., :-1]) * step
    section = np.concatenate([np.zeros((2, count, 1)), np.cumsum(slices, axis=-1)], axis=-1)
    return _Flanks(radius, height, section)


def _radii(assembly: Assembly, side: Throats) -> tuple[Array, Array]:
    center = np.array([0.0, assembly.mesh.center_distance])
    return np.hypot(*side.drive.point.T), np.hypot(*(side.driven.point - center).T)


def _sections(
    assembly: Assembly, flanks: tuple[_Flanks, _Flanks], spaces: Spaces, gear: int
) -> Array:
    """Section that deviations take from every space of a gear. [m2]."""
    count, rows = assembly.counts[0], []
    own, other = flanks[gear], flanks[1 - gear]
    for k in range(count):
        total = np.zeros(spaces.angles.size)
        for flank, side in enumerate((spaces.left, spaces.right)):
            radii = _radii(assembly, side)
            # drive and driven tooth of the throat beside this space
            if gear == 0:
                teeth = k + (1 if flank == 0 else 0), k
            else:
                teeth = k + 1, k + (0 if flank == 0 else 1)
            numbers = [_measured(g, teeth[g], count) for g in (0, 1)]
            total += own.below(flank, numbers[gear], radii[gear])
            entering = other.beyond(flank, numbers[1 - gear], radii[1 - gear])
            total += np.where(side.weight > 0.0, entering, 0.0)
        rows.append(total)
    return np.array(rows)


def _with_first(table: PeriodicTable, column: Array) -> PeriodicTable:
    # the first channel with another course; its slope gains that of the difference
    part = smooth_table(table.period, column - table.values[:, 0])
    values, slopes = table.values.copy(), table.slopes.copy()
    values[:, 0] += part.values[:, 0]
    slopes[:, 0] += part.slopes[:, 0]
    return PeriodicTable(table.period, values, slopes)
