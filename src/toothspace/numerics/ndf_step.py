r"""One accepted step of the stiff integrator: Newton iteration, error, step and order.

Numerical differentiation formulas of order 1 to 5 in backward differences,

.. math:: \sum_{m=1}^{k} \frac{1}{m} \nabla^m y_{n+1}
          - \kappa_k \gamma_k (y_{n+1} - y^{(0)}_{n+1}) = h f(t_{n+1}, y_{n+1}).

Where the simplified Newton iteration fails with a new Jacobian, the step is tried once more with
Newton's own, a new Jacobian at every trial state, whose evaluations may carry unknowns of the
right-hand side on [3]_. A square root of a pressure drop, about which an iteration in pressures
swings for ever, is then a square of the flow, on which Newton's method converges from anywhere.

References
----------
.. [1] L. F. Shampine and M. W. Reichelt, "The MATLAB ODE suite", SIAM J. Sci. Comput. 18
   (1997) 1-22, table 1 and section 2.
.. [2] A. C. Hindmarsh et al., "SUNDIALS", ACM Trans. Math. Softw. 31 (2005) 363-396,
   section 2.1 (correction of an iteration matrix with an old step).
.. [3] E. Todini and S. Pilati, "A gradient algorithm for the analysis of pipe networks", in
   Computer Applications in Water Supply, vol. 1, Research Studies Press, 1988, 1-20.
"""

from __future__ import annotations

from typing import Any

import numpy as np

from toothspace.core.compiled import njit
from toothspace.core.types import Array
from toothspace.numerics.ndf_types import (
    CARRIED_ON,
    FROM_LAST_STEP,
    FROM_STATE,
    MAX_STEPS,
    NOT_FINITE,
    STEP_TOO_SMALL,
    NdfSettings,
    NdfState,
    kernel,
)
from toothspace.numerics.static_lu import (
    SINGULAR,
    LuProgram,
    factorise,
    ledger_product,
    solve,
    states_of,
    summing_kernel,
)

_kernel = njit(error_model="numpy", _nrt=False)


@_kernel
def copy(source: Array, target: Array) -> None:
    """Copy a vector; slices that might overlap would be copied twice."""
    for i in range(target.size):
        target[i] = source[i]


@_kernel
def interpolate(differences: Array, order: int, position: float, y: Array) -> None:
    r"""Evaluate the interpolating polynomial of the last step.

    Parameters
    ----------
    differences : ndarray, shape (>= order + 1, n)
        Backward differences at the end of the step.
    order : int
        Degree of the polynomial.
    position : float
        Time from the end of the step over the step, -1 to 0 inside the step. [-]
    y : ndarray, shape (n,)
        Receives the state.

    Notes
    -----
    .. math:: y(s) = \sum_{j=0}^{k} \nabla^j y \prod_{m=0}^{j-1} \frac{s + m}{m + 1}
    """
    n = y.size
    for i in range(n):
        y[i] = differences[0, i]
    factor = 1.0
    for j in range(1, order + 1):
        factor *= (position + (j - 1)) / j
        for i in range(n):
            y[i] += factor * differences[j, i]


@_kernel
def change_step(differences: Array, order: int, ratio: float, scratch: Array) -> None:
    """Turn backward differences into those of another step, exactly for the polynomial.

    Parameters
    ----------
    differences : ndarray, shape (>= order + 1, n)
        Backward differences, changed in place.
    order : int
        Degree of the polynomial.
    ratio : float
        New step over old step. [-]
    scratch : ndarray, shape (>= 2 * order + 2, >= order + 1)
        Work space.

    Notes
    -----
    Matrices R and U of Shampine and Reichelt (1997), section 2.2. Their product is
    triangular: a polynomial of degree m has no differences beyond the m-th.
    """
    new, old = scratch[: order + 1], scratch[order + 1 : 2 * order + 2]
    for j in range(order + 1):
        new[0, j] = old[0, j] = 1.0
        for i in range(1, order + 1):
            new[i, j] = new[i - 1, j] * (i - 1 - ratio * j) / i
            old[i, j] = old[i - 1, j] * (i - 1 - j) / i
    n = differences.shape[1]
    for j in range(1, order + 1):
        for m in range(j, order + 1):
            weight = 0.0
            for p in range(1, order + 1):
                weight += new[m, p] * old[p, j]
            if m == j:
                for i in range(n):
                    differences[j, i] *= weight
            else:
                for i in range(n):
                    differences[j, i] += weight * differences[m, i]


