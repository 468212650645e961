"""Sound: radiation of simple bodies, bending waves of plates, A-weighting, third octaves."""

from __future__ import annotations

import math
from typing import Any

import numpy as np
from scipy import special

from toothspace.core.types import Array, ComplexArray

AIR_DENSITY, SOUND_SPEED = 1.204, 343.2
"""Of air at 20 degC and one atmosphere. [kg/m3], [m/s]"""
REFERENCE_POWER = 1e-12
"""Reference of sound power levels. [W]"""
BAND_NUMBERS = np.arange(-10, 11)
"""Third octaves of 100 Hz to 10 kHz, counted from that of 1 kHz. [-]"""
_POLES = (20.60, 107.7, 737.9, 12194.0)
_REFERENCE_FREQUENCY = 1000.0
_LARGEST_PLATE_EFFICIENCY = 2.0


def a_weighting(frequency: Array) -> Array:
    r"""A-weighting of a pure tone.

    Parameters
    ----------
    frequency : ndarray
        Frequency, above zero. [Hz]

    Returns
    -------
    ndarray
        What is added to a level, zero at 1 kHz. [dB]

    Notes
    -----
    .. math:: R = \frac{f_4^2 f^4}{(f^2 + f_1^2) \sqrt{(f^2 + f_2^2)(f^2 + f_3^2)}
              (f^2 + f_4^2)}, \qquad A = 20 \lg \frac{R(f)}{R(1\,\mathrm{kHz})}

    with poles at 20.60, 107.7, 737.9 and 12194 Hz. Validity: 10 Hz to 20 kHz.

    References
    ----------
    .. [1] IEC 61672-1, *Electroacoustics - Sound level meters - Part 1: Specifications*.
    """

    def response(hertz: Array) -> Array:
        f1, f2, f3, f4 = (pole**2 for pole in _POLES)
        square = np.asarray(hertz, dtype=float) ** 2
        low = (square + f1) * np.sqrt((square + f2) * (square + f3))
        return np.asarray(f4 * square**2 / (low * (square + f4)))

    return 20.0 * np.log10(response(frequency) / response(np.array(_REFERENCE_FREQUENCY)))


def third_octave_sums(frequency: Array, power: Array) -> Array:
    r"""Sum the powers of tones in the third octaves of 100 Hz to 10 kHz.

    Parameters
    ----------
    frequency : ndarray, shape (tones,)
        Frequencies. [Hz]
    power : ndarray, shape (..., tones)
        Powers; those outside the bands are left out. [W]

    Returns
    -------
    ndarray
        Power in each of the bands :data:`BAND_NUMBERS`, the last axis. [W]

    Notes
    -----
    .. math:: f_n = 1000 \cdot 10^{n/10}\,\mathrm{Hz}, \qquad
              f_n 10^{-1/20} \le f < f_n 10^{1/20}

    Validity: tones. A tone near an edge lies in one band only, where a filter shares it.

    References
    ----------
    .. [1] IEC 61260-1, *Electroacoustics - Octave-band and fractional-octave-band filters*, base
       ten.
    """
    place = np.floor(10.0 * np.log10(frequency / _REFERENCE_FREQUENCY) + 0.5)
    inside = place[:, None] == BAND_NUMBERS
    return np.asarray(power @ inside.astype(float))


def sound_power_level(power: Any) -> Any:
    r"""Level of a sound power.

    Parameters
    ----------
    power : float or ndarray
        Sound power. [W]

    Returns
    -------
    float or ndarray
        Sound power level, NaN without power. [dB]

    Notes
    -----
    .. math:: L_W = 10 \lg \frac{W}{1\,\mathrm{pW}}

    Validity: everywhere.

    References
    ----------
    .. [1] ISO 4412-1, *Hydraulic fluid power - Test code for determination of airborne noise
       levels - Part 1: Pumps*: its sound power level.
    """
    given = np.asarray(power, dtype=float)
    known = np.where(given > 0.0, given, np.nan)
    return 10.0 * np.log10(known / REFERENCE_POWER)


def radiated_power(efficiency: Any, area: float, square_velocity: Any) -> Any:
    r"""Sound power of a vibrating surface.

    Parameters
    ----------
    efficiency : float or ndarray
        Radiation efficiency. [-]
    area : float
        Area of the surface. [m2]
    square_velocity : float or ndarray
        Square of the normal velocity, mean over the surface and time. [m2/s2]

    Returns
    -------
    float or ndarray
        Sound power into air. [W]

    Notes
    -----
    .. math:: W = \rho_0 c_0 S \sigma \overline{v^2}

    which defines the radiation efficiency. Validity: air at 20 degC.

    References
    ----------
    .. [1] L. Cremer, M. Heckl, B. A. T. Petersson, *Structure-Borne Sound*, 3rd ed., Springer,
       2005.
    """
    return AIR_DENSITY * SOUND_SPEED * area * efficiency * square_velocity


