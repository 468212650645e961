"""Phases of spaces, teeth and throats, and which chambers they join.

At shaft angle zero the drive space 0 is centred on the centre line, open towards the driven
gear, and the driven tooth 0 stands in it. Numbers grow against the rotation: space k + 1 comes
to the mesh after space k. Drive space k lies between the drive teeth k (ahead) and k + 1; driven
space k between the driven teeth k (ahead) and k + 1, where drive tooth k + 1 enters it.
Table angles are zero opposite to the mesh and pi on the mesh side of the centre line; on the
driven gear they follow from the shaft angle alone, without the small turn into contact.
"""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.types import Array, IntArray

FULL_TURN = 2.0 * np.pi


@final
@dataclass(frozen=True)
class Numbering:
    """Phases and nodes of all chambers and of the paths between them."""

    space_phases: tuple[Array, Array]
    tooth_phases: tuple[Array, Array]
    """Table angles at shaft angle zero of the spaces, and of the teeth that stand behind them, of
    drive and driven gear. [rad]
    """
    nodes: tuple[IntArray, IntArray]
    """Node numbers of the spaces of both gears."""
    ratios: tuple[float, float]
    """Growth of the table angles per shaft angle. [-]"""
    met_spaces: IntArray
    """Driven space met by each drive space through its trailing throat in this turn."""
    partner_shift: int
    """Shift of the met space at each further turn of the drive gear."""

    @property
    def inlet(self) -> int:
        """Node of the inlet."""
        return int(sum(nodes.size for nodes in self.nodes))

    @property
    def outlet(self) -> int:
        """Node of the outlet."""
        return self.inlet + 1

    @property
    def drain(self) -> int:
        """Node of the drain."""
        return self.inlet + 2


def number(counts: tuple[int, int]) -> Numbering:
    """Number the chambers of two gears in mesh with given tooth counts, both positive."""
    first, second = counts
    index_1, index_2 = np.arange(first), np.arange(second)
    drive = np.pi - FULL_TURN * index_1 / first
    late = drive < -1e-9
    meeting = np.where(late, index_1 - first, index_1)
    driven_tooth = np.pi - FULL_TURN * index_2 / second
    half_1, half_2 = np.pi / first, np.pi / second
    phases = np.mod(drive, FULL_TURN), np.mod(driven_tooth - half_2, FULL_TURN)
    teeth = np.mod(drive - half_1, FULL_TURN), np.mod(driven_tooth - 2.0 * half_2, FULL_TURN)
    space_1, space_2, tooth_1, tooth_2 = (
        np.where(phase > FULL_TURN - 1e-9, 0.0, phase) for phase in (*phases, *teeth)
    )
    return Numbering(
        space_phases=(space_1, space_2),
        tooth_phases=(tooth_1, tooth_2),
        nodes=(index_1.astype(np.int64), (first + index_2).astype(np.int64)),
        ratios=(1.0, first / second),
        met_spaces=np.mod(meeting, second).astype(np.int64),
        partner_shift=first % second,
    )
