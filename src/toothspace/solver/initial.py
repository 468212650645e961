"""Start of a run: quasi-static pressures, bodies near the wall on which they are pressed."""

from __future__ import annotations

import numpy as np

from toothspace.closures.density import mixture_density
from toothspace.core.types import Array
from toothspace.model.arrays import (
    BUSH_X,
    BUSH_Y,
    JOURNAL_CLEARANCE,
    MOTION_X,
    MOTION_Y,
    VOLUME,
)
from toothspace.model.assembly import System
from toothspace.model.chambers import update_volumes
from toothspace.model.quasi_static import mean_force, quasi_static_pressures
from toothspace.model.system import update_tables

_START_ECCENTRICITY = 0.9


def start_state(system: System) -> Array:
    """Return the state vector at shaft angle zero."""
    arrays, size = system.arrays, system.arrays.size
    state = np.zeros(size.total)
    state[1] = system.condition.shaft_speed
    _place_bodies(system, state)
    update_tables(arrays, 0.0)
    update_volumes(arrays, state)
    pressure = np.full(size.nodes, system.condition.outlet_pressure)
    pressure[: size.chambers] = quasi_static_pressures(system.description, system.condition, 0.0)
    gas = arrays.fluid.feed_gas_mass_fraction
    for node in range(size.nodes):
        d = int(arrays.dynamic_index[node])
        if d >= 0:
            density = float(mixture_density(pressure[node], gas, arrays.fluid))
            state[size.mass + d] = density * arrays.node[node, VOLUME]
            state[size.gas + d] = gas * state[size.mass + d]
    return state


def _place_bodies(system: System, state: Array) -> None:
    size = system.arrays.size
    if size.motions == 0:
        return
    force = mean_force(system.description, system.condition) @ system.motion_map
    for journal in system.arrays.journal:
        kx, ky = int(journal[MOTION_X]), int(journal[MOTION_Y])
        load = max(float(np.hypot(force[kx], force[ky])), 1e-12)
        reach = _START_ECCENTRICITY * journal[JOURNAL_CLEARANCE]
        state[size.position + kx] = journal[BUSH_X] + reach * force[kx] / load
        state[size.position + ky] = journal[BUSH_Y] + reach * force[ky] / load
