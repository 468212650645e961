"""Loads of a lumped solution on faces and elastic bodies over the shaft angle."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import lru_cache
from typing import TYPE_CHECKING, final

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.types import Array
from toothspace.elasticity import ElasticBody
from toothspace.floating.elastic_faces import ElasticFaces, elastic_faces
from toothspace.floating.face_grid import FaceGrid
from toothspace.floating.stack import BackPressure, Snapshot, StackState
from toothspace.model.description import MachineDescription
from toothspace.model.floating_bearing import BodyLoad, LateralBalance

if TYPE_CHECKING:
    import xarray as xr

_KEPT = 32
"""Shaft angles whose loads are kept. [-]"""
_COMPONENTS = {"journal_x": 0, "journal_y": 1}


@final
@dataclass(frozen=True, eq=False)
class BodyLoads:
    """Named loads of elastic bodies by snapshot, above the low pressure."""

    loads: Callable[[float], tuple[BodyLoad, ...]]
    """What the loads follow at a shaft angle; those of one name add up."""
    back: BackPressure
    """Pressures behind the bearing."""
    journal_force: Callable[[float], Array]
    """Forces of the journal bearings on the turning bodies at a shaft angle, in the machine frame,
    shape (bodies, 2). [N]
    """
    contact_force: Callable[[float], Array]
    """Forces of all contacts between turning bodies at a shaft angle. [N]"""
    frames: Mapping[str, tuple[float, float]]
    """Angle [rad] at shaft angle zero and speed ratio of the frames that turn, by body."""

    def __call__(self, snapshot: Snapshot) -> dict[str, dict[str, float]]:
        """Sizes of the loads by body and name. [Pa] or [N]."""
        angle = snapshot.shaft_angle
        forces = self.journal_force(angle), self.contact_force(angle)
        found: dict[str, dict[str, float]] = {}
        for load in self.loads(angle):
            own = found.setdefault(load.body, {})
            size = load.factor * self._followed(load, snapshot, *forces)
            own[load.load] = own.get(load.load, 0.0) + size
        return found

    def _followed(
        self, load: BodyLoad, snapshot: Snapshot, journals: Array, contacts: Array
    ) -> float:
        low = self.back.low
        if load.source == "contact":
            return float(contacts[load.index])
        if load.source == "contact_share":
            total = float(contacts.sum())
            return float(contacts[load.index]) / total if total > 0.0 else 0.0
        if load.source == "node":
            return float(snapshot.node_pressure[load.index]) - low
        if load.source in _COMPONENTS:
            angle, ratio = self.frames.get(load.body, (0.0, 0.0))
            turn = angle + ratio * snapshot.shaft_angle
            x, y = journals[load.index]
            turned = (np.cos(turn) * x + np.sin(turn) * y, np.cos(turn) * y - np.sin(turn) * x)
            return float(turned[_COMPONENTS[load.source]])
        return {"high": self.back.high - low, "nose": self.back.nose - low}.get(load.source, 1.0)


def loaded_bodies(
    balance: LateralBalance, grids: tuple[FaceGrid, ...], back: BackPressure, data: xr.Dataset
) -> ElasticFaces:
    """Elastic bodies of a machine under the loads of a lumped solution.

    Parameters
    ----------
    balance : LateralBalance
        Bodies and what acts on them.
    grids : tuple of FaceGrid
        One per film.
    back : BackPressure
        Pressures behind the bearing.
    data : xarray.Dataset
        Samples of one revolution.

    Raises
    ------
    CaseError
        If the machine has no elastic bodies.
    GeometryError
        If a body cannot be meshed or condensed.
    """
    if balance.elastic_bodies is None:
        raise CaseError("run.deformation", "'bodies'", "'winkler' or 'none' here")
    made = balance.elastic_bodies()
    bodies = {name: body for name, body in made.items() if isinstance(body, ElasticBody)}
    frames = {i.body: (i.body_angle, i.speed_ratio) for i in balance.interfaces}
    at_angle = lru_cache(_KEPT)(balance.elastic_bodies.loads)
    journals = _over_a_turn(data, data["journal_force"].values[:, :, :2])
    contacts = _over_a_turn(data, data["contact_force"].values)
    loads = BodyLoads(at_angle, back, journals, contacts, frames)
    return elastic_faces(grids, bodies, loads)


def face_deflection(state: StackState) -> dict[str, float]:
    """Largest deformation of the gaps between elastic bodies and its error by their meshes. [m].

    Empty where faces are Winkler foundations or not at all. The first call for a body condenses it
    on a finer mesh as well, which is kept on disk.
    """
    faces = state.stack.compliance
    if not isinstance(faces, ElasticFaces):
        return {}
    low = float(state.snapshot.node_pressure[state.stack.balance.low_node])
    pressures = state.face_pressures(low)
    wide = faces.deformation(pressures, state.snapshot)
    error = faces.mesh_error(pressures, state.snapshot)

    def largest(fields: list[Array]) -> float:
        pairs = zip(fields, state.snapshot.masks, strict=True)
        return max(float(np.abs(field[mask.film]).max()) for field, mask in pairs)

    return {"film_deformation_largest": largest(wide), "film_deformation_error": largest(error)}


def node_pressures(description: MachineDescription, data: xr.Dataset) -> Callable[[float], Array]:
    """Pressures of all nodes over the shaft angle, periodic with the revolution. [Pa]."""
    chambers = _over_a_turn(data, data["chamber_pressure"].values)
    inlet = float(data["inlet_pressure"].mean())
    outlet = float(data["outlet_pressure"].mean())
    ports = {"inlet": inlet, "outlet": outlet, "external": description.drain_pressure}
    rest = np.array([inlet, outlet, ports[description.drain]])
    return lambda shaft_angle: np.concatenate([chambers(shaft_angle), rest])


def _over_a_turn(data: xr.Dataset, values: Array) -> Callable[[float], Array]:
    """Values between the samples of one revolution, periodic with the shaft angle."""
    turn = 2.0 * np.pi
    angle = np.mod(data["shaft_angle"].values - data["shaft_angle"].values[0], turn)
    first = float(np.mod(data["shaft_angle"].values[0], turn))
    keep = np.unique(np.round(angle, 9), return_index=True)[1]
    knots = np.append(angle[keep], turn)
    table = np.concatenate([values[keep], values[keep[:1]]])

    def at(shaft_angle: float) -> Array:
        place = np.mod(shaft_angle - first, turn)
        k = min(int(np.searchsorted(knots, place, side="right")) - 1, knots.size - 2)
        share = (place - knots[k]) / (knots[k + 1] - knots[k])
        return np.asarray((1.0 - share) * table[k] + share * table[k + 1])

    return at
