"""Quantities of interest of sampled states, computed with the compiled model."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from toothspace.core.compiled import njit
from toothspace.core.types import Array
from toothspace.model.arrays import SystemArrays
from toothspace.model.network import GEOMETRY, HEIGHT_BY_MOTION
from toothspace.model.system import right_hand_side


class Observation(NamedTuple):
    """Samples of everything that results are made of; first axis is the sample."""

    pressure: Array
    density: Array
    volume: Array
    gas: Array
    path_flow: Array
    path_drop: Array
    path_height: Array
    raw_height: Array
    pressure_force: Array
    film_force: Array
    contact_force: Array
    torque: Array
    ledger_rate: Array


def observe(arrays: SystemArrays, states: Array) -> Observation:
    """Evaluate the model at every sampled state."""
    count, size = states.shape[0], arrays.size
    paths, contacts = arrays.paths.table.size, arrays.contacts.table.size
    motions = arrays.work.pressure_force.size
    result = Observation(
        pressure=np.zeros((count, size.nodes)),
        density=np.zeros((count, size.nodes)),
        volume=np.zeros((count, size.chambers)),
        gas=np.zeros((count, size.nodes)),
        path_flow=np.zeros((count, paths)),
        path_drop=np.zeros((count, paths)),
        path_height=np.zeros((count, paths)),
        raw_height=np.zeros((count, paths)),
        pressure_force=np.zeros((count, motions)),
        film_force=np.zeros((count, motions)),
        contact_force=np.zeros((count, contacts)),
        torque=np.zeros((count, arrays.work.torque.size)),
        ledger_rate=np.zeros((count, size.total - size.core)),
    )
    _observe(arrays, states, result)
    return result


@njit(cache=True)
def _observe(s: SystemArrays, states: Array, out: Observation) -> None:
    rate = np.zeros(s.size.total)
    for i in range(states.shape[0]):
        state = states[i]
        right_hand_side(0.0, state, s, rate)
        w = s.work
        out.pressure[i] = w.pressure
        out.density[i] = w.density
        out.volume[i] = w.volume[: s.size.chambers]
        out.gas[i] = w.gas
        out.path_flow[i] = w.path_flow
        out.path_height[i] = w.path_height
        out.pressure_force[i] = w.pressure_force
        out.film_force[i] = w.film_force
        out.contact_force[i] = w.contact_force
        out.torque[i] = w.torque
        out.ledger_rate[i] = rate[s.size.core :]
        for j in range(s.paths.table.size):
            out.path_drop[i, j] = w.pressure[s.paths.node_a[j]] - w.pressure[w.path_b[j]]
            height = w.path_values[j, GEOMETRY]
            for k in range(s.size.motions):
                height += w.path_values[j, HEIGHT_BY_MOTION + k] * state[s.size.position + k]
            out.raw_height[i, j] = height
