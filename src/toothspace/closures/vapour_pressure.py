"""Vapour pressure over temperature."""

from __future__ import annotations

from typing import Any

import numpy as np


def clausius_clapeyron_pressure(
    temperature: Any,
    reference_pressure: Any,
    reference_temperature: Any,
    evaporation_temperature: Any,
) -> Any:
    r"""Vapour pressure of a liquid with constant heat of evaporation.

    Parameters
    ----------
    temperature : float or ndarray
        Absolute temperature. [K]
    reference_pressure : float or ndarray
        Vapour pressure at the reference temperature. [Pa]
    reference_temperature : float or ndarray
        Absolute temperature at which the vapour pressure is known. [K]
    evaporation_temperature : float or ndarray
        Heat of evaporation over specific gas constant of the vapour. [K]

    Returns
    -------
    float or ndarray
        Absolute vapour pressure. [Pa]

    Notes
    -----
    .. math:: p_v = p_r \exp\left[-T_e \left(\frac{1}{T} - \frac{1}{T_r}\right)\right]

    Validity: far below the critical temperature, some tens of kelvin about the reference.

    References
    ----------
    .. [1] M. J. Moran, H. N. Shapiro, *Fundamentals of Engineering Thermodynamics*, Wiley,
       chapter 11 (textbook law: Clausius and Clapeyron).
    """
    inverse = 1.0 / temperature - 1.0 / reference_temperature
    return reference_pressure * np.exp(-evaporation_temperature * inverse)
