"""Plain journal bearing without a grid: load and friction.

Angles are counted from the widest gap. The compiled right-hand side reads the force from
:mod:`toothspace.closures.bearing_map`, built from the same pressure.
"""

from __future__ import annotations

from typing import Any, NamedTuple

import numpy as np

from toothspace.core.compiled import inlined

_ANGLES = (np.arange(128) + 0.5) * (2.0 * np.pi / 128)
_AXIAL = np.polynomial.legendre.leggauss(12)


class JournalSize(NamedTuple):
    """Size of one plain journal bearing."""

    radius: float
    """Radius of the journal. [m]"""
    length: float
    """Axial length. [m]"""
    radial_clearance: float
    """Radius of the bush minus radius of the journal. [m]"""


def finite_bearing_force(
    eccentricity_ratio: float,
    wedge_speed: float,
    squeeze_rate: float,
    dynamic_viscosity: float,
    size: JournalSize,
    from_widest_gap: bool = False,
) -> tuple[float, float]:
    r"""Film force of a finite plain bearing, rotation and squeeze included.

    Parameters
    ----------
    eccentricity_ratio : float
        Eccentricity over radial clearance, below 1. [-]
    wedge_speed : float
        Speed of the journal minus twice that of the line of centres. [rad/s]
    squeeze_rate : float
        Rate of change of the eccentricity ratio. [1/s]
    dynamic_viscosity : float
        Dynamic viscosity. [Pa s]
    size : JournalSize
        Size of the bearing. [SI]
    from_widest_gap : bool
        Whether the long film starts at the widest gap, as from a supply groove there. Without
        it the squeeze film is closer to the Reynolds equation. [-]

    Returns
    -------
    restoring_force : float
        Force on the journal against the eccentricity. [N]
    cross_force : float
        Force on the journal across the eccentricity, in the sense of rotation. [N]

    Notes
    -----
    Harmonic sum :math:`p = 6\mu (R/c)^2 p_s p_l / (p_s + p_l)` where both are positive, of

    .. math:: p_s &= \tfrac12 (L/D)^2 (1 - y^2)
        [A \varepsilon \sin\vartheta - 2 B \cos\vartheta] / h^3 \\
        p_l &= \frac{A \varepsilon (2 + \varepsilon\cos\vartheta) \sin\vartheta}
        {(2 + \varepsilon^2) h^2} + \frac{B}{\varepsilon} \left(\frac{1}{h^2} - C\right)

    with h = 1 + eps cos, wedge speed A, squeeze rate B and C = 1, or 1/(1 + eps)^2 from the
    widest gap. Quadrature with 128 angles and 12 axial points.

    Accuracy against the Reynolds equation, steady: load within 1 % (L/D = 1/4), 3 % (1/2),
    6 % (1) up to an eccentricity ratio of 0.9, 14 % at L/D = 2.
    """
    eps = max(eccentricity_ratio, 1e-6)
    radius, length, clearance = size
    sin, cos = np.sin(_ANGLES), np.cos(_ANGLES)
    h = 1.0 + eps * cos
    axial, weights = _AXIAL
    slenderness = 0.5 * length / radius
    wedge, squeeze = wedge_speed * eps, squeeze_rate
    short = (wedge * sin - 2.0 * squeeze * cos) / h**3
    short = 0.5 * slenderness**2 * np.outer(short, 1.0 - axial**2)
    start = 1.0 / (1.0 + eps) ** 2 if from_widest_gap else 1.0
    long = wedge * (2.0 + eps * cos) * sin / ((2.0 + eps**2) * h**2)
    long = (long + squeeze / eps * (1.0 / h**2 - start))[:, None]
    film = (short > 0.0) & (long > 0.0)
    total = np.where(film, short + long, 1.0)
    line = np.where(film, short * long / total, 0.0) @ weights
    scale = 6.0 * dynamic_viscosity * (radius / clearance) ** 2 * radius * 0.5 * length
    scale *= 2.0 * np.pi / _ANGLES.size
    return float(-scale * (line @ cos)), float(scale * (line @ sin))


@inlined
def short_bearing_force(eccentricity_ratio: Any, slenderness: Any) -> Any:
    r"""Dimensionless steady force of a short bearing with half film (Ocvirk).

    Parameters
    ----------
    eccentricity_ratio : float or ndarray
        Eccentricity over radial clearance. [-]
    slenderness : float or ndarray
        Length over diameter. [-]

    Returns
    -------
    restoring_force : float or ndarray
        Force against the eccentricity over mu omega R L (R/c)^2. [-]
    cross_force : float or ndarray
        Force across it over mu omega R L (R/c)^2. [-]

    Notes
    -----
    .. math:: F_r = \frac{4 \varepsilon^2}{(1-\varepsilon^2)^2} (L/D)^2, \qquad
        F_t = \frac{\pi \varepsilon}{(1-\varepsilon^2)^{3/2}} (L/D)^2

    Validity: L/D up to 1/4, eccentricity ratio below 0.7.

    References
    ----------
    .. [1] G. B. DuBois, F. W. Ocvirk, NACA Report 1157, 1953.
    """
    rest = 1.0 - eccentricity_ratio * eccentricity_ratio
    factor = slenderness * slenderness / (rest * rest)
    restoring = 4.0 * eccentricity_ratio * eccentricity_ratio * factor
    return restoring, np.pi * eccentricity_ratio * np.sqrt(rest) * factor


