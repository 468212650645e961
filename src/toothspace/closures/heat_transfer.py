"""Heat between oil and walls: thin films, and bodies that turn in oil."""

from __future__ import annotations

from typing import Any


def film_wall_conductance(conductivity: Any, area: Any, height: Any) -> Any:
    r"""Heat flow from a film that heats itself to one of its walls, per temperature difference.

    Parameters
    ----------
    conductivity : float or ndarray
        Thermal conductivity of the oil. [W/(m K)]
    area : float or ndarray
        Area of the film. [m2]
    height : float or ndarray
        Film height. [m]

    Returns
    -------
    float or ndarray
        Conductance between the mean temperature of the film and the wall. [W/K]

    Notes
    -----
    .. math:: G = \frac{6 k A}{h}

    A heat source that is uniform over the height leaves half of it at either wall and lifts the
    mean over two equally warm walls by :math:`q''' h^2 / (12 k)`. Validity: laminar; heat is
    conducted across the film faster than carried along it.

    References
    ----------
    .. [1] H. S. Carslaw, J. C. Jaeger, *Conduction of Heat in Solids*, 2nd ed., Oxford, 1959,
       section 3.14: slab with heat produced within it.

    Examples
    --------
    Both faces of a gear of 40 mm with a film of 8 um:

    >>> round(film_wall_conductance(0.13, 2e-3, 8e-6))
    195
    """
    return 6.0 * conductivity * area / height


def turning_body_coefficient(
    conductivity: Any, diameter: Any, speed: Any, kinematic_viscosity: Any, prandtl: Any
) -> Any:
    r"""Heat transfer coefficient of a cylinder that turns in a liquid at rest.

    Parameters
    ----------
    conductivity : float or ndarray
        Thermal conductivity of the liquid. [W/(m K)]
    diameter : float or ndarray
        Diameter of the cylinder, for a gear that of its tips. [m]
    speed : float or ndarray
        Angular speed, of either sign. [rad/s]
    kinematic_viscosity : float or ndarray
        Kinematic viscosity of the liquid. [m2/s]
    prandtl : float or ndarray
        Prandtl number of the liquid. [-]

    Returns
    -------
    float or ndarray
        Coefficient, referred to the area that the liquid wets. [W/(m2 K)]

    Notes
    -----
    .. math:: \frac{\alpha d}{k} = 0.133\, Re^{2/3}\, Pr^{1/3}, \qquad
              Re = \frac{\omega d^2}{2 \nu}

    Validity: Re from 1e3 to 1e5 with water; the exponent of the Prandtl number carries it over
    to oils. Tooth spaces are no smooth cylinder: take it for the order of magnitude.

    References
    ----------
    .. [1] K. M. Becker, Measurements of Convective Heat Transfer from a Horizontal Cylinder
       Rotating in a Tank of Water, Int. J. Heat Mass Transfer 6 (1963) 1053-1062.

    Examples
    --------
    A gear of 40 mm at 1500 rpm in oil of 30 cSt:

    >>> round(turning_body_coefficient(0.13, 0.04, 157.0, 30e-6, 400.0), -1)
    830.0
    """
    reynolds = abs(speed) * diameter**2 / (2.0 * kinematic_viscosity)
    nusselt = 0.133 * reynolds ** (2.0 / 3.0) * prandtl ** (1.0 / 3.0)
    return nusselt * conductivity / diameter
