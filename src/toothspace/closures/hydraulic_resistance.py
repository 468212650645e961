"""Resistances of a circuit with their derivatives: throttle, cooler or line, pressure valve."""

from __future__ import annotations

import math

from toothspace.core.compiled import inlined

ROUNDING = 1e3
"""Pressure drop below which the flow of a throttle becomes linear: regularisation. [Pa]"""


@inlined
def throttle_flow(
    pressure_drop: float, discharge_area: float, density: float
) -> tuple[float, float]:
    r"""Flow rate through a throttle, linear at small drops.

    Parameters
    ----------
    pressure_drop : float
        Upstream minus downstream pressure. [Pa]
    discharge_area : float
        Discharge coefficient times area. [m2]
    density : float
        Density of the fluid that enters. [kg/m3]

    Returns
    -------
    flow_rate : float
        Volumetric flow rate, positive towards downstream. [m3/s]
    by_pressure : float
        Its derivative by the pressure drop. [m3/(s Pa)]

    Notes
    -----
    .. math:: Q = A_d \sqrt{\frac{2}{\rho}}
        \frac{\Delta p}{(\Delta p^2 + p_{cr}^2)^{1/4}}

    with :data:`ROUNDING` for the critical pressure. Validity: turbulent flow, drops above a few
    kilopascal.

    References
    ----------
    .. [1] MathWorks, Simscape Fluids reference, *Orifice*.
    """
    scale = discharge_area * math.sqrt(2.0 / density)
    square = pressure_drop * pressure_drop + ROUNDING * ROUNDING
    root = math.sqrt(math.sqrt(square))
    slope = scale * (1.0 - 0.5 * pressure_drop * pressure_drop / square) / root
    return scale * pressure_drop / root, slope


@inlined
def resistance_flow(
    pressure_drop: float, linear_resistance: float, square_resistance: float
) -> tuple[float, float]:
    r"""Flow rate through a resistance of which the laminar and the turbulent part are known.

    Parameters
    ----------
    pressure_drop : float
        Upstream minus downstream pressure. [Pa]
    linear_resistance : float
        Pressure drop per flow rate of the laminar part. [Pa s/m3]
    square_resistance : float
        Pressure drop per square of the flow rate of the turbulent part. [Pa s2/m6]

    Returns
    -------
    flow_rate : float
        Volumetric flow rate, positive towards downstream. [m3/s]
    by_pressure : float
        Its derivative by the pressure drop. [m3/(s Pa)]

    Notes
    -----
    .. math:: \Delta p = R_1 Q + R_2\, Q |Q|

    solved for Q without cancellation. Validity: coolers, filters and short lines whose
    characteristic is measured or given; one of the resistances above zero.

    References
    ----------
    .. [1] H. E. Merritt, *Hydraulic Control Systems*, Wiley, 1967, chapter 3 (textbook law).
    """
    linear, square = linear_resistance, square_resistance
    root = math.sqrt(linear * linear + 4.0 * square * abs(pressure_drop))
    flow = 2.0 * pressure_drop / (linear + root)
    return flow, 1.0 / (linear + 2.0 * square * abs(flow))


@inlined
def valve_flow(
    pressure_drop: float, opening_pressure: float, gradient: float, rounding: float
) -> tuple[float, float]:
    r"""Flow rate of a relief or check valve by its static characteristic.

    Parameters
    ----------
    pressure_drop : float
        Upstream minus downstream pressure. [Pa]
    opening_pressure : float
        Drop at which the valve opens. [Pa]
    gradient : float
        Rise of the drop per flow rate, valve open. [Pa s/m3]
    rounding : float
        Range of the drop over which the slope rises from zero: regularisation. [Pa]

    Returns
    -------
    flow_rate : float
        Volumetric flow rate, zero up to the opening pressure. [m3/s]
    by_pressure : float
        Its derivative by the pressure drop. [m3/(s Pa)]

    Notes
    -----
    With the excess :math:`x = \Delta p - p_o` and the rounding w,

    .. math:: Q = \frac{x^2}{2 w k} \ (0 < x < w), \qquad Q = \frac{x - w/2}{k} \ (x \ge w) .

    Validity: slow changes; the mass of the valve and the force of its flow are in the gradient.

    References
    ----------
    .. [1] H. E. Merritt, *Hydraulic Control Systems*, Wiley, 1967, chapter 9 (textbook law:
       pressure control valves).
    """
    excess = pressure_drop - opening_pressure
    if excess <= 0.0:
        return 0.0, 0.0
    if excess < rounding:
        return 0.5 * excess * excess / (rounding * gradient), excess / (rounding * gradient)
    return (excess - 0.5 * rounding) / gradient, 1.0 / gradient
