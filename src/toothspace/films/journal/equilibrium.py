"""Position of a shaft at which the film carries the load."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from toothspace.core.status import Status
from toothspace.core.types import Array
from toothspace.films.journal.geometry import JournalDefinition, MotionState, SurfaceSpeed
from toothspace.films.journal.solution import JournalBearingSolution, load_derivatives, solve_motion

_LONGEST_STEP = 0.5
"""Longest step over the clearance. [-]"""

_SINGULAR = 1e10
"""Condition number from which a film counts as empty. [-]"""
_LONGEST_SINK = 0.1
"""Longest step of a sinking shaft over the clearance. [-]"""
_ROUND = np.linspace(0.0, 2.0 * np.pi, 180, endpoint=False)
_SINK_STEPS = 150
_QUICKER = 0.8
"""Growth of the pace of a sinking shaft from step to step, beside that of the error. [-]"""
_OVERSHOT = 2.0
"""Growth of the force out of balance with which a step counts as too long. [-]"""
_NEAR_RUNAWAY = 0.3
"""Part of the smallest gap within which a search that a runaway stopped has come to it. [-]"""
_TOLERANCE = 1e-9
"""Force out of balance over the load. [-]"""
_SLOPE_TOLERANCE = 1e-6
"""Relative residual of the pressure's response that gives the direction of a step. [-]"""

_SMALLEST_SHRINK = 0.3
"""A step may shrink the smallest gap to this part."""
_STEPS = 40


