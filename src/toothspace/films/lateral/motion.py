"""One implicit step of bearings and gears under the forces of their films."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple, final

import numpy as np

from toothspace.core.types import Array
from toothspace.films.lateral.deformation import Fineness, Response, Widening
from toothspace.films.lateral.housing_friction import HousingFriction
from toothspace.films.lateral.local_deformation import Accuracy
from toothspace.films.lateral.stack import (
    BackPressure,
    Past,
    Scene,
    Stack,
    StackState,
    mean_force,
)
from toothspace.films.lateral.stops import stop_forces

_STATUS_ROUNDS = 4
_PATIENCE = 16
"""Iterations of one step after which an older Jacobian is made afresh. [-]"""
_HEAD = 0.3
"""Part of the former velocity with which a step begins its search. [-]"""
_STEADY = 0.02
"""Change of gaps in one pass up to which forces tell how they vary with the positions. [-]"""
_NEAR = 1e-3
"""Residual force over the balance force up to which rest or slide is revised. [-]"""
_HELPED = 0.5
"""Part of the residual above which a step left too much and asks for a fresh Jacobian. [-]"""
_NOISE = 5.0
"""Residual over the goal from which its change tells how forces vary. [-]"""
_MOST_FAILURES = 3
"""Films that may fail one after another before a step is given up."""


@final
@dataclass(frozen=True, kw_only=True)
class StepSettings:
    """When a step is done.

    Parameters
    ----------
    force_tolerance : float
        Residual force over the balance force. [-]
    film_tolerance : float
        Change of deformation over the gap in one iteration. [-]
    max_iterations : int
        Newton iterations of one step.
    memory : int
        Former iterations from which the next deformation and position are foreseen, 0 for none.
    jacobian_age : int
        Iterations and steps that one Jacobian serves; corrected by what it foretold if several.
    passes : int
        Passes of the films in one iteration; with few, films and forces settle together.
    fineness : Fineness, optional
        Patterns of the widening whose response is kept in place of a Jacobian.
    """

    force_tolerance: float = 1e-6
    film_tolerance: float = 1e-3
    max_iterations: int = 40
    memory: int = 0
    jacobian_age: int = 1
    passes: int = Accuracy().passes
    fineness: Fineness | None = None


class Loads(NamedTuple):
    """What acts on the bearings besides the films."""

    back: BackPressure
    friction: HousingFriction  # of every pressed bearing
    parts: tuple[HousingFriction, ...] = ()  # of its parts, if it is split

    def law(self, piece: int) -> HousingFriction:
        """Friction of one pressed bearing or part."""
        return self.parts[piece % len(self.parts)] if self.parts else self.friction


@final
@dataclass(frozen=True, eq=False)
class Balance:
    """Bearings and gears at the end of a step.

    Parameters
    ----------
    states : tuple of StackState
        Films, one state per scene.
    friction : ndarray
        Friction force on each pressed bearing, along z. [N]
    slides : tuple of int
        Sense in which each pressed bearing slides, 0 at rest.
    residual : float
        Largest residual force over the balance force. [-]
    iterations : int
        Film solutions per scene.
    converged : bool
        Whether forces and films settled.
    jacobian : tuple of ndarray or None
        Stiffness and damping that served last.
    age : int
        Iterations that it has served.
    responses : mapping of int to Response
        Responses to patterns of widening, by the phase of the tooth pitch.
    """

    states: tuple[StackState, ...]
    friction: Array
    slides: tuple[int, ...]
    residual: float
    iterations: int
    converged: bool
    jacobian: tuple[Array, Array] | None = None
    age: int = 0
    responses: Mapping[int, Response] = field(default_factory=dict)

    @property
    def position(self) -> Array:
        """Coordinates. [m, rad]."""
        return self.states[0].position

    @property
    def velocity(self) -> Array:
        """Their rates. [m/s, rad/s]."""
        return self.states[0].velocity


class _Task(NamedTuple):
    stack: Stack
    scenes: tuple[Scene, ...]
    loads: Loads
    settings: StepSettings
    start: Array  # coordinates at the begin of the step
    velocity: Array  # velocity before the step
    duration: float  # [s]
    past: Past | None  # films before the step; none if the faces count as steady


class _Step(NamedTuple):
    step: Array
    holding: Array  # forces that hold bearings at rest [N]
    error: float  # largest force out of balance [N]
    force: Array
    drag: Array


def advance(
    stack: Stack,
    scenes: Sequence[Scene],
    loads: Loads,
    former: Balance,
    duration: float,
    settings: StepSettings,
    follows: bool = False,
) -> Balance:
    """Move by one implicit Euler step under the mean of the forces in all scenes.

    Parameters
    ----------
    stack : Stack
        Bodies and films.
    scenes : sequence of Scene
        Shaft angles over which forces are averaged; one for a step in time.
    loads : Loads
        Pressures behind the bearing and friction in the housing.
    former : Balance
        State before the step.
    duration : float
        Length of the step. [s]
    settings : StepSettings
        When it is done.
    follows : bool
        Whether the scene follows on that of the state before by the length of the step, so that
        the change of the widening squeezes the films. Scenes averaged over leave that out.

    Returns
    -------
    Balance
        State after the step; ``converged`` tells whether it is in balance.
    """
    past = Past(former.states[0], duration) if follows else None
    start = former.position, former.velocity
    task = _Task(stack, tuple(scenes), loads, settings, *start, duration, past)
    if not loads.friction.holds or loads.friction.coulomb_force == 0.0:
        return _solve(task, former, None)
    return _solve(task, former, former.slides)


def _revised(task: _Task, found: _Step, v: Array, tried: tuple[int, ...]) -> tuple[int, ...]:
    """Rest or slide of every pressed bearing, revised by the forces or the motion foreseen."""
    revised = []
    velocity, friction = v + found.step / task.duration, _friction(task, v, tried, found.holding)
    for k, lever in enumerate(levers_of(task.stack)):
        speed = float(lever @ velocity)
        limit = task.loads.law(k).breakaway_force
        if tried[k] == 0 and abs(friction[k]) > limit * (1.0 + 1e-9):
            revised.append(-int(np.sign(friction[k])))
        elif tried[k] != 0 and tried[k] * speed <= 0.0:
            revised.append(0)
        else:
            revised.append(tried[k])
    return tuple(revised)


def levers_of(stack: Stack) -> list[Array]:
    """Velocity of the middle of every pressed bearing from the coordinates' rates."""
    tilts = stack.balance.motion == "full"
    found = []
    for piece in stack.pieces:
        x, y = piece.bearing.face.center
        lever = np.zeros(stack.size)
        lever[piece.first : piece.first + 3] = 1.0, y * tilts, -x * tilts
        found.append(lever)
    return found


