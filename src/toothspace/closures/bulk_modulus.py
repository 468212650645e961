"""Stiffness of the liquid."""

from __future__ import annotations

from typing import Any

from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.compiled import inlined


@inlined
def liquid_bulk_modulus(pressure: Any, law: FluidLaw) -> Any:
    r"""Bulk modulus of the liquid without gas.

    Parameters
    ----------
    pressure : float or ndarray
        Absolute pressure. [Pa]
    law : FluidLaw
        Constants of the fluid. [SI]

    Returns
    -------
    float or ndarray
        Bulk modulus. [Pa]

    Notes
    -----
    .. math:: K = (1 + b p) [1 + (a + b) p] / a

    the derivative of :func:`toothspace.closures.density.liquid_specific_volume`. Validity: 0 to
    100 MPa, isothermal.

    References
    ----------
    .. [1] H. E. Merritt, *Hydraulic Control Systems*, Wiley, 1967, chapter 2 (textbook law:
       definition of the bulk modulus).
    """
    a, b, p = law.compliance, law.stiffening, pressure
    return (1.0 + b * p) * (1.0 + (a + b) * p) / a
