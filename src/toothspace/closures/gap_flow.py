"""Laminar flow through narrow gaps: conductances, equivalent sizes, drag and shear of walls."""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.core.compiled import inlined

CURVED_GAP_CONSTANT = 8.0 / (36.0 * np.sqrt(2.0) * np.pi)
"""Factor 0.050018 of the conductance of a curved gap. [-]"""

NARROW = 0.1
"""Smallest gap over radius up to which walls are parabolas to the flow between them. [-]"""

FITTED_POWER = 2.4836
"""Power of the height in the fitted conductance of a gerotor tip. [-]"""


@inlined
def parallel_gap_conductance(
    gap_height: Any, gap_width: Any, gap_length: Any, dynamic_viscosity: Any
) -> Any:
    r"""Flow rate per pressure drop of a gap between parallel walls.

    Parameters
    ----------
    gap_height : float or ndarray
        Distance between the walls. [m]
    gap_width : float or ndarray
        Extent normal to the flow. [m]
    gap_length : float or ndarray
        Extent along the flow. [m]
    dynamic_viscosity : float or ndarray
        Dynamic viscosity. [Pa s]

    Returns
    -------
    float or ndarray
        Conductance. [m3/(s Pa)]

    Notes
    -----
    .. math:: G = \frac{b h^3}{12 \mu L}

    Validity: laminar, fully developed flow of a liquid of constant viscosity; gap height small
    against width and length.

    References
    ----------
    .. [1] B. J. Hamrock, S. R. Schmid, B. O. Jacobson, *Fundamentals of Fluid Film Lubrication*,
       2nd ed., Marcel Dekker, 2004 (textbook law: Poiseuille flow).

    Examples
    --------
    A tip gap of 20 um, 20 mm wide and 1 mm long at 100 bar:

    >>> flow = parallel_gap_conductance(20e-6, 20e-3, 1e-3, 0.03) * 100e5
    >>> round(flow * 6e4, 4)  # L/min
    0.2667
    """
    return gap_width * gap_height**3 / (12.0 * dynamic_viscosity * gap_length)


@inlined
def curved_gap_conductance(
    gap_height: Any, gap_width: Any, relative_radius: Any, dynamic_viscosity: Any
) -> Any:
    r"""Flow rate per pressure drop of the gap between two curved walls.

    Parameters
    ----------
    gap_height : float or ndarray
        Smallest distance between the walls. [m]
    gap_width : float or ndarray
        Extent normal to the flow. [m]
    relative_radius : float or ndarray
        Radius of relative curvature, 1 / (1/R1 + 1/R2), concave radii negative. [m]
    dynamic_viscosity : float or ndarray
        Dynamic viscosity. [Pa s]

    Returns
    -------
    float or ndarray
        Conductance. [m3/(s Pa)]

    Notes
    -----
    With :math:`h(x) = h_0 + x^2/(2R)` and
    :math:`\int \mathrm{d}x / h^3 = (3\pi/8) \sqrt{2R}\, h_0^{-5/2}`,

    .. math:: G = \frac{8\, b\, h_0^{5/2}}{36 \pi \sqrt{2 R}\, \mu}
        = 0.050018\, \frac{b\, h_0^{5/2}}{\mu \sqrt{R}} .

    Beyond :math:`h_0 = 0.1 R` it grows as :math:`b h_0^2 / \mu`, as that of an opening does, with
    the factor 0.0158 reached there; the limit of a very wide throat in creeping flow, a slit in a
    thin wall, has :math:`\pi / 32 = 0.098` [2]_. Validity: laminar flow of a liquid of constant
    viscosity. Accuracy: 0.6 % against circular arcs of equal convex radii up to h/R = 0.1; a pair
    of convex and concave arcs flows 8 % more at h/R = 0.03.

    References
    ----------
    .. [1] B. J. Hamrock, S. R. Schmid, B. O. Jacobson, *Fundamentals of Fluid Film Lubrication*,
       2nd ed., Marcel Dekker, 2004 (textbook law: Reynolds equation between parabolic walls).
    .. [2] H. Hasimoto, On the flow of a viscous fluid past a thin screen at small Reynolds
       numbers, J. Phys. Soc. Japan 13 (1958) 633-639.
    """
    scaled = CURVED_GAP_CONSTANT * gap_width * gap_height * gap_height
    return scaled * np.sqrt(np.minimum(gap_height / relative_radius, NARROW)) / dynamic_viscosity