@_kernel
def false_position(low: float, g_low: float, high: float, g_high: float) -> float:
    """Return the next trial point of a bracketed root, kept off the ends of the bracket."""
    share = g_low / (g_low - g_high)
    share = min(max(share, 0.02), 0.98)
    return low + share * (high - low)


HARMONIC = (0.0, 1.0, 3.0 / 2.0, 11.0 / 6.0, 25.0 / 12.0, 137.0 / 60.0)
"""Sums of 1/m up to the order: gamma_k of [1]_."""

KAPPA = (0.0, -0.1850, -1.0 / 9.0, -0.0823, -0.0415, 0.0)
"""Coefficients kappa_k of [1]_, table 1."""

ERROR_CONSTANT = (
    1.0,
    0.1850 * -1.0 + 0.5,
    -1.0 / 9.0 * 1.5 + 1.0 / 3.0,
    -0.0823 * 11.0 / 6.0 + 0.25,
    -0.0415 * 25.0 / 12.0 + 0.2,
    1.0 / 6.0,
    1.0 / 7.0,
)
"""Error over the (k+1)-th backward difference: kappa_k gamma_k + 1/(k+1)."""

GO_ON = -1
PASSED = -2
"""Return code: evaluate and call again."""

# Rest of the Newton iteration allowed, in units of the error weights: after one evaluation
# with the rate of earlier steps, which a kink can make ten times too small, and later as measured.
NEWTON_LIMIT = 7
CARRIED_LIMIT = 12
NEWTON_CUT = 0.15
FIRST_TOLERANCE = 0.01
LATER_TOLERANCE = 0.6

# A step whose error passes this within the iteration will fail its test: cut it then, but not in
# the steps after one that took carried unknowns: there a correction says little about the end.
HOPELESS_ERROR = 1.2

# When factors and Jacobian are renewed: change of gamma, steps, contraction rate. A new
# Jacobian is assumed to contract by FRESH_RATE until measured.
REFACTOR_CHANGE = 0.2
JACOBIAN_AGE = 20
SLOW_RATE = 0.5
FRESH_RATE = 0.1
RATE_MEMORY = 0.3

# Choice of step and order: safety of the lower, the same and the higher order.
SAFETY = (1.4, 1.35, 1.5)
LEAST_GROWTH = 1.15
LEAST_CUT = 0.9
MOST_GROWTH = 8.0

# After a step that failed, the step grows by the largest error since: a stiff part that rings from
# the cut meets the polynomial by chance in one of the steps, and a step that grows then lets it
# ring again, for ever.
JUST_FAILED = 1e-30


@summing_kernel
def error_norm(vector: Array, inverse_weights: Array, max_share: float) -> float:
    """Return the blend of root mean square and maximum of vector over weights, [-]."""
    squares = 0.0
    n = inverse_weights.size
    for i in range(n):
        value = vector[i] * inverse_weights[i]
        squares += value * value
    typical = np.sqrt(squares / n)
    if max_share == 0.0:
        return typical
    largest = 0.0
    for i in range(n):
        largest = max(largest, abs(vector[i] * inverse_weights[i]))
    return (1.0 - max_share) * typical + max_share * largest


@kernel
def start_step(settings: NdfSettings, state: NdfState) -> int:
    """Apply the plan of the last step and set the trial state; return GO_ON or why not."""
    control = state.control[0]
    inverse = state.inverse_weights
    for i in range(inverse.size):
        inverse[i] = 1.0 / state.weights[i]
    _apply_plan(state)
    if control.jacobian_age >= JACOBIAN_AGE:
        control.jacobian_wanted = 1
    control.failures = control.not_finite = 0
    return _start_attempt(settings, state)


