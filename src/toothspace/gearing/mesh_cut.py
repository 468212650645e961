r"""Tooth spaces along a helix that the mating tooth cuts in two while they pass the mesh.

Where tips roll through roots, the mating tooth fills a space in the section in which it stands in
its middle. Ahead of that section the space still empties to the outlet of a pump, behind it fills
from the inlet, so that the two parts are chambers of their own. A chamber here is one filling of
a space: it begins with its first section behind the middle of the mesh, and ends with the last
one ahead of it, a turn and the twist of the face width later. More chambers than spaces are
needed, and their tables have a longer period than a turn.
"""

from __future__ import annotations

import math
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.core.recall import recalled
from toothspace.core.types import Array, IntArray
from toothspace.gearing.helix import Helix
from toothspace.gearing.numbering import FULL_TURN
from toothspace.model.description import ChamberFamily, FlowPath
from toothspace.model.path_category import PathCategory
from toothspace.numerics.periodic_table import PeriodicTable, monotone_table

ROOT = PathCategory("root", "tips in roots", "#D55E00", "gap")
_FINE = 80
"""Nodes on a pitch of tables that are cut. [-]"""
_REST = 0.01
"""Least volume of a chamber over its largest: what waits between two fillings. [-]"""
_BREATHER = 0.02
"""Opening to the inlet between two fillings over the face width times that width. [-]"""
_KEPT = 64
"""Paths along teeth that are remembered: a design is looked at again and again."""


