"""Average flow between rough surfaces: pressure, shear and friction factors, contact factor.

All factors are functions of the nominal gap over the combined roughness, ``H = h / sigma``, and
of the surface pattern ``gamma``: correlation length along the flow over that across it. They are
tabulated for seven patterns and interpolated linearly in gamma. Below its range of validity a
factor keeps its value at the limit.

==============================  ===============================================
function                        quantity
==============================  ===============================================
``pattern_columns``             tabulated columns next to a pattern
``pressure_flow_factor``        conductance of the rough over the smooth gap
``shear_flow_factor``           extra flow that a rough moving wall carries
``shear_stress_factor``         mean of 1/gap, for sliding friction
``shear_stress_correction``     change of sliding friction by the pattern
``pressure_stress_factor``      pressure part of the wall shear
``contact_factor``              derivative of the mean gap by the nominal gap
==============================  ===============================================

References
----------
.. [1] N. Patir, H. S. Cheng, An average flow model for determining effects of three-dimensional
   roughness on partial hydrodynamic lubrication, J. Lubr. Technol. 100 (1978) 12-17.
.. [2] N. Patir, H. S. Cheng, Application of average flow model to lubrication between rough
   sliding surfaces, J. Lubr. Technol. 101 (1979) 220-230.
"""

from __future__ import annotations

import math
from typing import NamedTuple

import numpy as np

from toothspace.core.compiled import inlined
from toothspace.core.errors import CaseError
from toothspace.core.types import Array

PATTERNS = np.array([1 / 9, 1 / 6, 1 / 3, 1.0, 3.0, 6.0, 9.0])
"""Patterns of the tables. [-]"""

_PRESSURE = np.array(
    [
        [1.48, 1.38, 1.18, 0.90, 0.225, 0.520, 0.870],
        [0.42, 0.42, 0.42, 0.56, 1.5, 1.5, 1.5],
        [1.0, 1.0, 0.75, 0.5, 0.5, 0.5, 0.5],
        [0.0, 0.0, 0.0, 0.0, 1.0, 1.0, 1.0],  # form of the law
    ]
)
"""C, r, smallest H of [1], table 1 and equation 17."""

_SHEAR = np.array(
    [
        [2.046, 1.962, 1.858, 1.899, 1.560, 1.290, 1.011],
        [1.12, 1.08, 1.01, 0.98, 0.85, 0.62, 0.54],
        [0.78, 0.77, 0.76, 0.92, 1.13, 1.09, 1.07],
        [0.03, 0.03, 0.03, 0.05, 0.08, 0.08, 0.08],
        [1.856, 1.754, 1.561, 1.126, 0.556, 0.388, 0.295],
    ]
)
"""A1, a1, a2, a3, A2 of [2], table 1 and equation 14."""

_STRESS_CORRECTION = np.array(
    [
        [14.1, 13.4, 12.3, 11.1, 9.8, 10.1, 8.7],
        [2.45, 2.42, 2.32, 2.31, 2.25, 2.25, 2.15],
        [2.30, 2.30, 2.30, 2.38, 2.80, 2.90, 2.97],
        [0.10, 0.10, 0.10, 0.11, 0.18, 0.18, 0.18],
    ]
)
"""A3, a4, a5, a6 of [2], table 3."""

_PRESSURE_STRESS = np.array(
    [
        [1.51, 1.51, 1.47, 1.40, 0.98, 0.97, 0.73],
        [0.52, 0.54, 0.58, 0.66, 0.79, 0.91, 0.91],
        [1.0, 1.0, 0.75, 0.75, 0.5, 0.5, 0.5],
    ]
)
"""D, s, smallest H of [2], table 4."""


class PatternColumns(NamedTuple):
    """Columns of all tables on both sides of a pattern, and the weight of the second."""

    pressure: Array  # (2, 4)
    shear: Array  # (2, 5)
    stress_correction: Array  # (2, 4)
    pressure_stress: Array  # (2, 3)
    weight: float


def pattern_columns(pattern: float) -> PatternColumns:
    r"""Pick the tabulated columns between which a pattern lies.

    Parameters
    ----------
    pattern : float
        Correlation length along the flow over that across it, 1/9 to 9. [-]

    Returns
    -------
    PatternColumns
        Coefficients and weight of the linear interpolation. [-]

    Raises
    ------
    CaseError
        If the pattern is outside the tables.

    Notes
    -----
    .. math:: w = \frac{\gamma - \gamma_k}{\gamma_{k+1} - \gamma_k}

    Every factor is linear in gamma between two columns. Validity: patterns of 1/9 to 9.

    References
    ----------
    .. [1] N. Patir, H. S. Cheng, J. Lubr. Technol. 100 (1978) 12-17, table 1.
    .. [2] N. Patir, H. S. Cheng, J. Lubr. Technol. 101 (1979) 220-230, tables 1, 3 and 4.
    """
    if not PATTERNS[0] - 1e-9 <= pattern <= PATTERNS[-1] + 1e-9:
        raise CaseError("roughness.pattern", f"{pattern!r}", "are values from 1/9 to 9")
    first = int(np.clip(np.searchsorted(PATTERNS, pattern) - 1, 0, PATTERNS.size - 2))
    weight = (pattern - PATTERNS[first]) / (PATTERNS[first + 1] - PATTERNS[first])
    tables = (_PRESSURE, _SHEAR, _STRESS_CORRECTION, _PRESSURE_STRESS)
    cut = [np.ascontiguousarray(table[:, first : first + 2].T) for table in tables]
    return PatternColumns(cut[0], cut[1], cut[2], cut[3], float(np.clip(weight, 0.0, 1.0)))


