r"""Film between elastic walls: gap and pressure solved together.

The gap opens by the deformation of the walls under the pressure of the film,

.. math::

    h = h_r(q) + S u, \quad u = C S^T A (p - p_r) + u_0,

with the nodal deformation :math:`u`, its interpolation :math:`S` to the cells, their areas
:math:`A` and rigid motions :math:`q` that are either given or found from
:math:`\int p\,\partial h/\partial q\,\mathrm dA + W = 0`.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple, final

import numpy as np
import scipy.sparse as sp

from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.elasticity.influence import InfluenceMatrix
from toothspace.films.plane.film import PlaneFilm, PlaneSolution, solve_plane
from toothspace.films.reynolds.equation import GapField
from toothspace.films.reynolds.rough_surfaces import ContactTable, contact_field
from toothspace.numerics.krylov import gmres
from toothspace.numerics.linear_system import PRESCRIBED


@final
@dataclass(frozen=True, eq=False)
class ElasticWalls:
    """Walls of a film: nodes, their compliance and their interpolation to the cells.

    Parameters
    ----------
    spread : csr_matrix, shape (cells, n)
        Opening of the cells per deformation of the nodes; cells in the order of the grid. [-]
    compliance : ndarray, shape (n, n)
        Deformation per nodal load, into the bodies. [m/N]
    offset : ndarray, shape (n,)
        Deformation by other loads than the film. [m]
    reference_pressure : float
        Absolute pressure at which the film does not deform the walls. [Pa]
    """

    spread: sp.csr_matrix
    compliance: Array
    offset: Array
    reference_pressure: float = 0.0


def elastic_walls(
    sides: Sequence[tuple[InfluenceMatrix, str, Array]], reference_pressure: float = 0.0
) -> ElasticWalls:
    """Walls made of film surfaces of bodies, one on each side or only one.

    Parameters
    ----------
    sides : sequence of tuple
        Influence matrix, name of its film surface, and the cell centres in the frame of the body,
        shape (cells, 2) or (cells, 3). [m]
    reference_pressure : float
        Absolute pressure at which the film does not deform the walls. [Pa]
    """
    spread = [matrix.interpolation(name, points) for matrix, name, points in sides]
    blocks = []
    for matrix, name, _ in sides:
        own = matrix.of(name)
        blocks.append(matrix.compliance[own, own])
    size = sum(len(block) for block in blocks)
    compliance, start = np.zeros((size, size)), 0
    for block in blocks:
        stop = start + len(block)
        compliance[start:stop, start:stop] = block
        start = stop
    return ElasticWalls(sp.hstack(spread).tocsr(), compliance, np.zeros(size), reference_pressure)


@final
@dataclass(frozen=True)
class Asperities:
    """Contact of rough walls. [m]."""

    roughness: float
    table: ContactTable


@final
@dataclass(frozen=True, kw_only=True)
class CouplingSettings:
    """Iteration of film and walls.

    Parameters
    ----------
    tolerance : float
        Change of the gap by one step over the gap, and load out of balance over the load. [-]
    max_steps : int
        Most Newton steps. [-]
    smallest_shrink : float
        Part to which one step may shrink the gap of a smooth film. [-]
    krylov_tolerance : float
        Accuracy of each Newton step. [-]
    """

    tolerance: float = 1e-6
    max_steps: int = 60
    smallest_shrink: float = 0.3
    krylov_tolerance: float = 1e-3


@final
@dataclass(frozen=True)
class ElasticFilmSolution:
    """Film with its deformed gap."""

    plane: PlaneSolution
    """Fields at the deformed gap."""
    contact: Array
    """Asperity pressure. [Pa]"""
    deformation: Array = field(repr=False)
    """Nodal deformation into the walls. [m]"""
    motion: Array
    """Rigid motions. [m, rad]"""
    load: Array
    """Generalised force of the film on every rigid motion. [N, N m]"""
    status: Status
    """Whether film, walls and loads agree."""
    steps: int
    """Newton steps. [-]"""
    linear_solves: int
    """Solutions of the linearised film. [-]"""
    change: float
    """Change of the gap by the last step over the gap. [-]"""


class _State(NamedTuple):
    # unknowns, film, contact and its slope, loads of the cells, generalised force
    deformation: Array
    motion: Array
    plane: PlaneSolution
    contact: Array
    contact_slope: Array
    push: Array
    load: Array


@final
@dataclass(frozen=True, eq=False)
class _Problem:
    film: PlaneFilm
    walls: ElasticWalls
    shapes: tuple[GapField, ...]
    external: Array
    contact: Asperities | None

    def state(self, deformation: Array, motion: Array) -> _State:
        gap = self.gap(deformation, motion)
        plane = solve_plane(replace(self.film, gap=gap))
        contact, slope = self._touch(gap)
        push = (plane.pressure + contact - self.walls.reference_pressure) * self.film.grid.area
        return _State(deformation, motion, plane, contact, slope, push, self.force(push))

    def gap(self, deformation: Array, motion: Array) -> GapField:
        """Gap at a deformation and rigid motions. [m]."""
        cells = self.walls.spread @ deformation
        gap = opened(self.film.gap, cells.reshape(self.film.gap.centre.shape), self.film.grid.ring)
        for shape, size in zip(self.shapes, motion, strict=True):
            gap = gap._replace(
                centre=gap.centre + size * shape.centre,
                face_x=gap.face_x + size * shape.face_x,
                face_y=gap.face_y + size * shape.face_y,
            )
        return gap

    def _touch(self, gap: GapField) -> tuple[Array, Array]:
        if self.contact is None:
            return np.zeros_like(gap.centre), np.zeros_like(gap.centre)
        known = self.film.grid.mark == PRESCRIBED
        height = gap.centre + gap.step
        pressure, slope = contact_field(height, self.contact.roughness, self.contact.table)
        return np.where(known, 0.0, pressure), np.where(known, 0.0, slope)

    def force(self, push: Array) -> Array:
        """Generalised force of cell loads on the rigid motions. [N, N m]."""
        weight = self.film.weight
        return np.array([weight * float((push * s.centre).sum()) for s in self.shapes])

    def residual(self, state: _State) -> tuple[Array, Array]:
        """Deformation and loads that are missing. [m], [N, N m]."""
        walls = self.walls
        wanted = walls.compliance @ (walls.spread.T @ state.push.ravel()) + walls.offset
        return wanted - state.deformation, state.load + self.external

    def response(self, state: _State, change: GapField) -> Array:
        """Change of the cell loads per change of the gap. [N]."""
        return self.responses(state, [change])[0]

    def responses(self, state: _State, changes: Sequence[GapField]) -> list[Array]:
        """Change of the cell loads per change of the gap, for several at once. [N]."""
        area = state.plane.film.grid.area
        found = state.plane.responses(changes)
        return [
            (one + state.contact_slope * change.centre) * area
            for one, change in zip(found, changes, strict=True)
        ]


def opened(gap: GapField, opening: Array, ring: bool) -> GapField:
    """Gap with the opening of its cells; faces take the mean of their cells. [m]."""
    d = opening
    before = np.vstack([d[-1:] if ring else d[:1], d])
    after = np.vstack([d, d[:1] if ring else d[-1:]])
    across = np.hstack([d[:, :1], 0.5 * (d[:, 1:] + d[:, :-1]), d[:, -1:]])
    along = 0.5 * (before + after)
    return GapField(gap.centre + d, gap.face_x + along, gap.face_y + across, gap.rate, gap.step)


def solve_elastic_film(
    film: PlaneFilm,
    walls: ElasticWalls,
    *,
    shapes: Sequence[GapField] = (),
    external: Array | None = None,
    contact: Asperities | None = None,
    start: ElasticFilmSolution | tuple[Array, Array] | None = None,
    settings: CouplingSettings | None = None,
) -> ElasticFilmSolution:
    r"""Film, deformation of its walls and rigid motions under external loads.

    Parameters
    ----------
    film : PlaneFilm
        Film with its undeformed gap.
    walls : ElasticWalls
        Compliance of the walls.
    shapes : sequence of GapField
        Change of the gap per unit of every free rigid motion; none holds the walls.
    external : ndarray
        External load on every rigid motion. [N, N m]
    contact : Asperities, optional
        Contact of rough walls.
    start : ElasticFilmSolution or tuple of ndarray, optional
        Former solution, or nodal deformation [m] and rigid motions to begin with.
    settings : CouplingSettings, optional
        Iteration.

    Returns
    -------
    ElasticFilmSolution
        Fields; ``status`` says whether the iteration settled.

    Raises
    ------
    CaseError
        If the gap of a smooth film is closed at the start.

    Notes
    -----
    Newton's method with the exact derivative of the film, cavity included; each step is solved
    by GMRES, of which every iteration is one solution of the linearised film. The viscosity is
    held in the derivative. Pressure-dependent viscosity therefore costs more steps.

    References
    ----------
    .. [1] D. A. Knoll, D. E. Keyes, Jacobian-free Newton-Krylov methods, J. Comput. Phys. 193
       (2004) 357-397.
    """
    settings = settings or CouplingSettings()
    target = np.zeros(len(shapes)) if external is None else np.asarray(external, dtype=float)
    problem = _Problem(film, walls, tuple(shapes), target, contact)
    if isinstance(start, ElasticFilmSolution):
        start = (start.deformation, start.motion)
    first = start or (walls.offset.copy(), np.zeros(len(shapes)))
    if contact is None and not _lowest(problem.gap(*first)) > 0.0:
        raise CaseError("film: found walls that touch at the start, allowed are open gaps")
    return _newton(problem, problem.state(*first), settings)


def _lowest(gap: GapField) -> float:
    return float(min(gap.centre.min(), gap.face_x.min(), gap.face_y.min()))


def _newton(problem: _Problem, state: _State, settings: CouplingSettings) -> ElasticFilmSolution:
    solves, change = 0, np.inf
    size = max(float(np.abs(problem.external).max(initial=0.0)), 1e-300)
    for count in range(settings.max_steps):
        missing = problem.residual(state)
        balanced = float(np.abs(missing[1]).max(initial=0.0)) <= settings.tolerance * size
        if change <= settings.tolerance and balanced:
            return _result(problem, state, (Status.DONE, count, solves, change))
        step, used = _newton_step(problem, state, missing, settings)
        solves += used
        state, change = _advance(problem, state, step, missing, settings)
    return _result(problem, state, (Status.NOT_CONVERGED, settings.max_steps, solves, change))


def _newton_step(
    problem: _Problem, state: _State, missing: tuple[Array, Array], settings: CouplingSettings
) -> tuple[Array, int]:
    """Step of deformation and motions, preconditioned by the film's rigid stiffness."""
    walls, plane, shapes = problem.walls, state.plane, problem.shapes
    shape, nodes = problem.film.gap.centre.shape, len(walls.offset)
    zero = GapField(*(np.zeros_like(a) for a in plane.film.gap))
    rigid = problem.responses(state, [s._replace(rate=zero.rate, step=zero.step) for s in shapes])
    stiffness = -np.array([problem.force(r) for r in rigid]).T.reshape(len(shapes), len(shapes))
    inverse = np.linalg.pinv(stiffness) if len(shapes) else stiffness

    def product(v: Array) -> Array:
        cells = (walls.spread @ v[:nodes]).reshape(shape)
        change = problem.response(state, opened(zero, cells, plane.film.grid.ring))
        for size, one in zip(v[nodes:], rigid, strict=True):
            change = change + size * one
        deformed = v[:nodes] - walls.compliance @ (walls.spread.T @ change.ravel())
        return np.concatenate([deformed, -inverse @ problem.force(change)])

    rhs = np.concatenate([missing[0], inverse @ missing[1]])
    limits = np.array([settings.krylov_tolerance * np.linalg.norm(rhs)])
    step, count = gmres(
        lambda v: product(v[0])[None], np.copy, rhs[None], limits=limits, max_iterations=80
    )
    return step[0], count + len(shapes)


