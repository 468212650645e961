r"""Gas content of the fluid that waits in the inlet volume.

The inlet volume is well mixed and held at the inlet pressure. Feed arrives as it left a tank
at the saturation pressure; in the volume it releases or dissolves gas for the time that it
stays. The steady balance of free gas is

.. math:: f_{feed} - f + \tau\, \dot f_{exchange}(p, f) = 0, \qquad
    \tau = \frac{\rho V}{\dot m} .

Below atmospheric inlet pressure released air takes up room in the tooth spaces: the pump
starves.
"""

from __future__ import annotations

from toothspace.closures.aeration import gas_exchange_rate
from toothspace.closures.fluid_law import FluidLaw
from toothspace.numerics.roots import root_between

_TOLERANCE = 1e-14


def inlet_gas_fraction(pressure: float, residence_time: float, law: FluidLaw) -> float:
    """Mass fraction of free gas of the fluid that enters the machine.

    Parameters
    ----------
    pressure : float
        Absolute pressure of the inlet volume, above the vapour pressure. [Pa]
    residence_time : float
        Inlet volume over volume flow rate, positive. [s]
    law : FluidLaw
        Constants of the fluid. [SI]

    Returns
    -------
    float
        Mass of free gas per mass of mixture, between zero and the total gas content. [-]
    """
    feed = law.feed_gas_mass_fraction

    def excess(gas: float) -> float:
        return feed - gas + residence_time * float(gas_exchange_rate(pressure, gas, law)[0])

    highest = 1.1 * law.total_gas_mass_fraction + law.nuclei_mass_fraction
    if excess(0.0) <= 0.0 or excess(highest) >= 0.0:
        return feed
    return root_between(excess, 0.0, highest, _TOLERANCE * highest)
