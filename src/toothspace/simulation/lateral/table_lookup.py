"""Lumped runs whose lateral films come from tables over the axial load of the run itself."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from toothspace.core.status import Status
from toothspace.model.description import MachineDescription
from toothspace.model.lateral_load import axial_load, chamber_pressures, with_lateral_films
from toothspace.model.operating_point import OperatingCondition
from toothspace.results.solution import Solution
from toothspace.simulation.lateral.coupling import (
    NEGLIGIBLE,
    LumpedRun,
    agree,
    next_change,
    path_leakage,
)
from toothspace.simulation.lateral.loads import node_pressures
from toothspace.simulation.lateral.problem import balance_of

_ROUNDS = 10
_ONE_LOAD = (
    "Lateral films of the table at one load, {:.4g} N, that of gears which turn slowly at a "
    "pressure difference of {:.4g} bar: a run over time does not look them up again."
)
_NOT_AGREED = (
    "The lateral leakage of the table differs from that of the run by {:.2g} % of the displaced "
    "flow: the run does not show the equilibrium of the bearing."
)


def load_of_run(description: MachineDescription, solution: Solution) -> tuple[float, float]:
    """Axial load of the chamber pressures of a run: force [N] and moment [N m].

    Parameters
    ----------
    description : MachineDescription
        Machine with a floating bearing.
    solution : Solution
        Lumped solution of one revolution.
    """
    pressures = node_pressures(description, solution.data)
    return axial_load(balance_of(description), pressures)


def with_table_load(
    description: MachineDescription, condition: OperatingCondition, solution: Solution
) -> Solution:
    """Solution of a run over time with the load at which its lateral films were looked up.

    Parameters
    ----------
    description : MachineDescription
        Machine of the run, with a lateral table.
    condition : OperatingCondition
        Condition at the pressure that the run was expected to reach.
    """
    force, moment = axial_load(balance_of(description), chamber_pressures(description, condition))
    span = abs(condition.outlet_pressure - condition.inlet_pressure)
    told = _ONE_LOAD.format(force, 1e-5 * span)
    return solution.with_note(told, lateral_axial_force=force, lateral_axial_moment=moment)


def run_with_table(description: MachineDescription, run: LumpedRun, slide: float) -> Solution:
    """Lumped solution whose lateral films fit the axial load that its pressures exert.

    Parameters
    ----------
    description : MachineDescription
        Machine with a lateral table.
    run : callable
        Lumped solution of a changed machine at the condition.
    slide : float
        Viscosity times shaft speed at the condition. [Pa]

    Raises
    ------
    CaseError
        If the load found lies outside the table.

    Notes
    -----
    Leakage lowers the pressures that lift the bearing, and a lower bearing leaks less: secant
    method on the logarithm of the leakage factor, kept between opposite errors. It begins with the
    factor of the condition that the table was made at.
    """
    table = description.lateral_table
    assert table is not None
    known: list[tuple[float, float]] = []
    force, moment = table.condition_load
    for number in range(1, _ROUNDS + 1):
        extra, factor = table(force, moment, slide)
        solution = run(with_lateral_films(description, extra, factor))
        if solution.status is not Status.DONE:
            return solution
        load = load_of_run(description, solution)
        error = float(np.log(table(*load)[1] / factor))
        leakage = path_leakage(solution)
        mismatch = leakage * float(np.expm1(error))
        flow = description.displacement * float(solution.data["shaft_speed"].mean())
        agreed = agree(leakage + mismatch, leakage, NEGLIGIBLE * flow)
        if agreed or number == _ROUNDS:
            break
        known.append((float(np.log(factor)), error))
        moment = load[1]
        force = table.force_of(factor * float(np.exp(next_change(known))), moment)
    if agreed:
        table.check(*load)
    status = Status.DONE if agreed else Status.NOT_CONVERGED
    return replace(solution, status=status).with_note(
        "" if agreed else _NOT_AGREED.format(100.0 * mismatch / flow),
        lateral_axial_force=load[0],
        lateral_axial_moment=load[1],
        lateral_leakage_mismatch=mismatch / flow,
    )