@kernel
def _start_attempt(settings: NdfSettings, state: NdfState) -> int:
    control = state.control[0]
    if control.steps + control.rejected >= settings.max_steps:
        return MAX_STEPS
    if not control.step > max(settings.min_step, 1e-15 * abs(control.time)):
        return NOT_FINITE if control.not_finite == 1 else STEP_TOO_SMALL
    control.new_time = control.time + control.step
    control.origin = FROM_STATE
    _predict(state)
    _start_trial(state)
    return GO_ON


@kernel
def note_jacobian(state: NdfState) -> None:
    """Book a new Jacobian."""
    control = state.control[0]
    control.jacobian_calls += 1
    control.jacobian_age = 0
    control.jacobian_wanted = 0
    control.gamma_factored = 0.0
    control.rate = FRESH_RATE
    control.rate_size = 1.0


@kernel
def use_evaluation(program: LuProgram, settings: NdfSettings, state: NdfState) -> int:
    """Go on with the derivative at the trial state.

    GO_ON: evaluate at the trial state (and the Jacobian before, if wanted); PASSED: the trial state
    stands, accept it; else the reason of the failure.
    """
    control = state.control[0]
    control.rhs_calls += 1
    gamma = control.step / ((1.0 - KAPPA[control.order]) * HARMONIC[control.order])
    if not _prepare_matrix(program, state, gamma):
        return _give_up_attempt(settings, state)
    _correct(program, state, gamma)
    size = error_norm(state.delta, state.inverse_weights, settings.max_norm_share)
    if not np.isfinite(size):
        control.not_finite = 1
        return _give_up_attempt(settings, state)
    carried = control.origin != FROM_STATE
    if carried:
        control.jacobian_wanted = 1  # the next step too begins with its own
    verdict = _judge_carried(control, size) if carried else _judge(control, size)
    control.iteration += 1
    if verdict > 0 or (verdict == 0 and not carried and _hopeless(settings, state)):
        return _test_error(settings, state)
    if verdict < 0:
        if carried:
            return _give_up_attempt(settings, state)
        if control.jacobian_age == 0:
            control.origin = FROM_LAST_STEP
        if control.jacobian_age == 0 or size > control.old_size:
            _start_trial(state)
        control.jacobian_wanted = 1
        control.iteration = 0
    elif carried:
        control.origin = CARRIED_ON
    control.old_size = size
    return GO_ON


@kernel
def _give_up_attempt(settings: NdfSettings, state: NdfState) -> int:
    """Cut the step after a Newton failure."""
    control = state.control[0]
    control.newton_failures += 1
    control.rejected += 1
    control.jacobian_wanted = 1
    _cut_step(state, NEWTON_CUT)
    return _start_attempt(settings, state)


@kernel
def _step_error(settings: NdfSettings, state: NdfState) -> float:
    return ERROR_CONSTANT[state.control[0].order] * error_norm(
        state.work[2], state.inverse_weights, settings.max_norm_share
    )


@kernel
def _test_error(settings: NdfSettings, state: NdfState) -> int:
    control = state.control[0]
    error = _step_error(settings, state)
    if error <= 1.0:
        control.error = error
        return PASSED
    control.rejected += 1
    control.jacobian_age += 1
    _reject(settings, state, error)
    control.failures += 1
    return _start_attempt(settings, state)


@kernel
def _apply_plan(state: NdfState) -> None:
    control = state.control[0]
    if control.next_step != control.step or control.next_order != control.order:
        control.order = control.next_order
        change_step(
            state.differences, control.order, control.next_step / control.step, state.change
        )
        control.step = control.next_step
        control.equal_steps = 0


@kernel
def _cut_step(state: NdfState, ratio: float) -> None:
    control = state.control[0]
    control.next_step = ratio * control.step
    _apply_plan(state)


