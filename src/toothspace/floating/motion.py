"""One implicit step of bearings and gears under the forces of their films."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from typing import NamedTuple, final

import numpy as np

from toothspace.core.types import Array
from toothspace.floating.compliant_film import Accuracy
from toothspace.floating.deformation import DeformationIteration, DeformationResponse, Fineness
from toothspace.floating.housing_friction import HousingFriction
from toothspace.floating.stack import (
    BackPressure,
    PreviousStep,
    Snapshot,
    Stack,
    StackState,
    mean_force,
    stop_forces,
)

_STATUS_ROUNDS = 4
_PATIENCE = 16
"""Iterations of one step after which an older Jacobian is made afresh. [-]"""
_HEAD = 0.3
"""Part of the former velocity with which a step begins its search. [-]"""
_STEADY = 0.02
"""Change of gaps in one pass up to which forces show their derivative with the positions. [-]"""
_NEAR = 1e-3
"""Residual force over the balance force from which on stick or slip is revised. [-]"""
_HELPED = 0.5
"""Part of the residual above which a step left too much and asks for a fresh Jacobian. [-]"""
_NOISE = 5.0
"""Residual over the goal above which its change shows the derivative of the forces. [-]"""
_LOST = 1e6
"""Change of a deformation over the gap beyond which films are lost and a step is given up. [-]"""
_MOST_FAILURES = 3
"""Films that may fail one after another before a step is given up."""


@final
@dataclass(frozen=True, kw_only=True)
class StepSettings:
    """When a step is done."""

    force_tolerance: float = 1e-6
    """Residual force over the balance force. [-]"""
    drag_tolerance: float = 0.0
    """Residual force over the viscous force of the motion, where that allows more. [-]"""
    film_tolerance: float = 1e-3
    """Change of deformation over the gap in one iteration. [-]"""
    max_iterations: int = 40
    """Newton iterations of one step."""
    memory: int = 0
    """Former iterations from which the next deformation and position are predicted, 0 for none."""
    jacobian_age: int = 1
    """Iterations and steps that one Jacobian serves; corrected by what it predicted if several."""
    passes: int = Accuracy().passes
    """Passes of the films in one iteration; with few, films and forces settle together."""
    fineness: Fineness | None = None
    """Basis functions of the deformation whose response is kept in place of a Jacobian."""


class Loads(NamedTuple):
    """What acts on the bearings besides the films."""

    back: BackPressure
    friction: HousingFriction  # of every floating bearing
    parts: tuple[HousingFriction, ...] = ()  # of its parts, if it is split

    @property
    def decide_slides(self) -> bool:
        """Whether a bearing sticks or slides; without friction or by a smooth law it moves."""
        return self.friction.holds and self.friction.coulomb_force != 0.0

    def law(self, part: int) -> HousingFriction:
        """Friction of one floating bearing or part."""
        return self.parts[part % len(self.parts)] if self.parts else self.friction


@final
@dataclass(frozen=True, eq=False)
class Balance:
    """Bearings and gears at the end of a step."""

    states: tuple[StackState, ...]
    """Films, one state per snapshot."""
    friction: Array
    """Friction force on each floating bearing, along z. [N]"""
    slides: tuple[int, ...]
    """Sense in which each floating bearing slides, 0 at rest."""
    residual: float
    """Largest residual force over the balance force. [-]"""
    iterations: int
    """Film solutions per snapshot."""
    converged: bool
    """Whether forces and films settled."""
    jacobian: tuple[Array, Array] | None = None
    """Stiffness and damping that served last."""
    age: int = 0
    """Iterations that it has served."""
    responses: Mapping[int, DeformationResponse] = field(default_factory=dict)
    """Responses to basis functions of the deformation, by the phase of the tooth pitch."""

    @property
    def position(self) -> Array:
        """Coordinates. [m, rad]."""
        return self.states[0].position

    @property
    def velocity(self) -> Array:
        """Their rates. [m/s, rad/s]."""
        return self.states[0].velocity


class _StepTask(NamedTuple):
    stack: Stack
    snapshots: tuple[Snapshot, ...]
    loads: Loads
    settings: StepSettings
    start: Array  # coordinates at the begin of the step
    velocity: Array  # velocity before the step
    duration: float  # [s]
    previous: PreviousStep | None  # films before the step; none if the faces count as steady

    @property
    def scale(self) -> float:
        """Force behind the floating bearing. [N]."""
        return balance_force(self.stack, self.loads.back)


class _Step(NamedTuple):
    step: Array
    holding: Array  # forces that hold bearings at rest [N]
    error: float  # largest force out of balance [N]
    force: Array
    drag: Array


def advance(
    stack: Stack,
    snapshots: Sequence[Snapshot],
    loads: Loads,
    former: Balance,
    duration: float,
    settings: StepSettings,
    follows: bool = False,
    like: Balance | None = None,
) -> Balance:
    """Move by one implicit Euler step under the mean of the forces in all snapshots.

    State after the step; ``converged`` says whether it is in balance.

    Parameters
    ----------
    snapshots : sequence of Snapshot
        Shaft angles over which forces are averaged; one for a step in time.
    loads : Loads
        Pressures behind the bearing and friction in the housing.
    former : Balance
        State before the step.
    duration : float
        Length of the step. [s]
    follows : bool
        Whether the snapshot follows on that of the state before by the length of the step, so that
        the change of the deformation squeezes the films. Snapshots averaged over leave that out.
    like : Balance, optional
        Similar state at the end of such a step, whose films the step begins with, and whose place
        where bearings slide alike; default the state before.
    """
    previous = PreviousStep(former.states[0], duration) if follows else None
    start = former.position, former.velocity
    task = _StepTask(stack, tuple(snapshots), loads, settings, *start, duration, previous)
    ahead = task.start + _HEAD * duration * former.velocity
    slides = former.slides if loads.decide_slides else None
    if like is None:
        return _solve(task, former, ahead, slides)
    place = like.position if slides is None or slides == like.slides else ahead
    return _solve(task, like, place, slides)


def _solve(task: _StepTask, former: Balance, q: Array, slides: tuple[int, ...] | None) -> Balance:
    """Newton's method for positions, with friction of given sense or a smooth law for None."""
    settings, stack = task.settings, task.stack
    states = former.states
    if len(states) != len(task.snapshots):
        states = states[:1] * len(task.snapshots)
    angles = [snapshot.shaft_angle for snapshot in task.snapshots]
    kept = settings.fineness, former.responses
    frequency = 0.0 if task.previous is None else 1.0 / task.duration
    deformation = DeformationIteration(states, angles, settings.memory, *kept, frequency)
    # where the deformation is kept, forces show no derivative with the positions alone
    repeated = settings.jacobian_age > 1 and settings.memory == 0
    jacobian, age = deformation.serving(former.jacobian, former.age)
    best, error, failures, converged = np.inf, np.inf, 0, False
    quick = stack.with_passes(settings.passes)
    predicted: tuple[Array, Array] | None = None
    for number in range(1, settings.max_iterations + 1):
        v = (q - task.start) / task.duration
        # films are solved no closer than positions are known, now and then in full
        films = quick if number % _PATIENCE else stack
        states = films.solve_all(task.snapshots, q, v, states, deformation.used, task.previous)
        settled = all(s.converged for s in states)
        failures = 0 if settled or films is not stack else failures + 1
        if failures > _MOST_FAILURES:
            break
        change = deformation.take(states, task.loads.back.low)
        steady = max(s.change for s in states) <= _STEADY
        if steady and predicted is not None and jacobian is not None:
            # stiffness that would have predicted the force found after the step (Broyden 1965)
            taken, expected = predicted
            size = float(taken @ taken)
            if size > 0.0:
                missing = expected - _forces(task, states, v, slides)[0]
                jacobian = jacobian[0] + np.outer(missing, taken) / size, jacobian[1]
        if jacobian is None or age >= settings.jacobian_age or number % _PATIENCE == 0:
            jacobian, age = deformation.renew(states), 0
        age += 1
        pull = deformation.pull()
        found, revised, firm = _decided(task, states, jacobian, pull, v, slides, steady)
        # an old Jacobian that no longer helps is renewed before its step is taken
        if predicted is not None and age > 1 and found.error > _HELPED * error:
            jacobian, age = deformation.renew(states), 1
            found, revised, firm = _decided(task, states, jacobian, 0.0, v, slides, steady)
        slides = deformation.beside(slides, revised)
        error, best = found.error, found.error / task.scale
        goal = settings.force_tolerance * task.scale
        goal = max(goal, settings.drag_tolerance * drag_force(jacobian, v))
        balanced = error <= goal and change <= settings.film_tolerance
        converged = balanced and settled and firm
        step = found.step
        if converged or not np.isfinite(step).all() or not change < _LOST:
            break
        step = deformation.follow(states, step, step / task.duration)
        ahead = found.force - _matrix(task, jacobian, found.drag) @ step
        # what is left near the goal is the noise of films that are solved no closer
        informative = repeated and steady and best > _NOISE * settings.force_tolerance
        predicted = (step, ahead) if informative else None
        q = q + step
    return Balance(
        states,
        _friction(task, v, slides, found.holding),
        slides or (0,) * len(stack.moving_bearings),
        best,
        number,
        converged,
        jacobian=jacobian if converged else None,
        age=age if converged else 0,
        responses=deformation.responses if converged else {},
    )


