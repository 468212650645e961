"""Composition root: the only place that sees machine types and solver together."""

from __future__ import annotations

import platform
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass, replace
from importlib.metadata import version
from pathlib import Path
from typing import Any, final

import numpy as np

import toothspace
from toothspace.case import Case
from toothspace.case.circuit import ReliefValve
from toothspace.case.fingerprint import fingerprint
from toothspace.case.plumbing import plumb, shaft_of, speed_of
from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.compiled import compile_seconds
from toothspace.core.constants import ATMOSPHERIC_PRESSURE
from toothspace.core.errors import CaseError
from toothspace.core.registry import machine_type
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.model.assembly import assemble
from toothspace.model.description import MachineDescription
from toothspace.model.fluid import fluid_law
from toothspace.model.operating_point import OperatingCondition
from toothspace.presets import PRESETS
from toothspace.results.solution import Solution, warned
from toothspace.solver import running_in_store
from toothspace.solver.cyclic import History, RunPlan, first_turn_state, march_revolutions
from toothspace.solver.ideal import ideal_solution
from toothspace.solver.lateral_gap import LateralSettings
from toothspace.solver.lateral_lookup import run_with_table, told_over_time
from toothspace.solver.outcome import solution_from, window_ledger
from toothspace.solver.running_in import running_in_depths
from toothspace.solver.transient import TimePlan, TransientMarch
from toothspace.solver.transient_outcome import transient_solution

Progress = Callable[[float, str], None]

_RUNNING_IN_PLAN = RunPlan(max_revolutions=20, samples_per_revolution=720)
_RUNNING_IN_TOLERANCE = 1e-5
_LOAD_ROUNDS = 4
_LOAD_MATCH = 2e-3
_EXPECTED_PRESSURE = 50e5
_BEYOND_BREAKAWAY = 1.5
_CUT_SHORT = (Status.INTERRUPTED, Status.STEP_TOO_SMALL, Status.MAX_STEPS)
_KEPT_MACHINES = 4

_machines: dict[str, MachineDescription] = {}


def load_case(path: str | Path, overrides: Iterable[str] = ()) -> Case:
    """Read a case file.

    Raises
    ------
    CaseError
        If the file asks for something impossible, in one line.
    """
    from toothspace.config import load_case as load

    return load(Path(path), tuple(overrides))


def describe(case: Case) -> MachineDescription:
    """Turn the machine of a case into its tables; those of the last few machines are kept."""
    if case.machine_spec is None:
        raise CaseError("machine: found none, allowed a case with a [machine] table")
    key = fingerprint(case.machine_type, case.machine_spec)
    if key not in _machines:
        while len(_machines) >= _KEPT_MACHINES:
            del _machines[next(iter(_machines))]
        _machines[key] = machine_type(case.machine_type).describe(case.machine_spec)
    return _machines[key]


def simulate(case: Case, progress: Progress | None = None) -> Solution:
    """Run a case and return its solution; a numerical failure is a status of it.

    Parameters
    ----------
    case : Case
        What to run.
    progress : callable, optional
        Called with the finished share and a short text.
    """
    if case.operating_point is None and case.circuit is None:
        allowed = "a case with an [operating_point] or a [circuit]"
        raise CaseError(f"operating_point: found none, allowed {allowed}")
    PRESETS[case.run.fidelity].require_solved()
    started, compiled = time.perf_counter(), compile_seconds()
    description, fluid = describe(case), fluid_of(case)
    if case.circuit is not None:
        solution = _simulate_circuit(case, description, fluid, progress)
        return _timed(solution, started, compiled)
    condition = condition_of(case, description)
    if case.run.fidelity == "ideal":
        solution = ideal_solution(
            description,
            fluid,
            condition,
            samples=case.run.samples_per_revolution,
            dual_flank=case.run.flank_sealing == "dual",
            provenance=provenance_of(case),
            extra={"fluid_temperature": np.asarray(_temperature(case))},
        )
    elif case.run.fidelity == "elastic":
        solution = _simulate_elastic(case, progress)
    else:
        machine = _solved_films(case, description, condition)
        solution = _simulate_lumped(case, machine, fluid, condition, progress)
    return _timed(solution, started, compiled)


def _timed(solution: Solution, started: float, compiled: float) -> Solution:
    """Solution with the wall time since the start, without that of compilation. [s]."""
    compiling = compile_seconds() - compiled
    wall = time.perf_counter() - started - compiling
    times = {"wall_time": wall, "compile_time": compiling}
    return replace(solution, statistics={**solution.statistics, **times})