@kernel
def _predict(state: NdfState) -> None:
    """Fill work rows: 0 predicted state, 1 constant part of the formula."""
    control = state.control[0]
    differences = state.differences
    order = control.order
    predicted, constant = state.work[0], state.work[1]
    inverse_alpha = 1.0 / ((1.0 - KAPPA[order]) * HARMONIC[order])
    weight = HARMONIC[1] * inverse_alpha
    for i in range(predicted.size):
        predicted[i] = differences[0, i] + differences[1, i]
        constant[i] = weight * differences[1, i]
    for j in range(2, order + 1):
        weight = HARMONIC[j] * inverse_alpha
        for i in range(predicted.size):
            predicted[i] += differences[j, i]
            constant[i] += weight * differences[j, i]


@kernel
def _prepare_matrix(program: LuProgram, state: NdfState, gamma: float) -> bool:
    """Factorise if gamma moved away from that of the factors; False if that is impossible."""
    control = state.control[0]
    if abs(gamma - control.gamma_factored) > REFACTOR_CHANGE * gamma:
        control.factorisations += 1
        control.gamma_factored = gamma
        control.dense_factors = factorise(
            program, state.jacobian, state.basis, gamma, state.factors, state.pivots
        )
    return control.dense_factors != SINGULAR


@kernel
def _start_trial(state: NdfState) -> None:
    """Work rows: 2 trial minus predicted state, 3 trial state (4 derivative, 5 scratch)."""
    predicted, correction, trial = state.work[0], state.work[2], state.work[3]
    state.control[0].iteration = 0
    for i in range(trial.size):
        trial[i] = predicted[i]
        correction[i] = 0.0


@kernel
def _correct(program: LuProgram, state: NdfState, gamma: float) -> None:
    """Add one simplified Newton correction to all states; ledger rows follow the core."""
    control = state.control[0]
    delta = state.delta
    n = delta.size
    predicted, constant, correction = state.work[0], state.work[1], state.work[2]
    trial, slope, scratch = state.work[3], state.work[4], state.work[5]
    damping = 2.0 / (1.0 + gamma / control.gamma_factored)
    for i in range(n):
        delta[i] = gamma * slope[i] - constant[i] - correction[i]
    solve(program, state.factors, state.pivots, control.dense_factors, delta, scratch)
    product = scratch[n:]
    ledger_product(program, state.jacobian, delta, product)
    states_of(program, state.basis, delta, scratch)
    for i in range(n):
        delta[i] = damping * scratch[i]
        correction[i] += delta[i]
        trial[i] = predicted[i] + correction[i]
    for i in range(n, trial.size):
        residual = gamma * slope[i] - constant[i] - correction[i]
        correction[i] += damping * (residual + control.gamma_factored * product[i - n])


@kernel
def _judge(control: Any, size: float) -> int:
    """Return 1 converged, 0 go on, -1 too slow."""
    if size <= 1e-6:
        return 1
    if control.iteration == 0:
        if control.rate_known == 0:
            control.rate = 0.0
            return 0
        # what is not linear contracts worse from farther away
        rate = control.rate * max(1.0, size / control.rate_size)
        return 1 if size * rate <= FIRST_TOLERANCE * (1.0 - rate) else 0
    if size > 0.9 * control.old_size:
        return -1
    control.rate = max(RATE_MEMORY * control.rate, size / control.old_size)
    control.rate_known = 1
    if control.iteration == 1:
        control.rate_size = control.old_size
    left = size * control.rate / (1.0 - control.rate)
    if left <= LATER_TOLERANCE:
        return 1
    return (
        -1 if left * control.rate ** (NEWTON_LIMIT - 1 - control.iteration) > LATER_TOLERANCE else 0
    )


@kernel
def _judge_carried(control: Any, size: float) -> int:
    """Return 1 converged, 0 go on, -1 too slow; the first corrections may grow."""
    if size <= 1e-6:
        return 1
    control.rate = 1.0 if control.iteration == 0 else size / control.old_size
    if size * control.rate <= LATER_TOLERANCE * (1.0 - control.rate):
        return 1
    return -1 if control.iteration >= CARRIED_LIMIT else 0