@final
@dataclass(frozen=True)
class CutSpaces:
    """Fillings of the spaces of two equal gears, first in the section, then along the helix."""

    tooth_count: int
    """Teeth of each gear."""
    twist: float
    """Shaft angle between both ends of a tooth. [rad]"""

    @property
    def pitch(self) -> float:
        """Pitch angle. [rad]."""
        return FULL_TURN / self.tooth_count

    @property
    def count(self) -> int:
        """Fillings of each gear."""
        return self.tooth_count + math.ceil(self.twist / self.pitch) + 1

    @property
    def period(self) -> float:
        """Angle after which a chamber begins anew. [rad]."""
        return self.count * self.pitch

    def family(self, family: ChamberFamily) -> ChamberFamily:
        """Chambers whose section ends in the middle of the mesh."""
        alive = self._window(family.volume, 0.0, FULL_TURN)
        return replace(
            family,
            phases=self._phases(family.phases[0]),
            volume=self._longer(family.volume, alive),
            volume_by_motion=self._longer(family.volume_by_motion, alive),
        )

    def paths(self, path: FlowPath) -> list[FlowPath]:
        """Paths of the fillings: those of one turn, and those across the cut.

        A filling N is followed by N + 1 in the casing, and by N + ``tooth_count`` in its space.
        """
        half, z, first = 0.5 * self.pitch, self.tooth_count, np.arange(self.count)
        if path.nodes_a.min() >= 2 * z:  # from a port, which no filling touches
            more = 2 * (self.count - z)
            return [replace(path, nodes_a=path.nodes_a + more, nodes_b=path.nodes_b + more)]
        gear = 0 if path.nodes_a.max() < z else 1
        if path.name == "flank_leading":
            # the driven space ahead passes the middle half a pitch before
            same = self._joined(path, 0.0, FULL_TURN - half, 0, first, first - 1)
            over = self._joined(path, FULL_TURN - half, FULL_TURN, 0, first, first - 1 + z)
            return [same, replace(over, name=f"{path.name}_cut")]
        if path.name == "flank_trailing":
            same = self._joined(path, half, FULL_TURN, 0, first, first)
            over = self._joined(path, 0.0, half, 0, first, first - z)
            return [same, replace(over, name=f"{path.name}_cut")]
        if path.nodes_b.max() < 2 * z:
            # lands between a filling and the next one behind it
            ends, other = (half, FULL_TURN - half), (FULL_TURN - half, FULL_TURN + half)
            same = self._joined(path, *ends, gear, first + 1, first, gear)
            over = self._joined(path, *other, gear, first + 1, first + z, gear)
            return [same, replace(over, name=f"{path.name}_cut")]
        port = int(path.nodes_b[0]) - 2 * z + 2 * self.count
        joined = self._joined(path, 0.0, FULL_TURN, gear, first, first)
        return [replace(joined, nodes_b=np.full(self.count, port, dtype=np.int64))]

    def rest(self, family: ChamberFamily) -> ChamberFamily:
        """Chambers along the helix that never vanish."""
        volume = family.volume
        values = volume.values + _REST * volume.values.max()
        return replace(family, volume=PeriodicTable(volume.period, values, volume.slopes))

    def breather(self, path: FlowPath, width: float) -> FlowPath:
        """Opening to the inlet that also serves chambers between two fillings. [m]."""
        table = path.geometry
        nodes = table.period * np.arange(table.values.shape[0]) / table.values.shape[0]
        begin = FULL_TURN + 0.5 * self.twist
        room = self.period - self.twist - FULL_TURN
        rise = np.clip((nodes - begin) / (0.25 * room), 0.0, 1.0)
        fall = np.clip((begin + room - nodes) / (0.25 * room), 0.0, 1.0)
        share, values = np.minimum(rise, fall), table.values.copy()
        values[:, 0] += share**2 * (3.0 - 2.0 * share) * (_BREATHER * width) * width
        values[:, 1] = np.maximum(values[:, 1], np.where(share > 0.0, _BREATHER * width, 0.0))
        return replace(path, geometry=monotone_table(table.period, values))

    def roots(self, family: ChamberFamily, gear: int, area: float, height: float) -> FlowPath:
        """Leak along a space through the section that the mating tooth fills.

        Parameters
        ----------
        family : ChamberFamily
            Chambers of the gear.
        gear : int
            0 for the drive gear, 1 for the driven gear.
        area, height : float
            What the tooth leaves open there, and how high it is. [m2], [m]
        """
        rows = family.volume.values.shape[0]
        step = self.period / rows
        away = np.abs(step * np.arange(rows) - FULL_TURN)
        # fillings that hand over share the section while they do
        share = np.clip((0.5 * self.twist - away) / step + 0.5, 0.0, 1.0)
        ids = np.arange(self.count)
        return FlowPath(
            name=f"root_{('drive', 'driven')[gear]}",
            category=ROOT,
            kind="orifice",
            nodes_a=self._nodes(ids, gear),
            nodes_b=self._nodes(ids + self.tooth_count, gear),
            angle_ratio=1.0,
            phases=family.phases,
            geometry=monotone_table(
                self.period, np.column_stack([area * share, np.full(rows, 2.0 * height)])
            ),
        )

    def _joined(
        self, path: FlowPath, start: float, end: float, gear: int, first: IntArray,
        second: IntArray, other: int = 1,
    ) -> FlowPath:  # fmt: skip
        geometry = path.geometry
        if geometry.values.shape[0] < 2 * self.tooth_count:
            geometry = _constant(geometry, _FINE * self.tooth_count)
        elif geometry.values.shape[0] < _FINE * self.tooth_count:
            geometry = _finer(geometry, _FINE * self.tooth_count)
        window = self._window(geometry, start, end)
        longer = self._longer(geometry, None)
        values = longer.values.copy()
        nodes = self._nodes
        # area of an orifice or width of a gap
        values[:, 0 if path.kind == "orifice" else 1] *= window
        return replace(
            path,
            nodes_a=nodes(first, gear),
            nodes_b=nodes(second, other),
            phases=self._phases(path.phases[0]),
            geometry=monotone_table(self.period, values),
            height_by_motion=self._resampled(path.height_by_motion, geometry),
            drag_speed=self._resampled(path.drag_speed, geometry),
            shear_speed=self._resampled(path.shear_speed, geometry),
            partner_shift=0,
        )

    def _nodes(self, ids: IntArray, gear: int) -> IntArray:
        return np.asarray(np.mod(ids, self.count) + gear * self.count, dtype=np.int64)

    def _phases(self, first: float) -> Array:
        # from the middle of the mesh, which the section tables have at half a turn
        phases = np.mod(first - 0.5 * FULL_TURN - self.pitch * np.arange(self.count), self.period)
        return np.where(phases > self.period - 1e-9, 0.0, phases)

    def _window(self, table: PeriodicTable, start: float, end: float) -> Array:
        nodes = self._places(table)
        step = FULL_TURN / table.values.shape[0]
        return np.clip(np.minimum(nodes - start, end - nodes) / step + 0.5, 0.0, 1.0)

    def _places(self, table: PeriodicTable) -> Array:
        per_pitch = table.values.shape[0] // self.tooth_count
        return self.pitch * np.arange(per_pitch * self.count) / per_pitch

    def _longer(self, table: PeriodicTable, window: Array | None) -> PeriodicTable:
        rows = table.values.shape[0]
        chosen = np.mod(np.arange(self._places(table).size) + rows // 2, rows)
        values = table.values[chosen]
        if window is None:
            return PeriodicTable(self.period, values, table.slopes[chosen])
        cut = monotone_table(self.period, values * window[:, None])
        whole = (window >= 1.0) & (np.roll(window, 1) >= 1.0) & (np.roll(window, -1) >= 1.0)
        slopes = np.where(whole[:, None], table.slopes[chosen], cut.slopes)
        return PeriodicTable(self.period, cut.values, slopes)

    def _resampled(self, table: PeriodicTable | None, like: PeriodicTable) -> PeriodicTable | None:
        if table is None:
            return None
        if table.values.shape[0] != like.values.shape[0]:
            varies = np.ptp(table.values, axis=0).max() > 0.0
            table = (_finer if varies else _constant)(table, like.values.shape[0])
        return self._longer(table, None)


@final
@dataclass(frozen=True)
class AlongTeeth:
    """What a path of the section becomes along the helix, with spaces that are cut or not."""

    helix: Helix
    """How the teeth wind."""
    cut: CutSpaces | None = None
    """Fillings of the spaces; None where a space is one chamber."""

    def __call__(self, path: FlowPath) -> tuple[FlowPath, ...]:
        """Paths along the helix."""
        return _wound(self.helix, self.cut, path)


@recalled(_KEPT)
def _wound(helix: Helix, cut: CutSpaces | None, path: FlowPath) -> tuple[FlowPath, ...]:
    parts = [path] if cut is None else cut.paths(path)
    return tuple(helix.path(part) for part in parts)


def _constant(table: PeriodicTable, rows: int) -> PeriodicTable:
    values = np.tile(table.values[:1], (rows, 1))
    return PeriodicTable(table.period, values, np.zeros_like(values))


def _finer(table: PeriodicTable, rows: int) -> PeriodicTable:
    nodes = table.period * np.arange(rows) / rows
    return monotone_table(table.period, table(nodes))
