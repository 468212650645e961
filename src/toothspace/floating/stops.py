"""Cover, wall and journal bearings that limit how far bodies lift and tilt."""

from __future__ import annotations

import numpy as np

from toothspace.core.types import Array
from toothspace.floating.stack import MovingBearing, Stack

_STIFFNESS = 1e9
"""Stiffness of the cover at one place of the rim. [N/m]"""
_SHAFT_STIFFNESS = 1e6
"""Stiffness of a shaft that leans on the far ends of its journal bearings. [N m/rad]"""
_PLACES = 12
"""Places of the rim beside every body at which the cover may be met."""


def stop_forces(stack: Stack, q: Array) -> tuple[Array, Array]:
    """Forces of cover, wall and journal bearings on the coordinates, and their stiffness.

    Parameters
    ----------
    q : ndarray
        Coordinates. [m, rad]

    Returns
    -------
    tuple of ndarray
        Generalised forces [N, N m] and minus their derivatives with the coordinates.

    Notes
    -----
    The cover is met where a place of the rim has travelled by the axial play, so that a bearing
    which films push off on one side leans on it. The wall of the housing holds the tilt about y.
    Turning bodies are held by their journal bearings, weakly until the clearance is used up.
    """
    force, stiffness = np.zeros(stack.size), np.zeros((stack.size, stack.size))
    for part in stack.moving_bearings:
        here = slice(part.first, part.first + 3)
        levers = rim_levers(stack, part)
        over = -part.sign * (levers @ q[here]) - part.play
        met = levers[over > 0.0]
        force[here] += part.sign * _STIFFNESS * (over[over > 0.0] @ met)
        stiffness[here, here] += _STIFFNESS * met.T @ met
        wall = part.bearing.wall_stiffness
        force[part.first + 2] -= wall * q[part.first + 2]
        stiffness[part.first + 2, part.first + 2] += wall
    if stack.holding_spring is not None:
        lever, spring = stack.opening, stack.holding_spring
        force += spring.stiffness * (spring.opening - float(lever @ q)) * lever
        stiffness += spring.stiffness * np.outer(lever, lever)
    held = stack.balance.shaft_stiffness or 0.0
    for tilts, most in _shafts(stack):
        moment, slope = _journal_moment(q[tilts], most)
        force[tilts] += moment - held * q[tilts]
        stiffness[tilts, tilts] += slope + held * np.eye(2)
    return force, stiffness


def leaning(stack: Stack, q: Array) -> list[str]:
    """What leans on its cover or in its journal bearings at coordinates [m, rad], in words."""
    found = []
    for part in stack.moving_bearings:
        lift = -part.sign * (rim_levers(stack, part) @ q[part.first : part.first + 3])
        if lift.max() > part.bearing.axial_play:
            beside = "" if len(stack.moving_bearings) == 1 else f" ({part.side} side)"
            found.append(f"the floating bearing{beside} has lifted to its cover")
    for body, (tilts, most) in zip(stack.balance.bodies, _shafts(stack), strict=False):
        if np.hypot(*q[tilts]) > most:
            found.append(f"{body} has tilted by the clearance of its journal bearings")
    return found


def rim_levers(stack: Stack, part: MovingBearing) -> Array:
    """Rows from lift and tilts of a bearing to the lift of places on its rim. [-, m, m]."""
    own = [
        i.face for i in stack.balance.interfaces if i.side == part.side and i.body in part.bodies
    ]
    turn = 2.0 * np.pi * np.arange(_PLACES) / _PLACES
    x = np.concatenate([i.center[0] + i.outer_radius * np.cos(turn) for i in own])
    y = np.concatenate([i.center[1] + i.outer_radius * np.sin(turn) for i in own])
    return np.stack([np.ones_like(x), y, -x], axis=1)


def _shafts(stack: Stack) -> list[tuple[slice, float]]:
    """Rotations of every turning body, and how large they may be. [rad]."""
    count = len(stack.balance.bodies)
    most = stack.balance.body_tilts or (np.inf,) * count
    places = [stack.first_body + 3 * k for k in range(count)]
    return [(slice(p + 1, p + 3), m) for p, m in zip(places, most, strict=True)]


def _journal_moment(tilt: Array, most: float) -> tuple[Array, Array]:
    """Moments on a shaft that is tilted by more than its bearings allow, and their stiffness."""
    size = float(np.hypot(*tilt))
    over = size - most
    if over <= 0.0:
        return np.zeros(2), np.zeros((2, 2))
    sense = np.outer(tilt, tilt) / size**2
    slope = sense + over / size * (np.eye(2) - sense)
    return -_SHAFT_STIFFNESS * over / size * tilt, _SHAFT_STIFFNESS * slope
