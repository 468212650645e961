"""Deformation of elastic bearings and gears under all lateral films, and the loads on them."""

from __future__ import annotations

import itertools
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from typing import TYPE_CHECKING, final

import numpy as np
import scipy.sparse as sp

from toothspace.core.compiled import njit
from toothspace.core.errors import CaseError
from toothspace.core.types import Array, IntArray
from toothspace.elasticity import ElasticBody, InfluenceMatrix, influence_matrix
from toothspace.elasticity.influence import COARSER
from toothspace.floating.face_grid import BasisFunctions, FaceGrid
from toothspace.floating.stack import BackPressure, Snapshot, StackState
from toothspace.model.description import MachineDescription
from toothspace.model.floating_bearing import BodyLoad, LateralBalance
from toothspace.numerics.parallel import in_parallel

_PROBE = 1e6
"""Pressure by which the local part of the deformation is identified. [Pa]"""

_PROBE_WAVES = 16
"""Waves of that pressure round a face: about the finest basis functions whose response is known.

Finer ones, to which faces are stiffer, are iterated.
"""

_KEPT = 8
"""Shaft angles whose interpolation and loads are kept. [-]"""

_BODY_ROWS = 5760
"""Least number of rows round a turning body between which its deformation is interpolated. [-]"""

NamedLoads = Callable[[Snapshot], Mapping[str, Mapping[str, float]]]
"""Named loads of every body in a snapshot, above the low pressure. [Pa] or [N]"""


