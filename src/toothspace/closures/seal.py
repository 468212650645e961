"""Friction of shaft seals."""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.core.compiled import inlined


@inlined
def lip_seal_power_loss(
    diameter: Any, shaft_speed: Any, temperature: Any, viscosity_at_40_celsius: Any
) -> Any:
    r"""Power lost in a radial lip seal without pressure.

    Parameters
    ----------
    diameter : float or ndarray
        Shaft diameter. [m]
    shaft_speed : float or ndarray
        Angular speed, positive. [rad/s]
    temperature : float or ndarray
        Absolute temperature of the oil. [K]
    viscosity_at_40_celsius : float or ndarray
        Kinematic viscosity of the oil at 40 degC. [m2/s]

    Returns
    -------
    float or ndarray
        Power. [W]

    Notes
    -----
    .. math:: P = [145 - 1.6 T + 350 \log_{10}\log_{10}(\nu_{40} + 0.8)]\, d^2 n\, 10^{-7}

    with T in degC, viscosity in cSt, d in mm and n in rev/min. Pressure in the case or a new
    seal raise it three to five times.

    References
    ----------
    .. [1] ISO/TR 14179-2, *Gears - Thermal capacity*, 2001.

    Examples
    --------
    >>> round(float(lip_seal_power_loss(0.018, 157.08, 333.15, 46e-6)), 1)
    6.2
    """
    viscosity = np.log10(np.log10(viscosity_at_40_celsius * 1e6 + 0.8))
    level = 145.0 - 1.6 * (temperature - 273.15) + 350.0 * viscosity
    revolutions = shaft_speed * 30.0 / np.pi
    return level * (1e3 * diameter) ** 2 * revolutions * 1e-7


@inlined
def constant_seal_torque(shaft_speed: Any, level: Any, rounding_speed: Any = 0.05) -> Any:
    r"""Torque of a seal that does not depend on speed, smooth at rest.

    Parameters
    ----------
    shaft_speed : float or ndarray
        Angular speed. [rad/s]
    level : float or ndarray
        Torque in motion. [N m]
    rounding_speed : float or ndarray
        Speed over which the torque builds up: regularisation. [rad/s]

    Returns
    -------
    float or ndarray
        Torque that opposes the rotation, sign of the speed. [N m]
    """
    return level * np.tanh(shaft_speed / rounding_speed)
