"""March of the elastic lateral films of the fuel pump over a revolution.

    python benchmarks/bench_lateral.py [--quick] [--whole [--bodies]] [--condense]

Both sides of both gears, deformation and force balance, in steps of one degree from a start at
which films, forces and chamber pressures agree (3.5 um for both sides together), every step to a
force residual below 1e-4 of the balance force and a change of the films below 1e-3 per iteration.
By default the first steps and those of a tooth pitch after them stand for the revolution, whose
time is extrapolated, as the heading says; ``--whole`` marches all of it on the finest grid,
with ``--bodies`` between bending bodies. Processor seconds stand beside wall time. ``--condense``
condenses the bearing and a gear of the pump with 150 000 elements, each in a process of its own
whose memory is reported; OMP_NUM_THREADS sets its cores.
"""

from __future__ import annotations

import multiprocessing
import os
import resource
import sys
import time
from concurrent.futures import ProcessPoolExecutor
from dataclasses import dataclass, replace
from pathlib import Path
from unittest.mock import patch

import numpy as np

from toothspace import api
from toothspace.case import Case, load_case
from toothspace.core.processes import threads
from toothspace.elasticity import ElasticBody, SweptShape, influence_matrix
from toothspace.floating.coupling import PointRequest, couple_point
from toothspace.floating.motion import Balance
from toothspace.floating.problem import LateralProblem, LateralTrack, lateral_problem
from toothspace.run.elastic import lateral_settings
from toothspace.run.run import Marches, Run

CASE = Path(__file__).parents[1] / "cases" / "hysteresis_055.toml"
GRIDS = ((280, 26), (560, 52), (812, 74))
"""Cells round the circumference and along the radius of each gear; an interface has two gears."""
START = 1e-6
"""Gap at which the search for equilibrium begins, as in the study of the case. [m]"""
STEPS, SAMPLED = 360, 26
WARM = {"winkler": 3, "bodies": 26}
"""Steps before the sampled ones; between bodies those in which the films' response is found."""
ELEMENTS = 150_000
TARGET = 300.0
"""Wall time of a revolution with 2 x 120 000 cells. [s]"""


@dataclass(frozen=True)
class Setting:
    """Machine of the case with its chamber pressures, and the equilibrium of its bearing."""

    case: Case
    run: Run
    data: object
    settled: Balance

    def problem(self, grid: tuple[int, int], deformation: str) -> LateralProblem:
        settings = replace(
            lateral_settings(self.case), grid=grid, angles=1, deformation=deformation
        )
        return lateral_problem(self.run.machine, self.run.fluid, self.data, settings)


def prepare() -> Setting:
    """Chamber pressures and equilibrium of the bearing that agree, on the grid of the case."""
    case = load_case(CASE, ["run.max_revolutions=3"])
    run = api.prepare(case).worn().with_films()
    point = couple_point(
        run.machine,
        run.fluid,
        Marches(run),
        PointRequest(settings=lateral_settings(case), start=START),
    )
    if not (point.equilibrium.settled and point.agreed):
        raise RuntimeError("films and chambers do not agree where the benchmark begins")
    return Setting(case, run, point.solution.data, point.equilibrium.balance)


@dataclass(frozen=True)
class Times:
    """Wall and processor time of steps in the middle of a march, and of all before them."""

    march: LateralTrack
    wall: float
    used: float
    before: float


def timed(problem: LateralProblem, settled: Balance, warm: int, steps: int) -> Times:
    """Difference of two marches from the same start, the longer one by the steps."""
    start = problem.continued(settled.position)
    clocks = [(0.0, 0.0)]
    for count in (warm, warm + steps) if warm else (steps,):
        begun = time.perf_counter(), time.process_time()
        march = problem.march(start, STEPS, count / STEPS)
        clocks.append((time.perf_counter() - begun[0], time.process_time() - begun[1]))
    (before, used), (after, busy) = clocks[-2:]
    return Times(march, after - before, busy - used, before)


