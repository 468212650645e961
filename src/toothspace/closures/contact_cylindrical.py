"""Pressure and force of contacts between cylinders (teeth, rotors).

Moduli are E* = 1 / [(1 - nu1^2)/E1 + (1 - nu2^2)/E2], half of the E' of traction.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.closures.smooth import select
from toothspace.core.compiled import inlined

_INTERNAL_RANGE = (0.005e-3, 10e-3)
"""Radius differences for which the internal law of Pereira was fitted. [m]"""


@inlined
def hertz_pressure(line_load: Any, relative_radius: Any, contact_modulus: Any) -> Any:
    r"""Largest pressure of a Hertz line contact.

    Parameters
    ----------
    line_load : float or ndarray
        Normal force per length. [N/m]
    relative_radius : float or ndarray
        1 / (1/R1 + 1/R2), concave radii negative. [m]
    contact_modulus : float or ndarray
        E*. [Pa]

    Returns
    -------
    float or ndarray
        Pressure. [Pa]

    Notes
    -----
    .. math:: p_0 = \sqrt{q E^* / (\pi R)}

    Validity: elastic, smooth, dry bodies; contact narrow against the radii.

    References
    ----------
    .. [1] K. L. Johnson, *Contact Mechanics*, Cambridge, 1985, section 4.2 (textbook law).
    """
    return np.sqrt(line_load * contact_modulus / (np.pi * relative_radius))


@inlined
def pereira_force(
    indentation: Any, radius_difference: Any, length: Any, contact_modulus: Any, internal: bool
) -> Any:
    r"""Normal force of a cylindrical contact by the enhanced law of Pereira et al.

    Parameters
    ----------
    indentation : float or ndarray
        Indentation; zero or negative is no contact. [m]
    radius_difference : float or ndarray
        R1 + R2 for external contact, R1 - R2 for internal contact. [m]
    length : float or ndarray
        Length of the contact line. [m]
    contact_modulus : float or ndarray
        E*. [Pa]
    internal : bool
        Whether a convex body lies in a concave one. [-]

    Returns
    -------
    float or ndarray
        Normal force. [N]

    Notes
    -----
    .. math:: F = \frac{(a \Delta R + b) L E^*}{\Delta R}\, \delta^n

    The constants hold in mm, N and N/mm2; conversion is done here. Internal: a = 0.965,
    b = 0.0965 mm, n = Y dR^-0.005 with Y = 1.51 [ln(1000 dR)]^-0.151 below 0.75 mm and
    Y = 0.0151 dR + 1.151 above. External: a = 0.39, b = 0.85 mm, n = 1.094.
    Validity: :func:`in_pereira_range`.

    References
    ----------
    .. [1] C. Pereira, A. Ramalho, J. Ambrosio, "A critical overview of internal and external
       cylinder contact force models", Nonlinear Dynamics 63, 2011, 681-697.
    """
    difference = 1e3 * radius_difference
    depth = 1e3 * np.maximum(indentation, 0.0)
    if internal:
        small = 1.51 * np.log(1000.0 * np.minimum(difference, 0.75)) ** -0.151
        large = 0.0151 * difference + 1.151
        rises = select(difference < 0.75, 1.0, 0.0)
        exponent = (rises * small + (1.0 - rises) * large) * difference**-0.005
        stiffness = 0.965 * difference + 0.0965
    else:
        exponent = 1.094 + 0.0 * difference
        stiffness = 0.39 * difference + 0.85
    return stiffness / difference * (1e3 * length) * (1e-6 * contact_modulus) * depth**exponent


def in_pereira_range(radius_difference: float, internal: bool) -> bool:
    r"""Tell whether Pereira's law was fitted for a pair of radii.

    Parameters
    ----------
    radius_difference : float
        R1 + R2 for external contact, R1 - R2 for internal contact. [m]
    internal : bool
        Whether a convex body lies in a concave one. [-]

    Returns
    -------
    bool
        Whether the law may be used. [-]

    Notes
    -----
    .. math:: 0.005\,\mathrm{mm} \le \Delta R \le 10\,\mathrm{mm} \ \text{(internal)}, \qquad
        \Delta R > 0 \ \text{(external)}

    Validity: the range for which :func:`pereira_force` was fitted.

    References
    ----------
    .. [1] C. Pereira, A. Ramalho, J. Ambrosio, "A critical overview of internal and external
       cylinder contact force models", Nonlinear Dynamics 63, 2011, 681-697.
    """
    low, high = _INTERNAL_RANGE if internal else (1e-9, np.inf)
    return low <= radius_difference <= high
