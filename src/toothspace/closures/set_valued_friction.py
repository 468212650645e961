r"""Dry friction with a true state of rest.

.. math::

    M = M_k\,\mathrm{sign}(\omega) \ (\omega \ne 0), \qquad
    M = M_a \ (\omega = 0,\ |M_a| \le M_s)

with kinetic friction :math:`M_k`, static friction :math:`M_s` and the torque :math:`M_a` that
would drive the joint if it were free. A joint is in one of three states: sliding forward,
sliding backward, or stuck.
"""

from __future__ import annotations

import math

FORWARD, STUCK, BACKWARD = 1.0, 0.0, -1.0


def next_direction(speed: float, applied: float, holding: float) -> float:
    r"""State that a joint takes at a speed under an applied torque.

    Parameters
    ----------
    speed : float
        Relative speed; exactly zero where the joint has come to rest. [rad/s]
    applied : float
        Torque on the joint without its friction. [N m]
    holding : float
        Largest friction at rest. [N m]

    Returns
    -------
    float
        +1 sliding forward, -1 sliding backward, 0 stuck. [-]

    Notes
    -----
    .. math:: d = \mathrm{sign}\,\omega \ (\omega \ne 0), \qquad
        d = 0 \ (\omega = 0,\ |M_a| \le M_s), \qquad
        d = \mathrm{sign}\,M_a \ (\omega = 0,\ |M_a| > M_s)

    Validity: dry friction of one joint; the time at which the speed reaches zero must be found.

    References
    ----------
    .. [1] D. Karnopp, "Computer simulation of stick-slip friction in mechanical dynamic
       systems", J. Dyn. Syst. Meas. Control 107, 1985, 100-103.

    Examples
    --------
    >>> next_direction(0.0, 0.9, 1.0)
    0.0
    >>> next_direction(0.0, -1.1, 1.0)
    -1.0
    """
    if speed != 0.0:
        return math.copysign(1.0, speed)
    if abs(applied) <= holding and holding > 0.0:
        return STUCK
    return math.copysign(1.0, applied)