def row(setting: Setting, grid: tuple[int, int], deformation: str, steps: int) -> None:
    """Print the numbers of one grid."""
    problem = setting.problem(grid, deformation)
    warm = WARM[deformation] if steps < STEPS else 0
    found = timed(problem, setting.settled, warm, steps)
    march, wall = found.march, found.wall
    cells = 4 * grid[0] * grid[1]
    iterations = float(np.mean(march.iterations[warm:]))
    worst = max(march.residuals)
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    print(
        f"  {deformation:8s} 2 x {cells // 2:7d} {threads():7d} {wall / steps:8.3f} "
        f"{found.used / steps:10.3f} "
        f"{iterations:10.1f} {cells * iterations * steps / wall / 1e6:12.2f} "
        f"{found.before + wall / steps * (STEPS - warm):10.0f} {worst:9.1e} "
        f"{march.converged!s:>5s} {peak:8.2f}"
    )


def head(source: str) -> Setting:
    """Print the head of the table and find the equilibrium of the bearing."""
    print(f"Elastic lateral films, one revolution in {STEPS} steps; target {TARGET:.0f} s")
    print(f"s/revol. is {source}")
    print(
        "           cells      threads   s/step  cpu s/step  iter/step  Mcell it./s  s/revol.  "
        "residual   done  GiB peak"
    )
    return prepare()


def whole(deformation: str) -> None:
    """Print the numbers of a whole revolution on the finest grid."""
    row(head("marched whole"), GRIDS[-1], deformation, STEPS)


def report(grids: tuple[tuple[int, int], ...] = GRIDS) -> None:
    """Print scaling with cells and with cores."""
    setting = head(f"extrapolated from {SAMPLED} steps")
    for grid in grids:
        row(setting, grid, "winkler", SAMPLED)
    for grid in sorted({grids[0], grids[-1]}):
        row(setting, grid, "bodies", SAMPLED)
    if threads() > 1:
        with patch.dict(os.environ, TOOTHSPACE_THREADS="1"):
            row(setting, grids[-1], "winkler", SAMPLED)


def fine_body(name: str) -> ElasticBody:
    """Body of the pump with at least the wanted number of elements."""
    balance = api.prepare(load_case(CASE)).machine.lateral_balance
    body = balance.elastic_bodies()[name]
    shape, count, part = body.shape, 0, 1.0
    while count < ELEMENTS:
        count = len(shape.mesh(part).elements)
        part *= min(0.99, 0.995 * (count / ELEMENTS) ** (1.0 / 3.0)) if count < ELEMENTS else 1.0
    finer = SweptShape(shape.parts, part * shape.edge_length, part * shape.layer_height)
    return replace(body, shape=finer)


def condensed(name: str) -> str:
    """Row of a body: size, time and memory of its condensation, and its estimated error."""
    body = fine_body(name)
    start, used = time.perf_counter(), time.process_time()
    found = influence_matrix(body, cache=False)
    wall, busy = time.perf_counter() - start, time.process_time() - used
    peak = resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 2**20
    return (
        f"  {name:12s} {found.element_count:9d} {len(found.nodes):11d} {wall:8.0f} {busy:8.0f} "
        f"{peak:9.2f} {found.error_estimate:10.1e}"
    )


def condense() -> None:
    """Print time and memory of the condensation of a finely meshed bearing and gear."""
    print(
        "Condensation with the error estimate, which condenses a mesh 1.5 times as coarse as well"
    )
    print("  body          elements  film nodes        s    cpu s  GiB peak      error")
    for name in ("floating", "drive_gear"):
        # compiled code is loaded and memory is counted by a process of its own
        with ProcessPoolExecutor(1, multiprocessing.get_context("spawn")) as pool:
            print(pool.submit(condensed, name).result())


def main() -> None:
    """Print the table of few steps on the smallest grid."""
    report(GRIDS[:1])


if __name__ == "__main__":
    if "--condense" in sys.argv:
        condense()
    elif "--whole" in sys.argv:
        whole("bodies" if "--bodies" in sys.argv else "winkler")
    else:
        report(GRIDS[:1] if "--quick" in sys.argv else GRIDS)
