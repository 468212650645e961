"""Flow along a tooth space that winds about its axis, and the pressure that it takes."""

from __future__ import annotations

import numpy as np

from toothspace.core.types import Array


def pressure_along_space(
    area: Array,
    area_rate: Array,
    hydraulic_diameter: Array,
    turn_per_length: float,
    length: float,
    shaft_speed: float,
    density: float,
    dynamic_viscosity: float,
) -> Array:
    r"""Pressure by which the shut end of a tooth space stands above its open end. [Pa].

    Parameters
    ----------
    area : ndarray
        Section of the space at even places, from the shut end to the open one. [m2]
    area_rate : ndarray
        Its growth with the shaft angle. [m2/rad]
    hydraulic_diameter : ndarray
        Four times the section over its outline. [m]
    turn_per_length : float
        Shaft angle by which sections lead along the axis; not zero. [rad/m]
    length : float
        Face width. [m]
    shaft_speed : float
        Shaft speed. [rad/s]
    density : float
        Density of the oil. [kg/m3]
    dynamic_viscosity : float
        Dynamic viscosity of the oil. [Pa s]

    Returns
    -------
    ndarray
        Of inertia, Bernoulli and friction. Shape (3, ...). [Pa]

    Notes
    -----
    All that the space displaces leaves at one end. Along a helix the section changes with the place
    as it does with the shaft angle, :math:`\partial A/\partial\varphi = (1/\kappa)\,
    \partial A/\partial z`, so that continuity is integrated in closed form: with
    :math:`w = \omega/|\kappa|`, the speed at which the helix passes along the axis,

    .. math:: v(z) = w \left(1 - \frac{A(0)}{A(z)}\right), \qquad
        \frac{\partial v}{\partial \varphi} = -w\,\frac{A'(0) A(z) - A(0) A'(z)}{A(z)^2} ,

    .. math:: p(0) - p(b) = \rho\omega\int_0^b \frac{\partial v}{\partial\varphi}\,dz
        + \frac{\rho\,v(b)^2}{2} + \int_0^b \frac{32\,\mu\,v}{D_h^2}\,dz .

    Validity: one-dimensional incompressible flow, laminar friction of a round pipe.

    References
    ----------
    .. [1] F. M. White, *Fluid Mechanics*, sections on unsteady one-dimensional flow and laminar
       pipe flow.
    """
    shut, shut_rate = area[..., :1], area_rate[..., :1]
    passing = shaft_speed / abs(turn_per_length)
    speed = passing * (1.0 - shut / area)
    gain = -passing * (shut_rate * area - shut * area_rate) / area**2
    step = length / (area.shape[-1] - 1)
    inertia = density * shaft_speed * np.trapezoid(gain, dx=step, axis=-1)
    bernoulli = 0.5 * density * speed[..., -1] ** 2
    drag = 32.0 * dynamic_viscosity * speed / hydraulic_diameter**2
    return np.stack([inertia, bernoulli, np.trapezoid(drag, dx=step, axis=-1)])
