"""Start of a run: quasi-static pressures, bodies near the wall on which they are pressed."""

from __future__ import annotations

import numpy as np

from toothspace.closures.density import mixture_density
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.assembly import System, node_places
from toothspace.model.lateral_table import FORCE_SHARE, MOMENT_SHARE
from toothspace.model.quasi_static import mean_force, quasi_static_pressures
from toothspace.solver.compiled_model import evaluate_state, find_contacts, place

_START_ECCENTRICITY = 0.9
_SEARCH_STEP = 0.5
_SEARCH_STEPS = 400


def start_state(system: System) -> Array:
    """Return the state vector at the shaft angle of the start. [SI]."""
    arrays, size = system.arrays, system.arrays.size
    state = np.zeros(size.total)
    state[0] = system.condition.shaft_angle
    state[1] = system.condition.shaft_speed
    if size.core > size.load:
        state[size.load + 1] = state[1]
    _place_bodies(system, state)
    place(arrays, state)
    pressure = np.full(size.nodes, system.condition.outlet_pressure)
    if system.condition.circuit:
        # its nodes start at their own pressure, the tooth spaces at that of the outlet
        places = node_places(system.description, system.condition)
        for point in system.condition.circuit.nodes:
            pressure[places[point.name]] = point.pressure
        pressure[: size.chambers] = pressure[places["outlet"]]
    if not system.condition.over_time:
        chambers = quasi_static_pressures(system.description, system.condition, float(state[0]))
        pressure[: size.chambers] = chambers
    _turn_into_contact(system, state, pressure)
    place(arrays, state)
    gas = arrays.fluid.feed_gas_mass_fraction
    for node in range(size.nodes):
        d = int(arrays.dynamic_index[node])
        if d >= 0:
            density = float(mixture_density(pressure[node], gas, arrays.fluid))
            state[size.mass + d] = density * arrays.node[node, col.VOLUME]
            state[size.gas + d] = gas * state[size.mass + d]
    if size.load > size.film:
        evaluate_state(arrays, state)
        for k, axis in enumerate((FORCE_SHARE, MOMENT_SHARE)):
            nodes = arrays.lateral.axes[k, : arrays.lateral.counts[k]]
            state[size.film + k] = np.clip(arrays.lateral.now[axis], nodes[0], nodes[-1])
    return state


def _place_bodies(system: System, state: Array) -> None:
    size = system.arrays.size
    if size.motions == 0:
        return
    force = mean_force(system.description, system.condition) @ system.motion_map
    for journal in system.arrays.journal:
        if journal[col.CARRIER_X] >= 0.0:
            force[int(journal[col.CARRIER_X])] += force[int(journal[col.MOTION_X])]
            force[int(journal[col.CARRIER_Y])] += force[int(journal[col.MOTION_Y])]
    # what carries others stands last
    for journal in system.arrays.journal[::-1]:
        kx, ky = int(journal[col.MOTION_X]), int(journal[col.MOTION_Y])
        x, y = journal[col.BUSH_X], journal[col.BUSH_Y]
        if journal[col.CARRIER_X] >= 0.0:
            x += state[size.position + int(journal[col.CARRIER_X])]
            y += state[size.position + int(journal[col.CARRIER_Y])]
        load = max(float(np.hypot(force[kx], force[ky])), 1e-12)
        reach = _START_ECCENTRICITY * journal[col.JOURNAL_CLEARANCE]
        state[size.position + kx] = x + reach * force[kx] / load
        state[size.position + ky] = y + reach * force[ky] / load


def _turn_into_contact(system: System, state: Array, pressure: Array) -> None:
    """Turn the bodies that compliant contacts hold until these carry the pressure torque."""
    arrays, size = system.arrays, system.arrays.size
    if size.compliant == 0:
        return
    values = arrays.chamber_values[:, col.CHANNEL_MOTION :]
    torque = pressure[: size.chambers] @ values
    for k, motion in enumerate(system.free_motions):
        if system.description.motions[motion].axis != "rotation":
            continue
        place = size.position + k
        step = _SEARCH_STEP * arrays.motion[k, col.CLEARANCE]
        # rotations at which the sum of torques drives up and down
        low = high = state[place]
        for _ in range(_SEARCH_STEPS):
            state[place] = low
            if _contact_torque(system, state, place) + torque[k] > 0.0:
                break
            low -= step
        for _ in range(_SEARCH_STEPS):
            state[place] = high
            if _contact_torque(system, state, place) + torque[k] < 0.0:
                break
            high += step
        for _ in range(60):
            state[place] = 0.5 * (low + high)
            if _contact_torque(system, state, place) + torque[k] > 0.0:
                low = state[place]
            else:
                high = state[place]


def _contact_torque(system: System, state: Array, place: int) -> float:
    standing = state.copy()
    standing[1] = 0.0
    find_contacts(system.arrays, standing)
    return float(system.arrays.motion[place - system.arrays.size.position, col.CONTACT_LOAD])
