"""Position and tilt of a shaft at which the film carries a load and a moment."""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.films.journal.definition import JournalDefinition
from toothspace.films.journal.equilibrium import closeness, find_equilibrium
from toothspace.films.journal.geometry import MotionState, SurfaceSpeed
from toothspace.films.journal.solution import JournalBearingSolution, load_derivatives, solve_motion

_STEPS = 40
_TOLERANCE = 1e-9
_OPEN = 0.7
"""Part of the smallest gap that one step may close. [-]"""


def find_tilted_equilibrium(
    bearing: JournalDefinition,
    load: Array,
    moment: Array,
    speed: SurfaceSpeed,
    start: tuple[float, float] | None,
) -> JournalBearingSolution:
    """Newton's method with the exact 4x4 stiffness from the untilted equilibrium.

    See :meth:`JournalBearing.equilibrium`.
    """
    film = find_equilibrium(bearing, load, speed, start)
    film = _at(bearing, np.asarray(film.motion.place), speed)
    wanted = np.concatenate([load, moment])
    size = np.hypot(*load) * np.array([1.0, 1.0, bearing.length, bearing.length])
    for _ in range(_STEPS):
        error = _error(film, wanted)
        if np.abs(error / size).max() <= _TOLERANCE:
            return film
        film = _stepped(bearing, film, wanted, size)
    return replace(film, status=Status.NOT_CONVERGED)


def _at(bearing: JournalDefinition, place: Array, speed: SurfaceSpeed) -> JournalBearingSolution:
    return solve_motion(bearing, MotionState(place, np.zeros(4)), speed, half=False)


def _error(film: JournalBearingSolution, wanted: Array) -> Array:
    return np.asarray(np.concatenate([film.force, film.moment]) + wanted)


def _stepped(
    bearing: JournalDefinition, film: JournalBearingSolution, wanted: Array, size: Array
) -> JournalBearingSolution:
    """Longest part of Newton's step that keeps the gap open and lessens the error."""
    error = _error(film, wanted)
    slope = load_derivatives(film.film, bearing.fluid, (0, 1, 2, 3))[:, :4]
    step, place = np.linalg.solve(-slope, error), np.asarray(film.motion.place)
    limit = _nearest(bearing, place)
    limit += _OPEN * max(1.0 - limit, 0.0)
    for _ in range(60):
        if _nearest(bearing, place + step) <= limit:
            break
        step = 0.8 * step
    for _ in range(8):
        trial = _at(bearing, place + step, film.speed)
        if np.abs(_error(trial, wanted) / size).max() < np.abs(error / size).max():
            break
        step = 0.5 * step
    return trial


def _nearest(bearing: JournalDefinition, place: Array) -> float:
    """One less the smallest gap at both ends over the clearance. [-]."""
    lean = 0.5 * bearing.length * np.array([place[3], -place[2]])
    ends = (place[:2] + lean, place[:2] - lean)
    return max(closeness(end / bearing.radial_clearance, bearing) for end in ends)
