"""Where lumped runs spend their steps and their time.

    python -m benchmarks.steps            # prints the tables
    python -m benchmarks.steps --store    # and writes them into benchmarks/results/steps.md
    python -m benchmarks.steps --case startup_fan_drive

Every accepted step of a march is read: its size, its order and the state whose error is the
largest share of the error norm that bounds it. Steady cases march one revolution from their cyclic
state. Times are those of one part in a loop at a state of that march, with counts of the whole
march; what the loops leave of its processor time is named as the rest.
"""

from __future__ import annotations

import argparse
import re
import time
from collections import Counter
from collections.abc import Callable
from dataclasses import dataclass, replace
from functools import cache
from pathlib import Path
from typing import Any
from unittest.mock import patch

import numba
import numpy as np

import toothspace.core.compilation.jit  # noqa: F401 records are known to Numba
from benchmarks.bench_lumped import block_of, record_at
from toothspace import api
from toothspace.core.compiled import njit
from toothspace.core.status import Status
from toothspace.model.assembly import System, assemble
from toothspace.model.jacobian import fill_jacobian
from toothspace.model.system import finish_step, right_hand_side, update_tables
from toothspace.numerics.ndf_types import NdfState
from toothspace.numerics.static_lu import factorise, solve
from toothspace.solver import transient
from toothspace.solver.cyclic import RunPlan, march_revolutions
from toothspace.solver.integrator import March, Piece, start_march

PAGE = Path(__file__).resolve().parents[1] / "benchmarks" / "results" / "steps.md"
CASES = Path(__file__).resolve().parents[1] / "cases"
EDGES = (0.3, 1.0, 3.0, 10.0, 30.0, 100.0)
"""Limits of the classes of the histogram. [us]"""
TOLERANCE = 1e-6
START = 3.0
"""Time of the start cycle that is marched. [s]"""
PLAN = transient.TimePlan(START, 600)
PARTS = ("right-hand side", "tables", "Jacobian", "factors", "correction", "ledger")
_TABLE = re.compile(r"(?<=<!-- tables -->\n).*?(?=<!-- end of tables -->)", re.DOTALL)
PIECES = 40
"""Pieces of a revolution, each timed by its fastest run, so that other load counts little."""
LOOP, TRIES, RUNS = 400, 60, 7


@dataclass(frozen=True)
class Task:
    """What is marched.

    Parameters
    ----------
    name : str
        Words of the table.
    case : str
        Shipped case.
    overrides : tuple of str
        Keys that differ.
    duration : float
        Seconds from the start of a case with a circuit; zero for one cyclic revolution. [s]
    """

    name: str
    case: str
    overrides: tuple[str, ...] = ()
    duration: float = 0.0


def _point(speed: int, pressure: int) -> tuple[str, ...]:
    return (
        f"operating_point.shaft_speed={speed} rpm",
        f"operating_point.inlet_pressure={pressure + 1} bar",
    )


TASKS = (
    Task("motor, 1500 rpm, 200 bar", "egm12_motor", _point(1500, 200)),
    Task("motor, 300 rpm, 200 bar", "egm12_motor", _point(300, 200)),
    Task("motor, 300 rpm, 10 bar", "egm12_motor", _point(300, 10)),
    Task(f"start cycle, first {START:g} s", "startup_fan_drive", (), START),
    Task("pump", "egm12_pump"),
    Task("gerotor", "gerotor_trochoidal"),
    Task("crescent pump", "crescent_pump"),
)


def groups(system: System) -> list[str]:
    """Group of each core state in words."""
    size, names = system.arrays.size, ["shaft", "shaft"]
    dynamic = np.flatnonzero(np.asarray(system.arrays.dynamic_index) >= 0)
    chambers = ["mass of a chamber" if i < size.chambers else "mass of a volume" for i in dynamic]
    names += chambers + ["gas"] * len(chambers) + ["bodies"] * (2 * size.motions)
    return names + ["circuit and load"] * (size.core - len(names))


