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
from toothspace.model import arrays as col

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
