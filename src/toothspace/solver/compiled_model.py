"""All that Python asks of the compiled model, behind one compiled function.

One entry with a task code, so that the whole model is compiled once, whatever is asked first.
Unused arguments are empty arrays.
"""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from toothspace.circuit.network import FLOW
from toothspace.core.compiled import kernel, passed_by_address
from toothspace.core.types import Array, IntArray
from toothspace.model import arrays as col
from toothspace.model.arrays import SystemArrays
from toothspace.model.carried_flows import carry_flows
from toothspace.model.chambers import hold_pressure, update_volumes, wall_energy
from toothspace.model.circuit import stored_in_elements
from toothspace.model.contacts import note_approach, update_contacts
from toothspace.model.drive import load_energy, update_load
from toothspace.model.jacobian import fill_jacobian
from toothspace.model.network import CLOSED_GAP
from toothspace.model.system import (
    error_weights,
    evaluate,
    event_values,
    finish_step,
    full_rates,
    held_torque,
    right_hand_side,
    update_tables,
)
from toothspace.numerics.ndf import bind
from toothspace.numerics.ndf_types import (
    NdfCallbacks,
    NdfRecord,
    NdfSettings,
    NdfState,
    make_record,
    make_settings,
    make_state,
)
from toothspace.numerics.static_lu import LuProgram, analyse

(
    _BEGIN,
    _ADVANCE,
    _OBSERVE,
    _PLACE,
    _CONTACTS,
    _EVALUATE,
    _HOLD,
    _MOVING_ENERGY,
    _WALL_ENERGY,
    _PRESSURE,
) = range(10)

_start, _continue = bind(
    NdfCallbacks(
        right_hand_side, finish_step, fill_jacobian, error_weights, event_values, carry_flows
    )
)


@passed_by_address
class Integration(NamedTuple):
    """Elimination program, settings, memory and record of one integration."""

    program: LuProgram
    settings: NdfSettings
    memory: NdfState
    record: NdfRecord


@passed_by_address
class Observation(NamedTuple):
    """Samples of everything that results are made of; first axis is the sample.

    Nothing flows through closed paths, and they have no height.
    """

    pressure: Array
    density: Array
    volume: Array
    gas: Array
    path_flow: Array
    path_drop: Array
    path_loss: Array
    path_drag: Array
    path_carried: Array
    path_partner: IntArray
    raw_height: Array
    pressure_force: Array
    film_force: Array
    contact_force: Array
    torque: Array
    element_flow: Array
    lateral: Array


def empty_observation(arrays: SystemArrays, count: int) -> Observation:
    """Room for a number of samples."""
    size = arrays.size
    paths, contacts, motions = size.paths, size.contacts, size.motions
    return Observation(
        pressure=np.zeros((count, size.nodes)),
        density=np.zeros((count, size.nodes)),
        volume=np.zeros((count, size.nodes)),
        gas=np.zeros((count, size.nodes)),
        path_flow=np.zeros((count, paths)),
        path_drop=np.zeros((count, paths)),
        path_loss=np.zeros((count, paths)),
        path_drag=np.zeros((count, paths)),
        path_carried=np.zeros((count, paths)),
        path_partner=np.zeros((count, paths), dtype=np.int64),
        raw_height=np.full((count, paths), np.inf),
        pressure_force=np.zeros((count, motions)),
        film_force=np.zeros((count, motions)),
        contact_force=np.zeros((count, contacts)),
        torque=np.zeros((count, arrays.torque.size)),
        element_flow=np.zeros((count, arrays.elements.shape[0])),
        lateral=np.zeros((count, arrays.lateral.now.size)),
    )


NO_RECORD = make_record(np.zeros(0), 1, 0)
"""Where an integration that only begins writes nothing."""

_NO_PROGRAM = analyse(np.ones((1, 1), dtype=bool))
_NO_INTEGRATION = Integration(
    _NO_PROGRAM, make_settings(), make_state(_NO_PROGRAM, 1, 0), NO_RECORD
)
_NO_OBSERVATION = Observation(
    *(np.zeros((0, 0), np.int64 if n == "path_partner" else float) for n in Observation._fields)
)
_NOTHING = np.zeros(0)
_NO_STATES = np.zeros((0, 0))


def begin(arrays: SystemArrays, integration: Integration, time: float, state: Array) -> None:
    """Start an integration at a time [s] and state; its counters start at zero."""
    _run(_BEGIN, arrays, integration, _NO_OBSERVATION, time, state, _NOTHING, _NO_STATES)


def advance(arrays: SystemArrays, integration: Integration, end: float) -> int:
    """Integrate to a time [s]; return the code of :class:`~toothspace.numerics.ndf_types`."""
    nothing = (_NOTHING, _NOTHING, _NO_STATES)
    return int(_run(_ADVANCE, arrays, integration, _NO_OBSERVATION, end, *nothing))


def observe(arrays: SystemArrays, states: Array, times: Array | None = None) -> Observation:
    """Evaluate the model at every sampled state; times [s] matter to circuits only."""
    count = states.shape[0]
    out = empty_observation(arrays, count)
    at = np.zeros(count) if times is None else np.ascontiguousarray(times)
    rate = np.zeros(arrays.size.total)
    # one memory layout, so that the model is compiled once
    states = np.ascontiguousarray(states)
    _run(_OBSERVE, arrays, _NO_INTEGRATION, out, 0.0, rate, at, states)
    return out


def place(arrays: SystemArrays, state: Array) -> None:
    """Evaluate tables and volumes at the shaft angle and the positions of a state."""
    _ask(_PLACE, arrays, state)


