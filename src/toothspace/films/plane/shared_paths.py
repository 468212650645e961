"""Flow paths through the films beside bodies that share covers, from solved conductances."""

from __future__ import annotations

from dataclasses import dataclass
from typing import final

import numpy as np

from toothspace.core.types import Array, IntArray
from toothspace.films.plane.conductance import FaceConductance, gap_table, over_turn
from toothspace.model.description import FlowPath
from toothspace.model.film_faces import SharedFaces
from toothspace.model.path_category import DRAIN, LATERAL, RIM, PathCategory

_LEAST = 0.01
"""Share of the largest conductance below which the films between two edges are left out. [-]"""


@final
@dataclass(frozen=True)
class _Edges:
    """Edges of the films with their nodes, one per chamber."""

    number: IntArray
    node: IntArray


def shared_paths(
    faces: SharedFaces, films: tuple[FaceConductance, ...], height: float
) -> list[FlowPath]:
    """Paths between all edges of the films at shared covers.

    Parameters
    ----------
    faces : SharedFaces
        What the covers share; the chamber of the rim is the first of its sectors.
    films : tuple of FaceConductance
        Films before the covers.
    height : float
        Gap of the paths; unequal gaps of the covers enter with their cubes. [m]

    Returns
    -------
    list of FlowPath
        Between neighbouring chambers; from chambers to recesses, to the inner node and to the
        rim; from recesses to each other, to the inner node and to the rim.
    """
    return _Paths(faces, films, height).all()


class _Paths:
    def __init__(
        self, faces: SharedFaces, films: tuple[FaceConductance, ...], height: float
    ) -> None:
        self.face, self.rim, self.height = faces.face, faces.rim, height
        self.turn = films[0].turn
        weight = [(cover.gap / height) ** 3 for cover in faces.covers]
        parts = [w * film.matrix for w, film in zip(weight, films, strict=True)]
        self.shape = -np.sum(parts, axis=0)
        face, self.count = self.face, self.face.chambers.nodes.size
        self.chambers = _Edges(np.arange(self.count), face.chambers.nodes)
        self.inner = self._same(self.count + face.recesses.size, face.inner_node)
        self.recesses = [
            self._same(self.count + k, node) for k, node in enumerate(face.recesses.tolist())
        ]

    def all(self) -> list[FlowPath]:
        """Every path."""
        chambers, ahead = self.chambers, np.roll(np.arange(self.count), -1)
        next_ones = _Edges(ahead, chambers.node[ahead])
        found = [
            self._turning(("lateral", LATERAL), chambers, next_ones),
            self._turning(("drain", DRAIN), chambers, self.inner),
        ]
        for k, recess in enumerate(self.recesses):
            found.append(self._turning((f"lateral_recess_{k}", LATERAL), chambers, recess))
            found.append(self._resting((f"drain_recess_{k}", DRAIN), recess, self.inner))
            found += [
                self._resting((f"lateral_recesses_{j}_{k}", LATERAL), self.recesses[j], recess)
                for j in range(k)
            ]
        return [*found, *self._to_rim()]

    def _to_rim(self) -> list[FlowPath]:
        """From chambers and recesses to the rim, one path for each sector of a pitch."""
        found = []
        per_pitch, first = self.face.sectors, self.rim.chamber
        edges = self.inner.number[0] + 1
        phases = self.face.sector_phases
        for j in range(-per_pitch, 2 * per_pitch):
            sector = np.mod(np.arange(self.count) * per_pitch + j, phases.size)
            rim = _Edges(edges + sector, self.inner.node if self.rim.open_ends else first + sector)
            found.append(self._turning((f"rim_{j}", RIM), self.chambers, rim))
            if 0 <= j < per_pitch:
                found += [
                    self._turning((f"rim_{j}_recess_{k}", RIM), rim, recess, phases[sector])
                    for k, recess in enumerate(self.recesses)
                ]
        largest = max(_shape(path).max() for path in found)
        return [path for path in found if _shape(path).max() > _LEAST * largest]

    def _same(self, number: int, node: int) -> _Edges:
        return _Edges(np.full(self.count, number), np.full(self.count, node))

    def _turning(
        self, label: tuple[str, PathCategory], a: _Edges, b: _Edges, phases: Array | None = None
    ) -> FlowPath:
        """Path for every chamber, over its table angle."""
        phases = self.face.chambers.phases if phases is None else phases
        shape = over_turn(self.shape[:, a.number, b.number], phases, self.turn)
        return self._path(label, (a.node, b.node), phases, shape)

    def _resting(self, label: tuple[str, PathCategory], a: _Edges, b: _Edges) -> FlowPath:
        """Path between edges that rest: the same after every pitch."""
        shape = np.tile(self.shape[:, a.number[0], b.number[0]], self.count)
        return self._path(label, (a.node[:1], b.node[:1]), np.zeros(1), shape)

    def _path(
        self,
        label: tuple[str, PathCategory],
        nodes: tuple[IntArray, IntArray],
        phases: Array,
        shape: Array,
    ) -> FlowPath:
        return FlowPath(
            name=label[0],
            category=label[1],
            kind="parallel_gap",
            nodes_a=nodes[0],
            nodes_b=nodes[1],
            angle_ratio=self.face.chambers.angle_ratio,
            phases=phases,
            geometry=gap_table(self.height, shape),
        )


def _shape(path: FlowPath) -> Array:
    return np.asarray(path.geometry.values[:, 1] / path.geometry.values[:, 2])