def _solved_films(
    case: Case, description: MachineDescription, condition: OperatingCondition
) -> MachineDescription:
    """Machine with the films that the preset asks for."""
    if PRESETS[case.run.fidelity].films != "reynolds":
        return description
    from toothspace.films.solved_machine import with_solved_films

    return with_solved_films(description, condition)


def _with_tables(case: Case, description: MachineDescription) -> MachineDescription:
    """Machine with the film tables of the case, if it names any."""
    if case.run.film_tables is None:
        return description
    from toothspace.films.film_tables import with_film_tables

    return with_film_tables(description, case.run.film_tables)


def simulate_all(cases: Iterable[Case], workers: int = 1) -> list[Solution | Exception]:
    """Run several cases; a case that cannot run is returned as its exception.

    A numerical failure within a run is a solution with its status, as in :func:`simulate`.
    """
    items = list(cases)
    if workers <= 1:
        return [_simulate_safely(case) for case in items]
    from concurrent.futures import ProcessPoolExecutor

    with ProcessPoolExecutor(workers) as pool:
        return list(pool.map(_simulate_safely, items))


def fluid_of(case: Case) -> FluidLaw:
    """Constants of the fluid of a case at its temperature."""
    return _fluid_at(case, _temperature(case))


def condition_of(case: Case, description: MachineDescription) -> OperatingCondition:
    """Operating condition of a case, before a load orifice is sized."""
    point = case.operating_point
    assert point is not None
    return OperatingCondition(
        shaft_speed=point.shaft_speed,
        inlet_pressure=point.inlet_pressure,
        outlet_pressure=point.outlet_pressure,
        drain_pressure=description.drain_pressure,
        radial_load=point.shaft_radial_load,
        compliant_mesh=case.run.mesh == "elastic",
        relative_tolerance=case.run.relative_tolerance,
    )


def provenance_of(case: Case) -> dict[str, str]:
    """Where a result comes from, as text."""
    return {
        "title": case.title,
        "package_version": toothspace.__version__,
        "case_toml": case.to_toml(),
        "case_hash": case.hash,
        "case_file": str(case.source or ""),
        "preset": case.run.fidelity,
        "overrides": "\n".join(case.overrides),
        "python_version": platform.python_version(),
        "numba_version": version("numba"),
        "numpy_version": np.__version__,
    }


def run_in(
    case: Case, description: MachineDescription
) -> tuple[MachineDescription, dict[str, Array]]:
    """Cut the casing at the break-in condition; return the worn machine and the depths. [m]."""
    worn, depths, _ = _run_in(case, description)
    return worn, depths


def _run_in(
    case: Case, description: MachineDescription
) -> tuple[MachineDescription, dict[str, Array], Status]:
    """Running-in, taken from disk if the same one was computed before."""
    state = description.running_in
    if state is None:
        return description, {}, Status.DONE
    high, low = state.pressure, ATMOSPHERIC_PRESSURE
    motor = description.mode == "motor"
    condition = OperatingCondition(
        shaft_speed=state.shaft_speed,
        inlet_pressure=high if motor else low,
        outlet_pressure=low if motor else high,
        drain_pressure=description.drain_pressure,
        relative_tolerance=_RUNNING_IN_TOLERANCE,
    )
    fluid = _fluid_at(case, state.temperature)
    key = fingerprint(case.machine_type, case.machine_spec, fluid, condition, _RUNNING_IN_PLAN)
    depths = running_in_store.load(key)
    if depths is None:
        plan = replace(_RUNNING_IN_PLAN, max_steps=case.run.max_steps)
        history = march_revolutions(assemble(description, fluid, condition), plan)
        if history.status is Status.INTERRUPTED:
            raise KeyboardInterrupt
        depths = running_in_depths(history)
        if history.status in _CUT_SHORT:
            return description.with_running_in(depths), depths, history.status
        running_in_store.save(key, depths)
    return description.with_running_in(depths), depths, Status.DONE


def _simulate_lumped(
    case: Case,
    description: MachineDescription,
    fluid: FluidLaw,
    condition: OperatingCondition,
    progress: Progress | None,
) -> Solution:
    machine, status = _machine_after_running_in(case, description, fluid)
    return _with_running_in_status(machine.solve(condition, progress=progress), status)


