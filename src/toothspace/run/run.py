"""One machine with one fluid at one condition, its march, and the presets that only march.

With lateral films from a table, bearing blocks take the position that their load gives them.
"""

from __future__ import annotations

import platform
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import partial
from operator import attrgetter
from typing import Any, final

import numpy as np

import toothspace
from toothspace.case import Case
from toothspace.case.conditions import RunSettings
from toothspace.case.presets import ELASTIC, PRESETS
from toothspace.circuit.fmu import LinkedUnit
from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.compilation.library import compiler_version
from toothspace.core.errors import CaseError
from toothspace.core.lazy import LazyMapping
from toothspace.core.progress import UNKNOWN, Progress, part, tell
from toothspace.core.status import Status
from toothspace.model.assembly import System, assemble
from toothspace.model.description import MachineDescription
from toothspace.model.operating_point import OperatingCondition
from toothspace.numerics.roots import next_change
from toothspace.results.solution import Solution, standing
from toothspace.run.condition import fluid_keys
from toothspace.run.heating import HeatSearch
from toothspace.run.load_orifice import march_against_orifice, with_held_outlet
from toothspace.run.running_in import Tracks, named_depths, run_in, running_in_depths
from toothspace.solver.accuracy import march_to_balance, solve_to_balance
from toothspace.solver.cyclic import (
    History,
    RunPlan,
    first_turn_state,
    march_near,
    march_revolutions,
)
from toothspace.solver.flow_regime import along_spaces, flow_regimes, pressure_along_spaces
from toothspace.solver.outcome import solution_from
from toothspace.solver.transient import TimePlan, TransientMarch, transient_solution

_RARELY = 0.01
_LONGEST_CHANGE = 4.0
"""Largest change of the logarithm of the leakage that seats the bearings, in one run. [-]"""
_SEAT_ROUNDS, _SEATED = 8, 0.05
"""Most runs, and difference of leakage, until position and load of the bearings agree."""
_BEYOND = (
    "The load on the lateral films is beyond their table in {:.0f} % of the time of turning, and "
    "counts as its edge: make tables over a wider range."
)
_NATIVE = "circuit.{} is native code of {}, which ran with the rights of this program"
_UNSEATED = (
    "Seats and gaps of the bearings do not agree: the lateral films leak {:.2f} times as much as "
    "the gaps that seat the bearings. Make tables with more pressures and speeds about this point, "
    "or solve the films with fidelity 'elastic'."
)


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
            case = self.case
            assert case.circuit is not None
            plan = TimePlan(
                case.circuit.duration,
                cells=case.run.time_samples,
                max_steps=case.run.step_limit(over_time=True),
                channels=case.run.channels,
            )

            def solve(system: System) -> Solution:
                march = TransientMarch(system, plan)
                return transient_solution(march, self.provenance, self.values, case.title, progress)

            system = assemble(self.machine, self.fluid, self.condition)
            found = solve_to_balance(system, solve)
            for unit in self.condition.circuit.units if self.condition.circuit else ():
                if isinstance(unit, LinkedUnit):
                    found = found.with_note(_NATIVE.format(unit.name, unit.keys.file.name))
            if self.condition.free_shaft is not None and found.status is Status.DONE:
                found = found.with_note(*standing(found.data))
            return self.marked(SeatSearch(self.machine).noted(found))
        return Marches(self, progress)(self.machine)

    @property
    def values(self) -> dict[str, Any]:
        """What a result holds of the run beside the history: temperature and tracks."""
        bodies = [body.name for body in self.machine.bodies]
        temperature = np.asarray(fluid_keys(self.case).temperature)
        cut = named_depths("running_in_depth", self.tracks.depths, bodies)
        return {"fluid_temperature": temperature, **cut}

    @property
    def provenance(self) -> Mapping[str, str]:
        """Where a result comes from, as text; the model of each interface by its name."""
        return LazyMapping(
            partial(_provenance, self.case, self.interfaces, self.condition.over_time)
        )

    def marked(self, solution: Solution) -> Solution:
        """Solution that says where its machine is doubtful: places of bodies, a casing half cut."""
        places = self.machine.face_places
        return self.tracks.marked(solution.short_of("" if places is None else places.warning))


