r"""Tooth spaces along a helix in slices, where one pressure for a whole space is not enough.

Planes across the axis cut the face width in equal slices. In each of them a tooth space is a
chamber of its own, with the tables of the helix over its part of the width; the section of the
space between two slices is a flow path.
"""

from __future__ import annotations

import math
from collections.abc import Iterable, Sequence
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.closures.orifice import DISCHARGE_COEFFICIENT
from toothspace.core.types import IntArray
from toothspace.gearing.helix import Helix
from toothspace.gearing.space_paths import FACES
from toothspace.model.description import ChamberFamily, FlowPath
from toothspace.model.path_category import PathCategory
from toothspace.numerics.periodic_table import PeriodicTable, monotone_table

ALONG = PathCategory("along_space", "along tooth spaces", "#CC79A7", "along")
_PIPE_OVER_GAP = 2.0 / 3.0
"""Length of a gap of half the hydraulic diameter over that of a pipe that leaks as much. [-]"""


@final
@dataclass(frozen=True)
class Slices:
    """Slices of the face width of two gears."""

    helix: Helix
    """How the teeth wind."""
    count: int
    """Slices, at least two."""
    spaces: tuple[int, int]
    """Tooth spaces of both gears."""

    @property
    def _one(self) -> Helix:
        """Helix over the width of one slice."""
        return replace(self.helix, face_width=self.helix.face_width / self.count)

    def _lead(self, place: float) -> float:
        """Shaft angle by which a place leads the middle, in slices from the lower end. [rad]."""
        width = self.helix.face_width
        return self.helix.turn_per_length * width * (place / self.count - 0.5)

    def families(self, *section: ChamberFamily) -> tuple[ChamberFamily, ...]:
        """Chambers of all slices of one gear after those of the other, from the lower end on."""
        found = []
        for family in section:
            mean = self._one.family(family)
            volume, by_motion = (
                PeriodicTable(t.period, t.values / self.count, t.slopes / self.count)
                for t in (mean.volume, mean.volume_by_motion)
            )
            for k in range(self.count):
                ahead = self._lead(k + 0.5) * family.angle_ratio
                found.append(
                    replace(
                        family,
                        name=f"{family.name}_slice_{k}",
                        phases=family.phases + ahead,
                        volume=volume,
                        volume_by_motion=by_motion,
                    )
                )
        return tuple(found)

    def __call__(self, path: FlowPath) -> tuple[FlowPath, ...]:
        """Path of the section in every slice, or at both ends where it is in the faces."""
        if path.multiplicity == FACES:
            last = self.count - 1
            ends = ((0, 0.0, "lower"), (last, float(self.count), "upper"))
            return tuple(
                self._moved(path, k, place, f"{path.name}_{end}", 1.0) for k, place, end in ends
            )
        if path.end:
            upper = path.end * self.helix.turn_per_length > 0.0
            part, place = (self.count - 1, float(self.count)) if upper else (0, 0.0)
            return (self._moved(path, part, place, path.name, path.multiplicity),)
        own = self._one.path(path)
        share = path.multiplicity / self.count
        return tuple(
            self._moved(own, k, k + 0.5, f"{path.name}_slice_{k}", share) for k in range(self.count)
        )

    def paths(
        self, section: Iterable[FlowPath], families: Sequence[ChamberFamily]
    ) -> tuple[FlowPath, ...]:
        """Paths of all slices, and between them, of a section with its chambers."""
        return (*(part for path in section for part in self(path)), *self.joints(*families))

    def joints(self, *section: ChamberFamily) -> tuple[FlowPath, ...]:
        r"""Sections of the spaces between neighbouring slices, from the lower one to the upper.

        Notes
        -----
        From the middle of one slice to that of the next oil loses what a pipe of the section A and
        the hydraulic diameter :math:`D = A/\sqrt{A_{max}}` takes, and :math:`\zeta` dynamic heads,

        .. math:: \Delta p = \frac{32\,\mu\,L\,Q}{A D^2} + \zeta\,\frac{\rho\,Q^2}{2 A^2},
            \qquad L = \frac{b}{N}, \qquad \zeta = \frac{6}{2 N - 1} .

        In a space that is squeezed evenly the speed grows evenly from the shut end to the open one.
        Bernoulli's equation then takes :math:`(N - 1)/N` of the last head from the middle of the
        first slice to that of the last one, and so do all N - 1 joints with this :math:`\zeta`,
        which is ours. The inertia of the oil, small beside both, is left out.
        """
        loss, width = 6.0 / (2 * self.count - 1), self.helix.face_width
        wider = 1.0 / (DISCHARGE_COEFFICIENT * math.sqrt(loss))
        found = []
        for gear, family in enumerate(section):
            area = np.maximum(family.volume.values[:, 0] / width, 0.0)
            side = math.sqrt(area.max())
            columns = np.tile([0.0, 2.0 * wider * side, 0.0], (area.size, 1))
            columns[:, 0] = 0.5 * area / side
            columns[:, 2] = _PIPE_OVER_GAP * wider * width / self.count
            geometry = monotone_table(family.volume.period, columns)
            first = gear * self.spaces[0]
            ids = first + np.arange(family.count)
            for k in range(self.count - 1):
                found.append(
                    FlowPath(
                        name=f"along_{family.name}_{k}",
                        category=ALONG,
                        kind="parallel_gap",
                        nodes_a=self._nodes(ids, k),
                        nodes_b=self._nodes(ids, k + 1),
                        angle_ratio=family.angle_ratio,
                        phases=family.phases + self._lead(k + 1.0) * family.angle_ratio,
                        geometry=geometry,
                    )
                )
        return tuple(found)

    def _moved(
        self, path: FlowPath, part: int, place: float, name: str, multiplicity: float
    ) -> FlowPath:
        """Path between the chambers of a slice, at a place in slices from the lower end."""
        return replace(
            path,
            name=name,
            nodes_a=self._nodes(path.nodes_a, part),
            nodes_b=self._nodes(path.nodes_b, part),
            phases=path.phases + self._lead(place) * path.angle_ratio,
            multiplicity=multiplicity,
        )

    def _nodes(self, nodes: IntArray, part: int) -> IntArray:
        """Nodes of a slice for those of the section; ports stay ports."""
        first, both = self.spaces[0], sum(self.spaces)
        drive, driven = (
            nodes + part * first,
            nodes + (self.count - 1) * first + part * self.spaces[1],
        )
        port = nodes + (self.count - 1) * both
        return np.where(nodes < first, drive, np.where(nodes < both, driven, port)).astype(np.int64)
