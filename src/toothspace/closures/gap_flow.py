"""Laminar flow through narrow gaps: conductances, and drag of moving walls."""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.core.compiled import inlined

CURVED_GAP_CONSTANT = 8.0 / (36.0 * np.sqrt(2.0) * np.pi)
"""Factor 0.050018 of the conductance of a curved gap. [-]"""


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

    Validity: laminar, fully developed flow of a liquid of constant viscosity.
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

    Accuracy: 0.6 % against circular arcs of equal convex radii up to h/R = 0.1; a pair of
    convex and concave arcs flows 8 % more at h/R = 0.03.
    """
    scaled = CURVED_GAP_CONSTANT * gap_width * gap_height * gap_height
    return scaled * np.sqrt(gap_height / relative_radius) / dynamic_viscosity


@inlined
def curved_gap_conductance_fitted(
    gap_height: Any, gap_width: Any, relative_radius: Any, dynamic_viscosity: Any
) -> Any:
    r"""Flow rate per pressure drop of a curved gap by a published fit.

    Parameters
    ----------
    gap_height : float or ndarray
        Smallest distance between the walls. [m]
    gap_width : float or ndarray
        Extent normal to the flow. [m]
    relative_radius : float or ndarray
        Radius of relative curvature. [m]
    dynamic_viscosity : float or ndarray
        Dynamic viscosity. [Pa s]

    Returns
    -------
    float or ndarray
        Conductance. [m3/(s Pa)]

    Notes
    -----
    .. math:: G = 0.0456\, b\, h^{2.4836} / (\mu R^{0.4836})

    Within 5 % of :func:`curved_gap_conductance` for h/R from 3e-4 to 0.1.

    References
    ----------
    .. [1] Gerotor torque study with multiple contact points, equation 3.
    """
    power = gap_height**2.4836 / relative_radius**0.4836
    return 0.0456 * gap_width * power / dynamic_viscosity


@inlined
def annular_land_conductance(
    gap_height: Any, inner_radius: Any, outer_radius: Any, sector_angle: Any, dynamic_viscosity: Any
) -> Any:
    r"""Flow rate per pressure drop of radial flow through a flat ring sector.

    Parameters
    ----------
    gap_height : float or ndarray
        Distance between the walls. [m]
    inner_radius : float or ndarray
        Radius of the inner edge. [m]
    outer_radius : float or ndarray
        Radius of the outer edge. [m]
    sector_angle : float or ndarray
        Angle of the sector. [rad]
    dynamic_viscosity : float or ndarray
        Dynamic viscosity. [Pa s]

    Returns
    -------
    float or ndarray
        Conductance. [m3/(s Pa)]

    Notes
    -----
    .. math:: G = \frac{\varphi h^3}{12 \mu \ln (r_o / r_i)}
    """
    land = 12.0 * dynamic_viscosity * np.log(outer_radius / inner_radius)
    return sector_angle * gap_height**3 / land


@inlined
def tilted_gap_factor(tilt: Any, radius_ratio: Any) -> Any:
    r"""Mean of the cube of a tilted gap's height over a circle, over that at the axis.

    Parameters
    ----------
    tilt : float or ndarray
        Change of height at the reference radius over the height at the axis. [-]
    radius_ratio : float or ndarray
        Radius of the circle over the reference radius. [-]

    Returns
    -------
    float or ndarray
        Factor on the flow rate. [-]

    Notes
    -----
    Mean of :math:`(1 + k (r/R) \cos\vartheta)^3 = 1 + 1.5\, k^2 (r/R)^2`.
    """
    slope = tilt * radius_ratio
    return 1.0 + 1.5 * slope * slope


@inlined
def couette_flow_rate(mean_wall_speed: Any, gap_height: Any, gap_width: Any) -> Any:
    r"""Flow rate dragged through a gap by its walls.

    Parameters
    ----------
    mean_wall_speed : float or ndarray
        Mean speed of both walls towards downstream, in the frame of the gap. [m/s]
    gap_height : float or ndarray
        Distance between the walls. [m]
    gap_width : float or ndarray
        Extent normal to the flow. [m]

    Returns
    -------
    float or ndarray
        Volumetric flow rate, positive towards downstream. [m3/s]

    Notes
    -----
    .. math:: Q = b\, h\, (u_1 + u_2) / 2

    A tooth tip in a bore at rest has the mean speed :math:`\omega r_a / 2`; a smooth disc
    in a bore pumps :math:`b u h / 2` in the direction of rotation.
    """
    return gap_width * gap_height * mean_wall_speed


@inlined
def gap_flow_rate_couette_poiseuille(
    pressure_drop: Any,
    sliding_speed: Any,
    gap_height: Any,
    gap_width: Any,
    gap_length: Any,
    dynamic_viscosity: Any,
) -> Any:
    r"""Flow rate through a parallel gap driven by pressure and by one moving wall.

    Parameters
    ----------
    pressure_drop : float or ndarray
        Upstream minus downstream pressure. [Pa]
    sliding_speed : float or ndarray
        Speed of the moving wall, positive towards downstream. [m/s]
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
        Volumetric flow rate, positive towards downstream. [m3/s]

    Notes
    -----
    .. math:: Q = \frac{b h^3}{12 \mu L} \Delta p + \frac{b h}{2} U

    Validity: laminar (:math:`\rho U h / \mu < 1000`), fully developed, no slip.

    Examples
    --------
    A 20 um tip gap, 20 mm wide, 1 mm long, 100 bar, walls at rest:

    >>> q = gap_flow_rate_couette_poiseuille(100e5, 0.0, 20e-6, 20e-3, 1e-3, 0.03)
    >>> round(float(q) * 6e4, 4)  # L/min
    0.2667
    """
    conductance = parallel_gap_conductance(gap_height, gap_width, gap_length, dynamic_viscosity)
    return conductance * pressure_drop + couette_flow_rate(
        0.5 * sliding_speed, gap_height, gap_width
    )


@inlined
def throat_drag_flow_rate(
    speed_a: Any, speed_b: Any, throat_speed: Any, gap_height: Any, gap_width: Any
) -> Any:
    r"""Flow rate dragged through a throat that itself moves along the walls.

    Parameters
    ----------
    speed_a : float or ndarray
        Speed of one wall along the common tangent. [m/s]
    speed_b : float or ndarray
        Speed of the other wall along the common tangent. [m/s]
    throat_speed : float or ndarray
        Speed of the narrowest place along the common tangent. [m/s]
    gap_height : float or ndarray
        Smallest distance between the walls. [m]
    gap_width : float or ndarray
        Extent normal to the flow. [m]

    Returns
    -------
    float or ndarray
        Volumetric flow rate relative to the throat, positive along the tangent. [m3/s]

    Notes
    -----
    .. math:: Q = b\, h \left[\tfrac12 (u_a + u_b) - V_c\right]

    The throat bounds the chambers on both sides, so its own motion is part of their change
    of volume and must be left out of the drag flow.
    """
    return couette_flow_rate(0.5 * (speed_a + speed_b) - throat_speed, gap_height, gap_width)