def _decided(
    task: _StepTask,
    states: tuple[StackState, ...],
    jacobian: tuple[Array, Array],
    pull: Array | float,
    v: Array,
    slides: tuple[int, ...] | None,
    steady: bool,
) -> tuple[_Step, tuple[int, ...] | None, bool]:
    """Newton step with the stick or slip that it leads to, and whether that is settled.

    Stick or slip is revised near the balance only: what once sticks needs more to break away.
    """
    near, levers = False, task.stack.levers
    for _ in range(_STATUS_ROUNDS):
        held = [w for k, w in enumerate(levers) if slides is not None and slides[k] == 0]
        force, drag = _forces(task, states, v, slides)
        found = _newton_step(task, jacobian, force, drag, pull, held, v)
        revised = slides
        if slides is not None:
            following = []
            velocity = v + found.step / task.duration
            friction = _friction(task, v, slides, found.holding)
            for k, lever in enumerate(task.stack.levers):
                speed = float(lever @ velocity)
                limit = task.loads.law(k).breakaway_force
                # holding asks for more than friction gives: it slides the way it is pushed
                if slides[k] == 0 and abs(friction[k]) > limit * (1.0 + 1e-9):
                    following.append(-int(np.sign(friction[k])))
                # friction would drive it on: it sticks before it turns round
                elif slides[k] != 0 and slides[k] * speed <= 0.0:
                    following.append(0)
                else:
                    following.append(slides[k])
            revised = tuple(following)
        near = near or (steady and found.error <= _NEAR * task.scale)
        if revised == slides or not near:
            return found, slides, revised == slides
        slides = revised
    return found, slides, False