@kernel
def _hopeless(settings: NdfSettings, state: NdfState) -> bool:
    lately = state.control[0].carried_lately
    return lately == 0 and _step_error(settings, state) > HOPELESS_ERROR


@kernel
def _reject(settings: NdfSettings, state: NdfState, error: float) -> None:
    """Cut the step after a failed error test, to a lower order if that is better."""
    control = state.control[0]
    order = control.order
    control.worst = JUST_FAILED
    ratio = max(0.1, error ** (-1.0 / (order + 1)) / SAFETY[1])
    if control.failures > 0:
        _cut_step(state, min(ratio, 0.5))
        return
    if order > settings.lowest_order:
        lower = ERROR_CONSTANT[order - 1] * error_norm(
            state.differences[order], state.inverse_weights, settings.max_norm_share
        )
        lower_ratio = max(0.1, lower ** (-1.0 / order) / SAFETY[0])
        if lower_ratio > ratio:
            ratio = lower_ratio
            control.next_order = order - 1
    _cut_step(state, min(ratio, 0.9))


@kernel
def accept_step(program: LuProgram, settings: NdfSettings, state: NdfState) -> None:
    """Integrate the plain ledger states with their rates at the new state, then move to it."""
    control = state.control[0]
    gamma = control.step / ((1.0 - KAPPA[control.order]) * HARMONIC[control.order])
    n, start = program.order.size, program.ledger_start
    constant, correction, slope = state.work[1], state.work[2], state.work[4]
    for row in range(start.size - 1):
        if start[row] == start[row + 1]:
            correction[n + row] = gamma * slope[n + row] - constant[n + row]
    _move(settings, state, control.error)


@kernel
def _move(settings: NdfSettings, state: NdfState, error: float) -> None:
    """Move the differences to the new time and plan the next step."""
    control = state.control[0]
    order = control.order
    differences, correction = state.differences, state.work[2]
    for i in range(correction.size):
        differences[order + 2, i] = correction[i] - differences[order + 1, i]
        differences[order + 1, i] = correction[i]
    for j in range(order, -1, -1):
        for i in range(correction.size):
            differences[j, i] += differences[j + 1, i]
    control.time += control.step
    control.steps += 1
    control.equal_steps += 1
    control.jacobian_age += 1
    control.carried_lately = max(0, control.carried_lately - 1)
    if control.origin != FROM_STATE:
        control.carried_lately = JACOBIAN_AGE
    if control.rate_known == 1 and control.rate > SLOW_RATE:
        control.jacobian_age += JACOBIAN_AGE
    if control.worst > 0.0:
        control.worst = max(control.worst, error)
    if control.equal_steps > order:
        _plan(settings, state, max(error, control.worst))
        control.worst = 0.0


@kernel
def _plan(settings: NdfSettings, state: NdfState, error: float) -> None:
    """Choose order and step of the next step; small changes are not worth their cost."""
    control = state.control[0]
    order = control.order
    best_order = order
    best = _growth(error, order, SAFETY[1])
    if order > settings.lowest_order:
        lower = _growth(_difference_error(settings, state, order - 1), order - 1, SAFETY[0])
        if lower > best:
            best, best_order = lower, order - 1
    if order < settings.highest_order and control.worst == 0.0:
        higher = _growth(_difference_error(settings, state, order + 1), order + 1, SAFETY[2])
        if higher > best:
            best, best_order = higher, order + 1
    step = min(best * control.step, settings.max_step)
    ratio = step / control.step
    if ratio >= LEAST_GROWTH or ratio <= LEAST_CUT or (best_order != order and ratio >= 1.0):
        control.next_order = best_order
        control.next_step = step


@kernel
def _difference_error(settings: NdfSettings, state: NdfState, order: int) -> float:
    return ERROR_CONSTANT[order] * error_norm(
        state.differences[order + 1], state.inverse_weights, settings.max_norm_share
    )


@kernel
def _growth(error: float, order: int, safety: float) -> float:
    return min(MOST_GROWTH, 1.0 / (safety * max(error, 1e-30) ** (1.0 / (order + 1))))
