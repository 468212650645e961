"""Quantities of interest of sampled states, computed with the compiled model."""

from __future__ import annotations

from typing import NamedTuple

import numpy as np

from toothspace.core.compiled import njit, passed_by_address
from toothspace.core.types import Array, IntArray
from toothspace.model.arrays import (
    CONTACT_FORCE,
    DENSITY,
    DIRECTION,
    DRAG,
    ELEMENT_FLOW,
    FILM_FORCE,
    FLOW,
    FREE,
    GAS,
    GEOMETRY,
    HEIGHT_BY_MOTION,
    LOSS,
    NODE_A,
    PRESENT_B,
    PRESSURE,
    PRESSURE_FORCE,
    VOLUME,
    SystemArrays,
)
from toothspace.model.system import full_rates


@passed_by_address
class Observation(NamedTuple):
    """Samples of everything that results are made of; first axis is the sample."""

    pressure: Array
    density: Array
    volume: Array
    gas: Array
    path_flow: Array
    path_drop: Array
    path_loss: Array
    path_drag: Array
    path_partner: IntArray
    raw_height: Array
    pressure_force: Array
    film_force: Array
    contact_force: Array
    torque: Array
    element_flow: Array


def observe(arrays: SystemArrays, states: Array, times: Array | None = None) -> Observation:
    """Evaluate the model at every sampled state; times [s] matter to circuits only."""
    count, size = states.shape[0], arrays.size
    paths, contacts, motions = size.paths, size.contacts, size.motions
    result = Observation(
        pressure=np.zeros((count, size.nodes)),
        density=np.zeros((count, size.nodes)),
        volume=np.zeros((count, size.nodes)),
        gas=np.zeros((count, size.nodes)),
        path_flow=np.zeros((count, paths)),
        path_drop=np.zeros((count, paths)),
        path_loss=np.zeros((count, paths)),
        path_drag=np.zeros((count, paths)),
        path_partner=np.zeros((count, paths), dtype=np.int64),
        raw_height=np.zeros((count, paths)),
        pressure_force=np.zeros((count, motions)),
        film_force=np.zeros((count, motions)),
        contact_force=np.zeros((count, contacts)),
        torque=np.zeros((count, arrays.torque.size)),
        element_flow=np.zeros((count, arrays.elements.shape[0])),
    )
    at = np.zeros(count) if times is None else np.ascontiguousarray(times)
    # one memory layout, so that the model is compiled once
    _observe(arrays, at, np.ascontiguousarray(states), result)
    return result


@njit(cache=True)
def _observe(s: SystemArrays, times: Array, states: Array, out: Observation) -> None:
    rate = np.zeros(s.size.total)
    direction = s.drive[DIRECTION]
    for i in range(states.shape[0]):
        state = states[i]
        if s.drive[FREE] > 0.0:
            s.drive[DIRECTION] = np.sign(state[1])
        full_rates(times[i], state, s, rate)
        out.pressure[i] = s.node[:, PRESSURE]
        out.density[i] = s.node[:, DENSITY]
        out.volume[i] = s.node[:, VOLUME]
        out.gas[i] = s.node[:, GAS]
        out.path_flow[i] = s.path[:, FLOW]
        out.path_loss[i] = s.path[:, LOSS]
        out.path_drag[i] = s.path[:, DRAG]
        out.path_partner[i] = s.path_index[:, PRESENT_B]
        out.pressure_force[i] = s.motion[:, PRESSURE_FORCE]
        out.film_force[i] = s.motion[:, FILM_FORCE]
        out.contact_force[i] = s.contact[:, CONTACT_FORCE]
        out.torque[i] = s.torque
        out.element_flow[i] = s.elements[:, ELEMENT_FLOW]
        for j in range(s.size.paths):
            a, b = s.path_index[j, NODE_A], s.path_index[j, PRESENT_B]
            out.path_drop[i, j] = s.node[a, PRESSURE] - s.node[b, PRESSURE]
            height = s.path_values[j, GEOMETRY]
            for k in range(s.size.motions):
                height += s.path_values[j, HEIGHT_BY_MOTION + k] * state[s.size.position + k]
            out.raw_height[i, j] = height
    s.drive[DIRECTION] = direction
