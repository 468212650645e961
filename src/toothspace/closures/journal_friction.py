"""Friction of a journal bearing over the Sommerfeld number, from boundary to full film."""

from __future__ import annotations

from dataclasses import astuple, dataclass
from typing import Any, final

import numpy as np

from toothspace.closures.smooth import smooth_step
from toothspace.core.compiled import inlined
from toothspace.core.types import Array

FULL_FILM_NUMBER = 0.5
"""Sommerfeld number about which the fit gives way to the line of the full film. [-]"""
_HALF_BLEND = 0.1


@inlined
def boundary_friction_term(sommerfeld: Any, boundary: Any, decay: Any) -> Any:
    """Part of the friction coefficient that fades as the film opens.

    Parameters
    ----------
    sommerfeld : float or ndarray
        Load parameter S = (eta N / P) (R / c)^2. [-]
    boundary, decay : float or ndarray
        Terms a and b of :class:`FrictionCurve`. [-]

    Returns
    -------
    float or ndarray
        a exp(-S / b). [-]
    """
    return boundary * np.exp(-sommerfeld / decay)


@inlined
def film_friction_term(sommerfeld: Any, rise: Any, transition: Any, offset: Any, line: Any) -> Any:
    """Part of the friction coefficient that a sheared film has.

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
        c tanh(S / d) + e, blended between S = 0.4 and 0.6 into line S. [-]
    """
    fit = rise * np.tanh(sommerfeld / transition) + offset
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
    because they saturate. Petroff's law is the line :math:`2 \pi^2 (c_r / R) S`.

    References
    ----------
    .. [1] Pawar, Vacca, Rigosi, start-up of spur gear motors, equation 2.7.

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

    def full_film_slope(self, lowest: float = 0.05, highest: float = 0.2) -> float:
        """Mean slope between two Sommerfeld numbers of the full-film branch.

        Parameters
        ----------
        lowest, highest : float
            Sommerfeld numbers. [-]

        Returns
        -------
        float
            Slope. [-]
        """
        values = self(np.array([lowest, highest]))
        return float((values[1] - values[0]) / (highest - lowest))

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
        terms = [curve.terms for curve in self.curves]
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
