"""Pressure, film fraction and liquid of a film of given gap."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, field
from functools import cached_property
from typing import NamedTuple, final

import numpy as np

from toothspace.core.errors import CaseError
from toothspace.core.status import Status
from toothspace.core.types import Array, IntArray
from toothspace.films.reynolds.equation import (
    FilmGrid,
    FluidField,
    GapField,
    balance_derivative,
    balance_variation,
    film_balance,
)
from toothspace.films.reynolds.fluid import FilmFluid
from toothspace.films.reynolds.rough_surfaces import SMOOTH, FlowLaw, mean_gap
from toothspace.numerics.acceleration import Mixing
from toothspace.numerics.complementarity import (
    ComplementaritySolution,
    Constraint,
    face_flows,
    residual,
    solve_complementarity,
)
from toothspace.numerics.linear_system import PRESCRIBED, SATURATED, TIGHT
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
    weight: float = 1.0  # 2 if the film is half of a mirrored one [-]


class Exchange(NamedTuple):
    """What a film exchanges with its edges and cells of given pressure."""

    outflow: float
    """Flow out of the film, wherever it leaves. [m3/s]"""
    power: float
    """Power that the pressures of what flows in and out bring into the film. [W]"""


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
    film: FilmProblem = field(repr=False)
    """What was solved."""

    @property
    def pressure(self) -> Array:
        """Absolute pressure of the cells. [Pa]."""
        return self.gauge + self.film.cavitation_pressure

    def history(self, time_step: float) -> FilmHistory:
        """What the film holds, as the past of a film one time step later. [s]."""
        film = self.film
        height = mean_gap(film.gap.centre, film.law) + film.gap.step
        return FilmHistory(self.fields.saturation * self.fluid.density * height, time_step)

    def responses(
        self, changes: Sequence[GapField], relative_tolerance: float = TIGHT
    ) -> list[Array]:
        """Change of the pressure with each change of the gap; the density is held. [Pa per unit].

        As :meth:`reduced_responses`.
        """
        # the pressure follows the reduced one with the viscosity ratio
        stretch = self._carrier.fluidity / self.fluid.fluidity
        return [stretch * found for found in self.reduced_responses(changes, relative_tolerance)]

    def reduced_responses(
        self, changes: Sequence[GapField], relative_tolerance: float = TIGHT
    ) -> list[Array]:
        """Change of the reduced pressure with each change of the gap, cavity boundary exact.

        [Pa per unit]

        Parameters
        ----------
        changes : sequence of GapField
            Changes of gap and rate per unit of a motion, ``step`` unused. [m and m/s per unit]
        relative_tolerance : float
            Residual of the linear solution over its right-hand side. [-]
        """
        now = self.film.grid, self.film.gap, self._carrier
        slope = balance_derivative(*now, self.balance, self.film.law)
        varied = (balance_variation(*now, change, slope, self.film.law) for change in changes)
        u, s = self.fields.potential, self.fields.saturation
        flows = [residual(self.balance, change, u, s) for change in varied]
        return solved_responses(self.fields, flows, relative_tolerance)

    @property
    def _carrier(self) -> FluidField:
        return self.film.fluid.carrier(self.fluid.density)

    @cached_property
    def flows(self) -> tuple[Array, Array]:
        """Flows through the faces of the solved part along both indices. [m3/s]."""
        b, fields = self.balance, self.fields
        return face_flows(b, b, np.maximum(fields.potential, 0.0), fields.saturation)

    @property
    def residuals(self) -> Array:
        """Flow out of every cell of the solved part less its source. [m3/s]."""
        b, fields = self.balance, self.fields
        return residual(b, b, np.maximum(fields.potential, 0.0), fields.saturation)

    @cached_property
    def exchange(self) -> Exchange:
        """Flow out of the whole film, and power of the given pressures. [m3/s, W]."""
        grid, (flow_x, flow_y) = self.film.grid, self.flows
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
        return Exchange(self.film.weight * outflow, self.film.weight * power)

    def relative_error(self, error: float, through: float) -> float:
        """Flow that is missing over the through-flow; 0 in a film that only rounding moves. [-]."""
        b, u = self.balance, np.abs(self.fields.potential)
        conducted = float((b.conductance_x[1:] * u).sum() + (b.conductance_y[:, 1:] * u).sum())
        return abs(error) / through if through > ROUNDING * conducted else 0.0


def solve_state(
    film: FilmProblem, start: IntArray | None = None, history: FilmHistory | None = None
) -> FilmState:
    """Pressure and film fraction; the density is iterated with the pressure.

    Fields and status: ``RUNAWAY`` if no finite pressure balances the flow.

    Raises CaseError if the film had other cells one time step ago.

    Parameters
    ----------
    film : FilmProblem
        Film.
    start : ndarray of int, optional
        Kinds of the cells to begin with, as of a former solution.
    history : FilmHistory, optional
        What the film held one time step ago; without, the film follows the motion without delay.
    """
    fluid, lowest = film.fluid, film.cavitation_pressure
    grid, floor = fluid.reduced_grid(film.grid), fluid.reduced_of(lowest)
    density = fluid.density(np.full(film.gap.centre.shape, lowest))
    gauge, lost = np.zeros_like(density), 0
    mixing, remember = Mixing(MIXED_PASSES), _memory(film, history)
    for number in range(1, FLUID_PASSES + 1):
        balance = film_balance(grid, film.gap, fluid.carrier(density), floor, film.law)
        if remember is not None:
            balance = remember(balance, density)
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
    return FilmState(gauge, fluid.fields(gauge + lowest), balance, fields, status, film)


def _memory(
    film: FilmProblem, history: FilmHistory | None
) -> Callable[[CellBalance, Array], CellBalance] | None:
    """Implicit Euler step of the content of the cells in place of the squeeze velocity."""
    if history is None:
        return None
    height = mean_gap(film.gap.centre, film.law) + film.gap.step
    if history.content.shape != height.shape:
        raise CaseError(
            "history",
            f"{history.content.shape} cells",
            f"are {height.shape}: keep the grid, and the tilt zero or not zero",
        )
    rate = film.grid.area / history.time_step
    gained = history.content * rate

    def remember(balance: CellBalance, density: Array) -> CellBalance:
        return balance._replace(storage=density * height * rate, source=gained)

    return remember


def _solve(
    balance: CellBalance, constraint: Constraint, start: IntArray | None
) -> ComplementaritySolution:
    if start is not None and start.shape == balance.storage.shape:
        fields = solve_complementarity(balance, constraint, start, max_passes=15)
        if fields.converged:
            return fields
    return solve_complementarity(balance, constraint)


def solved_responses(
    fields: ComplementaritySolution, flows: Sequence[Array], relative_tolerance: float
) -> list[Array]:
    """Change of a solved pressure with flows added to its balance: sides of one solution. [Pa].

    Parameters
    ----------
    fields
        Solution of the balance.
    flows : sequence of ndarray
        Net flow out of every cell by each. [m3/s]
    relative_tolerance : float
        Residual of the linear solution over its right-hand side. [-]
    """
    known = fields.kind == PRESCRIBED
    sides = np.empty((len(flows), known.size))
    for side, flow in zip(sides, flows, strict=True):
        side[:] = np.where(known, 0.0, -flow).ravel()
    found = fields.system.solve(sides, relative_tolerance=relative_tolerance)
    held = (fields.kind != SATURATED) | (fields.potential <= 0.0)
    return [np.where(held, 0.0, response.reshape(held.shape)) for response in found]