class StepReader:
    """A march that reads every step; used in place of one."""

    def __init__(self, march: March) -> None:
        self.march, self.size, self.order = march, [], []
        self.limiting: list[str] = []
        self._names = groups(march.system)

    @property
    def state(self) -> NdfState:
        """Memory of the integrator."""
        return self.march.state

    @property
    def statistics(self) -> dict[str, float]:
        """Counters of the integrator."""
        return self.march.statistics

    def restart(self, time: float, state: np.ndarray) -> None:
        """Go on from a state at a time. [s]."""
        self.march.restart(time, state)

    def advance(self, times: np.ndarray) -> Piece:
        """Integrate to the last time, one step a call, with the states at all times. [s]."""
        control, pieces, given = self.state.control[0], [], 0
        while True:
            passed = int(np.searchsorted(times, control["time"], "right"))
            if control["time"] >= times[-1]:
                pieces.append(self.march.advance(times[given:]))
                break
            end = np.nextafter(control["time"], np.inf)
            steps, asked = int(control["steps"]), np.append(times[given:passed], end)
            piece = self.march.advance(asked)
            pieces.append(replace(piece, states=piece.states[: passed - given]))
            if piece.stopped or piece.status is not Status.DONE:
                break
            given = passed
            if control["steps"] > steps:
                self._note()
        last, states = pieces[-1], np.vstack([piece.states for piece in pieces])
        events = tuple(event for piece in pieces for event in piece.events)
        return replace(last, times=times[: len(states)], states=states, events=events)

    def _note(self) -> None:
        control, memory = self.state.control[0], self.state
        errors = np.abs(memory.work[2, : memory.inverse_weights.size]) * memory.inverse_weights
        self.size.append(float(control["step"]))
        self.order.append(int(control["order"]))
        self.limiting.append(self._names[int(np.argmax(errors))])


class Clock:
    """A march that notes the processor time of every call that advances it. [s]."""

    def __init__(self, march: March) -> None:
        self.march, self.state, self.restart = march, march.state, march.restart
        self.seconds: list[float] = []

    @property
    def statistics(self) -> dict[str, float]:
        """Counters of the integrator."""
        return self.march.statistics

    def advance(self, times: np.ndarray) -> Piece:
        """Integrate to the last time. [s]."""
        began = time.process_time()
        piece = self.march.advance(times)
        self.seconds.append(time.process_time() - began)
        return piece


@dataclass(frozen=True)
class Prepared:
    """A task ready to be marched: its system, and where and how long it goes. [s]."""

    task: Task
    system: System
    start: np.ndarray
    duration: float


def prepare(task: Task) -> Prepared:
    """Set a task up; a steady one is marched to its cyclic state first."""
    case = api.load_case(CASES / f"{task.case}.toml", task.overrides)
    run = api.prepare(case).worn()
    description, fluid = run.machine, run.fluid
    if task.duration:
        system = assemble(description, fluid, run.condition)
        return Prepared(task, system, np.zeros(0), task.duration)
    condition = replace(run.condition, relative_tolerance=TOLERANCE)
    system = assemble(description, fluid, condition)
    start = march_revolutions(system, RunPlan()).states[0].copy()
    start[system.arrays.size.core :] = 0.0
    return Prepared(task, system, start, 2.0 * np.pi / abs(condition.shaft_speed))


def marched(ready: Prepared, kind: Callable[[March], Any]) -> Any:
    """March as a task says; what integrates is what ``kind`` makes of the march, and returned."""
    if not ready.task.duration:
        march = kind(start_march(ready.system, ready.start))
        ends = np.linspace(0.0, ready.duration, PIECES + 1)
        for k in range(PIECES):
            march.advance(ends[k : k + 2])
        return march
    kept = []

    def start(*arguments: Any) -> Any:
        kept.append(kind(start_march(*arguments)))
        return kept[-1]

    with patch.object(transient, "start_march", start):
        for _ in transient.TransientMarch(ready.system, PLAN).chunks():
            pass
    return kept[0]


@cache
def loop_of(kinds: tuple[Any, ...]) -> Callable[..., None]:
    """Loop over one part, for systems, programs and memories of given types."""
    record, lu_record, memory_record = (record_at(kind) for kind in kinds)

    @njit
    def loop(part, count, kind, time, address, lu_address, memory_address, y, rate):  # type: ignore[no-untyped-def]
        s, lu, m = record(address), lu_record(lu_address), memory_record(memory_address)
        n = m.delta.size
        for k in range(count):
            if part == 0:
                right_hand_side(time, y, s, rate)
            elif part == 1:
                update_tables(s, y[0] + 1e-9 * (k % 2))
            elif part == 2:
                fill_jacobian(time, y, s, m.jacobian, m.basis)
            elif part == 3:
                factorise(lu, m.jacobian, m.basis, 1e-6, m.factors, m.pivots)
            elif part == 4:
                solve(lu, m.factors, m.pivots, kind, rate[:n], m.work[5])
            else:
                finish_step(time, y, s, rate, m.weights, m.events[1])

    return loop  # type: ignore[no-any-return]


def part_times(march: March) -> dict[str, float]:
    """Processor time of one call of each part at the end of a march. [us]."""
    arrays, memory, program = march.system.arrays, march.state, march.program
    loop = loop_of(tuple(numba.typeof(one) for one in (arrays, program, memory)))
    blocks = [block_of(one) for one in (arrays, program, memory)]
    addresses = [block.ctypes.data for block in blocks]
    kind, at = int(memory.control["dense_factors"][0]), float(memory.control["time"][0])
    y, rate, found = memory.differences[0].copy(), np.zeros(memory.y.size), {}
    for part, name in enumerate(PARTS):
        loop(0, 1, kind, at, *addresses, y, rate)
        loop(part, 1, kind, at, *addresses, y, rate)
        tries = []
        for _ in range(TRIES):
            began = time.process_time()
            loop(part, LOOP, kind, at, *addresses, y, rate)
            tries.append(1e6 * (time.process_time() - began) / LOOP)
        found[name] = min(tries)
    return found


