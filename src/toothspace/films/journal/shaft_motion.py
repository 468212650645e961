"""Motion of a rigid shaft on its film: stability threshold and transient orbit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace
from typing import final

import numpy as np
from scipy.optimize import brentq

from toothspace.core.errors import CaseError
from toothspace.core.types import Array
from toothspace.films.journal.bearing import JournalBearing
from toothspace.films.journal.equilibrium import closeness, longest_part
from toothspace.films.journal.geometry import JournalDefinition, MotionState, SurfaceSpeed
from toothspace.films.journal.solution import JournalBearingSolution, solve_motion

Load = Callable[[float], tuple[float, float]]


def critical_mass(stiffness: Array, damping: Array) -> tuple[float, float]:
    r"""Mass of a rigid shaft on the limit of stability, and its whirl speed there.

    Parameters
    ----------
    stiffness : ndarray, shape (2, 2)
        Minus the derivative of the force with the displacement. [N/m]
    damping : ndarray, shape (2, 2)
        Minus the derivative of the force with the velocity. [N s/m]

    Returns
    -------
    tuple of float
        Largest stable mass per bearing, infinite if every mass is stable, and the whirl
        speed at that mass. [kg, rad/s]

    Notes
    -----
    With :math:`k = (K_{xx} C_{yy} + K_{yy} C_{xx} - K_{xy} C_{yx} - K_{yx} C_{xy})
    / (C_{xx} + C_{yy})` and :math:`\nu^2 = [(K_{xx} - k)(K_{yy} - k) - K_{xy} K_{yx}]
    / (C_{xx} C_{yy} - C_{xy} C_{yx})` the mass is :math:`k / \nu^2` (criterion of Routh).

    References
    ----------
    .. [1] J. W. Lund, The stability of an elastic rotor in journal bearings with flexible,
       damped supports, J. Appl. Mech. 32 (1965) 911-920.
    """
    K, C = stiffness, damping
    coupled = K[0, 0] * C[1, 1] + K[1, 1] * C[0, 0] - K[0, 1] * C[1, 0] - K[1, 0] * C[0, 1]
    k = coupled / (C[0, 0] + C[1, 1])
    whirl = (K[0, 0] - k) * (K[1, 1] - k) - K[0, 1] * K[1, 0]
    whirl /= C[0, 0] * C[1, 1] - C[0, 1] * C[1, 0]
    if whirl <= 0.0 or k <= 0.0:
        return float("inf"), 0.0
    return float(k / whirl), float(np.sqrt(whirl))


def threshold_speed(
    bearing: JournalBearing, *, load: tuple[float, float], mass: float, speeds: tuple[float, float]
) -> float:
    """Shaft speed above which a rigid shaft whirls. [rad/s].

    Parameters
    ----------
    load : tuple of float
        Static force x, y on the shaft, per bearing. [N]
    mass : float
        Mass of the shaft, per bearing. [kg]
    speeds : tuple of float
        A stable and an unstable speed to search between. [rad/s]

    Raises
    ------
    CaseError
        If both speeds are on the same side of the threshold.
    """

    def margin(shaft_speed: float) -> float:
        film = bearing.equilibrium(load=load, shaft_speed=shaft_speed)
        return mass / critical_mass(film.stiffness, film.damping)[0] - 1.0

    low, high = margin(speeds[0]), margin(speeds[1])
    if low * high > 0.0:
        raise CaseError(
            "speeds",
            f"mass over critical mass {low + 1.0:.3g} and {high + 1.0:.3g}",
            "are speeds on both sides of 1",
        )
    return float(brentq(margin, speeds[0], speeds[1], rtol=1e-6))


_STEP_PASSES = 30
"""Most iterations of Newton's method in one time step. [-]"""
_HALVINGS = 8
"""Most halvings of one of its steps. [-]"""


@final
@dataclass(frozen=True)
class Orbit:
    """Path of the shaft centre over time."""

    time: Array
    """Instants. [s]"""
    position: Array
    """Displacement x, y at every instant. [m]"""
    velocity: Array
    """Velocity x, y. [m/s]"""
    force: Array
    """Force of the film x, y. [N]"""
    converged: bool
    """Whether every step was solved."""


@final
@dataclass(frozen=True)
class OrbitSettings:
    """Start and time steps of an orbit.

    Parameters
    ----------
    position, velocity : tuple of float
        State at the beginning. [m, m/s]
    duration : float
        Simulated time. [s]
    time_step : float
        Step. [s]
    film_memory : bool
        Whether the liquid in the cavity is followed in time (mass-conserving model only).
    """

    position: tuple[float, float]
    velocity: tuple[float, float]
    duration: float
    time_step: float
    film_memory: bool = False


