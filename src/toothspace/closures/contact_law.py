"""Elastic laws of compliant line contacts with their stiffness and energy, for compiled code.

Each law gives force, slope and energy per length over the depth of indentation and a level
that may vary along the flank: where curvature changes, stored energy does too.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.core.compiled import inlined

_DEEPEST = 3.0
"""Least ln(4 D / depth) of the logarithmic law; beyond it goes on straight. [-]"""

_DEEPEST_ROOT = 4.1461932206205825
"""Root of z - ln(z - 1) = 3. [-]"""


@inlined
def rounded_depth(overlap: float, onset: float) -> tuple[float, float, float]:
    r"""Depth that the elastic law feels, rounded where the surfaces begin to touch.

    Parameters
    ----------
    overlap : float
        Overlap of the nominal surfaces, negative while they are apart. [m]
    onset : float
        Overlap from which the depth equals it; at minus this value it begins. [m]

    Returns
    -------
    depth : float
        Depth, zero or positive. [m]
    slope : float
        Derivative by the overlap. [-]
    bend : float
        Second derivative. [1/m]

    Notes
    -----
    .. math:: d = (x + w)^3 (3 w - x) / (16 w^3), \qquad -w < x < w

    with two continuous derivatives. It stands for the first asperities that touch. Validity: a
    regularisation; onset of the size of the roughness.

    References
    ----------
    .. [1] C. de Boor, *A Practical Guide to Splines*, Springer, 1978 (textbook: a polynomial
       piece that joins two lines smoothly).
    """
    if overlap <= -onset:
        return 0.0, 0.0, 0.0
    if overlap >= onset:
        return overlap, 1.0, 0.0
    y = (overlap + onset) / onset
    depth = onset * y * y * y * (4.0 - y) / 16.0
    return depth, y * y * (3.0 - y) / 4.0, (6.0 * y - 3.0 * y * y) / (4.0 * onset)


@inlined
def logarithmic_law(
    depth: float, level: float, contact_modulus: float
) -> tuple[float, float, float, float]:
    r"""Line contact whose depth is the load times a logarithm (Hertz, Johnson).

    Parameters
    ----------
    depth : float
        Indentation, positive. [m]
    level : float
        Logarithm of the length scale D in metres. [-]
    contact_modulus : float
        E*. [Pa]

    Returns
    -------
    line_load : float
        Force per length. [N/m]
    stiffness : float
        Derivative by the depth. [N/m2]
    energy : float
        Elastic energy per length. [J/m]
    energy_by_level : float
        Derivative of the energy by the level at this depth. [J/m]

    Notes
    -----
    .. math:: \delta = \frac{q}{\pi E^*} \left[\ln\frac{4\pi E^* D}{q} - 1\right]

    With :math:`z = \ln(4\pi E^* D/q)`, the root of
    :math:`z - \ln(z-1) = \ln(4D/\delta)`: stiffness :math:`\pi E^*/(z-2)`, energy
    :math:`q^2 (z - 3/2)/(2\pi E^*)`. Beyond :math:`\delta = 4D/e^3` the law goes on straight.
    A compliance 1/kappa of the structure in series multiplies D by
    :math:`\exp(\pi E^*/\kappa)`. Validity: elastic half-spaces, contact narrow against the
    radii; the depth of the straight branch is beyond that.

    References
    ----------
    .. [1] K. L. Johnson, *Contact Mechanics*, Cambridge, 1985, section 5.6.
    """
    modulus = np.pi * contact_modulus
    a = level - np.log(0.25 * depth)
    deep = a < _DEEPEST
    z = _DEEPEST_ROOT
    if not deep:
        z = a + np.log(a)
        for _ in range(3):
            z -= (z - np.log(z - 1.0) - a) * (z - 1.0) / (z - 2.0)
    load = 4.0 * modulus * np.exp(level - z)
    stiffness = modulus / (z - 2.0)
    energy = 0.5 * load * load * (z - 1.5) / modulus
    if deep:
        further = depth - 4.0 * np.exp(level - _DEEPEST)
        energy += further * (load + 0.5 * stiffness * further)
        load += stiffness * further
    return load, stiffness, energy, 2.0 * energy - load * depth


@inlined
def power_law(
    depth: float, level: float, exponent: float
) -> tuple[float, float, float, float, float]:
    r"""Contact whose force is a power of the depth (Pereira, linear springs).

    Parameters
    ----------
    depth : float
        Indentation, positive. [m]
    level : float
        Logarithm of the force per length at a depth of one metre. [-]
    exponent : float
        Exponent n. [-]

    Returns
    -------
    line_load, stiffness, energy, energy_by_level, energy_by_exponent : float
        As in :func:`logarithmic_law`; last the derivative by the exponent. [N/m], [N/m2],
        [J/m], [J/m], [J/m]

    Notes
    -----
    .. math:: q = e^{level} \delta^n, \qquad u = q \delta / (n + 1)

    Validity: the range in which level and exponent were fitted.

    References
    ----------
    .. [1] C. Pereira, A. Ramalho, J. Ambrosio, "A critical overview of internal and external
       cylinder contact force models", Nonlinear Dynamics 63, 2011, 681-697.
    """
    logarithm = np.log(depth)
    load = np.exp(level + exponent * logarithm)
    energy = load * depth / (exponent + 1.0)
    by_exponent = energy * (logarithm - 1.0 / (exponent + 1.0))
    return load, exponent * load / depth, energy, energy, by_exponent


@inlined
def johnson_scale(radius_a: Any, radius_b: Any) -> Any:
    r"""Length scale D of Johnson's law: sum of the radii, concave ones negative.

    Parameters
    ----------
    radius_a, radius_b : float or ndarray
        Radii of curvature, concave negative. [m]

    Returns
    -------
    float or ndarray
        Length scale. [m]

    Notes
    -----
    .. math:: D = |R_1 + R_2|

    Validity: as :func:`logarithmic_law`, each radius the depth of the far point.

    References
    ----------
    .. [1] K. L. Johnson, *Contact Mechanics*, Cambridge, 1985, section 5.6.
    """
    return np.abs(radius_a + radius_b)


@inlined
def hertz_scale(radius_a: Any, radius_b: Any, depth: Any) -> Any:
    r"""Length scale D of the approach of two points deep below a Hertz line contact.

    Parameters
    ----------
    radius_a, radius_b : float or ndarray
        Radii of curvature, concave negative. [m]
    depth : float or ndarray
        Largest distance of those points from the surface; no farther than a radius. [m]

    Returns
    -------
    float or ndarray
        Length scale. [m]

    Notes
    -----
    .. math:: \delta = \frac{q}{\pi E^*}
        \left[\ln\frac{4 d_1}{b} + \ln\frac{4 d_2}{b} - 1\right], \qquad D = d_1 d_2 / R

    Where both depths are the radii, this is Johnson's law. Validity: depths large against the
    half width b of the contact.

    References
    ----------
    .. [1] K. L. Johnson, *Contact Mechanics*, Cambridge, 1985, section 5.6.
    """
    first = np.minimum(np.abs(radius_a), depth)
    second = np.minimum(np.abs(radius_b), depth)
    return first * second * np.abs(1.0 / radius_a + 1.0 / radius_b)


@inlined
def series_level(scale: Any, contact_modulus: Any, structure_stiffness: Any) -> Any:
    r"""Level of the logarithmic law with a compliant structure in series.

    Parameters
    ----------
    scale : float or ndarray
        Length scale D. [m]
    contact_modulus : float or ndarray
        E*. [Pa]
    structure_stiffness : float or ndarray
        Stiffness of teeth and bodies behind the contact per length. [N/m2]

    Returns
    -------
    float or ndarray
        Level of :func:`logarithmic_law`. [-]

    Notes
    -----
    .. math:: \lambda = \ln D + \pi E^* / \kappa

    because a deflection :math:`q/\kappa` adds to the logarithm of the contact. Validity: a
    structure of constant stiffness.

    References
    ----------
    .. [1] K. L. Johnson, *Contact Mechanics*, Cambridge, 1985, section 5.6.
    """
    return np.log(scale) + np.pi * contact_modulus / structure_stiffness


@inlined
def impact_damping(restitution: float, approach_speed: float) -> float:
    r"""Damping of a contact over its elastic force.

    Parameters
    ----------
    restitution : float
        Coefficient of restitution, 0.7 to 1. [-]
    approach_speed : float
        Rate of indentation at first touch for which the restitution holds, positive. [m/s]

    Returns
    -------
    float
        Damping force over elastic force and rate of indentation. [s/m]

    Notes
    -----
    .. math:: d = \tfrac34 (1 - c_r^2) / \dot\delta^{(-)}

    Validity: central impact of elastic bodies with little loss, restitution above 0.7.

    References
    ----------
    .. [1] H. M. Lankarani, P. E. Nikravesh, "A contact force model with hysteresis damping for
       impact analysis of multibody systems", J. Mechanical Design 112, 1990, 369-376.
    """
    return 0.75 * (1.0 - restitution**2) / approach_speed


@inlined
def impact_factor(indentation_rate: float, damping: float) -> float:
    r"""Factor on the elastic contact force for the energy lost in an impact.

    Parameters
    ----------
    indentation_rate : float
        Rate of indentation, positive while approaching. [m/s]
    damping : float
        Damping of :func:`impact_damping`. [s/m]

    Returns
    -------
    float
        Factor, zero or positive so that the contact never pulls. [-]

    Notes
    -----
    .. math:: \max(0,\; 1 + d\, \dot\delta)

    Validity: as :func:`impact_damping`.

    References
    ----------
    .. [1] H. M. Lankarani, P. E. Nikravesh, "A contact force model with hysteresis damping for
       impact analysis of multibody systems", J. Mechanical Design 112, 1990, 369-376.
    """
    return max(0.0, 1.0 + damping * indentation_rate)


REACH = 60.0
"""Gap at which the film begins to resist, over the roughness. [-]"""

_FORCE = 3.0 * np.sqrt(2.0) * np.pi


@inlined
def squeeze_damping(
    gap: float, roughness: float, curvature: float, viscosity: float
) -> tuple[float, float]:
    r"""Force per length and speed at which two cylinders approach in a liquid.

    Parameters
    ----------
    gap : float
        Gap of the mean surfaces, negative while they overlap. [m]
    roughness : float
        Combined root mean square roughness: the valleys hold a film that is never squeezed
        out. [m]
    curvature : float
        Relative curvature. [1/m]
    viscosity : float
        Dynamic viscosity. [Pa s]

    Returns
    -------
    damping : float
        Line load over the speed of approach; zero from :data:`REACH` roughness heights on.
        [N s/m2]
    by_gap : float
        Its derivative. [N s/m3]

    Notes
    -----
    Validity: rigid parabolic surfaces, isoviscous, full film.

    .. math::

        \frac{q}{v} = 3\sqrt2\,\pi\,\mu \left(\frac{R}{h}\right)^{3/2}, \qquad
        h = \sigma + \tfrac12\left(g + \sqrt{g^2 + \sigma^2}\right) .

    From :math:`\mathrm dp/\mathrm dx = 12\mu v x/h^3` with :math:`h = h_0 + x^2/2R`. A film
    that is drawn apart cavitates and does not pull: use it for approach only.

    References
    ----------
    .. [1] B. J. Hamrock, S. R. Schmid, B. O. Jacobson, Fundamentals of Fluid Film Lubrication,
       2nd ed., Marcel Dekker, 2004, chapter 11.
    """
    if gap >= REACH * roughness:
        return 0.0, 0.0
    root = np.sqrt(gap * gap + roughness * roughness)
    height = roughness + 0.5 * (gap + root)
    far = roughness * (1.0 + 0.5 * (REACH + np.sqrt(REACH * REACH + 1.0)))
    scale = _FORCE * viscosity / (curvature * np.sqrt(curvature))
    near = 1.0 / (height * np.sqrt(height))
    by_height = -1.5 * near / height
    return scale * (near - 1.0 / (far * np.sqrt(far))), scale * by_height * 0.5 * (1.0 + gap / root)