def sphere_radiation_efficiency(degree: int, wave_number: Any, radius: float) -> Any:
    r"""Radiation efficiency of a sphere whose normal velocity is a Legendre polynomial.

    Parameters
    ----------
    degree : int
        Degree of the polynomial: 0 pulsates (monopole), 1 moves to and fro as a rigid body
        (dipole), 2 stretches without change of volume (quadrupole). [-]
    wave_number : float or ndarray
        Wave number of sound in air, above zero. [1/m]
    radius : float
        Radius of the sphere. [m]

    Returns
    -------
    float or ndarray
        Radiation efficiency, that of a rigid sphere of its normal velocity, whose mean square is
        a third of that of the sphere. [-]

    Notes
    -----
    With the derivative of the spherical Hankel function :math:`h_n`,

    .. math:: \sigma_n = \frac{1}{(ka)^2 |h_n'(ka)|^2}: \qquad
              \sigma_0 = \frac{(ka)^2}{1 + (ka)^2}, \quad
              \sigma_1 = \frac{(ka)^4}{4 + (ka)^4}

    Validity: exact for a sphere in free air.

    References
    ----------
    .. [1] F. Fahy, P. Gardonio, *Sound and Structural Vibration*, 2nd ed., Academic Press, 2007.
    """
    x = np.asarray(wave_number * radius, dtype=float)
    real = special.spherical_jn(degree, x, derivative=True)
    imaginary = special.spherical_yn(degree, x, derivative=True)
    return 1.0 / (x**2 * (real**2 + imaginary**2))


def plate_bending_stiffness(youngs_modulus: float, poisson_ratio: float, thickness: float) -> float:
    r"""Bending stiffness of a plate per width.

    Parameters
    ----------
    youngs_modulus : float
        Young's modulus. [Pa]
    poisson_ratio : float
        Poisson's ratio. [-]
    thickness : float
        Thickness. [m]

    Returns
    -------
    float
        Bending stiffness. [N m]

    Notes
    -----
    .. math:: B = \frac{E h^3}{12 (1 - \nu^2)}

    Validity: thin plate, bending waves longer than six thicknesses.

    References
    ----------
    .. [1] L. Cremer, M. Heckl, B. A. T. Petersson, *Structure-Borne Sound*, 3rd ed., Springer,
       2005.
    """
    return youngs_modulus * thickness**3 / (12.0 * (1.0 - poisson_ratio**2))


def plate_critical_frequency(bending_stiffness: float, mass_per_area: float) -> float:
    r"""Frequency at which bending waves of a plate are as fast as sound in air.

    Parameters
    ----------
    bending_stiffness : float
        Bending stiffness per width. [N m]
    mass_per_area : float
        Mass per area. [kg/m2]

    Returns
    -------
    float
        Critical frequency. [Hz]

    Notes
    -----
    .. math:: f_c = \frac{c_0^2}{2\pi} \sqrt{\frac{m''}{B}}

    Validity: thin plate in air of 20 degC. A steel plate of 10 mm has about 1.2 kHz.

    References
    ----------
    .. [1] L. Cremer, M. Heckl, B. A. T. Petersson, *Structure-Borne Sound*, 3rd ed., Springer,
       2005.
    """
    return SOUND_SPEED**2 / (2.0 * math.pi) * math.sqrt(mass_per_area / bending_stiffness)


