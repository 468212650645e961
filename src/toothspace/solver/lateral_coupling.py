"""Chamber pressures and lateral films brought to agreement, and added to a solution."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import final

import numpy as np

from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.films.lateral_gap.equilibrium import Equilibrium
from toothspace.films.lateral_gap.motion import Balance
from toothspace.films.lateral_gap.stops import leaning
from toothspace.model.description import MachineDescription
from toothspace.model.lateral_table import LATERAL_PATHS, axial_load, with_lateral_leakage
from toothspace.results.solution import Solution, warned
from toothspace.results.variables import VARIABLES
from toothspace.solver.cyclic import Progress
from toothspace.solver.lateral_gap import (
    LateralNumbers,
    LateralProblem,
    LateralSettings,
    film_fields,
    film_places,
    lateral_problem,
    numbers_of,
    with_lateral_torque,
)
from toothspace.solver.lateral_heat import HeatedEquilibrium, settle_heated
from toothspace.solver.lateral_loads import face_deflection

LumpedRun = Callable[[MachineDescription], Solution]
"""Lumped solution of a machine at the operating point."""

_AGREEMENT = 0.02
"""Difference of leakage at which films and chambers agree. [-]"""
_NEGLIGIBLE = 5e-4
"""Difference of leakage over displaced flow at which films and chambers agree. [-]"""
_TOLERATED = 0.01
"""Difference of leakage over displaced flow above which a point has failed. [-]"""
_LONGEST_CHANGE = 3.0
"""Largest change of the logarithm of the leakage of the paths in one round. [-]"""


@final
@dataclass(frozen=True, kw_only=True)
class PointRequest:
    """What is asked of one operating point.

    Parameters
    ----------
    settings : LateralSettings
        Grids and laws of the films.
    start : ndarray or float
        Positions and rotations of all bodies, or a gap everywhere, to begin with. [m, rad]
    nose_pressure : float or None
        Absolute pressure on the nose; None: the low pressure. [Pa]
    rounds : int
        Most lumped runs at this point; one leaves the paths of the network as they are.
    """

    settings: LateralSettings
    start: Array | float
    nose_pressure: float | None = None
    rounds: int = 6


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
    agreed : bool
        Whether films and paths were brought to agree, or were not meant to be, and temperatures
        with the power dissipated.
    temperatures : ndarray or None
        Mean temperature of every film; None at the temperature of the fluid. [K]
    """

    solution: Solution
    description: MachineDescription
    problem: LateralProblem
    equilibrium: Equilibrium
    numbers: LateralNumbers
    leakage_mismatch: float
    agreed: bool = True
    temperatures: Array | None = None

    @property
    def temperature_rise(self) -> float | None:
        """Temperature of the hottest film above the fluid; None where none warms up. [K]."""
        heating = self.problem.settings.heating
        if self.temperatures is None or heating is None:
            return None
        return float(self.temperatures.max()) - heating.balance.supply_temperature

    @property
    def status(self) -> Status:
        """Outcome of the lumped run, or failure of the force balance or of the agreement."""
        settled = self.equilibrium.rests and self.agreed
        return self.solution.status if settled else Status.NOT_CONVERGED


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
    Secant method on the logarithm of the factor by which the lumped lateral and drain paths leak
    more; the film heights of the faces are set to drag like the films.
    """
    known: list[tuple[float, float]] = []
    widened = 0.0
    description = replace(description, lateral_table=None)
    for number in range(1, request.rounds + 1):
        solution = run(description)
        problem = lateral_problem(
            description, fluid, solution.data, request.settings, request.nose_pressure
        )
        start = request.start
        begun = problem.started(start) if isinstance(start, float) else problem.continued(start)
        problem, found, warm = _settled(problem, begun)
        numbers = numbers_of(problem, found.balance)
        paths = solution.data["leakage"].sel(path=list(LATERAL_PATHS))
        lumped = float(paths.sum("path").mean())
        mismatch = numbers.leakage - lumped
        flow = description.displacement * problem.stack.shaft_speed
        close = abs(mismatch) <= max(_AGREEMENT * abs(numbers.leakage), _NEGLIGIBLE * flow)
        agreed = request.rounds == 1 or abs(mismatch) <= max(
            _AGREEMENT * abs(numbers.leakage), _TOLERATED * flow
        )
        own = None if warm is None else warm.temperatures
        agreed = agreed and (warm is None or warm.agreed)
        point = CoupledPoint(
            solution, description, problem, found, numbers, mismatch / flow, agreed, own
        )
        if close or number == request.rounds:
            return point
        if lumped > 0.0 and numbers.leakage > 0.0:
            known.append((widened, float(np.log(numbers.leakage / lumped))))
            change = next_change(known)
            widened += change
            description = with_lateral_leakage(description, float(np.exp(change)))
        description = _with_drag(description, solution, numbers)
    return point


def _settled(
    problem: LateralProblem, begun: Balance
) -> tuple[LateralProblem, Equilibrium, HeatedEquilibrium | None]:
    """Bearing at rest, with films that warm up where they are meant to."""
    if problem.settings.heating is None:
        return problem, problem.settle(begun), None
    found = settle_heated(problem, begun, problem.settings.heating)
    return found.problem, found.equilibrium, found


def next_change(known: list[tuple[float, float]]) -> float:
    """Change of the logarithm of the paths' leakage; secant between opposite errors.

    Parameters
    ----------
    known : list of tuple
        Logarithms that were tried, and by how much the leakage asked for differs. [-]
    """
    place, error = known[-1]
    opposite = [(s, e) for s, e in known if e * error < 0.0]
    if opposite:
        other, before = min(opposite, key=lambda pair: abs(pair[0] - place))
        share = float(np.clip(error / (error - before), 0.2, 0.8))
        return share * (other - place)
    return float(np.clip(error, -_LONGEST_CHANGE, _LONGEST_CHANGE))


def _with_drag(
    description: MachineDescription, solution: Solution, numbers: LateralNumbers
) -> MachineDescription:
    lumped = float(solution.data["torque_loss"].sel(mechanism="lateral_viscous").mean())
    found = numbers.viscous_torque + numbers.asperity_torque
    if lumped <= 0.0 or found <= 0.0:
        return description
    return with_lateral_torque(description, float(np.clip(found / lumped, 1e-2, 1e2)))


def coupled_solution(
    asked: tuple[MachineDescription, FluidLaw, PointRequest],
    run: LumpedRun,
    steps: int,
    progress: Progress | None = None,
) -> Solution:
    """Operating point with its lateral films over one revolution.

    Parameters
    ----------
    asked : tuple
        Machine, fluid and what is asked of them, as for :func:`couple_point`.
    run : callable
        Lumped solution at the operating point, of a changed machine.
    steps : int
        Steps of the march over the revolution. [-]
    progress : callable, optional
        Called with a fraction and a text.

    Raises
    ------
    KeyboardInterrupt
        If interrupted before there was a lumped solution; a later interrupt keeps what is done.
    """
    done: list[Solution] = []

    def lumped(changed: MachineDescription) -> Solution:
        done.append(run(changed))
        if done[-1].status is Status.INTERRUPTED:
            raise KeyboardInterrupt
        if progress:
            progress(1.0, "lateral films come to rest")
        return done[-1]

    try:
        description, fluid, request = asked
        point = couple_point(description, fluid, lumped, request)
        return elastic_solution(point, steps, progress)
    except KeyboardInterrupt:
        if not done:
            raise
        return replace(done[-1], status=Status.INTERRUPTED)


def elastic_solution(point: CoupledPoint, steps: int, progress: Progress | None = None) -> Solution:
    """Solution of an operating point with its lateral films over one revolution.

    Parameters
    ----------
    point : CoupledPoint
        Chambers and films in agreement.
    steps : int
        Steps of the march over the revolution. [-]
    progress : callable, optional
        Called after every step with a fraction and a text.

    Returns
    -------
    Solution
        The lumped solution with film fields at the end of the revolution and the position of
        the bearing at every sample; of an interrupted march as far as it came.

    Raises
    ------
    KeyboardInterrupt
        If interrupted before the first step.
    """
    march = point.problem.march(point.equilibrium.balance, steps, progress=progress)
    stack = point.problem.stack
    data = point.solution.data
    angle = np.mod(data["shaft_angle"].values, 2.0 * np.pi)
    position = np.interp(angle, march.shaft_angle, march.positions, period=2.0 * np.pi)
    values: dict[str, tuple[tuple[str, ...], object, dict[str, str]]] = {}
    fields = {**film_fields(march.last), **film_places(stack)}
    fields["film_wear_power"] = march.wear
    if point.temperatures is not None:
        fields["film_temperature"] = point.temperatures
    for name, field in fields.items():
        values[name] = _entry(name, field)
    values["bearing_position"] = (("shaft_angle",), position, _entry("bearing_position", 0)[2])
    data = data.assign(values).assign_coords(
        film=("film", [grid.interface.name for grid in stack.grids])
    )
    data = data.set_coords(list(film_places(stack)))
    status = point.status if march.converged else Status.NOT_CONVERGED
    status = Status.INTERRUPTED if march.interrupted else status
    statistics = {
        **point.solution.statistics,
        **_statistics(point.numbers, point.leakage_mismatch),
        **_axial_load(point.problem),
        **_warmth(point),
        "pressed_bearing_preload": stack.balance.floating.preload,
        "lateral_iterations": float(sum(march.iterations)),
        "lateral_rest_residual": point.equilibrium.balance.residual,
        "lateral_residual": float(max(march.residuals)),
        **face_deflection(march.last.states[0]),
    }
    warnings = filter(None, [seat_warning(point.numbers), rest_warning(point)])
    provenance = warned(point.solution.provenance, "\n".join(warnings))
    return replace(
        point.solution, status=status, data=data, statistics=statistics, provenance=provenance
    )


def seat_warning(numbers: LateralNumbers) -> str:
    """Tell what is wrong with the seat of the solid bearing, nothing if it sits on its cover."""
    if numbers.seat_force <= 0.0:
        return (
            f"The solid bearing lifts off its cover: {-numbers.seat_force:.4g} N are missing "
            "at one shaft angle at least."
        )
    if numbers.seat_margin < 0.0:
        return (
            "The solid bearing tips on its cover: it is pressed "
            f"{-numbers.seat_margin * 1e3:.3g} mm beyond its rim at one shaft angle at least."
        )
    return ""


def rest_warning(point: CoupledPoint) -> str:
    """Tell why bearing and gears do not rest, or on what they lean; nothing if films carry all."""
    found = point.equilibrium
    if not found.rests:
        return f"Bearing and gears do not come to rest: {found.reason}."
    held = leaning(point.problem.stack, found.balance.position)
    return f"At rest {'; '.join(held)}." if held else ""


def _entry(name: str, value: object) -> tuple[tuple[str, ...], object, dict[str, str]]:
    entry = VARIABLES[name]
    return entry.dimensions, value, {"long_name": entry.long_name, "units": entry.units}


def _axial_load(problem: LateralProblem) -> dict[str, float]:
    force, moment = axial_load(problem.stack.balance, problem.node_pressure)
    return {"lateral_axial_force": force, "lateral_axial_moment": moment}


def _warmth(point: CoupledPoint) -> dict[str, float]:
    rise = point.temperature_rise
    return {} if rise is None else {"lateral_temperature_rise": rise}


def _statistics(numbers: LateralNumbers, mismatch: float) -> dict[str, float]:
    return {
        "lateral_leakage": numbers.leakage,
        "lateral_leakage_mismatch": mismatch,
        "lateral_torque": numbers.viscous_torque + numbers.asperity_torque,
        "lateral_smallest_gap": numbers.smallest_gap,
        "lateral_contact_force": numbers.contact_force,
        "lateral_real_contact_area": numbers.real_contact_area,
        "lateral_contact_share": numbers.contact_share,
        "lateral_wear_power": numbers.wear_power,
        "lateral_housing_friction": numbers.friction_force,
        "solid_bearing_seat_force": numbers.seat_force,
        "solid_bearing_seat_margin": numbers.seat_margin,
    }
