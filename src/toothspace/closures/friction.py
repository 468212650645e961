"""Friction at start, shear at tooth tips and at the faces of gears."""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.core.compiled import inlined


@inlined
def stribeck_friction(
    speed: Any, breakaway: Any, coulomb: Any, breakaway_speed: Any, viscous: Any = 0.0
) -> Any:
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
    viscous : float or ndarray
        Coefficient of viscous friction. [N s/m]

    Returns
    -------
    float or ndarray
        Friction with the sign of the speed (it opposes motion). [N]

    Notes
    -----
    .. math:: F = \sqrt{2e}\,(F_{brk} - F_c)\, e^{-(v/v_{st})^2} \frac{v}{v_{st}}
        + F_c \tanh\frac{v}{v_{coul}} + f v

    with :math:`v_{st} = \sqrt2\, v_{brk}` and :math:`v_{coul} = v_{brk}/10`; odd, and equal
    to the breakaway value at the breakaway speed. It creeps under a static load: where a
    body must hold still, use a set-valued stick element instead. The same law holds for
    torques, with N m for N and rad/s for m/s.

    References
    ----------
    .. [1] MathWorks, Simscape reference, *Translational Friction*.
    """
    ratio = speed / (np.sqrt(2.0) * breakaway_speed)
    hump = np.sqrt(2.0 * np.e) * (breakaway - coulomb) * np.exp(-ratio * ratio) * ratio
    return hump + coulomb * np.tanh(10.0 * speed / breakaway_speed) + viscous * speed


@inlined
def running_share(shaft_speed: Any, stribeck_speed: Any) -> Any:
    r"""Share of the speed-dependent friction terms that is present near standstill.

    Parameters
    ----------
    shaft_speed : float or ndarray
        Angular speed. [rad/s]
    stribeck_speed : float or ndarray
        Square root of two times the breakaway speed. [rad/s]

    Returns
    -------
    float or ndarray
        Share, 0 at rest and 1 in running. [-]

    Notes
    -----
    .. math:: 1 - \exp[-(\omega/\omega_{st})^2]

    Used where the breakaway torque stands for all interfaces at rest.
    """
    ratio = shaft_speed / stribeck_speed
    return -np.expm1(-ratio * ratio)


@inlined
def tip_shear_stress(
    surface_speed: Any, pressure_rise: Any, gap_height: Any, land_length: Any, viscosity: Any
) -> Any:
    r"""Shear stress on the land of a tooth tip, against its motion.

    Parameters
    ----------
    surface_speed : float or ndarray
        Speed of the land along the wall, towards the chamber ahead. [m/s]
    pressure_rise : float or ndarray
        Pressure of the chamber ahead minus that behind. [Pa]
    gap_height : float or ndarray
        Distance from land to wall. [m]
    land_length : float or ndarray
        Length of the land along the motion. [m]
    viscosity : float or ndarray
        Dynamic viscosity. [Pa s]

    Returns
    -------
    float or ndarray
        Shear stress, positive where it opposes the motion. [Pa]

    Notes
    -----
    .. math:: \tau = \frac{\mu u}{h} + \frac{h}{2} \frac{p_{ahead} - p_{behind}}{L}

    The second term resists in a pump and assists in a motor.
    """
    return viscosity * surface_speed / gap_height + 0.5 * gap_height * pressure_rise / land_length


@inlined
def tip_shear_torque(shear_stress: Any, land_length: Any, face_width: Any, tip_radius: Any) -> Any:
    r"""Torque of the shear stress on one tooth tip.

    Parameters
    ----------
    shear_stress : float or ndarray
        Stress of :func:`tip_shear_stress`. [Pa]
    land_length : float or ndarray
        Length of the land along the motion. [m]
    face_width : float or ndarray
        Width of the gear. [m]
    tip_radius : float or ndarray
        Radius of the tip. [m]

    Returns
    -------
    float or ndarray
        Torque, positive where it opposes the motion. [N m]
    """
    return shear_stress * land_length * face_width * tip_radius


@inlined
def lateral_film_torque(
    dynamic_viscosity: Any,
    shaft_speed: Any,
    inner_radius: Any,
    outer_radius: Any,
    gap_height: Any,
    tilt: Any = 0.0,
) -> Any:
    r"""Viscous torque on one ring-shaped face, parallel or tilted gap.

    Parameters
    ----------
    dynamic_viscosity : float or ndarray
        Dynamic viscosity. [Pa s]
    shaft_speed : float or ndarray
        Angular speed of the face. [rad/s]
    inner_radius : float or ndarray
        Inner radius of the ring. [m]
    outer_radius : float or ndarray
        Outer radius of the ring. [m]
    gap_height : float or ndarray
        Height of the gap at the axis. [m]
    tilt : float or ndarray
        Change of height at the outer radius over the height at the axis, below 1. [-]

    Returns
    -------
    float or ndarray
        Torque that opposes the rotation, sign of the speed. [N m]

    Notes
    -----
    With :math:`h = h_0 (1 + k r \cos\vartheta / r_o)`, :math:`x = (k r / r_o)^2` and
    :math:`f(x) = \sqrt{1 - x}\,(2 + x)`,

    .. math:: M = \frac{2 \pi \mu \omega}{3 h_0} \left[ r^4
        \frac{3 + x}{2 + f(x)} \right]_{r_i}^{r_o},

    which is :math:`\pi \mu \omega (r_o^4 - r_i^4) / (2 h_0)` for a parallel gap. Radial pressure
    gradients do no work on the face.
    """
    slope = tilt * tilt / (outer_radius * outer_radius)
    outer = slope * outer_radius * outer_radius
    inner = slope * inner_radius * inner_radius
    outer_term = outer_radius**4 * (3.0 + outer) / (2.0 + np.sqrt(1.0 - outer) * (2.0 + outer))
    inner_term = inner_radius**4 * (3.0 + inner) / (2.0 + np.sqrt(1.0 - inner) * (2.0 + inner))
    scale = 2.0 * np.pi * dynamic_viscosity * shaft_speed / (3.0 * gap_height)
    return scale * (outer_term - inner_term)
