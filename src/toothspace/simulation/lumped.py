"""The ``lumped`` and ``films`` presets: a machine whose chambers are marched until it is cyclic."""

from __future__ import annotations

from dataclasses import dataclass, replace
from typing import Any, final

import numpy as np

from toothspace.case import Case
from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.progress import UNKNOWN, Progress, tell
from toothspace.core.status import Status
from toothspace.model.description import MachineDescription
from toothspace.model.operating_point import OperatingCondition
from toothspace.numerics.roots import next_change
from toothspace.results.solution import Solution
from toothspace.simulation.heating import run_with_heat
from toothspace.simulation.load_orifice import march_against_orifice
from toothspace.simulation.presets import interface_models, interface_text
from toothspace.simulation.running_in import WornMachine, run_in
from toothspace.simulation.setup import Setup, fluid_temperature, provenance_of
from toothspace.solver.accuracy import Assembled, march_to_balance
from toothspace.solver.cyclic import History, RunPlan, first_turn_state
from toothspace.solver.outcome import solution_from

_RARELY = 0.01
_LONGEST_CHANGE = 4.0
"""Largest change of the logarithm of the leakage that seats the bearings, in one run. [-]"""
_SEAT_ROUNDS, _SEATED = 8, 0.05
"""Most runs, and difference of leakage, until bearings sit where the pressures press them."""
_BEYOND = (
    "The load on the lateral films is beyond their table in {:.0f} % of the time, and counts as "
    "its edge: make tables over a wider range."
)
_UNSEATED = (
    "Seats and gaps of the bearings do not agree: the lateral films leak {:.2f} times as much as "
    "the gaps that seat the bearings. Make tables with more pressures and speeds about this point, "
    "or solve the films with fidelity 'elastic'."
)


@final
@dataclass(frozen=True, eq=False)
class RunInMachine:
    """Machine of a case after running-in, for several lumped runs."""

    case: Case
    """Its case."""
    worn: WornMachine
    """The machine after running-in."""
    description: MachineDescription
    """The same with the film tables and the solved films of the case."""
    fluid: FluidLaw
    """Fluid."""
    extra: dict[str, Any]
    """Values that go into every result."""
    provenance: dict[str, str]
    """Where every result comes from."""

    def at(self, condition: OperatingCondition, progress: Progress | None = None) -> RepeatedRun:
        """Lumped runs at a condition, of this machine and of changed ones."""
        return RepeatedRun(self, condition, progress)


@final
class RepeatedRun:
    """Lumped runs of a machine at one condition, each begun where the last one ended.

    Parameters
    ----------
    machine : RunInMachine
        The machine after running-in.
    condition : OperatingCondition
        Operating point.
    progress : callable, optional
        Called with the finished share and a short text.
    """

    def __init__(
        self, machine: RunInMachine, condition: OperatingCondition, progress: Progress | None
    ) -> None:
        self._machine, self._condition, self._progress = machine, condition, progress
        self._last: History | None = None

    def __call__(self, description: MachineDescription | None = None) -> Solution:
        """Solution of the machine, or of one that differs in its gaps and films only."""
        machine = description or self._machine.description
        tried: list[tuple[float, float]] = []
        for _ in range(_SEAT_ROUNDS):
            own = self._machine
            start = Assembled(machine, own.fluid, self._condition)
            history, told = _march(own.case, start, self._last, self._progress)
            self._last = history if history.status is Status.DONE else None
            found = solution_from(history, own.provenance, own.extra, own.case.title)
            found = found.with_note(told)
            table = machine.lateral_table
            if table is None:
                return found
            # the bearings take their seats under the pressures that the gaps found leave
            more = float(found.data["lateral_leakage_factor"].mean()) / table.seat_factor
            if found.status is not Status.DONE or abs(more - 1.0) < _SEATED:
                return within_table(found)
            tried.append((np.log(table.seat_factor), np.log(more)))
            seat = table.seat_factor * float(np.exp(next_change(tried, _LONGEST_CHANGE)))
            machine = replace(machine, lateral_table=replace(table, seat_factor=seat))
        return within_table(found).with_note(_UNSEATED.format(more))


def within_table(solution: Solution) -> Solution:
    """Solution that says so where the load on lateral films was beyond their table."""
    beyond = float(solution.data["lateral_load_beyond"].mean())
    return solution.with_note(_BEYOND.format(100 * beyond) if beyond > _RARELY else "")


def run_in_machine(setup: Setup, progress: Progress | None = None) -> RunInMachine:
    """Run in the machine of a case, then give it its film tables and solved films."""
    worn, tables = run_in(setup, progress), setup.case.run.film_tables
    description, tabulated = worn.description, tuple[str, ...]()
    if tables is not None:
        from toothspace.simulation.film_tables import with_film_tables

        description, tabulated = with_film_tables(description, tables)
    has_rigid_mesh = description.mesh is not None
    models = interface_models(setup.case, tabulated, rigid_mesh=has_rigid_mesh)
    if "reynolds" in models.values():
        from toothspace.simulation.films import with_solved_films

        tell(progress, UNKNOWN, "journal and face films")
        description = with_solved_films(description, setup.condition, setup.fluid, models)
    extra = {"fluid_temperature": np.asarray(fluid_temperature(setup.case)), **worn.values}
    provenance = {**provenance_of(setup.case), "interfaces": interface_text(models)}
    return RunInMachine(setup.case, worn, description, setup.fluid, extra, provenance)


def simulate(setup: Setup, progress: Progress | None = None) -> Solution:
    """Cyclic state of a case at its operating point."""
    machine = run_in_machine(setup, progress)
    runs = machine.at(setup.condition, progress)
    found = run_with_heat(setup.case, machine.description, runs)
    if machine.description.face_places is not None:
        # why the places of bodies between covers are doubtful, if they are
        found = found.with_note(machine.description.face_places.warning)
    return machine.worn.marked(found)


def _march(
    case: Case, machine: Assembled, last: History | None, progress: Progress | None
) -> tuple[History, str]:
    """March until cyclic, from the end of the last run if any, and what was not reached."""
    plan = RunPlan(
        revolutions=case.run.revolutions,
        max_revolutions=case.run.max_revolutions,
        samples_per_revolution=case.run.samples_per_revolution,
        max_steps=case.run.max_steps,
    )
    assert case.operating_point is not None
    if case.operating_point.outlet_load == "fixed_pressure":
        state = None if last is None else first_turn_state(last)
        return march_to_balance(machine, plan, progress, state), ""
    return march_against_orifice(machine, plan, last, progress)