def _solve(task: _Task, former: Balance, slides: tuple[int, ...] | None) -> Balance:
    """Newton's method for positions, with friction of given sense or a smooth law for None."""
    settings, stack = task.settings, task.stack
    states: tuple[StackState, ...] = _matched(former, task)
    widening = _begun(task, states, former)
    q = task.start + _HEAD * task.duration * task.velocity
    jacobian, age = widening.serving(former.jacobian, former.age)
    best, error, failures, number = np.inf, np.inf, 0, 0
    quick = stack.with_passes(settings.passes)
    foretold: tuple[Array, Array] | None = None
    for number in range(1, settings.max_iterations + 1):
        v = (q - task.start) / task.duration
        films = quick if number % _PATIENCE else stack
        states = tuple(
            films.solve(scene, q, v, old, given, task.past)
            for scene, old, given in zip(task.scenes, states, widening.used, strict=True)
        )
        settled = all(s.converged for s in states)
        failures = 0 if settled or films is not stack else failures + 1
        if failures > _MOST_FAILURES:
            break
        change = widening.take(states, task.loads.back.low)
        steady = max(s.change for s in states) <= _STEADY
        if steady and foretold is not None and jacobian is not None:
            jacobian = _corrected(jacobian, foretold, _forces(task, states, v, slides)[0])
        if jacobian is None or age >= settings.jacobian_age or number % _PATIENCE == 0:
            jacobian, age = widening.renew(states), 0
        age += 1
        known = states, jacobian, widening.pull()
        found, revised, firm = _decided(task, known, v, slides, steady)
        if foretold is not None and age > 1 and found.error > _HELPED * error:
            jacobian, age = widening.renew(states), 1
            found, revised, firm = _decided(task, (states, jacobian, 0.0), v, slides, steady)
        slides = widening.beside(slides, revised)
        error, best = found.error, found.error / _scale(task)
        balanced = best <= settings.force_tolerance and change <= settings.film_tolerance
        if balanced and settled and firm:
            lasting = jacobian, age, widening.responses
            return _outcome(task, states, (found, v, slides), (best, number), lasting)
        step = found.step
        if not np.isfinite(step).all():
            break
        step = widening.follow(states, step, step / task.duration)
        ahead = found.force - _matrix(task, jacobian, found.drag) @ step
        foretold = (step, ahead) if _tells(settings, steady, best) else None
        q = q + step
    return _outcome(task, states, (found, v, slides), (best, number), None)


