"""Wear of sliding surfaces: Archard's law with break-in."""

from __future__ import annotations

import math

from toothspace.core.types import FloatOrArray


def wear_depth_rate(
    wear_coefficient: float, contact_pressure: FloatOrArray, sliding_speed: FloatOrArray
) -> FloatOrArray:
    r"""Depth that a sliding contact loses per time, after Archard.

    Parameters
    ----------
    wear_coefficient : float
        Worn volume over load and sliding distance, Archard's number over hardness. [m3/(N m)]
    contact_pressure : float or ndarray
        Pressure that the contact carries. [Pa]
    sliding_speed : float or ndarray
        Speed of the surfaces against each other, positive. [m/s]

    Returns
    -------
    float or ndarray
        Rate of depth. [m/s]

    Notes
    -----
    .. math:: \dot h = k\, p\, v, \qquad k = \frac{K}{H}

    so that the worn volume is k times the work of friction over the friction coefficient.

    Validity: mild wear at one k; lubrication, dirt and materials are all in k.

    References
    ----------
    .. [1] J. F. Archard, Contact and rubbing of flat surfaces, J. Appl. Phys. 24 (1953) 981-988.

    Examples
    --------
    A bush at 5 MPa and 1.4 m/s with 1e-18 m3/(N m), per 1000 h:

    >>> round(wear_depth_rate(1e-18, 5e6, 1.4) * 3.6e6 * 1e6, 1)  # um
    25.2
    """
    return wear_coefficient * contact_pressure * sliding_speed


def worn_time(time: float, break_in_factor: float, break_in_time: float) -> float:
    r"""Time at the steady rate of wear that wears as much as a time from new, break-in included.

    Parameters
    ----------
    time : float
        Time in service since new. [s]
    break_in_factor : float
        Rate of wear of new surfaces over the steady one. [-]
    break_in_time : float
        Time after which the excess has fallen to 1/e. [s]

    Returns
    -------
    float
        Time at the steady rate. [s]

    Notes
    -----
    A rate that falls from :math:`B \dot h` to :math:`\dot h` as :math:`\mathrm{e}^{-t/\tau}`:

    .. math:: \int_0^t 1 + (B - 1)\,\mathrm{e}^{-t/\tau}\,\mathrm{d}t
        = t + (B - 1)\,\tau\,(1 - \mathrm{e}^{-t/\tau})

    Validity: the form of the decay is an assumption of ours, not measured.

    References
    ----------
    .. [1] J. F. Archard, Contact and rubbing of flat surfaces, J. Appl. Phys. 24 (1953) 981-988,
       for the steady rate.

    Examples
    --------
    >>> worn_time(3600.0, 1.0, 600.0)
    3600.0
    """
    return time - (break_in_factor - 1.0) * break_in_time * math.expm1(-time / break_in_time)


def cutting_time(
    wear_coefficient: float,
    bearing_stiffness: float,
    radius: float,
    width: float,
    sliding_speed: float,
) -> float:
    r"""Time in which tips of a rotor that presses into its bore cut away most of the overlap.

    Parameters
    ----------
    wear_coefficient : float
        Of the bore. [m3/(N m)]
    bearing_stiffness : float
        Force with which the bearings push the rotor into the bore, per overlap. [N/m]
    radius : float
        Radius of the bore. [m]
    width : float
        Width of the tips along the axis. [m]
    sliding_speed : float
        Speed of the tips. [m/s]

    Returns
    -------
    float
        Time constant with which the overlap fades, infinite without wear. [s]

    Notes
    -----
    A shift x of the rotor overlaps with the bore by :math:`x \cos\theta` over half a turn. A
    pressure in proportion to the overlap, in balance with the force K x of the bearings, and
    :func:`wear_depth_rate` give

    .. math:: p = \frac{2 K}{\pi R b} x \cos\theta, \qquad
        \tau = \frac{\pi R b}{2\, k\, K v}

    Validity: tips that pass much more often than once in that time; bearings as stiff springs.

    References
    ----------
    .. [1] J. F. Archard, Contact and rubbing of flat surfaces, J. Appl. Phys. 24 (1953) 981-988,
       for the rate of depth.

    Examples
    --------
    Half a minute, where bushes wear in hours: the bore is worn to where the tips are:

    >>> round(cutting_time(1e-15, 2e9, 20e-3, 7.6e-3, 3.2), 1)
    37.3
    """
    if wear_coefficient == 0.0:
        return math.inf
    rate = 2.0 * wear_coefficient * bearing_stiffness * sliding_speed
    return math.pi * radius * width / rate
