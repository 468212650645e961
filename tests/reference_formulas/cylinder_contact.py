"""Line contact of cylinders as K. L. Johnson, Contact Mechanics, 1985, gives it."""

from __future__ import annotations

import numpy as np
from scipy.optimize import brentq


def hertz_half_width(
    line_load: np.ndarray, relative_radius: float, contact_modulus: float
) -> np.ndarray:
    """Half width of the contact, section 4.2. [m]."""
    return np.sqrt(4.0 * line_load * relative_radius / (np.pi * contact_modulus))


def hertz_approach(
    line_load: float, radius_a: float, radius_b: float, contact_modulus: float
) -> float:
    """Approach of points as deep below the surfaces as the radii, section 5.6. [m]."""
    relative = radius_a * radius_b / (radius_a + radius_b)
    width = hertz_half_width(line_load, relative, contact_modulus)
    depth = np.log(16.0 * abs(radius_a * radius_b) / width**2)
    return float(line_load / (np.pi * contact_modulus) * (depth - 1.0))


def johnson_indentation(
    line_load: float, radius_difference: float, contact_modulus: float
) -> float:
    """Indentation of cylinders; grows with loads below 4 pi E* dR / e2. [m]."""
    scale = np.pi * contact_modulus
    return float(line_load / scale * (np.log(4.0 * scale * radius_difference / line_load) - 1.0))


def johnson_line_load(
    indentation: float, radius_difference: float, contact_modulus: float
) -> float:
    """Load of :func:`johnson_indentation`, found by bisection. [N/m]."""
    highest = 4.0 * np.pi * contact_modulus * radius_difference * np.exp(-2.0)
    found = brentq(
        lambda load: johnson_indentation(load, radius_difference, contact_modulus) - indentation,
        1e-12 * highest,
        highest,
        xtol=1e-9,
        rtol=1e-13,
    )
    return float(found)
