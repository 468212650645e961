"""Deformation of elastic bearings and gears under the pressures of all lateral films."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from typing import final

import numpy as np
import scipy.sparse as sp

from toothspace.core.types import Array
from toothspace.elasticity import ElasticBody, InfluenceMatrix, influence_matrix
from toothspace.films.lateral_gap.faces import FaceGrid, Mask
from toothspace.films.lateral_gap.stack import Scene

_PROBE = 1e6
"""Pressure that the local part of the deformation is told with. [Pa]"""

_LOCAL_MARGIN = 1.5
"""Local part over the mean of the probe: rims give way more, and the rest must not exceed it."""

_KEPT = 4
"""Shaft angles whose interpolation is kept. [-]"""

MEMORY = 8
"""Iterations from which the rest and the positions are foreseen. [-]"""


@final
@dataclass(frozen=True, eq=False)
class ElasticFaces:
    """Widening of the gaps by bearings and gears that bend, compress and bulge.

    Parameters
    ----------
    grids : tuple of FaceGrid
        One per film.
    bodies : mapping of str to InfluenceMatrix
        Bearings ``floating`` and ``solid`` with the film ``face`` in the machine frame, and the
        turning bodies by name with the films ``floating`` and ``solid`` in their own frame.
    back_loads : mapping of str to float
        Named loads of the pressed bearing, above the low pressure. [Pa] or [N]
    local : tuple of float
        Part of the widening that follows the pressure at the same place, by film. [m/Pa]

    Notes
    -----
    Only pressures on the faces and behind the bearing deform; pressures in the tooth spaces and
    forces of the journals do not. The film follows the local part within its own iteration, the
    rest is brought to agreement by the iteration of the force balance.
    """

    grids: tuple[FaceGrid, ...]
    bodies: Mapping[str, InfluenceMatrix]
    back_loads: Mapping[str, float]
    local: tuple[float, ...]
    _spreads: dict[tuple[int, float], tuple[sp.csr_matrix, sp.csr_matrix]] = field(
        init=False, repr=False, default_factory=dict
    )

    def distant(self, pressures: Sequence[Array], scene: Scene) -> list[Array]:
        """Rest of the widening of every gap [m] under pressures above the low one. [Pa]."""
        whole = self.widening(pressures, scene)
        found = []
        for own, p, share in zip(whole, pressures, self.local, strict=True):
            found.append(own - share * p)
        return found

    def widening(self, pressures: Sequence[Array], scene: Scene) -> list[Array]:
        """Widening of every gap by all bodies. [m]."""
        spread = [self._kept_spread(k, scene.shaft_angle) for k in range(len(self.grids))]
        loads = {name: np.zeros(len(body.nodes)) for name, body in self.bodies.items()}
        for grid, p, mask, maps in zip(self.grids, pressures, scene.masks, spread, strict=True):
            side, body = grid.interface.side, grid.interface.body
            on_bearing, on_body = self._cell_loads(grid, p, mask)
            loads[side][self.bodies[side].of("face")] += maps[0].T @ on_bearing
            loads[body][self.bodies[body].of(side)] += maps[1].T @ on_body
        moved = {name: self._moved(name, loads[name]) for name in self.bodies}
        found = []
        for grid, (bearing, body) in zip(self.grids, spread, strict=True):
            side, name = grid.interface.side, grid.interface.body
            opening = bearing @ moved[side][self.bodies[side].of("face")]
            opening = opening + body @ moved[name][self.bodies[name].of(side)]
            found.append(np.asarray(opening).reshape(grid.area.shape))
        return found

    def _moved(self, name: str, loads: Array) -> Array:
        named = self.back_loads if name == "floating" else {}
        return self.bodies[name].deformation(loads, named)

    def _cell_loads(self, grid: FaceGrid, pressure: Array, mask: Mask) -> tuple[Array, Array]:
        """Loads of all cells on the bearing and on the turning body. [N]."""
        push = pressure * grid.area
        on_bearing = np.where(mask.cells.owned, push, 0.0)
        return on_bearing.ravel(), np.where(mask.cells.covered, push, 0.0).ravel()

    def _kept_spread(self, index: int, shaft_angle: float) -> tuple[sp.csr_matrix, sp.csr_matrix]:
        """Spread at an angle, kept for the next iterations at the angles used last."""
        key = index, shaft_angle
        if key not in self._spreads:
            if len(self._spreads) >= _KEPT * len(self.grids):
                self._spreads.clear()
            self._spreads[key] = self._spread(self.grids[index], shaft_angle)
        return self._spreads[key]

    def _spread(self, grid: FaceGrid, shaft_angle: float) -> tuple[sp.csr_matrix, sp.csr_matrix]:
        """From the nodes of bearing and turning body to the cells."""
        own = grid.interface
        x, y = grid.points.x.ravel(), grid.points.y.ravel()
        turn = own.body_angle + own.speed_ratio * shaft_angle
        cos, sin = np.cos(turn), np.sin(turn)
        turned = np.column_stack([cos * x + sin * y, cos * y - sin * x])
        placed = np.column_stack([x + own.center[0], y + own.center[1]])
        bearing = self.bodies[own.side].interpolation("face", placed)
        return bearing, self.bodies[own.body].interpolation(own.side, turned)


def elastic_faces(
    grids: tuple[FaceGrid, ...],
    bodies: Mapping[str, ElasticBody],
    back_loads: Mapping[str, float],
) -> ElasticFaces:
    """Condense the bodies, or take them from the cache, and split off the local part.

    Parameters
    ----------
    grids : tuple of FaceGrid
        One per film.
    bodies : mapping of str to ElasticBody
        Bearings and turning bodies, see :class:`ElasticFaces`.
    back_loads : mapping of str to float
        Named loads of the pressed bearing, above the low pressure. [Pa] or [N]

    Raises
    ------
    GeometryError
        If a body cannot be meshed or condensed.
    """
    matrices = {name: influence_matrix(body, estimate_error=False) for name, body in bodies.items()}
    faces = ElasticFaces(grids, matrices, {}, (0.0,) * len(grids))
    scene = Scene(0.0, tuple(grid.mask(0.0) for grid in grids), np.zeros(0))
    local = tuple(_local_part(faces, scene, k) for k in range(len(grids)))
    return ElasticFaces(grids, matrices, dict(back_loads), local)


def _local_part(faces: ElasticFaces, scene: Scene, index: int) -> float:
    """Widening over pressure, as a mean over one half of a face under pressure. [m/Pa]."""
    grid = faces.grids[index]
    probe = [np.zeros_like(g.area) for g in faces.grids]
    pressed = scene.masks[index].film & (grid.points.x > 0.0)
    probe[index] = np.where(pressed, _PROBE, 0.0)
    area = np.where(pressed, grid.area, 0.0)
    mean = float((faces.widening(probe, scene)[index] * area).sum() / area.sum())
    return _LOCAL_MARGIN * mean / _PROBE