@inlined
def fitted_gap_conductance(
    gap_height: Any, gap_width: Any, relative_radius: Any, dynamic_viscosity: Any
) -> Any:
    r"""Flow rate per pressure drop between two curved walls as fitted for gerotor tips.

    Parameters
    ----------
    gap_height, gap_width, relative_radius, dynamic_viscosity : float or ndarray
        As in :func:`curved_gap_conductance`. [m], [m], [m], [Pa s]

    Returns
    -------
    float or ndarray
        Conductance. [m3/(s Pa)]

    Notes
    -----
    .. math:: G = 0.0456\, \frac{b\, h_0^{2.4836}}{\mu R^{0.4836}}

    The width counts once; the printed equation has it twice. Wide gaps as there. Validity: 5 % of
    :func:`curved_gap_conductance` for h/R from 3e-4 to 0.1.

    References
    ----------
    .. [1] "A numerical model for the evaluation of gerotor torque considering multiple contact
       points and fluid-structure interactions", equation 3.
    """
    narrow = np.minimum(gap_height / relative_radius, NARROW)
    fit = 0.0456 * narrow ** (FITTED_POWER - 2.0)
    return fit * gap_width * gap_height * gap_height / dynamic_viscosity


@inlined
def ring_sector_gap(inner_radius: Any, outer_radius: Any, sector_angle: Any) -> tuple[Any, Any]:
    r"""Width and length of the parallel gap that leaks like radial flow through a ring sector.

    Parameters
    ----------
    inner_radius : float or ndarray
        Radius of the inner edge. [m]
    outer_radius : float or ndarray
        Radius of the outer edge. [m]
    sector_angle : float or ndarray
        Angle of the sector. [rad]

    Returns
    -------
    gap_width : float or ndarray
        Extent normal to the flow, at the mean radius. [m]
    gap_length : float or ndarray
        Extent along the flow. [m]

    Notes
    -----
    From :math:`G = \varphi h^3 / [12 \mu \ln(r_o/r_i)]` of the ring sector,

    .. math:: b = \varphi\, r_m, \qquad L = r_m \ln\frac{r_o}{r_i}, \qquad
        r_m = \tfrac12 (r_i + r_o) .

    Validity: laminar radial flow between parallel faces, equal pressure along each edge.

    References
    ----------
    .. [1] B. J. Hamrock, S. R. Schmid, B. O. Jacobson, *Fundamentals of Fluid Film Lubrication*,
       2nd ed., Marcel Dekker, 2004 (textbook law: flat annular thrust bearing).
    """
    middle = 0.5 * (inner_radius + outer_radius)
    return sector_angle * middle, middle * np.log(outer_radius / inner_radius)


@inlined
def tilted_gap_height(gap_height: Any, tilt: Any) -> Any:
    r"""Height of the parallel gap that leaks like a tilted one, mean of a circle.

    Parameters
    ----------
    gap_height : float or ndarray
        Height of the tilted gap at the axis. [m]
    tilt : float or ndarray
        Largest change of height on the circle over the height at the axis. [-]

    Returns
    -------
    float or ndarray
        Height. [m]

    Notes
    -----
    .. math:: h = h_0 \left(1 + \tfrac32 k^2\right)^{1/3}

    the cube root of the mean of :math:`h_0^3 (1 + k \cos\vartheta)^3`. Validity: laminar flow
    across the circle with the same pressure drop at every angle; tilt below 1.

    References
    ----------
    .. [1] B. J. Hamrock, S. R. Schmid, B. O. Jacobson, *Fundamentals of Fluid Film Lubrication*,
       2nd ed., Marcel Dekker, 2004 (textbook law: Poiseuille flow, integrated).
    """
    return gap_height * (1.0 + 1.5 * tilt**2) ** (1.0 / 3.0)


@inlined
def equal_leakage_height(first_height: Any, second_height: Any) -> Any:
    r"""Height that two equal gaps must have to leak as much as two of different height.

    Parameters
    ----------
    first_height, second_height : float or ndarray
        Heights of the two gaps. [m]

    Returns
    -------
    float or ndarray
        Height. [m]

    Notes
    -----
    .. math:: h = \left[\tfrac12 (h_1^3 + h_2^3)\right]^{1/3}

    Validity: laminar flow, both gaps of the same width, length and pressure drop.

    References
    ----------
    .. [1] B. J. Hamrock, S. R. Schmid, B. O. Jacobson, *Fundamentals of Fluid Film Lubrication*,
       2nd ed., Marcel Dekker, 2004 (textbook law: Poiseuille flow).
    """
    return (0.5 * (first_height**3 + second_height**3)) ** (1.0 / 3.0)


