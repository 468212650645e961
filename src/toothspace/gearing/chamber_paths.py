"""Flow paths of chambers in a ring: over the lands between them, and to one node."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any, final

import numpy as np

from toothspace.core.types import Array, IntArray
from toothspace.gearing.numbering import FULL_TURN
from toothspace.model.description import FlowPath
from toothspace.model.machine_parts import PathKind
from toothspace.model.path_category import PathCategory
from toothspace.numerics.periodic_table import monotone_table


@final
@dataclass(frozen=True, kw_only=True)
class ChamberPaths:
    """Chambers round one axis, numbered round it, and the lands between neighbours."""

    nodes: IntArray
    """Nodes of the chambers."""
    behind: IntArray
    ahead: IntArray
    """Nodes behind and ahead of every land in the sense of rotation."""
    angle_ratio: float
    """Growth of the places per shaft angle. [-]"""
    phases: Array
    land_phases: Array
    """Places of chambers and lands at shaft angle zero. [rad]"""

    def over_lands(
        self, name: str, category: PathCategory, geometry: Array, kind: PathKind = "parallel_gap",
        **other: Any,
    ) -> FlowPath:  # fmt: skip
        """Path over the lands, with its channels [SI] over the place, or one row of them.

        ``other`` are further fields of the path.
        """
        return FlowPath(
            name=name,
            category=category,
            kind=kind,
            nodes_a=self.behind,
            nodes_b=self.ahead,
            angle_ratio=self.angle_ratio,
            phases=self.land_phases,
            geometry=monotone_table(FULL_TURN, _over_place(geometry)),
            **other,
        )

    def to_node(
        self, name: str, category: PathCategory, geometry: Array, node: int,
        kind: PathKind = "parallel_gap", multiplicity: float = 1.0,
    ) -> FlowPath:  # fmt: skip
        """Path from every chamber to one node, its channels [SI] over the place, or one row."""
        return FlowPath(
            name=name,
            category=category,
            kind=kind,
            nodes_a=self.nodes,
            nodes_b=np.full_like(self.nodes, node),
            angle_ratio=self.angle_ratio,
            phases=self.phases,
            geometry=monotone_table(FULL_TURN, _over_place(geometry)),
            multiplicity=multiplicity,
        )


def _over_place(geometry: Array) -> Array:
    return np.tile(geometry, (4, 1)) if geometry.ndim == 1 else geometry
