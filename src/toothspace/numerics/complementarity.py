r"""Cell balances with a potential bounded below and a saturation bounded above.

Find potential :math:`u \ge 0` and deficit :math:`\chi = 1 - s \ge 0` with
:math:`u \chi = 0` in every cell such that the balance of
:class:`~toothspace.numerics.structured_grid.CellBalance` holds. Newton's method on this
semismooth system is an active-set method: a cell is either saturated (unknown: potential) or
unsaturated (unknown: saturation), every pass is one linear solve.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import IntEnum
from typing import final

import numpy as np

from toothspace.core.compiled import inlined, kernel
from toothspace.core.types import Array, IntArray
from toothspace.numerics.banded import stencil_product
from toothspace.numerics.linear_system import (
    LOOSE,
    PRESCRIBED,
    SATURATED,
    TIGHT,
    UNSATURATED,
    LinearSystem,
    PassSystems,
)
from toothspace.numerics.structured_grid import CellBalance, coarsened, grid_shape
from toothspace.numerics.vectors import norm, put


class Constraint(IntEnum):
    """What happens where the potential would become negative."""

    NONE = 0
    """Nothing: one linear solve."""
    OBSTACLE = 1
    """The potential is zero and the balance becomes an inequality."""
    CONSERVING = 2
    """The potential is zero, the saturation falls below one and the balance holds."""


ROUNDING = 1e-10
"""Part of its scale by which an unknown may break a bound before its cell changes kind. [-]"""


def bordered(b: CellBalance, potential: Array, saturation: Array) -> tuple[Array, Array]:
    """Fields with one more cell on every side: given potentials at full saturation, or the ring."""
    rows, lanes = potential.shape
    u, s = np.zeros((rows + 2, lanes + 2)), np.ones((rows + 2, lanes + 2))
    u[1:-1, 1:-1], s[1:-1, 1:-1] = potential, saturation
    u[1:-1, 0], u[1:-1, -1] = b.south, b.north
    if b.ring:
        u[0, 1:-1], u[-1, 1:-1] = potential[-1], potential[0]
        s[0, 1:-1], s[-1, 1:-1] = saturation[-1], saturation[0]
    else:
        u[0, 1:-1], u[-1, 1:-1] = b.west, b.east
    return u, s


def _bordered_kind(kind: IntArray, ring: bool) -> IntArray:
    rows, lanes = kind.shape
    out = np.full((rows + 2, lanes + 2), PRESCRIBED)
    out[1:-1, 1:-1] = kind
    if ring:
        out[0, 1:-1], out[-1, 1:-1] = kind[-1], kind[0]
    return out


@inlined
def _face_terms(
    conductance: float, outflow: float, kind: int, known: float
) -> tuple[float, float, float]:
    """Coefficient of a neighbour, what leaves the saturated cell, and the right-hand side."""
    entering = max(-outflow, 0.0)
    if kind == 0:
        return -conductance, max(outflow, 0.0), entering
    if kind == 1:
        return -entering, max(outflow, 0.0), 0.0
    return 0.0, max(outflow, 0.0), conductance * known + entering


@inlined
def neighbour_terms(
    b: CellBalance,
    place: tuple[int, int],
    kinds: tuple[int, int, int, int],
    known: tuple[float, float, float, float],
) -> tuple[tuple[float, float, float, float], tuple[float, float, float, float], float]:
    """Coefficients of the neighbours of a cell, what each delivers, and all that leaves it if full.

    ``kinds`` and ``known`` are kinds and potentials of the neighbours west, south, north and east.
    """
    i, j = place
    gx, gy, cx, cy = b.conductance_x, b.conductance_y, b.advection_x, b.advection_y
    west, leaving_west, from_west = _face_terms(gx[i, j], -cx[i, j], kinds[0], known[0])
    south, leaving_south, from_south = _face_terms(gy[i, j], -cy[i, j], kinds[1], known[1])
    north, leaving_north, from_north = _face_terms(gy[i, j + 1], cy[i, j + 1], kinds[2], known[2])
    east, leaving_east, from_east = _face_terms(gx[i + 1, j], cx[i + 1, j], kinds[3], known[3])
    leaving = b.storage[i, j] + leaving_west + leaving_south + leaving_north + leaving_east
    return (west, south, north, east), (from_west, from_south, from_north, from_east), leaving


def assemble(b: CellBalance, kind: IntArray) -> tuple[Array, Array]:
    """Five-point matrix and right-hand side for given kinds of the cells."""
    stencil, rhs = np.zeros((kind.size, 5)), np.empty(kind.size)
    known, _ = bordered(b, b.prescribed, b.prescribed)
    _fill_system(b, _bordered_kind(kind, b.ring), known, stencil, rhs)
    return stencil, rhs


@kernel
def _fill_system(b: CellBalance, kinds: IntArray, known: Array, stencil: Array, rhs: Array) -> None:
    """Coefficients and right-hand side, from kinds and potentials with a border."""
    rows, lanes = b.mark.shape
    gx, gy = b.conductance_x, b.conductance_y
    for i in range(rows):
        for j in range(lanes):
            r, p, q = i * lanes + j, i + 1, j + 1
            size = gx[i, j] + gx[i + 1, j] + gy[i, j] + gy[i, j + 1]
            if kinds[p, q] == 2:
                # scaled as a balance, so that residual norms compare flows with flows
                stencil[r, 2] = size if size > 0.0 else 1.0
                rhs[r] = stencil[r, 2] * known[p, q]
                continue
            round_it = kinds[p - 1, q], kinds[p, q - 1], kinds[p, q + 1], kinds[p + 1, q]
            given = known[p - 1, q], known[p, q - 1], known[p, q + 1], known[p + 1, q]
            sides, gains, leaving = neighbour_terms(b, (i, j), round_it, given)
            supply = b.source[i, j] + gains[0] + gains[1] + gains[2] + gains[3]
            if kinds[p, q] == 0:
                leaving, supply = size, supply - leaving
            elif leaving <= 0.0:
                # nothing leaves the cell, so it fills up: the next pass takes it as saturated
                stencil[r, 2], rhs[r] = 1.0, 2.0
                continue
            stencil[r, 0], stencil[r, 1], stencil[r, 2] = sides[0], sides[1], leaving
            stencil[r, 3], stencil[r, 4], rhs[r] = sides[2], sides[3], supply


def face_flows(
    b: CellBalance, change: CellBalance, potential: Array, saturation: Array
) -> tuple[Array, Array]:
    """Flows through the faces, towards east and north, with the coefficients of ``change``.

    With ``change = b`` the flows themselves, else their variation with the coefficients;
    the upstream side of a face is always that of ``b``.
    """
    along, across = np.empty(b.conductance_x.shape), np.empty(b.conductance_y.shape)
    _fill_flows(b, change, *bordered(b, potential, saturation), along, across)
    return along, across


@kernel
def _fill_flows(
    b: CellBalance, change: CellBalance, u: Array, s: Array, flow_x: Array, flow_y: Array
) -> None:
    gx, gy, cx, cy = change.conductance_x, change.conductance_y, b.advection_x, b.advection_y
    dx, dy = change.advection_x, change.advection_y
    for i in range(gx.shape[0]):
        for j in range(gx.shape[1]):
            carried = s[i, j + 1] if cx[i, j] > 0.0 else s[i + 1, j + 1]
            flow_x[i, j] = gx[i, j] * (u[i, j + 1] - u[i + 1, j + 1]) + dx[i, j] * carried
    for i in range(gy.shape[0]):
        for j in range(gy.shape[1]):
            carried = s[i + 1, j] if cy[i, j] > 0.0 else s[i + 1, j + 1]
            flow_y[i, j] = gy[i, j] * (u[i + 1, j] - u[i + 1, j + 1]) + dy[i, j] * carried


def residual(b: CellBalance, change: CellBalance, potential: Array, saturation: Array) -> Array:
    """Net flow out of every cell less its source, prescribed cells included.

    ``change`` as in :func:`face_flows`: the residual itself or its variation.
    """
    along, across = face_flows(b, change, potential, saturation)
    net = along[1:] - along[:-1] + across[:, 1:] - across[:, :-1]
    return np.asarray(saturation * change.storage - change.source + net)


def _settle(b: CellBalance, kind: IntArray, unknown: Array, sweeps: int, empty: int) -> None:
    """Revise the kinds by sweeps along the flow, each cell solved on its own.

    A strip of cells that changes its kind one after another settles at once this way. Negative
    sweeps run against the first index. Cells on the bound become ``empty``: UNSATURATED, or
    PRESCRIBED for an obstacle.
    """
    values, unsaturated = unknown.reshape(kind.shape), kind == UNSATURATED
    potential = np.where(unsaturated, 0.0, np.maximum(values, 0.0))
    saturation = np.where(unsaturated, np.minimum(values, 1.0), 1.0)
    _sweep(b, kind, *bordered(b, potential, saturation), sweeps, empty)


@kernel
def _sweep(b: CellBalance, kind: IntArray, u: Array, s: Array, sweeps: int, empty: int) -> None:
    rows = kind.shape[0]
    for _ in range(abs(sweeps)):
        if b.ring:
            put(u[0], u[rows])
            put(u[rows + 1], u[1])
            put(s[0], s[rows])
            put(s[rows + 1], s[1])
        for step in range(rows):
            _settle_row(b, kind, u, s, rows - 1 - step if sweeps < 0 else step, empty)


@kernel
def _settle_row(b: CellBalance, kind: IntArray, u: Array, s: Array, i: int, empty: int) -> None:
    gx, gy, cx, cy = b.conductance_x, b.conductance_y, b.advection_x, b.advection_y
    p = i + 1
    for j in range(kind.shape[1]):
        if b.mark[i, j] == 2:
            continue
        q = j + 1
        supply = b.source[i, j] + gx[i, j] * u[p - 1, q] + gx[i + 1, j] * u[p + 1, q]
        supply += gy[i, j] * u[p, q - 1] + gy[i, j + 1] * u[p, q + 1]
        supply += max(cx[i, j], 0.0) * s[p - 1, q] - min(cx[i + 1, j], 0.0) * s[p + 1, q]
        supply += max(cy[i, j], 0.0) * s[p, q - 1] - min(cy[i, j + 1], 0.0) * s[p, q + 1]
        leaving = b.storage[i, j] + max(cx[i + 1, j], 0.0) - min(cx[i, j], 0.0)
        leaving += max(cy[i, j + 1], 0.0) - min(cy[i, j], 0.0)
        # more comes in than a full cell passes on: it is full, and pressure drives off the rest
        if supply >= leaving or leaving <= 0.0:
            conducted = gx[i, j] + gx[i + 1, j] + gy[i, j] + gy[i, j + 1]
            u[p, q], s[p, q] = max(supply - leaving, 0.0) / conducted, 1.0
            kind[i, j] = 0
        else:
            u[p, q], s[p, q] = 0.0, max(supply, 0.0) / leaving if empty == 1 else 1.0
            kind[i, j] = empty


@kernel
def exchange_kinds(kind: IntArray, unknowns: Array, scale: float, storage: Array) -> int:
    """Exchange the kind of cells that break a bound; return how many did.

    A cell that closes holds less than nothing where more flows in than out: it fills up.
    """
    changed = 0
    lanes = kind.shape[1]
    for i in range(kind.shape[0]):
        for j in range(lanes):
            value = unknowns[i * lanes + j]
            # films cannot pull: a negative pressure opens a cavity, a film over-full closes it
            if kind[i, j] == 0 and value < -ROUNDING * scale:
                kind[i, j] = 1
                changed += 1
            elif kind[i, j] == 1 and (
                value > 1.0 + ROUNDING or (value < -ROUNDING and storage[i, j] < 0.0)
            ):
                kind[i, j] = 0
                changed += 1
    return changed


def _revise_obstacle(b: CellBalance, kind: IntArray, unknown: Array, scale: float) -> int:
    """Exchange cells on the obstacle that the balance pushes off, and the reverse."""
    potential = unknown.reshape(kind.shape)
    net = residual(b, b, potential, np.ones(kind.shape))
    size = 1e-12 * np.abs(b.advection_x).max() + 1e-12 * np.abs(b.storage).max()
    free = b.mark != PRESCRIBED
    landed = free & (kind == SATURATED) & (potential < -ROUNDING * scale)
    lifted = free & (kind == PRESCRIBED) & (net < -size)
    kind[landed], kind[lifted] = PRESCRIBED, SATURATED
    return int(landed.sum() + lifted.sum())


@final
@dataclass(frozen=True)
class ComplementaritySolution:
    """Potential and saturation of every cell, and the linearised system there."""

    potential: Array
    """Potential, zero where unsaturated. [unit of the potential]"""
    saturation: Array
    """Saturation, one where the potential is positive. [-]"""
    kind: IntArray
    """SATURATED, UNSATURATED or PRESCRIBED."""
    system: LinearSystem
    """Jacobian at the solution, ready for further right-hand sides."""
    passes: int
    """Number of linear solves on this grid. [-]"""
    converged: bool
    """Whether the last pass changed no cell."""


def solve_complementarity(
    balance: CellBalance,
    constraint: Constraint,
    start: IntArray | None = None,
    *,
    max_passes: int = 60,
) -> ComplementaritySolution:
    """Solve a balance under a constraint, beginning with a guess found on coarser grids.

    Fields and factored Jacobian. ``converged`` says whether the active set settled.

    Parameters
    ----------
    balance : CellBalance
        Coefficients. [any consistent units]
    constraint : Constraint
        Treatment of negative potentials.
    start : ndarray of int, optional
        Kinds of the cells to begin with, as in a former solution.
    max_passes : int
        Limit of the number of linear solves on one grid. [-]

    References
    ----------
    .. [1] M. Hintermueller, K. Ito, K. Kunisch, The primal-dual active set strategy as a
       semismooth Newton method, SIAM J. Optim. 13 (2002) 865-888.
    """
    found = _active_set(balance, constraint, start, max_passes)
    # passes go in circles only with negative storage: a film squeezed faster than it drains
    if found.converged or constraint is not Constraint.CONSERVING or balance.storage.min() >= 0.0:
        return found
    return _with_delay(balance, max_passes) or found


def _with_delay(balance: CellBalance, max_passes: int) -> ComplementaritySolution | None:
    """Settle the cells of a film that is squeezed faster than the flow carries liquid away.

    Negative storage makes the passes go in circles. Held at the saturation of the round before,
    it leaves a matrix with which they settle, and from a full film the saturations can then only
    fall from round to round, towards those of the balance itself.
    """
    held, kind = np.maximum(-balance.storage, 0.0), None
    saturation = np.ones(held.shape)
    for _ in range(_ROUNDS):
        delayed = balance._replace(
            storage=balance.storage + held, source=balance.source + held * saturation
        )
        former = _active_set(delayed, Constraint.CONSERVING, kind, max_passes)
        saturation, kind = former.saturation, former.kind
        found = _active_set(balance, Constraint.CONSERVING, kind, _TRIAL_PASSES)
        if found.converged:
            return found
    return None


def _active_set(
    balance: CellBalance, constraint: Constraint, start: IntArray | None, max_passes: int
) -> ComplementaritySolution:
    prescribed = balance.mark == PRESCRIBED
    if start is not None:
        kind = start.copy()
        if constraint is not Constraint.OBSTACLE:
            kind[kind == PRESCRIBED] = SATURATED
    elif constraint is Constraint.NONE or min(grid_shape(balance)) < 8:
        kind = np.full(grid_shape(balance), SATURATED, dtype=np.int64)
    else:
        kind = _from_coarse(balance, constraint)
    kind[prescribed] = PRESCRIBED
    # kinds change only where a bound is broken by more than rounding, which needs a size
    scale = potential_scale(balance)
    sense = -1 if balance.advection_x.sum() < 0.0 else 1
    systems = PassSystems(balance)
    unknown = np.zeros(kind.size)
    for number in range(1, max_passes + 1):
        if balance.ring:
            lanes = np.flatnonzero((kind == UNSATURATED).all(axis=0))
            if lanes.size != 0:
                if number > _RING_CLOSURES:
                    lanes = lanes[~balance.storage[:, lanes].any(axis=0)]
                # there the ring passes on least, so there it fills first
                narrowest = np.argmin(np.abs(balance.advection_x[1:, lanes]), axis=0)
                kind[narrowest, lanes] = SATURATED
        stencil, rhs = assemble(balance, kind)
        system = systems.system(stencil, kind)
        used = kind.copy()
        # early passes only have to tell the sign of a potential, the last one all its digits
        exact = number > _LOOSE_PASSES
        unknown = system.solve(rhs, unknown, TIGHT if exact else LOOSE)
        changed = _revise(balance, constraint, kind, unknown, scale)
        if changed == 0 and not exact:
            # a rough solution that changes nothing is solved out before it is believed
            unknown = system.solve(rhs, unknown, TIGHT)
            changed = _revise(balance, constraint, kind, unknown, scale)
        if changed == 0:
            break
        if constraint is Constraint.CONSERVING:
            # Newton moves the border of a cavity by one cell a pass; a sweep along the flow follows
            # the liquid as far as it goes
            if number in _RESCUES:
                sweeps = _RESCUES[number]
            else:
                peeling = 1 < changed < 10 and number <= 4 * _SETTLING_PASSES
                sweeps = 1 if number <= _SETTLING_PASSES or peeling else 0
            _settle(balance, kind, unknown, sense * sweeps, UNSATURATED)
        else:
            _settle(balance, kind, unknown, 1, PRESCRIBED)
            _settle(balance, kind, unknown, -1, PRESCRIBED)
        # a potential says nothing about the saturation of a cell that changed its kind
        unknown = np.where((used == kind).ravel(), unknown, 0.0)
    error = norm(rhs - stencil_product(stencil, unknown, *grid_shape(balance)))
    converged = changed == 0 and error <= _ACCEPTED * norm(rhs)
    return ComplementaritySolution(*fields_of(used, unknown), used, system, number, converged)


def _revise(
    balance: CellBalance, constraint: Constraint, kind: IntArray, unknown: Array, scale: float
) -> int:
    """Exchange the kinds of cells that break a bound; return how many did."""
    if constraint is Constraint.CONSERVING:
        return int(exchange_kinds(kind, unknown, scale, balance.storage))
    if constraint is Constraint.OBSTACLE:
        return _revise_obstacle(balance, kind, unknown, scale)
    return 0


_SETTLING_PASSES = 6
"""Passes followed by a sweep; later a sweep from old potentials could undo a revision for ever."""

_RESCUES = {8: 50, 16: 200, 32: 800}
"""Passes after which the cavity is found afresh by many sweeps, and how many."""

_LOOSE_PASSES = 3
"""Passes with a rough linear solution; for ever, it would move cells that are all but full."""

_ROUNDS, _TRIAL_PASSES = 60, 4
"""Rounds with delayed storage, and passes that the balance itself gets after each. [-]"""

_ACCEPTED = 1e-8
"""Relative residual above which a solution counts as not converged. [-]"""

_SAMPLES = 32
"""Values along one direction from which a grid is sampled. [-]"""

_COARSE_SWEEPS = 1
"""Sweeps that settle the kinds taken from a coarser grid. [-]"""

_RING_CLOSURES = 8
"""Passes in which rings that gain or lose volume are closed."""


def potential_scale(balance: CellBalance) -> float:
    """Size of the potentials that the flows and the given potentials can cause."""
    conductance = _typical(balance.conductance_x[1:-1])
    conductance += _typical(balance.conductance_y[:, 1:-1])
    flow = max(
        float(np.abs(balance.advection_x).max()),
        float(np.abs(balance.storage).max()),
        float(np.abs(balance.source).max()),
    )
    given = max(float(np.abs(a).max()) for a in (balance.prescribed, balance.west, balance.south))
    return given + flow / conductance


def _typical(values: Array) -> float:
    """Median of at most a few thousand values spread over a grid."""
    along, across = (max(1, size // _SAMPLES) for size in values.shape)
    return float(np.median(values[::along, ::across]))


def _from_coarse(balance: CellBalance, constraint: Constraint) -> IntArray:
    """Kinds found on a grid of half as many cells, settled on this one."""
    coarse = _active_set(coarsened(balance), constraint, None, 30)
    rows, lanes = grid_shape(balance)
    kind = np.repeat(np.repeat(coarse.kind, 2, axis=0), 2, axis=1)[:rows, :lanes].copy()
    if constraint is Constraint.OBSTACLE:
        return kind
    kind[kind == PRESCRIBED] = SATURATED
    kind[balance.mark == PRESCRIBED] = PRESCRIBED
    potential = _refined(_refined(coarse.potential, rows).T, lanes).T
    saturation = np.repeat(np.repeat(coarse.saturation, 2, axis=0), 2, axis=1)[:rows, :lanes]
    unknown = np.where(kind == UNSATURATED, saturation, potential).ravel()
    sense = -1 if balance.advection_x.sum() < 0.0 else 1
    _settle(balance, kind, unknown, sense * _COARSE_SWEEPS, UNSATURATED)
    return kind


def _refined(values: Array, count: int) -> Array:
    """Linear interpolation of rows between the centres of merged cells."""
    before = np.concatenate([values[:1], values[:-1]])
    after = np.concatenate([values[1:], values[-1:]])
    fine = np.empty((2 * values.shape[0], values.shape[1]))
    fine[::2] = 0.75 * values + 0.25 * before
    fine[1::2] = 0.75 * values + 0.25 * after
    return np.ascontiguousarray(fine[:count])


def fields_of(kind: IntArray, unknowns: Array) -> tuple[Array, Array]:
    """Potential and saturation of every cell from its one unknowns."""
    values, unsaturated = unknowns.reshape(kind.shape), kind == UNSATURATED
    return np.where(unsaturated, 0.0, values), np.where(unsaturated, values, 1.0)