@final
@dataclass(frozen=True, eq=False)
class ElasticFaces:
    """Deformation of the gaps by bearings and gears that bend, compress and bulge.

    Notes
    -----
    The film follows the local part within its own iteration, the distant part is
    brought to agreement by the iteration of the force balance.
    """

    grids: tuple[FaceGrid, ...]
    """One per film."""
    bodies: Mapping[str, InfluenceMatrix]
    """Bearings, or their parts, by the names that the films have for them, with the film ``face``
    in the machine frame; the turning bodies by name with the films ``floating`` and ``solid`` in
    their own frame.
    """
    named_loads: NamedLoads
    """What acts on the bodies besides the films, by snapshot."""
    local: tuple[float, ...]
    """Part of the deformation that follows the pressure at the same place, by film. [m/Pa]"""
    _on_bearing: dict[int, sp.csr_matrix] = field(init=False, repr=False, default_factory=dict)
    _on_body: dict[tuple[int, float], sp.csr_matrix] = field(
        init=False, repr=False, default_factory=dict
    )
    _named: list[tuple[Snapshot, Mapping[str, Mapping[str, float]]]] = field(
        init=False, repr=False, default_factory=list
    )
    _turning: dict[int, sp.csr_matrix] = field(init=False, repr=False, default_factory=dict)

    def distant(self, pressures: Sequence[Array], snapshot: Snapshot) -> list[Array]:
        """Distant deformation of every gap [m] under pressures above the low one. [Pa]."""
        whole = self.deformation(pressures, snapshot)
        return [own - share * p for own, p, share in zip(whole, pressures, self.local, strict=True)]

    def gain(
        self, changes: Sequence[Array], snapshot: Snapshot, basis: Sequence[BasisFunctions]
    ) -> Array:
        """Coefficients of the distant part of the deformation per change of pressure. [m/Pa].

        Parameters
        ----------
        changes : sequence of ndarray
            Changes of the pressure of every film, shape (n, rows, lanes), zero beside the film.
        """
        films, size = range(len(self.grids)), self.grids[0].area.size
        ends = np.cumsum([0, *map(len, changes)])
        spans = [slice(int(a), int(b)) for a, b in itertools.pairwise(ends)]
        loads = {name: np.zeros((len(b.nodes), ends[-1])) for name, b in self.bodies.items()}
        for k, felt in enumerate(self._nodal_loads(changes, snapshot)):
            for load, (name, nodes, _) in zip(felt, self._faces(k, snapshot), strict=True):
                loads[name][nodes, spans[k]] += load
        moved = {name: self.bodies[name].compliance @ load for name, load in loads.items()}

        def opened(k: int) -> Array:
            own = np.zeros((basis[k].count, int(ends[-1])))
            for name, nodes, spread in self._faces(k, snapshot):
                own += basis[k].fit_rows(spread.T).T @ moved[name][nodes]
            own[:, spans[k]] -= self.local[k] * np.array([basis[k].fit(c) for c in changes[k]]).T
            return own

        return np.vstack(in_parallel(opened, films, size))

    def _nodal_loads(
        self, pressures: Sequence[Array], snapshot: Snapshot
    ) -> Sequence[tuple[Array, Array]]:
        """Loads on the nodes of bearing and turning body, one column per pressure, by film. [N]."""

        def felt(k: int) -> tuple[Array, Array]:
            bearing, body = self._kept_spread(k, snapshot.shaft_angle)
            mask, push = snapshot.masks[k], pressures[k] * self.grids[k].area
            on_bearing, on_body = (
                np.where(part, push, 0.0).reshape(len(push), -1).T
                for part in (mask.owned, mask.covered)
            )
            return bearing.T @ on_bearing, body.T @ on_body

        return in_parallel(felt, range(len(self.grids)), self.grids[0].area.size)

    def _faces(self, index: int, snapshot: Snapshot) -> list[tuple[str, slice, sp.csr_matrix]]:
        """Bearing and turning body at a film: name, nodes, and from the nodes to the cells."""
        bearing, body = self._kept_spread(index, snapshot.shaft_angle)
        own = self.grids[index].interface
        return [
            (own.bearing, self.bodies[own.bearing].of("face"), bearing),
            (own.body, self.bodies[own.body].of(own.side), body),
        ]

    def deformation(self, pressures: Sequence[Array], snapshot: Snapshot) -> list[Array]:
        """Deformation of every gap by all bodies. [m]."""
        loads, named = self._film_loads(pressures, snapshot), self._kept_loads(snapshot)
        moved = {
            name: body.deformation(loads[name], named.get(name))
            for name, body in self.bodies.items()
        }

        def opening(k: int) -> Array:
            parts = [
                spread @ moved[name][nodes] for name, nodes, spread in self._faces(k, snapshot)
            ]
            return np.asarray(sum(parts)).reshape(self.grids[k].area.shape)

        return list(in_parallel(opening, range(len(self.grids)), self.grids[0].area.size))

    def resultants(self, pressures: Sequence[Array], snapshot: Snapshot) -> dict[str, Array]:
        """Force and moment of all loads on every body about its centre of mass. [N, N m].

        A body in equilibrium on nothing but its films and its named loads has none; what is left
        accelerates it, see :func:`~toothspace.elasticity.influence`.
        """
        loads, named = self._film_loads(pressures, snapshot), self._kept_loads(snapshot)
        return {
            name: body.resultant(loads[name], named.get(name)) for name, body in self.bodies.items()
        }

    def mesh_error(self, pressures: Sequence[Array], snapshot: Snapshot) -> list[Array]:
        """Error of the deformation of every gap by the size of the elements of all bodies. [m].

        Notes
        -----
        Difference to bodies with elements smaller by ``COARSER`` on the same film nodes, and
        what is missing beyond them by an error of second order (Richardson).
        """
        finer = {
            name: influence_matrix(body.body, estimate_error=False, scale=1.0 / COARSER)
            for name, body in self.bodies.items()
        }
        better = replace(self, bodies=finer).deformation(pressures, snapshot)
        share = 1.0 / (1.0 - COARSER**-2)
        here = self.deformation(pressures, snapshot)
        return [share * (a - b) for a, b in zip(here, better, strict=True)]

    def _film_loads(self, pressures: Sequence[Array], snapshot: Snapshot) -> dict[str, Array]:
        """Loads of all films on the nodes of all bodies. [N]."""
        loads = {name: np.zeros(len(body.nodes)) for name, body in self.bodies.items()}
        for k, felt in enumerate(self._nodal_loads([p[None] for p in pressures], snapshot)):
            for load, (name, nodes, _) in zip(felt, self._faces(k, snapshot), strict=True):
                loads[name][nodes] += load[:, 0]
        return loads

    def _kept_loads(self, snapshot: Snapshot) -> Mapping[str, Mapping[str, float]]:
        """Named loads, kept for the next iterations with the same snapshots."""
        kept = next((loads for own, loads in self._named if own is snapshot), None)
        if kept is None:
            kept = self.named_loads(snapshot)
            self._named[_KEPT:] = []
            self._named.insert(0, (snapshot, kept))
        return kept

    def _kept_spread(self, index: int, shaft_angle: float) -> tuple[sp.csr_matrix, sp.csr_matrix]:
        """From the nodes of bearing and turning body to the cells.

        That of the body lies between rows of a grid that turns with it, and is kept for the next
        iterations at the angles used last.
        """
        if index not in self._on_bearing:
            grid = self.grids[index]
            own, p, (x0, y0) = grid.interface, grid.points, grid.interface.face.center
            placed = np.column_stack([p.x.ravel() + x0, p.y.ravel() + y0])
            self._on_bearing[index] = self.bodies[own.bearing].interpolation("face", placed)
        key = self._twin(index), shaft_angle
        spread = self._on_body.get(key)
        if spread is None:
            if len(self._on_body) >= _KEPT * len(self.grids):
                self._on_body.clear()
            spread = self._on_body[key] = self._body_spread(key[0], shaft_angle)
        return self._on_bearing[index], spread

    def _twin(self, index: int) -> int:
        """First film whose cells lie alike to like nodes of the same turning body."""
        own = self.grids[index]
        for k, grid in enumerate(self.grids[:index]):
            one, other = grid.interface, own.interface
            alike = (one.body, one.lead) == (other.body, other.lead)
            if alike and np.array_equal(grid.points.x, own.points.x):
                body = self.bodies[own.interface.body]
                first, second = body.of(grid.interface.side), body.of(own.interface.side)
                if np.array_equal(body.nodes[first], body.nodes[second]):
                    return k
        return index

    def _body_spread(self, index: int, shaft_angle: float) -> sp.csr_matrix:
        grid = self.grids[index]
        own = grid.interface
        finer = -(-_BODY_ROWS // grid.rows)
        rows = finer * grid.rows
        if index not in self._turning:
            angle = (np.arange(rows) + 0.5) * 2.0 * np.pi / rows
            radius = np.tile(grid.radius, rows)
            places = np.column_stack([np.cos(angle), np.sin(angle)]).repeat(grid.lanes, axis=0)
            spread = self.bodies[own.body].interpolation(own.side, places * radius[:, None])
            self._turning[index] = spread
        spread = self._turning[index]
        turn = own.body_angle + own.speed_ratio * (shaft_angle + own.lead)
        first = 0.5 * (finer - 1) - turn * rows / (2.0 * np.pi)
        given = spread.indices.reshape(rows, grid.lanes, -1)
        columns = np.empty((rows // finer, grid.lanes, 2 * given.shape[2]), dtype=given.dtype)
        weights = np.empty(columns.shape)
        _between_rows(given, spread.data.reshape(given.shape), first, columns, weights)
        starts = np.arange(grid.area.size + 1, dtype=np.int32) * columns.shape[2]
        shape = grid.area.size, spread.shape[1]
        return sp.csr_matrix((weights.ravel(), columns.ravel(), starts), shape=shape)


@njit(nogil=True)
def _between_rows(
    columns: IntArray, weights: Array, first: float, out: IntArray, values: Array
) -> None:
    """Fill rows of an interpolation between those of a ring, even from a broken row on."""
    ring, lanes, width = weights.shape
    rows, start = len(out), int(np.floor(first))
    share, stride = first - start, ring // rows
    for i in range(rows):
        a = (start + i * stride) % ring
        b = (a + 1) % ring
        for j in range(lanes):
            for k in range(width):
                out[i, j, k], values[i, j, k] = columns[a, j, k], (1.0 - share) * weights[a, j, k]
                out[i, j, width + k] = columns[b, j, k]
                values[i, j, width + k] = share * weights[b, j, k]


def elastic_faces(
    grids: tuple[FaceGrid, ...],
    bodies: Mapping[str, ElasticBody],
    named_loads: NamedLoads | None = None,
) -> ElasticFaces:
    """Condense the bodies, or take them from the cache, and split off the local part.

    Raises GeometryError if a body cannot be meshed or condensed.

    Parameters
    ----------
    grids : tuple of FaceGrid
        One per film.
    bodies : mapping of str to ElasticBody
        Bearings and turning bodies, see :class:`ElasticFaces`.
    named_loads : callable, optional
        What acts on the bodies besides the films, by snapshot; nothing if not given.
    """
    matrices = {name: influence_matrix(body, estimate_error=False) for name, body in bodies.items()}
    faces = ElasticFaces(grids, matrices, _unloaded, (0.0,) * len(grids))
    snapshot = Snapshot(0.0, tuple(grid.mask(0.0) for grid in grids), np.zeros(0))
    # deformation over pressure, where the pressure goes up and down round the face
    local = []
    for k in range(len(grids)):
        grid = faces.grids[k]
        probe = [np.zeros_like(g.area) for g in faces.grids]
        wave = np.cos(_PROBE_WAVES * grid.angle)[:, None] * np.ones(grid.lanes)
        probe[k] = _PROBE * wave
        found = faces.deformation(probe, snapshot)[k]
        one = float((found * wave * grid.area).sum() / (wave**2 * grid.area).sum()) / _PROBE
        local.append(one)
    return ElasticFaces(grids, matrices, named_loads or _unloaded, tuple(local))


def _unloaded(snapshot: Snapshot) -> Mapping[str, Mapping[str, float]]:
    return {}


if TYPE_CHECKING:
    import xarray as xr

_KEPT_ANGLES = 32
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
    thrust: Callable[[float], Array] | None = None
    """Axial forces with which a helix pushes the turning bodies at a shaft angle. [N]"""

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
        if load.source == "thrust":
            assert self.thrust is not None
            total, body = float(contacts.sum()), list(self.frames).index(load.body)
            push = float(self.thrust(snapshot.shaft_angle)[body])
            return push * float(contacts[load.index]) / total if total > 0.0 else 0.0
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
    description: MachineDescription,
    balance: LateralBalance,
    grids: tuple[FaceGrid, ...],
    back: BackPressure,
    data: xr.Dataset,
) -> ElasticFaces:
    """Elastic bodies of a machine under the loads of a lumped solution.

    Raises CaseError if the machine has no elastic bodies, or bearings that rest; GeometryError if a
    body cannot be meshed or condensed.

    Parameters
    ----------
    description : MachineDescription
        The machine, whose first contacts are those of the loaded flanks.
    balance : LateralBalance
        Bodies and what acts on them.
    grids : tuple of FaceGrid
        One per film.
    back : BackPressure
        Pressures behind the bearing.
    data : xarray.Dataset
        Samples of one revolution.
    """
    if balance.elastic_bodies is None or balance.arrangement == "fixed":
        raise CaseError("run.deformation", "'bodies'", "'winkler' or 'none' here")
    made = balance.elastic_bodies()
    bodies = {name: body for name, body in made.items() if isinstance(body, ElasticBody)}
    frames = {i.body: (i.body_angle, i.speed_ratio) for i in balance.interfaces}
    at_angle = lru_cache(_KEPT_ANGLES)(balance.elastic_bodies.loads)
    journals = _over_a_turn(data, data["journal_force"].values[:, :, :2])
    contacts = _over_a_turn(data, flank_forces(description, data))
    loads = BodyLoads(at_angle, back, journals, contacts, frames, axial_forces(data))
    return elastic_faces(grids, bodies, loads)


def flank_forces(description: MachineDescription, data: xr.Dataset) -> Array:
    """Forces of the loaded flanks, shape (samples, flanks); slices of one flank together. [N]."""
    pair, winding = description.contacts[0], description.winding
    flanks = pair.count if winding is None else winding.section.contacts[0].count
    forces = data["contact_force"].values[:, : pair.count]
    return np.asarray(forces.reshape(len(forces), -1, flanks).sum(axis=1))


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


def axial_forces(data: xr.Dataset) -> Callable[[float], Array] | None:
    """Axial forces of a helix on all bodies over the shaft angle; None with straight teeth. [N]."""
    return _over_a_turn(data, data["axial_force"].values) if "axial_force" in data else None


def node_pressures(
    description: MachineDescription, balance: LateralBalance, data: xr.Dataset
) -> Callable[[float], Array]:
    """Pressures of all nodes over the shaft angle, periodic with the revolution. [Pa].

    Where tooth spaces are more than one chamber, those of the middle section, then those of the
    sections at the ends that films look at, each with the ports.
    """
    pressure, angle = data["chamber_pressure"].values, data["shaft_angle"].values
    leads = {0: 0.0, **{i.first_node: i.lead for i in balance.interfaces}}
    held = [pressure]
    if description.parts_spaces:
        held = [
            np.array(
                [
                    row[description.chambers_in_section(float(a), leads[first])]
                    for row, a in zip(pressure, angle, strict=True)
                ]
            )
            for first in sorted(leads)
        ]
    inlet = float(data["inlet_pressure"].mean())
    outlet = float(data["outlet_pressure"].mean())
    ports = {"inlet": inlet, "outlet": outlet, "external": description.drain_pressure}
    rest = np.array([inlet, outlet, ports[description.drain]])
    chambers = [_over_a_turn(data, own) for own in held]
    return lambda shaft_angle: np.concatenate(
        [part for own in chambers for part in (own(shaft_angle), rest)]
    )


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
