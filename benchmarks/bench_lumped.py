"""Lumped simulation of the 12-tooth motor against SciPy and SUNDIALS on one right-hand side.

All integrators see the same compiled right-hand side and start from the same point of the cyclic
state. They are given the analytic Jacobian too; "own J" marks runs in which SciPy makes its own
by differences, as a user without one would call it. The competitors are given the package's
error weights, averaged over the revolution because theirs cannot vary in time, and integrate the
core states only; the package also integrates the ledger and looks for events. Errors of the
chamber pressures against a run of the package at a far smaller tolerance show what each has
really achieved, and times at equal root mean square error are interpolated between tolerances.
"""

from __future__ import annotations

import time
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import partial
from pathlib import Path
from typing import Any

import numba
import numpy as np
from llvmlite import ir
from numba.core import types
from numba.extending import intrinsic
from scipy.integrate import solve_ivp

import toothspace.core.compilation.jit  # noqa: F401 records are known to Numba
from tests.reference_formulas.full_jacobian import jacobian
from toothspace import api
from toothspace.core.compilation.records import RecordAddress, pack
from toothspace.core.compiled import njit
from toothspace.model.assembly import System, assemble
from toothspace.model.system import error_weights, right_hand_side
from toothspace.solver.compiled_model import observe
from toothspace.solver.cyclic import RunPlan, march_revolutions
from toothspace.solver.integrator import start_march

CASE = Path(__file__).resolve().parents[1] / "cases" / "egm12_motor.toml"
SAMPLES = 720
REVOLUTIONS = 1
TOLERANCES = (1e-5, 1e-6, 1e-7)
REFERENCE_TOLERANCE = 1e-9
REPEATS = 2


@dataclass(frozen=True)
class Outcome:
    """One integrator at one tolerance: time [s], counts, errors of chamber pressures [bar]."""

    name: str
    tolerance: float
    seconds: float
    rhs_calls: int
    jacobian_calls: int
    pressure_error: float
    root_mean_square_error: float


class Problem:
    """The system at a point of its cyclic state, callable from Python with little overhead."""

    def __init__(self, path: Path = CASE, overrides: tuple[str, ...] = ()) -> None:
        case = api.load_case(path, overrides)
        run = api.prepare(case).worn()
        self.fluid, self.description, self.condition = run.fluid, run.machine, run.condition
        self.system = assemble(self.description, self.fluid, self.condition)
        history = march_revolutions(self.system, RunPlan(samples_per_revolution=SAMPLES))
        self.revolutions_to_cyclic = history.revolutions
        self.start = history.states[0].copy()
        self.start[self.core :] = 0.0
        turn = 2.0 * np.pi / self.condition.shaft_speed
        self.times = np.linspace(0.0, REVOLUTIONS * turn, REVOLUTIONS * SAMPLES + 1)
        self._bind()
        self.unit_weights = self._mean_weights(history.states)

    @property
    def core(self) -> int:
        """Number of core states."""
        return int(self.system.arrays.size.core)

    def _bind(self) -> None:
        arrays = self.system.arrays
        self.compiled = compiled_callbacks(numba.typeof(arrays))
        # written once: packing the record at every call would cost more than the call
        self._block = block_of(arrays)
        self.address = self._block.ctypes.data
        self.full = self.start.copy()
        self.rate = np.zeros_like(self.full)
        self.matrix = np.zeros((self.full.size, self.core))

    def rates(self, t: float, y: Any, out: Any) -> None:
        """Rates of the core states."""
        self.compiled.rates(t, y, self.address, self.full, self.rate, out)

    def slopes(self, t: float, y: Any, out: Any) -> None:
        """Jacobian of the core states."""
        self.compiled.slopes(t, y, self.address, self.full, self.matrix, out)

    def _mean_weights(self, states: Any) -> Any:
        logarithms = []
        for state in states[::10]:
            one = np.empty(self.core)
            self.compiled.weights(0.0, state, self.address, one)
            logarithms.append(np.log(one))
        return np.exp(np.mean(logarithms, axis=0)) / self.condition.relative_tolerance

    def at_tolerance(self, tolerance: float) -> System:
        """The same system at another tolerance."""
        condition = replace(self.condition, relative_tolerance=tolerance)
        return assemble(self.description, self.fluid, condition)

    def pressures(self, core_states: Any) -> Any:
        """Chamber pressures of sampled core states. [Pa]."""
        states = np.zeros((len(core_states), self.full.size))
        states[:, : self.core] = core_states
        chambers = self.description.chamber_count
        return observe(self.system.arrays, states).pressure[:, :chambers]


