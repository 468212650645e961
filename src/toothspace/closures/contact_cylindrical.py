"""Force, pressure and damping of contacts between cylinders (teeth, rotors).

Moduli are E* = 1 / [(1 - nu1^2)/E1 + (1 - nu2^2)/E2], half of the E' of traction.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.closures.smooth import select
from toothspace.core.compiled import inlined
from toothspace.core.errors import CaseError

ISO_MESH_STIFFNESS = 14e9
"""Stiffness of one steel spur tooth pair per face width, ISO 6336-1 order. [N/m2]"""

_INTERNAL_RANGE = (0.005e-3, 10e-3)
"""Radius differences for which the internal law of Pereira was fitted. [m]"""


@inlined
def hertz_half_width(line_load: Any, relative_radius: Any, contact_modulus: Any) -> Any:
    r"""Half width of a Hertz line contact.

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
        Half width. [m]

    Notes
    -----
    .. math:: b = \sqrt{4 q R / (\pi E^*)}
    """
    return np.sqrt(4.0 * line_load * relative_radius / (np.pi * contact_modulus))


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
    """
    return np.sqrt(line_load * contact_modulus / (np.pi * relative_radius))


@inlined
def hertz_indentation(line_load: Any, radius_a: Any, radius_b: Any, contact_modulus: Any) -> Any:
    r"""Approach of the axes of two cylinders in line contact.

    Parameters
    ----------
    line_load : float or ndarray
        Normal force per length, positive. [N/m]
    radius_a : float or ndarray
        Radius of one cylinder. [m]
    radius_b : float or ndarray
        Radius of the other, negative if concave. [m]
    contact_modulus : float or ndarray
        E*, shared equally by both bodies. [Pa]

    Returns
    -------
    float or ndarray
        Approach of points as deep below the surface as the radii. [m]

    Notes
    -----
    .. math:: \delta = \frac{q}{\pi E^*}
        \left[\ln\frac{4 R_1}{b} + \ln\frac{4 |R_2|}{b} - 1\right]

    with the half width b of :func:`hertz_half_width`.

    References
    ----------
    .. [1] K. L. Johnson, *Contact Mechanics*, Cambridge, 1985, section 5.6.
    """
    relative = radius_a * radius_b / (radius_a + radius_b)
    width = hertz_half_width(line_load, relative, contact_modulus)
    depth = np.log(16.0 * np.abs(radius_a * radius_b) / (width * width))
    return line_load / (np.pi * contact_modulus) * (depth - 1.0)


@inlined
def johnson_indentation(line_load: Any, radius_difference: Any, contact_modulus: Any) -> Any:
    r"""Indentation of a line contact of cylinders by Johnson.

    Parameters
    ----------
    line_load : float or ndarray
        Normal force per length, positive. [N/m]
    radius_difference : float or ndarray
        R1 + R2 for external contact, R1 - R2 for internal contact. [m]
    contact_modulus : float or ndarray
        E*. [Pa]

    Returns
    -------
    float or ndarray
        Indentation. [m]

    Notes
    -----
    .. math:: \delta = \frac{q}{\pi E^*}
        \left[\ln\frac{4 \pi E^* \Delta R}{q} - 1\right]

    Validity: it grows with the load only for :math:`q < 4 \pi E^* \Delta R / e^2`.

    References
    ----------
    .. [1] K. L. Johnson, *Contact Mechanics*, Cambridge, 1985.
    """
    scale = np.pi * contact_modulus
    return line_load / scale * (np.log(4.0 * scale * radius_difference / line_load) - 1.0)


@inlined
def johnson_line_load(indentation: Any, radius_difference: Any, contact_modulus: Any) -> Any:
    r"""Normal force per length of a line contact by Johnson, inverse of the indentation.

    Parameters
    ----------
    indentation : float or ndarray
        Indentation; zero or negative is no contact. [m]
    radius_difference : float or ndarray
        R1 + R2 for external contact, R1 - R2 for internal contact. [m]
    contact_modulus : float or ndarray
        E*. [Pa]

    Returns
    -------
    float or ndarray
        Normal force per length. [N/m]

    Notes
    -----
    Newton's iteration for :math:`x (\ln(1/x) - 1) = \delta / (4 \Delta R)` with
    :math:`x = q / (4 \pi E^* \Delta R)`, started below the root where it converges from one
    side. Validity: indentation below a tenth of the radius difference.
    """
    target = np.minimum(np.maximum(indentation / (4.0 * radius_difference), 1e-300), 0.025)
    x = target / (1.0 - np.log(target))
    for _ in range(8):
        logarithm = np.log(x)
        x = x - (x * (-logarithm - 1.0) - target) / (-logarithm - 2.0)
    force = 4.0 * np.pi * contact_modulus * radius_difference * x
    return select(indentation > 0.0, force, 0.0 * force)


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
    Validity: :func:`check_pereira_range`.

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


def check_pereira_range(radius_difference: float, internal: bool) -> None:
    """Refuse radius differences outside the range of the internal law of Pereira.

    Parameters
    ----------
    radius_difference : float
        R1 + R2 for external contact, R1 - R2 for internal contact. [m]
    internal : bool
        Whether a convex body lies in a concave one. [-]

    Returns
    -------
    None
        Nothing; the range is 0.005 to 10 mm for internal contact. [-]

    Raises
    ------
    CaseError
        If the law must not be used.
    """
    low, high = _INTERNAL_RANGE if internal else (0.0, np.inf)
    if not low <= radius_difference <= high or radius_difference <= 0.0:
        allowed = f"allowed {1e3 * low:g} to {1e3 * high:g} mm; use johnson or hertz"
        found = f"found pereira with a radius difference of {1e3 * radius_difference:g} mm"
        raise CaseError(f"contact.law: {found}, {allowed}")


@inlined
def impact_damping_factor(
    indentation_rate: Any, approach_speed: Any, restitution: Any, smallest_speed: Any = 1e-4
) -> Any:
    r"""Factor on the elastic contact force for the energy lost in an impact.

    Parameters
    ----------
    indentation_rate : float or ndarray
        Rate of indentation, positive while approaching. [m/s]
    approach_speed : float or ndarray
        Rate of indentation at first touch. [m/s]
    restitution : float or ndarray
        Coefficient of restitution, 0.7 to 1. [-]
    smallest_speed : float or ndarray
        Lower limit of the approach speed in the quotient. [m/s]

    Returns
    -------
    float or ndarray
        Factor, zero or positive so that the contact never pulls. [-]

    Notes
    -----
    .. math:: 1 + \tfrac34 (1 - c_r^2)\, \dot\delta / \dot\delta^{(-)}

    References
    ----------
    .. [1] H. M. Lankarani, P. E. Nikravesh, "A contact force model with hysteresis damping for
       impact analysis of multibody systems", J. Mechanical Design 112, 1990, 369-376.
    """
    approach = np.maximum(np.abs(approach_speed), smallest_speed)
    loss = 0.75 * (1.0 - restitution * restitution) * indentation_rate / approach
    return np.maximum(1.0 + loss, 0.0)
