"""Start of a run: quasi-static pressures, bodies near the wall on which they are pressed."""

from __future__ import annotations

import numpy as np

from toothspace.closures.density import mixture_density
from toothspace.core.types import Array
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
        d = int(arrays.condition.dynamic_index[node])
        if d >= 0:
            density = float(mixture_density(pressure[node], gas, arrays.fluid))
            state[size.mass + d] = density * arrays.work.volume[node]
            state[size.gas + d] = gas * state[size.mass + d]
    return state


def _place_bodies(system: System, state: Array) -> None:
    journals, size = system.arrays.journals, system.arrays.size
    if size.motions == 0:
        return
    force = mean_force(system.description, system.condition) @ system.motion_map
    for j in range(journals.motion_x.size):
        kx, ky = int(journals.motion_x[j]), int(journals.motion_y[j])
        load = max(float(np.hypot(force[kx], force[ky])), 1e-12)
        reach = _START_ECCENTRICITY * float(journals.clearance[j])
        state[size.position + kx] = journals.bush_x[j] + reach * force[kx] / load
        state[size.position + ky] = journals.bush_y[j] + reach * force[ky] / load
