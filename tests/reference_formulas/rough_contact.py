"""Published fits of mixed lubrication."""

from __future__ import annotations

import numpy as np


def contact_factor_fit(gap_ratio: float) -> float:
    """Contact factor of Gaussian surfaces.

    C. Wu, L. Zheng, J. Tribol. 111 (1989) 188-191.
    """
    H = gap_ratio
    if H >= 3.0:
        return 1.0
    return float(np.exp(-0.6912 + H * (0.782 + H * (-0.304 + 0.0401 * H))))


def pan_hamrock_film(
    mean_speed_number: float, material_number: float, load_number: float
) -> tuple[float, float]:
    """Smallest and central film of a line contact over the relative radius.

    P. Pan, B. J. Hamrock, "Simple formulas for performance parameters used in
    elastohydrodynamically lubricated line contacts", J. Tribology 111, 1989.
    """
    minimum = 1.714 * mean_speed_number**0.694 * material_number**0.568 / load_number**0.128
    central = 2.922 * mean_speed_number**0.692 * material_number**0.470 / load_number**0.166
    return minimum, central
