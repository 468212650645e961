"""Real area of contact of rough surfaces."""

from __future__ import annotations

import numpy as np

from toothspace.closures.contact_rough import pressure_unit
from toothspace.core.types import Array

_PLASTIC_SHARE = 0.96
"""Mean pressure of plastically deformed spots over the hardness. [-]"""


def real_contact_share(
    contact_pressure: Array,
    roughness: float,
    correlation_length: float,
    effective_modulus: float,
    hardness: float,
) -> Array:
    r"""Real over nominal area of touching asperities, elastic and perfectly plastic.

    Parameters
    ----------
    contact_pressure : ndarray
        Mean contact pressure over the nominal area, zero or positive. [Pa]
    roughness : float
        Combined root mean square roughness. [m]
    correlation_length : float
        Half-height correlation length of the combined surface. [m]
    effective_modulus : float
        E' = 2 / [(1 - nu1^2)/E1 + (1 - nu2^2)/E2]. [Pa]
    hardness : float
        Hardness of the softer body. [Pa]

    Returns
    -------
    ndarray
        Share of the nominal area, at most one. [-]

    Notes
    -----
    With :math:`P = 2 l_{50} p / (\pi E' \sigma)`, :math:`H_Y = 2 l_{50} H / (\pi E' \sigma)`, a fit
    to the boundary element solutions from which the law of the asperity pressure is:

    .. math:: A_r/A = P / \min(0.2346 - 0.197 \sqrt{P} + 0.895 P,\; 0.96\, H_Y)

    Validity: P up to 0.16.

    References
    ----------
    .. [1] H. M. Stanley, T. Kato, "An FFT-based method for rough surface contact", J. Tribology
       119, 1997, 481-485 (method of the solutions; the fit is this package's own).
    """
    unit = pressure_unit(roughness, correlation_length, effective_modulus)
    load = np.asarray(contact_pressure) / unit
    elastic = 0.2346 - 0.197 * np.sqrt(load) + 0.895 * load
    spots = np.minimum(elastic, _PLASTIC_SHARE * hardness / unit)
    return np.asarray(np.minimum(load / spots, 1.0))
