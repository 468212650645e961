"""What the stiff integrator is given and what it keeps: plain tuples of arrays.

All of them pass into compiled code unchanged. Arrays are written in place.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from numpy.typing import NDArray

from toothspace.core.compiled import njit, passed_by_address
from toothspace.core.types import Array, IntArray
from toothspace.numerics.static_lu import LuProgram

kernel = njit(error_model="numpy", _nrt=False)
"""Compiles a function that allocates nothing."""

MAX_ORDER = 5
DONE = 0
TERMINAL_EVENT = 1
STEP_TOO_SMALL = 2
MAX_STEPS = 3
NOT_FINITE = 4
"""Return codes of :func:`toothspace.numerics.ndf.advance`."""

LOG_EVENT = 0
STOP_AT_EVENT = 1
RESTART_AT_EVENT = 2
"""What to do at a sign change of an event value: log; log and stop; log and restart at order 1."""

CONTROL = np.dtype(
    [
        ("time", "f8"),
        ("step", "f8"),
        ("new_time", "f8"),
        ("valid_until", "f8"),
        ("next_step", "f8"),
        ("rate", "f8"),
        ("rate_size", "f8"),
        ("error", "f8"),
        ("worst", "f8"),
        ("old_size", "f8"),
        ("gamma_factored", "f8"),
        ("order", "i8"),
        ("next_order", "i8"),
        ("equal_steps", "i8"),
        ("pending", "i8"),
        ("rate_known", "i8"),
        ("iteration", "i8"),
        ("failures", "i8"),
        ("not_finite", "i8"),
        ("jacobian_wanted", "i8"),
        ("origin", "i8"),
        ("carried_lately", "i8"),
        ("jacobian_age", "i8"),
        ("dense_factors", "i8"),
        ("steps", "i8"),
        ("rejected", "i8"),
        ("rhs_calls", "i8"),
        ("jacobian_calls", "i8"),
        ("factorisations", "i8"),
        ("newton_failures", "i8"),
    ],
    align=True,
)
"""Time, step, order and counters of the integrator (one record)."""


Compiled = Callable[..., Any]
"""A compiled function."""

FROM_STATE, FROM_LAST_STEP, CARRIED_ON = range(3)
"""Where an evaluation takes unknowns within the equations from, see ``carry``."""


@kernel
def _carry_nothing(params: Any, origin: int) -> None:
    """Let every evaluation follow from the state alone."""


class NdfCallbacks(NamedTuple):
    """Compiled functions of a problem."""

    rhs: Compiled
    """``rhs(t, y, params, dydt)`` fills the time derivatives of the core states and of the ledger
    states whose Jacobian rows are in the pattern (balances).
    """
    finish: Compiled
    """``finish(t, y, params, dydt, w, g)`` is called once at each accepted state, shortly after
    ``rhs`` at a state within the tolerance of it. Fills the time derivatives of the ledger states
    without Jacobian rows (plain integrals), and what ``weights`` and ``event_values`` give.
    """
    jacobian: Compiled
    """``jacobian(t, y, params, jac, basis)`` zeroes and fills the derivatives of ``dydt`` with
    respect to unknowns that determine the core states, shape (n_total, n_core), and the derivatives
    of the core states with respect to them off the diagonal, where they stand as ones. A basis left
    as it is makes the states the unknowns. Called after ``rhs`` at the same time and state, whose
    work it may use.
    """
    weights: Compiled
    """``weights(t, y, params, w)`` fills the absolute error allowed in each core state."""
    event_values: Compiled
    """``event_values(t, y, params, g)`` fills the values whose sign changes are events."""
    carry: Compiled = _carry_nothing
    """``carry(params, origin)`` is called before ``rhs`` and ``finish``. Where the Newton iteration
    does not converge it is tried again with a new Jacobian at every trial state; ``rhs`` may then
    hold unknowns of its own, such as flows, that the equations of a path determine: FROM_LAST_STEP
    as ``finish`` left them, then CARRIED_ON by the linear equations of the evaluation before. Such
    unknowns keep smooth what is steep in the states. FROM_STATE asks for the derivatives at the
    state, whatever came before.
    """


class NdfFunctions(NamedTuple):
    """Integrator of one problem, made by :func:`toothspace.numerics.ndf.bind`."""

    initial_state: Compiled
    """``initial_state(params, program, settings, state, t0, y0)`` starts at a time [s] and state
    with order 1 and a step chosen from the equations; counters start at zero.
    """
    advance: Compiled
    """``advance(params, program, settings, state, record, t_end)`` integrates to a time [s], a
    terminal event or a failure; returns DONE, TERMINAL_EVENT, STEP_TOO_SMALL, MAX_STEPS or
    NOT_FINITE. ``state.y`` receives the state where it stops; the record goes on where its counts
    stand. Integrating in pieces gives the bits of one long run.
    """


@passed_by_address
class NdfSettings(NamedTuple):
    """Choices that hold for a whole integration."""

    max_step: float
    """Largest step. [s]"""
    min_step: float
    """Smallest step; below it the integration stops with STEP_TOO_SMALL. [s]"""
    max_steps: int
    """Largest number of accepted and rejected steps over the life of the state."""
    lowest_order: int
    highest_order: int
    """Orders allowed, 1 to 5."""
    max_norm_share: float
    """Share of the maximum norm in the error norm, the rest is root mean square, 0 to 1. [-]"""
    event_actions: IntArray
    """LOG_EVENT, STOP_AT_EVENT or RESTART_AT_EVENT of every event value. Shape (n_events,)."""


@passed_by_address
class NdfRecord(NamedTuple):
    """Where samples and events are written."""

    sample_times: Array
    """Ascending times at which the state is wanted. Shape (n_samples,). [s]"""
    samples: Array
    """State at these times. Shape (n_samples, n_total)."""
    event_times: Array
    """Times of the logged events. Shape (capacity,). [s]"""
    event_index: IntArray
    event_direction: IntArray
    """Which event value changed its sign, and +1 for rising, -1 for falling. Shape (capacity,)."""
    counts: IntArray
    """Samples written; events met (more than the capacity if the log was too short). Shape (2,)."""


@passed_by_address
class NdfState(NamedTuple):
    """Everything the integrator remembers between calls.

    ``y`` is the state where the last call stopped, shape (n_total,); ``control`` the record
    :data:`CONTROL`; ``differences`` the backward differences at ``control.time``; the other
    arrays are the saved Jacobian, the basis of its unknowns, its factors and work space.
    """

    control: NDArray[Any]
    y: Array
    differences: Array
    jacobian: Array
    basis: Array
    factors: Array
    pivots: IntArray
    work: Array
    weights: Array
    inverse_weights: Array
    delta: Array
    change: Array
    events: Array


def make_settings(
    event_actions: IntArray | None = None,
    max_step: float = np.inf,
    min_step: float = 0.0,
    max_steps: int = 10_000_000,
    orders: tuple[int, int] = (1, MAX_ORDER),
    max_norm_share: float = 0.0,
) -> NdfSettings:
    """Return settings with defaults; see :class:`NdfSettings`."""
    actions = np.zeros(0, dtype=np.int64) if event_actions is None else event_actions
    return NdfSettings(
        float(max_step),
        float(min_step),
        int(max_steps),
        int(orders[0]),
        int(orders[1]),
        float(max_norm_share),
        np.ascontiguousarray(actions, dtype=np.int64),
    )


def make_record(sample_times: Array, n_total: int, event_capacity: int = 1000) -> NdfRecord:
    """Return an empty record for samples at ascending times [s] and a log of events."""
    times = np.ascontiguousarray(sample_times, dtype=float)
    return NdfRecord(
        times,
        np.full((times.size, n_total), np.nan),
        np.full(event_capacity, np.nan),
        np.zeros(event_capacity, dtype=np.int64),
        np.zeros(event_capacity, dtype=np.int64),
        np.zeros(2, dtype=np.int64),
    )


def make_state(program: LuProgram, n_total: int, n_events: int) -> NdfState:
    """Allocate the memory of an integration; fill it with ``initial_state`` in compiled code."""
    n_core = program.order.size
    return NdfState(
        control=np.zeros(1, dtype=CONTROL),
        y=np.zeros(n_total),
        differences=np.zeros((MAX_ORDER + 3, n_total)),
        jacobian=np.zeros((n_total, n_core)),
        basis=np.eye(n_core),
        factors=np.zeros(max(program.packed_size[0], n_core * n_core)),
        pivots=np.zeros(n_core, dtype=np.int64),
        work=np.zeros((6, n_total)),
        weights=np.zeros(n_core),
        inverse_weights=np.zeros(n_core),
        delta=np.zeros(n_core),
        change=np.zeros((2 * MAX_ORDER + 4, MAX_ORDER + 2)),
        events=np.zeros((4, n_events)),
    )