def _begun(task: _Task, states: tuple[StackState, ...], former: Balance) -> Widening:
    """Widening before the step."""
    settings, angles = task.settings, [scene.shaft_angle for scene in task.scenes]
    frequency = 0.0 if task.past is None else 1.0 / task.duration
    kept = settings.fineness, former.responses
    return Widening(states, angles, settings.memory, *kept, frequency)


def _tells(settings: StepSettings, steady: bool, residual: float) -> bool:
    """Whether forces of the next pass tell how they vary with the positions.

    What is left near the goal is the noise of films that are solved no closer.
    """
    repeated = settings.jacobian_age > 1 and settings.memory == 0
    return repeated and steady and residual > _NOISE * settings.force_tolerance


def _decided(
    task: _Task,
    known: tuple[tuple[StackState, ...], tuple[Array, Array], Array | float],
    v: Array,
    slides: tuple[int, ...] | None,
    steady: bool,
) -> tuple[_Step, tuple[int, ...] | None, bool]:
    """Newton step with the rest or slide that it leads to, and whether that is settled.

    Rest or slide is revised near the balance only, as what once rests needs more to break away.
    """
    (states, jacobian, pull), near = known, False
    for _ in range(_STATUS_ROUNDS):
        force, drag = _forces(task, states, v, slides)
        found = _newton_step(task, jacobian, (force, drag, pull), _held(task, slides), v)
        revised = slides if slides is None else _revised(task, found, v, slides)
        near = near or (steady and found.error <= _NEAR * _scale(task))
        if revised == slides or not near:
            return found, slides, revised == slides
        slides = revised
    return found, slides, False


def _held(task: _Task, slides: tuple[int, ...] | None) -> list[Array]:
    """Motions of the bearings that rest."""
    levers = levers_of(task.stack)
    return [lever for k, lever in enumerate(levers) if slides is not None and slides[k] == 0]


def _outcome(
    task: _Task,
    states: tuple[StackState, ...],
    last: tuple[_Step, Array, tuple[int, ...] | None],
    reached: tuple[float, int],
    jacobian: tuple[tuple[Array, Array], int, Mapping[int, Response]] | None,
) -> Balance:
    """State after a step; without a Jacobian it is not in balance."""
    found, v, slides = last
    return Balance(
        states,
        _friction(task, v, slides, found.holding),
        slides or (0,) * len(levers_of(task.stack)),
        *reached,
        jacobian is not None,
        *((None, 0, {}) if jacobian is None else jacobian),
    )


def _matched(former: Balance, task: _Task) -> tuple[StackState, ...]:
    """Former states, one for every scene."""
    if len(former.states) == len(task.scenes):
        return former.states
    return tuple(former.states[0] for _ in task.scenes)


def _forces(
    task: _Task, states: tuple[StackState, ...], v: Array, slides: tuple[int, ...] | None
) -> tuple[Array, Array]:
    """Force on the coordinates without held friction, and minus its derivative with velocity."""
    stack = task.stack
    held, stiffness = stop_forces(stack, task.start + v * task.duration)
    force = mean_force(states, task.loads.back) + held
    drag = stiffness * task.duration
    mass = _masses(stack)
    force -= mass * (v - task.velocity) / task.duration
    drag += np.diag(mass) / task.duration
    for k, lever in enumerate(levers_of(stack)):
        if slides is None:
            value, slope = task.loads.law(k).force(float(lever @ v))
            force -= value * lever
            drag += slope * np.outer(lever, lever)
        else:
            force -= slides[k] * task.loads.law(k).coulomb_force * lever
    return force, drag


def _masses(stack: Stack) -> Array:
    """Masses of the lifts; rotary inertia is negligible beside the films' damping."""
    masses = np.zeros(stack.size)
    for piece in stack.pieces:
        masses[piece.first] = piece.bearing.mass
    for k, mass in enumerate(stack.balance.body_masses):
        masses[stack.first_body + 3 * k] = mass
    return masses