def shaft_orbit(
    bearing: JournalDefinition,
    *,
    mass: float,
    load: Load,
    shaft_speed: float,
    settings: OrbitSettings,
) -> Orbit:
    r"""Motion of a rigid shaft under a load that may vary with time.

    Parameters
    ----------
    mass : float
        Mass of the shaft, per bearing. [kg]
    load : callable
        Force x, y on the shaft over time. [s to N]
    shaft_speed : float
        Rotation of the shaft. [rad/s]

    Notes
    -----
    Backward differences of second order, begun with one of first order: stiff films do not ring.
    The film force is implicit, its exact stiffness and damping serve Newton's method.
    """
    step = _OrbitStep(bearing, mass, SurfaceSpeed(shaft_speed), settings)
    place = _ShaftStates(np.array(settings.position), np.array(settings.velocity))
    film = step.film(place.position, place.velocity, None)
    count = int(np.ceil(settings.duration / settings.time_step - 1e-9))
    rows = [(0.0, place.position, place.velocity, film.force)]
    converged, past = True, place
    for k in range(1, count + 1):
        time = k * settings.time_step
        found, film, done = step.advance(past, np.array(load(time)), film)
        past = replace(found, before=replace(past, before=None))
        rows.append((time, found.position, found.velocity, film.force))
        converged = converged and done
    time_column, x, v, f = (np.array([row[c] for row in rows]) for c in range(4))
    return Orbit(time_column, x, v, f, converged)


@final
@dataclass(frozen=True)
class _ShaftStates:
    """State of the shaft, and the one before it."""

    position: Array
    velocity: Array
    before: _ShaftStates | None = None

    def derivative(self, name: str) -> tuple[float, Array]:
        """Factor of the new value and what is subtracted in the rate times the step."""
        now = getattr(self, name)
        if self.before is None:
            return 1.0, now
        return 1.5, 2.0 * now - 0.5 * getattr(self.before, name)


@final
@dataclass(frozen=True)
class _OrbitStep:
    bearing: JournalDefinition
    mass: float
    speed: SurfaceSpeed
    settings: OrbitSettings

    def film(
        self, position: Array, velocity: Array, former: JournalBearingSolution | None
    ) -> JournalBearingSolution:
        zero = (0.0, 0.0)
        motion = MotionState(np.array([*position, *zero]), np.array([*velocity, *zero]))
        history = None
        if former is not None and self.settings.film_memory:
            history = former.history(self.settings.time_step)
        return solve_motion(self.bearing, motion, self.speed, former=former, history=history)

    def velocity(self, position: Array, past: _ShaftStates) -> Array:
        """Velocity at the end of a step that ends at a position."""
        factor, rest = past.derivative("position")
        return np.asarray((factor * position - rest) / self.settings.time_step)

    def trial(
        self, position: Array, past: _ShaftStates, load: Array, former: JournalBearingSolution
    ) -> tuple[JournalBearingSolution, Array]:
        """Film at the end of a step, and the force that is out of balance."""
        velocity = self.velocity(position, past)
        factor, rest = past.derivative("velocity")
        acceleration = (factor * velocity - rest) / self.settings.time_step
        film = self.film(position, velocity, former)
        return film, load + film.force - self.mass * acceleration

    def tangent(self, film: JournalBearingSolution, past: _ShaftStates) -> Array:
        """Minus the derivative of the force out of balance with the position."""
        rate = past.derivative("position")[0] / self.settings.time_step
        return np.asarray(self.mass * rate**2 * np.eye(2) + film.stiffness + rate * film.damping)

    def advance(
        self, past: _ShaftStates, load: Array, former: JournalBearingSolution
    ) -> tuple[_ShaftStates, JournalBearingSolution, bool]:
        position = past.position

        def trial(place: Array) -> tuple[JournalBearingSolution, Array]:
            return self.trial(place, past, load, former)

        film, error = trial(position)
        tangent = self.tangent(film, past)
        c, bearing = self.bearing.radial_clearance, self.bearing
        for _ in range(_STEP_PASSES):
            full = np.asarray(np.linalg.solve(tangent, error), dtype=np.float64)
            # longest part of a step that keeps the gap open and does not raise the error
            start = position
            limit = 1.0 - 0.3 * max(1.0 - closeness(start / c, bearing), 1e-3)

            def opens(part: Array, start: Array = start, limit: float = limit) -> bool:
                return bool(closeness((start + part) / c, bearing) <= limit)

            change = longest_part(full, opens)
            for _ in range(_HALVINGS):
                film, next_error = trial(position + change)
                if np.hypot(*next_error) <= np.hypot(*error):
                    break
                change = 0.5 * change
            position = position + change
            if np.hypot(*change) <= 1e-9 * self.bearing.radial_clearance:
                return _ShaftStates(position, self.velocity(position, past)), film, True
            if self.settings.film_memory:
                # the memory has no derivative of its own: Broyden's rank-one correction
                missing = error - next_error - tangent @ change
                tangent = tangent + np.outer(missing, change) / (change @ change)
            else:
                tangent = self.tangent(film, past)
            error = next_error
        return _ShaftStates(position, self.velocity(position, past)), film, False
