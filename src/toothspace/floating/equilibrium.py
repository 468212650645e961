"""Equilibrium of bearings and gears, and their motion over the revolution."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from typing import NamedTuple, final

import numpy as np
from scipy.linalg import eig

from toothspace.core.types import Array
from toothspace.floating.deformation import Fields, film_coefficients, next_deformation, overstep
from toothspace.floating.motion import (
    Balance,
    Loads,
    StepSettings,
    advance,
    balance_force,
    drag_force,
    stopped,
)
from toothspace.floating.stack import (
    Snapshot,
    Stack,
    StackState,
    leaning,
    mean_coefficients,
    mean_force,
    stop_forces,
)

_MOST_STEPS = 80
_MOST_FAILURES = 6
"""Steps in time that may fail before squeeze is left out."""
_MOST_PUSHES = 2
"""Times that a state which small motions leave is left for another."""
_PUSH, _FAR = 0.05, 1e3
"""Part of the longest step that gaps allow by which such a state is pushed aside. [-]"""
_PUSH_TIME = 0.3
"""Length of the next step over the time in which the motion grows. [-]"""
_UNSTABLE = "forces balance where the smallest motion grows by {:.3g} 1/s"
_SAME_PLACE = 1e-10
"""Distance up to which a bearing counts as held where it was. [m]"""
_SAME_FRICTION = 0.01
"""Part of the friction of sliding up to which it counts as that. [-]"""
_RELAXATIONS = 150
"""Most film solutions of the relaxation without squeeze."""
NodePressure = Callable[[float], Array]
"""Pressures of all nodes at a shaft angle. [Pa]"""


@final
@dataclass(frozen=True, kw_only=True)
class SearchSettings:
    """How an equilibrium is looked for."""

    first_step: float = 1e-3
    """First step of the time in which the search moves. [s]"""
    longest_time: float = 1e3
    """Time after which the search stops: the dwell at the operating point. [s]"""
    residual_motion: float = 1e-6
    """Viscous force of the remaining motion over the balance force that is left. [-]"""
    stable: bool = True
    """Whether a balance that small motions tip away from is left for another."""


@final
@dataclass(frozen=True, eq=False)
class Equilibrium:
    """Outcome of a search."""

    balance: Balance
    """Last state; if settled with stiffness and damping of its own films."""
    settled: bool
    """Whether the remaining motion is negligible."""
    time: float
    """Time over which the bodies moved. [s]"""
    steps: int
    """Steps taken."""
    reason: str = ""
    """Why there is no equilibrium, in words."""
    begun: Balance | None = None
    """State after the first step."""


def snapshots_over_pitch(stack: Stack, pressures: NodePressure, count: int) -> tuple[Snapshot, ...]:
    """Masks and pressures at evenly spaced angles of one period of the faces."""
    period = stack.balance.interfaces[0].face.period
    angles = (np.arange(count) + 0.5) * period / count
    return tuple(stack.snapshot(float(a), pressures(float(a))) for a in angles)


def find_equilibrium(
    stack: Stack,
    snapshots: Sequence[Snapshot],
    loads: Loads,
    start: Balance,
    search: SearchSettings,
    step: StepSettings,
    known: Equilibrium | None = None,
) -> Equilibrium:
    """Let bearings and gears move under mean forces until they settle or the time is over.

    Parameters
    ----------
    stack, snapshots, loads
        Bodies and films, shaft angles over which forces are averaged, other loads.
    start : Balance
        Where the motion starts; it begins from rest.
    known : Equilibrium, optional
        What a search from there found at nearly the same pressures and viscosities. Of several
        equilibria that lie on the way the one next to it is found.

    Notes
    -----
    Implicit steps that grow as long as they succeed: accurate in time at first, Newton's method
    for the equilibrium in the end. A step that fails is repeated with a tenth of its length; after
    the sixth the way is followed without squeeze, see :func:`relax`. Newton's method also ends
    where a small motion grows: such a state is pushed aside, and the search goes on. Once bearings
    stick and slide as at the end of a known search, one step tries to reach its end.
    """
    now, time, length = stopped(start), 0.0, search.first_step
    scale, failures, pushes = balance_force(stack, loads.back), 0, 0
    still = np.zeros(stack.size)
    begun: Balance | None = None
    known = known if known is not None and known.settled else None
    for number in range(1, _MOST_STEPS + 1):
        length = min(length, search.longest_time - time)
        if length <= 1e-12:
            return Equilibrium(now, False, time, number, "its time is over")
        like, ends = None, False
        if known is not None and begun is None and loads.friction.coulomb_force != 0.0:
            like = known.begun  # the first step tells whether friction lets go
        elif known is not None and _ends_like(stack, loads, now, known.balance):
            like, ends = replace(known.balance, slides=now.slides), True
        duration = search.longest_time - time if ends else length
        found = advance(stack, snapshots, loads, now, duration, step, like=like)
        if ends:
            known = None
            if not found.converged:
                continue
        elif not found.converged:
            length, failures = 0.1 * length, failures + 1
            if failures >= _MOST_FAILURES:
                return _leaning(stack, snapshots, loads, now, time, number, search, step)
            continue
        else:
            begun, time = begun or found, time + length
            # a step that took few iterations was short for what moved
            length *= 3.0 if found.iterations <= step.max_iterations // 2 else 1.0
        now = found
        # the first steps begin from rest, where no damping is left to tell a motion by
        rests = number <= 2 and not ends
        if rests or _viscous(stack, now) > search.residual_motion * scale:
            continue
        # Newton's method stops at saddles too: a state counts that small motions return to
        now = replace(now, jacobian=film_coefficients(now.states, step.fineness))
        rate, motion = growing_motion(stack, now, loads) if search.stable else (0.0, still)
        if rate * search.longest_time <= 1.0:
            return Equilibrium(now, True, time, number, begun=begun)
        if pushes == _MOST_PUSHES:
            return Equilibrium(now, False, time, number, _UNSTABLE.format(rate))
        far = motion * _FAR
        aside = _PUSH * far / overstep(now.states, far)
        rest = np.zeros_like(motion)
        states = tuple(replace(s, position=s.position + aside, velocity=rest) for s in now.states)
        now, length, pushes = replace(now, states=states), _PUSH_TIME / rate, pushes + 1
    return Equilibrium(now, False, time, _MOST_STEPS, "it still moves after the last step")


def _ends_like(stack: Stack, loads: Loads, now: Balance, end: Balance) -> bool:
    """Whether the place of an equilibrium follows from how bearings stick and slide now.

    It does without friction, and where every bearing stays where it is or slides on in one sense,
    until the friction of sliding is all that is left. A bearing that comes to rest before, or
    creeps by a smooth law, has to be followed.
    """
    if not loads.decide_slides:
        return loads.friction.coulomb_force == 0.0
    for k, (lever, sense) in enumerate(zip(stack.levers, now.slides, strict=True)):
        way, sliding = float(lever @ (end.position - now.position)), loads.law(k).coulomb_force
        if sense == 0:
            same = end.slides[k] == 0 and abs(way) <= _SAME_PLACE
        else:
            left = abs(end.friction[k] + sense * sliding)
            same = sense * way >= 0.0 and left <= _SAME_FRICTION * sliding
        if not same:
            return False
    return True


def _leaning(
    stack: Stack,
    snapshots: Sequence[Snapshot],
    loads: Loads,
    now: Balance,
    time: float,
    steps: int,
    search: SearchSettings,
    step: StepSettings,
) -> Equilibrium:
    """Equilibrium of bodies whose motion in time cannot be followed, proved by one long step."""
    goals = step.force_tolerance, step.film_tolerance
    found = relax(stack, snapshots, loads, now, *goals, _RELAXATIONS)
    steps += found.steps
    if not np.isfinite(found.residual):
        return Equilibrium(now, False, time, steps, "films and forces do not settle")
    length = search.longest_time - time
    still = replace(now, states=found.states, slides=(0,) * len(now.slides), jacobian=None)
    # the longest step leaves next to no squeeze: what passes it is an equilibrium of the motion too
    last = advance(stack, snapshots, loads, stopped(still), length, step)
    if not last.converged:
        reason = "; ".join(leaning(stack, still.position)) or "films and forces do not settle"
        return Equilibrium(replace(still, residual=found.residual), False, time, steps, reason)
    last = replace(last, jacobian=film_coefficients(last.states, step.fineness))
    rate, _ = growing_motion(stack, last, loads)
    if rate * search.longest_time > 1.0:
        return Equilibrium(last, False, time + length, steps, _UNSTABLE.format(rate))
    settled = _viscous(stack, last) <= search.residual_motion * balance_force(stack, loads.back)
    return Equilibrium(last, settled, time + length, steps, "" if settled else "it still moves")


def _viscous(stack: Stack, balance: Balance) -> float:
    """Largest force of the films' damping on a lift; infinite where no film damps a motion. [N]."""
    assert balance.jacobian is not None
    if balance.velocity.any() and not balance.jacobian[1].any():
        return np.inf
    return drag_force(balance.jacobian, balance.velocity)