def _with_running_in_status(solution: Solution, status: Status) -> Solution:
    """A run on a casing that was cut only in part is not done."""
    if status is Status.DONE or solution.status is Status.INTERRUPTED:
        return solution
    provenance = warned(solution.provenance, "Running-in ended before its time.")
    return replace(solution, status=status, provenance=provenance)


def _simulate_circuit(
    case: Case, description: MachineDescription, fluid: FluidLaw, progress: Progress | None
) -> Solution:
    """A run over time in the circuit of the case."""
    assert case.circuit is not None
    if case.run.fidelity != "lumped":
        found = f"run.fidelity: found {case.run.fidelity!r}"
        raise CaseError(f"{found}, allowed 'lumped' with a [circuit]")
    condition = circuit_condition(case, description, fluid)
    machine, status = _machine_after_running_in(case, description, fluid)
    run = case.run
    plan = TimePlan(
        case.circuit.duration,
        cells=run.time_samples,
        max_steps=run.max_steps,
        channels=run.channels,
    )
    march = TransientMarch(assemble(machine.description, fluid, condition), plan)
    ended = transient_solution(march, provenance_of(case), machine.extra, case.title, progress)
    return _with_running_in_status(told_over_time(machine.description, condition, ended), status)


def circuit_condition(
    case: Case, description: MachineDescription, fluid: FluidLaw
) -> OperatingCondition:
    """Condition of a case with a circuit, at the pressure that it is expected to reach."""
    keys = case.circuit
    assert keys is not None
    circuit, shaft, speed = plumb(keys, description, fluid), shaft_of(keys, description), None
    if shaft is None:
        speed = speed_of(keys)
        assert speed is not None
    low = circuit.supply_pressure
    high = low + _expected_pressure(case, description)
    motor = description.mode == "motor"
    return OperatingCondition(
        shaft_speed=keys.initial_shaft_speed if speed is None else float(speed[0, 1]),
        inlet_pressure=high if motor else low,
        outlet_pressure=low if motor else high,
        drain_pressure=description.drain_pressure,
        compliant_mesh=case.run.mesh == "elastic",
        relative_tolerance=case.run.relative_tolerance,
        circuit=circuit,
        free_shaft=shaft,
        speed_schedule=np.zeros((0, 2)) if speed is None else speed,
        shaft_angle=keys.initial_shaft_angle,
    )


def _expected_pressure(case: Case, description: MachineDescription) -> float:
    """Pressure difference that seats the bearing blocks and scales the tolerance. [Pa]."""
    assert case.circuit is not None
    elements = case.circuit.elements.values()
    relief = [e.opening_pressure for e in elements if isinstance(e, ReliefValve)]
    expected = max(relief, default=_EXPECTED_PRESSURE)
    if description.startup is None or speed_of(case.circuit) is not None:
        return expected
    return min(expected, _BEYOND_BREAKAWAY * description.startup.torque / description.displacement)


@final
@dataclass(frozen=True, eq=False)
class RunInMachine:
    """Machine of a case after running-in, for several lumped runs.

    Parameters
    ----------
    case : Case
        Its case.
    description : MachineDescription
        The machine after running-in.
    fluid : FluidLaw
        Fluid.
    extra : mapping
        Values that go into every result.
    """

    case: Case
    description: MachineDescription
    fluid: FluidLaw
    extra: dict[str, Any]

    def solve(
        self,
        condition: OperatingCondition,
        description: MachineDescription | None = None,
        progress: Progress | None = None,
    ) -> Solution:
        """Lumped solution at a condition, of the machine or a changed one."""

        def run(changed: MachineDescription) -> Solution:
            history = _march(self.case, changed, self.fluid, condition, progress)
            return solution_from(history, provenance_of(self.case), self.extra, self.case.title)

        slide = float(self.fluid.dynamic_viscosity) * condition.shaft_speed
        return run_with_table(description or self.description, run, slide)


def run_in_machine(case: Case) -> RunInMachine:
    """Describe the machine of a case and run it in."""
    return _machine_after_running_in(case, describe(case), fluid_of(case))[0]


def _machine_after_running_in(
    case: Case, description: MachineDescription, fluid: FluidLaw
) -> tuple[RunInMachine, Status]:
    worn, depths, status = _run_in(case, description)
    extra: dict[str, Any] = {"fluid_temperature": np.asarray(_temperature(case))}
    extra |= _running_in_values(description, depths)
    return RunInMachine(case, _with_tables(case, worn), fluid, extra), status


