"""Gas charge of an accumulator: volume that it gives free, and energy that it keeps."""

from __future__ import annotations

from toothspace.core.compiled import inlined


@inlined
def gas_charge_volume(
    pressure: float, gas_volume: float, precharge: float, polytropic_exponent: float
) -> tuple[float, float]:
    r"""Volume of liquid that the gas charge of an accumulator makes room for.

    Parameters
    ----------
    pressure : float
        Absolute pressure, above the precharge. [Pa]
    gas_volume : float
        Volume of the gas at the precharge. [m3]
    precharge : float
        Absolute pressure of the gas with no liquid in the accumulator. [Pa]
    polytropic_exponent : float
        1 isothermal, 1.4 adiabatic. [-]

    Returns
    -------
    volume : float
        Volume of the liquid. [m3]
    by_pressure : float
        Its derivative. [m3/Pa]

    Notes
    -----
    .. math:: V = V_g \left[1 - (p_0/p)^{1/n}\right]

    Validity: ideal gas, quasi-static change of state, no friction of the separator.

    References
    ----------
    .. [1] M. J. Moran, H. N. Shapiro, *Fundamentals of Engineering Thermodynamics*, Wiley,
       chapter 3 (textbook law: polytropic process of an ideal gas).
    """
    power = 1.0 / polytropic_exponent
    gas = gas_volume * (precharge / pressure) ** power
    return gas_volume - gas, power * gas / pressure


@inlined
def gas_charge_energy(
    pressure: float, gas_volume: float, precharge: float, polytropic_exponent: float
) -> float:
    r"""Energy that the gas charge of an accumulator has taken up from its precharge on.

    Parameters
    ----------
    pressure : float
        Absolute pressure, above the precharge. [Pa]
    gas_volume : float
        Volume of the gas at the precharge. [m3]
    precharge : float
        Absolute pressure of the gas with no liquid in the accumulator. [Pa]
    polytropic_exponent : float
        Above 1; 1.4 adiabatic. [-]

    Returns
    -------
    float
        Energy. [J]

    Notes
    -----
    .. math:: E = \frac{p_0 V_g}{n - 1} \left[(p/p_0)^{1 - 1/n} - 1\right]

    the work :math:`\int p\,\mathrm dV` on :func:`gas_charge_volume`. Validity: as there.

    References
    ----------
    .. [1] M. J. Moran, H. N. Shapiro, *Fundamentals of Engineering Thermodynamics*, Wiley,
       chapter 3 (textbook law: polytropic process of an ideal gas).
    """
    power = 1.0 - 1.0 / polytropic_exponent
    ratio = pressure / precharge
    scale = gas_volume * precharge / (polytropic_exponent - 1.0)
    return scale * (ratio**power - 1.0)
