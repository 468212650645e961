"""Pressure, film fraction and liquid of a film of given gap."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, field
from typing import NamedTuple, final

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.core.types import Array, IntArray
from toothspace.films.reynolds.equation import FilmGrid, FluidField, GapField, film_balance
from toothspace.films.reynolds.fluid import FilmFluid
from toothspace.films.reynolds.rough_surfaces import SMOOTH, FlowLaw, mean_gap
from toothspace.numerics.acceleration import Mixing
from toothspace.numerics.complementarity import (
    ComplementaritySolution,
    Constraint,
    face_flows,
    solve_complementarity,
)
from toothspace.numerics.linear_system import PRESCRIBED
from toothspace.numerics.structured_grid import CellBalance

FLUID_PASSES = 120
"""Most iterations of the density with the pressure. [-]"""
FLUID_TOLERANCE = 1e-10
"""Change of the pressure over its maximum at which they end. [-]"""
LEAST_PRESSURE = 1e4
"""Pressure below which no liquid changes. [Pa]"""
ROUNDING = 1e-12
"""Part of the flow that potentials drive, up to which a film counts as without flow. [-]"""
RUNAWAY_PASSES = 8
"""Passes in succession without a finite pressure after which there is none. [-]"""
MIXED_PASSES = 8
"""Former passes whose densities the next one is mixed from. [-]"""
ROUNDED = 1e-11
"""Density that is lacking up to which the passes have settled: round-off. [-]"""


@final
@dataclass(frozen=True)
class FilmHistory:
    """Liquid that the film held one time step ago."""

    content: Array
    """Film fraction times gap height times relative density, on the solved cells. [m]"""
    time_step: float
    """Time that has passed since. [s]"""


@dataclass(frozen=True)
class FilmProblem:
    """What is solved: grid, gap, liquid, walls and cavitation."""

    grid: FilmGrid
    gap: GapField
    fluid: FilmFluid
    cavitation_pressure: float  # [Pa]
    constraint: Constraint
    law: FlowLaw = SMOOTH


@dataclass(frozen=True)
class FilmState:
    """Solved film. The potential of ``fields`` is the reduced pressure above the cavity's."""

    gauge: Array = field(repr=False)
    """Pressure above the cavitation pressure. [Pa]"""
    fluid: FluidField = field(repr=False)
    """Liquid at the pressure of the cells."""
    balance: CellBalance = field(repr=False)
    """Balance in the reduced pressure. [Pa, m3/s]"""
    fields: ComplementaritySolution = field(repr=False)
    """Its solution."""
    status: Status
    """Whether there is a solution and the iterations settled."""


def solve_state(
    film: FilmProblem,
    start: IntArray | None = None,
    history: Callable[[CellBalance, Array], CellBalance] | None = None,
) -> FilmState:
    """Pressure and film fraction; the density is iterated with the pressure.

    Parameters
    ----------
    film : FilmProblem
        Film.
    start : ndarray of int, optional
        Kinds of the cells to begin with, as of a former solution.
    history : callable, optional
        Adds to a balance, at a density of the cells, what the film held before.

    Returns
    -------
    FilmState
        Fields and status: ``RUNAWAY`` if no finite pressure balances the flow.
    """
    fluid, lowest = film.fluid, film.cavitation_pressure
    grid, floor = fluid.reduced_grid(film.grid), fluid.reduced_of(lowest)
    density = fluid.density(np.full(film.gap.centre.shape, lowest))
    gauge, lost = np.zeros_like(density), 0
    mixing = Mixing(MIXED_PASSES)
    for number in range(1, FLUID_PASSES + 1):
        balance = film_balance(grid, film.gap, fluid.carrier(density), floor, film.law)
        if history is not None:
            balance = history(balance, density)
        fields = _solve(balance, film.constraint, start)
        reduced = np.maximum(fields.potential, 0.0) + floor
        lost = lost + 1 if float(reduced.max()) >= fluid.highest_reduced else 0
        found = np.maximum(fluid.pressure(reduced) - lowest, 0.0)
        change, gauge, start = float(np.abs(found - gauge).max()), found, fields.kind
        error = fluid.density(gauge + lowest) - density
        settled = not fluid.compressible or change <= FLUID_TOLERANCE * max(
            float(gauge.max()) + lowest, LEAST_PRESSURE
        )
        settled = settled or float(np.abs(error).max()) <= ROUNDED
        if settled or lost >= RUNAWAY_PASSES or number == FLUID_PASSES:
            break
        density = mixing.following(density.ravel(), error.ravel()).reshape(error.shape)
    status = Status.DONE if settled and fields.converged else Status.NOT_CONVERGED
    status = Status.RUNAWAY if lost else status
    return FilmState(gauge, fluid.fields(gauge + lowest), balance, fields, status)