def _simulate_elastic(case: Case, progress: Progress | None) -> Solution:
    """Chambers and lateral films in agreement, then one revolution of the films."""
    from toothspace.solver.lateral_agreement import PointRequest
    from toothspace.solver.lateral_coupling import coupled_solution
    from toothspace.solver.lateral_gap import balance_of

    machine = run_in_machine(case)
    balance_of(machine.description)
    condition = condition_of(case, machine.description)
    gap = float(case.machine_spec.lateral.side_gap_floating)
    request = PointRequest(settings=lateral_settings(case), start=gap)
    return coupled_solution(
        (machine.description, machine.fluid, request),
        lambda changed: machine.solve(condition, changed, progress),
        case.run.film_steps_per_revolution,
        progress,
    )


def lateral_settings(case: Case) -> LateralSettings:
    """Grids and laws of the lateral films of a case."""
    from toothspace.films.cases import lateral_heating

    run, warm = case.run, lateral_heating(case)
    grid, angles, law = run.film_grid, run.film_angles_per_pitch, run.deformation
    return LateralSettings(grid=grid, angles=angles, deformation=law, heating=warm)


def _march(
    case: Case,
    description: MachineDescription,
    fluid: FluidLaw,
    condition: OperatingCondition,
    progress: Progress | None,
) -> History:
    plan = RunPlan(
        revolutions=case.run.revolutions,
        max_revolutions=case.run.max_revolutions,
        samples_per_revolution=case.run.samples_per_revolution,
        max_steps=case.run.max_steps,
    )
    assert case.operating_point is not None
    if case.operating_point.outlet_load == "fixed_pressure":
        return march_revolutions(assemble(description, fluid, condition), plan, progress)
    return _march_against_orifice(description, fluid, condition, plan, progress)


def _march_against_orifice(
    description: MachineDescription,
    fluid: FluidLaw,
    condition: OperatingCondition,
    plan: RunPlan,
    progress: Progress | None,
) -> History:
    """Size the load orifice until the mean outlet pressure is the one asked for."""
    wanted = condition.outlet_pressure - condition.load_pressure
    flow = description.displacement * condition.shaft_speed
    area = flow / (0.7 * np.sqrt(2.0 * wanted / fluid.reference_density))
    state: Array | None = None
    for _ in range(_LOAD_ROUNDS):
        system = assemble(description, fluid, replace(condition, load_area=area))
        history = march_revolutions(system, plan, progress, state)
        if history.status in _CUT_SHORT:
            break
        found = mean_outlet_pressure(history) - condition.load_pressure
        if abs(found / wanted - 1.0) < _LOAD_MATCH:
            break
        area *= np.sqrt(found / wanted)
        state = first_turn_state(history)
    return history


def mean_outlet_pressure(history: History) -> float:
    """Mean pressure of the outlet volume over the last revolution. [Pa]."""
    from toothspace.solver.compiled_model import observe

    seen = observe(history.system.arrays, history.states[:-1])
    return float(seen.pressure[:, history.system.description.outlet_node].mean())


def _running_in_values(
    description: MachineDescription, depths: dict[str, Array]
) -> dict[str, Array]:
    if not depths:
        return {}
    nodes = next(iter(depths.values())).size
    names = [body.name for body in description.bodies]
    table = np.zeros((len(names), nodes))
    for name, depth in depths.items():
        body = next(b for b in names if name.endswith(b.split("_")[0]))
        table[names.index(body)] = depth
    return {
        "running_in_depth": table,
        "casing_angle": np.arange(nodes) * 2.0 * np.pi / nodes,
    }


def _fluid_at(case: Case, temperature: float) -> FluidLaw:
    choice = case.fluid
    if choice is None:
        raise CaseError("fluid: found none, allowed a case with a [fluid] table")
    return fluid_law(
        choice.source,
        temperature,
        choice.free_air_fraction,
        choice.dissolved_air_fraction,
        choice.gas_law,
        choice.saturation_pressure,
        choice.release_time,
        choice.absorption_time,
    )


def _temperature(case: Case) -> float:
    assert case.fluid is not None
    return case.fluid.temperature


def _simulate_safely(case: Case) -> Solution | Exception:
    try:
        return simulate(case)
    except CaseError as error:
        # its subclasses may not survive the way between processes
        return CaseError(str(error))
    except Exception as error:  # one case that fails must not end the others
        return error


__all__ = [
    "condition_of",
    "describe",
    "fluid_of",
    "load_case",
    "run_in",
    "simulate",
    "simulate_all",
    "window_ledger",
]
