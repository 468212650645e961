"""Chambers and lateral films in agreement over one revolution, added to a solution."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.progress import UNKNOWN, Progress, tell
from toothspace.core.status import Status
from toothspace.core.units import ZERO_CELSIUS
from toothspace.floating.body_loads import face_deflection
from toothspace.floating.coupling import (
    CoupledPoint,
    LumpedRun,
    PointRequest,
    couple_point,
)
from toothspace.floating.problem import LateralNumbers, film_fields, film_places
from toothspace.floating.stops import leaning
from toothspace.model.description import MachineDescription
from toothspace.model.lateral_load import axial_load
from toothspace.results.solution import Solution
from toothspace.results.variables import VARIABLES

_TOO_WARM = (
    "Lateral films find no temperature up to {:.0f} degC, to which the fluid is known, at which "
    "their viscosity agrees with the heat that they dissipate. Lower operating_point.shaft_speed "
    "or the pressure, or set run.film_oil_share = 0 for films at the temperature of the fluid."
)
_APART = (
    "Lateral films and chambers do not agree: the films leak {:+.2g} % of the displaced flow more "
    "than the chambers lose, and their torque is {:+.2g} % of the ideal torque above that in the "
    "run. Refine run.film_grid, or change the pressure a little."
)

HeatedRun = Callable[[MachineDescription, Callable[[MachineDescription], Solution]], Solution]
"""Solution with temperatures, from a machine and what repeats it with other viscosities."""


def _as_cold(
    description: MachineDescription, run: Callable[[MachineDescription], Solution]
) -> Solution:
    return run(description)


def coupled_solution(
    description: MachineDescription,
    fluid: FluidLaw,
    run: LumpedRun,
    request: PointRequest,
    steps: int,
    progress: Progress | None = None,
    *,
    heated: HeatedRun = _as_cold,
) -> Solution:
    """Operating point with its lateral films over one revolution.

    Parameters
    ----------
    description, fluid, run, request
        Machine, fluid, lumped solution and settings, as for :func:`couple_point`.
    steps : int
        Steps of the march over the revolution. [-]
    progress : callable, optional
        Called with a fraction and a text.
    heated : callable
        Solution of the machine with the temperatures of its films, from one that repeats it with
        other viscosities; without temperatures if not given.

    Raises
    ------
    KeyboardInterrupt
        If interrupted before there was a lumped solution; a later interrupt keeps what is done.
    """
    done: list[Solution] = []
    points: list[CoupledPoint] = []

    def lumped(changed: MachineDescription) -> Solution:
        done.append(run(changed))
        tell(progress, UNKNOWN, f"lateral films settle, round {len(done)}")
        return done[-1]

    def coupled(changed: MachineDescription) -> Solution:
        begun = request
        if points:
            last = points[-1]
            place, factor = last.equilibrium.balance.position, last.log_leakage_factor
            begun = replace(request, start=place, log_leakage_factor=factor)
        points.append(couple_point(changed, fluid, lumped, begun))
        return replace(points[-1].solution, status=points[-1].status)

    try:
        solution = heated(description, coupled)
        # films that would be too warm leave the first point, at the temperature of the fluid
        point = next(p for p in points if p.solution.ledger is solution.ledger)
        return _with_films(point, solution, steps, progress)
    except KeyboardInterrupt:
        if not done:
            raise
        return replace(done[-1], status=Status.INTERRUPTED)


def _with_films(
    point: CoupledPoint, solution: Solution, steps: int, progress: Progress | None
) -> Solution:
    """Lumped solution with film fields at the end of a revolution and the way of the bearing.

    Of an interrupted march as far as it came.
    """
    march = point.problem.march(point.equilibrium.balance, steps, progress=progress)
    stack = point.problem.stack
    data = solution.data
    angle = np.mod(data["shaft_angle"].values, 2.0 * np.pi)
    position = np.interp(angle, march.shaft_angle, march.positions, period=2.0 * np.pi)
    fields = {**film_fields(march.last), **film_places(stack)}
    fields["film_wear_power"] = march.wear
    if point.temperatures is not None:
        fields["film_temperature"] = point.temperatures
    values: dict[str, object] = {}
    for name, field in {**fields, "bearing_position": position}.items():
        entry = VARIABLES[name]
        dimensions = ("shaft_angle",) if field is position else entry.dimensions
        values[name] = dimensions, field, {"long_name": entry.long_name, "units": entry.units}
    data = data.assign(values).assign_coords(
        film=("film", [grid.interface.name for grid in stack.grids])
    )
    data = data.set_coords(list(film_places(stack)))
    status = solution.status if march.converged else Status.NOT_CONVERGED
    status = Status.INTERRUPTED if march.interrupted else status
    force, moment = axial_load(point.problem.stack.balance, point.problem.node_pressure)
    rise, numbers = point.temperature_rise, point.numbers
    return replace(solution, status=status, data=data).with_note(
        hold_down_warning(numbers),
        equilibrium_warning(point),
        lateral_leakage=numbers.leakage,
        lateral_leakage_mismatch=point.leakage_mismatch,
        lateral_torque_mismatch=point.torque_mismatch,
        lateral_torque=numbers.viscous_torque + numbers.asperity_torque,
        lateral_smallest_gap=numbers.smallest_gap,
        lateral_contact_force=numbers.contact_force,
        lateral_real_contact_area=numbers.real_contact_area,
        lateral_contact_share=numbers.contact_share,
        lateral_wear_power=numbers.wear_power,
        lateral_housing_friction=numbers.friction_force,
        solid_bearing_seat_force=numbers.hold_down_force,
        solid_bearing_seat_margin=numbers.tipping_margin,
        lateral_axial_force=force,
        lateral_axial_moment=moment,
        **({} if rise is None else {"lateral_temperature_rise": rise}),
        floating_bearing_preload=stack.balance.floating.preload.size,
        lateral_iterations=float(sum(march.iterations)),
        lateral_equilibrium_residual=point.equilibrium.balance.residual,
        lateral_residual=float(max(march.residuals)),
        **face_deflection(march.last.states[0]),
    )


def hold_down_warning(numbers: LateralNumbers) -> str:
    """Warning that the solid bearing lifts off its cover or tips, empty if it does not."""
    if numbers.hold_down_force <= 0.0:
        return (
            f"The solid bearing lifts off its cover: {-numbers.hold_down_force:.4g} N are missing "
            "at one shaft angle at least."
        )
    if numbers.tipping_margin < 0.0:
        return (
            "The solid bearing tips on its cover: it is pressed "
            f"{-numbers.tipping_margin * 1e3:.3g} mm beyond its rim at one shaft angle at least."
        )
    return ""


def equilibrium_warning(point: CoupledPoint) -> str:
    """Why there is no equilibrium, or on what bodies lean; empty if films carry all."""
    found, heating = point.equilibrium, point.problem.settings.heating
    if not found.settled:
        return f"Bearing and gears do not reach equilibrium: {found.reason}."
    if not point.warm and heating is not None:
        highest = heating.balance.highest_temperature - ZERO_CELSIUS
        return _TOO_WARM.format(highest)
    if not point.agreed:
        return _APART.format(100.0 * point.leakage_mismatch, 100.0 * point.torque_mismatch)
    held = leaning(point.problem.stack, found.balance.position)
    return f"In equilibrium {'; '.join(held)}." if held else ""