@dataclass(frozen=True)
class Examined:
    """Steps of a march, its processor time in one piece [s] and the times of its parts. [us]."""

    ready: Prepared
    reader: StepReader
    seconds: float
    parts: dict[str, float]


def examine(task: Task) -> Examined:
    """March step by step, against the clock, and time the parts."""
    ready = prepare(task)
    reader = marched(ready, StepReader)
    runs = [marched(ready, Clock) for _ in range(RUNS)]
    seconds = np.min([run.seconds for run in runs], axis=0).sum()
    return Examined(ready, reader, float(seconds), part_times(runs[-1].march))


def step_rows(found: list[Examined]) -> list[str]:
    """Histogram of the step sizes, orders, and what bounds the steps."""
    classes = [f"to {edge:g}" for edge in EDGES] + [f"over {EDGES[-1]:g}"]
    lines = [
        "| share of the steps [%] | " + " | ".join(one.ready.task.name for one in found) + " |",
        "|---|" + "---|" * len(found),
    ]

    def row(name: str, values: list[str]) -> None:
        lines.append(f"| {name} | " + " | ".join(values) + " |")

    counts = [one.reader.statistics for one in found]
    row("accepted steps", [f"{c['steps']:.0f}" for c in counts])
    row("rejected steps", [f"{c['rejected']:.0f}" for c in counts])
    shares = [
        np.histogram(1e6 * np.array(one.reader.size), [0.0, *EDGES, np.inf])[0]
        / len(one.reader.size)
        for one in found
    ]
    for k, name in enumerate(classes):
        row(f"{name} us", [f"{100.0 * share[k]:.1f}" for share in shares])
    for order in range(1, 6):
        row(f"order {order}", [_share(one.reader.order.count(order), one) for one in found])
    limits = [Counter(one.reader.limiting) for one in found]
    for name in sorted(set().union(*limits), key=lambda n: -sum(c[n] for c in limits)):
        row(f"bounded by {name}", [_share(c[name], e) for c, e in zip(limits, found, strict=True)])
    return lines


def _share(count: int, one: Examined) -> str:
    return f"{100.0 * count / len(one.reader.size):.1f}"


def cost_rows(found: list[Examined]) -> list[str]:
    """Calls and times of the parts, and their shares of the march."""
    lines = [
        "| calls; us a call; share of the time | "
        + " | ".join(one.ready.task.name for one in found)
        + " |",
        "|---|" + "---|" * len(found),
    ]
    used = np.zeros(len(found))
    for name in PARTS:
        cells = []
        for k, one in enumerate(found):
            count, each = _calls(one.reader.statistics)[name], one.parts[name]
            share = 1e-6 * count * each / one.seconds
            used[k] += share
            cells.append(f"{count:.0f}; {each:.2f}; {100.0 * share:.0f} %")
        lines.append(f"| {name} | " + " | ".join(cells) + " |")
    rest = [f"{100.0 * (1.0 - share):.0f} %" for share in used]
    lines.append("| not in these parts | " + " | ".join(rest) + " |")
    whole = [
        f"{1e3 * one.seconds:.0f} ms, {1e6 * one.seconds / one.reader.statistics['steps']:.1f}"
        for one in found
    ]
    lines.append("| whole march; us a step | " + " | ".join(whole) + " |")
    return lines


def _calls(counts: dict[str, float]) -> dict[str, float]:
    attempts = counts["steps"] + counts["rejected"]
    called = (counts["rhs"], attempts, counts["jac"], counts["lu"], counts["rhs"], counts["steps"])
    return dict(zip(PARTS, called, strict=True))


def main() -> None:
    """Print the tables, and write them into the page."""
    parser = argparse.ArgumentParser(prog="python -m benchmarks.steps", description=__doc__)
    parser.add_argument("--case", help="tasks of this case only")
    parser.add_argument("--store", action="store_true", help="write the tables into the page")
    arguments = parser.parse_args()
    chosen = [task for task in TASKS if arguments.case in (None, task.case)]
    found = [examine(task) for task in chosen]
    text = "\n".join([*step_rows(found), "", *cost_rows(found)]) + "\n"
    print(text)
    if arguments.store and not arguments.case:
        page = PAGE.read_text(encoding="utf-8")
        PAGE.write_text(_TABLE.sub(lambda _: text + "\n", page), encoding="utf-8")


if __name__ == "__main__":
    main()
