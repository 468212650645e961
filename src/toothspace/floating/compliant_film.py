"""Film between faces that deform locally: Newton's method for pressure, cavity and gap."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, final

import numpy as np

from toothspace.core.compiled import inlined, kernel, njit
from toothspace.core.status import Status
from toothspace.core.types import Array, BoolArray, IntArray
from toothspace.films.plane.film import PlaneFilm, PlaneSolution
from toothspace.films.reynolds.active_set import (
    DeformedGap,
    GapMotion,
    Linearised,
    flow_change,
    linearised_balance,
)
from toothspace.films.reynolds.equation import FilmGrid, FluidField, GapField
from toothspace.films.reynolds.fluid import ReducedLaw, pressure_above
from toothspace.films.reynolds.rough_surfaces import ContactTable, contact_pressure
from toothspace.films.reynolds.state import solved_responses
from toothspace.numerics.banded import empty_band
from toothspace.numerics.block_elimination import block_system
from toothspace.numerics.complementarity import (
    ComplementaritySolution,
    exchange_kinds,
    neighbour_terms,
)
from toothspace.numerics.linear_system import (
    PRESCRIBED,
    SATURATED,
    TIGHT,
    UNSATURATED,
    LinearSystem,
    direct_system,
)
from toothspace.numerics.structured_grid import CellBalance

_MOST_PASSES = 40
_SAME_GAP = 1e-15
"""Error of a gap between pressed faces. [m]"""
_MOST_HALVINGS = 80
"""Most steps to it."""


class Accuracy(NamedTuple):
    """When a film is done."""

    settled: float = 1e-7  # change of the gap by one pass over the gap [-]
    linear: float = TIGHT  # residual of one linear solution over its right-hand side [-]
    passes: int = _MOST_PASSES  # most passes; few where the force balance repeats them [-]


class LocalCompliance(NamedTuple):
    """How the faces deform."""

    compliance: float  # local approach over pressure [m/Pa]
    reference: float  # pressure without approach, above the cavitation pressure [Pa]
    contact: ContactTable
    roughness: float  # [m]
    frequency: float = 0.0  # inverse of the time in which the faces deform, 0 for steady [1/s]
    accuracy: Accuracy = Accuracy()


@inlined
def _contact_gap(base: float, start: float, how: LocalCompliance) -> tuple[float, float, float]:
    """Gap over which asperities hold faces apart, their pressure and its slope.

    Newton's method between bounds: asperities begin to carry so suddenly that its steps alone go
    back and forth over the edge of contact.
    """
    low, high, h = -np.inf, np.inf, max(base, start)
    p, slope = contact_pressure(h, how.roughness, how.contact)
    for _ in range(_MOST_HALVINGS):
        error = h - base - how.compliance * p
        if abs(error) < _SAME_GAP:
            break
        low, high = (h, high) if error < 0.0 else (low, h)
        h -= error / (1.0 - how.compliance * slope)
        if not low < h < high:
            h = 0.5 * (low + high)
        p, slope = contact_pressure(h, how.roughness, how.contact)
    return h, p, slope


@kernel
def settle_gap(
    kind: IntArray,
    values: Array,
    rigid: Array,
    walls: tuple[Array, Array],
    law: ReducedLaw,
    how: LocalCompliance,
    gap: Array,
    out: Array,
) -> None:
    """Gap of every cell under film and asperity pressure.

    Parameters
    ----------
    kind, values : ndarray
        Kinds of the cells, and their potential or saturation. [Pa or -]
    rigid : ndarray
        Undeformed gap. [m]
    walls : tuple of ndarray
        Pressure of prescribed cells above the lowest one, and an asperity pressure to begin with.
        [Pa, Pa]
    law : ReducedLaw
        Pressure over the potential.
    how : LocalCompliance
        How the faces deform.
    gap : ndarray
        Gap found. [m]
    out : ndarray, shape (4, rows, lanes)
        Asperity pressure, its slope, change of the gap over that of the undeformed one and over
        that of the potential. [Pa, Pa/m, -, m/Pa]
    """
    known, begun = walls
    rows, lanes = rigid.shape
    for i in range(rows):
        for j in range(lanes):
            if kind[i, j] == 2:
                gap[i, j] = rigid[i, j] + how.compliance * (known[i, j] - how.reference)
                out[0, i, j], out[1, i, j], out[2, i, j], out[3, i, j] = 0.0, 0.0, 1.0, 0.0
                continue
            potential = values[i * lanes + j] if kind[i, j] == 0 else 0.0
            pressure, stretch = pressure_above(potential, law)
            base = rigid[i, j] + how.compliance * (pressure - how.reference)
            start = base + how.compliance * begun[i, j]
            gap[i, j], out[0, i, j], out[1, i, j] = _contact_gap(base, start, how)
            out[2, i, j] = 1.0 / (1.0 - how.compliance * out[1, i, j])
            out[3, i, j] = how.compliance * out[2, i, j] * stretch


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


class GivenPressures(NamedTuple):
    """Boundaries of a film that is solved for the reduced pressure."""

    grid: FilmGrid
    law: ReducedLaw
    prescribed: Array  # pressure above the cavitation pressure, where it is given [Pa]


@final
@dataclass(frozen=True)
class CompliantSolution:
    """Film with its gap."""

    plane: PlaneSolution
    """Fields; the linear system is that of the coupled problem."""
    contact: Array
    contact_slope: Array
    """Asperity pressure and its derivative with the gap. [Pa, Pa/m]"""
    gap_slope: Array
    """Change of the gap over a change of its undeformed height. [-]"""
    kind: IntArray
    """Kinds of the cells for a next pass; those of the fields if the film settled."""
    change: float = 0.0
    """Largest change of the gap by the last pass over the gap. [-]"""
    found: Linearised | None = None
    """Balance and its slopes; none between rigid faces."""
    given: GivenPressures | None = None
    """What it was solved between; none between rigid faces."""
    frequency: float = 0.0
    """Inverse of the time in which the faces deform, 0 for steady ones. [1/s]"""


@kernel
def _assemble(
    film: Linearised,
    kind: IntArray,
    unknown: Array,
    gap_compliance: Array,
    frequency: float,
    stencil: Array,
    right: Array,
) -> None:
    """Matrix of one Newton pass and what the balance of every cell leaves, negative.

    ``gap_compliance`` is the change of the gap with the reduced pressure of its cell. Flows through
    the faces and the filling of gaps that pressures open within a step add to the conduction.
    """
    b, slope = film.balance, film.slope
    rows, lanes = kind.shape
    gx, gy, cx = b.conductance_x, b.conductance_y, b.advection_x
    for i in range(rows):
        for j in range(lanes):
            r = i * lanes + j
            own = kind[i, j]
            size = gx[i, j] + gx[i + 1, j] + gy[i, j] + gy[i, j + 1]
            if own == 2:
                centre = size if size > 0.0 else 1.0
                stencil[r, 0], stencil[r, 1], stencil[r, 3], stencil[r, 4] = 0.0, 0.0, 0.0, 0.0
                stencil[r, 2] = centre
                right[r] = centre * (b.prescribed[i, j] - unknown[r])
                continue
            w, e = (i + rows - 1) % rows, (i + 1) % rows
            rw, re = w * lanes + j, e * lanes + j
            kw, ke = kind[w, j], kind[e, j]
            ks = kind[i, j - 1] if j > 0 else 2
            kn = kind[i, j + 1] if j < lanes - 1 else 2
            xs = unknown[r - 1] if j > 0 else b.south[i]
            xn = unknown[r + 1] if j < lanes - 1 else b.north[i]
            here = 0.0 if own == 1 else unknown[r]
            full = unknown[r] if own == 1 else 1.0
            below = b.prescribed[i, j - 1] if j > 0 else b.south[i]
            above = b.prescribed[i, j + 1] if j < lanes - 1 else b.north[i]
            known = b.prescribed[w, j], below, above, b.prescribed[e, j]
            sides, gains, leaving = neighbour_terms(b, (i, j), (kw, ks, kn, ke), known)
            west, south, north, east = sides
            supply = b.source[i, j] + gains[0] + gains[3] + gains[1] + gains[2]
            if own == 0:
                leaving, supply = size, supply - leaving
            elif leaving <= 0.0:
                # nothing leaves the cell, so it fills up: the next pass takes it as saturated
                west, south, north, east, leaving, supply = 0.0, 0.0, 0.0, 0.0, 1.0, 2.0
            left = west * unknown[rw] + south * xs + leaving * unknown[r] + north * xn
            right[r] = supply - left - east * unknown[re]
            # faces of the first index
            before = 0.0 if kw == 1 else unknown[rw]
            behind = 0.0 if ke == 1 else unknown[re]
            if kw == 0:
                change = slope.west[i, j] * (before - here)
                if cx[i, j] >= 0.0:
                    change += slope.carried[i, j]
                west -= change * gap_compliance[w, j]
            if ke == 0:
                change = slope.east[i + 1, j] * (here - behind)
                if cx[i + 1, j] < 0.0:
                    change += slope.carried[i + 1, j]
                east += change * gap_compliance[e, j]
            if ks == 0:
                south -= slope.south[i, j] * (xs - here) * gap_compliance[i, j - 1]
            if kn == 0:
                north += slope.north[i, j + 1] * (here - xn) * gap_compliance[i, j + 1]
            if own == 0:
                change = slope.west[i + 1, j] * (here - behind)
                if cx[i + 1, j] >= 0.0:
                    change += slope.carried[i + 1, j] * full
                change -= slope.east[i, j] * (before - here)
                if cx[i, j] < 0.0:
                    change -= slope.carried[i, j] * full
                ys = 0.0 if ks == 1 else xs
                yn = 0.0 if kn == 1 else xn
                change += slope.south[i, j + 1] * (here - yn) - slope.north[i, j] * (ys - here)
                change += frequency * film.squeeze[i, j]
                leaving += change * gap_compliance[i, j]
            stencil[r, 0], stencil[r, 1], stencil[r, 2] = west, south, leaving
            stencil[r, 3], stencil[r, 4] = north, east


@inlined
def _floored(gap: float, roughness: float) -> float:
    """Gap that changes are compared with, positive also where faces overlap. [m]."""
    return max(gap, 0.1 * roughness + 1e-9)


@kernel
def _take(
    kind: IntArray,
    walls: tuple[Array, Array],
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
    gap, touch = walls
    rows, lanes = kind.shape
    largest = 0.0
    for i in range(rows):
        for j in range(lanes):
            if kind[i, j] == 0:
                change = abs(touch[3, i, j] * step[i * lanes + j])
                largest = max(largest, change / _floored(gap[i, j], roughness))
    most = careful if largest > _MUCH else 1.0
    for i in range(rows):
        for j in range(lanes):
            r, part, change = i * lanes + j, most, 0.0
            contact[i, j] = 0.0
            if kind[i, j] == 2:
                continue
            if kind[i, j] == 0:
                change = touch[3, i, j] * step[r]
                room = _LONGEST * _floored(gap[i, j], roughness)
                part = min(part, room / max(abs(change), 1e-300))
            unknown[r] += part * step[r]
            contact[i, j] = max(touch[0, i, j] + part * touch[1, i, j] * change, 0.0)
    return largest


class _Pass(NamedTuple):
    gap: Array
    rate: Array  # of the whole gap [m/s]
    touch: Array  # contact, slope, share, change of the gap over that of the potential
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
    given = None if former is None else former.given
    if given is None or former is None or former.plane.film.grid is not film.grid:
        above = film.grid.prescribed - lowest
        given = GivenPressures(fluid.reduced_grid(film.grid), fluid.reduced_law(lowest), above)
    known = film.grid.mark == PRESCRIBED
    if former is None:
        potential = np.where(known, given.grid.prescribed - given.law.floor, 0.0)
        unknown, kind = potential.ravel(), np.where(known, PRESCRIBED, SATURATED)
    else:
        fields, kind = former.plane.fields, former.kind.copy()
        potential = fields.potential
        if former.given is not given:
            bare = kind == PRESCRIBED
            kind[bare] = SATURATED
            kind[known] = PRESCRIBED
            potential = np.where(known, given.grid.prescribed - given.law.floor, potential)
            _carry(bare, kind, film.grid.sweep_x, fields.potential, potential)
        unknown = np.where(kind == UNSATURATED, fields.saturation, potential).ravel()
    contact = np.zeros(kind.shape) if former is None else former.contact
    settled = False
    system = None if former is None else former.plane.fields.system
    balance = None
    if former is not None and former.found is not None and former.given is given:
        balance = former.found.balance
    for number in range(1, how.accuracy.passes + 1):
        now = _linearise(film, given, carrier, how, unknown, kind, contact, system, balance)
        gap, system, balance = now.gap, now.system, now.found.balance
        step = now.system.solve(now.right, relative_tolerance=how.accuracy.linear)
        lost = not np.isfinite(step).all()
        if lost:
            step = np.zeros_like(step)
        contact = np.empty_like(gap)
        careful = _CAREFUL if number > _PATIENCE else 1.0
        largest = _take(kind, (gap, now.touch), how.roughness, careful, step, unknown, contact)
        used, scale = kind.copy(), _largest(kind, unknown)
        changed = exchange_kinds(kind, unknown, scale, now.found.balance.storage)
        _put_on_bound(used, kind, unknown)
        settled = changed == 0 and largest <= how.accuracy.settled and not lost
        if settled or lost:
            break
    final, filled, gauge, fluidity = (np.empty_like(gap) for _ in range(4))
    _fields(kind, unknown, given, 1.0 / fluid.dynamic_viscosity, (final, filled, gauge, fluidity))
    fields = ComplementaritySolution(final, filled, used, now.system, number, settled)
    deformed = deformed_gap(film.gap, gap - film.gap.centre, film.grid.sweep_x)
    status = Status.DONE if settled else Status.NOT_CONVERGED
    liquid = FluidField(fluidity, fluid.density(gauge + lowest))
    film = replace(film, gap=deformed._replace(rate=now.rate))
    plane = PlaneSolution(gauge, liquid, now.found.balance, fields, status, film)
    slope, share = now.touch[1], now.touch[2]
    found, pace = now.found, how.frequency
    return CompliantSolution(plane, contact, slope, share, kind, largest, found, given, pace)


@kernel
def _largest(kind: IntArray, unknown: Array) -> float:
    """Largest potential of saturated cells. [Pa]."""
    found, lanes = 0.0, kind.shape[1]
    for i in range(kind.shape[0]):
        for j in range(lanes):
            if kind[i, j] == 0:
                found = max(found, abs(unknown[i * lanes + j]))
    return found


@kernel
def _put_on_bound(used: IntArray, kind: IntArray, unknown: Array) -> None:
    """Saturation one or potential zero where the kind was exchanged."""
    lanes = kind.shape[1]
    for i in range(kind.shape[0]):
        for j in range(lanes):
            if kind[i, j] != used[i, j]:
                unknown[i * lanes + j] = 1.0 if kind[i, j] == 1 else 0.0


@kernel
def _fields(
    kind: IntArray,
    unknown: Array,
    given: GivenPressures,
    fluidity: float,
    out: tuple[Array, Array, Array, Array],
) -> None:
    """Potential, saturation, pressure above the lowest one and fluidity of every cell.

    ``fluidity`` is that at zero pressure. [1/(Pa s)]
    """
    potential, saturation, gauge, fluid = out
    lanes = kind.shape[1]
    for i in range(kind.shape[0]):
        for j in range(lanes):
            value, empty = unknown[i * lanes + j], kind[i, j] == 1
            potential[i, j] = 0.0 if empty else value
            saturation[i, j] = value if empty else 1.0
            pressure, stretch = pressure_above(max(potential[i, j], 0.0), given.law)
            gauge[i, j], fluid[i, j] = pressure, fluidity / stretch


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
    fields, sweep, share = plane.fields, plane.film.grid.sweep_x, solution.gap_slope
    # asperities hold off a part of the motion, at the pace of the step
    held = solution.frequency * (share - 1.0)
    flows = [np.empty_like(fields.potential) for _ in lifts]
    for lift, out in zip(lifts, flows, strict=True):
        motion = GapMotion(lift._replace(rate=lift.rate + held * lift.centre), share)
        own = share * lift.centre
        flow_change(found, sweep, motion, fields.potential, fields.saturation, own, out)
    return solved_responses(fields, flows, linear)


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
    given: GivenPressures,
    carrier: FluidField,
    how: LocalCompliance,
    unknown: Array,
    kind: IntArray,
    contact: Array,
    former: LinearSystem | None,
    balance: CellBalance | None,
) -> _Pass:
    height, touch = np.empty(kind.shape), np.empty((4, *kind.shape))
    walls, base = (given.prescribed, contact), film.gap.centre
    settle_gap(kind, unknown, base, walls, given.law, how, height, touch)
    opening = height - base
    rate = film.gap.rate + how.frequency * opening
    rims = np.vstack([film.grid.south, film.grid.north]) - given.law.lowest - how.reference
    deformed = DeformedGap(film.gap._replace(rate=rate), opening, how.compliance * rims)
    law = film.law
    found = linearised_balance(given.grid, deformed, carrier, given.law.floor, law, balance)
    stencil, right = np.empty((kind.size, 5)), np.empty(kind.size)
    _assemble(found, kind, unknown, touch[3], how.frequency, stencil, right)
    system: LinearSystem | None = block_system(stencil, kind, former)
    if system is None:
        system = direct_system(stencil, kind, empty_band(*kind.shape))
    return _Pass(height, rate, touch, found, system, right)


def deformed_gap(gap: GapField, deformation: Array, sweep: Array) -> GapField:
    """Gap with a deformation: along the motion that of the cell upstream."""
    along, across = np.empty(gap.face_x.shape), np.empty(gap.face_y.shape)
    fill_deformed_faces(gap, deformation, sweep, along, across)
    return gap._replace(centre=gap.centre + deformation, face_x=along, face_y=across)


@njit(nogil=True)
def fill_deformed_faces(
    gap: GapField, deformation: Array, sweep: Array, along: Array, across: Array
) -> None:
    """Fill the gap at the faces of the cells; arguments as for :func:`deformed_gap`."""
    rows, lanes = deformation.shape
    for i in range(rows + 1):
        for j in range(lanes):
            up = i - 1 if sweep[i, j] >= 0.0 else i
            along[i, j] = gap.face_x[i, j] + deformation[up % rows, j]
    for i in range(rows):
        for j in range(lanes + 1):
            south, north = deformation[i, max(j - 1, 0)], deformation[i, min(j, lanes - 1)]
            across[i, j] = gap.face_y[i, j] + 0.5 * (south + north)
