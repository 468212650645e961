"""Motion of a rigid shaft on its film: stability threshold and transient orbit."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass
from typing import TYPE_CHECKING, final

import numpy as np
from scipy.optimize import brentq

from toothspace.core.errors import CaseError
from toothspace.core.types import Array
from toothspace.films.journal_film import MotionState
from toothspace.films.journal_solution import JournalBearingSolution, SurfaceSpeed
from toothspace.films.journal_solver import solve_motion

if TYPE_CHECKING:
    from toothspace.films.journal_bearing import JournalBearing

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
    """Shaft speed above which a rigid shaft whirls.

    Parameters
    ----------
    bearing : JournalBearing
        Bearing.
    load : tuple of float
        Static force x, y on the shaft, per bearing. [N]
    mass : float
        Mass of the shaft, per bearing. [kg]
    speeds : tuple of float
        A stable and an unstable speed to search between. [rad/s]

    Returns
    -------
    float
        Threshold. [rad/s]

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
            f"speeds: found mass over critical mass {low + 1.0:.3g} and {high + 1.0:.3g}, "
            "allowed are speeds on both sides of 1"
        )
    return float(brentq(margin, speeds[0], speeds[1], rtol=1e-6))


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
    bearing: JournalBearing, *, mass: float, load: Load, shaft_speed: float, settings: OrbitSettings
) -> Orbit:
    r"""Motion of a rigid shaft under a load that may vary with time.

    Parameters
    ----------
    bearing : JournalBearing
        Bearing.
    mass : float
        Mass of the shaft, per bearing. [kg]
    load : callable
        Force x, y on the shaft over time. [s to N]
    shaft_speed : float
        Rotation of the shaft. [rad/s]
    settings : OrbitSettings
        Start, duration and step.

    Returns
    -------
    Orbit
        States at every step.

    Notes
    -----
    Newmark's method of constant mean acceleration (second order, no numerical damping); the
    film force is implicit, its exact stiffness and damping serve Newton's method.
    """
    step = _OrbitStep(bearing, mass, SurfaceSpeed(shaft_speed), settings)
    position, velocity = np.array(settings.position), np.array(settings.velocity)
    film = step.film(position, velocity, None)
    acceleration = (np.array(load(0.0)) + film.force) / mass
    count = int(np.ceil(settings.duration / settings.time_step - 1e-9))
    rows = [(0.0, position, velocity, film.force)]
    converged = True
    for k in range(1, count + 1):
        time = k * settings.time_step
        state = (position, velocity, acceleration)
        position, film, found = step.advance(state, np.array(load(time)), film)
        acceleration, velocity = step.derivatives(position, state)
        rows.append((time, position, velocity, film.force))
        converged = converged and found
    time_column, x, v, f = (np.array([row[c] for row in rows]) for c in range(4))
    return Orbit(time_column, x, v, f, converged)


@final
@dataclass(frozen=True)
class _OrbitStep:
    bearing: JournalBearing
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

    def derivatives(
        self, position: Array, state: tuple[Array, Array, Array]
    ) -> tuple[Array, Array]:
        """Acceleration and velocity at the end of a step that ends at a position."""
        dt = self.settings.time_step
        x, v, a = state
        acceleration = 4.0 / dt**2 * (position - x) - 4.0 / dt * v - a
        return acceleration, v + 0.5 * dt * (a + acceleration)

    def advance(
        self, state: tuple[Array, Array, Array], load: Array, former: JournalBearingSolution
    ) -> tuple[Array, JournalBearingSolution, bool]:
        dt = self.settings.time_step
        position = state[0] + dt * state[1] + 0.25 * dt**2 * state[2]
        position = self._inside(position, state[0])
        film = former
        for _ in range(15):
            acceleration, velocity = self.derivatives(position, state)
            film = self.film(position, velocity, former)
            error = load + film.force - self.mass * acceleration
            tangent = 4.0 * self.mass / dt**2 * np.eye(2) + film.stiffness + 2.0 / dt * film.damping
            change = np.linalg.solve(tangent, error)
            position = self._inside(position + change, position)
            if np.hypot(*change) <= 1e-9 * self.bearing.radial_clearance:
                return position, film, True
        return position, film, False

    def _inside(self, position: Array, before: Array) -> Array:
        """Shorten a step that would close the gap."""
        c = self.bearing.radial_clearance
        limit = 1.0 - 0.2 * (1.0 - float(np.hypot(*before)) / c)
        ratio = float(np.hypot(*position)) / c
        return position if ratio <= limit else position * (limit / ratio)
