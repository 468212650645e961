"""Film thickness and traction of a lubricated line contact, from rest to full film."""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from toothspace.closures.fluid_law import FluidLaw
from toothspace.core.compiled import inlined

_SLIDE_ROUNDING = 1e-4
"""Slide to roll ratio that rounds the traction at pure rolling, and below which no film however
thick grips whole: regularisation, less than the elastic creep of two cylinders. [-]"""

_LEAST_SLIDE = (2.0**0.405 - 1.0) * _SLIDE_ROUNDING**0.81
"""Factor of sliding at that ratio. [-]"""

_REST_SPEED = 1e-6
"""Speed that keeps the slide to roll ratio finite at rest: regularisation. [m/s]"""

_BOUNDARY_SPEED = 1e-3
"""Sliding speed over which boundary friction builds up: regularisation. [m/s]"""

_LEAST = 1e-300
"""Material number of a fluid whose viscosity does not grow with pressure, for its logarithm. [-]"""


class FlankSurface(NamedTuple):
    """Constants of one pair of flanks."""

    effective_modulus: float
    """E' = 2 / [(1 - nu1^2)/E1 + (1 - nu2^2)/E2]. [Pa]"""
    roughness: float
    """Combined root mean square roughness. [m]"""
    boundary_friction: float
    """Friction coefficient without a film. [-]"""
    limiting_shear: float
    """Limiting shear strength over pressure. [-]"""


@inlined
def traction_coefficient(
    slide_ratio: float,
    speed_number: float,
    load_number: float,
    material_number: float,
    limiting_shear: float,
) -> tuple[float, float, float, float, float]:
    r"""Traction coefficient of an elastohydrodynamic line contact (Jacobson and Hamrock).

    Parameters
    ----------
    slide_ratio : float
        Sliding speed over sum of the surface speeds, 0 to 1. [-]
    speed_number : float
        U = viscosity times SUM of surface speeds over E' R. [-]
    load_number : float
        W = load over width, E' and R. [-]
    material_number : float
        G = Barus coefficient times E'. [-]
    limiting_shear : float
        Limiting shear strength over pressure (gamma), 0.04 to 0.09. [-]

    Returns
    -------
    traction : float
        Friction coefficient, zero in pure rolling. [-]
    by_newtonian : float
        Its derivative by the Newtonian coefficient :math:`\mu_1`, one below the limit. [-]
    grip : float
        The Newtonian coefficient over its factor of sliding, at most that which reaches the limit
        at a slide ratio of 1e-4. [-]
    slide : float
        That factor, :math:`(U^*)^{0.81}`. [-]
    firmer : float
        1 where the grip grows with load and viscosity, 0 where it is the largest. [-]

    Notes
    -----
    .. math:: \mu_1 = 0.671\cdot10^{-6}\, (U^*)^{0.81} U^{0.26} (W G^2)^{3.32}

    and :math:`\mu = \mu_1` up to :math:`0.8\gamma`, beyond it
    :math:`\mu = 0.8\gamma + 0.021 \tanh(\mu_1/\gamma - 0.8)`. The power of the slide ratio is
    rounded below 1e-4. At hard loads :math:`\mu_1` is so steep that its limit stood at a slide
    ratio of 1e-14: a step, at which no time step ends. Two cylinders creep elastically by about
    :math:`\mu a / R` before they slide [2]_, more than 1e-4 at such loads; that the limit is not
    reached before 1e-4 is our assumption. Validity: full film, isothermal, rectangular contact.

    References
    ----------
    .. [1] B. O. Jacobson, B. J. Hamrock, "Non-Newtonian fluid model incorporated into
       elastohydrodynamic lubrication of rectangular contacts", J. Tribology 106, 1984, 275-284.
    .. [2] F. W. Carter, "On the action of a locomotive driving wheel", Proc. Royal Society A 112,
       1926, 151-157.
    """
    rounded = slide_ratio * slide_ratio + _SLIDE_ROUNDING * _SLIDE_ROUNDING
    slide = rounded**0.405 - _SLIDE_ROUNDING**0.81
    # one exponential for the powers, whose logarithms the film thickness has too
    loaded = np.log(load_number) + 2.0 * np.log(np.maximum(material_number, _LEAST))
    grip = 0.671e-6 * np.exp(0.26 * np.log(speed_number) + 3.32 * loaded)
    cap, firmer = 0.8 * limiting_shear, 1.0
    if grip * _LEAST_SLIDE > cap:
        grip, firmer = cap / _LEAST_SLIDE, 0.0
    traction, slope = grip * slide, 1.0
    if traction > cap:
        bend = np.tanh(traction / limiting_shear - 0.8)
        traction, slope = cap + 0.021 * bend, 0.021 * (1.0 - bend * bend) / limiting_shear
    return traction, slope, grip, slide, firmer