def plate_radiation_efficiency(
    frequency: Array, critical_frequency: float, length: float, width: float
) -> Array:
    r"""Radiation efficiency of free bending waves of a plate in a baffle, mean over its modes.

    Parameters
    ----------
    frequency : ndarray
        Frequencies. [Hz]
    critical_frequency : float
        Critical frequency of the plate. [Hz]
    length, width : float
        Sides of the plate. [m]

    Returns
    -------
    ndarray
        Radiation efficiency, 0 to 2. [-]

    Notes
    -----
    With :math:`\lambda = \sqrt{f/f_c}`, sides :math:`l_1, l_2` and the first mode
    :math:`f_{11} = c_0^2 (l_1^{-2} + l_2^{-2})/(4 f_c)`,

    .. math::

        \sigma_1 = \frac{1}{\sqrt{1 - f_c/f}}, \quad
        \sigma_2 = 4 l_1 l_2 \left(\frac{f}{c_0}\right)^2, \quad
        \sigma_3 = \sqrt{\frac{2\pi f (l_1 + l_2)}{16 c_0}}

        \sigma_4 = \frac{2 (l_1 + l_2)}{l_1 l_2} \frac{c_0}{f_c} \delta_1 + \delta_2, \quad
        \delta_1 = \frac{(1 - \lambda^2) \ln\frac{1 + \lambda}{1 - \lambda} + 2\lambda}
            {4 \pi^2 (1 - \lambda^2)^{3/2}}, \quad
        \delta_2 = \frac{8 c_0^2 (1 - 2\lambda^2)}
            {f_c^2 \pi^4 l_1 l_2 \lambda \sqrt{1 - \lambda^2}}

    (:math:`\delta_2` up to half the critical frequency). Of a plate with
    :math:`f_{11} \le f_c/2`: :math:`\sigma_1` above, :math:`\sigma_4` below the critical
    frequency, below :math:`f_{11}` no more than :math:`\sigma_2`. Of a smaller one:
    :math:`\sigma_3`, no more than :math:`\sigma_2` below and :math:`\sigma_1` above. Two at most.

    Validity: simply supported plate in a baffle, one side radiating, many modes in a band.

    References
    ----------
    .. [1] EN 12354-1:2000, *Building acoustics - Estimation of acoustic performance of buildings
       from the performance of elements - Part 1*: its radiation factor for free waves.
    .. [2] G. Maidanik, Response of ribbed panels to reverberant acoustic fields, J. Acoust. Soc.
       Am. 34 (1962) 809-826.
    """
    f, fc, area = np.asarray(frequency, dtype=float), critical_frequency, length * width
    above, around = f > fc, np.abs(f / fc - 1.0) < 1e-9
    ratio = np.where(above | around, 0.5, f / fc)
    root = np.sqrt(ratio)
    edge = (1.0 - ratio) * np.log((1.0 + root) / (1.0 - root)) + 2.0 * root
    edge = edge / (4.0 * math.pi**2 * (1.0 - ratio) ** 1.5)
    corner = 8.0 * SOUND_SPEED**2 * np.maximum(1.0 - 2.0 * ratio, 0.0)
    corner = corner / (fc**2 * math.pi**4 * area * root * np.sqrt(1.0 - ratio))
    first = np.where(above & ~around, 1.0, np.inf)
    first[above] /= np.sqrt(np.maximum(1.0 - fc / f[above], 1e-12))
    second = 4.0 * area * (f / SOUND_SPEED) ** 2
    third = np.sqrt(2.0 * math.pi * f * (length + width) / (16.0 * SOUND_SPEED))
    fourth = 2.0 * (length + width) / area * SOUND_SPEED / fc * edge + corner
    fourth = np.where(around, np.inf, fourth)
    lowest = SOUND_SPEED**2 / (4.0 * fc) * (length**-2 + width**-2)
    if lowest <= 0.5 * fc:
        below = np.where(f < lowest, np.minimum(fourth, second), fourth)
        found = np.where(above, first, below)
    else:
        found = np.minimum(third, np.where(above, first, second))
    return np.minimum(found, _LARGEST_PLATE_EFFICIENCY)


def plate_point_mobility(bending_stiffness: float, mass_per_area: float) -> float:
    r"""Velocity over force at a point of an infinite plate.

    Parameters
    ----------
    bending_stiffness : float
        Bending stiffness per width. [N m]
    mass_per_area : float
        Mass per area. [kg/m2]

    Returns
    -------
    float
        Mobility, real. [m/(N s)]

    Notes
    -----
    .. math:: Y_0 = \frac{1}{8 \sqrt{B m''}}

    Validity: thin plate; the mean over frequency of a finite one.

    References
    ----------
    .. [1] L. Cremer, M. Heckl, B. A. T. Petersson, *Structure-Borne Sound*, 3rd ed., Springer,
       2005.
    """
    return 1.0 / (8.0 * math.sqrt(bending_stiffness * mass_per_area))


def plate_transfer_ratio(bending_wave_number: Array, distance: float) -> ComplexArray:
    r"""Velocity at a distance from a force on an infinite plate, over that at the force.

    Parameters
    ----------
    bending_wave_number : ndarray
        Wave number of bending waves, above zero. [1/m]
    distance : float
        Distance, above zero. [m]

    Returns
    -------
    ndarray of complex
        Ratio, 1 at no distance; time factor of positive imaginary exponent. [-]

    Notes
    -----
    .. math:: \frac{v(r)}{v(0)} = H_0^{(2)}(k_B r) - H_0^{(2)}(-j k_B r)
              = J_0(k_B r) - j \left[Y_0(k_B r) + \frac{2}{\pi} K_0(k_B r)\right]

    Validity: thin plate.

    References
    ----------
    .. [1] L. Cremer, M. Heckl, B. A. T. Petersson, *Structure-Borne Sound*, 3rd ed., Springer,
       2005.
    """
    x = np.asarray(bending_wave_number, dtype=float) * distance
    near = special.y0(x) + 2.0 / math.pi * special.k0(x)
    return np.asarray(special.j0(x) - 1j * near)


def plate_near_field_power(square_force: Any, mass_per_area: float) -> Any:
    r"""Sound power that an infinite plate radiates from the near field of a point force.

    Parameters
    ----------
    square_force : float or ndarray
        Mean square of the force. [N2]
    mass_per_area : float
        Mass per area. [kg/m2]

    Returns
    -------
    float or ndarray
        Sound power to one side. [W]

    Notes
    -----
    .. math:: W = \frac{\rho_0 \overline{F^2}}{2 \pi c_0 {m''}^2}

    Validity: well below the critical frequency. It does not hang on the damping of the plate.

    References
    ----------
    .. [1] L. Cremer, M. Heckl, B. A. T. Petersson, *Structure-Borne Sound*, 3rd ed., Springer,
       2005.
    """
    return AIR_DENSITY * square_force / (2.0 * math.pi * SOUND_SPEED * mass_per_area**2)