Run = tuple[float, Any, int, int]
"""Time [s], core states at the samples, right-hand sides, Jacobians."""


@dataclass(frozen=True)
class Callbacks:
    """Right-hand side, Jacobian and error weights as compiled functions of a record's address."""

    rates: Callable[..., None]
    slopes: Callable[..., None]
    weights: Callable[..., None]


def record_at(kind: RecordAddress) -> Callable[[int], Any]:
    """Function of compiled code that takes an address for a record of a type."""

    @intrinsic
    def record(context, address):  # type: ignore[no-untyped-def]
        def generate(context, builder, signature, values):  # type: ignore[no-untyped-def]
            return builder.inttoptr(values[0], ir.IntType(8).as_pointer())

        return kind(types.int64), generate

    return record  # type: ignore[no-any-return]


def block_of(record: tuple[Any, ...]) -> np.ndarray:
    """Words of a record, valid as long as the returned array and those of the record live."""
    return np.frombuffer(pack(record, "=" + numba.typeof(record).format), np.uint8)


def compiled_callbacks(kind: RecordAddress) -> Callbacks:
    """Callbacks for systems of one type."""
    record = record_at(kind)

    @njit
    def rates(t, y, address, full, rate, out):  # type: ignore[no-untyped-def]
        full[: y.size] = y
        right_hand_side(t, full, record(address), rate)
        out[:] = rate[: y.size]

    @njit
    def slopes(t, y, address, full, matrix, out):  # type: ignore[no-untyped-def]
        full[: y.size] = y
        jacobian(t, full, record(address), matrix)
        out[:, :] = matrix[: y.size, :]

    @njit
    def weights(t, y, address, out):  # type: ignore[no-untyped-def]
        error_weights(t, y, record(address), out)

    return Callbacks(rates, slopes, weights)


def run_package(problem: Problem, tolerance: float) -> Run:
    """March with the package's integrator."""
    march = start_march(problem.at_tolerance(tolerance), problem.start)
    began = time.perf_counter()
    piece = march.advance(problem.times)
    seconds = time.perf_counter() - began
    counts = march.statistics
    return seconds, piece.states[:, : problem.core], int(counts["rhs"]), int(counts["jac"])


def run_scipy(problem: Problem, tolerance: float, method: str, *, analytic: bool) -> Run:
    """March with a method of SciPy, with the package's Jacobian or with SciPy's differences."""
    n = problem.core

    def rates(t: float, y: Any) -> Any:
        out = np.empty(n)
        problem.rates(t, np.ascontiguousarray(y), out)
        return out

    def slopes(t: float, y: Any) -> Any:
        out = np.empty((n, n))
        problem.slopes(t, np.ascontiguousarray(y), out)
        return out

    began = time.perf_counter()
    found = solve_ivp(
        rates, (0.0, problem.times[-1]), problem.start[:n], method, problem.times,
        jac=slopes if analytic else None, rtol=1e-13, atol=tolerance * problem.unit_weights,
        max_step=_longest_step(problem),
    )  # fmt: skip
    seconds = time.perf_counter() - began
    return seconds, found.y.T, int(found.nfev), int(found.njev)


def run_cvode(problem: Problem, tolerance: float) -> Run:
    """March with SUNDIALS CVODE and its dense solver."""
    from sksundae.cvode import CVODE

    counts = [0, 0]

    def rates(t: float, y: Any, out: Any) -> None:
        counts[0] += 1
        problem.rates(t, y, out)

    def slopes(t: float, y: Any, rate: Any, out: Any) -> None:
        counts[1] += 1
        problem.slopes(t, y, out)

    solver = CVODE(
        rates, method="BDF", rtol=1e-13, atol=tolerance * problem.unit_weights,
        linsolver="dense", jacfn=slopes,
        max_num_steps=1_000_000, max_step=_longest_step(problem),
    )  # fmt: skip
    began = time.perf_counter()
    found = solver.solve(problem.times, problem.start[: problem.core])
    seconds = time.perf_counter() - began
    return seconds, found.y, counts[0], counts[1]


def _longest_step(problem: Problem) -> float:
    return float(1.0 / (40.0 * problem.condition.shaft_speed))