@final
class Marches:
    """Marches of one run to its cyclic state, on its machine and ones with other gaps and films.

    Each begins where the last one ended.

    Parameters
    ----------
    run : Run
        Machine, fluid and condition.
    progress : callable, optional
        Called with the finished share and a short text.
    begin : History, optional
        Where the first one begins: the end of a march of a machine with the same parts.
    by_pitch : bool
        Whether a pitch that is like the one before is enough.
    """

    def __init__(
        self,
        run: Run,
        progress: Progress | None = None,
        begin: History | None = None,
        *,
        by_pitch: bool = False,
    ) -> None:
        self._run, self._progress = run, progress
        point, settings = run.case.operating_point, run.case.run
        self._orifice = point is not None and point.outlet_load == "orifice"
        self._plan = RunPlan(
            revolutions=settings.revolutions,
            max_revolutions=settings.max_revolutions,
            averaged_revolutions=settings.averaged_revolutions,
            samples_per_revolution=settings.samples_per_revolution,
            max_steps=settings.step_limit(over_time=False),
            by_pitch=by_pitch,
        )
        self._repeats = True
        """Whether a march by pitches may find one that repeats."""
        self.last = begin
        """The last march that was done; None where the next one begins anew."""

    def __call__(self, machine: MachineDescription) -> Solution:
        """March this machine to its cyclic state."""
        run, progress = self._run, self._progress
        seats, settled = SeatSearch(machine), False
        while not settled:
            condition, before = run.condition, self.last and self.last.system.condition
            if self._orifice and before and before.load_node == condition.load_node:
                condition = replace(condition, load_area=before.load_area)
            system = assemble(seats.machine, run.fluid, condition)
            last, loaded = self._begin(system)
            if self._orifice:
                history, told = march_against_orifice(system, self._plan, last, progress, loaded)
            else:
                state = None if last is None else first_turn_state(last)
                history, told = march_to_balance(system, self._plan, progress, state), ""
            self.last = history if history.status is Status.DONE else None
            # what tips would cut into the casing in the last revolution
            bodies, cut = [body.name for body in run.machine.bodies], running_in_depths(history)
            values = {**run.values, **named_depths("tip_cut_depth", cut, bodies)}
            found = solution_from(history, run.provenance, values, run.case.title)
            found = found.short_of(told)
            settled = seats.agree_with(found)
        found = found.with_later(partial(flow_regimes, history))
        if seats.machine.winding is not None:
            speed, ports = run.condition.shaft_speed, run.condition
            along = pressure_along_spaces(seats.machine, run.fluid, speed)
            difference = ports.outlet_pressure - ports.inlet_pressure
            notes = along_spaces(along, difference, seats.machine.winding.slices)
            found = found.with_note(*notes, pressure_along_spaces=along)
        return run.marked(seats.noted(found))

    def turned(self, machine: MachineDescription) -> History:
        """Revolution of this machine near its cyclic state, its pressures held.

        Of the first tooth pitch that repeats; where teeth differ the first march goes on until it
        repeats, and others are one revolution from where the last one ended. It tells mean flows
        and losses.

        Raises KeyboardInterrupt if interrupted.
        """
        run, condition = self._run, self._run.condition
        if self._orifice:
            condition = with_held_outlet(condition)
        system = assemble(machine, run.fluid, condition)
        last, _ = self._begin(system)
        state = None if last is None else first_turn_state(last)
        plan = replace(self._plan, revolutions=None if last is None else 1)

        warming = part(self._progress, "temperatures of the films")
        found = march_near(system, plan, warming, state) if self._repeats else None
        self._repeats = found is not None
        history = found or march_revolutions(system, plan, warming, state)
        if history.status is Status.INTERRUPTED:
            raise KeyboardInterrupt
        self.last = history if history.status is Status.DONE else None
        return history

    def _begin(self, system: System) -> tuple[History | None, System | None]:
        """The last march, where a march of a system can begin at its end; the system loaded so."""
        if self.last is None:
            return None, None
        before, after, loaded = self.last.system, system, None
        if self._orifice and before.condition.load_node != after.condition.load_node:
            after = after.under(with_held_outlet(after.condition))
        if before.condition.load_area > 0.0:
            held = after is not system
            if after.condition.load_area != before.condition.load_area:
                after = after.at(load_area=before.condition.load_area)
            loaded = None if held else after
        return (self.last, loaded) if before.arrays.size == after.arrays.size else (None, None)


def _provenance(case: Case, interfaces: Mapping[str, str], over_time: bool) -> dict[str, str]:
    models = {f"{name}_model": model for name, model in interfaces.items()}
    films = "at the temperature of the fluid"
    if case.heat.model == "coupled" and not over_time:
        films = "as warm as the heat network finds them"
    elif case.run.preset is ELASTIC and case.run.film_oil_share > 0.0:
        films = "as warm as their own heat and flow make them"
    return {**provenance_of(case), **models, "films": films}


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


