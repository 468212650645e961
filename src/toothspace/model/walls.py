r"""Volumes with walls that yield: hoses, and accumulators with a gas charge.

.. math::

    V(p) = V_0 + C p + V_g \left[1 - (p_0/p)^{1/n}\right]_{p > p_0}

with the wall compliance C of a line and the gas volume :math:`V_g` of an accumulator, charged
to :math:`p_0`, whose gas follows the polytropic exponent n.
"""

from __future__ import annotations

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
        power = 1.0 / node[GAS_EXPONENT]
        gas = node[GAS_VOLUME] * (node[PRECHARGE] / pressure) ** power
        volume += node[GAS_VOLUME] - gas
        slope += power * gas / pressure
    return volume, slope


@kernel
def widen(node: Array, mass: float, gas: float, fluid: FluidLaw) -> None:
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
        power = 1.0 - 1.0 / node[GAS_EXPONENT]
        ratio = pressure / node[PRECHARGE]
        scale = node[GAS_VOLUME] * node[PRECHARGE] / (node[GAS_EXPONENT] - 1.0)
        energy += scale * (ratio**power - 1.0)
    return energy