def _forces(
    task: _StepTask, states: tuple[StackState, ...], v: Array, slides: tuple[int, ...] | None
) -> tuple[Array, Array]:
    """Force on the coordinates without held friction, and minus its derivative with velocity."""
    stack = task.stack
    held, stiffness = stop_forces(stack, task.start + v * task.duration)
    force = mean_force(states, task.loads.back) + held
    drag = stiffness * task.duration
    # rotary inertia is negligible beside the films' damping
    mass = np.zeros(stack.size)
    for part in stack.moving_bearings:
        mass[part.first] = part.bearing.mass
    mass[stack.first_body :][: 3 * len(stack.balance.bodies) : 3] = stack.balance.body_masses
    force -= mass * (v - task.velocity) / task.duration
    drag += np.diag(mass) / task.duration
    for k, lever in enumerate(stack.levers):
        if slides is None:
            value, slope = task.loads.law(k).force(float(lever @ v))
            force -= value * lever
            drag += slope * np.outer(lever, lever)
        else:
            force -= slides[k] * task.loads.law(k).coulomb_force * lever
    return force, drag


def _matrix(task: _StepTask, jacobian: tuple[Array, Array], drag: Array) -> Array:
    """Minus the derivative of the forces with the coordinates at the end of the step."""
    stiffness, damping = jacobian
    return np.asarray(stiffness + (damping + drag) / task.duration)


