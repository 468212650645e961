"""Variable-order stiff integrator (NDF 1 to 5), compiled, resumable, with events.

The problem is given as compiled functions that allocate no arrays; ``params`` is any named
tuple of arrays and is only passed on. The state is ``y = [core | ledger]``: ledger states are
integrals of functions of the core states and stand in no right-hand side.

How to use it::

    from toothspace.core.compiled import njit
    from toothspace.numerics.ndf import bind
    from toothspace.numerics.ndf_types import (
        DONE, RESTART_AT_EVENT, STOP_AT_EVENT, NdfCallbacks,
        make_record, make_settings, make_state)
    from toothspace.numerics.static_lu import analyse

    @njit
    def rhs(t, y, params, dydt): ...                # core and balances of the ledger
    @njit
    def finish(t, y, params, dydt, w, g): ...       # once a step: ledger, weights, events
    @njit
    def jacobian(t, y, params, jac, basis): ...     # zeroes, fills (n_total, n_core)
    @njit
    def weights(t, y, params, w): ...               # absolute error allowed, w[:n_core]
    @njit
    def event_values(t, y, params, g): ...          # g[:n_events]

    _initial_state, _advance = bind(NdfCallbacks(rhs, finish, jacobian, weights, event_values))

    @njit                               # cached with all that they call
    def begin(params, program, settings, state, t0, y0):
        _initial_state(params, program, settings, state, t0, y0)

    @njit
    def integrate(params, program, settings, state, record, t_end):
        return _advance(params, program, settings, state, record, t_end)

    program = analyse(pattern)                      # bool, (n_total, n_core): where jac may fill
    settings = make_settings(event_actions, max_step=1e-4)
    state = make_state(program, n_total, n_events)
    record = make_record(sample_times, n_total, event_capacity=1000)
    begin(params, program, settings, state, t0, y0)
    code = integrate(params, program, settings, state, record, t1)    # first piece
    code = integrate(params, program, settings, state, record, t2)    # goes on, no restart
    state.y; record.samples; record.counts; state.control["steps"][0]

The integrator steps past ``t_end`` and interpolates, so that pieces do not change the steps:
the right-hand side must be defined a little beyond ``t_end``.

The callbacks are bound into the compiled functions, not passed: Numba cannot cache a
function that hands compiled functions on as values.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.core.types import Array
from toothspace.numerics.ndf_step import (
    GO_ON,
    PASSED,
    accept_step,
    copy,
    error_norm,
    false_position,
    interpolate,
    note_jacobian,
    start_step,
    use_evaluation,
)
from toothspace.numerics.ndf_types import (
    DONE,
    FROM_STATE,
    RESTART_AT_EVENT,
    STOP_AT_EVENT,
    TERMINAL_EVENT,
    Compiled,
    NdfCallbacks,
    NdfFunctions,
    NdfRecord,
    NdfSettings,
    NdfState,
    kernel,
)
from toothspace.numerics.static_lu import LuProgram, factorise, solve

_NOTHING = 0
_EVENT_BITS = 60


@kernel
def _state_at(state: NdfState, time: float, y: Array) -> None:
    control = state.control[0]
    interpolate(state.differences, control.order, (time - control.time) / control.step, y)


@kernel
def _pause(state: NdfState, record: NdfRecord, t_end: float) -> int:
    """Write what lies before the end or an event; return GO_ON or why to return."""
    control = state.control[0]
    limit = min(control.valid_until, t_end)
    sample = record.counts[0]
    while sample < record.sample_times.size and record.sample_times[sample] <= limit:
        _state_at(state, record.sample_times[sample], record.samples[sample])
        sample += 1
    record.counts[0] = sample
    stop = control.pending == STOP_AT_EVENT
    if control.valid_until < t_end and control.pending == _NOTHING:
        return GO_ON
    _state_at(state, limit, state.y)
    if stop and control.valid_until <= t_end:
        control.pending = RESTART_AT_EVENT
        return TERMINAL_EVENT
    return DONE if control.valid_until >= t_end else GO_ON


@kernel
def _turn(program: LuProgram, state: NdfState) -> None:
    """Second derivative of the core states by the present derivative, J f."""
    slope, unknown, scratch, turned = state.work[4], state.work[2], state.work[5], state.delta
    n = turned.size
    copy(slope, unknown)
    kind = factorise(program, state.jacobian, state.basis, 0.0, state.factors, state.pivots)
    solve(program, state.factors, state.pivots, kind, unknown[:n], scratch)
    for i in range(n):
        turned[i] = 0.0
        for j in range(n):
            turned[i] += state.jacobian[i, j] * unknown[j]


@kernel
def _first_step(program: LuProgram, settings: NdfSettings, state: NdfState, part: int) -> None:
    """Choose a step whose first-order error h^2 |y''| / 2 is half of the tolerance.

    Part 0 takes y'' = J f from the derivative at the start, part 1 adds the derivative
    with respect to time from a second evaluation, one step later.
    """
    control = state.control[0]
    slope, first, second = state.work[4], state.differences[1], state.delta
    inverse = state.differences[2, : second.size]
    if part == 0:
        copy(slope, first)
        _turn(program, state)
        for i in range(second.size):
            inverse[i] = 1.0 / state.weights[i]
        bend = error_norm(second, inverse, settings.max_norm_share)
        speed = error_norm(slope[: second.size], inverse, settings.max_norm_share)
        scale = max(np.sqrt(bend), 1e-3 * speed)
        control.step = min(settings.max_step, 1.0 / scale if scale > 0.0 else 1e-6)
        return
    for i in range(second.size):
        second[i] += (slope[i] - first[i]) / control.step
    bend = error_norm(second, inverse, settings.max_norm_share)
    inverse[:] = 0.0
    if bend > 0.0:
        control.step = min(control.step, 1.0 / np.sqrt(bend))
    control.next_step = control.step
    for i in range(first.size):
        first[i] *= control.step


@kernel
def _log_events(state: NdfState, record: NdfRecord, until: float) -> None:
    """Write the found sign changes in the order of time."""
    roots, after = state.events[3], state.events[1]
    while True:
        first = 0
        for e in range(roots.size):
            if roots[e] < roots[first]:
                first = e
        if not roots[first] <= until:
            return
        place = record.counts[1]
        if place < record.event_times.size:
            record.event_times[place] = roots[first]
            record.event_index[place] = first
            record.event_direction[place] = 1 if after[first] >= 0.0 else -1
        record.counts[1] += 1
        roots[first] = np.inf


def bind(callbacks: NdfCallbacks) -> NdfFunctions:
    """Return ``initial_state`` and ``advance`` for a problem.

    Functions to be called from compiled code.

    Parameters
    ----------
    callbacks : NdfCallbacks
        Compiled functions of the problem.
    """
    rhs, finish, jacobian, weights, event_values, carry = callbacks
    find_events = _bind_events(event_values)

    @kernel
    def begin(
        params: Any,
        program: LuProgram,
        settings: NdfSettings,
        state: NdfState,
        t0: float,
        y0: Array,
    ) -> None:
        control = state.control[0]
        state.differences[:, :] = 0.0
        copy(y0, state.differences[0])
        control.time = control.valid_until = t0
        control.order = control.next_order = 1
        control.equal_steps = control.pending = control.rate_known = control.carried_lately = 0
        control.worst = 0.0
        start, slope = state.differences[0], state.work[4]
        weights(t0, start, params, state.weights)
        rhs(t0, start, params, slope)
        jacobian(t0, start, params, state.jacobian, state.basis)
        note_jacobian(state)
        _first_step(program, settings, state, 0)
        rhs(t0 + control.step, start, params, slope)
        _first_step(program, settings, state, 1)
        control.rhs_calls += 2
        if settings.event_actions.size > 0:
            event_values(t0, start, params, state.events[0])

    @kernel
    def initial_state(
        params: Any,
        program: LuProgram,
        settings: NdfSettings,
        state: NdfState,
        t0: float,
        y0: Array,
    ) -> None:
        """Start with order 1 and a step chosen from the equations. Arguments: ``NdfFunctions``."""
        control = state.control[0]
        control.steps = control.rejected = control.rhs_calls = control.jacobian_calls = 0
        control.factorisations = control.newton_failures = 0
        begin(params, program, settings, state, t0, y0)

    @kernel
    def advance(
        params: Any,
        program: LuProgram,
        settings: NdfSettings,
        state: NdfState,
        record: NdfRecord,
        t_end: float,
    ) -> int:
        """Integrate until a time, a terminal event or a failure.

        Steps do not depend on ``t_end`` or on the sample times; after a terminal event a
        further call goes on from the event. Arguments: see ``NdfFunctions``.
        """
        control = state.control[0]
        trial, slope = state.work[3], state.work[4]
        while True:
            code = _pause(state, record, t_end)
            if code != GO_ON:
                return code
            if control.pending == RESTART_AT_EVENT:
                begin(params, program, settings, state, control.valid_until, state.y)
            code = start_step(settings, state)
            while code == GO_ON:
                carry(params, control.origin)
                rhs(control.new_time, trial, params, slope)
                if control.jacobian_wanted == 1:
                    jacobian(control.new_time, trial, params, state.jacobian, state.basis)
                    note_jacobian(state)
                code = use_evaluation(program, settings, state)
            if code != PASSED:
                carry(params, FROM_STATE)
                copy(state.differences[0], state.y)
                return code
            carry(params, FROM_STATE)
            finish(control.new_time, trial, params, slope, state.weights, state.events[1])
            accept_step(program, settings, state)
            control.valid_until = control.time
            if settings.event_actions.size > 0:
                find_events(params, settings, state, record)

    return NdfFunctions(initial_state, advance)


def _bind_events(event_values: Compiled) -> Compiled:
    @kernel
    def locate(params: Any, state: NdfState, event: int) -> float:
        """Bracket a sign change in the last step; return the end that has the new sign."""
        control = state.control[0]
        trial_values, trial_state = state.events[2], state.work[3]
        low, high = control.time - control.step, control.time
        g_low, g_high = state.events[0, event], state.events[1, event]
        rising = g_high >= 0.0
        accuracy = 4e-16 * max(abs(low), abs(high))
        for trial in range(_EVENT_BITS):
            if high - low <= accuracy:
                break
            middle = (
                0.5 * (low + high) if trial % 3 == 2 else false_position(low, g_low, high, g_high)
            )
            _state_at(state, middle, trial_state)
            event_values(middle, trial_state, params, trial_values)
            if (trial_values[event] >= 0.0) == rising:
                high, g_high = middle, trial_values[event]
            else:
                low, g_low = middle, trial_values[event]
        return high

    @kernel
    def find_events(params: Any, settings: NdfSettings, state: NdfState, record: NdfRecord) -> None:
        """Log the sign changes of the last step up to the first that stops or restarts.

        Rows of ``state.events``: values at the start and at the end of the step, at a trial
        time, times of the sign changes.
        """
        control = state.control[0]
        actions = settings.event_actions
        before, after, roots = state.events[0], state.events[1], state.events[3]
        until, action = control.time, _NOTHING
        for e in range(actions.size):
            roots[e] = np.inf
            if (before[e] >= 0.0) != (after[e] >= 0.0):
                roots[e] = locate(params, state, e)
                if actions[e] != _NOTHING and roots[e] < until:
                    until, action = roots[e], actions[e]
        _log_events(state, record, until)
        control.valid_until, control.pending = until, action
        for e in range(actions.size):
            before[e] = after[e]

    return find_events