@inlined
def wall_drag_flow_rate(
    gap_height: Any, gap_width: Any, mean_wall_speed: Any, opened_height: Any, throat_speed: Any
) -> Any:
    r"""Flow rate dragged through a gap by its walls, as the chambers on both sides see it.

    Parameters
    ----------
    gap_height : float or ndarray
        Distance between the walls. [m]
    gap_width : float or ndarray
        Extent normal to the flow. [m]
    mean_wall_speed : float or ndarray
        Mean speed of both walls towards downstream, less that of the throat where the
        chambers move with it. [m/s]
    opened_height : float or ndarray
        Part of the height that a displacement of the bodies opened. [m]
    throat_speed : float or ndarray
        Speed with which the boundary of the chambers moves through that part. [m/s]

    Returns
    -------
    float or ndarray
        Volumetric flow rate, positive towards downstream. [m3/s]

    Notes
    -----
    .. math:: Q = b\,(\bar u\, h - U\, \delta h)

    The first term is Couette flow between the walls. The second is fluid between the nominal
    and the displaced wall: volumes of the chambers count it as theirs, so that it passes from
    one to the other with the speed U of the body. Speeds may be per shaft speed, the result
    then is too. Validity: laminar, fully developed flow.

    References
    ----------
    .. [1] B. J. Hamrock, S. R. Schmid, B. O. Jacobson, *Fundamentals of Fluid Film Lubrication*,
       2nd ed., Marcel Dekker, 2004 (textbook law: Couette flow).

    Examples
    --------
    A smooth disc in a bore pumps half its surface speed times the gap:

    >>> round(wall_drag_flow_rate(20e-6, 10e-3, 0.5 * 5.0, 0.0, 5.0), 12)
    5e-07
    """
    return gap_width * gap_height * mean_wall_speed - gap_width * throat_speed * opened_height


@inlined
def land_shear_torque(
    shaft_speed: Any,
    surface_lever: Any,
    gap_height: Any,
    gap_width: Any,
    land_length: Any,
    dynamic_viscosity: Any,
) -> Any:
    r"""Torque of viscous shear on a land that slides along a wall, as of a tooth tip.

    Parameters
    ----------
    shaft_speed : float or ndarray
        Angular speed of the shaft. [rad/s]
    surface_lever : float or ndarray
        Speed of the land along the wall per shaft speed. [m]
    gap_height : float or ndarray
        Distance from land to wall. [m]
    gap_width : float or ndarray
        Extent normal to the motion. [m]
    land_length : float or ndarray
        Extent along the motion. [m]
    dynamic_viscosity : float or ndarray
        Dynamic viscosity. [Pa s]

    Returns
    -------
    float or ndarray
        Torque at the shaft, sign of the speed; it opposes the rotation. [N m]

    Notes
    -----
    .. math:: M = \mu \omega \frac{r^2 b L}{h}

    with the lever r. The pressure drop along the land shears it by
    :math:`\tfrac12 h\, \Delta p / L` besides: that part is the work of the dragged flow against
    the pressure drop. Validity: laminar, fully developed flow.

    References
    ----------
    .. [1] B. J. Hamrock, S. R. Schmid, B. O. Jacobson, *Fundamentals of Fluid Film Lubrication*,
       2nd ed., Marcel Dekker, 2004 (textbook law: Newtonian shear).
    """
    shear = surface_lever * surface_lever * gap_width * land_length / gap_height
    return dynamic_viscosity * shaft_speed * shear


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
    gradients do no work on the face. Validity: laminar shear of a film without cavity, one
    viscosity, tilt below 1.

    References
    ----------
    .. [1] B. J. Hamrock, S. R. Schmid, B. O. Jacobson, *Fundamentals of Fluid Film Lubrication*,
       2nd ed., Marcel Dekker, 2004 (textbook law: Newtonian shear, integrated over the face).
    """
    slope = tilt * tilt / (outer_radius * outer_radius)
    outer = slope * outer_radius * outer_radius
    inner = slope * inner_radius * inner_radius
    outer_term = outer_radius**4 * (3.0 + outer) / (2.0 + np.sqrt(1.0 - outer) * (2.0 + outer))
    inner_term = inner_radius**4 * (3.0 + inner) / (2.0 + np.sqrt(1.0 - inner) * (2.0 + inner))
    scale = 2.0 * np.pi * dynamic_viscosity * shaft_speed / (3.0 * gap_height)
    return scale * (outer_term - inner_term)
