"""Closed forms of the plain journal bearing that the package does not run."""

from __future__ import annotations

import numpy as np


def short_bearing_force(eccentricity_ratio: float, slenderness: float) -> tuple[float, float]:
    """Steady force of a short bearing with half film (Ocvirk) over mu omega R L (R/c)^2.

    Against the eccentricity, and across it in the sense of rotation.
    G. B. DuBois, F. W. Ocvirk, NACA Report 1157, 1953.
    """
    rest = 1.0 - eccentricity_ratio**2
    factor = slenderness**2 / rest**2
    along = 4.0 * eccentricity_ratio**2 * factor
    return along, np.pi * eccentricity_ratio * np.sqrt(rest) * factor


def short_bearing_dynamic_force(x: float, y: float, vx: float, vy: float) -> tuple[float, float]:
    """Force on a moving journal of a short bearing with half film (Capone).

    Over mu omega R L (R/c)^2 (L/D)^2. Arguments: eccentricity over clearance, and its
    derivative over the angle turned by the journal.
    G. Capone, "Descrizione analitica del campo di forze fluidodinamico nei cuscinetti cilindrici
    lubrificati", L'Energia Elettrica 3, 1991, 105-110.
    """
    across, along = y + 2.0 * vx, x - 2.0 * vy
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


def friction_number(sommerfeld: float, eccentricity_ratio: float, attitude_angle: float) -> float:
    """Friction coefficient of a fully sheared film times radius over clearance.

    A. A. Raimondi, J. Boyd, Trans. ASLE 1, 1958, 159-209.
    """
    viscous = 2.0 * np.pi**2 * sommerfeld / np.sqrt(1.0 - eccentricity_ratio**2)
    return viscous + 0.5 * eccentricity_ratio * np.sin(attitude_angle)