@inlined
def pressure_flow_factor(gap_ratio: float, columns: Array, weight: float) -> tuple[float, float]:
    r"""Conductance of a rough gap over that of the smooth gap of the same nominal height.

    Parameters
    ----------
    gap_ratio : float
        Nominal gap over combined roughness H. [-]
    columns : ndarray
        ``PatternColumns.pressure`` of the flow direction. [-]
    weight : float
        ``PatternColumns.weight``. [-]

    Returns
    -------
    tuple of float
        Factor and its derivative with the gap ratio. [-, -]

    Notes
    -----
    .. math::

        \phi = 1 - C e^{-r H} \ (\gamma \le 1), \qquad \phi = 1 + C H^{-r} \ (\gamma > 1)

    Validity: H above 0.5 to 1 (by pattern); held there below.

    References
    ----------
    .. [1] N. Patir, H. S. Cheng, J. Lubr. Technol. 100 (1978) 12-17, equation 17, table 1.
    """
    value, slope = 0.0, 0.0
    for k in range(2):
        share = weight if k == 1 else 1.0 - weight
        C, r, lowest, form = columns[k, 0], columns[k, 1], columns[k, 2], columns[k, 3]
        H = max(gap_ratio, lowest)
        if form == 0.0:
            term = C * math.exp(-r * H)
            value += share * (1.0 - term)
            change = share * r * term
        else:
            term = C * H ** (-r)
            value += share * (1.0 + term)
            change = -share * r * term / H
        if gap_ratio > lowest:
            slope += change
    return value, slope


@inlined
def shear_flow_factor(gap_ratio: float, columns: Array, weight: float) -> tuple[float, float]:
    r"""Extra flow carried by one rough wall over roughness and half the sliding speed.

    Parameters
    ----------
    gap_ratio : float
        Nominal gap over combined roughness H. [-]
    columns : ndarray
        ``PatternColumns.shear`` of the wall. [-]
    weight : float
        ``PatternColumns.weight``. [-]

    Returns
    -------
    tuple of float
        Factor of this wall and its derivative with the gap ratio. [-, -]

    Notes
    -----
    .. math::

        \Phi_s = A_1 H^{a_1} e^{-a_2 H + a_3 H^2} \ (H \le 5), \qquad A_2 e^{-0.25 H} \ (H > 5)

    Both walls: :math:`\phi_s = (\sigma_1/\sigma)^2 \Phi_s(\gamma_1) - (\sigma_2/\sigma)^2
    \Phi_s(\gamma_2)`. Validity: H above 0.5; the first form is used down to 0.

    References
    ----------
    .. [1] N. Patir, H. S. Cheng, J. Lubr. Technol. 101 (1979) 220-230, equation 14, table 1.
    """
    value, slope = 0.0, 0.0
    H = max(gap_ratio, 1e-3)
    for k in range(2):
        share = weight if k == 1 else 1.0 - weight
        if H > 5.0:
            term = share * columns[k, 4] * math.exp(-0.25 * H)
            value += term
            slope -= 0.25 * term
        else:
            a1, a2, a3 = columns[k, 1], columns[k, 2], columns[k, 3]
            term = share * columns[k, 0] * H**a1 * math.exp(-a2 * H + a3 * H * H)
            value += term
            slope += term * (a1 / H - a2 + 2.0 * a3 * H)
    return value, slope if gap_ratio > 1e-3 else 0.0


