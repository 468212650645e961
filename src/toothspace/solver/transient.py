"""Marches a machine with a free shaft through time, stick and slip included, to a solution."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import Any, final

import numpy as np

from toothspace.circuit.electric_drive import LinkedDrive
from toothspace.circuit.history import NO_HISTORY
from toothspace.closures.friction import STUCK, next_direction
from toothspace.core.interrupts import interrupts_held
from toothspace.core.progress import Progress
from toothspace.core.status import Event, Status
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.assembly import System, node_places
from toothspace.results.solution import Solution
from toothspace.results.stream import SampleStream
from toothspace.results.variables import WITH_EXTREMES, dataset_from
from toothspace.solver import outcome
from toothspace.solver.co_simulation import CoSimulation
from toothspace.solver.compiled_model import hold_shaft
from toothspace.solver.cyclic import History
from toothspace.solver.flow_regime import FlowRegimes
from toothspace.solver.initial import start_state
from toothspace.solver.integrator import March, start_march

_CELLS_PER_CHUNK = 50
_KINKS = 1000
_LOOKS = 10
"""States of a chunk at which the flow in its gaps is judged."""


@final
@dataclass(frozen=True)
class TimePlan:
    """Duration and sampling of a transient run."""

    duration: float
    """Simulated time. [s]"""
    cells: int = 4000
    """Rows of the result; each keeps mean, lowest and highest value of its samples."""
    samples_per_cell: int = 8
    """Samples evaluated in each cell."""
    max_steps: int = 50_000_000
    """Most time steps."""
    channels: tuple[str, ...] | None = None
    """Kept variables of those with several values in each sample; all if not given."""


@final
@dataclass
class TransientMarch:
    """A transient run in progress: chunks of sampled states, and events."""

    system: System
    """Machine with a free shaft."""
    plan: TimePlan
    """Duration and sampling."""
    status: Status = Status.DONE
    events: list[Event] = field(default_factory=list)
    statistics: dict[str, float] = field(default_factory=dict)
    regimes: FlowRegimes = field(init=False)
    """Largest Reynolds and Taylor numbers of the samples so far."""
    exchange: CoSimulation = field(init=False)
    """Units of other programs beside it."""
    first: Array = field(default_factory=lambda: np.zeros(0))
    last: Array = field(default_factory=lambda: np.zeros(0))
    time: float = 0.0

    def __post_init__(self) -> None:
        self.regimes = FlowRegimes(self.system)
        self.exchange = CoSimulation(self.system)

    def chunks(self, progress: Progress | None = None) -> Iterator[tuple[Array, Array]]:
        """Yield times [s] and states of whole cells until the end, a failure or an interrupt."""
        state = start_state(self.system)
        self.first = self.last = state
        try:
            self.exchange.meet(0.0, state)
            settle(self.system, state, 0.0)
            march = start_march(self.system, state, self.plan.max_steps)
            yield from self._march(march, progress)
        except KeyboardInterrupt:
            self.status = Status.INTERRUPTED
        finally:
            self.exchange.close()

    def _march(self, march: March, progress: Progress | None) -> Iterator[tuple[Array, Array]]:
        plan = self.plan
        count = plan.samples_per_cell * _CELLS_PER_CHUNK
        total = plan.cells * plan.samples_per_cell
        step = plan.duration / total
        for begin in range(0, total, count):
            times: Array = step * np.arange(begin + 1.0, min(begin + count, total) + 1.0)
            states = self._advance(march, times)
            whole = len(states) // plan.samples_per_cell * plan.samples_per_cell
            if whole:
                self.last, self.time = states[whole - 1], float(times[whole - 1])
                yield times[:whole], states[:whole]
            if self.status is not Status.DONE:
                return
            if progress:
                progress(self.time / plan.duration, f"{self.time:.2f} s")

    def _advance(self, march: March, times: Array) -> Array:
        """States at the times; restarts at kinks of schedules and where the shaft switches."""
        parts: list[Array] = []
        begin = times[0] - (times[1] - times[0])
        end = times[-1]
        schedule = self.system.condition.speed_schedule
        circuit = self.system.condition.circuit
        tables = [e.history for e in circuit.elements] if circuit else []
        knots = np.unique(np.concatenate([table[:, 0] for table in (schedule, *tables)]))
        if knots.size > _KINKS:
            knots = np.unique(schedule[:, 0])
        own = (float(knot) for knot in knots if begin < knot <= end)
        for kink in [*sorted({*self.exchange.until(end), *own}), None]:
            until = times.size if kink is None else int(np.searchsorted(times, kink, "right"))
            ahead = times[sum(map(len, parts)) : until]
            if kink is not None and (ahead.size == 0 or ahead[-1] < kink):
                ahead = np.append(ahead, kink)
            states = self._advance_smoothly(march, ahead)
            parts.append(states[: until - sum(map(len, parts))])
            if self.status is not Status.DONE:
                break
            if kink is not None:
                state = march.state.y.copy()
                # as the case or a unit gives it
                speed = schedule
                if circuit is not None and circuit.leads("speed"):
                    first = int(self.system.arrays.drive[col.SPEED_KNOT])
                    speed = self.system.arrays.schedule[first : first + 2]
                if len(speed):
                    state[1] = np.interp(kink, speed[:, 0], speed[:, 1])
                self.exchange.meet(kink, state)
                settle(self.system, state, kink)
                march.restart(kink, state)
        return np.vstack(parts)

    def _advance_smoothly(self, march: March, times: Array) -> Array:
        parts = [np.zeros((0, self.system.arrays.size.total))]
        while times.size:
            piece = march.advance(times)
            parts.append(piece.states)
            self.events.extend(piece.events)
            self.statistics = march.statistics
            self.status = piece.status
            times = times[len(piece.states) :]
            if not piece.stopped:
                break
            state = march.state.y.copy()
            time = float(march.state.control[0]["valid_until"])
            drive = self.system.arrays.drive
            if drive[col.DIRECTION] == STUCK:
                drive[col.DIRECTION] = next_direction(0.0, drive[col.DRIVING_TORQUE], 0.0)
            else:
                state[1] = 0.0
                settle(self.system, state, time)
            march.restart(time, state)
        return np.vstack(parts)


def settle(system: System, state: Array, time: float) -> None:
    """Let the shaft stick if it is at rest and friction can hold it; else set its direction."""
    drive = system.arrays.drive
    drive[col.DIRECTION] = np.sign(state[1])
    if drive[col.FREE] == 0.0:
        speed = system.condition.speed_schedule
        if state[1] == 0.0 and len(speed):
            later = speed[speed[:, 0] > time, 1]
            drive[col.DIRECTION] = np.sign(later[0]) if later.size else 0.0
        return
    if state[1] != 0.0:
        return
    hold_shaft(system.arrays, state, time)
    holding = drive[col.HOLDING_TORQUE] if drive[col.BREAKAWAY] > 0.0 else 0.0
    drive[col.DIRECTION] = next_direction(0.0, drive[col.DRIVING_TORQUE], holding)


_AT_ONCE = 1e-12


def transient_solution(
    march: TransientMarch,
    provenance: Mapping[str, str],
    extra: Mapping[str, Any],
    title: str,
    progress: Progress | None = None,
) -> Solution:
    """March to the end and keep mean, lowest and highest value of every cell of time on disk.

    Parameters
    ----------
    march : TransientMarch
        Run that has not begun.
    provenance, extra, title
        As for :func:`toothspace.solver.outcome.solution_from`.
    progress : callable, optional
        Called with the finished share and a short text.
    """
    stream = SampleStream()
    # append all cells to the stream; a run that fails in its first cell keeps its start
    try:
        for times, states in march.chunks(progress):
            with interrupts_held():
                _append(march, stream, times, states)
            if stream.failure is not None:
                march.status = Status.NOT_STORED
                break
    except KeyboardInterrupt:
        march.status = Status.INTERRUPTED
    if stream.rows == 0:
        if march.status is Status.INTERRUPTED:
            raise KeyboardInterrupt
        _append(march, stream, *_start(march))
    system = march.system
    rows = stream.finish()
    constants = {
        **outcome.constants_of(system, rows),
        "seat_position": _values(march, *_start(march))["seat_position"],
    }
    data = dataset_from(
        {**rows, **constants, **extra},
        {**outcome.labels_of(system), "node": list(_nodes(system))},
        sample="time",
        attributes=outcome.attributes_of(system.description, title),
    )
    # events with the shaft angle at their times
    moments = [event.time for event in march.events]
    angles = np.interp(moments, np.asarray(rows["time"]), np.asarray(rows["shaft_angle"]))
    return Solution(
        status=march.status,
        data=data,
        ledger=outcome.window_ledger(_history(march, [0.0, march.time], [march.first, march.last])),
        statistics=march.statistics,
        provenance=provenance,
        events=tuple(
            event._replace(shaft_angle=float(angle))
            for event, angle in zip(march.events, angles, strict=True)
        ),
    ).with_note(*march.regimes.findings())


def _start(march: TransientMarch) -> tuple[Array, Array]:
    """Times and states of one cell at the start of the run."""
    times: Array = _AT_ONCE * np.arange(float(march.plan.samples_per_cell))
    return times, np.tile(march.first, (times.size, 1))


def _append(march: TransientMarch, stream: SampleStream, times: Array, states: Array) -> None:
    values = _values(march, times, states)
    del values["seat_position"]
    # means over cells, and extremes of some, of what has one number in each sample and of the
    # chosen channels
    channels = march.plan.channels
    reduced = {}
    for name, value in values.items():
        if channels is None or value.ndim == 1 or name in channels:
            cells = value.reshape(-1, march.plan.samples_per_cell, *value.shape[1:])
            reduced[name] = cells.mean(axis=1)
            if name in WITH_EXTREMES:
                reduced[f"{name}_lowest"] = cells.min(axis=1)
                reduced[f"{name}_highest"] = cells.max(axis=1)
    stream.append(reduced)
    march.exchange.forget()


def _history(march: TransientMarch, times: Any, states: Any) -> History:
    return History(
        march.status, march.system, np.asarray(times), np.asarray(states), (), 0, march.statistics
    )


def _values(march: TransientMarch, times: Array, states: Array) -> dict[str, Array]:
    """Everything that is kept of a chunk, at its samples."""
    system = march.system
    history = _history(march, times, states)
    seen = march.exchange.observed(states, times)
    march.regimes.look(states, seen, _LOOKS)
    sign = -1.0 if system.description.mode == "motor" else 1.0
    ports, circuit = outcome.port_values(history, seen), system.condition.circuit
    pumps = [
        march.exchange.history(("speed", k), element.history)
        for k, element in enumerate(circuit.elements if circuit else ())
        if element.turns
    ]
    # torque of the load, with its speed and the torque of the coupling where it has its own
    shaft, place, given = system.condition.free_shaft, system.arrays.size.load, _load_history(march)
    if shaft is None or shaft.coupling is None:
        load = {"load_torque": _load(system, times, states[:, 1], given)}
    else:
        speed, twist, coupling = states[:, place + 1], states[:, place], shaft.coupling
        load = {
            "load_torque": _load(system, times, speed, given),
            "load_speed": speed,
            "coupling_torque": coupling.stiffness * twist
            + coupling.damping * (states[:, 1] - speed),
        }
    if system.condition.free_shaft is not None:
        # friction that holds a shaft at rest is inside the machine
        ports["shaft_torque"] = np.where(states[:, 1] == 0.0, 0.0, ports["shaft_torque"])
    return {
        **ports,
        **load,
        **_drive_values(march, times, states[:, 1]),
        "supply_speed": np.interp(times, *pumps[0].T) if pumps else np.zeros(times.size),
        "pressure_difference": sign * (ports["outlet_pressure"] - ports["inlet_pressure"]),
        "node_pressure": seen.pressure[:, list(_nodes(system).values())],
        **outcome.chamber_values(system, seen),
        **outcome.body_values(history, seen),
        **outcome.loss_values(history, seen),
        **outcome.lateral_values(history, seen),
    }


def _load_history(march: TransientMarch) -> Array:
    shaft = march.system.condition.free_shaft
    given = NO_HISTORY if shaft is None else shaft.load_history
    return march.exchange.history(("torque", -1), given)


def _drive_values(march: TransientMarch, times: Array, speed: Array) -> dict[str, Array]:
    """Torque, power and losses of an electric drive, where there is one."""
    circuit = march.system.condition.circuit
    units = circuit.units if circuit else ()
    drives = [unit.keys for unit in units if isinstance(unit, LinkedDrive)]
    if not drives:
        return {}
    torque = -np.interp(times, *_load_history(march).T)
    powers = drives[0].powers(torque, speed)
    return {
        "drive_torque": torque,
        "electric_power": powers.electric,
        "drive_motor_loss": powers.motor_loss,
        "drive_inverter_loss": powers.inverter_loss,
    }


def _load(system: System, times: Array, speed: Array, history: Array) -> Array:
    shaft = system.condition.free_shaft
    if shaft is None:
        return np.zeros(times.size)
    torque = shaft.linear * speed + shaft.square * speed * abs(speed)
    torque += shaft.cubic * speed**3
    if len(history):
        torque += np.interp(times, *history.T)
    return np.asarray(torque)


def _nodes(system: System) -> dict[str, int]:
    """Nodes of the circuit by name, with their numbers."""
    circuit = system.condition.circuit
    places = node_places(system.description, system.condition)
    return {node.name: places[node.name] for node in circuit.nodes} if circuit else {}
