"""Relaxation to equilibrium of bodies that lean: squeeze in time is left out."""

from __future__ import annotations

from collections.abc import Sequence
from typing import NamedTuple, final

import numpy as np

from toothspace.core.types import Array
from toothspace.films.lateral.deformation import Fields, next_deformation, overstep
from toothspace.films.lateral.motion import Balance, Loads, balance_force
from toothspace.films.lateral.stack import (
    Snapshot,
    Stack,
    StackState,
    mean_coefficients,
    mean_force,
)
from toothspace.films.lateral.stops import stop_forces

_FIRST_STEP = 1e-7
"""Displacement of a body by the force behind the bearing in the first step. [m]"""
_LONGEST_STEP = 1e3
_SHORTEST_STEP = 1e-14
_PREDICTED, _GOOD = 0.5, 0.1
"""Error of the predicted force over the force: above it a step is repeated, below it grows. [-]"""
_SMALL = 1e-3
"""Force over the force behind the bearing below which no step is repeated for its error. [-]"""
_GROWTH, _SHRINK = 3.0, 0.25
_DEFORMATION_PART = 0.4
"""Part of the distant deformation that is taken over by a step. [-]"""


class Relaxed(NamedTuple):
    """Positions without motion in which forces balance, or the last ones."""

    states: tuple[StackState, ...]
    residual: float  # over the force behind the bearing [-]
    steps: int


@final
class _Point(NamedTuple):
    states: tuple[StackState, ...]
    force: Array
    stiffness: Array
    wanted: Fields
    change: float  # of the distant deformation over the gap [-]


def relax(
    stack: Stack,
    snapshots: Sequence[Snapshot],
    loads: Loads,
    start: Balance,
    force_tolerance: float,
    film_tolerance: float,
    most_steps: int,
) -> Relaxed:
    """Follow the forces of films without squeeze to where they balance.

    Parameters
    ----------
    stack, snapshots, loads
        Bodies and films, shaft angles over which forces are averaged, other loads.
    start : Balance
        Where it begins; a bearing that slides there is held back by friction.
    force_tolerance : float
        Residual over the force behind the bearing. [-]
    film_tolerance : float
        Change of a deformation over the gap. [-]
    most_steps : int
        Most film solutions.

    Notes
    -----
    Linearly implicit steps of bodies that a made-up damping holds back, the same for lifts and
    tilts at the rim. Squeeze between faces that nearly touch pushes in one sense only, since films
    cannot pull, and keeps implicit steps in time from settling; here it is left out. Steps grow as
    long as the stiffness predicts the forces found, so that a contact is met slowly.
    """
    scale = balance_force(stack, loads.back)

    def point(q: Array, former: Sequence[StackState], distant: Fields) -> _Point:
        still = np.zeros(stack.size)
        states = stack.solve_all(snapshots, q, still, former, distant)
        force, stiffness = stop_forces(stack, q)
        if loads.friction.holds:
            for k, (sense, lever) in enumerate(zip(start.slides, stack.levers, strict=True)):
                force -= sense * loads.law(k).coulomb_force * lever
        force += mean_force(states, loads.back)
        stiffness += mean_coefficients(states)[0]
        wanted, change = next_deformation(states, distant, loads.back.low)
        return _Point(states, force, stiffness, wanted, change)

    now = point(start.position, start.states, [list(s.distant) for s in start.states])
    far, taken = _FIRST_STEP, 0
    while taken < most_steps:
        settled = now.change <= film_tolerance and all(s.converged for s in now.states)
        if settled and _size(stack, now.force) <= force_tolerance * scale:
            break
        taken += 1
        step = _step(stack, now, scale / far)
        step = step / overstep(now.states, step)
        found = point(now.states[0].position + step, now.states, _followed(now))
        error = _size(stack, found.force - (now.force - now.stiffness @ step))
        size = _size(stack, now.force)
        good = error <= _PREDICTED * max(size, _SMALL * scale)  # false where films are lost
        if not good and far > _SHORTEST_STEP:
            far *= _SHRINK
            continue
        now = found
        far = min(far * _GROWTH, _LONGEST_STEP) if error <= _GOOD * size else far
    return Relaxed(now.states, _size(stack, now.force) / scale, taken)


def _step(stack: Stack, now: _Point, holding: float) -> Array:
    """Step of the coordinates against a made-up damping. [m, rad]."""
    free, arms = stack.free, stack.arms
    scaled = (now.stiffness / np.outer(arms, arms))[np.ix_(free, free)]
    step = np.zeros(stack.size)
    found = np.linalg.solve(scaled + holding * np.eye(free.size), (now.force / arms)[free])
    step[free] = found / arms[free]
    return step


def _followed(now: _Point) -> Fields:
    """Deformation for the next films: that of the last ones on its way to what they ask for."""
    return [
        [a + _DEFORMATION_PART * (b - a) for a, b in zip(state.distant, new, strict=True)]
        for state, new in zip(now.states, now.wanted, strict=True)
    ]


def _size(stack: Stack, force: Array) -> float:
    """Largest force, moments as forces at the rim. [N]."""
    return float(np.abs(force / stack.arms)[stack.free].max())