def find_equilibrium(
    bearing: JournalDefinition, load: Array, speed: SurfaceSpeed, start: tuple[float, float] | None
) -> JournalBearingSolution:
    """Newton's method with the exact stiffness, on a coarse grid first.

    See :meth:`JournalBearing.equilibrium`.
    """
    if start is None:
        rows, lanes = bearing.grid
        cells = max(min(rows, 48), rows // 4), max(min(lanes, 9), lanes // 4)
        coarse = replace(bearing, grid=cells)
        # half the smallest clearance of the centred shaft, 55 degrees from the load with rotation
        sense = -1.0 if speed.shaft + speed.bush < 0.0 else 1.0
        size = 0.5 if bearing.lobes is None else 0.5 * (1.0 - bearing.lobes.preload)
        angle = np.arctan2(load[1], load[0]) + sense * np.radians(55.0)
        guess = _newton(coarse, load, speed, size * np.array([np.cos(angle), np.sin(angle)]), 1e-3)
        # a coarse grid does not resolve a nearly closed gap, so it may go too far
        place = guess.eccentricity
        place = place * min(1.0, 0.97 / max(closeness(place, bearing), 0.01))
    else:
        place = np.asarray(start, dtype=float)
    film = _newton(bearing, load, speed, place, _TOLERANCE)
    if film.status.succeeded:
        return film
    # the shaft sinks from a place not deeper than 0.7 of the clearance
    deepest = 0.7 if bearing.lobes is None else 0.7 * (1.0 - bearing.lobes.preload)
    place = film.eccentricity
    place = place * min(1.0, deepest / max(float(np.hypot(*place)), 1e-9))
    film = _sunk(bearing, load, _solve_at(bearing, place, speed))
    if film.status.succeeded:
        return film
    missing = film.force + load
    room = 1.0 - closeness(film.eccentricity, bearing)
    if bearing.pressure_viscosity == 0.0 or room <= 0.0:
        return film
    beyond = film.eccentricity + _NEAR_RUNAWAY * room * missing / np.hypot(*missing)
    near = (_solve_at(bearing, place, film.speed) for place in (film.eccentricity, beyond))
    runs_away = any(one.status is Status.RUNAWAY for one in near)
    return replace(film, status=Status.RUNAWAY) if runs_away else film


def _sunk(
    bearing: JournalDefinition, load: Array, film: JournalBearingSolution
) -> JournalBearingSolution:
    """Let a shaft without mass sink to its place in ever longer implicit steps of time.

    Squeeze damping holds it on the way that a real shaft takes where Newton's method jumps to
    and fro, as between a light load and the pressure of a groove.
    """
    size, pace, longest = float(np.hypot(*load)), np.inf, _LONGEST_SINK
    for _ in range(_SINK_STEPS):
        error = film.force + load
        length = float(np.hypot(*error))
        if length <= _TOLERANCE * size:
            return film
        # pace that keeps the step short [1/s], and the step over the clearance
        clearance = film.bearing.radial_clearance
        damping, stiffness = film.damping * clearance, film.stiffness * clearance
        if np.linalg.cond(damping) > _SINGULAR:
            step: Array = longest * error / length
        else:
            free = np.linalg.solve(damping, error)
            pace = min(pace, float(np.hypot(*free)) / longest)
            step = np.linalg.solve(stiffness + pace * damping, error).astype(np.float64)
            step *= min(1.0, longest / max(float(np.hypot(*step)), 1e-300))
        place = film.eccentricity + _kept_inside(film.eccentricity, step, bearing)
        trial = _solve_at(bearing, place, film.speed, film)
        after = float(np.hypot(*(trial.force + load)))
        if after > _OVERSHOT * length:
            longest = 0.3 * min(longest, float(np.hypot(*step)))
            continue
        film, longest = trial, min(1.5 * longest, _LONGEST_SINK)
        pace *= max(after / length, 0.1) * _QUICKER
    return replace(film, status=Status.NOT_CONVERGED)


def _solve_at(
    bearing: JournalDefinition,
    place: Array,
    speed: SurfaceSpeed,
    former: JournalBearingSolution | None = None,
) -> JournalBearingSolution:
    position = np.array([*(bearing.radial_clearance * place), 0.0, 0.0])
    return solve_motion(bearing, MotionState(position, np.zeros(4)), speed, former=former)


def _newton(
    bearing: JournalDefinition, load: Array, speed: SurfaceSpeed, place: Array, tolerance: float
) -> JournalBearingSolution:
    film = _solve_at(bearing, place, speed)
    size = float(np.hypot(*load))
    for _ in range(_STEPS):
        error = film.force + load
        if np.hypot(*error) <= tolerance * size:
            return film
        # Newton's step; an empty film has no stiffness and follows the load
        slope = -film.bearing.radial_clearance * _slope(film, (0, 1))[:2]
        if np.linalg.cond(slope) > _SINGULAR:
            step: Array = _LONGEST_STEP * load / np.hypot(*load)
        else:
            step = np.linalg.solve(slope, error).astype(np.float64)
            step *= min(1.0, _LONGEST_STEP / max(float(np.hypot(*step)), 1e-300))
        # longest part of it that keeps the gap open and does not raise the error much
        before, step = film, _kept_inside(film.eccentricity, step, bearing)
        for _ in range(8):
            film = _solve_at(bearing, before.eccentricity + step, before.speed, before)
            if np.hypot(*(film.force + load)) < float(np.hypot(*error)):
                break
            step = 0.5 * step
    return replace(film, status=Status.NOT_CONVERGED)


def _slope(film: JournalBearingSolution, directions: tuple[int, ...]) -> Array:
    """Derivatives of force and moment with the position, as exact as Newton's method needs them."""
    return load_derivatives(
        film.solved,
        directions,
        speeds=(False,),
        relative_tolerance=_SLOPE_TOLERANCE,
    )


def closeness(place: Array, bearing: JournalDefinition) -> float:
    """One less the smallest gap over the clearance: the eccentricity ratio in a cylinder. [-]."""
    if bearing.lobes is None:
        return float(np.hypot(*place))
    nearer = place[0] * np.cos(_ROUND) + place[1] * np.sin(_ROUND)
    return float((nearer + bearing.lobes.narrowing(_ROUND)).max())


def _kept_inside(place: Array, step: Array, bearing: JournalDefinition) -> Array:
    """Shorten a step that would close the gap; rough walls may overlap a little more each time."""
    ratio = closeness(place, bearing)
    limit = ratio + (1.0 - _SMALLEST_SHRINK) * max(1.0 - ratio, 0.0)
    if bearing.surfaces is None:
        limit = min(limit, 0.9999)
    else:
        limit += 0.5 * bearing.surfaces.roughness / bearing.radial_clearance
    return longest_part(step, lambda part: closeness(place + part, bearing) <= limit)


def longest_part(step: Array, allowed: Callable[[Array], bool]) -> Array:
    """Longest part of a step that is allowed, to a fifth."""
    for _ in range(60):
        if allowed(step):
            break
        step = 0.8 * step
    return step


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
        error = film.load_vector + wanted
        if np.abs(error / size).max() <= _TOLERANCE:
            return film
        film = _stepped(bearing, film, wanted, size)
    return replace(film, status=Status.NOT_CONVERGED)


def _stepped(
    bearing: JournalDefinition, film: JournalBearingSolution, wanted: Array, size: Array
) -> JournalBearingSolution:
    """Longest part of Newton's step that keeps the gap open and lessens the error."""
    error = film.load_vector + wanted
    step: Array = np.linalg.solve(-_slope(film, (0, 1, 2, 3)), error).astype(np.float64)
    place = np.asarray(film.motion.place)
    limit = _nearest(bearing, place)
    limit += (1.0 - _SMALLEST_SHRINK) * max(1.0 - limit, 0.0)
    step = longest_part(step, lambda part: _nearest(bearing, place + part) <= limit)
    for _ in range(8):
        trial = _at(bearing, place + step, film.speed)
        if np.abs((trial.load_vector + wanted) / size).max() < np.abs(error / size).max():
            break
        step = 0.5 * step
    return trial


def _at(bearing: JournalDefinition, place: Array, speed: SurfaceSpeed) -> JournalBearingSolution:
    return solve_motion(bearing, MotionState(place, np.zeros(4)), speed, half=False)


def _nearest(bearing: JournalDefinition, place: Array) -> float:
    """One less the smallest gap at both ends over the clearance. [-]."""
    lean = 0.5 * bearing.length * np.array([place[3], -place[2]])
    ends = (place[:2] + lean, place[:2] - lean)
    return max(closeness(end / bearing.radial_clearance, bearing) for end in ends)
