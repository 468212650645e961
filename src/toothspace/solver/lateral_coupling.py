"""Chamber pressures and lateral films brought to agreement, and added to a solution."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.status import Status
from toothspace.films.lateral_gap.equilibrium import Equilibrium
from toothspace.films.lateral_gap.motion import Balance
from toothspace.model.description import MachineDescription
from toothspace.results.solution import Solution
from toothspace.results.variables import VARIABLES
from toothspace.solver.lateral_gap import (
    LateralNumbers,
    LateralProblem,
    LateralSettings,
    film_fields,
    lateral_problem,
    numbers_of,
    with_lateral_leakage,
    with_lateral_torque,
)

LumpedRun = Callable[[MachineDescription], Solution]
"""Lumped solution of a machine at the operating point."""

_LATERAL_PATHS = ("lateral", "drain")
_AGREEMENT = 0.02
"""Difference of leakage at which films and chambers agree. [-]"""
_NEGLIGIBLE = 5e-4
"""Difference of leakage over displaced flow at which films and chambers agree. [-]"""


@final
@dataclass(frozen=True, kw_only=True)
class PointRequest:
    """What is asked of one operating point.

    Parameters
    ----------
    settings : LateralSettings
        Grids and laws of the films.
    start : Balance or float
        State of the point before, or a gap everywhere to begin with. [m]
    nose_pressure : float or None
        Absolute pressure on the nose; None: the low pressure. [Pa]
    rounds : int
        Most lumped runs at this point.
    """

    settings: LateralSettings
    start: Balance | float
    nose_pressure: float | None = None
    rounds: int = 2


@final
@dataclass(frozen=True, eq=False)
class CoupledPoint:
    """Films, bearing and chambers at one operating point.

    Parameters
    ----------
    solution : Solution
        Last lumped solution.
    description : MachineDescription
        The machine with the lateral gaps that were found.
    problem : LateralProblem
        Films and loads.
    equilibrium : Equilibrium
        Where the bearing came to rest.
    numbers : LateralNumbers
        Mean numbers of the films.
    leakage_mismatch : float
        Leakage of films less that of the lumped paths, over the displaced flow. [-]
    """

    solution: Solution
    description: MachineDescription
    problem: LateralProblem
    equilibrium: Equilibrium
    numbers: LateralNumbers
    leakage_mismatch: float

    @property
    def status(self) -> Status:
        """Outcome of the lumped run, or failure of the force balance."""
        return self.solution.status if self.equilibrium.rests else Status.NOT_CONVERGED


def couple_point(
    description: MachineDescription, fluid: FluidLaw, run: LumpedRun, request: PointRequest
) -> CoupledPoint:
    """Find gaps and chamber pressures that agree about the lateral leakage.

    Parameters
    ----------
    description : MachineDescription
        The machine after running-in.
    fluid : FluidLaw
        Fluid.
    run : callable
        Lumped solution at the operating point, of a changed machine.
    request : PointRequest
        Start and settings.

    Notes
    -----
    Fixed point: the lumped lateral and drain paths are widened until they leak like the films,
    and the film heights of the faces are set to drag like them.
    """
    for number in range(1, request.rounds + 1):
        solution = run(description)
        problem = lateral_problem(
            description, fluid, solution.data, request.settings, request.nose_pressure
        )
        start = request.start
        begun = problem.started(start) if isinstance(start, float) else problem.continued(start)
        found = problem.settle(begun)
        numbers = numbers_of(problem, found.balance)
        paths = solution.data["leakage"].sel(path=list(_LATERAL_PATHS))
        lumped = float(paths.sum("path").mean())
        mismatch = numbers.leakage - lumped
        flow = description.displacement * problem.stack.shaft_speed
        point = CoupledPoint(solution, description, problem, found, numbers, mismatch / flow)
        close = abs(mismatch) <= max(_AGREEMENT * abs(numbers.leakage), _NEGLIGIBLE * flow)
        if close or number == request.rounds:
            return point
        if lumped > 0.0 and numbers.leakage > 0.0:
            factor = float(np.clip(numbers.leakage / lumped, 1e-3, 1e3))
            description = with_lateral_leakage(description, factor)
        description = _with_drag(description, solution, numbers)
    return point


def _with_drag(
    description: MachineDescription, solution: Solution, numbers: LateralNumbers
) -> MachineDescription:
    lumped = float(solution.data["torque_loss"].sel(mechanism="lateral_viscous").mean())
    found = numbers.viscous_torque + numbers.asperity_torque
    if lumped <= 0.0 or found <= 0.0:
        return description
    return with_lateral_torque(description, float(np.clip(found / lumped, 1e-2, 1e2)))


def elastic_solution(point: CoupledPoint, steps: int) -> Solution:
    """Solution of an operating point with its lateral films over one revolution.

    Parameters
    ----------
    point : CoupledPoint
        Chambers and films in agreement.
    steps : int
        Steps of the march over the revolution. [-]

    Returns
    -------
    Solution
        The lumped solution with film fields at the end of the revolution and the position of
        the bearing at every sample.
    """
    march = point.problem.march(point.equilibrium.balance, steps)
    stack = point.problem.stack
    track = np.array([stack.gauge(balance.position) for balance in march.balances])
    data = point.solution.data
    angle = np.mod(data["shaft_angle"].values, 2.0 * np.pi)
    position = np.interp(angle, march.shaft_angle, track, period=2.0 * np.pi)
    values: dict[str, tuple[tuple[str, ...], object, dict[str, str]]] = {}
    for name, field in film_fields(march.balances[-1]).items():
        values[name] = _entry(name, field)
    values["bearing_position"] = (("shaft_angle",), position, _entry("bearing_position", 0)[2])
    data = data.assign(values).assign_coords(
        film=("film", [grid.interface.name for grid in stack.grids])
    )
    status = point.status if march.converged else Status.NOT_CONVERGED
    statistics = {
        **point.solution.statistics,
        **_statistics(point.numbers, point.leakage_mismatch),
        "lateral_iterations": float(sum(b.iterations for b in march.balances)),
        "lateral_residual": float(max(b.residual for b in march.balances)),
    }
    return replace(point.solution, status=status, data=data, statistics=statistics)


def _entry(name: str, value: object) -> tuple[tuple[str, ...], object, dict[str, str]]:
    entry = VARIABLES[name]
    return entry.dimensions, value, {"long_name": entry.long_name, "units": entry.units}


def _statistics(numbers: LateralNumbers, mismatch: float) -> dict[str, float]:
    return {
        "lateral_leakage": numbers.leakage,
        "lateral_leakage_mismatch": mismatch,
        "lateral_smallest_gap": numbers.smallest_gap,
        "lateral_contact_force": numbers.contact_force,
        "lateral_contact_share": numbers.contact_share,
        "lateral_wear_power": numbers.wear_power,
        "lateral_housing_friction": numbers.friction_force,
        "solid_bearing_seat_force": numbers.seat_force,
    }