@inlined
def film_thickness_dowson_higginson(
    mean_speed_number: Any, material_number: Any, load_number: Any
) -> Any:
    r"""Smallest film of a line contact over the relative radius (Dowson and Higginson).

    Parameters
    ----------
    mean_speed_number : float or ndarray
        Viscosity times MEAN of the surface speeds over E' R. [-]
    material_number : float or ndarray
        Barus coefficient times E'. [-]
    load_number : float or ndarray
        Load over width, E' and R. [-]

    Returns
    -------
    float or ndarray
        Film thickness over relative radius. [-]

    Notes
    -----
    .. math:: H = 2.65\, U_m^{0.70} G^{0.54} W^{-0.13}

    Validity: fully flooded, isothermal, smooth flanks, piezoviscous and elastic.

    References
    ----------
    .. [1] D. Dowson, "Elastohydrodynamics", Proc. Instn Mech. Engrs 182, part 3A, 1968, 151-167.
    """
    logarithm = 0.70 * np.log(mean_speed_number)
    logarithm += 0.54 * np.log(np.maximum(material_number, _LEAST))
    return 2.65 * np.exp(logarithm - 0.13 * np.log(load_number))


@inlined
def boundary_share(film_ratio: Any) -> tuple[Any, Any]:
    r"""Share of the load that asperities carry in a mixed film.

    Parameters
    ----------
    film_ratio : float or ndarray
        Film thickness over combined roughness (lambda). [-]

    Returns
    -------
    share : float or ndarray
        Share between 0 and 1. [-]
    exponent : float or ndarray
        Minus its logarithm. [-]

    Notes
    -----
    .. math:: f = \exp(-1.8\, \lambda^{1.2})

    Validity: constants of ground steel flanks after running-in; both depend on the surfaces.

    References
    ----------
    .. [1] R. S. Zhou, M. R. Hoeprich, "Torque of tapered roller bearings", J. Tribology 113,
       1991, 590-597, equation 29 (form of the law).
    """
    exponent = 1.8 * film_ratio**1.2
    return np.exp(-exponent), exponent


@inlined
def mesh_friction(
    line_load: float,
    relative_radius: float,
    sliding_speed: float,
    rolling_speed_sum: float,
    fluid: FluidLaw,
    surface: FlankSurface,
) -> tuple[float, float, float]:
    r"""Friction coefficient of tooth flanks from rest to full film, with the sign of sliding.

    Parameters
    ----------
    line_load : float
        Normal force per width, zero or positive. [N/m]
    relative_radius : float
        1 / (1/Ra + 1/Rb), concave radii negative. [m]
    sliding_speed : float
        Difference of the surface speeds relative to the contact point. [m/s]
    rolling_speed_sum : float
        Sum of the surface speeds relative to the contact point. [m/s]
    fluid : FluidLaw
        Constants of the fluid; viscosity is that at the entry of the contact. [SI]
    surface : FlankSurface
        Constants of the flanks, or anything with the same fields. [SI]

    Returns
    -------
    friction : float
        Friction coefficient, odd in the sliding speed, zero at rest. [-]
    by_load : float
        Derivative by the line load. [m/N]
    by_sliding : float
        Derivative by the sliding speed. [s/m]

    Notes
    -----
    .. math:: \mu = (1 - f)\, \mu_{EHL} + f \mu_b

    with :func:`traction_coefficient` for the film, :func:`boundary_share` f of
    :func:`film_thickness_dowson_higginson` and the boundary friction :math:`\mu_b`. Smooth at
    rest and at pure rolling. Validity: mixed to full lubrication of gear flanks.

    References
    ----------
    .. [1] B. O. Jacobson, B. J. Hamrock, "Non-Newtonian fluid model incorporated into
       elastohydrodynamic lubrication of rectangular contacts", J. Tribology 106, 1984, 275-284.
    .. [2] R. S. Zhou, M. R. Hoeprich, "Torque of tapered roller bearings", J. Tribology 113,
       1991, 590-597 (load shared by asperities and film).
    """
    total = np.sqrt(rolling_speed_sum * rolling_speed_sum + _REST_SPEED * _REST_SPEED)
    slide_ratio = min(abs(sliding_speed) / total, 1.0)
    scale = surface.effective_modulus * relative_radius
    speed_number = fluid.dynamic_viscosity * total / scale
    load_number = max(line_load / scale, 1e-12)
    material_number = fluid.pressure_viscosity * surface.effective_modulus
    film = film_thickness_dowson_higginson(0.5 * speed_number, material_number, load_number)
    share, exponent = boundary_share(film * relative_radius / surface.roughness)
    traction, slope, grip, slide, firmer = traction_coefficient(
        slide_ratio, speed_number, load_number, material_number, surface.limiting_shear
    )
    sign = np.sign(sliding_speed)
    rise = np.tanh(sliding_speed / _BOUNDARY_SPEED)
    boundary = surface.boundary_friction * rise
    by_load = (1.0 - share) * sign * slope * firmer * 3.32 * grip * slide
    by_load += 0.13 * 1.2 * exponent * share * (boundary - sign * traction)
    by_sliding = share * surface.boundary_friction * (1.0 - rise * rise) / _BOUNDARY_SPEED
    if slide_ratio < 1.0:
        rounded = slide_ratio * slide_ratio + _SLIDE_ROUNDING * _SLIDE_ROUNDING
        by_ratio = 0.81 * slide_ratio * (slide + _SLIDE_ROUNDING**0.81) / rounded
        by_sliding += (1.0 - share) * slope * grip * by_ratio / total
    friction = (1.0 - share) * sign * traction + share * boundary
    return friction, by_load / (load_number * scale), by_sliding