@final
@dataclass(eq=False)
class SeatSearch:
    """Leakage of tabulated lateral films with which the bearing blocks of a machine are seated.

    The blocks take their seats under the pressures that the gaps leave, and the gaps follow from
    the load on the seated blocks; a run with each guess leads to the next one.
    """

    machine: MachineDescription
    """The machine with the present guess."""
    _tried: list[tuple[float, float]] = field(init=False, default_factory=list)
    _unsettled: str = field(init=False, default="")

    def agree_with(self, found: Solution) -> bool:
        """Whether seats and gaps of a run agree, or no better guess is to be had; else the next."""
        table = self.machine.lateral_table
        if table is None or found.status is not Status.DONE:
            return True
        more = float(found.data["lateral_leakage_factor"].mean()) / table.seat_factor
        if abs(more - 1.0) < _SEATED:
            return True
        self._tried.append((np.log(table.seat_factor), np.log(more)))
        if len(self._tried) == _SEAT_ROUNDS:
            self._unsettled = _UNSEATED.format(more)
            return True
        seat = table.seat_factor * float(np.exp(next_change(self._tried, _LONGEST_CHANGE)))
        self.machine = replace(self.machine, lateral_table=replace(table, seat_factor=seat))
        return False

    def noted(self, found: Solution) -> Solution:
        """Solution that says so where a table does not reach, or seats and gaps do not agree."""
        if self.machine.lateral_table is None:
            return found
        turning = np.asarray(found.data["shaft_speed"]) != 0.0
        samples = np.asarray(found.data["lateral_load_beyond"])
        beyond = float(samples[turning].mean()) if turning.any() else 0.0
        said = found.with_note(_BEYOND.format(100 * beyond) if beyond > _RARELY else "")
        return said.short_of(self._unsettled)


def unused_tables(case: Case) -> dict[str, str]:
    """Tables and keys of a case that its run does not use, as they are written, with the reason."""
    run, tables = case.run, getattr(case.machine, "part_tables", {})
    reasons = dict.fromkeys(run.preset.unused, f"by a run with {run.fidelity!r}")
    if case.circuit is not None:
        reasons.pop("startup", None)  # a circuit lets the shaft turn freely
    if run.film_tables is not None:
        reasons.pop("floating_part", None)
    if run.deformation != "bodies":
        reasons.setdefault("elastic_bodies", f"with run.deformation = {run.deformation!r}")
    if interface_models(case).get("lateral") != "reynolds":
        reasons.setdefault("free_bodies", "without run.interfaces.lateral = 'reynolds'")
    given: dict[str, str] = {}
    for table in filter(tables.__contains__, reasons):
        path, value = f"machine.{tables[table]}", attrgetter(tables[table])(case.machine)
        if value not in (None, "given"):
            given[path if isinstance(value, str) else f"[{path}]"] = reasons[table]
    if case.heat.model == "coupled" and (case.circuit is not None or not run.preset.has_losses):
        where = "over time" if case.circuit is not None else f"with {run.fidelity!r}"
        given["heat.model"] = f"by a run {where}"
    for key in (name for preset in PRESETS.values() for name in preset.own_keys):
        if not run.preset.reads(key) and getattr(run, key) != getattr(RunSettings, key):
            given[f"run.{key}"] = f"by a run with {run.fidelity!r}"
    return given


def interface_models(
    case: Case, tables: tuple[str, ...] = (), *, rigid_mesh: bool = True
) -> dict[str, str]:
    """Model of each interface in a run of a case.

    Raises CaseError if the case chooses a model that its preset does not offer.

    Parameters
    ----------
    tables : tuple of str
        Interfaces whose films come from the tables of the case.
    rigid_mesh : bool
        Whether the machine offers a rigid mesh.
    """
    preset = case.run.preset
    models = {name: offered[0] for name, offered in preset.interfaces.items()}
    if models and (case.run.mesh == "elastic" or not rigid_mesh):
        models["contact"] = "compliant"
    if "elastic" in models.values() and getattr(case.machine, "covers_rest", False):
        models["lateral"] = "reynolds"
    for name in tables:
        models[name] = "table"
    chosen = case.run.interfaces
    for name, model in {} if chosen is None else chosen.given.items():
        offered = [m for m in preset.interfaces.get(name, ()) if m != "table"]
        if name in tables or model not in offered:
            found = f"{model!r} with {'tables of these films' if name in tables else preset.name!r}"
            allowed = "no choice" if name in tables else " or ".join(map(repr, offered)) or "none"
            raise CaseError(f"run.interfaces.{name}", found, allowed)
        models[name] = model
    return models


def simulate(run: Run, progress: Progress | None = None) -> Solution:
    """Cyclic state of a machine at its operating point, or its way through time in a circuit."""
    ready = run.worn(progress).with_films(progress)
    if ready.condition.over_time:
        return ready.march(progress)
    march, heat = Marches(ready, progress), HeatSearch(ready.case, ready.machine)
    heat.come_near(march.turned)
    while not heat.agree_with(march(heat.machine)):
        pass
    return heat.solution


def warmed_through(run: Run, progress: Progress | None = None) -> Run:
    """Run whose films are as warm as its operating point makes them, where the case asks so."""
    if run.condition.over_time or run.case.heat.model != "coupled":
        return run
    march, heat = Marches(run, progress), HeatSearch(run.case, run.machine)
    heat.come_near(march.turned)
    while not heat.agree_with(march(heat.machine)):
        pass
    return replace(run, machine=heat.machine)