@inlined
def shear_stress_factor(gap_ratio: float) -> float:
    r"""Mean of the inverse gap times the roughness, for sliding friction.

    Parameters
    ----------
    gap_ratio : float
        Nominal gap over combined roughness H. [-]

    Returns
    -------
    float
        :math:`\phi_f / H`, so that the mean stress is this times viscosity, sliding speed and
        one over the roughness. [-]

    Notes
    -----
    :math:`\phi_f = h\,E(1/h_T)` with the sixth-order polynomial density of heights within three
    roughnesses, gaps below one hundredth of the roughness excluded; with :math:`z = H/3`,
    :math:`\epsilon = 1/300`

    .. math::

        \phi_f = \frac{35}{32} z \left\{(1-z^2)^3 \ln\frac{z+1}{\epsilon} + \frac{1}{60}\left[-55
        + z(132 + z(345 + z(-160 + z(-405 + z(60 + 147 z)))))\right]\right\}, \ H \le 3

        \phi_f = \frac{35}{32} z \left\{(1-z^2)^3 \ln\frac{z+1}{z-1} + \frac{z}{15}\left[66
        + z^2 (30 z^2 - 80)\right]\right\}, \ H > 3

    Validity: H above 0; held at 0 below.

    References
    ----------
    .. [1] N. Patir, H. S. Cheng, J. Lubr. Technol. 101 (1979) 220-230, equations 31 and 32.
    """
    z = max(gap_ratio, 0.0) / 3.0
    if z > 6.0:
        # the long polynomials cancel; the expansion has 1e-6 of its value left
        inverse = 1.0 / (9.0 * z * z)
        return (1.0 + inverse * (1.0 + 2.454545 * inverse)) / (3.0 * z)
    cube = (1.0 - z * z) ** 3
    if z <= 1.0:
        tail = z * (132.0 + z * (345.0 + z * (-160.0 + z * (-405.0 + z * (60.0 + 147.0 * z)))))
        inner = cube * math.log((z + 1.0) * 300.0) + (tail - 55.0) / 60.0
    else:
        inner = cube * math.log((z + 1.0) / (z - 1.0))
        inner += z / 15.0 * (66.0 + z * z * (30.0 * z * z - 80.0))
    return 35.0 / 96.0 * inner


@inlined
def shear_stress_correction(gap_ratio: float, columns: Array, weight: float) -> float:
    r"""Change of sliding friction by the pattern of one rough wall.

    Parameters
    ----------
    gap_ratio : float
        Nominal gap over combined roughness H. [-]
    columns : ndarray
        ``PatternColumns.stress_correction`` of the wall. [-]
    weight : float
        ``PatternColumns.weight``. [-]

    Returns
    -------
    float
        Change of the friction factor. [-]

    Notes
    -----
    .. math:: \Phi_{fs} = A_3 H^{a_4} e^{-a_5 H + a_6 H^2}

    Both walls as in :func:`shear_flow_factor`. Validity: H above 0.5; used down to 0, zero from
    H = 7.

    References
    ----------
    .. [1] N. Patir, H. S. Cheng, J. Lubr. Technol. 101 (1979) 220-230, table 3.
    """
    H = max(gap_ratio, 0.0)
    if H >= 7.0:
        return 0.0
    value = 0.0
    for k in range(2):
        share = weight if k == 1 else 1.0 - weight
        power = H ** columns[k, 1]
        value += share * columns[k, 0] * power * math.exp(H * (columns[k, 3] * H - columns[k, 2]))
    return value


@inlined
def pressure_stress_factor(gap_ratio: float, columns: Array, weight: float) -> float:
    r"""Pressure part of the mean wall shear over that of the smooth gap.

    Parameters
    ----------
    gap_ratio : float
        Nominal gap over combined roughness H. [-]
    columns : ndarray
        ``PatternColumns.pressure_stress`` of the direction. [-]
    weight : float
        ``PatternColumns.weight``. [-]

    Returns
    -------
    float
        Factor on the pressure part of the shear. [-]

    Notes
    -----
    .. math:: \phi_{fp} = 1 - D e^{-s H}

    Validity: H above 0.5 to 1 (by pattern); held there below.

    References
    ----------
    .. [1] N. Patir, H. S. Cheng, J. Lubr. Technol. 101 (1979) 220-230, table 4.
    """
    value = 0.0
    for k in range(2):
        share = weight if k == 1 else 1.0 - weight
        H = max(gap_ratio, columns[k, 2])
        value += share * (1.0 - columns[k, 0] * math.exp(-columns[k, 1] * H))
    return value


@inlined
def contact_factor(gap_ratio: float) -> float:
    r"""Derivative of the mean gap by the nominal gap of Gaussian surfaces.

    Parameters
    ----------
    gap_ratio : float
        Nominal gap over combined roughness H. [-]

    Returns
    -------
    float
        Part of the nominal area that is not in contact. [-]

    Notes
    -----
    .. math:: \phi_c = \tfrac12 \left[1 + \mathrm{erf}(H/\sqrt2)\right]

    the exact form of the fit of [1]_. Validity: Gaussian heights.

    References
    ----------
    .. [1] C. Wu, L. Zheng, An average Reynolds equation for partial film lubrication with a
       contact factor, J. Tribol. 111 (1989) 188-191.
    """
    return 0.5 * math.erfc(-gap_ratio / math.sqrt(2.0))


@inlined
def contact_factor_slope(gap_ratio: float) -> float:
    r"""Derivative of :func:`contact_factor` by the gap ratio.

    Parameters
    ----------
    gap_ratio : float
        Nominal gap over combined roughness H. [-]

    Returns
    -------
    float
        Density of the Gaussian heights at the nominal gap. [-]

    Notes
    -----
    .. math:: \varphi(H) = e^{-H^2/2} / \sqrt{2\pi}

    Validity: Gaussian heights.

    References
    ----------
    .. [1] C. Wu, L. Zheng, An average Reynolds equation for partial film lubrication with a
       contact factor, J. Tribol. 111 (1989) 188-191.
    """
    return math.exp(-0.5 * gap_ratio * gap_ratio) / math.sqrt(2.0 * math.pi)