def callback_microseconds(problem: Problem, count: int = 2000) -> tuple[float, float]:
    """Time of one right-hand side and of one Jacobian as the competitors call them. [us]."""
    y, rate = problem.start[: problem.core].copy(), np.empty(problem.core)
    matrix = np.empty((problem.core, problem.core))
    times = []
    for call in (
        lambda: problem.rates(0.0, y, rate),
        lambda: problem.slopes(0.0, y, matrix),
    ):
        call()
        began = time.perf_counter()
        for _ in range(count):
            call()
        times.append((time.perf_counter() - began) / count * 1e6)
    return times[0], times[1]


def measure(problem: Problem, tolerances: tuple[float, ...] = TOLERANCES) -> list[Outcome]:
    """All integrators on one revolution at the tolerances, each warm."""
    reference = problem.pressures(run_package(problem, REFERENCE_TOLERANCE)[1])
    runs: dict[str, Callable[[float], Run]] = {
        "toothspace NDF": lambda tolerance: run_package(problem, tolerance),
        "SUNDIALS CVODE": lambda tolerance: run_cvode(problem, tolerance),
        **{
            f"SciPy {method}{', own J' if not analytic else ''}": partial(
                run_scipy, problem, method=method, analytic=analytic
            )
            for method in ("LSODA", "BDF")
            for analytic in (True, False)
        },
    }
    outcomes = []
    for tolerance in tolerances:
        for name, run in runs.items():
            tries = [run(tolerance) for _ in range(REPEATS)]
            fastest = min(tries, key=lambda found: found[0])
            outcomes.append(outcome_of(name, problem, tolerance, fastest, reference))
    return outcomes


def outcome_of(name: str, problem: Problem, tolerance: float, run: Run, reference: Any) -> Outcome:
    """A run with its errors against pressures [Pa] at a far smaller tolerance."""
    seconds, states, rhs_calls, jacobian_calls = run
    error = (problem.pressures(states) - reference) / 1e5
    worst, typical = float(np.abs(error).max()), float(np.sqrt(np.mean(error**2)))
    return Outcome(name, tolerance, seconds, rhs_calls, jacobian_calls, worst, typical)


def seconds_at_error(outcomes: list[Outcome], name: str, error: float) -> float:
    """Time of an integrator for a root mean square error, from its tolerances. [s]."""
    own = sorted(
        (found for found in outcomes if found.name == name),
        key=lambda found: found.root_mean_square_error,
    )
    errors = np.log([found.root_mean_square_error for found in own])
    return float(np.exp(np.interp(np.log(error), errors, np.log([f.seconds for f in own]))))


def print_at_tolerances(outcomes: list[Outcome]) -> None:
    """Print one line for each integrator and tolerance."""
    head = f"{'integrator':18s}{'tolerance':>10s}{'time s':>9s}{'rev/s':>8s}{'ratio':>8s}"
    print(head + f"{'rhs':>9s}{'jac':>8s}{'max err bar':>13s}{'rms err bar':>13s}")
    for found in outcomes:
        base = next(o.seconds for o in outcomes if o.tolerance == found.tolerance)
        print(
            f"{found.name:18s}{found.tolerance:10.0e}{found.seconds:9.3f}"
            f"{REVOLUTIONS / found.seconds:8.2f}{found.seconds / base:8.2f}"
            f"{found.rhs_calls:9d}{found.jacobian_calls:8d}"
            f"{found.pressure_error:13.2e}{found.root_mean_square_error:13.2e}"
        )


def print_at_equal_error(outcomes: list[Outcome]) -> None:
    """Print times at the error that the package reaches at the middle tolerance."""
    own = next(o for o in outcomes if o.tolerance == TOLERANCES[1])
    error = own.root_mean_square_error
    print(f"\nat equal root mean square error of {error:.1e} bar")
    print(f"{'integrator':18s}{'time s':>9s}{'ratio':>8s}")
    for name in dict.fromkeys(found.name for found in outcomes):
        seconds = seconds_at_error(outcomes, name, error)
        print(f"{name:18s}{seconds:9.3f}{seconds / own.seconds:8.2f}")


def main() -> None:
    """Print the table of integrators."""
    problem = Problem()
    rhs, jac = callback_microseconds(problem)
    outcomes = measure(problem)
    print(f"Lumped, {CASE.stem}, 1500 rpm, one revolution")
    print(
        f"{problem.core} core states (radial motion and gas included), cyclic after "
        f"{problem.revolutions_to_cyclic} revolutions; right-hand side {rhs:.1f} us, "
        f"Jacobian {jac:.1f} us per call from Python"
    )
    print_at_tolerances(outcomes)
    print_at_equal_error(outcomes)
