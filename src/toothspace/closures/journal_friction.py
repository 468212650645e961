"""Friction of a journal bearing over the Sommerfeld number, from boundary to full film."""

from __future__ import annotations

from dataclasses import astuple, dataclass
from typing import Any, final

import numpy as np

from toothspace.closures.smooth import smooth_step
from toothspace.core.compiled import inlined
from toothspace.core.types import Array

FULL_FILM_NUMBER = 0.5
"""Sommerfeld number about which the fit passes into the line of the full film. [-]"""
_HALF_BLEND = 0.1


@inlined
def sommerfeld_number(
    shaft_speed: Any,
    load: Any,
    dynamic_viscosity: Any,
    radius: Any,
    length: Any,
    radial_clearance: Any,
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
    radius : float or ndarray
        Radius of the journal. [m]
    length : float or ndarray
        Axial length. [m]
    radial_clearance : float or ndarray
        Radius of the bush minus radius of the journal. [m]

    Returns
    -------
    float or ndarray
        Sommerfeld number. [-]

    Notes
    -----
    .. math:: S = \frac{\mu N}{P} \left(\frac{R}{c}\right)^2, \quad
        N = \frac{\omega}{2\pi}, \quad P = \frac{W}{2 R L}

    Validity: a definition; it orders bearings of one length over diameter and one viscosity.

    References
    ----------
    .. [1] A. A. Raimondi, J. Boyd, "A solution for the finite journal bearing and its
       application to analysis and design", Trans. ASLE 1, 1958, 159-209.

    Examples
    --------
    A gear shaft of 18 mm in a bush 19 mm long, clearance 8 um, 1500 rpm, 3 kN:

    >>> round(sommerfeld_number(157.0, 3000.0, 0.02, 9e-3, 19e-3, 8e-6), 4)
    0.0721
    """
    number = radius * length * (radius / radial_clearance) ** 2
    return number * (dynamic_viscosity * shaft_speed / (np.pi * load))


@inlined
def journal_shear_torque(
    eccentricity_ratio: Any,
    shaft_speed: Any,
    dynamic_viscosity: Any,
    radius: Any,
    length: Any,
    radial_clearance: Any,
) -> Any:
    r"""Torque of viscous shear on a journal whose film is full all round.

    Parameters
    ----------
    eccentricity_ratio : float or ndarray
        Eccentricity over radial clearance, below 1. [-]
    shaft_speed : float or ndarray
        Angular speed. [rad/s]
    dynamic_viscosity : float or ndarray
        Dynamic viscosity. [Pa s]
    radius : float or ndarray
        Radius of the journal. [m]
    length : float or ndarray
        Axial length. [m]
    radial_clearance : float or ndarray
        Radius of the bush minus radius of the journal. [m]

    Returns
    -------
    float or ndarray
        Torque that opposes the rotation, sign of the speed. [N m]

    Notes
    -----
    .. math:: M = \frac{2 \pi \mu \omega L R^3}{c \sqrt{1 - \varepsilon^2}}

    which is Petroff's law for a centred journal. Validity: laminar, one viscosity; a film that
    breaks up shears less. The pressure's part is :func:`journal_pressure_torque`.

    References
    ----------
    .. [1] B. J. Hamrock, S. R. Schmid, B. O. Jacobson, *Fundamentals of Fluid Film Lubrication*,
       2nd ed., Marcel Dekker, 2004 (textbook law: Petroff, Sommerfeld).
    """
    centred = 2.0 * np.pi * dynamic_viscosity * shaft_speed * length * radius**3
    slit = radial_clearance * np.sqrt(1.0 - eccentricity_ratio * eccentricity_ratio)
    return centred * (1.0 / slit)


@inlined
def journal_pressure_torque(ex: Any, ey: Any, force_x: Any, force_y: Any) -> Any:
    r"""Torque on a journal by the shear that the pressure gradient of its film causes.

    Parameters
    ----------
    ex, ey : float or ndarray
        Eccentricity of the journal in its bush. [m]
    force_x, force_y : float or ndarray
        Force of the film on the journal. [N]

    Returns
    -------
    float or ndarray
        Torque, positive where it opposes a positive rotation. [N m]

    Notes
    -----
    .. math:: M = \tfrac12 (\mathbf e \times \mathbf F)_z

    the exact integral of :math:`\tfrac12 h\, \mathrm dp/\mathrm d\vartheta` round the journal.
    Validity: clearance small against the radius; pressure that meets itself round the journal.

    References
    ----------
    .. [1] B. J. Hamrock, S. R. Schmid, B. O. Jacobson, *Fundamentals of Fluid Film Lubrication*,
       2nd ed., Marcel Dekker, 2004 (textbook law: friction of journal and bush differ by the
       moment of the load).
    """
    return 0.5 * (ex * force_y - ey * force_x)


@inlined
def boundary_friction_term(sommerfeld: Any, boundary: Any, decay: Any) -> Any:
    r"""Part of the friction coefficient that fades as the film opens.

    Parameters
    ----------
    sommerfeld : float or ndarray
        Load parameter S = (eta N / P) (R / c)^2. [-]
    boundary, decay : float or ndarray
        Terms a and b of :class:`FrictionCurve`. [-]

    Returns
    -------
    float or ndarray
        Friction coefficient of touching asperities. [-]

    Notes
    -----
    .. math:: \mu_b = a\, e^{-S/b}

    Validity: that of the fit of :class:`FrictionCurve`.

    References
    ----------
    .. [1] A. Pawar, A. Vacca, M. Rigosi, "Modelling and experimental validation of the dynamic
       startup behavior of external spur gear motor", equation 2.7.
    """
    return boundary * np.exp(-sommerfeld / decay)


@inlined
def film_friction_fit(sommerfeld: Any, rise: Any, transition: Any, offset: Any) -> Any:
    r"""Part of the friction coefficient that a sheared film has, as fitted up to S = 0.5.

    Parameters
    ----------
    sommerfeld : float or ndarray
        Load parameter S = (eta N / P) (R / c)^2. [-]
    rise, transition, offset : float or ndarray
        Terms c, d and e of :class:`FrictionCurve`. [-]

    Returns
    -------
    float or ndarray
        Friction coefficient of the film. [-]

    Notes
    -----
    .. math:: \mu_f = c \tanh(S/d) + e

    Validity: S from 0.001 to 0.5; it saturates beyond, where a full film does not.

    References
    ----------
    .. [1] A. Pawar, A. Vacca, M. Rigosi, "Modelling and experimental validation of the dynamic
       startup behavior of external spur gear motor", equation 2.7.
    """
    return rise * np.tanh(sommerfeld / transition) + offset


@inlined
def film_friction_term(sommerfeld: Any, rise: Any, transition: Any, offset: Any, line: Any) -> Any:
    r"""Part of the friction coefficient that a sheared film has.

    Parameters
    ----------
    sommerfeld : float or ndarray
        Load parameter S = (eta N / P) (R / c)^2. [-]
    rise, transition, offset : float or ndarray
        Terms c, d and e of :class:`FrictionCurve`. [-]
    line : float or ndarray
        Slope of the full film beyond the fit. [-]

    Returns
    -------
    float or ndarray
        Friction coefficient of the film. [-]

    Notes
    -----
    .. math:: \mu = (1 - w)\, \mu_f + w\, l S

    with :func:`film_friction_fit` and a share w that rises between S = 0.4 and 0.6. Validity: the
    fit below, a full film of one viscosity above.

    References
    ----------
    .. [1] A. Pawar, A. Vacca, M. Rigosi, "Modelling and experimental validation of the dynamic
       startup behavior of external spur gear motor", equation 2.7.
    """
    fit = film_friction_fit(sommerfeld, rise, transition, offset)
    blend = smooth_step((sommerfeld - FULL_FILM_NUMBER + _HALF_BLEND) / (2.0 * _HALF_BLEND))
    return fit + blend * (line * sommerfeld - fit)


@final
@dataclass(frozen=True)
class FrictionCurve:
    r"""Friction coefficient over the Sommerfeld number.

    Notes
    -----
    .. math:: \mu = a\,e^{-S/b} + c \tanh(S/d) + e

    up to S = 0.5, about which the last two terms are blended into the line of the full film,
    because they saturate. Petroff's law is the line :math:`2 \pi^2 (c_r / R) S`. Validity: one
    bearing at one load, S above 0.001.

    References
    ----------
    .. [1] A. Pawar, A. Vacca, M. Rigosi, "Modelling and experimental validation of the dynamic
       startup behavior of external spur gear motor", equation 2.7.

    Examples
    --------
    >>> round(float(PUBLISHED_CURVE(0.0184)), 5)
    0.00102
    """

    boundary: float
    """a. [-]"""
    decay: float
    """b. [-]"""
    rise: float
    """c. [-]"""
    transition: float
    """d. [-]"""
    offset: float
    """e. [-]"""
    line: float
    """Slope of the full film beyond the fit. [-]"""

    def __call__(self, sommerfeld_number: Array | float) -> Array:
        """Friction coefficient.

        Parameters
        ----------
        sommerfeld_number : float or ndarray
            Load parameter S = (eta N / P) (R / c)^2. [-]

        Returns
        -------
        ndarray
            Friction torque over load and radius. [-]
        """
        S = np.asarray(sommerfeld_number, dtype=float)
        film = film_friction_term(S, self.rise, self.transition, self.offset, self.line)
        return np.asarray(boundary_friction_term(S, self.boundary, self.decay) + film)

    @property
    def terms(self) -> tuple[float, ...]:
        """The six numbers in their order.

        Returns
        -------
        tuple of float
            Terms. [-]
        """
        return astuple(self)

    @property
    def boundary_level(self) -> float:
        """Friction coefficient at rest.

        Returns
        -------
        float
            a + e. [-]
        """
        return self.boundary + self.offset

    def full_film_slope(self) -> float:
        """Mean slope of the full-film branch, between Sommerfeld numbers of 0.05 and 0.2.

        Returns
        -------
        float
            Slope. [-]
        """
        values = self(np.array([0.05, 0.2]))
        return float((values[1] - values[0]) / (0.2 - 0.05))

    def minimum(self) -> tuple[float, float]:
        """Lowest point of the curve.

        Returns
        -------
        sommerfeld_number : float
            Where it is, between 1e-4 and 1. [-]
        friction_coefficient : float
            Its value. [-]
        """
        S = np.geomspace(1e-4, 1.0, 4001)
        mu = self(S)
        k = int(np.argmin(mu))
        return float(S[k]), float(mu[k])


@final
@dataclass(frozen=True)
class FrictionCurves:
    """Friction curves of one bearing over its load.

    Asperities get flatter under load, so a mixed film follows the load beside the Sommerfeld
    number. Between two loads the friction coefficient is linear in the logarithm of the load,
    beyond the outermost it is that of the outermost.
    """

    loads: tuple[float, ...]
    """Rising loads on one bearing. [N]"""
    curves: tuple[FrictionCurve, ...]
    """Friction coefficient at each."""

    @property
    def rows(self) -> Array:
        """One row per load.

        Returns
        -------
        ndarray
            Logarithm of the load in N and the terms of its curve. [-]
        """
        terms = [astuple(curve) for curve in self.curves]
        return np.column_stack([np.log(self.loads), np.array(terms)])

    def __call__(self, sommerfeld_number: float, load: float) -> float:
        """Friction coefficient.

        Parameters
        ----------
        sommerfeld_number : float
            Load parameter S = (eta N / P) (R / c)^2. [-]
        load : float
            Load on one bearing. [N]

        Returns
        -------
        float
            Friction torque over load and radius. [-]
        """
        values = [float(curve(sommerfeld_number)) for curve in self.curves]
        return float(np.interp(np.log(load), np.log(self.loads), values))


PUBLISHED_CURVE = FrictionCurve(0.04486, 0.002681, 0.01897, 1.085, 0.0006507, 0.01748)
"""Fit of the motor study for S from 0.001 to 0.2; its line is Petroff's with c/R = 8.9e-4."""

PUBLISHED = FrictionCurves((1.0,), (PUBLISHED_CURVE,))
"""The same at any load."""
