"""What the port timing does to a pocket: openings, sealed spans, pockets that join the ports."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.types import Array
from toothspace.machines.gerotor.pockets import FULL_TURN, Pockets
from toothspace.machines.gerotor.ports import Ports, openings

_CLOSED_AREA = 0.02e-6


@final
@dataclass(frozen=True)
class Timing:
    """Openings of a pocket over its place."""

    inlet: Array
    outlet: Array
    """Area [m2] and hydraulic diameter [m] of the opening to each port. Shape (n, 2)."""

    @property
    def joined_area(self) -> float:
        """Largest area through which one pocket joins both ports. [m2]."""
        return float(np.minimum(self.inlet[:, 0], self.outlet[:, 0]).max())

    def sealed_spans(self) -> list[slice]:
        """Runs of table nodes at which a pocket is open to neither port.

        Returns
        -------
        list of slice
            Runs in nodes counted from half a turn before the smallest pocket, so that none is
            cut in two.
        """
        half = self.inlet.shape[0] // 2
        closed = (self.inlet[:, 0] < _CLOSED_AREA) & (self.outlet[:, 0] < _CLOSED_AREA)
        # the largest pocket may be sealed as well: begin where a port is wide open
        start = int(np.argmax(self.inlet[:, 0])) - half
        turned = np.roll(closed, -start)
        edges = np.flatnonzero(np.diff(np.concatenate([[False], turned, [False]]).astype(int)))
        return [
            slice(int(a) + start, int(b) + start)
            for a, b in zip(edges[::2], edges[1::2], strict=True)
        ]

    def sealed_angle(self, pocket: Pockets) -> float:
        """Longest shaft angle during which a pocket is open to neither port. [rad]."""
        longest = max((s.stop - s.start - 1 for s in self.sealed_spans()), default=0)
        return longest * FULL_TURN / pocket.place.size / pocket.angle_ratio

    def trapped_area(self, pocket: Pockets) -> float:
        """Largest change of a pocket's area while it is open to neither port. [m2]."""
        nodes = np.arange(pocket.place.size)
        changes = [
            np.ptp(pocket.area[np.take(nodes, np.arange(s.start, s.stop), mode="wrap")])
            for s in self.sealed_spans()
        ]
        return float(max(changes, default=0.0))


def timing_of(ports: Ports, pocket: Pockets) -> Timing:
    """Openings of a pocket to both ports."""
    return Timing(*(openings(ports, pocket, name) for name in ("inlet", "outlet")))