def memory(
    film: FilmProblem, history: FilmHistory | None
) -> Callable[[CellBalance, Array], CellBalance] | None:
    """Implicit Euler step of the content of the cells in place of the squeeze velocity.

    Parameters
    ----------
    film : FilmProblem
        Film at the end of the time step.
    history : FilmHistory, optional
        What it held at the beginning; the result is None without.

    Raises
    ------
    CaseError
        If the film had other cells.
    """
    if history is None:
        return None
    height = mean_gap(film.gap.centre, film.law) + film.gap.step
    if history.content.shape != height.shape:
        raise CaseError(
            f"history: found {history.content.shape} cells, allowed are {height.shape}: keep the "
            "grid, and the tilt zero or not zero"
        )
    rate = film.grid.area / history.time_step
    gained = history.content * rate

    def remember(balance: CellBalance, density: Array) -> CellBalance:
        return balance._replace(storage=density * height * rate, source=gained)

    return remember


class Exchange(NamedTuple):
    """What a film exchanges with its edges and cells of given pressure."""

    outflow: float
    """Flow out of the film, wherever it leaves. [m3/s]"""
    power: float
    """Power that the pressures of what flows in and out bring into the film. [W]"""


def exchange(grid: FilmGrid, balance: CellBalance, fields: ComplementaritySolution) -> Exchange:
    """Flow out of the free cells and the power of the given pressures, of the solved part.

    Parameters
    ----------
    grid : FilmGrid
        Grid with its given pressures. [Pa]
    balance : CellBalance
        Balance that was solved. [Pa, m3/s]
    fields : ComplementaritySolution
        Its solution.
    """
    flow_x, flow_y = face_flows(
        balance, balance, np.maximum(fields.potential, 0.0), fields.saturation
    )
    free = np.pad(grid.mark != PRESCRIBED, 1)
    given = np.pad(grid.prescribed, 1)
    given[0, 1:-1], given[-1, 1:-1] = grid.west, grid.east
    given[1:-1, 0], given[1:-1, -1] = grid.south, grid.north
    if grid.ring:
        free[0], given[0], flow_x = free[-2], given[-2], flow_x[:-1]
    outflow, power = 0.0, 0.0
    for flow, before, after, first, second in (
        (flow_x, free[:-1, 1:-1], free[1:, 1:-1], given[:-1, 1:-1], given[1:, 1:-1]),
        (flow_y, free[1:-1, :-1], free[1:-1, 1:], given[1:-1, :-1], given[1:-1, 1:]),
    ):
        rows = len(flow)
        out = np.where(before[:rows], flow, -flow)
        crossing = before[:rows] != after[:rows]
        pressure = np.where(before[:rows], second[:rows], first[:rows])
        outflow += float(np.maximum(out, 0.0)[crossing].sum())
        power -= float((out * pressure)[crossing].sum())
    return Exchange(outflow, power)


def relative_error(error: float, through: float, balance: CellBalance, potential: Array) -> float:
    """Flow that is missing over the through-flow; zero in a film that only rounding moves. [-]."""
    u = np.abs(potential)
    conducted = float(
        (balance.conductance_x[1:] * u).sum() + (balance.conductance_y[:, 1:] * u).sum()
    )
    return abs(error) / through if through > ROUNDING * conducted else 0.0


def _solve(
    balance: CellBalance, constraint: Constraint, start: IntArray | None
) -> ComplementaritySolution:
    if start is not None and start.shape == balance.storage.shape:
        fields = solve_complementarity(balance, constraint, start, max_passes=15)
        if fields.converged:
            return fields
    return solve_complementarity(balance, constraint)
