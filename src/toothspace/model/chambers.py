r"""Volumes, pressures and gas content of the chambers and other dynamic nodes.

Mass balance of node i with mass flows :math:`\dot m` into it, and pressure from its state:

.. math::

    \frac{\mathrm{d} m_i}{\mathrm{d} t} = \sum_j \dot m_j, \qquad
    p_i = p\!\left(\frac{V_i}{m_i}, \frac{m_{g,i}}{m_i}\right), \qquad
    V_i = V_{0,i}(\theta) + \sum_k \frac{\partial V_i}{\partial q_k} q_k .

Mass, not pressure, is the state: sums over chambers and ports are then kept to round-off.
"""

from __future__ import annotations

from toothspace.closures.aeration import gas_exchange_rate
from toothspace.closures.density import mixture_pressure
from toothspace.closures.enthalpy import gas_enthalpy, liquid_enthalpy
from toothspace.core.compiled import njit
from toothspace.core.types import Array
from toothspace.model.arrays import SystemArrays
from toothspace.model.tables import table_slopes, table_values

CHANNEL_VOLUME = 0
CHANNEL_MESH = 1
CHANNEL_MOTION = 2


@njit(cache=True)
def update_chamber_tables(s: SystemArrays, shaft_angle: float) -> None:
    """Evaluate the volume tables of all chambers at a shaft angle."""
    for i in range(s.size.chambers):
        angle = s.chambers.phase[i] + s.chambers.ratio[i] * shaft_angle
        table = s.chambers.table[i]
        table_values(s.bank, table, angle, s.work.chamber_values[i])
        table_slopes(s.bank, table, angle, s.work.chamber_slopes[i])


@njit(cache=True)
def update_volumes(s: SystemArrays, state: Array) -> None:
    """Volumes of all dynamic nodes and their derivative with respect to the shaft angle."""
    w = s.work
    for i in range(s.size.chambers):
        volume = w.chamber_values[i, CHANNEL_VOLUME]
        slope = w.chamber_slopes[i, CHANNEL_VOLUME]
        for k in range(s.size.motions):
            q = state[s.size.position + k]
            volume += w.chamber_values[i, CHANNEL_MOTION + k] * q
            slope += w.chamber_slopes[i, CHANNEL_MOTION + k] * q
        w.volume[i] = volume
        w.volume_rate[i] = slope * s.chambers.ratio[i]
    for node in range(s.size.chambers, s.size.nodes):
        w.volume[node] = s.condition.node_volume[node]


@njit(cache=True)
def update_pressures(s: SystemArrays, state: Array) -> None:
    """Pressure, density, gas content and their derivatives in every node."""
    w = s.work
    for node in range(s.size.nodes):
        d = s.condition.dynamic_index[node]
        if d < 0:
            w.pressure[node] = s.condition.fixed_pressure[node]
            w.gas[node] = s.condition.fixed_gas[node]
            continue
        mass = state[s.size.mass + d]
        gas = state[s.size.gas + d] / mass
        specific_volume = w.volume[node] / mass
        p, by_volume, by_gas = mixture_pressure(specific_volume, gas, s.fluid)
        w.pressure[node] = p
        w.gas[node] = gas
        w.density[node] = 1.0 / specific_volume
        w.pressure_by_mass[node] = -(by_volume * specific_volume + by_gas * gas) / mass
        w.pressure_by_gas[node] = by_gas / mass
        w.pressure_by_volume[node] = by_volume / mass


@njit(cache=True)
def update_enthalpies(s: SystemArrays) -> None:
    """Enthalpies of liquid and gas at the pressure of every node, for the energy ledger."""
    w = s.work
    for node in range(s.size.nodes):
        w.liquid_enthalpy[node] = liquid_enthalpy(w.pressure[node], s.fluid)
        w.gas_enthalpy[node] = gas_enthalpy(w.pressure[node], s.fluid)


@njit(cache=True)
def exchange_gas(s: SystemArrays, state: Array) -> float:
    """Release or dissolve gas in every dynamic node; return the power lost by it. [W]."""
    w = s.work
    loss = 0.0
    for node in range(s.size.nodes):
        d = s.condition.dynamic_index[node]
        if d < 0:
            continue
        rate, by_pressure, by_gas = gas_exchange_rate(w.pressure[node], w.gas[node], s.fluid)
        mass = state[s.size.mass + d]
        w.gas_rate[node] += mass * rate
        w.gas_exchange[node, 0] = rate
        w.gas_exchange[node, 1] = by_pressure
        w.gas_exchange[node, 2] = by_gas
        loss -= mass * rate * (w.gas_enthalpy[node] - w.liquid_enthalpy[node])
    return loss