def march_angles(
    stack: Stack,
    pressures: NodePressure,
    loads: Loads,
    start: Balance,
    angles: Array,
    step: StepSettings,
) -> Iterator[Balance]:
    """March over shaft angles with transient squeeze; yields the state after every step.

    Parameters
    ----------
    stack, loads
        Bodies, films and other loads.
    pressures : callable
        Pressures of all nodes at a shaft angle. [Pa]
    start : Balance
        State before the first angle.
    angles : ndarray
        Shaft angles at the ends of the steps, evenly spaced. [rad]
    """
    duration = float(angles[1] - angles[0]) / stack.shaft_speed
    states = (replace(start.states[0], stack=stack),)
    now = replace(start, states=states, jacobian=None, responses={})
    for k, angle in enumerate(angles):
        snapshot = stack.snapshot(float(angle), pressures(float(angle)))
        now = advance(stack, (snapshot,), loads, now, duration, step, follows=k > 0)
        yield now


_ROUNDING = 1e-5
"""Growth over the fastest decay below which it counts as none. [-]"""
_UNDAMPED = 1e-12
"""Damping over the largest from which it is rounding. [-]"""


def growing_motion(stack: Stack, balance: Balance, loads: Loads) -> tuple[float, Array]:
    """Fastest growth of a motion that tips bodies in equilibrium, and its shape.

    Rate [1/s], zero if every motion decays, and coordinates with the largest one. [m, rad]

    Parameters
    ----------
    balance : Balance
        Equilibrium with its stiffness and damping; bearings that friction holds take no part.
    loads : Loads
        Friction in the housing.

    Notes
    -----
    With the films' damping D and the stiffness K of films and stops small motions follow
    D dq/dt = -K q; masses play no part. What turns carries its film along: K is not symmetric and
    motions circle. Those that circle faster than they grow do not tip a body, and are left out,
    as are those that no film damps: a cover holds all that moves together.
    """
    assert balance.jacobian is not None
    stiffness, damping = balance.jacobian
    stiffness = stiffness + stop_forces(stack, balance.position)[1]
    every = np.eye(stack.size)[:, stack.free]
    if not loads.decide_slides:
        motions = every
    else:
        bars = zip(stack.levers, balance.slides, strict=True)
        held = [lever @ every for lever, slides in bars if slides == 0]
        if not held:
            motions = every
        else:
            left = np.linalg.svd(np.array(held))[2][len(held) :]
            motions = np.asarray(every @ left.T)
    basis = motions / stack.arms[:, None]
    matrices = -basis.T @ stiffness @ basis, basis.T @ damping @ basis
    (force, drag), shapes = eig(*matrices, homogeneous_eigvals=True)
    damped = np.abs(drag) > _UNDAMPED * np.abs(drag).max()
    if not damped.any():
        return 0.0, np.zeros(stack.size)
    rates, shapes = force[damped] / drag[damped], shapes[:, damped]
    tipping = np.where(np.abs(rates.imag) < rates.real, rates.real, -np.inf)
    k = int(np.argmax(tipping))
    fastest = float(np.abs(rates).max())
    if tipping[k] <= _ROUNDING * fastest:
        return 0.0, np.zeros(stack.size)
    return float(rates[k].real), basis @ shapes[:, k].real


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
        free, arms = stack.free, stack.arms
        scaled = (now.stiffness / np.outer(arms, arms))[np.ix_(free, free)]
        step = np.zeros(stack.size)
        solved = np.linalg.solve(
            scaled + (scale / far) * np.eye(free.size), (now.force / arms)[free]
        )
        step[free] = solved / arms[free]
        step = step / overstep(now.states, step)
        found = point(
            now.states[0].position + step,
            now.states,
            [
                [a + _DEFORMATION_PART * (b - a) for a, b in zip(state.distant, new, strict=True)]
                for state, new in zip(now.states, now.wanted, strict=True)
            ],
        )
        error = _size(stack, found.force - (now.force - now.stiffness @ step))
        size = _size(stack, now.force)
        good = error <= _PREDICTED * max(size, _SMALL * scale)  # false where films are lost
        if not good and far > _SHORTEST_STEP:
            far *= _SHRINK
            continue
        if not np.isfinite(error):
            break  # films are lost at the shortest step too
        now = found
        far = min(far * _GROWTH, _LONGEST_STEP) if error <= _GOOD * size else far
    return Relaxed(now.states, _size(stack, now.force) / scale, taken)


def _size(stack: Stack, force: Array) -> float:
    """Largest force, moments as forces at the rim. [N]."""
    return float(np.abs(force / stack.arms)[stack.free].max())