def _matrix(task: _Task, jacobian: tuple[Array, Array], drag: Array) -> Array:
    """Minus the derivative of the forces with the coordinates at the end of the step."""
    stiffness, damping = jacobian
    return np.asarray(stiffness + (damping + drag) / task.duration)


def _corrected(
    jacobian: tuple[Array, Array], foretold: tuple[Array, Array], force: Array
) -> tuple[Array, Array]:
    """Stiffness that would have foretold the force found after a step (Broyden 1965)."""
    step, expected = foretold
    size = float(step @ step)
    if size == 0.0:
        return jacobian
    return jacobian[0] + np.outer(expected - force, step) / size, jacobian[1]


def _newton_step(
    task: _Task,
    jacobian: tuple[Array, Array],
    forces: tuple[Array, Array, Array | float],
    held: list[Array],
    v: Array,
) -> _Step:
    """Step of the coordinates that balances the forces with what the widening will add."""
    force, drag, pull = forces
    free = task.stack.free
    matrix = _matrix(task, jacobian, drag)[np.ix_(free, free)]
    count, bars = free.size, len(held)
    full = np.zeros((count + bars, count + bars))
    full[:count, :count] = matrix
    right = np.concatenate([(force + pull)[free], np.zeros(bars)])
    for k, lever in enumerate(held):
        full[:count, count + k] = -lever[free]
        full[count + k, :count] = lever[free]
        right[count + k] = -float(lever @ v) * task.duration
    # lifts in metres and tilts in radians differ by the size of the face
    scale = np.concatenate([1.0 / task.stack.arms[free], np.ones(bars)])
    solution = scale * _solved(full * scale[:, None] * scale[None, :], right * scale)
    step = np.zeros(task.stack.size)
    step[free] = solution[:count]
    holding = solution[count:]
    balanced = force.copy()
    for lever, value in zip(held, holding, strict=True):
        balanced += value * lever
    error = float(np.abs(balanced / task.stack.arms)[free].max())
    return _Step(step, holding, error, force, drag)


def _solved(matrix: Array, right: Array) -> Array:
    """Solution; that of least length where films are lost and nothing holds a motion."""
    try:
        return np.asarray(np.linalg.solve(matrix, right), dtype=np.float64)
    except np.linalg.LinAlgError:
        return np.asarray(np.linalg.lstsq(matrix, right, rcond=None)[0], dtype=np.float64)


def _friction(task: _Task, v: Array, slides: tuple[int, ...] | None, holding: Array) -> Array:
    """Friction force on every pressed bearing. [N]."""
    levers = levers_of(task.stack)
    if slides is None:
        laws = [task.loads.law(k) for k in range(len(levers))]
        return np.array([-f.force(float(w @ v))[0] for w, f in zip(levers, laws, strict=True)])
    found, rest = np.zeros(len(levers)), iter(holding)
    for k, sense in enumerate(slides):
        found[k] = next(rest) if sense == 0 else -sense * task.loads.law(k).coulomb_force
    return found


def balance_force(stack: Stack, back: BackPressure) -> float:
    """Force behind the pressed bearing, the scale of all residuals. [N]."""
    bearing = stack.balance.floating
    rest = bearing.face.area - bearing.high_pressure.area - bearing.nose.area
    push = back.high * bearing.high_pressure.area + back.nose * bearing.nose.area
    return push + back.low * rest + bearing.preload.size


def _scale(task: _Task) -> float:
    return balance_force(task.stack, task.loads.back)


def rest_at(stack: Stack, scenes: Sequence[Scene], position: Array) -> Balance:
    """State without motion at given coordinates, not in balance; where a search begins."""
    still = np.zeros(stack.size)
    flat = [np.zeros((g.rows, g.lanes)) for g in stack.grids]
    states = tuple(stack.solve(scene, position, still, None, flat) for scene in scenes)
    bearings = len(stack.pieces)
    return Balance(states, np.zeros(bearings), (0,) * bearings, np.inf, 1, False)


def at_rest(balance: Balance) -> Balance:
    """Forget the motion of a state: the next step begins from rest."""
    states = tuple(replace(s, velocity=np.zeros_like(s.velocity)) for s in balance.states)
    return replace(balance, states=states, slides=(0,) * len(balance.slides))