def _advance(
    problem: _Problem,
    state: _State,
    step: Array,
    missing: tuple[Array, Array],
    settings: CouplingSettings,
) -> tuple[_State, float]:
    """Longest part of a step that keeps the gap open and does not raise the error much."""
    nodes = len(state.deformation)
    gap = state.plane.film.gap
    whole = problem.gap(state.deformation + step[:nodes], state.motion + step[nodes:])
    relative = (whole.centre - gap.centre) / np.maximum(np.abs(gap.centre), 1e-12)
    part = _kept_open(gap, whole, problem, settings)
    error = _error(problem, state, missing)
    for _ in range(6):
        trial = problem.state(
            state.deformation + part * step[:nodes], state.motion + part * step[nodes:]
        )
        if _error(problem, trial, problem.residual(trial)) < 1.5 * error:
            break
        part *= 0.5
    return trial, float(np.abs(relative).max())


def _kept_open(
    gap: GapField, whole: GapField, problem: _Problem, settings: CouplingSettings
) -> float:
    """Part of a step that no gap shrinks more by than allowed; rough walls may overlap a little."""
    room = 0.0 if problem.contact is None else 0.5 * problem.contact.roughness
    part = 1.0
    for before, after in zip(gap[:3], whole[:3], strict=True):
        fall = before - after
        limit = (1.0 - settings.smallest_shrink) * np.maximum(before, 0.0) + room
        over = fall > limit
        if over.any():
            part = min(part, float((limit[over] / fall[over]).min()))
    return part


def _error(problem: _Problem, state: _State, missing: tuple[Array, Array]) -> float:
    """Missing deformation over the mean gap, and missing load over the load."""
    scale = float(np.abs(state.plane.film.gap.centre).mean())
    out = float(np.abs(missing[0]).max(initial=0.0)) / scale
    if len(problem.external):
        size = max(float(np.linalg.norm(problem.external)), 1e-300)
        out += float(np.linalg.norm(missing[1])) / size
    return out


def _result(
    problem: _Problem, state: _State, outcome: tuple[Status, int, int, float]
) -> ElasticFilmSolution:
    status, steps, solves, change = outcome
    return ElasticFilmSolution(
        plane=state.plane,
        contact=state.contact,
        deformation=state.deformation,
        motion=state.motion,
        load=state.load,
        status=status if state.plane.status.succeeded else state.plane.status,
        steps=steps,
        linear_solves=solves,
        change=change,
    )
