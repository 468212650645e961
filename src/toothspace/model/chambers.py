r"""Volumes, pressures and gas content of the chambers and other dynamic nodes.

Mass balance of node i with mass flows :math:`\dot m` into it, and pressure from its state:

.. math::

    \frac{\mathrm{d} m_i}{\mathrm{d} t} = \sum_j \dot m_j, \qquad
    p_i = p\!\left(\frac{V_i}{m_i}, \frac{m_{g,i}}{m_i}\right), \qquad
    V_i = V_{0,i}(\theta) + \sum_k \frac{\partial V_i}{\partial q_k} q_k .

Where contacts overlap elastically, this V of a small chamber between them goes down to zero and
below, the overlap counted in. A least volume e stays: :math:`e\,(1 + (V/2e)^2)` below 2 e, and e
for a negative V. Forces on bodies and the rate of the volume take its slope by V.

Volumes with compliant walls, hoses and accumulators, follow the pressure,

.. math:: V(p) = V_0 + C p + \Delta V_g(p)

with the wall compliance C of a line and the volume :math:`\Delta V_g` by which the gas charge of
an accumulator is compressed, :func:`toothspace.closures.accumulator.gas_charge_volume`.

Mass, not pressure, is the state: sums over chambers and ports are then kept to round-off.
"""

from __future__ import annotations

from toothspace.closures.accumulator import gas_charge_energy, gas_charge_volume
from toothspace.closures.aeration import gas_exchange_rate
from toothspace.closures.density import mixture_density, mixture_pressure
from toothspace.closures.enthalpy import partial_enthalpies
from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.compiled import kernel, merged
from toothspace.core.types import Array
from toothspace.model import arrays as col
from toothspace.model.arrays import SystemArrays

ITERATIONS = 60
TOLERANCE = 1e-15
LEAST_SQUEEZED = 1.01


@kernel
def wall_volume(node: Array, pressure: float) -> tuple[float, float]:
    """Volume of a node at an absolute pressure [Pa] and its slope. [m3], [m3/Pa]."""
    volume = node[col.REST_VOLUME] + node[col.WALL_COMPLIANCE] * pressure
    slope = node[col.WALL_COMPLIANCE]
    if pressure > node[col.PRECHARGE] and node[col.GAS_VOLUME] > 0.0:
        taken, by_pressure = gas_charge_volume(
            pressure, node[col.GAS_VOLUME], node[col.PRECHARGE], node[col.GAS_EXPONENT]
        )
        volume += taken
        slope += by_pressure
    return volume, slope


@kernel
def update_volume(node: Array, mass: float, gas: float, fluid: FluidLaw) -> None:
    """Find the volume at which wall and content have one pressure; Newton in a bracket."""
    if node[col.WALL_COMPLIANCE] == 0.0 and node[col.GAS_VOLUME] == 0.0:
        node[col.VOLUME] = node[col.REST_VOLUME]
        return
    # below this share of its volume the liquid has no pressure
    densest = fluid.stiffening / (fluid.compliance + fluid.stiffening) / fluid.reference_density
    low = max(node[col.REST_VOLUME], LEAST_SQUEEZED * mass * densest)
    pressure, _, _ = mixture_pressure(low / mass, gas, fluid)
    high = low + node[col.GAS_VOLUME] + node[col.WALL_COMPLIANCE] * max(pressure, 0.0)
    volume = min(max(node[col.VOLUME], low), high)
    for _ in range(ITERATIONS):
        pressure, by_volume, _ = mixture_pressure(volume / mass, gas, fluid)
        wall, node[col.WALL_SLOPE] = wall_volume(node, pressure)
        error = wall - volume
        if abs(error) <= TOLERANCE * volume:
            break
        if error > 0.0:
            low = volume
        else:
            high = volume
        volume += error / (1.0 - node[col.WALL_SLOPE] * by_volume / mass)
        if not low < volume < high:
            volume = 0.5 * (low + high)
    node[col.VOLUME] = volume


@kernel
def wall_energy(node: Array, pressure: float) -> float:
    """Energy kept in the wall and in the gas charge of a node. [J]."""
    energy = 0.5 * node[col.WALL_COMPLIANCE] * pressure * pressure
    if pressure > node[col.PRECHARGE] and node[col.GAS_VOLUME] > 0.0:
        volume, exponent = node[col.GAS_VOLUME], node[col.GAS_EXPONENT]
        energy += gas_charge_energy(pressure, volume, node[col.PRECHARGE], exponent)
    return energy


