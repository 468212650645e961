"""From a march through time to a :class:`Solution` with one row per cell of time."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from typing import Any

import numpy as np

from toothspace.core.interrupts import interrupts_held
from toothspace.core.progress import Progress
from toothspace.core.status import Event, Status
from toothspace.core.types import Array
from toothspace.model.assembly import System, node_places
from toothspace.results.solution import Solution
from toothspace.results.stream import SampleStream
from toothspace.results.variables import WITH_EXTREMES, dataset_from
from toothspace.solver import outcome
from toothspace.solver.compiled_model import observe
from toothspace.solver.cyclic import History
from toothspace.solver.transient import TransientMarch

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
    return Solution(
        status=march.status,
        data=data,
        ledger=outcome.window_ledger(_history(march, [0.0, march.time], [march.first, march.last])),
        statistics=march.statistics,
        provenance=provenance,
        events=_placed(march.events, rows),
    )


def _start(march: TransientMarch) -> tuple[Array, Array]:
    """Times and states of one cell at the start of the run."""
    times: Array = _AT_ONCE * np.arange(float(march.plan.samples_per_cell))
    return times, np.tile(march.first, (times.size, 1))


def _append(march: TransientMarch, stream: SampleStream, times: Array, states: Array) -> None:
    values = _values(march, times, states)
    del values["seat_position"]
    # values that are kept: all with one number in each sample, and the chosen channels
    channels = march.plan.channels
    stream.append(
        _cells(
            {
                name: value
                for name, value in values.items()
                if channels is None or value.ndim == 1 or name in channels
            },
            march.plan.samples_per_cell,
        )
    )


def _history(march: TransientMarch, times: Any, states: Any) -> History:
    return History(
        march.status, march.system, np.asarray(times), np.asarray(states), (), 0, march.statistics
    )


def _values(march: TransientMarch, times: Array, states: Array) -> dict[str, Array]:
    """Everything that is kept of a chunk, at its samples."""
    system = march.system
    history = _history(march, times, states)
    seen = observe(system.arrays, states, times)
    sign = -1.0 if system.description.mode == "motor" else 1.0
    ports, circuit = outcome.port_values(history, seen), system.condition.circuit
    pumps = [e for e in circuit.elements if e.supplies] if circuit else []
    if system.condition.free_shaft is not None:
        # friction that holds a shaft at rest is inside the machine
        ports["shaft_torque"] = np.where(states[:, 1] == 0.0, 0.0, ports["shaft_torque"])
    return {
        **ports,
        **_load_values(system, times, states),
        "supply_speed": np.interp(times, *pumps[0].history.T) if pumps else np.zeros(times.size),
        "pressure_difference": sign * (ports["outlet_pressure"] - ports["inlet_pressure"]),
        "node_pressure": seen.pressure[:, list(_nodes(system).values())],
        **outcome.chamber_values(system, seen),
        **outcome.body_values(history, seen),
        **outcome.loss_values(history, seen),
        **outcome.lateral_values(history, seen),
    }


def _load_values(system: System, times: Array, states: Array) -> dict[str, Array]:
    """Torque of the load, and its speed and the torque of the coupling where it has its own."""
    shaft, place = system.condition.free_shaft, system.arrays.size.load
    if shaft is None or shaft.coupling is None:
        return {"load_torque": _load(system, times, states[:, 1])}
    speed, twist = states[:, place + 1], states[:, place]
    torque = shaft.coupling.stiffness * twist + shaft.coupling.damping * (states[:, 1] - speed)
    return {
        "load_torque": _load(system, times, speed),
        "load_speed": speed,
        "coupling_torque": torque,
    }


def _load(system: System, times: Array, speed: Array) -> Array:
    shaft = system.condition.free_shaft
    if shaft is None:
        return np.zeros(times.size)
    torque = shaft.linear * speed + shaft.square * speed * abs(speed)
    torque += shaft.cubic * speed**3
    if len(shaft.load_history):
        torque += np.interp(times, *shaft.load_history.T)
    return np.asarray(torque)


def _cells(values: Mapping[str, Array], samples: int) -> dict[str, Array]:
    """Means of cells of so many samples, and their extremes where they are kept."""
    reduced = {}
    for name, value in values.items():
        cells = value.reshape(-1, samples, *value.shape[1:])
        reduced[name] = cells.mean(axis=1)
        if name in WITH_EXTREMES:
            reduced[f"{name}_lowest"] = cells.min(axis=1)
            reduced[f"{name}_highest"] = cells.max(axis=1)
    return reduced


def _nodes(system: System) -> dict[str, int]:
    """Nodes of the circuit by name, with their numbers."""
    circuit = system.condition.circuit
    places = node_places(system.description, system.condition)
    return {node.name: places[node.name] for node in circuit.nodes} if circuit else {}


def _placed(events: Sequence[Event], rows: Mapping[str, Any]) -> tuple[Event, ...]:
    """Events with the shaft angle at their times."""
    times = [event.time for event in events]
    angles = np.interp(times, np.asarray(rows["time"]), np.asarray(rows["shaft_angle"]))
    return tuple(
        event._replace(shaft_angle=float(angle))
        for event, angle in zip(events, angles, strict=True)
    )