def _newton_step(
    task: _StepTask,
    jacobian: tuple[Array, Array],
    force: Array,
    drag: Array,
    pull: Array | float,
    held: list[Array],
    v: Array,
) -> _Step:
    """Step of the coordinates that balances the forces with what the deformation will add."""
    free = task.stack.free
    matrix = _matrix(task, jacobian, drag)[np.ix_(free, free)]
    # a bearing that sticks adds the force that holds it as an unknown, and that it does not move
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
    scaled = full * scale[:, None] * scale[None, :], right * scale
    try:
        solution = scale * np.linalg.solve(*scaled)
    except np.linalg.LinAlgError:
        # that of least length, where films are lost and nothing holds a motion
        solution = scale * np.linalg.lstsq(*scaled, rcond=None)[0]
    step = np.zeros(task.stack.size)
    step[free] = solution[:count]
    holding = solution[count:]
    balanced = force.copy()
    for lever, value in zip(held, holding, strict=True):
        balanced += value * lever
    error = float(np.abs(balanced / task.stack.arms)[free].max())
    return _Step(step, holding, error, force, drag)


def _friction(task: _StepTask, v: Array, slides: tuple[int, ...] | None, holding: Array) -> Array:
    """Friction force on every floating bearing. [N]."""
    levers = task.stack.levers
    if slides is None:
        laws = [task.loads.law(k) for k in range(len(levers))]
        return np.array([-f.force(float(w @ v))[0] for w, f in zip(levers, laws, strict=True)])
    found, stuck = np.zeros(len(levers)), iter(holding)
    for k, sense in enumerate(slides):
        # a search that is left just as a bearing comes to rest has no force for it yet
        found[k] = next(stuck, 0.0) if sense == 0 else -sense * task.loads.law(k).coulomb_force
    return found


def drag_force(jacobian: tuple[Array, Array], velocity: Array) -> float:
    """Largest force of the films' damping on a lift. [N]."""
    return float(np.abs(jacobian[1] @ velocity)[::3].max())


def balance_force(stack: Stack, back: BackPressure) -> float:
    """Force behind the floating bearing, the scale of all residuals. [N]."""
    bearing = stack.balance.floating
    rest = bearing.face.area - bearing.high_pressure.area - bearing.nose.area
    push = back.high * bearing.high_pressure.area + back.nose * bearing.nose.area
    return push + back.low * rest + bearing.preload.size


def state_at(stack: Stack, snapshots: Sequence[Snapshot], position: Array) -> Balance:
    """State without motion at given coordinates, not in balance; where a search begins."""
    still = np.zeros(stack.size)
    flat = [np.zeros((g.rows, g.lanes)) for g in stack.grids]
    states = tuple(stack.solve(snapshot, position, still, None, flat) for snapshot in snapshots)
    bearings = len(stack.moving_bearings)
    return Balance(states, np.zeros(bearings), (0,) * bearings, np.inf, 1, False)


def stopped(balance: Balance) -> Balance:
    """Forget the motion of a state: the next step begins from rest."""
    states = tuple(replace(s, velocity=np.zeros_like(s.velocity)) for s in balance.states)
    return replace(balance, states=states, slides=(0,) * len(balance.slides))
