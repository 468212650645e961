"""Variable-order stiff integrator (NDF 1 to 5), compiled, resumable, with events.

The problem is given as compiled functions; ``params`` is any named tuple of arrays and is
only passed on. The state is ``y = [core | ledger]``: ledger states are integrals of
functions of the core states and stand in no right-hand side.

How to use it::

    from toothspace.core.compiled import njit
    from toothspace.numerics.ndf import NdfCallbacks, advance, initial_state
    from toothspace.numerics.ndf_types import (
        DONE, RESTART_AT_EVENT, STOP_AT_EVENT, make_record, make_settings, make_state)
    from toothspace.numerics.static_lu import analyse

    @njit
    def rhs(t, y, params, dydt): ...                # fills all n_total entries
    @njit
    def jacobian(t, y, params, jac): ...            # zeroes, fills (n_total, n_core)
    @njit
    def weights(t, y, params, w): ...               # absolute error allowed, w[:n_core]
    @njit
    def event_values(t, y, params, g): ...          # g[:n_events]

    @njit(cache=True)                               # the only function that is cached
    def begin(params, program, settings, state, t0, y0):
        callbacks = NdfCallbacks(rhs, jacobian, weights, event_values)
        return initial_state(callbacks, params, program, settings, state, t0, y0)

    @njit(cache=True)
    def integrate(params, program, settings, state, record, t_end):
        callbacks = NdfCallbacks(rhs, jacobian, weights, event_values)
        return advance(callbacks, params, program, settings, state, record, t_end)

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
"""

from __future__ import annotations