def short_bearing_dynamic_force(x: float, y: float, vx: float, vy: float) -> tuple[float, float]:
    r"""Dimensionless force of a short bearing with half film in motion (Capone).

    Parameters
    ----------
    x, y : float
        Eccentricity over radial clearance. [-]
    vx, vy : float
        Its derivative over the angle turned by the journal. [-]

    Returns
    -------
    force_x, force_y : float
        Force on the journal over mu omega R L (R/c)^2 (L/D)^2. [-]

    References
    ----------
    .. [1] G. Capone, "Descrizione analitica del campo di forze fluidodinamico nei cuscinetti
       cilindrici lubrificati", L'Energia Elettrica 3, 1991, 105-110.
    """
    across, along = y + 2.0 * vx, x - 2.0 * vy
    # Direction of the largest pressure: against the motion in the half-speed frame.
    alpha = np.arctan2(-across, -along)
    sin, cos = np.sin(alpha), np.cos(alpha)
    rest = 1.0 - x * x - y * y
    lateral, axial = y * cos - x * sin, x * cos + y * sin
    g = 2.0 / np.sqrt(rest) * (0.5 * np.pi + np.arctan(lateral / np.sqrt(rest)))
    v = (2.0 + lateral * g) / rest
    f = axial / (1.0 - axial * axial)
    scale = -np.hypot(across, along) / rest
    force_x = scale * (3.0 * x * v - g * sin - 2.0 * f * cos)
    force_y = scale * (3.0 * y * v + g * cos - 2.0 * f * sin)
    return float(force_x), float(force_y)


@inlined
def sommerfeld_number(
    shaft_speed: Any, load: Any, dynamic_viscosity: Any, size: JournalSize
) -> Any:
    r"""Sommerfeld number of a plain bearing (Anglo-American definition).

    Parameters
    ----------
    shaft_speed : float or ndarray
        Angular speed. [rad/s]
    load : float or ndarray
        Radial load. [N]
    dynamic_viscosity : float or ndarray
        Dynamic viscosity. [Pa s]
    size : JournalSize
        Size of the bearing. [SI]

    Returns
    -------
    float or ndarray
        Sommerfeld number. [-]

    Notes
    -----
    .. math:: S = \frac{\mu N}{P} \left(\frac{R}{c}\right)^2, \quad
        N = \frac{\omega}{2\pi}, \quad P = \frac{W}{2 R L}
    """
    ratio = size.radius / size.radial_clearance
    area = 2.0 * size.radius * size.length
    return dynamic_viscosity * shaft_speed / (2.0 * np.pi) * area / load * ratio * ratio


@inlined
def bearing_friction_number(sommerfeld: Any, eccentricity_ratio: Any, attitude_angle: Any) -> Any:
    r"""Friction coefficient of a full bearing times radius over clearance.

    Parameters
    ----------
    sommerfeld : float or ndarray
        Sommerfeld number of :func:`sommerfeld_number`. [-]
    eccentricity_ratio : float or ndarray
        Eccentricity over radial clearance. [-]
    attitude_angle : float or ndarray
        Angle from the load to the eccentricity. [rad]

    Returns
    -------
    float or ndarray
        Friction number f R / c. [-]

    Notes
    -----
    .. math:: f R / c = \frac{2 \pi^2 S}{\sqrt{1 - \varepsilon^2}}
        + \tfrac12 \varepsilon \sin\varphi

    The whole circumference is sheared, as in the tables of Raimondi and Boyd (1958). For a
    centred journal it is Petroff's law.
    """
    viscous = 2.0 * np.pi**2 * sommerfeld / np.sqrt(1.0 - eccentricity_ratio**2)
    return viscous + 0.5 * eccentricity_ratio * np.sin(attitude_angle)


@inlined
def petroff_torque(shaft_speed: Any, dynamic_viscosity: Any, size: JournalSize) -> Any:
    r"""Viscous torque of a centred journal.

    Parameters
    ----------
    shaft_speed : float or ndarray
        Angular speed. [rad/s]
    dynamic_viscosity : float or ndarray
        Dynamic viscosity. [Pa s]
    size : JournalSize
        Size of the bearing. [SI]

    Returns
    -------
    float or ndarray
        Torque that opposes the rotation, sign of the speed. [N m]

    Notes
    -----
    .. math:: M = 2 \pi \mu \omega R^3 L / c
    """
    volume = 2.0 * np.pi * size.radius**3 * size.length / size.radial_clearance
    return dynamic_viscosity * shaft_speed * volume


@inlined
def journal_friction_torque(
    ex: Any, ey: Any, force_x: Any, force_y: Any, viscous_torque: Any, radial_clearance: Any
) -> Any:
    r"""Torque of the film on a journal, against its rotation.

    Parameters
    ----------
    ex, ey : float or ndarray
        Eccentricity of the journal in its bush. [m]
    force_x, force_y : float or ndarray
        Force of the film on the journal. [N]
    viscous_torque : float or ndarray
        Torque of the centred journal, :func:`petroff_torque`. [N m]
    radial_clearance : float or ndarray
        Radius of the bush minus radius of the journal. [m]

    Returns
    -------
    float or ndarray
        Torque, positive where it opposes a positive rotation. [N m]

    Notes
    -----
    .. math:: M = \frac{M_{Petroff}}{\sqrt{1 - \varepsilon^2}} + \tfrac12 (e \times F)_z

    the second term being the exact integral of the pressure gradient's shear. The
    eccentricity ratio is held at 0.999.
    """
    ratio = np.minimum((ex * ex + ey * ey) / radial_clearance**2, 0.998)
    return viscous_torque / np.sqrt(1.0 - ratio) + 0.5 * (ex * force_y - ey * force_x)