@kernel
def update_volumes(s: SystemArrays, state: Array) -> None:
    """Volumes of all chambers and their derivative with respect to the shaft angle."""
    node, values, slopes, size = s.node, s.chamber_values, s.chamber_slopes, s.size
    for i in range(size.chambers):
        node[i, col.VOLUME] = values[i, col.CHANNEL_VOLUME]
        node[i, col.VOLUME_RATE] = slopes[i, col.CHANNEL_VOLUME]
    for k in range(size.motions):
        q = state[size.position + k]
        for i in range(size.chambers):
            node[i, col.VOLUME] += values[i, col.CHANNEL_MOTION + k] * q
            node[i, col.VOLUME_RATE] += slopes[i, col.CHANNEL_MOTION + k] * q
    for i in range(size.chambers):
        volume, least = node[i, col.VOLUME], node[i, col.LEAST_VOLUME]
        share = min(max(0.5 * volume / least, 0.0), 1.0)
        node[i, col.VOLUME_SHARE] = share
        node[i, col.VOLUME] = max(volume, least * (1.0 + share * share))
        node[i, col.VOLUME_RATE] *= share


@kernel
def update_pressures(s: SystemArrays, state: Array) -> None:
    """Pressure, density, gas content and their derivatives in every dynamic node.

    The chambers, first among the states, pass in a loop without branches.
    """
    node, size, fluid, dynamic = s.node, s.size, s.fluid, s.dynamic_index
    for i in range(size.chambers):
        update_pressure(node, i, state[size.mass + i], state[size.gas + i], fluid)
        node[i, col.PRESSURE_BY_VOLUME] *= node[i, col.VOLUME_SHARE]
    for i in range(size.chambers, size.nodes):
        d = dynamic[i]
        if d < 0:
            continue
        mass, gas_mass = state[size.mass + d], state[size.gas + d]
        if node[i, col.REST_VOLUME] > 0.0:
            update_volume(node[i], mass, gas_mass / mass, fluid)
        update_pressure(node, i, mass, gas_mass, fluid)
        softer = 1.0 / (1.0 - node[i, col.WALL_SLOPE] * node[i, col.PRESSURE_BY_VOLUME])
        for column in (col.PRESSURE_BY_MASS, col.PRESSURE_BY_GAS, col.PRESSURE_BY_VOLUME):
            node[i, column] *= softer


@merged
def update_pressure(node: Array, i: int, mass: float, gas_mass: float, fluid: FluidLaw) -> None:
    """Pressure of one node at its volume, with derivatives."""
    per_mass = 1.0 / mass
    gas, specific_volume = gas_mass * per_mass, node[i, col.VOLUME] * per_mass
    p, by_volume, by_gas = mixture_pressure(specific_volume, gas, fluid)
    node[i, col.PRESSURE] = p
    node[i, col.GAS] = gas
    node[i, col.DENSITY] = 1.0 / specific_volume
    node[i, col.PRESSURE_BY_MASS] = -(by_volume * specific_volume + by_gas * gas) * per_mass
    node[i, col.PRESSURE_BY_GAS] = by_gas * per_mass
    node[i, col.PRESSURE_BY_VOLUME] = by_volume * per_mass


@kernel
def hold_pressure(s: SystemArrays, i: int, pressure: float) -> None:
    """Hold a node whose pressure is given at another one [Pa]."""
    node = s.node
    node[i, col.PRESSURE] = pressure
    node[i, col.DENSITY] = mixture_density(pressure, node[i, col.GAS], s.fluid)


@kernel
def update_enthalpies(s: SystemArrays) -> None:
    """Partial enthalpies of liquid and gas in every node, for the energy ledger."""
    node, fluid = s.node, s.fluid
    for i in range(s.size.nodes):
        liquid, gas = partial_enthalpies(node[i, col.PRESSURE], node[i, col.GAS], fluid)
        node[i, col.LIQUID_ENTHALPY] = liquid
        node[i, col.GAS_ENTHALPY] = gas


@kernel
def exchange_gas(s: SystemArrays, state: Array) -> None:
    """Release or dissolve gas in every dynamic node."""
    node, size, dynamic = s.node, s.size, s.dynamic_index
    for i in range(size.chambers):
        exchange(node, i, state[size.mass + i], s.fluid)
    for i in range(size.chambers, size.nodes):
        if dynamic[i] >= 0:
            exchange(node, i, state[size.mass + dynamic[i]], s.fluid)


@merged
def exchange(node: Array, i: int, mass: float, fluid: FluidLaw) -> None:
    """Release or dissolve gas in one node."""
    rate, by_pressure, by_gas = gas_exchange_rate(node[i, col.PRESSURE], node[i, col.GAS], fluid)
    node[i, col.GAS_RATE] += mass * rate
    node[i, col.EXCHANGE_RATE] = rate
    node[i, col.EXCHANGE_BY_PRESSURE] = by_pressure
    node[i, col.EXCHANGE_BY_GAS] = by_gas


@kernel
def gas_relaxation(s: SystemArrays, state: Array) -> float:
    """Power lost by release and absorption of gas out of equilibrium. [W]."""
    node, size, dynamic = s.node, s.size, s.dynamic_index
    loss = 0.0
    for i in range(size.nodes):
        d = dynamic[i]
        if d >= 0:
            exchanged = state[size.mass + d] * node[i, col.EXCHANGE_RATE]
            loss -= exchanged * (node[i, col.GAS_ENTHALPY] - node[i, col.LIQUID_ENTHALPY])
    return loss
