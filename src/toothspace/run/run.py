"""One machine with one fluid at one condition, and the march that solves it."""

from __future__ import annotations

import platform
from collections.abc import Callable, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, cast, final

import numpy as np

import toothspace
from toothspace.case import Case
from toothspace.case.presets import ELASTIC
from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.compilation.library import compiler_version
from toothspace.core.progress import UNKNOWN, Progress, tell
from toothspace.core.status import Status
from toothspace.model.assembly import System, assemble
from toothspace.model.description import MachineDescription
from toothspace.model.operating_point import OperatingCondition
from toothspace.results.solution import Solution
from toothspace.results.startup import standing
from toothspace.run.condition import fluid_temperature
from toothspace.run.interfaces import interface_models
from toothspace.run.load_orifice import march_against_orifice
from toothspace.run.running_in import Tracks, run_in
from toothspace.run.seats import SeatSearch
from toothspace.solver.accuracy import march_to_balance, solve_to_balance
from toothspace.solver.cyclic import History, RunPlan, first_turn_state
from toothspace.solver.outcome import solution_from
from toothspace.solver.transient import TimePlan, TransientMarch, transient_solution


@final
@dataclass(frozen=True, eq=False)
class Run:
    """One machine with one fluid at one condition.

    A preset takes it through its stages, each of which gives another run: the machine as designed,
    ``worn`` by running-in, ``with_films`` from tables or grids; then marches it.
    """

    case: Case
    """Where it comes from: numerical settings, names, provenance."""
    machine: MachineDescription
    """Tables of the machine over the shaft angle."""
    fluid: FluidLaw
    """Fluid at its temperature."""
    condition: OperatingCondition
    """Speeds, pressures and circuit."""
    tracks: Tracks = field(default_factory=Tracks)
    """What the gears have cut into the casing."""
    interfaces: Mapping[str, str] = field(default_factory=dict)
    """Model of each interface of the machine."""

    def worn(self, progress: Progress | None = None) -> Run:
        """Run on the casing that the break-in condition leaves.

        Raises
        ------
        KeyboardInterrupt
            If interrupted: half a track is none.
        """
        tracks = run_in(self.case, self.machine, progress)
        return replace(self, machine=self.machine.with_running_in(tracks.depths), tracks=tracks)

    def with_films(self, progress: Progress | None = None) -> Run:
        """Run whose films come from the tables of the case, and from grids where it asks so."""
        machine, tables, tabulated = self.machine, self.case.run.film_tables, tuple[str, ...]()
        if tables is not None:
            from toothspace.run.film_tables import with_film_tables

            machine, tabulated = with_film_tables(machine, tables)
        rigid_mesh = machine.mesh is not None
        models = interface_models(self.case, tabulated, rigid_mesh=rigid_mesh)
        if "reynolds" in models.values():
            from toothspace.run.solved_films import with_solved_films

            tell(progress, UNKNOWN, "journal and face films")
            machine = with_solved_films(machine, self.condition, self.fluid, models)
        return replace(self, machine=machine, interfaces=models)

    def march(self, progress: Progress | None = None) -> Solution:
        """Cyclic state at the operating point, or the time of the circuit."""
        if self.condition.over_time:
            return self._over_time(progress)
        return self.repeated(progress)(self.machine)

    def repeated(
        self, progress: Progress | None = None
    ) -> Callable[[MachineDescription], Solution]:
        """Marches to the cyclic state of this machine and of ones that differ in gaps and films.

        Each begins where the last one ended.
        """
        case, last = self.case, cast(History | None, None)
        plan = RunPlan(
            revolutions=case.run.revolutions,
            max_revolutions=case.run.max_revolutions,
            samples_per_revolution=case.run.samples_per_revolution,
            max_steps=case.run.max_steps,
        )
        point = case.operating_point
        orifice = point is not None and point.outlet_load == "orifice"

        def march(machine: MachineDescription) -> Solution:
            nonlocal last
            seats, settled = SeatSearch(machine), False
            while not settled:
                system = assemble(seats.machine, self.fluid, self.condition)
                if orifice:
                    history, told = march_against_orifice(system, plan, last, progress)
                else:
                    state = None if last is None else first_turn_state(last)
                    history, told = march_to_balance(system, plan, progress, state), ""
                last = history if history.status is Status.DONE else None
                found = solution_from(history, self.provenance, self.values, case.title)
                found = found.short_of(told)
                settled = seats.agree_with(found)
            return self._marked(seats.noted(found))

        return march

    @property
    def values(self) -> dict[str, Any]:
        """What a result holds of the run beside the history: temperature and tracks."""
        bodies = [body.name for body in self.machine.bodies]
        temperature = np.asarray(fluid_temperature(self.case))
        return {"fluid_temperature": temperature, **self.tracks.values(bodies)}

    @property
    def provenance(self) -> dict[str, str]:
        """Where a result comes from, as text; the model of each interface by its name."""
        models = {f"{name}_model": model for name, model in self.interfaces.items()}
        films = "at the temperature of the fluid"
        if self.case.heat.model == "coupled" and not self.condition.over_time:
            films = "as warm as the heat network finds them"
        elif self.case.run.preset is ELASTIC and self.case.run.film_oil_share > 0.0:
            films = "as warm as their own heat and flow make them"
        return {**provenance_of(self.case), **models, "films": films}

    def _over_time(self, progress: Progress | None) -> Solution:
        case = self.case
        assert case.circuit is not None
        plan = TimePlan(
            case.circuit.duration,
            cells=case.run.time_samples,
            max_steps=case.run.max_steps,
            channels=case.run.channels,
        )

        def solve(system: System) -> Solution:
            march = TransientMarch(system, plan)
            return transient_solution(march, self.provenance, self.values, case.title, progress)

        system = assemble(self.machine, self.fluid, self.condition)
        found = solve_to_balance(system, solve)
        if self.condition.free_shaft is not None and found.status is Status.DONE:
            found = found.with_note(*standing(found.data))
        return self._marked(SeatSearch(self.machine).noted(found))

    def _marked(self, solution: Solution) -> Solution:
        """Solution that says where its machine is doubtful: places of bodies, a casing half cut."""
        places = self.machine.face_places
        return self.tracks.marked(solution.short_of("" if places is None else places.warning))


def provenance_of(case: Case) -> dict[str, str]:
    """Where the results of a case come from, as text."""
    return {
        "title": case.title,
        "package_version": toothspace.__version__,
        "case_toml": case.to_toml(case.source.parent if case.source else None),
        "case_hash": case.hash,
        "case_file": str(case.source or ""),
        "preset": case.run.fidelity,
        "overrides": "\n".join(case.overrides),
        "python_version": platform.python_version(),
        "numba_version": compiler_version(),
        "numpy_version": np.__version__,
    }