def find_contacts(arrays: SystemArrays, state: Array) -> None:
    """Evaluate the contacts of a state whose tables are at its angle."""
    _ask(_CONTACTS, arrays, state)


def evaluate_state(arrays: SystemArrays, state: Array) -> None:
    """Compute pressures, flows and forces of a state into the work arrays."""
    _ask(_EVALUATE, arrays, state)


def hold_shaft(arrays: SystemArrays, state: Array, time: float) -> None:
    """Find the torque on a shaft at rest and the largest that friction can hold."""
    _ask(_HOLD, arrays, state, time)


def moving_energy_of(arrays: SystemArrays, state: Array) -> float:
    """Kinetic energy of all fluid columns, energy of the coupling and the load beyond it. [J]."""
    return _ask(_MOVING_ENERGY, arrays, state)


def wall_energy_of(arrays: SystemArrays, pressure: Array) -> float:
    """Energy in walls and gas charges of the dynamic nodes at their pressures [Pa]. [J]."""
    return _ask(_WALL_ENERGY, arrays, pressure)


def _ask(task: int, arrays: SystemArrays, values: Array, time: float = 0.0) -> float:
    nothing = (_NOTHING, _NO_STATES)
    return float(_run(task, arrays, _NO_INTEGRATION, _NO_OBSERVATION, time, values, *nothing))


@kernel
def _run(
    task: int,
    s: SystemArrays,
    integration: Integration,
    out: Observation,
    time: float,
    state: Array,
    times: Array,
    states: Array,
) -> float:
    program, settings, memory = integration.program, integration.settings, integration.memory
    if task == _BEGIN:
        _start(s, program, settings, memory, time, state)
    elif task == _ADVANCE:
        return float(_continue(s, program, settings, memory, integration.record, time))
    elif task == _OBSERVE:
        _observe(s, times, states, state, out)
    else:
        return _value(task, s, time, state)
    return 0.0


@kernel
def _value(task: int, s: SystemArrays, time: float, state: Array) -> float:
    if task == _PLACE:
        update_tables(s, state[0])
        update_volumes(s, state)
    elif task == _CONTACTS:
        update_contacts(s, state)
    elif task == _EVALUATE:
        evaluate(s, state)
    elif task == _HOLD:
        evaluate(s, state)
        update_load(s, time)
        held_torque(s, state)
    elif task == _MOVING_ENERGY:
        return float(stored_in_elements(s, state) + load_energy(s, state))
    elif task == _WALL_ENERGY:
        energy = 0.0
        for i in range(s.size.nodes):
            d = s.dynamic_index[i]
            if d >= 0:
                energy += wall_energy(s.node[i], state[d])
        return energy
    elif task == _PRESSURE:
        hold_pressure(s, int(state[0]), state[1])
    return 0.0


@kernel
def _observe(s: SystemArrays, times: Array, states: Array, rate: Array, out: Observation) -> None:
    direction = s.drive[col.DIRECTION]
    for i in range(states.shape[0]):
        state = states[i]
        if s.drive[col.FREE] > 0.0:
            s.drive[col.DIRECTION] = np.sign(state[1])
        full_rates(times[i], state, s, rate)
        note_approach(s, state)
        for j in range(s.size.nodes):
            out.pressure[i, j] = s.node[j, col.PRESSURE]
            out.density[i, j] = s.node[j, col.DENSITY]
            out.volume[i, j] = s.node[j, col.VOLUME]
            out.gas[i, j] = s.node[j, col.GAS]
        _note_paths(s, state, out, i)
        for k in range(s.size.motions):
            out.pressure_force[i, k] = s.motion[k, col.PRESSURE_FORCE]
            out.film_force[i, k] = s.motion[k, col.FILM_FORCE]
        for k in range(s.contact.shape[0]):
            out.contact_force[i, k] = s.contact[k, col.CONTACT_FORCE]
        for k in range(s.torque.size):
            out.torque[i, k] = s.torque[k]
        for k in range(s.elements.shape[0]):
            out.element_flow[i, k] = s.elements[k, FLOW]
        for k in range(s.lateral.now.size):
            out.lateral[i, k] = s.lateral.now[k]
    s.drive[col.DIRECTION] = direction


@kernel
def _note_paths(s: SystemArrays, state: Array, out: Observation, i: int) -> None:
    for j in range(s.size.paths):
        a, b = s.path_index[j, col.NODE_A], s.path_index[j, col.PRESENT_B]
        out.path_partner[i, j] = b
        out.path_drop[i, j] = s.node[a, col.PRESSURE] - s.node[b, col.PRESSURE]
    for row in range(s.paths.open[-1]):
        j = s.paths.open[row]
        out.path_flow[i, j] = s.path[row, col.FLOW]
        out.path_loss[i, j] = s.path[row, col.LOSS]
        out.path_drag[i, j] = s.path[row, col.DRAG]
        # what the chambers' accounts hand over between nominal and displaced wall
        width = s.path_values[row, 1] if row < s.open_kinds[col.ORIFICE] else 0.0
        opened = s.path[row, col.HEIGHT] - s.path[row, col.NOMINAL_HEIGHT]
        throat = s.open_data[row, col.MULTIPLICITY] * s.open_data[row, col.THROAT_SPEED]
        out.path_carried[i, j] = -throat * opened * width if width > CLOSED_GAP else 0.0
        height = s.path_values[row, col.GEOMETRY]
        for k in range(s.size.motions):
            height += s.path_values[row, col.HEIGHT_BY_MOTION + k] * state[s.size.position + k]
        out.raw_height[i, j] = height
