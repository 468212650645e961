"""Film between faces that deform locally: Newton's method for pressure, cavity and gap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, final

import numpy as np

from toothspace.core.compiled import inlined, kernel, njit
from toothspace.core.status import Status
from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.films.lateral.local_deformation import LocalCompliance, settle_gap
from toothspace.films.plane.film import PlaneFilm, PlaneSolution
from toothspace.films.reynolds.active_set import (
    DeformedGap,
    GapMotion,
    Linearised,
    linearised_balance,
    varied_balance,
)
from toothspace.films.reynolds.equation import FilmGrid, FluidField, GapField
from toothspace.films.reynolds.linearised import solved_responses
from toothspace.films.reynolds.rough_surfaces import FlowLaw, squeeze_law
from toothspace.numerics.banded import stencil_product
from toothspace.numerics.block_elimination import block_system
from toothspace.numerics.complementarity import (
    ComplementaritySolution,
    assemble,
    exchange_kinds,
    fields_of,
)
from toothspace.numerics.linear_system import (
    PRESCRIBED,
    SATURATED,
    UNSATURATED,
    LinearSystem,
    iterative_system,
)
from toothspace.numerics.structured_grid import grid_shape

_PATIENCE = 8
"""Passes after which steps that still change the gap much are taken in part."""
_CAREFUL = 0.5
"""That part, as whole steps may go back and forth where faces touch. [-]"""
_MUCH = 0.01
"""Change of the gap that counts as much. [-]"""
_LONGEST = 0.5
"""Largest change of the gap in one pass over the gap. [-]"""
_CARRIED = 16
"""Rows from which a newly covered cell takes the film that it begins with. [-]"""
_BLOCK_LANES = 200
"""Cells along the radius up to which elimination beats multigrid of a compliant film. [-]"""


@final
@dataclass(frozen=True)
class CompliantSolution:
    """Film with its gap.

    Parameters
    ----------
    plane : PlaneSolution
        Fields; the linear system is that of the coupled problem.
    contact, contact_slope : ndarray
        Asperity pressure and its derivative with the gap. [Pa, Pa/m]
    gap_slope : ndarray
        Change of the gap over a change of its undeformed height. [-]
    kind : ndarray of int
        Kinds of the cells for a next pass; those of the fields if the film settled.
    change : float
        Largest change of the gap by the last pass over the gap. [-]
    found : Linearised, optional
        Balance and its slopes; none between rigid faces.
    """

    plane: PlaneSolution
    contact: Array
    contact_slope: Array
    gap_slope: Array
    kind: IntArray
    change: float = 0.0
    found: Linearised | None = None


@kernel
def _couple_along(
    film: Linearised,
    kind: IntArray,
    potential: Array,
    saturation: Array,
    gap_compliance: Array,
    stencil: Array,
) -> None:
    """Add to a matrix what flows along the ring change with the gaps that pressures open.

    ``gap_compliance`` is the change of the gap with the reduced pressure of its cell.
    """
    b, slope = film
    rows, lanes = kind.shape
    for i in range(rows):
        w = (i + rows - 1) % rows
        for j in range(lanes):
            own, other = i * lanes + j, w * lanes + j
            drop = potential[w, j] - potential[i, j]
            forward = b.advection_x[i, j] >= 0.0
            if kind[w, j] == 0:
                change = slope.west[i, j] * drop
                if forward:
                    change += slope.carried[i, j] * saturation[w, j]
                change *= gap_compliance[w, j]
                stencil[other, 2] += change
                if kind[i, j] != 2:
                    stencil[own, 0] -= change
            if kind[i, j] == 0:
                change = slope.east[i, j] * drop
                if not forward:
                    change += slope.carried[i, j] * saturation[i, j]
                change *= gap_compliance[i, j]
                stencil[own, 2] -= change
                if kind[w, j] != 2:
                    stencil[other, 4] += change


@kernel
def _couple_across(
    film: Linearised, kind: IntArray, potential: Array, gap_compliance: Array, stencil: Array
) -> None:
    """Faces of the second index, as :func:`_couple_along`."""
    b, slope = film
    rows, lanes = kind.shape
    for i in range(rows):
        for j in range(lanes + 1):
            own, other = i * lanes + j, i * lanes + j - 1
            below = potential[i, j - 1] if j > 0 else b.south[i]
            above = potential[i, j] if j < lanes else b.north[i]
            if j > 0 and kind[i, j - 1] == 0:
                change = slope.south[i, j] * (below - above) * gap_compliance[i, j - 1]
                stencil[other, 2] += change
                if j < lanes and kind[i, j] != 2:
                    stencil[own, 1] -= change
            if j < lanes and kind[i, j] == 0:
                change = slope.north[i, j] * (below - above) * gap_compliance[i, j]
                stencil[own, 2] -= change
                if j > 0 and kind[i, j - 1] != 2:
                    stencil[other, 3] += change


@kernel
def _store(kind: IntArray, held: Array, height: Array, law: FlowLaw, stencil: Array) -> None:
    """Add the flow that fills gaps as pressures open them; ``held`` per pressure at flat walls."""
    rows, lanes = kind.shape
    for i in range(rows):
        for j in range(lanes):
            if kind[i, j] == 0:
                stencil[i * lanes + j, 2] += held[i, j] * squeeze_law(height[i, j], law)[0]


@inlined
def _floored(gap: float, roughness: float) -> float:
    """Gap that changes are compared with, positive also where faces overlap. [m]."""
    return max(gap, 0.1 * roughness + 1e-9)


@kernel
def _take(
    kind: IntArray,
    walls: tuple[Array, Array, Array],
    roughness: float,
    careful: float,
    step: Array,
    unknown: Array,
    contact: Array,
) -> float:
    """Add a step to the unknowns, in part where it changes the gap much.

    Returns the largest change of a gap over the gap that the whole step asks for. Steps that ask
    for much are taken to the part ``careful`` at most.
    """
    gap, gap_compliance, touch = walls
    rows, lanes = kind.shape
    largest = 0.0
    for i in range(rows):
        for j in range(lanes):
            if kind[i, j] == 0:
                change = abs(gap_compliance[i, j] * step[i * lanes + j])
                largest = max(largest, change / _floored(gap[i, j], roughness))
    most = careful if largest > _MUCH else 1.0
    for i in range(rows):
        for j in range(lanes):
            r, part, change = i * lanes + j, most, 0.0
            contact[i, j] = 0.0
            if kind[i, j] == 2:
                continue
            if kind[i, j] == 0:
                change = gap_compliance[i, j] * step[r]
                room = _LONGEST * _floored(gap[i, j], roughness)
                part = min(part, room / max(abs(change), 1e-300))
            unknown[r] += part * step[r]
            contact[i, j] = max(touch[0, i, j] + part * touch[1, i, j] * change, 0.0)
    return largest


class _Reduced(NamedTuple):
    """Boundaries and liquid of a film that is solved for the reduced pressure."""

    grid: FilmGrid
    floor: float  # reduced cavitation pressure [Pa]
    carrier: FluidField


class _Pass(NamedTuple):
    gap: Array
    rate: Array  # of the whole gap [m/s]
    touch: Array  # contact, slope, share
    gap_compliance: Array  # change of the gap over that of the reduced pressure [m/Pa]
    found: Linearised
    system: LinearSystem
    right: Array


def solve_compliant(
    film: PlaneFilm, carrier: FluidField, how: LocalCompliance, former: CompliantSolution | None
) -> CompliantSolution:
    """Film whose gap follows its own pressure.

    Parameters
    ----------
    film : PlaneFilm
        Film with the undeformed gap.
    carrier : FluidField
        Liquid for the reduced pressure.
    how : LocalCompliance
        Local compliance and contact.
    former : CompliantSolution, optional
        Similar film to begin with.
    """
    fluid, lowest = film.fluid, film.cavitation_pressure
    reduced = _Reduced(fluid.reduced_grid(film.grid), fluid.reduced_of(lowest), carrier)
    potential, saturation, kind = _begin(reduced, former)
    unknown = np.where(kind == UNSATURATED, saturation, potential).ravel()
    gap = film.gap.centre.copy() if former is None else former.plane.film.gap.centre.copy()
    settled, system = False, None if former is None else former.plane.fields.system
    for number in range(1, how.accuracy.passes + 1):
        now = _linearise(film, reduced, how, unknown, kind, gap, system)
        gap, system = now.gap, now.system
        step = now.system.solve(-now.right, relative_tolerance=how.accuracy.linear)
        lost = not np.isfinite(step).all()
        if lost:
            step = np.zeros_like(step)
        contact = np.empty_like(gap)
        careful = _CAREFUL if number > _PATIENCE else 1.0
        walls = gap, now.gap_compliance, now.touch
        largest = _take(kind, walls, how.roughness, careful, step, unknown, contact)
        used, scale = kind.copy(), np.abs(unknown[kind.ravel() == SATURATED]).max(initial=0.0)
        changed = exchange_kinds(kind, unknown, float(scale))
        moved = (kind != used).ravel()
        unknown[moved] = kind.ravel()[moved]  # on the bound: saturation one, potential zero
        settled = changed == 0 and largest <= how.accuracy.settled and not lost
        if settled or lost:
            break
    final, filled = fields_of(kind, unknown)
    fields = ComplementaritySolution(final, filled, used, now.system, number, settled)
    deformed = deformed_gap(film.gap, gap - film.gap.centre, film.grid.sweep_x)
    status = Status.DONE if settled else Status.NOT_CONVERGED
    gauge = fluid.gauge(np.maximum(fields.potential, 0.0), lowest)
    liquid = fluid.fields(gauge + lowest)
    film = replace(film, gap=deformed._replace(rate=now.rate))
    plane = PlaneSolution(gauge, liquid, now.found.balance, fields, status, film)
    touch = (now.touch[1].copy(), now.touch[2].copy())
    return CompliantSolution(plane, contact, *touch, kind, largest, now.found)


def compliant_responses(
    solution: CompliantSolution, lifts: Sequence[GapField], linear: float
) -> list[Array]:
    """Change of the reduced pressure with motions of the undeformed gap, on compliant walls.

    [Pa per unit]

    Parameters
    ----------
    solution : CompliantSolution
        Settled film.
    lifts : sequence of GapField
        Changes of gap and rate per unit of a motion, ``step`` unused. [m and m/s per unit]
    linear : float
        Residual of the linear solution over its right-hand side. [-]
    """
    plane, found = solution.plane, solution.found
    assert found is not None
    film, fields = (plane.film.grid, plane.film.gap, plane.fluid), plane.fields
    motions = (GapMotion(lift, solution.gap_slope) for lift in lifts)
    varied = (varied_balance(found, *film, plane.film.law, motion) for motion in motions)
    return solved_responses(found.balance, fields, varied, linear)


def _begin(film: _Reduced, former: CompliantSolution | None) -> tuple[Array, Array, IntArray]:
    known = film.grid.mark == PRESCRIBED
    given = film.grid.prescribed - film.floor
    if former is None:
        kind = np.where(known, PRESCRIBED, SATURATED)
        return np.where(known, given, 0.0), np.ones(kind.shape), kind
    fields, before = former.plane.fields, former.kind
    kind = np.where(before == PRESCRIBED, SATURATED, before)
    kind = np.where(known, PRESCRIBED, kind)
    potential = np.where(known, given, fields.potential)
    _carry(before == PRESCRIBED, kind, film.grid.sweep_x, fields.potential, potential)
    return potential, fields.saturation.copy(), kind


@kernel
def _carry(bare: BoolArray, kind: IntArray, sweep: Array, former: Array, potential: Array) -> None:
    """Begin newly covered cells with the film that the face has carried there."""
    rows, lanes = kind.shape
    for i in range(rows):
        for j in range(lanes):
            if kind[i, j] == 2 or not bare[i, j]:
                continue
            back = -1 if sweep[i, j] >= 0.0 else 1
            for far in range(1, _CARRIED + 1):
                up = (i + far * back) % rows
                if not bare[up, j]:
                    potential[i, j] = former[up, j]
                    break


def _linearise(
    film: PlaneFilm,
    reduced: _Reduced,
    how: LocalCompliance,
    unknown: Array,
    kind: IntArray,
    gap: Array,
    former: LinearSystem | None,
) -> _Pass:
    potential, saturation = fields_of(kind, unknown)
    touch = np.empty((3, *gap.shape))
    height = gap.copy()
    inside = film.grid.mark != PRESCRIBED
    pressure = film.fluid.gauge(potential, film.cavitation_pressure)
    settle_gap(film.gap.centre, pressure, inside, how, height, touch)
    gap_compliance = (
        how.compliance * touch[2] * film.fluid.stretch(pressure + film.cavitation_pressure)
    )
    rate = film.gap.rate + how.frequency * (height - film.gap.centre)
    rigid = film.gap._replace(rate=rate)
    b = film.grid
    rims = np.vstack([b.south, b.north]) - film.cavitation_pressure - how.reference
    deformed = DeformedGap(rigid, height - film.gap.centre, how.compliance * rims)
    grid, floor, carrier = reduced
    found = linearised_balance(grid, deformed, carrier, floor, film.law)
    balance = found.balance
    stencil, rhs = assemble(balance, kind)
    rows, lanes = grid_shape(balance)
    right = stencil_product(stencil, unknown, rows, lanes) - rhs
    _couple_along(found, kind, potential, saturation, gap_compliance, stencil)
    _couple_across(found, kind, potential, gap_compliance, stencil)
    if how.frequency > 0.0:
        _store(
            kind,
            how.frequency * carrier.density * b.area * gap_compliance,
            height,
            film.law,
            stencil,
        )
    system: LinearSystem | None = None
    if lanes <= _BLOCK_LANES:
        system = block_system(stencil, kind, former)
    if system is None:
        system = iterative_system(balance, stencil, kind)
    return _Pass(height, rate, touch, gap_compliance, found, system, right)


@njit(nogil=True)
def deformed_gap(gap: GapField, deformation: Array, sweep: Array) -> GapField:
    """Gap with a deformation: along the motion that of the cell upstream."""
    along, across = np.empty(gap.face_x.shape), np.empty(gap.face_y.shape)
    rows, lanes = deformation.shape
    for i in range(rows + 1):
        for j in range(lanes):
            up = i - 1 if sweep[i, j] >= 0.0 else i
            along[i, j] = gap.face_x[i, j] + deformation[up % rows, j]
    for i in range(rows):
        for j in range(lanes + 1):
            south, north = deformation[i, max(j - 1, 0)], deformation[i, min(j, lanes - 1)]
            across[i, j] = gap.face_y[i, j] + 0.5 * (south + north)
    return GapField(gap.centre + deformation, along, across, gap.rate, gap.step)
