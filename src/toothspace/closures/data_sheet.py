"""What a data sheet leaves unsaid: viscosity by its index, and its rise with pressure."""

from __future__ import annotations

import math

from toothspace.numerics.roots import root_between

_LEAST, _MOST = 2.0, 70.0
"""Viscosities at 100 degC between which the index is defined by the polynomials. [cSt]"""
_RANGES = (
    (3.8, (1.14673, 1.7576, -0.109), (0.84155, 1.5521, -0.077)),
    (4.4, (3.38095, -15.4952, 33.196), (0.78571, 1.7929, -0.183)),
    (5.0, (2.5000, -7.2143, 13.812), (0.82143, 1.5679, 0.119)),
    (6.4, (0.10100, 16.6350, -45.469), (0.04985, 9.1613, -18.557)),
    (7.0, (3.35714, -23.5643, 78.466), (0.22619, 7.7369, -16.656)),
    (7.7, (0.01191, 21.4750, -72.870), (0.79762, -0.7321, 14.610)),
    (9.0, (0.41858, 16.1558, -56.040), (0.05794, 10.5156, -28.240)),
    (12.0, (0.88779, 7.5527, -16.600), (0.26665, 6.7015, -10.810)),
    (15.0, (0.76720, 10.7972, -38.180), (0.20073, 8.4658, -22.490)),
    (18.0, (0.97305, 5.3135, -2.200), (0.28889, 5.9741, -4.930)),
    (22.0, (0.97256, 5.2500, -0.980), (0.24504, 7.4160, -16.730)),
    (28.0, (0.91413, 7.4759, -21.820), (0.20323, 9.1267, -34.230)),
    (40.0, (0.87031, 9.7157, -50.770), (0.18411, 10.1015, -46.750)),
    (55.0, (0.84703, 12.6752, -133.310), (0.17029, 11.4866, -80.620)),
    (_MOST, (0.85921, 11.1009, -83.190), (0.17130, 11.3680, -76.940)),
)  # fmt: skip
"""Upper end [cSt], and coefficients of L and H over the viscosity at 100 degC."""


def viscosity_index(at_40_degC: float, at_100_degC: float) -> float:
    r"""Viscosity index of an oil.

    Parameters
    ----------
    at_40_degC, at_100_degC : float
        Kinematic viscosities. [m2/s]

    Returns
    -------
    float
        Index. [-]

    Notes
    -----
    With :math:`U` and :math:`Y` the viscosities at 40 and 100 degC in cSt, and :math:`L(Y)`,
    :math:`H(Y)` those at 40 degC of oils of index 0 and 100,

    .. math:: VI = 100 \frac{L - U}{L - H} \;(U \ge H), \qquad
        VI = 100 + \frac{10^N - 1}{0.00715}, \quad N = \frac{\log_{10} (H/U)}{\log_{10} Y}

    Validity: 2 to 70 cSt at 100 degC.

    References
    ----------
    .. [1] ASTM D2270, *Calculating Viscosity Index from Kinematic Viscosity at 40 degC and
       100 degC*, procedures A and B (ISO 2909).

    Examples
    --------
    >>> round(viscosity_index(73.30e-6, 8.86e-6)), round(viscosity_index(22.83e-6, 5.05e-6))
    (92, 156)
    """
    at_40, at_100 = 1e6 * at_40_degC, 1e6 * at_100_degC
    low, high = next((low, high) for end, low, high in _RANGES if at_100 <= end)
    poor, good = ((a * at_100 + b) * at_100 + c for a, b, c in (low, high))
    if at_40 >= good:
        return 100.0 * (poor - at_40) / (poor - good)
    exponent = math.log10(good / at_40) / math.log10(at_100)
    return float(100.0 + (10.0**exponent - 1.0) / 0.00715)


def viscosity_at_100(at_40_degC: float, index: float) -> float:
    r"""Kinematic viscosity at 100 degC of an oil of a viscosity index.

    Parameters
    ----------
    at_40_degC : float
        Kinematic viscosity at 40 degC. [m2/s]
    index : float
        Viscosity index. [-]

    Returns
    -------
    float
        Kinematic viscosity at 100 degC, NaN where the index has none. [m2/s]

    Notes
    -----
    .. math:: VI(\nu_{40}, \nu_{100}) = VI

    solved for :math:`\nu_{100}`. Validity: as :func:`viscosity_index`.

    References
    ----------
    .. [1] ASTM D2270, *Calculating Viscosity Index from Kinematic Viscosity at 40 degC and
       100 degC*.

    Examples
    --------
    >>> round(1e6 * viscosity_at_100(46e-6, 100.0), 2)
    6.78
    """

    def missing(at_100: float) -> float:
        return viscosity_index(at_40_degC, 1e-6 * at_100) - index

    highest = min(_MOST, 0.9e6 * at_40_degC)
    if highest <= _LEAST or missing(_LEAST) > 0.0 or missing(highest) < 0.0:
        return math.nan
    return 1e-6 * root_between(missing, _LEAST, highest)


def pressure_viscosity(dynamic_viscosity: float) -> float:
    r"""Barus coefficient of a mineral oil from its viscosity.

    Parameters
    ----------
    dynamic_viscosity : float
        At atmospheric pressure and the temperature in question. [Pa s]

    Returns
    -------
    float
        Coefficient. [1/Pa]

    Notes
    -----
    .. math:: \alpha = (0.6 + 0.965 \log_{10} \eta_{cP}) \cdot 10^{-8}

    Validity: an estimate for mineral oils of 2 to 1000 mPa s, within some 20 %.

    References
    ----------
    .. [1] G. W. Stachowiak, A. W. Batchelor, *Engineering Tribology*, Butterworth-Heinemann,
       chapter 2 (relation of Wooster).

    Examples
    --------
    >>> round(1e8 * pressure_viscosity(0.04), 3)
    2.146
    """
    return 1e-8 * (0.6 + 0.965 * math.log10(1e3 * dynamic_viscosity))
