"""Running-in: how deep the gears cut into the casing at a break-in condition."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, final

import numpy as np

from toothspace.case import Case
from toothspace.case.fingerprint import fingerprint
from toothspace.core.compilation.library import way
from toothspace.core.compiled import cache_root, digest_of_sources
from toothspace.core.files import keep_arrays, load_arrays
from toothspace.core.progress import Progress, part
from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.core.units import ATMOSPHERIC_PRESSURE
from toothspace.model.assembly import System, assemble
from toothspace.model.description import MachineDescription
from toothspace.model.operating_point import OperatingCondition
from toothspace.model.paths import by_kind
from toothspace.results.solution import Solution
from toothspace.run.condition import fluid_of
from toothspace.solver.compiled_model import observe
from toothspace.solver.cyclic import History, RunPlan, first_turn_state, march_revolutions

_PLAN = RunPlan(max_revolutions=20, samples_per_revolution=720)
_TOLERANCE = 1e-5
_MOST_FILES = 2000
_SETTLED = 0.02
"""Change of a track from one revolution to the next, over the deepest, that counts as none. [-]"""
_LEAST_CHANGE = 0.05e-6
"""Change that counts as none however shallow the track is, less than any roughness. [m]"""
_STILL_CUTS = (
    "Running-in does not come to an end: from one revolution to the next its track still changes "
    "by {:.2g} µm, of {:.2g} µm. Ask for another machine.casing.wear_in, such as a higher "
    "shaft_speed or a lower pressure, at which the gears run smoothly."
)
_CHANGE = "change"
"""Name under which the change of the tracks is kept beside them."""
CUT_SHORT = (
    Status.INTERRUPTED,
    Status.STEP_TOO_SMALL,
    Status.FLUID_ENCLOSED,
    Status.MAX_STEPS,
    Status.OUT_OF_MESH,
)
"""How a march ends before its time."""


@final
@dataclass(frozen=True, eq=False)
class Tracks:
    """What running-in has cut into the casing; nothing without running-in."""

    depths: Mapping[str, Array] = field(default_factory=dict)
    """Depth of each track over the casing angle, by the path that wears. [m]"""
    status: Status = Status.DONE
    """Whether the running-in came to its end."""
    change: float = 0.0
    """Largest change of a track from the last revolution to one more. [m]"""

    def marked(self, solution: Solution) -> Solution:
        """Solution on this casing: not done on one that was cut only in part."""
        if solution.status is Status.INTERRUPTED:
            return solution
        if self.status is not Status.DONE:
            ended = replace(solution, status=self.status)
            return ended.short_of("Running-in ended before its time.")
        deepest = max((float(depth.max()) for depth in self.depths.values()), default=0.0)
        if self.change <= max(_SETTLED * deepest, _LEAST_CHANGE):
            return solution
        return solution.short_of(_STILL_CUTS.format(1e6 * self.change, 1e6 * deepest))


def named_depths(name: str, depths: Mapping[str, Array], bodies: Sequence[str]) -> dict[str, Any]:
    """Depths under the name of a result, one row per body, at the nodes of the finest table."""
    if not depths:
        return {}
    nodes, turn = max(depth.size for depth in depths.values()), 2.0 * np.pi
    angle, table = np.arange(nodes) * turn / nodes, np.zeros((len(bodies), nodes))
    for body, depth in depths.items():
        own = np.arange(depth.size) * turn / depth.size
        table[bodies.index(body)] = np.interp(angle, own, depth, period=turn)
    return {name: table, "casing_angle": angle}


def run_in(case: Case, machine: MachineDescription, progress: Progress | None = None) -> Tracks:
    """Cut the casing at the break-in condition; taken from disk if it was computed before.

    Raises KeyboardInterrupt if interrupted.
    """
    state = machine.running_in
    if state is None:
        return Tracks()
    high, low = state.pressure, ATMOSPHERIC_PRESSURE
    motor = machine.mode == "motor"
    condition = OperatingCondition(
        shaft_speed=state.shaft_speed,
        inlet_pressure=high if motor else low,
        outlet_pressure=low if motor else high,
        drain_pressure=machine.drain_pressure,
        relative_tolerance=_TOLERANCE,
    )
    fluid = fluid_of(case, state.temperature)
    key = fingerprint(case.machine_type, case.machine_spec, fluid, condition, _PLAN)
    place = folder() / f"{key}.npz"
    kept = load_arrays(place)
    if kept is not None:
        change = float(kept.pop(_CHANGE, 0.0))
        return Tracks(kept, change=change)
    plan = replace(_PLAN, max_steps=case.run.step_limit(over_time=False))
    history = _marched(assemble(machine, fluid, condition), plan, progress)
    depths, change = running_in_depths(history), 0.0
    if history.status in CUT_SHORT:
        return Tracks(depths, history.status)
    if history.status is not Status.DONE:
        once = replace(plan, revolutions=1)
        again = _marched(history.system, once, progress, first_turn_state(history))
        if again.status in CUT_SHORT:
            return Tracks(depths, again.status)
        later = running_in_depths(again)
        change = max(float(np.abs(later[body] - depth).max()) for body, depth in depths.items())
    keep_arrays(place, {**depths, _CHANGE: np.asarray(change)}, _MOST_FILES)
    return Tracks(depths, change=change)


def _marched(
    system: System, plan: RunPlan, progress: Progress | None, state: Array | None = None
) -> History:
    history = march_revolutions(system, plan, part(progress, "running-in"), state)
    if history.status is Status.INTERRUPTED:
        raise KeyboardInterrupt
    return history


def folder() -> Path:
    """Folder of stored depths, beside the compiled code and keyed by its sources.

    Code of the library and of a compiler cut tracks that differ in their last digits.
    """
    return cache_root() / f"tracks-{way()}-{digest_of_sources()}"


def running_in_depths(history: History) -> dict[str, Array]:
    """Depths that every body cuts, at the table nodes of its gap, from one revolution. [m].

    The casing is cut until no gap of the revolution is smaller than its residual height.
    """
    system = history.system
    heights = observe(system.arrays, history.states).raw_height
    angles = history.states[:, 0]
    depths: dict[str, Array] = {}
    first = 0
    for path in by_kind(system.description.paths):
        members = slice(first, first + path.count)
        if path.worn_by is not None:
            own = heights[:, members]
            period, nodes = path.geometry.period, path.geometry.values.shape[0]
            step = period / nodes
            depth = np.zeros(nodes)
            closed = path.geometry.values[:, 1] <= 0.0
            for k in range(path.count):
                angle = np.mod(path.phases[k] + path.angle_ratio * angles, period)
                index = np.round(angle / step).astype(int) % nodes
                np.maximum.at(depth, index, path.minimum_height - own[:, k])
            depth[closed] = 0.0
            # widened and rounded by a few nodes: a tip land has a width
            widened = np.max([np.roll(depth, k) for k in range(-3, 4)], axis=0)
            rounded = np.mean([np.roll(widened, k) for k in range(-3, 4)], axis=0)
            # slices of one body cut the same track
            depths[path.worn_by] = np.maximum(rounded, depths.get(path.worn_by, 0.0))
        first += path.count
    return depths
