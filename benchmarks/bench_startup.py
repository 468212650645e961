"""Start-stop cycle of the fan-drive motor: real-time factor, and the running motor against CVODE.

The cycle is the whole run of the case, with every tooth space resolved and all results kept. The
comparison integrates the running motor in its circuit, free shaft included, over two revolutions
with the same right-hand side, Jacobian and error weights.
"""

from __future__ import annotations

import time
from dataclasses import replace
from pathlib import Path

import numpy as np

from benchmarks.bench_lumped import Problem, run_cvode, run_package
from toothspace import api
from toothspace.model.assembly import assemble
from toothspace.solver.transient import TimePlan, TransientMarch

CASE = Path(__file__).resolve().parents[1] / "cases" / "startup_fan_drive.toml"
SETTLED = 4.0
RUNNING = 0.4
TOLERANCE = 1e-6
PLATEAU = 'circuit.supply.speed=[["0 s", "300 rpm"]]'


class RunningMotor(Problem):
    """The motor at a constant supply, some seconds after its start."""

    def __init__(self) -> None:
        case = api.load_case(CASE, [PLATEAU])
        run = api.prepare(case).worn()
        self.description, self.fluid, rest = run.machine, run.fluid, run.condition
        march = TransientMarch(assemble(self.description, self.fluid, rest), TimePlan(SETTLED, 400))
        for _, states in march.chunks():
            self.start = states[-1].copy()
        self.start[march.system.arrays.size.core :] = 0.0
        self.condition = replace(rest, shaft_speed=float(self.start[1]))
        self.system = assemble(self.description, self.fluid, self.condition)
        self.times = np.linspace(0.0, RUNNING, 401)
        self._bind()
        self.unit_weights = self._mean_weights(states)


def cycle() -> tuple[float, dict[str, float]]:
    """Wall time of the whole cycle [s] and counts of the integrator."""
    case = api.load_case(CASE)
    began = time.perf_counter()
    solution = api.simulate(case)
    return time.perf_counter() - began, dict(solution.statistics)


def main() -> None:
    """Print real-time factor and ratio against CVODE."""
    cycle()  # compiles
    seconds, counts = cycle()
    duration = api.load_case(CASE).circuit.duration
    print(f"Start-stop cycle, {CASE.stem}: {duration:.0f} s in {seconds:.1f} s of wall time")
    print(f"real-time factor {duration / seconds:.2f}, {counts['steps']:.0f} steps")
    motor = RunningMotor()
    own = min(run_package(motor, TOLERANCE)[0] for _ in range(3))
    other = min(run_cvode(motor, TOLERANCE)[0] for _ in range(3))
    print(f"running motor, {RUNNING} s: toothspace {own:.2f} s, SUNDIALS CVODE {other:.2f} s")
    print(f"ratio {other / own:.2f}")
