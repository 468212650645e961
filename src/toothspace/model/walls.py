r"""Volumes with compliant walls: hoses, and accumulators with a gas charge.

.. math::

    V(p) = V_0 + C p + \Delta V_g(p)

with the wall compliance C of a line and the volume :math:`\Delta V_g` by which the gas charge of
an accumulator is compressed, :func:`toothspace.closures.accumulator.gas_charge_volume`.
"""

from __future__ import annotations

from toothspace.closures.accumulator import gas_charge_energy, gas_charge_volume
from toothspace.closures.density import mixture_pressure
from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.compiled import kernel
from toothspace.core.types import Array
from toothspace.model.arrays import (
    GAS_EXPONENT,
    GAS_VOLUME,
    PRECHARGE,
    REST_VOLUME,
    VOLUME,
    WALL_COMPLIANCE,
    WALL_SLOPE,
)

ITERATIONS = 60
TOLERANCE = 1e-15


@kernel
def wall_volume(node: Array, pressure: float) -> tuple[float, float]:
    """Volume of a node at an absolute pressure [Pa] and its slope. [m3], [m3/Pa]."""
    volume = node[REST_VOLUME] + node[WALL_COMPLIANCE] * pressure
    slope = node[WALL_COMPLIANCE]
    if pressure > node[PRECHARGE] and node[GAS_VOLUME] > 0.0:
        taken, by_pressure = gas_charge_volume(
            pressure, node[GAS_VOLUME], node[PRECHARGE], node[GAS_EXPONENT]
        )
        volume += taken
        slope += by_pressure
    return volume, slope


@kernel
def update_volume(node: Array, mass: float, gas: float, fluid: FluidLaw) -> None:
    """Find the volume at which wall and content have one pressure; Newton in a bracket."""
    if node[WALL_COMPLIANCE] == 0.0 and node[GAS_VOLUME] == 0.0:
        node[VOLUME] = node[REST_VOLUME]
        return
    low = node[REST_VOLUME]
    pressure, _, _ = mixture_pressure(low / mass, gas, fluid)
    high = low + node[GAS_VOLUME] + node[WALL_COMPLIANCE] * max(pressure, 0.0)
    volume = min(max(node[VOLUME], low), high)
    for _ in range(ITERATIONS):
        pressure, by_volume, _ = mixture_pressure(volume / mass, gas, fluid)
        wall, node[WALL_SLOPE] = wall_volume(node, pressure)
        error = wall - volume
        if abs(error) <= TOLERANCE * volume:
            break
        if error > 0.0:
            low = volume
        else:
            high = volume
        volume += error / (1.0 - node[WALL_SLOPE] * by_volume / mass)
        if not low < volume < high:
            volume = 0.5 * (low + high)
    node[VOLUME] = volume


@kernel
def wall_energy(node: Array, pressure: float) -> float:
    """Energy kept in the wall and in the gas charge of a node. [J]."""
    energy = 0.5 * node[WALL_COMPLIANCE] * pressure * pressure
    if pressure > node[PRECHARGE] and node[GAS_VOLUME] > 0.0:
        energy += gas_charge_energy(pressure, node[GAS_VOLUME], node[PRECHARGE], node[GAS_EXPONENT])
    return energy
