r"""Friction at start, where it fades into that of running, and with a true state of rest.

.. math::

    M = M_k\,\mathrm{sign}(\omega) \ (\omega \ne 0), \qquad
    M = M_a \ (\omega = 0,\ |M_a| \le M_s)

with kinetic friction :math:`M_k`, static friction :math:`M_s` and the torque :math:`M_a` that
would drive the joint if it were free. A joint is in one of three states: sliding forward,
sliding backward, or stuck.
"""

from __future__ import annotations

import math
from collections.abc import Callable
from typing import Any

import numpy as np

from toothspace.core.compiled import inlined

_ROOT_TWO = np.sqrt(2.0)
_ROOT_TWO_E = np.sqrt(2.0 * np.e)


@inlined
def stribeck_hump(speed: Any, breakaway_speed: Any) -> tuple[Any, Any]:
    r"""Part of the breakaway friction beyond Coulomb friction that is present at a speed.

    Parameters
    ----------
    speed : float or ndarray
        Sliding speed, or angular speed. [m/s]
    breakaway_speed : float or ndarray
        Speed of the largest friction. [m/s]

    Returns
    -------
    hump : float or ndarray
        Share, odd in the speed, 1 at the breakaway speed. [-]
    by_speed : float or ndarray
        Its derivative. [s/m]

    Notes
    -----
    .. math:: g(v) = \sqrt{2e}\; e^{-(v/v_{st})^2} \frac{v}{v_{st}}, \qquad
        v_{st} = \sqrt2\, v_{brk}

    Validity: an empirical law of mixed lubrication that fades above a few breakaway speeds.

    References
    ----------
    .. [1] MathWorks, Simscape reference, *Translational Friction*.
    .. [2] B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, "A survey of models, analysis
       tools and compensation methods for the control of machines with friction", Automatica 30,
       1994, 1083-1138.
    """
    stribeck_speed = _ROOT_TWO * breakaway_speed
    ratio = speed / stribeck_speed
    bell = _ROOT_TWO_E * np.exp(-ratio * ratio)
    return bell * ratio, bell * (1.0 - 2.0 * ratio * ratio) / stribeck_speed


@inlined
def stribeck_friction(
    speed: Any, breakaway: Any, coulomb: Any, breakaway_speed: Any
) -> tuple[Any, Any]:
    r"""Friction force or torque over speed, from breakaway to sliding.

    Parameters
    ----------
    speed : float or ndarray
        Sliding speed, or angular speed. [m/s]
    breakaway : float or ndarray
        Largest friction, at the breakaway speed. [N]
    coulomb : float or ndarray
        Friction that stays at higher speed. [N]
    breakaway_speed : float or ndarray
        Speed of the largest friction. [m/s]

    Returns
    -------
    friction : float or ndarray
        Friction with the sign of the speed (it opposes motion). [N]
    by_speed : float or ndarray
        Its derivative. [N s/m]

    Notes
    -----
    .. math:: F = (F_{brk} - F_c)\, g(v) + F_c \tanh\frac{10\, v}{v_{brk}}

    with the share g of :func:`stribeck_hump`; odd, and equal to the breakaway value at the
    breakaway speed. The same law holds for torques, with N m for N and rad/s for m/s.
    Validity: it vanishes at rest and creeps under a static load; where a body must hold still,
    use set-valued friction.

    References
    ----------
    .. [1] MathWorks, Simscape reference, *Translational Friction*.

    Examples
    --------
    >>> round(float(stribeck_friction(6e-3, 250.0, 100.0, 6e-3)[0]), 3)
    250.0
    """
    hump, hump_slope = stribeck_hump(speed, breakaway_speed)
    level = np.tanh(10.0 * speed / breakaway_speed)
    slope = (breakaway - coulomb) * hump_slope
    slope += coulomb * (1.0 - level * level) * 10.0 / breakaway_speed
    return (breakaway - coulomb) * hump + coulomb * level, slope


SMOOTH_LAWS: dict[str, Callable[..., tuple[Any, Any]]] = {"stribeck": stribeck_friction}
"""Friction that a case may choose in place of the set-valued one, with the arguments of
:func:`stribeck_friction`."""


@inlined
def running_share(speed: Any, breakaway_speed: Any) -> Any:
    r"""Share of the speed-dependent friction terms that is present near standstill.

    Parameters
    ----------
    speed : float or ndarray
        Angular speed. [rad/s]
    breakaway_speed : float or ndarray
        Speed of the largest friction at start. [rad/s]

    Returns
    -------
    float or ndarray
        Share, 0 at rest and 1 in running. [-]

    Notes
    -----
    .. math:: 1 - \exp[-(\omega/\omega_{st})^2], \qquad \omega_{st} = \sqrt2\, \omega_{brk}

    the complement of the bell of :func:`stribeck_hump`. Validity: a blend, where one breakaway
    torque stands for all interfaces at rest, so that none counts twice.

    References
    ----------
    .. [1] B. Armstrong-Helouvry, P. Dupont, C. Canudas de Wit, "A survey of models, analysis
       tools and compensation methods for the control of machines with friction", Automatica 30,
       1994, 1083-1138 (the bell of the Stribeck curve).
    """
    ratio = speed / (_ROOT_TWO * breakaway_speed)
    return -np.expm1(-ratio * ratio)


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
