"""Runs over time with the machine in a hydraulic circuit."""

from __future__ import annotations

from toothspace.core.errors import CaseError
from toothspace.core.progress import Progress
from toothspace.model.assembly import assemble
from toothspace.results.solution import Solution
from toothspace.simulation.lumped import run_in_machine, within_table
from toothspace.simulation.setup import Setup
from toothspace.solver.transient import TimePlan, TransientMarch
from toothspace.solver.transient_outcome import transient_solution


def simulate(setup: Setup, progress: Progress | None = None) -> Solution:
    """Run a case over the time of its circuit.

    Raises
    ------
    CaseError
        If the case asks for another preset than ``lumped``.
    """
    case, run = setup.case, setup.case.run
    assert case.circuit is not None
    if run.fidelity != "lumped":
        found = f"run.fidelity: found {run.fidelity!r}"
        raise CaseError(f"{found}, allowed 'lumped' with a [circuit]")
    condition = setup.condition
    machine = run_in_machine(setup, progress)
    plan = TimePlan(
        case.circuit.duration,
        cells=run.time_samples,
        max_steps=run.max_steps,
        channels=run.channels,
    )
    march = TransientMarch(assemble(machine.description, setup.fluid, condition), plan)
    ended = transient_solution(march, machine.provenance, machine.extra, case.title, progress)
    if machine.description.lateral_table is not None:
        ended = within_table(ended)
    return machine.worn.marked(ended)
